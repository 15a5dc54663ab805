#include "estimator/from_session/session_estimate.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "base/format.h"
#include "base/stopwatch.h"
#include "calib/camera_model.h"
#include "estimator/baseline/paper_estimate.h"
#include "estimator/from_session/calibration_errors.h"
#include "estimator/from_session/candidate_views.h"
#include "estimator/from_session/frame_doubts.h"
#include "estimator/from_session/session_keyframe.h"
#include "estimator/memory_need.h"
#include "estimator/residual_maps.h"
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
  // One more part of the stage is done.
  void Step() {
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

// Some of a session's frames.
struct Chosen {
  std::vector<std::size_t> frames;
  model::KeyframeSource keyframes;
  // What their files say; filled in as they are read.
  std::shared_ptr<std::vector<rig::PictureFacts>> facts;
};

Chosen Choose(const std::shared_ptr<const rig::Session>& session, std::vector<std::size_t> frames) {
  Chosen out{std::move(frames), {}, nullptr};
  out.facts = std::make_shared<std::vector<rig::PictureFacts>>(out.frames.size());
  for (const std::size_t i : out.frames)
    out.keyframes.poses.push_back({session->frames[i].X_WC, session->frames[i].X_WT});
  out.keyframes.read = [session, frames = out.frames,
                        facts = out.facts](std::size_t k) -> Result<model::Keyframe> {
    return ReadKeyframe(*session, frames[k], &(*facts)[k]);
  };
  return out;
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

Status CheckOptions(const Options& options) {
  if (options.most_pixels < kFewestPixels || options.most_pixels > kMostPixelsAllowed)
    return InputError(Format("--pixels: %zu, allowed are %zu to %zu", options.most_pixels,
                             kFewestPixels, kMostPixelsAllowed));
  const bool paper = options.method == results::Method::kPaper;
  if (paper && options.initial)
    return InputError(
        "--initial: not with --method paper, which takes its start from the pictures");
  if (options.wanted_direction_sigma && !options.next_view)
    return InputError("--wanted-deg: with --next-view only, which says what it takes");
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

// Whether the estimate would fit into what it may take.
Status CheckFits(const rig::Session& session, const model::KeyframeSource& keyframes,
                 const target::Geometry& geometry, const Options& options) {
  if (!options.max_memory) return {};
  MemoryInputs inputs;
  const calib::CameraModel& camera = *session.camera;
  inputs.picture_pixels = static_cast<std::size_t>(camera.width()) * camera.height();
  inputs.keyframes = keyframes.size();
  inputs.target_pixels = TargetPixels(keyframes, geometry, camera);
  inputs.most_pixels = options.most_pixels;
  inputs.casts_shadows = geometry.CanShadowItself();
  inputs.noise_known = session.radiometry.noise.has_value();
  if (const auto* mesh = std::get_if<calib::MeshShape>(&geometry.shape()))
    inputs.mesh_faces = mesh->faces.size();
  inputs.pictures = static_cast<bool>(options.residuals_of);
  return CheckMemory(inputs, *options.max_memory);
}

// What is read of a session, but for its pictures.
struct Loaded {
  std::shared_ptr<const rig::Session> session;
  std::optional<rig::RigCalibration> calibration;
  target::Geometry geometry;
  std::optional<rig::ClosureCheck> closure;
  std::vector<std::string> repairs;  // of the mesh
  Chosen chosen;
};

Result<Loaded> Load(const std::filesystem::path& folder, const Options& options) {
  auto read = rig::ReadSession(folder);
  if (!read) return Forward(read);
  const auto session = std::make_shared<const rig::Session>(std::move(*read));
  if (const Status status = CheckOptions(options); !status) return Forward(status);
  auto frames = ChooseFrames(*session, options);
  if (!frames) return Forward(frames);
  auto calibration = rig::ReadSessionCalibration(*session);
  if (!calibration) return Forward(calibration);
  std::vector<std::string> repairs;
  auto shape = rig::ReadTarget(*session, &repairs);
  if (!shape) return Forward(shape);
  Chosen chosen = Choose(session, std::move(*frames));
  target::Geometry geometry(std::move(*shape));
  if (const Status status = CheckFits(*session, chosen.keyframes, geometry, options); !status)
    return Forward(status);
  auto closure = rig::CheckClosure(folder);
  if (!closure) return Forward(closure);
  if (*closure && options.on_closure) options.on_closure(**closure);
  return Loaded{session,
                std::move(*calibration),
                std::move(geometry),
                std::move(*closure),
                std::move(repairs),
                std::move(chosen)};
}

Result<EstimateOutput> EstimateByPaper(const Loaded& loaded, const Chosen& chosen,
                                       const calib::RayGrid& rays, const Options& options,
                                       const EstimateOptions& estimate) {
  const auto distance = FromMetres(options.ceiling_distance_m.value_or(kCeilingDistanceM),
                                   loaded.session->length_unit);
  if (!distance) return Forward(distance);
  baseline::PaperOptions paper;
  paper.ceiling_distance = *distance;
  paper.frame_numbers = chosen.frames;
  paper.up = baseline::PaperUp(chosen.keyframes.poses, loaded.geometry);
  return baseline::EstimateByPaper(chosen.keyframes, loaded.geometry, rays, paper, estimate);
}

Stage StageOf(Part part) {
  switch (part) {
    case Part::kObserve:
      return Stage::kReading;
    case Part::kStart:
      return Stage::kStarting;
    case Part::kRefine:
      return Stage::kRefining;
    case Part::kBudget:
      return Stage::kBudget;
  }
  return Stage::kRefining;
}

// copies (optional) receives the keyframes.
Result<EstimateOutput> EstimateLoaded(const Loaded& loaded, const Chosen& chosen,
                                      const calib::RayGrid& rays, const Options& options,
                                      Stages& stages, SmallCopies* copies) {
  EstimateOptions estimate;
  estimate.most_pixels = options.most_pixels;
  estimate.residuals_of = options.residuals_of;
  estimate.watch.stop = options.stop;
  estimate.watch.on_part = [&](Part part) {
    stages.Begin(StageOf(part), part == Part::kObserve ? chosen.keyframes.size() : 1);
  };
  estimate.watch.on_keyframe = [&](std::size_t k, const model::Keyframe& keyframe) {
    if (copies) copies->Take(k, keyframe);
    stages.Step();
  };
  if (options.method == results::Method::kPaper)
    return EstimateByPaper(loaded, chosen, rays, options, estimate);
  estimate.initial = options.initial;
  estimate.model = options.model;
  estimate.frame_numbers = chosen.frames;
  std::optional<CalibrationErrors> errors;
  if (loaded.calibration) {
    errors = ErrorsOf(*loaded.calibration, *loaded.session, chosen.frames, loaded.geometry);
    if (!errors->items.empty()) estimate.calibration = &*errors;
  }
  return EstimateScene(chosen.keyframes, loaded.geometry, rays, estimate);
}

std::vector<std::size_t> Without(const std::vector<std::size_t>& frames,
                                 const std::vector<std::size_t>& views) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < frames.size(); ++k)
    if (!std::binary_search(views.begin(), views.end(), k)) out.push_back(frames[k]);
  return out;
}

// Of the first of them, as each takes the memory of a picture.
Result<std::map<std::size_t, cv::Mat1f>> MapsOfLeftOut(const Loaded& loaded,
                                                       const calib::RayGrid& rays,
                                                       const std::vector<std::size_t>& views,
                                                       const model::Scene& scene) {
  std::map<std::size_t, cv::Mat1f> out;
  for (std::size_t i = 0; i < std::min(views.size(), kMostLeftOutMaps); ++i) {
    const auto keyframe = loaded.chosen.keyframes.read(views[i]);
    if (!keyframe) return Forward(keyframe);
    out.emplace(loaded.chosen.frames[views[i]],
                ResidualMapOf(*keyframe, loaded.geometry, rays, scene));
  }
  return out;
}

// The estimate with a note, or its refusal with the note's words.
Result<EstimateOutput> With(const Note& note, Result<EstimateOutput> output) {
  if (output) {
    output->estimate.notes.push_back(note);
  } else if (output.error().kind == ErrorKind::kNoEstimate) {
    return NoEstimateError(output.error().text + " " + note.text);
  }
  return output;
}

// An estimate, or a refusal, that leaves doubts: frames that do not belong to the others are left
// out and it is made anew; a change of all poses that explains the pictures is told.
Result<EstimateOutput> LookCloser(Loaded& loaded, const calib::RayGrid& rays,
                                  const Options& options, const SmallCopies& copies,
                                  Result<EstimateOutput> output, Stages& stages) {
  stages.Begin(Stage::kChecking);
  const consistency::Consistency found = consistency::CheckConsistency(
      copies.views(), copies.angles_deg(), loaded.geometry, options.model, false, options.stop);
  if (StopRequested(options.stop)) return InterruptedError();
  if (found.change) return With({"poses-doubtful", WordsOfChange(found)}, std::move(output));
  const std::vector<std::size_t> odd = OddViews(found);
  if (odd.empty()) return output;
  const bool by_hand = !options.frames.empty();
  const Note note = NoteOfOddFrames(*loaded.session, loaded.chosen.frames, found, !by_hand);
  if (by_hand) return With(note, std::move(output));
  if (output) *output = {};  // its maps are large
  Chosen rest = Choose(loaded.session, Without(loaded.chosen.frames, odd));
  auto better = EstimateLoaded(loaded, rest, rays, options, stages, nullptr);
  if (better && options.residuals_of) {
    auto maps = MapsOfLeftOut(loaded, rays, odd, model::WithoutFactors(better->estimate.ToScene()));
    if (!maps) return Forward(maps);
    better->left_out = std::move(*maps);
  }
  loaded.chosen = std::move(rest);
  return With(note, std::move(better));
}

Result<EstimateOutput> EstimateChecked(Loaded& loaded, const Options& options, Stages& stages) {
  const calib::RayGrid rays(*loaded.session->camera);
  if (options.method == results::Method::kPaper)
    return EstimateLoaded(loaded, loaded.chosen, rays, options, stages, nullptr);
  SmallCopies copies(*loaded.session, loaded.chosen.frames, loaded.chosen.keyframes.poses,
                     loaded.geometry);
  auto output = EstimateLoaded(loaded, loaded.chosen, rays, options, stages, &copies);
  const bool doubtful = output ? CallsForACheck(*output, copies.views(), loaded.geometry)
                               : output.error().kind == ErrorKind::kNoEstimate && copies.full();
  return doubtful ? LookCloser(loaded, rays, options, copies, std::move(output), stages)
                  : std::move(output);
}

// Of pictures as the session's first one is; its sigmas are those of the estimate.
Result<std::optional<ViewAdvice>> Advise(const Loaded& loaded, const Estimate& estimate,
                                         const Options& options) {
  if (!options.next_view) return std::optional<ViewAdvice>();
  const rig::Session& session = *loaded.session;
  const auto first = rig::ReadFrameImages(session, loaded.chosen.frames.front());
  if (!first) return Forward(first);
  NextViewOptions ask;
  ask.wanted = options.wanted_direction_sigma;
  ask.stop = options.stop;
  auto advice = AdviseOrSayWhy(estimate, CandidatesOf(session, loaded.chosen.frames),
                               loaded.geometry, calib::RayGrid(*session.camera),
                               {session.radiometry, first->image.depth()}, ask);
  if (!advice) return Forward(advice);
  return std::optional(std::move(*advice));
}

// Where there is no estimate, what the pictures say may be why.
Error WithNotes(Error error, const std::vector<rig::PictureNote>& notes) {
  if (error.kind != ErrorKind::kNoEstimate) return error;
  for (const rig::PictureNote& note : notes)
    error.text += (error.text.ends_with('.') ? " Besides: " : ". Besides: ") + note.text;
  return error;
}

}  // namespace

Result<SessionEstimate> EstimateSession(const std::filesystem::path& folder,
                                        const Options& options) {
  const Stopwatch stopwatch;
  Stages stages(options);
  auto loaded = Load(folder, options);
  if (!loaded) return Forward(loaded);
  const double load_s = stopwatch.Seconds();
  auto output = EstimateChecked(*loaded, options, stages);
  auto notes = rig::PictureNotes(loaded->session->radiometry, *loaded->chosen.facts);
  if (!output) return tl::unexpected(WithNotes(output.error(), notes));
  stages.End();
  auto next_view = Advise(*loaded, output->estimate, options);
  if (!next_view) return Forward(next_view);
  for (rig::PictureNote& note : notes)
    output->estimate.notes.push_back({std::move(note.code), std::move(note.text)});
  if (loaded->closure && !loaded->closure->closed)
    output->estimate.notes.push_back({"closure-open", loaded->closure->text});
  for (const std::string& repair : loaded->repairs)
    output->estimate.notes.push_back({"mesh-repaired", repair});
  return SessionEstimate{*loaded->session,
                         std::move(loaded->chosen.keyframes),
                         std::move(loaded->geometry),
                         std::move(*output),
                         std::move(loaded->closure),
                         std::move(*next_view),
                         load_s};
}

}  // namespace turnlight::estimator::from_session
