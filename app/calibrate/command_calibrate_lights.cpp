#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/calibrate/calibrate_commands.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "base/file.h"
#include "base/format.h"
#include "calib/calibrate/probe/against.h"
#include "calib/calibrate/probe/lights.h"
#include "calib/calibrate/probe/lights_json.h"
#include "calib/calibrate/probe/pictures.h"
#include "calib/calibrate/probe/probe_session.h"
#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace probe = calib::calibrate::probe;

constexpr std::size_t kDrawnViews = 6;
constexpr std::uint64_t kMaxStatedBytes = 64 << 20;

struct LightsArguments {
  std::vector<std::string> sessions;  // the first, and those of --second
  std::vector<std::string> further;
  std::string out;
  std::string against;
  std::string calibration;
  bool sphere_from_outline = false;
  double center_sigma = 0.0;
  double radius_sigma = 0.0;
  bool json = false;
};

Result<probe::ProbeOptions> ReadOptions(const LightsArguments& arguments) {
  probe::ProbeOptions options;
  options.sphere_from_outline = arguments.sphere_from_outline;
  options.center_sigma = arguments.center_sigma;
  options.radius_sigma = arguments.radius_sigma;
  if (!arguments.calibration.empty()) {
    auto calibration = rig::ReadRigCalibration(arguments.calibration);
    if (!calibration) return Forward(calibration);
    options.calibration = std::move(*calibration);
  }
  return options;
}

Result<std::vector<probe::ProbeSession>> ReadSessions(const LightsArguments& arguments) {
  const auto options = ReadOptions(arguments);
  if (!options) return Forward(options);
  std::vector<probe::ProbeSession> sessions;
  for (const std::string& folder : arguments.sessions) {
    const auto checked = rig::ReadSession(folder);  // how many frames there are
    if (!checked) return Forward(checked);
    Progress progress("looking at the ball, " + checked->name, 2 * checked->frames.size());
    auto session = probe::ReadProbeSession(folder, *options, [&progress] {
      progress.Step();
      return !Interrupted();
    });
    if (!session) return Forward(session);
    sessions.push_back(std::move(*session));
    const std::string& unit = sessions.front().session->length_unit;
    if (sessions.back().session->length_unit != unit)
      return InputError(folder + ": length_unit: \"" + sessions.back().session->length_unit +
                        "\", allowed is that of " + arguments.sessions.front() + ", \"" + unit +
                        "\"");
  }
  return sessions;
}

Status WritePictures(const std::vector<probe::ProbeSession>& sessions, std::size_t views,
                     const probe::ProbeLights& found, const fs::path& out) {
  for (const std::size_t view : probe::ViewsToDraw(views, kDrawnViews))
    if (const Status status = rig::WriteImage(out / Format("spots_%03zu.png", view),
                                              probe::SpotsPicture(sessions, view, found));
        !status)
      return status;
  return rig::WriteImage(out / "sky.png",
                         probe::SkyPicture(sessions, found, sessions.front().session->length_unit));
}

std::string Report(const std::vector<probe::ProbeSession>& sessions,
                   const probe::ProbeLights& found) {
  std::string text;
  for (const probe::ProbeSession& session : sessions) {
    if (session.center_T)
      text +=
          session.session->name +
          Format(": ball's centre in T %.4g %.4g %.4g, sigma %.2g %.2g %.2g", session.center_T->x(),
                 session.center_T->y(), session.center_T->z(), session.center_sigma_T->x(),
                 session.center_sigma_T->y(), session.center_sigma_T->z()) +
          " " + session.session->length_unit + "\n";
    for (const std::string& note : session.notes)
      text += session.session->name + ": " + note + "\n";
  }
  text += Format("%zu light%s", found.lights.size(), found.lights.size() == 1 ? "" : "s") +
          (found.lights.empty() ? ": no compact highlight stands out on the ball\n" : "\n");
  for (std::size_t i = 0; i < found.lights.size(); ++i)
    text += "  " + probe::LightText(found.lights[i], i + 1, sessions.front().session->length_unit) +
            "\n";
  if (!found.candidates.empty()) text += "not called lights:\n";
  constexpr std::size_t kMostLines = 8;
  for (std::size_t i = 0; i < std::min(kMostLines, found.candidates.size()); ++i)
    text += "  " + probe::CandidateText(found.candidates[i]) + "\n";
  if (found.candidates.size() > kMostLines)
    text += Format("  and %zu more, see lights.json\n", found.candidates.size() - kMostLines);
  return text;
}

Result<probe::Agreement> Compare(const LightsArguments& arguments, const probe::ProbeLights& found,
                                 const std::string& unit) {
  const auto text = ReadFile(arguments.against, kMaxStatedBytes);
  if (!text) return Forward(text);
  const auto stated = probe::ReadStatedLights(*text, arguments.against);
  if (!stated) return Forward(stated);
  return probe::CompareLights(found.lights, *stated, unit);
}

std::string AgreementText(const probe::Agreement& agreement, const std::string& file) {
  std::string text = "against " + file + ": " +
                     (agreement.agrees ? "they agree within 3 sigmas\n" : "they differ\n");
  for (const probe::LightAgreement& light : agreement.lights) text += "  " + light.words + "\n";
  return text;
}

int CalibrateLights(LightsArguments arguments) {
  arguments.sessions.insert(arguments.sessions.end(), arguments.further.begin(),
                            arguments.further.end());
  for (const std::string& session : arguments.sessions)
    if (const Status status = CheckOutputFolder(arguments.out, session); !status)
      return Fail(status.error());
  const auto sessions = ReadSessions(arguments);
  if (!sessions) return Fail(sessions.error());
  const probe::ProbeInput input = probe::Joined(*sessions);
  const probe::ProbeLights found = probe::FindLights(input.views, input.spots, input.perturbations);
  std::optional<probe::Agreement> agreement;
  if (!arguments.against.empty()) {
    auto compared = Compare(arguments, found, sessions->front().session->length_unit);
    if (!compared) return Fail(compared.error());
    agreement = std::move(*compared);
  }
  const fs::path out = arguments.out;
  const std::string text = probe::LightsJson(found, *sessions, arguments.radius_sigma);
  Status status = MakeDirectory(out);
  if (status) status = WriteFileAtomic(out / probe::kLightsFile, text);
  if (status) status = WritePictures(*sessions, input.views.size(), found, out);
  if (!status) return Fail(status.error());
  std::cout << (arguments.json ? text : Report(*sessions, found));
  if (agreement)
    (arguments.json ? std::cerr : std::cout) << AgreementText(*agreement, arguments.against);
  std::cout << std::flush;
  return agreement && !agreement->agrees ? kDifferent : kDone;
}

void AddUncertainties(CLI::App& command, LightsArguments& arguments) {
  command
      .add_option("--center-sigma", arguments.center_sigma,
                  "Sigma of the ball's centre along each axis, in the session's unit (default 0); "
                  "outlines bring their own")
      ->type_name("LENGTH")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--radius-sigma", arguments.radius_sigma,
                  "Sigma of the ball's radius, in the session's unit (default 0)")
      ->type_name("LENGTH")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--calibration", arguments.calibration,
                  "A rig-calibration.json, whose covariances of the poses go into the sigmas")
      ->type_name("FILE");
}

}  // namespace

void AddCalibrateLights(CLI::App& calibrate, Action& action) {
  CLI::App* command = AddCommand(
      calibrate, "lights",
      "Where the lights are, measured with a mirror or glossy ball of known radius as the "
      "session's "
      "target: an independent check of an estimate. The lights stand still, the camera goes round "
      "or "
      "the table turns",
      "turnlight calibrate lights my_ball --sphere-from-outline --against result/result.json "
      "--out lights");
  auto arguments = std::make_shared<LightsArguments>();
  arguments->sessions.resize(1);
  command->add_option("SESSION", arguments->sessions.front(), "A session whose target is the ball")
      ->required();
  AddOut(*command, arguments->out, "Folder for lights.json and pictures");
  command
      ->add_option("--second", arguments->further,
                   "A session with a ball at another place in the same room: distances are known "
                   "better; may be repeated")
      ->type_name("SESSION")
      ->allow_extra_args(false);
  command->add_flag("--sphere-from-outline", arguments->sphere_from_outline,
                    "Find the ball from its outline, of the masks or in the pictures near where "
                    "the session has it");
  AddUncertainties(*command, *arguments);
  command
      ->add_option("--against", arguments->against,
                   "Compare with the lights of a result.json, a truth.json or a lights.json; exit "
                   "code 3 if they differ")
      ->type_name("FILE");
  command->add_flag("--json", arguments->json,
                    "Print lights.json on standard output and nothing else there");
  command->callback(
      [arguments, &action] { action = [arguments] { return CalibrateLights(*arguments); }; });
}

}  // namespace turnlight::app
