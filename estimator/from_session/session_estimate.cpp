#include "estimator/from_session/session_estimate.h"

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "base/format.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "calib/camera_model.h"
#include "estimator/baseline/paper_estimate.h"
#include "estimator/from_session/calibration_errors.h"
#include "rig/session_calibration.h"

namespace turnlight::estimator::from_session {
namespace {

// Tells the stages: each begun ends the one before.
class Stages {
 public:
  explicit Stages(const Options& options) : options_(options) {}

  void Begin(Stage stage, std::size_t total = 1) {
    End();
    stage_ = stage;
    done_ = 0;
    total_ = total;
    Tell();
  }
  // One more part of the stage is done. May be called from several threads.
  void Step() {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++done_;
    Tell();
  }
  void End() {
    if (done_ == total_) return;
    done_ = total_;
    Tell();
  }

 private:
  void Tell() {
    if (options_.progress) options_.progress(stage_, done_, total_);
  }

  const Options& options_;
  std::mutex mutex_;
  Stage stage_ = Stage::kReading;
  std::size_t done_ = 0, total_ = 0;
};

// Those of --frames, or frames floor(i F / N).
Result<std::vector<std::size_t>> ChooseFrames(const rig::Session& session, const Options& options) {
  const std::optional<int>& views = options.views;
  const std::size_t all = session.frames.size();
  if (!options.frames.empty()) {
    if (views) return InputError("--frames: not with --views, which chooses frames, too");
    if (options.frames.back() < all) return options.frames;
    return InputError("--frames: " + std::to_string(options.frames.back()) + ", allowed are 0 to " +
                      std::to_string(all - 1) + ", the session's " + std::to_string(all) +
                      " frames");
  }
  if (views && (*views < 1 || static_cast<std::size_t>(*views) > all))
    return InputError("--views: " + std::to_string(*views) +
                      ", allowed are at most the session's " + std::to_string(all) + " frames");
  const std::size_t count = views ? static_cast<std::size_t>(*views) : all;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(i * all / count);
  return chosen;
}

// The first refusal in the order of the frames, whatever thread found it.
Result<std::vector<model::Keyframe>> LoadKeyframes(const rig::Session& session,
                                                   const std::vector<std::size_t>& chosen,
                                                   const StopFlag* stop, Stages& stages) {
  std::vector<model::Keyframe> keyframes(chosen.size());
  std::vector<Status> statuses(chosen.size());
  stages.Begin(Stage::kReading, chosen.size());
  ParallelFor(chosen.size(), [&](std::size_t i) {
    if (StopRequested(stop)) return;
    const rig::FrameRecord& frame = session.frames[chosen[i]];
    const auto images = rig::ReadFrameImages(session, chosen[i]);
    if (!images) {
      statuses[i] = Forward(images);
      return;
    }
    keyframes[i] = {calib::Linearise(images->image, session.radiometry, frame.exposure),
                    images->mask, frame.X_WC, frame.X_WT};
    stages.Step();
  });
  if (StopRequested(stop)) return InterruptedError();
  for (const Status& status : statuses)
    if (!status) return Forward(status);
  return keyframes;
}

// Metres to the session's unit.
Result<double> FromMetres(double metres, const std::string& length_unit) {
  static const std::map<std::string, double> kMetres = {{"um", 1e-6},   {"mm", 1e-3},  {"cm", 1e-2},
                                                        {"dm", 0.1},    {"m", 1.0},    {"km", 1e3},
                                                        {"in", 0.0254}, {"ft", 0.3048}};
  const auto unit = kMetres.find(length_unit);
  if (unit != kMetres.end()) return metres / unit->second;
  std::vector<std::string> known;
  for (const auto& [name, value] : kMetres) known.push_back(name);
  return InputError(
      "--ceiling-distance: metres cannot be converted to the session's length_unit \"" +
      length_unit + "\", known are " + Listed(known));
}

Status CheckMethod(const Options& options) {
  const bool paper = options.method == results::Method::kPaper;
  if (paper && options.initial)
    return InputError(
        "--initial: not with --method paper, which takes its start from the pictures");
  const model::ModelChoice& model = options.model;
  if (paper && (model.lights || model.diffuse || model.specular || model.near))
    return InputError(
        "--model: not with --method paper, whose model is fixed: Lambert, Phong, near lights");
  if (model.lights && options.initial)
    return InputError("--model lights=" + std::to_string(*model.lights) +
                      ": not with --initial, whose lights are taken");
  if (!paper && options.ceiling_distance_m)
    return InputError("--ceiling-distance: with --method paper only; " +
                      results::WordOf(options.method) + " finds distances from the pictures");
  return {};
}

// What is read of a session.
struct Loaded {
  rig::Session session;
  std::optional<rig::RigCalibration> calibration;
  std::vector<std::size_t> chosen;  // frames
  std::vector<model::Keyframe> keyframes;
  target::Geometry geometry;
  std::optional<rig::ClosureCheck> closure;
};

Result<Loaded> Load(const std::filesystem::path& folder, const Options& options, Stages& stages) {
  auto session = rig::ReadSession(folder);
  if (!session) return Forward(session);
  if (const Status status = CheckMethod(options); !status) return Forward(status);
  auto chosen = ChooseFrames(*session, options);
  if (!chosen) return Forward(chosen);
  auto calibration = rig::ReadSessionCalibration(*session);
  if (!calibration) return Forward(calibration);
  auto shape = rig::ReadTarget(*session);
  if (!shape) return Forward(shape);
  auto keyframes = LoadKeyframes(*session, *chosen, options.stop, stages);
  if (!keyframes) return Forward(keyframes);
  target::Geometry geometry(std::move(*shape));
  auto closure = rig::CheckClosure(folder);
  if (!closure) return Forward(closure);
  if (*closure && options.on_closure) options.on_closure(**closure);
  return Loaded{std::move(*session),   std::move(*calibration), std::move(*chosen),
                std::move(*keyframes), std::move(geometry),     std::move(*closure)};
}

Result<EstimateOutput> EstimateByPaper(const Loaded& loaded, const calib::RayGrid& rays,
                                       const Options& options, const Watch& watch) {
  const auto distance = FromMetres(options.ceiling_distance_m.value_or(kCeilingDistanceM),
                                   loaded.session.length_unit);
  if (!distance) return Forward(distance);
  baseline::PaperOptions paper;
  paper.ceiling_distance = *distance;
  paper.frame_numbers = loaded.chosen;
  paper.up = baseline::PaperUp(loaded.keyframes, loaded.geometry);
  return baseline::EstimateByPaper(loaded.keyframes, loaded.geometry, rays, paper, watch);
}

Stage StageOf(Part part) {
  switch (part) {
    case Part::kObserve:
      return Stage::kObserving;
    case Part::kStart:
      return Stage::kStarting;
    case Part::kRefine:
      return Stage::kRefining;
    case Part::kBudget:
      return Stage::kBudget;
  }
  return Stage::kRefining;
}

Result<EstimateOutput> EstimateLoaded(const Loaded& loaded, const Options& options,
                                      Stages& stages) {
  const calib::RayGrid rays(*loaded.session.camera);
  const Watch watch{options.stop, [&](Part part) { stages.Begin(StageOf(part)); }};
  if (options.method == results::Method::kPaper)
    return EstimateByPaper(loaded, rays, options, watch);
  EstimateOptions estimate;
  estimate.initial = options.initial;
  estimate.model = options.model;
  estimate.frame_numbers = loaded.chosen;
  estimate.watch = watch;
  std::optional<CalibrationErrors> errors;
  if (loaded.calibration) {
    errors = ErrorsOf(*loaded.calibration, loaded.session, loaded.chosen, loaded.geometry);
    if (!errors->items.empty()) estimate.calibration = &*errors;
  }
  return EstimateScene(loaded.keyframes, loaded.geometry, rays, estimate);
}

}  // namespace

Result<SessionEstimate> EstimateSession(const std::filesystem::path& folder,
                                        const Options& options) {
  const Stopwatch stopwatch;
  Stages stages(options);
  auto loaded = Load(folder, options, stages);
  if (!loaded) return Forward(loaded);
  const double load_s = stopwatch.Seconds();
  auto output = EstimateLoaded(*loaded, options, stages);
  if (!output) return Forward(output);
  stages.End();
  if (loaded->closure && !loaded->closure->closed)
    output->estimate.notes.push_back({"closure-open", loaded->closure->text});
  return SessionEstimate{std::move(loaded->session),  std::move(loaded->keyframes),
                         std::move(loaded->geometry), std::move(*output),
                         std::move(loaded->closure),  load_s};
}

}  // namespace turnlight::estimator::from_session
