#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <opencv2/core.hpp>

#include "app/calibrate/board_options.h"
#include "app/calibrate/camera_option.h"
#include "app/calibrate/picture_files.h"
#include "app/calibrate/target_option.h"
#include "app/command.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "app/register_session.h"
#include "base/angles.h"
#include "base/file.h"
#include "base/format.h"
#include "base/printable.h"
#include "calib/calibrate/board/board_words.h"
#include "calib/calibrate/board/detect_boards.h"
#include "calib/calibrate/board/shown_board.h"
#include "calib/calibrate/handheld/board_plane.h"
#include "calib/calibrate/handheld/corners_file.h"
#include "calib/calibrate/handheld/registration.h"
#include "calib/rig_geometry.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace handheld = calib::calibrate::handheld;
namespace board = calib::calibrate::board;

// Of a corner that a person picked, as known beforehand.
constexpr double kPickedSigmaPx = 0.7;
constexpr double kWorstPickedRmsPx = 4.0;

struct RegisterArguments {
  std::vector<std::string> pictures;
  std::string camera, corners, out, name = "registered";
  board::BoardWords board;
  double step_deg = 10.0, turn_deg = 0.0;
  TargetWords target;
  std::vector<double> at{0.0, 0.0, 0.0};
  std::string encoding;  // encoding: empty: that of the pictures' format
  double black = 0.0;
  std::optional<double> white;
};

// What is seen in the pictures, and what that makes of W: the plane's frame B with z towards the
// camera's side.
struct Seen {
  std::vector<handheld::PlaneView> views;
  std::vector<fs::path> files;  // of each view
  calib::Pose X_WB;
  handheld::RegistrationOptions options;
};

// Of the lens's size.
Result<cv::Mat> ReadGrey(const fs::path& file, const calib::CameraModel& camera) {
  auto picture = ReadGreyPicture(file);
  if (!picture) return Forward(picture);
  const cv::Size size = picture->grey.size();
  if (size != cv::Size(camera.width(), camera.height()))
    return InputError(Format("%s: %d x %d pixels, allowed is the lens's size, %d x %d",
                             file.c_str(), size.width, size.height, camera.width(),
                             camera.height()));
  return std::move(picture->grey);
}

Result<Seen> SeeBoards(const RegisterArguments& arguments, const calib::CameraModel& camera) {
  const auto plate = board::ParseBoard(arguments.board);
  if (!plate) return Forward(plate);
  auto files = ListPictures(arguments.pictures);
  if (!files) return Forward(files);
  Seen seen;
  seen.files = std::move(*files);
  Progress progress("finding the board", seen.files.size());
  const auto found = board::DetectInPictures(
      seen.files.size(), [&](std::size_t i) { return ReadGrey(seen.files[i], camera); }, *plate,
      [&progress](std::size_t) { progress.Step(); });
  const handheld::BoardPlane plane = handheld::PlaneOf(*plate);
  std::vector<std::string> names;
  for (const fs::path& file : seen.files) names.push_back(file.string());
  if (const Status status = board::CheckShownBoard(names, found, *plate); !status)
    return Forward(status);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) return Forward(found[i]);
    seen.views.push_back(handheld::ViewOf(seen.files[i].string(), *found[i], plane));
  }
  seen.X_WB = plane.X_WB;
  seen.options = plane.options;
  return seen;
}

Result<Seen> SeeCorners(const handheld::CornersFile& corners, const fs::path& folder) {
  Seen seen;
  for (const handheld::PickedCorners& picked : corners.pictures) {
    seen.views.push_back(handheld::ViewOf(picked, corners.plane));
    seen.files.push_back(folder / picked.image);
  }
  seen.options.pixel_sigma = kPickedSigmaPx;
  seen.options.worst_rms_px = kWorstPickedRmsPx;
  return seen;
}

// Of JPEGs what their values nearly always are; of all else what measuring cameras give.
std::string EncodingOf(const RegisterArguments& arguments, bool jpeg) {
  return !arguments.encoding.empty() ? arguments.encoding : jpeg ? "srgb" : "linear";
}

Result<calib::Radiometry> RadiometryOf(const RegisterArguments& arguments, int depth, bool jpeg) {
  const std::string encoding = EncodingOf(arguments, jpeg);
  calib::Radiometry radiometry;
  radiometry.black = arguments.black;
  radiometry.white = arguments.white.value_or(depth == CV_8U    ? 255.0
                                              : depth == CV_16U ? 65535.0
                                                                : 1.0);
  if (!(radiometry.white > radiometry.black))
    return InputError(
        Format("--white: %g, allowed is above --black, %g", radiometry.white, radiometry.black));
  if (encoding == "srgb") radiometry.encoding = calib::Encoding::kSrgb;
  if (encoding == "linear" || encoding == "srgb") return radiometry;
  char* end = nullptr;
  radiometry.encoding = calib::Encoding::kGamma;
  radiometry.gamma = std::strtod(encoding.c_str(), &end);
  if (end == encoding.c_str() || *end || !(radiometry.gamma >= 0.1) || radiometry.gamma > 10.0)
    return InputError("--encoding: " + encoding +
                      ", allowed is linear, srgb or a gamma from 0.1 to 10");
  return radiometry;
}

double ShiftSigma(const handheld::PlanePose& pose) {
  return std::sqrt(pose.covariance.bottomRightCorner<3, 3>().trace());
}
double TurnSigmaDeg(const handheld::PlanePose& pose) {
  return RadToDeg(std::sqrt(pose.covariance.topLeftCorner<3, 3>().trace()));
}

void PrintViews(const std::vector<handheld::RegisteredView>& views) {
  std::cout << "     rms px  sigma mm  sigma deg  view change  picture\n";
  for (const handheld::RegisteredView& view : views) {
    if (!view.pose) {
      std::cout << "out                                           " << Printable(view.name) << ": "
                << Printable(view.why_left_out) << "\n";
      continue;
    }
    std::cout << Format("%-4s %6.2f  %8.2f  %9.3f  %7.1f deg  ", view.keyframe ? "key" : "",
                        view.pose->rms_px, ShiftSigma(*view.pose), TurnSigmaDeg(*view.pose),
                        view.view_change_deg)
              << Printable(view.name) << "\n";
  }
}

Result<HandheldSession> SessionOf(const RegisterArguments& arguments, const Seen& seen,
                                  const std::vector<handheld::RegisteredView>& views,
                                  HandheldSession session) {
  for (std::size_t i = 0; i < views.size(); ++i)
    if (views[i].keyframe)
      session.keyframes.push_back({seen.files[i], seen.X_WB * views[i].pose->X_CB.Inverse()});
  if (session.keyframes.empty())
    return InputError(
        "no picture could be registered, so that there is no session; the reasons "
        "are above");
  const auto first = ReadPicture(session.keyframes.front().picture);
  if (!first) return Forward(first);
  const auto jpegs =
      std::count_if(session.keyframes.begin(), session.keyframes.end(),
                    [](const HandheldKeyframe& keyframe) { return IsJpeg(keyframe.picture); });
  if (jpegs > 0 && jpegs < std::ssize(session.keyframes))
    return InputError(
        Format("%td of %zu keyframes are JPEG, allowed are all or none: their values "
               "mean different things",
               jpegs, session.keyframes.size()));
  auto radiometry = RadiometryOf(arguments, first->depth(), jpegs > 0);
  if (!radiometry) return Forward(radiometry);
  session.radiometry = *radiometry;
  if (jpegs > 0)
    std::cout << "note: JPEG has 8 bits, is compressed with loss and gamma encoded, which limits "
                 "what can be estimated; the session has the same values as PNG, encoding "
              << EncodingOf(arguments, true) << std::endl;
  return session;
}

// Target and what was seen of the plane, from either kind of input.
Result<Seen> See(const RegisterArguments& arguments, HandheldSession& session) {
  if (arguments.corners.empty()) {
    if (arguments.pictures.empty())
      return InputError("no pictures, allowed are one or more with --board, or --corners FILE");
    auto target = NamedTarget(arguments.target);
    if (!target) return Forward(target);
    session.target = std::move(*target);
    session.X_WT = calib::Turn(Eigen::Vector3d::UnitZ(), DegToRad(arguments.turn_deg));
    session.X_WT.translation = {arguments.at[0], arguments.at[1], arguments.at[2]};
    return SeeBoards(arguments, session.camera);
  }
  if (!arguments.pictures.empty() || !arguments.board.size.empty())
    return InputError(
        "--corners: it names the pictures and the target; allowed is either it or "
        "pictures with --board");
  const auto text = ReadFile(arguments.corners);
  if (!text) return Forward(text);
  const auto document = ParseYaml(*text, arguments.corners);
  if (!document) return Forward(document);
  const auto corners = handheld::ReadCorners(*document);
  if (!corners) return Forward(corners);
  session.target = corners->plane;
  return SeeCorners(*corners, fs::path(arguments.corners).parent_path());
}

// All but the writing.
Result<HandheldSession> Register(const RegisterArguments& arguments) {
  const InterruptAtOnce until_it_writes;
  if (const Status status = CheckNewFolder(arguments.out); !status) return Forward(status);
  auto lens = ReadCalibratedLens(arguments.camera);
  if (!lens) return Forward(lens);
  HandheldSession session{arguments.name, lens->camera, {}, {}, {}, {}};
  auto seen = See(arguments, session);
  if (!seen) return Forward(seen);
  seen->options.step_deg = arguments.step_deg;
  const auto views = handheld::RegisterViews(session.camera, seen->views,
                                             seen->X_WB.Inverse() * session.X_WT, seen->options);
  PrintViews(views);
  const auto found = std::count_if(views.begin(), views.end(),
                                   [](const auto& view) { return view.pose.has_value(); });
  std::cout << Format("%zu pictures, %td registered", views.size(), found) << std::endl;
  return SessionOf(arguments, *seen, views, std::move(session));
}

Status RegisterAndWrite(const RegisterArguments& arguments) {
  const auto session = Register(arguments);
  if (!session) return Forward(session);
  if (const Status status = WriteHandheldSession(*session, arguments.out); !status) return status;
  std::cout << Format("%zu keyframes of %g degrees of view change\n", session->keyframes.size(),
                      arguments.step_deg)
            << arguments.out << " is a session; turnlight estimate " << arguments.out
            << " --out result estimates the lights" << std::endl;
  return {};
}

void AddTargetOptions(CLI::App& command, RegisterArguments& arguments) {
  AddTargetShapeOptions(command, arguments.target);
  command
      .add_option("--at", arguments.at,
                  "Where the target's origin is in W, in mm (default 0,0,0): W's origin is the "
                  "middle of the board's points, x along its rows, z out of its printed side")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->expected(3);
  command.add_option("--turn", arguments.turn_deg, "The target turned about W's z, in degrees")
      ->type_name("DEG");
}

void AddPictureOptions(CLI::App& command, RegisterArguments& arguments) {
  command.add_option(
      "--encoding", arguments.encoding,
      "How the pictures' values follow the light: linear, srgb or a gamma (default: of "
      "JPEG srgb, else linear)");
  command.add_option("--black", arguments.black, "Value of no light")->capture_default_str();
  command.add_option("--white", arguments.white,
                     "Value of full light (default: 255, 65535, of floats 1)");
}

}  // namespace

void AddRegister(CLI::App& program, Action& action) {
  CLI::App* command = AddCommand(
      program, "register",
      "Make a session of pictures from a camera that was carried round the target: the pose of "
      "each from a "
      "board in view, or from the four corners of a flat target; a keyframe for each 10 degrees of "
      "view change. Lengths are in mm",
      "turnlight register walk/*.png --camera lens --board 10x10 --square-mm 10 --sphere 25 --at "
      "0,0,25 --out session");
  auto arguments = std::make_shared<RegisterArguments>();
  command->add_option("PICTURES", arguments->pictures,
                      "Files or folders: PNG, TIFF or JPEG, in the order in which they were taken");
  command
      ->add_option("--camera", arguments->camera,
                   "The lens: the folder of calibrate intrinsics, or a .cameramodel")
      ->type_name("DIR|FILE")
      ->required();
  AddBoardOptions(*command, arguments->board);
  for (const char* option : {"--board", "--square-mm"})
    command->get_option(option)->required(false);
  command
      ->add_option("--corners", arguments->corners,
                   "Instead of a board: picked corners of a flat target (YAML: size: [W, H], "
                   "pictures: [{image, corners: four [x, y] from the top left, clockwise}])")
      ->type_name("FILE");
  AddTargetOptions(*command, *arguments);
  AddPictureOptions(*command, *arguments);
  command
      ->add_option("--step-deg", arguments->step_deg, "View change from one keyframe to the next")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 180.0));
  command->add_option("--name", arguments->name, "Of the session")->capture_default_str();
  AddOut(*command, arguments->out, "The session, a new or empty folder");
  command->callback([arguments, &action] {
    action = [arguments] {
      const Status status = RegisterAndWrite(*arguments);
      return status ? kDone : Fail(status.error());
    };
  });
}

}  // namespace turnlight::app
