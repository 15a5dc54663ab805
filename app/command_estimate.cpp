#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "app/command.h"
#include "app/interrupt.h"
#include "app/pictures_out.h"
#include "app/progress.h"
#include "app/result_json.h"
#include "app/summary.h"
#include "base/file.h"
#include "base/parallel.h"
#include "estimator/estimate.h"
#include "rig/session/session.h"
#include "rig/sim/scene_file.h"

namespace turnlight::app {
namespace {

using Clock = std::chrono::steady_clock;

struct EstimateArguments {
  std::string session;
  std::string out;
  std::string method = "lm";
  std::optional<int> views;
  std::string initial;
  bool no_pictures = false;
  bool json = false;
};

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
Result<std::vector<estimator::Keyframe>> LoadKeyframes(const rig::Session& session,
                                                       const std::vector<std::size_t>& chosen) {
  std::vector<estimator::Keyframe> keyframes(chosen.size());
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

Result<estimator::EstimateOptions> MakeOptions(const EstimateArguments& arguments) {
  estimator::EstimateOptions options;
  if (arguments.initial.empty()) return options;
  auto guess = rig::ReadInitialGuess(arguments.initial);
  if (!guess) return Forward(guess);
  options.initial = std::move(*guess);
  return options;
}

struct Computed {
  rig::Session session;
  std::vector<estimator::Keyframe> keyframes;
  estimator::Geometry geometry;
  estimator::EstimateOutput output;
  double load_s = 0.0;
};

Result<Computed> Compute(const EstimateArguments& arguments, Clock::time_point start) {
  const InterruptAtOnce nothing_written;
  auto session = rig::ReadSession(arguments.session);
  if (!session) return Forward(session);
  const auto options = MakeOptions(arguments);
  if (!options) return Forward(options);
  const auto chosen = ChooseFrames(*session, arguments.views);
  if (!chosen) return Forward(chosen);
  auto shape = rig::ReadTarget(*session);
  if (!shape) return Forward(shape);
  auto keyframes = LoadKeyframes(*session, *chosen);
  if (!keyframes) return Forward(keyframes);
  estimator::Geometry geometry(std::move(*shape));
  const calib::RayGrid rays(*session->camera);
  const double load_s = SecondsSince(start);
  auto output = estimator::EstimateScene(*keyframes, geometry, rays, *options);
  if (!output) return Forward(output);
  return Computed{std::move(*session), std::move(*keyframes), std::move(geometry),
                  std::move(*output), load_s};
}

int Estimate(const EstimateArguments& arguments) {
  const Clock::time_point start = Clock::now();
  const std::filesystem::path out = arguments.out;
  if (const Status status = CheckOutputFolder(out, arguments.session); !status)
    return Fail(status.error());
  const auto computed = Compute(arguments, start);
  if (!computed) return Fail(computed.error());
  const estimator::Estimate& estimate = computed->output.estimate;
  if (const Status status = MakeDirectory(out); !status) return Fail(status.error());
  std::size_t pictures = 0;
  if (!arguments.no_pictures) {
    const auto written = WritePictures(computed->keyframes, computed->geometry,
                                       *computed->session.camera, computed->output, out);
    if (!written) return Fail(written.error());
    pictures = *written;
  }
  const RunTimes times{computed->load_s, SecondsSince(start)};
  const std::string text =
      ResultToJson(estimate, computed->session.name, arguments.method, times).dump(1) + "\n";
  if (const Status status = WriteFileAtomic(out / "result.json", text); !status)
    return Fail(status.error());
  if (arguments.json) {
    std::cout << text << std::flush;
    return kDone;
  }
  std::cout << Summary(estimate, computed->session.name, computed->session.length_unit) << "\n"
            << (out / "result.json").string();
  if (pictures > 0) std::cout << " and " << pictures << " pictures beside it";
  std::cout << " written" << std::endl;
  return kDone;
}

}  // namespace

void AddEstimate(CLI::App& program, Action& action) {
  CLI::App* command =
      AddCommand(program, "estimate",
                 "Estimate the lights and the reflectance of a session's target, with error bars",
                 "turnlight estimate my_session --out result");
  auto arguments = std::make_shared<EstimateArguments>();
  command->add_option("SESSION", arguments->session, "The session's folder")->required();
  command->add_option("--out", arguments->out, "Folder for result.json and pictures")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--method", arguments->method,
                   "lm (default): least squares over all parameters together")
      ->type_name("NAME")
      ->check(CLI::IsMember({"lm"}));
  command
      ->add_option("--views", arguments->views,
                   "Use N frames spread over the session's F: frames floor(i F / N)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000));
  command
      ->add_option("--initial", arguments->initial,
                   "Start from the lights of a truth.json or result.json")
      ->type_name("FILE");
  command->add_flag("--no-pictures", arguments->no_pictures, "Write result.json only");
  command->add_flag("--json", arguments->json,
                    "Print result.json on standard output and nothing else there");
  command->callback(
      [arguments, &action] { action = [arguments] { return Estimate(*arguments); }; });
}

}  // namespace turnlight::app
