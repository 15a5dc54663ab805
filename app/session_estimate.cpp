#include "app/session_estimate.h"

#include <chrono>
#include <map>
#include <utility>
#include <vector>

#include "app/closure.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/pictures_out.h"
#include "app/progress.h"
#include "app/result_json.h"
#include "app/summary.h"
#include "base/file.h"
#include "base/format.h"
#include "base/parallel.h"
#include "estimator/baseline/paper_estimate.h"
#include "estimator/estimate.h"
#include "rig/session/session.h"
#include "rig/sim/scene_file.h"

namespace turnlight::app {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Frames floor(i F / N).
Result<std::vector<std::size_t>> ChooseFrames(const rig::Session& session,
                                              const std::optional<int>& views) {
  const std::size_t all = session.frames.size();
  const std::size_t count = views ? static_cast<std::size_t>(*views) : all;
  if (count > all)
    return InputError("--views: " + std::to_string(count) + ", allowed are at most the session's " +
                      std::to_string(all) + " frames");
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(i * all / count);
  return chosen;
}

// The first refusal in the order of the frames, whatever thread found it.
Result<std::vector<estimator::model::Keyframe>> LoadKeyframes(
    const rig::Session& session, const std::vector<std::size_t>& chosen) {
  std::vector<estimator::model::Keyframe> keyframes(chosen.size());
  std::vector<Status> statuses(chosen.size());
  Progress progress("reading", chosen.size());
  ParallelFor(chosen.size(), [&](std::size_t i) {
    const rig::FrameRecord& frame = session.frames[chosen[i]];
    const auto images = rig::ReadFrameImages(session, chosen[i]);
    if (!images) {
      statuses[i] = Forward(images);
      return;
    }
    keyframes[i] = {calib::Linearise(images->image, session.radiometry, frame.exposure),
                    images->mask, frame.X_WC, frame.X_WT};
    progress.Step();
  });
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

Status CheckMethod(const SessionEstimateOptions& given) {
  const bool paper = given.method == "paper";
  if (paper && !given.initial.empty())
    return InputError(
        "--initial: not with --method paper, which takes its start from the pictures");
  const estimator::model::ModelChoice& model = given.model;
  if (paper && (model.lights || model.diffuse || model.specular || model.near))
    return InputError(
        "--model: not with --method paper, whose model is fixed: Lambert, Phong, near lights");
  if (model.lights && !given.initial.empty())
    return InputError("--model lights=" + std::to_string(*model.lights) +
                      ": not with --initial, whose lights are taken");
  if (!paper && given.ceiling_distance_m)
    return InputError("--ceiling-distance: with --method paper only; " + given.method +
                      " finds distances from the pictures");
  return {};
}

// What the paper's method needs to know of the session.
Result<estimator::baseline::PaperOptions> MakePaperOptions(
    const SessionEstimateOptions& given, const rig::Session& session,
    const std::vector<estimator::model::Keyframe>& keyframes,
    const estimator::target::Geometry& geometry) {
  const auto distance =
      FromMetres(given.ceiling_distance_m.value_or(kCeilingDistanceM), session.length_unit);
  if (!distance) return Forward(distance);
  estimator::baseline::PaperOptions options;
  options.ceiling_distance = *distance;
  options.up = estimator::baseline::PaperUp(keyframes, geometry);
  return options;
}

Result<estimator::EstimateOptions> MakeOptions(const SessionEstimateOptions& given) {
  if (const Status status = CheckMethod(given); !status) return Forward(status);
  estimator::EstimateOptions options;
  options.model = given.model;
  if (given.initial.empty()) return options;
  auto guess = rig::sim::ReadInitialGuess(given.initial);
  if (!guess) return Forward(guess);
  options.initial = std::move(*guess);
  return options;
}

Result<estimator::EstimateOutput> EstimateBy(
    const SessionEstimateOptions& given, const rig::Session& session,
    const std::vector<estimator::model::Keyframe>& keyframes,
    const estimator::target::Geometry& geometry, const calib::RayGrid& rays,
    const estimator::EstimateOptions& options) {
  if (given.method != "paper") return estimator::EstimateScene(keyframes, geometry, rays, options);
  const auto paper = MakePaperOptions(given, session, keyframes, geometry);
  if (!paper) return Forward(paper);
  return estimator::baseline::EstimateByPaper(keyframes, geometry, rays, *paper);
}

struct Computed {
  rig::Session session;
  std::vector<estimator::model::Keyframe> keyframes;
  estimator::target::Geometry geometry;
  estimator::EstimateOutput output;
  std::optional<rig::ClosureCheck> closure;
  double load_s = 0.0;
};

Result<Computed> Compute(const std::filesystem::path& folder, const SessionEstimateOptions& options,
                         Clock::time_point start) {
  const InterruptAtOnce nothing_written;
  auto session = rig::ReadSession(folder);
  if (!session) return Forward(session);
  auto estimator_options = MakeOptions(options);
  if (!estimator_options) return Forward(estimator_options);
  const auto chosen = ChooseFrames(*session, options.views);
  if (!chosen) return Forward(chosen);
  auto shape = rig::ReadTarget(*session);
  if (!shape) return Forward(shape);
  auto keyframes = LoadKeyframes(*session, *chosen);
  if (!keyframes) return Forward(keyframes);
  estimator::target::Geometry geometry(std::move(*shape));
  const calib::RayGrid rays(*session->camera);
  auto closure = TellClosure(folder);
  if (!closure) return Forward(closure);
  const double load_s = SecondsSince(start);
  auto output = EstimateBy(options, *session, *keyframes, geometry, rays, *estimator_options);
  if (!output) return Forward(output);
  if (*closure && !(*closure)->closed)
    output->estimate.notes.push_back({"closure-open", (*closure)->text});
  return Computed{std::move(*session), std::move(*keyframes), std::move(geometry),
                  std::move(*output),  std::move(*closure),   load_s};
}

}  // namespace

Result<SessionEstimate> EstimateSession(const std::filesystem::path& session,
                                        const std::filesystem::path& out,
                                        const SessionEstimateOptions& options) {
  const Clock::time_point start = Clock::now();
  if (const Status status = CheckOutputFolder(out, session); !status) return Forward(status);
  const auto computed = Compute(session, options, start);
  if (!computed) return Forward(computed);
  const estimator::Estimate& estimate = computed->output.estimate;
  if (const Status status = MakeDirectory(out); !status) return Forward(status);
  std::size_t pictures = 0;
  if (options.pictures) {
    const auto written = WritePictures(computed->keyframes, computed->geometry,
                                       *computed->session.camera, computed->output, out);
    if (!written) return Forward(written);
    pictures = *written;
  }
  const RunTimes times{computed->load_s, SecondsSince(start)};
  SessionEstimate done;
  done.closure = computed->closure;
  done.json = ResultToJson(estimate, computed->session.name, options.method, times).dump(1) + "\n";
  if (const Status status = WriteFileAtomic(out / "result.json", done.json); !status)
    return Forward(status);
  done.summary = Summary(estimate, computed->session.name, computed->session.length_unit) + "\n" +
                 (out / "result.json").string() +
                 (pictures > 0 ? " and " + std::to_string(pictures) + " pictures beside it" : "") +
                 " written\n";
  return done;
}

}  // namespace turnlight::app
