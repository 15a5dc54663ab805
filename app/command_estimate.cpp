#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/exit_code.h"
#include "app/frame_list.h"
#include "app/session_estimate.h"
#include "base/angles.h"
#include "estimator/memory_need.h"
#include "estimator/results/model_option.h"
#include "estimator/results/words.h"

namespace turnlight::app {
namespace {

struct EstimateArguments {
  std::string session;
  std::string out;
  WriteOptions options;
  std::string method = estimator::results::WordOf(estimator::results::Method::kLeastSquares);
  std::vector<std::string> model;
  std::optional<std::size_t> pixels;
  std::string max_memory;
  std::optional<std::string> frames;
  std::optional<double> wanted_deg;
  bool no_pictures = false;
  bool json = false;
};

int EstimateAndPrint(const EstimateArguments& arguments) {
  WriteOptions options = arguments.options;
  options.estimate.method =
      *estimator::results::ValueOf<estimator::results::Method>(arguments.method);
  options.pictures = !arguments.no_pictures;
  if (arguments.pixels) options.estimate.most_pixels = *arguments.pixels;
  if (!arguments.max_memory.empty()) {
    const auto bytes = estimator::BytesOf(arguments.max_memory);
    if (!bytes) return Fail(bytes.error());
    options.estimate.max_memory = *bytes;
  }
  if (arguments.wanted_deg)
    options.estimate.wanted_direction_sigma = DegToRad(*arguments.wanted_deg);
  for (const std::string& option : arguments.model)
    if (const Status status = estimator::results::ApplyModelOption(option, options.estimate.model);
        !status)
      return Fail(status.error());
  if (arguments.frames) {
    auto frames = ParseFrames(*arguments.frames);
    if (!frames) return Fail(frames.error());
    options.estimate.frames = std::move(*frames);
  }
  const auto done = WriteEstimate(arguments.session, arguments.out, options);
  if (!done) return Fail(done.error());
  std::cout << (arguments.json ? done->json : done->summary) << std::flush;
  return kDone;
}

void AddFrameChoice(CLI::App& command, EstimateArguments& arguments) {
  command
      .add_option("--views", arguments.options.estimate.views,
                  "Use N frames spread over the session's F: frames floor(i F / N)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000));
  command
      .add_option("--frames", arguments.frames,
                  "Use these frames: numbers and ranges, counted from 0, such as 0-16,18-35; not "
                  "with --views")
      ->type_name("LIST");
}

void AddNextView(CLI::App& command, EstimateArguments& arguments) {
  command.add_flag("--next-view", arguments.options.estimate.next_view,
                   "Say which view, between those that are there or beyond them, would make the "
                   "least known light's direction better known, and to what");
  command
      .add_option("--wanted-deg", arguments.wanted_deg,
                  "With --next-view: also how many further views would make every direction known "
                  "to so many degrees (one sigma)")
      ->type_name("DEGREES")
      ->check(CLI::Range(1e-6, 90.0));
}

}  // namespace

void AddEstimate(CLI::App& program, Action& action) {
  CLI::App* command =
      AddCommand(program, "estimate",
                 "Estimate the lights and the reflectance of a session's target, with error bars",
                 "turnlight estimate my_session --out result");
  auto arguments = std::make_shared<EstimateArguments>();
  command->add_option("SESSION", arguments->session, "The session's folder")->required();
  AddOut(*command, arguments->out, "Folder for result.json and pictures");
  command
      ->add_option("--method", arguments->method,
                   "lm (default): least squares over all parameters together; paper: the published "
                   "baseline, lights' directions from the intensity map and steepest descent")
      ->type_name("NAME")
      ->check(CLI::IsMember(estimator::results::AllWords<estimator::results::Method>()));
  command
      ->add_option("--ceiling-distance", arguments->options.estimate.ceiling_distance_m,
                   "With --method paper: the distance that its lights start from and that says how "
                   "bright they are, in metres (default 2.5)")
      ->type_name("METRES")
      ->check(CLI::Range(1e-6, 1e6));
  AddFrameChoice(*command, *arguments);
  AddPixels(*command, arguments->pixels);
  AddNextView(*command, *arguments);
  command
      ->add_option("--max-memory", arguments->max_memory,
                   "Refuse beforehand what would need more than that, and say what would fit, such "
                   "as 4GB or 800MB; changes no result")
      ->type_name("SIZE");
  command
      ->add_option("--initial", arguments->options.initial,
                   "Start from the lights of a truth.json or result.json")
      ->type_name("FILE");
  command
      ->add_option("--model", arguments->model,
                   "Decide what the data otherwise decide: " +
                       estimator::results::ModelOptionHelp() + "; may be repeated")
      ->type_name("KEY=VALUE");
  command->add_flag("--no-pictures", arguments->no_pictures, "Write result.json only");
  command->add_flag("--json", arguments->json,
                    "Print result.json on standard output and nothing else there");
  command->callback(
      [arguments, &action] { action = [arguments] { return EstimateAndPrint(*arguments); }; });
}

}  // namespace turnlight::app
