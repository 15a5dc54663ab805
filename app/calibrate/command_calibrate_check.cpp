#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "app/calibrate/board_options.h"
#include "app/calibrate/calibrate_commands.h"
#include "app/calibrate/outline_pictures.h"
#include "app/calibrate/turning_pictures.h"
#include "app/exit_code.h"
#include "app/interrupt.h"
#include "app/output_folder.h"
#include "app/progress.h"
#include "base/file.h"
#include "base/format.h"
#include "calib/calibrate/board/detect_boards.h"
#include "calib/calibrate/board/shown_board.h"
#include "calib/calibrate/drift/drift.h"
#include "calib/calibrate/drift/drift_json.h"
#include "calib/calibrate/drift/drift_words.h"
#include "calib/calibrate/placement/view_of_picture.h"
#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace axis = calib::calibrate::axis;
namespace board = calib::calibrate::board;
namespace drift = calib::calibrate::drift;
namespace placement = calib::calibrate::placement;

struct CheckArguments {
  TargetArguments target;  // its pictures may be those of a board
  std::string calibration, out;
  board::BoardWords board;
  drift::DriftOptions options;
};

Status CheckSize(const rig::RigCalibration& calibration, const TurningPictures& pictures) {
  const cv::Size known = calibration.devices.resolution;
  if (pictures.size != known)
    return InputError(
        Format("%s: identity/camera/resolution: %d x %d, the pictures are %d x %d; "
               "allowed is a calibration of pictures like these",
               calibration.source.c_str(), known.width, known.height, pictures.size.width,
               pictures.size.height));
  if (!pictures.devices) return {};
  return rig::CheckIdentity(calibration, pictures.devices->camera, pictures.devices->table);
}

Result<drift::DriftReport> CheckBoard(const CheckArguments& arguments,
                                      const rig::RigCalibration& calibration) {
  const auto board = board::ParseBoard(arguments.board);
  if (!board) return Forward(board);
  const auto pictures = ReadTurningPictures(arguments.target.pictures, "board");
  if (!pictures) return Forward(pictures);
  if (const Status status = CheckSize(calibration, *pictures); !status) return Forward(status);
  Progress progress("finding the board", pictures->angles_deg.size());
  const auto found = board::DetectInPictures(pictures->angles_deg.size(), pictures->picture, *board,
                                             [&progress](std::size_t) { progress.Step(); });
  std::vector<std::string> names;
  for (const double angle_deg : pictures->angles_deg)
    names.push_back(Format("at %g deg", angle_deg));
  if (const Status status = board::CheckShownBoard(names, found, *board); !status)
    return Forward(status);
  std::vector<axis::AxisView> views;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!found[i]) return Forward(found[i]);
    axis::AxisView& view = views.emplace_back();
    view.angle_deg = pictures->angles_deg[i];
    if (!found[i]->boards.empty()) view.board = found[i]->boards.front().view;
  }
  return drift::CheckWithBoard(calibration, *board, views, arguments.options);
}

Result<drift::DriftReport> CheckOutlines(const CheckArguments& arguments,
                                         const rig::RigCalibration& calibration) {
  if (const Status status = rig::CheckTargetPlaced(calibration); !status) return Forward(status);
  const auto input = ReadTargetInput(arguments.target, calibration);
  if (!input) return Forward(input);
  const auto seen = FindOutlines(input->pictures, {});
  if (!seen) return Forward(seen);
  drift::DriftOptions options = arguments.options;
  if (seen->from_masks)
    options.edge_offset_sigma = std::max(options.edge_offset_sigma, placement::kMaskOffsetSigma);
  auto report = drift::CheckWithOutlines(calibration, input->shape, seen->views, options);
  if (report)
    report->remarks.insert(report->remarks.begin(), seen->remarks.begin(), seen->remarks.end());
  return report;
}

int ExitCodeOf(drift::Verdict verdict) {
  switch (verdict) {
    case drift::Verdict::kStillTrue:
      return kDone;
    case drift::Verdict::kDrifted:
      return kDifferent;
    case drift::Verdict::kCannotTell:
      return kNoEstimate;
  }
  return kNoEstimate;
}

int Check(const CheckArguments& arguments) {
  const InterruptAtOnce until_it_writes;
  const auto calibration = rig::ReadRigCalibration(arguments.calibration);
  if (!calibration) return Fail(calibration.error());
  if (const Status status = CheckOutputFolder(arguments.out, arguments.target.pictures); !status)
    return Fail(status.error());
  const auto report = arguments.board.size.empty() ? CheckOutlines(arguments, *calibration)
                                                   : CheckBoard(arguments, *calibration);
  if (!report) return Fail(report.error());
  const fs::path out = arguments.out;
  Status status = MakeDirectory(out);
  if (status) status = WriteFileAtomic(out / "check.json", drift::PrintDrift(*report));
  if (status)
    status = rig::WriteImage(out / "check.png",
                             drift::DrawDrift(*report, calibration->devices.resolution));
  if (!status) return Fail(status.error());
  std::cout << drift::DriftText(*report) << std::flush;
  return ExitCodeOf(report->verdict);
}

void AddCheckOptions(CLI::App& command, CheckArguments& arguments) {
  command
      .add_option(
          "PICTURES", arguments.target.pictures,
          "Taken now: with --board a raw capture's folder or a session's, two or three "
          "angles of a board anywhere on the table; else of the target where it was put for "
          "the calibration")
      ->required();
  command
      .add_option("--calibration", arguments.calibration, "The rig-calibration.json in question")
      ->type_name("FILE")
      ->required();
  AddOut(command, arguments.out, "Folder for check.json and check.png");
  AddBoardOptions(command, arguments.board, false);
  AddTargetOptions(command, arguments.target);
  command
      .add_option("--angle-sigma-deg", arguments.options.angle_sigma_deg,
                  "How far the table may be from the angle that it reports: sigma (default 0.05)")
      ->type_name("DEG")
      ->check(CLI::Range(0.0, 10.0));
  command
      .add_option("--edge-offset-px", arguments.options.edge_offset_sigma,
                  "How far outlines may lie outside the true ones for blur and shading: sigma "
                  "(default 0.2)")
      ->type_name("PX")
      ->check(CLI::Range(0.0, 10.0));
}

}  // namespace

void AddCalibrateCheck(CLI::App& calibrate, Action& action) {
  CLI::App* command = AddCommand(
      calibrate, "check",
      "Is a calibration still true? A few pictures taken now, of a board on the table or of the "
      "target's outlines, against the stored one: what drifted, by how much, in how many sigmas. "
      "Exit code 0 if it is still true, 3 if it drifted, 5 if the pictures cannot tell, 2 "
      "otherwise",
      "turnlight calibrate check board_today --calibration rig-calibration.json --board 10x10 "
      "--square-mm 10 --out check");
  auto arguments = std::make_shared<CheckArguments>();
  AddCheckOptions(*command, *arguments);
  command->callback([arguments, &action] { action = [arguments] { return Check(*arguments); }; });
}

}  // namespace turnlight::app
