#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "app/calibrate/calibrate_commands.h"
#include "app/calibrate/outline_pictures.h"
#include "app/exit_code.h"
#include "app/output_folder.h"
#include "base/file.h"
#include "base/format.h"
#include "base/printable.h"
#include "calib/calibrate/placement/picked_points.h"
#include "calib/calibrate/placement/placement.h"
#include "calib/calibrate/placement/report.h"
#include "calib/calibrate/placement/view_of_picture.h"
#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"
#include "rig/session/raw_capture.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace placement = calib::calibrate::placement;
using nlohmann::ordered_json;

struct PlacingArguments {
  TargetArguments target;
  std::string calibration, out, points;
  placement::PlacementOptions options;
};

ordered_json RowsOf(const placement::Matrix6& matrix) {
  ordered_json rows = ordered_json::array();
  for (int r = 0; r < 6; ++r) {
    rows.push_back(ordered_json::array());
    for (int c = 0; c < 6; ++c) rows.back().push_back(matrix(r, c));
  }
  return rows;
}

std::string PrintPlacement(const placement::Placement& placed,
                           const std::vector<placement::View>& views, const std::string& unit,
                           const std::vector<std::string>& remarks) {
  ordered_json json{{"format", "turnlight-placement"}, {"version", 1}, {"length_unit", unit}};
  json["X_AT"] = calib::RowsFromPose(placed.X_AT);
  json["covariance"] = RowsOf(placed.covariance);
  json["covariance_from_outlines"] = RowsOf(placed.from_outlines);
  json["covariance_from_calibration"] = RowsOf(placed.from_calibration);
  if (placed.radius_sigma > 0.0)
    json["radius"] = {{"value", placed.radius}, {"sigma", placed.radius_sigma}};
  json["rms_px"] = placed.rms;
  json["wobble_px"] = placed.wobble;
  json["pixel_length"] = placed.pixel_length;
  json["edge_offset_px"] = {{"value", placed.edge_offset}, {"sigma", placed.edge_offset_sigma}};
  ordered_json frames = ordered_json::array();
  for (std::size_t v = 0; v < views.size(); ++v) {
    const placement::ViewFit& fit = placed.views[v];
    frames.push_back({{"angle_deg", views[v].angle_deg},
                      {"points", fit.points},
                      {"used", fit.used},
                      {"rms_px", fit.rms},
                      {"shift_px", {fit.shift.x(), fit.shift.y()}}});
  }
  json["frames"] = frames;
  json["remarks"] = remarks;
  return json.dump(1) + "\n";
}

Status WriteAll(const rig::RigCalibration& calibration, const calib::TargetShape& shape,
                const OutlinePictures& observed, const placement::Placement& placed,
                const std::vector<std::string>& remarks, const fs::path& out) {
  calib::TargetShape fitted = shape;
  if (auto* sphere = std::get_if<calib::SphereShape>(&fitted)) sphere->radius = placed.radius;
  Status status =
      WriteFileAtomic(out / "placement.json",
                      PrintPlacement(placed, observed.views, calibration.length_unit, remarks));
  if (status)
    status = rig::WriteImage(
        out / "placement.png",
        placement::OverlayPage(observed.shown, calibration, fitted, observed.views, placed));
  if (status)
    status =
        rig::WriteImage(out / "residuals.png", placement::ResidualPage(observed.views, placed));
  if (status)
    status = rig::WriteRigCalibration(placement::WithTarget(calibration, placed),
                                      out / "rig-calibration.json");
  return status;
}

int CalibrateTarget(const PlacingArguments& arguments) {
  const auto calibration = rig::ReadRigCalibration(arguments.calibration);
  if (!calibration) return Fail(calibration.error());
  const auto input = ReadTargetInput(arguments.target, *calibration);
  if (!input) return Fail(input.error());
  const calib::TargetShape& shape = input->shape;
  Status status = CheckOutputFolder(arguments.out, arguments.target.pictures);
  if (!status) return Fail(status.error());
  std::vector<placement::PickedPoint> picked;
  if (!arguments.points.empty()) {
    auto read = placement::ReadPickedPoints(arguments.points, input->pictures.frames.size());
    if (!read) return Fail(read.error());
    picked = std::move(*read);
  }
  const auto observed = FindOutlines(input->pictures, fs::path(arguments.out) / "masks");
  if (!observed) return Fail(observed.error());
  placement::PlacementOptions options = arguments.options;
  if (observed->from_masks)
    options.edge_offset_sigma = std::max(options.edge_offset_sigma, placement::kMaskOffsetSigma);
  const auto placed = placement::PlaceTarget(*calibration, shape, observed->views, picked, options);
  std::vector<std::string> remarks = observed->remarks;
  if (!placed) {
    for (const std::string& remark : remarks) std::cerr << "remark: " << Printable(remark) << "\n";
    return Fail(placed.error());
  }
  remarks.insert(remarks.end(), placed->remarks.begin(), placed->remarks.end());
  status = WriteAll(*calibration, shape, *observed, *placed, remarks, arguments.out);
  if (!status) return Fail(status.error());
  for (const std::string& remark : remarks) std::cout << "remark: " << Printable(remark) << "\n";
  std::cout << placement::Verdict(*placed, observed->views, calibration->length_unit)
            << (fs::path(arguments.out) / "rig-calibration.json").string()
            << ": X_AT with its covariance" << std::endl;
  return kDone;
}

void AddOptions(CLI::App& command, PlacingArguments& arguments) {
  command
      .add_option("PICTURES", arguments.target.pictures,
                  "A raw capture's folder (its frames of the kinds target, empty and lamp-off), or "
                  "a session, whose poses are not used")
      ->required();
  command
      .add_option("--calibration", arguments.calibration,
                  "rig-calibration.json with camera, axis and angles; its X_AT is not used")
      ->required()
      ->type_name("FILE");
  AddOut(command, arguments.out,
         "Folder for rig-calibration.json with X_AT, placement.json, masks and the report");
  AddTargetOptions(command, arguments.target);
  command
      .add_option("--points", arguments.points,
                  "Picked points, a line each: frame, x, y, X, Y, Z (pixels; the target's frame)")
      ->type_name("FILE");
  command.add_flag("--fit-radius", arguments.options.fit_radius,
                   "Of a sphere, find the radius too");
  command.add_flag("--upright", arguments.options.upright,
                   "A mesh whose z axis is along the table's: try all angles about it");
  command
      .add_option("--edge-offset-px", arguments.options.edge_offset_sigma,
                  "How far outlines may lie outside the true ones for blur and shading: sigma")
      ->type_name("PX")
      ->check(CLI::Range(0.0, 10.0));
}

}  // namespace

void AddCalibrateTarget(CLI::App& calibrate, Action& action) {
  CLI::App* command = AddCommand(
      calibrate, "target",
      "Where the target stands on the table: X_AT from its outlines at several angles. Masks are "
      "the session's; without them what differs from the empty table, or what is bright before a "
      "dark background",
      "turnlight calibrate target pictures --mesh cat.ply --calibration rig-calibration.json --out "
      "target");
  auto arguments = std::make_shared<PlacingArguments>();
  AddOptions(*command, *arguments);
  command->callback(
      [arguments, &action] { action = [arguments] { return CalibrateTarget(*arguments); }; });
}

}  // namespace turnlight::app
