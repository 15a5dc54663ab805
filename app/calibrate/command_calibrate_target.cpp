#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
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
#include "calib/calibrate/placement/picked_points.h"
#include "calib/calibrate/placement/placement.h"
#include "calib/calibrate/placement/report.h"
#include "calib/calibrate/placement/view_of_picture.h"
#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace placement = calib::calibrate::placement;
using nlohmann::ordered_json;

constexpr std::size_t kShown = 6;  // photographs in the report

struct TargetArguments {
  std::string session, calibration, out, points;
  std::vector<std::string> empty, lamp_off;
  placement::PlacementOptions options;
};

// Pictures beside the frames: none, one for all, or one each.
class Companions {
 public:
  static Result<Companions> Read(const std::vector<std::string>& files, const char* option,
                                 const rig::Session& session) {
    if (files.size() > 1 && files.size() != session.frames.size())
      return InputError(
          Format("%s: %zu pictures, allowed are one, or one for each of the %zu frames", option,
                 files.size(), session.frames.size()));
    Companions companions(files, session);
    if (files.size() != 1) return companions;
    auto picture = companions.Load(0, {});
    if (!picture) return Forward(picture);
    companions.common_ = *picture;
    return companions;
  }

  // As linear radiance, taken with the frame's exposure.
  Result<cv::Mat> Of(std::size_t frame) const {
    if (files_.empty() || files_.size() == 1) return common_;
    return Load(frame, session_->frames[frame].exposure);
  }

 private:
  Companions(const std::vector<std::string>& files, const rig::Session& session)
      : files_(files), session_(&session) {}

  Result<cv::Mat> Load(std::size_t at, const calib::Exposure& exposure) const {
    const auto image =
        rig::ReadImage(files_[at], {session_->camera->width(), session_->camera->height()});
    if (!image) return Forward(image);
    return calib::Linearise(*image, session_->radiometry, exposure).radiance;
  }

  std::vector<std::string> files_;
  const rig::Session* session_;
  cv::Mat common_;
};

Status CheckTogether(const rig::Session& session, const rig::RigCalibration& calibration) {
  if (session.length_unit != calibration.length_unit)
    return InputError(calibration.source + ": length_unit: \"" + calibration.length_unit +
                      "\", allowed is the session's, \"" + session.length_unit + "\"");
  const cv::Size taken(session.camera->width(), session.camera->height());
  if (taken != calibration.devices.resolution)
    return InputError(
        Format("%s: identity/camera/resolution: %d x %d, the session's pictures are "
               "%d x %d; allowed is a calibration of pictures like these",
               calibration.source.c_str(), calibration.devices.resolution.width,
               calibration.devices.resolution.height, taken.width, taken.height));
  for (std::size_t i = 0; i < session.frames.size(); ++i)
    if (!session.frames[i].angle_deg && !session.frames[i].angle_measured_deg)
      return InputError(Format("%s: frames/%zu/angle_deg: missing, allowed is the table's angle",
                               (session.root / rig::kSessionFile).c_str(), i));
  return {};
}

// All frames, seen.
struct Observed {
  std::vector<placement::View> views;
  std::vector<cv::Mat> shown;  // pictures for the report; empty for the others
  std::vector<std::string> remarks;
  bool from_masks = false;
};

Result<placement::PictureView> ObserveFrame(const rig::Session& session, std::size_t frame,
                                            const Companions& empty, const Companions& lamp_off,
                                            cv::Mat& picture) {
  const rig::FrameRecord& record = session.frames[frame];
  const auto images = rig::ReadFrameImages(session, frame);
  if (!images) return Forward(images);
  placement::Pictures pictures;
  pictures.lit = calib::Linearise(images->image, session.radiometry, record.exposure).radiance;
  picture = pictures.lit;
  const auto bare = empty.Of(frame), dark = lamp_off.Of(frame);
  if (!bare) return Forward(bare);
  if (!dark) return Forward(dark);
  pictures.empty = *bare;
  pictures.lamp_off = *dark;
  if (record.mask) pictures.mask = images->mask;
  const double angle_deg = record.angle_measured_deg.value_or(record.angle_deg.value_or(0.0));
  return placement::ViewOfPicture(pictures, angle_deg, rig::FrameLabel(frame, angle_deg));
}

Result<Observed> Observe(const rig::Session& session, const TargetArguments& arguments) {
  const auto empty = Companions::Read(arguments.empty, "--empty", session);
  if (!empty) return Forward(empty);
  const auto lamp_off = Companions::Read(arguments.lamp_off, "--lamp-off", session);
  if (!lamp_off) return Forward(lamp_off);
  const fs::path masks = fs::path(arguments.out) / "masks";
  if (Status status = MakeDirectory(masks); !status) return Forward(status);
  Observed observed;
  const std::size_t count = session.frames.size();
  const std::size_t every = (count + kShown - 1) / kShown;
  Progress progress("finding outlines", count);
  for (std::size_t i = 0; i < count; ++i) {
    if (Interrupted()) return InterruptedError();
    cv::Mat picture;
    auto seen = ObserveFrame(session, i, *empty, *lamp_off, picture);
    if (!seen) return Forward(seen);
    if (!seen->mask.empty())
      if (Status status = rig::WriteImage(masks / Format("%03zu.png", i), seen->mask); !status)
        return Forward(status);
    observed.from_masks |= seen->from_mask;
    observed.remarks.insert(observed.remarks.end(), seen->remarks.begin(), seen->remarks.end());
    observed.views.push_back(std::move(seen->view));
    observed.shown.push_back(i % every == 0 ? picture : cv::Mat());
    progress.Step();
  }
  if (observed.from_masks)
    observed.remarks.push_back(
        "some outlines are those of the session's masks, as the pictures "
        "show no clear edges there");
  return observed;
}

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
                const Observed& observed, const placement::Placement& placed,
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

int CalibrateTarget(const TargetArguments& arguments) {
  const auto session = rig::ReadSession(arguments.session);
  if (!session) return Fail(session.error());
  const auto calibration = rig::ReadRigCalibration(arguments.calibration);
  if (!calibration) return Fail(calibration.error());
  const auto shape = rig::ReadTarget(*session);
  if (!shape) return Fail(shape.error());
  Status status = CheckTogether(*session, *calibration);
  if (status) status = CheckOutputFolder(arguments.out, arguments.session);
  if (!status) return Fail(status.error());
  std::vector<placement::PickedPoint> picked;
  if (!arguments.points.empty()) {
    auto read = placement::ReadPickedPoints(arguments.points, session->frames.size());
    if (!read) return Fail(read.error());
    picked = std::move(*read);
  }
  const auto observed = Observe(*session, arguments);
  if (!observed) return Fail(observed.error());
  placement::PlacementOptions options = arguments.options;
  if (observed->from_masks)
    options.edge_offset_sigma = std::max(options.edge_offset_sigma, placement::kMaskOffsetSigma);
  const auto placed =
      placement::PlaceTarget(*calibration, *shape, observed->views, picked, options);
  std::vector<std::string> remarks = observed->remarks;
  if (!placed) {
    for (const std::string& remark : remarks) std::cerr << "remark: " << remark << "\n";
    return Fail(placed.error());
  }
  remarks.insert(remarks.end(), placed->remarks.begin(), placed->remarks.end());
  status = WriteAll(*calibration, *shape, *observed, *placed, remarks, arguments.out);
  if (!status) return Fail(status.error());
  for (const std::string& remark : remarks) std::cout << "remark: " << remark << "\n";
  std::cout << placement::Verdict(*placed, observed->views, calibration->length_unit)
            << (fs::path(arguments.out) / "rig-calibration.json").string()
            << ": X_AT with its covariance" << std::endl;
  return kDone;
}

void AddOptions(CLI::App& command, TargetArguments& arguments) {
  command
      .add_option("SESSION", arguments.session,
                  "A session with the target on the table; its poses are not used")
      ->required();
  command
      .add_option("--calibration", arguments.calibration,
                  "rig-calibration.json with camera, axis and angles; its X_AT is not used")
      ->required()
      ->type_name("FILE");
  AddOut(command, arguments.out,
         "Folder for rig-calibration.json with X_AT, placement.json, masks and the report");
  command
      .add_option("--empty", arguments.empty,
                  "Picture of the empty table: one, or one for each frame")
      ->type_name("IMAGE");
  command
      .add_option("--lamp-off", arguments.lamp_off,
                  "Picture with the lamps off, subtracted: one, or one for each frame")
      ->type_name("IMAGE");
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
      "the "
      "session's; without them what differs from --empty, or what is bright before a dark "
      "background",
      "turnlight calibrate target my_session --calibration axis/rig-calibration.json --out target");
  auto arguments = std::make_shared<TargetArguments>();
  AddOptions(*command, *arguments);
  command->callback(
      [arguments, &action] { action = [arguments] { return CalibrateTarget(*arguments); }; });
}

}  // namespace turnlight::app
