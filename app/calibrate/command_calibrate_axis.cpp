#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "app/calibrate/axis_parts.h"
#include "app/calibrate/board_options.h"
#include "app/calibrate/calibrate_commands.h"
#include "app/calibrate/camera_option.h"
#include "app/calibrate/turning_pictures.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "base/file.h"
#include "base/format.h"
#include "calib/calibrate/axis/axis_report.h"
#include "calib/calibrate/axis/calibrate_axis.h"
#include "calib/calibrate/board/detect_boards.h"
#include "calib/calibrate/board/shown_board.h"
#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace axis = calib::calibrate::axis;
namespace board = calib::calibrate::board;

constexpr double kSamePlaceDeg = 0.05;  // a table that stays is read with noise

struct AxisArguments {
  std::string pictures, camera, out, lens_note;
  board::BoardWords board;
  axis::AxisOptions options;
};

// In which direction the table came to each angle, by the order of the pictures.
void SetApproachesByOrder(std::vector<axis::AxisView>& views) {
  for (std::size_t i = 1; i < views.size(); ++i) {
    const double step = views[i].angle_deg - views[i - 1].angle_deg;
    views[i].approach = std::abs(step) < kSamePlaceDeg ? views[i - 1].approach
                        : step > 0.0                   ? axis::Approach::kRising
                                                       : axis::Approach::kFalling;
  }
}

Result<std::vector<axis::AxisView>> DetectViews(const TurningPictures& pictures,
                                                const board::Board& board) {
  Progress progress("finding the board", pictures.angles_deg.size());
  const auto found = board::DetectInPictures(pictures.angles_deg.size(), pictures.picture, board,
                                             [&progress](std::size_t) { progress.Step(); });
  std::vector<std::string> names;
  for (const double angle_deg : pictures.angles_deg)
    names.push_back("at " + NumberText(angle_deg) + " deg");
  if (const Status status = board::CheckShownBoard(names, found, board); !status)
    return Forward(status);
  std::vector<axis::AxisView> views;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) return Forward(found[i]);
    axis::AxisView& view = views.emplace_back();
    view.angle_deg = pictures.angles_deg[i];
    if (!found[i]->boards.empty()) view.board = found[i]->boards.front().view;
  }
  SetApproachesByOrder(views);
  return views;
}

// What is there already, if it is of these devices; else a new one.
Result<rig::RigCalibration> BeginCalibration(const fs::path& path, const TurningPictures& pictures,
                                             const CalibratedLens& lens) {
  std::error_code code;
  rig::RigCalibration calibration(lens.camera);
  calibration.devices.resolution = pictures.size;
  calibration.radiometry = pictures.radiometry;
  if (fs::exists(path, code)) {
    auto read = rig::ReadRigCalibration(path);
    if (!read) return Forward(read);
    if (pictures.devices)
      if (const Status status =
              rig::CheckIdentity(*read, pictures.devices->camera, pictures.devices->table);
          !status)
        return Forward(status);
    calibration.radiometry = read->radiometry;
    calibration.noise = read->noise;
    calibration.covariances.radiometry = read->covariances.radiometry;
    calibration.devices = read->devices;
    calibration.devices.resolution = pictures.size;
  }
  if (pictures.devices) {
    const std::string note = calibration.devices.lens;
    calibration.devices = *pictures.devices;
    if (calibration.devices.lens.empty()) calibration.devices.lens = note;
  }
  return calibration;
}

// Beside the calibration, named after it.
Status WriteAxisPictures(const axis::AxisCalibration& axis,
                         const std::vector<axis::AxisView>& views, const board::Board& board,
                         const fs::path& out) {
  const auto name = [&out](const std::string& what) {
    return out.parent_path() / (out.stem().string() + "-axis-" + what + ".png");
  };
  const Status status = rig::WriteImage(name("views"), axis::DrawAxisViews(axis, views));
  if (!status) return status;
  return rig::WriteImage(name("plan"), axis::DrawAxisPlan(axis, board, "mm"));
}

Status CalibrateAndWrite(const AxisArguments& arguments) {
  const auto board = board::ParseBoard(arguments.board);
  if (!board) return Forward(board);
  const auto lens = ReadCalibratedLens(arguments.camera);
  if (!lens) return Forward(lens);
  const fs::path out = fs::absolute(arguments.out);
  if (const Status status = CheckOutputFolder(out.parent_path(), arguments.pictures); !status)
    return status;
  const auto pictures = ReadTurningPictures(arguments.pictures, "board");
  if (!pictures) return Forward(pictures);
  const cv::Size size(lens->camera.width(), lens->camera.height());
  if (pictures->size != size)
    return InputError("--camera: a lens of " + std::to_string(size.width) + " x " +
                      std::to_string(size.height) + " pixels, allowed is one of the pictures', " +
                      std::to_string(pictures->size.width) + " x " +
                      std::to_string(pictures->size.height));
  auto calibration = BeginCalibration(out, *pictures, *lens);
  if (!calibration) return Forward(calibration);
  const auto views = DetectViews(*pictures, *board);
  if (!views) return Forward(views);
  axis::AxisOptions options = arguments.options;
  options.intrinsics_covariance = lens->covariance;
  const auto axis = axis::CalibrateAxis(*board, lens->camera, *views, options);
  if (!axis) return Forward(axis);
  PutAxis(*axis, lens->covariance, *calibration);
  if (!arguments.lens_note.empty()) calibration->devices.lens = arguments.lens_note;
  if (const Status status = MakeDirectory(out.parent_path()); !status) return status;
  if (const Status status = WriteAxisPictures(*axis, *views, *board, out); !status) return status;
  if (const Status status = rig::WriteRigCalibration(*calibration, out); !status) return status;
  std::cout << axis::AxisText(*axis, *views, "mm");
  if (calibration->devices.camera.model.empty())
    std::cout << "note          a session does not say which devices took it, so that the "
                 "identity is empty; a raw capture (turnlight calibrate capture) says it\n";
  if (!lens->covariance)
    std::cout << "note          the lens comes without its covariance: the sigmas are without its "
                 "share\n";
  std::cout << "written       " << arguments.out
            << "; next: turnlight calibrate target finds where the target stands" << std::endl;
  return {};
}

int CalibrateAxisAndPrint(const AxisArguments& arguments) {
  const InterruptAtOnce until_it_writes;
  const Status status = CalibrateAndWrite(arguments);
  return status ? kDone : Fail(status.error());
}

}  // namespace

void AddCalibrateAxis(CLI::App& calibrate, Action& action) {
  CLI::App* command = AddCommand(
      calibrate, "axis",
      "Find the table's axis and where the camera is, from pictures of a board that lies anywhere "
      "on the turning table. Writes X_WC, X_WA, angle_scale and the lens into the rig's "
      "calibration, with covariances, and beside it pictures of what it found",
      "turnlight calibrate axis board --board 10x10 --square-mm 10 --camera lens --out "
      "rig-calibration.json");
  auto arguments = std::make_shared<AxisArguments>();
  command
      ->add_option("PICTURES", arguments->pictures,
                   "A raw capture's folder (its frames of the kind board), or a session's")
      ->required();
  AddBoardOptions(*command, arguments->board);
  command
      ->add_option("--camera", arguments->camera,
                   "The lens: the folder of calibrate intrinsics, or a .cameramodel")
      ->type_name("DIR|FILE")
      ->required();
  command
      ->add_option("--out", arguments->out,
                   "The rig's calibration. Of one that is there the radiometry stays; the "
                   "target's place does not, as W is another")
      ->type_name("FILE")
      ->required()
      ->check([](const std::string& file) {
        return file.empty() ? std::string("\"\" is no file's name") : std::string();
      });
  command
      ->add_option("--origin-height", arguments->options.origin_height,
                   "W's origin so far above the board's plane, along the axis; -3 for a board of "
                   "3 mm puts it on the table (default 0)")
      ->type_name("MM")
      ->check(CLI::Range(-1e5, 1e5));
  command
      ->add_option("--lens", arguments->lens_note,
                   "A note for people: which lens, its focus and aperture")
      ->type_name("TEXT");
  command->callback(
      [arguments, &action] { action = [arguments] { return CalibrateAxisAndPrint(*arguments); }; });
}

}  // namespace turnlight::app
