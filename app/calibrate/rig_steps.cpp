#include "app/calibrate/rig_steps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "app/calibrate/axis_parts.h"
#include "app/calibrate/outline_pictures.h"
#include "app/calibrate/raw_taking.h"
#include "app/progress.h"
#include "base/file.h"
#include "base/format.h"
#include "calib/calibrate/axis/axis_report.h"
#include "calib/calibrate/board/detect_boards.h"
#include "calib/calibrate/board/shown_board.h"
#include "calib/calibrate/lens/assess_lens.h"
#include "calib/calibrate/lens/lens_json.h"
#include "calib/calibrate/lens/pictures.h"
#include "calib/calibrate/placement/report.h"
#include "calib/calibrate/response/response_pictures.h"
#include "rig/session/image_file.h"
#include "rig/session/raw_capture.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace axis = calib::calibrate::axis;
namespace board = calib::calibrate::board;
namespace lens = calib::calibrate::lens;
namespace placement = calib::calibrate::placement;
namespace response = calib::calibrate::response;

// A flat field is judged where it is bright and far from full.
constexpr double kBrightestFlat = 0.85;

struct Taking {
  std::string folder, prop, words;
  RawOrder order;
  std::optional<TurningRecipe> turning;
};

Result<rig::RawCapture> Take(const RigWork& work, const Taking& taking) {
  const fs::path out = work.out / taking.folder;
  DeviceConfig config = work.recipe.devices;
  if (taking.turning) {
    config.plan.count = taking.turning->count;
    config.plan.step_deg = taking.turning->step_deg;
    config.plan.exposures_us = {taking.turning->exposure_us};
    config.plan.closure = false;
    if (const auto problem = rig::Validate(config.plan))
      return InputError(config.file + ": capture/" + problem->key + ": " + problem->text);
  }
  if (auto whole = WholeCapture(config.plan, taking.order, out)) return std::move(*whole);
  if (Status status = work.stage.Put(taking.prop, taking.words); !status) return Forward(status);
  auto taken = TakeRawCapture(config, taking.order, out, work.drivers, {work.stop, work.say});
  if (!taken) return Forward(taken);
  return std::move(taken->capture);
}

RawOrder StillOrder(const std::string& kind, std::vector<double> exposures_us, int pairs) {
  RawOrder order;
  order.kind = kind;
  order.exposures_us = std::move(exposures_us);
  order.pairs = pairs;
  order.move = false;
  return order;
}

RawOrder TurningOrder(const std::string& kind) {
  RawOrder order;
  order.kind = kind;
  return order;
}

std::vector<response::ListedGroup> GroupsOf(const rig::RawCapture& capture,
                                            const std::string& kind) {
  std::map<double, response::ListedGroup> groups;
  for (const std::size_t i : rig::FramesOfKind(capture, kind)) {
    const double exposure_us = capture.frames[i].exposure.exposure_us.value_or(0.0);
    groups[exposure_us].exposure_us = exposure_us;
    groups[exposure_us].images.push_back(capture.root / capture.frames[i].image);
  }
  std::vector<response::ListedGroup> list;
  for (auto& [exposure_us, group] : groups) list.push_back(std::move(group));
  return list;
}

// The brightest that is not near full.
Result<response::ListedGroup> FlatGroup(const rig::RawCapture& capture,
                                        const std::vector<response::ListedGroup>& series) {
  std::optional<response::ListedGroup> best;
  for (const response::ListedGroup& group : series) {
    const auto image = rig::ReadImage(group.images.front());
    if (!image) return Forward(image);
    double brightest = 0.0;
    cv::minMaxLoc(image->reshape(1), nullptr, &brightest);
    if (!best || brightest < kBrightestFlat * capture.radiometry.white) best = group;
  }
  return *best;
}

Status WriteResponsePages(const response::Response& found, const fs::path& out) {
  Status status = rig::WriteImage(out / "linearity.png", response::DrawLinearity(found.curve));
  if (status && found.transfer)
    status = rig::WriteImage(out / "photon_transfer.png",
                             response::DrawPhotonTransfer(*found.transfer, found.planes));
  if (status && found.flat)
    status =
        rig::WriteImage(out / "flat_field.png", response::DrawFlatField(*found.flat, found.size));
  if (status) status = WriteFileAtomic(out / "response.json", response::PrintResponse(found));
  return status;
}

Result<cv::Mat> GreyOf(const rig::RawCapture& capture, std::size_t frame) {
  auto image = rig::ReadRawImage(capture, frame);
  if (!image || image->channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(*image, grey, cv::COLOR_RGB2GRAY);
  return grey;
}

Result<std::vector<board::Detection>> Detect(const RigWork& work, const rig::RawCapture& capture,
                                             const std::vector<std::size_t>& frames) {
  Progress progress("finding the board", frames.size());
  auto found = board::DetectInPictures(
      frames.size(), [&](std::size_t i) { return GreyOf(capture, frames[i]); }, work.recipe.board,
      [&progress](std::size_t) { progress.Step(); });
  std::vector<std::string> names;
  for (const std::size_t frame : frames) names.push_back(capture.frames[frame].image);
  if (const Status status = board::CheckShownBoard(names, found, work.recipe.board); !status)
    return Forward(status);
  std::vector<board::Detection> detections;
  for (auto& detection : found) {
    if (!detection) return Forward(detection);
    detections.push_back(std::move(*detection));
  }
  return detections;
}

std::vector<lens::PictureViews> ViewsOf(const rig::RawCapture& capture,
                                        const std::vector<std::size_t>& frames,
                                        const std::vector<board::Detection>& detections) {
  std::vector<lens::PictureViews> pictures;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    lens::PictureViews& picture = pictures.emplace_back();
    picture.picture = capture.frames[frames[i]].image;
    picture.width = capture.devices.resolution.width;
    picture.height = capture.devices.resolution.height;
    for (const board::DetectedBoard& seen : detections[i].boards)
      picture.boards.push_back(seen.view);
    if (!picture.boards.empty()) continue;
    picture.why_none =
        detections[i].remarks.empty() ? "no board found" : detections[i].remarks.front();
  }
  return pictures;
}

Status WriteLens(const RigWork& work, const std::vector<lens::PictureViews>& pictures,
                 const lens::LensCalibration& found, const lens::LensAssessment& assessment) {
  const fs::path out = work.out / "lens";
  const std::string& unit = work.recipe.length_unit;
  const std::string model = found.camera().ToString();
  Status status = WriteFileAtomic(out / "camera.cameramodel", model);
  if (status)
    status = WriteFileAtomic(
        out / "intrinsics.json",
        lens::IntrinsicsJson(work.recipe.board, pictures, found, assessment, model, unit));
  for (const lens::ReportPicture& page : lens::ReportPictures(pictures, found, assessment, unit))
    if (status) status = rig::WriteImage(out / page.name, page.page);
  return status;
}

// A table that always comes the same way round.
std::optional<axis::Approach> ApproachOf(const rig::CapturePlan& plan) {
  if (plan.approach == rig::Approach::kDirect) return std::nullopt;
  return plan.direction == rig::TurnDirection::kCcw ? axis::Approach::kRising
                                                    : axis::Approach::kFalling;
}

// All but the axis.
rig::RigCalibration BeginCalibration(const RigWork& work, const rig::RawCapture& capture,
                                     const calib::CameraModel& camera) {
  rig::RigCalibration calibration(camera);
  calibration.length_unit = work.recipe.length_unit;
  calibration.radiometry = capture.radiometry;
  calibration.devices = capture.devices;
  calibration.devices.lens = work.recipe.lens_note;
  return calibration;
}

}  // namespace

Result<std::optional<response::Response>> FindResponse(const RigWork& work) {
  if (!work.recipe.response) return std::optional<response::Response>();
  const ResponseRecipe& recipe = *work.recipe.response;
  auto capture =
      Take(work, {"response",
                  "flat",
                  "hold something white and evenly lit before the lens, so that it fills "
                  "the picture",
                  StillOrder("flat", recipe.exposures_us, recipe.pairs),
                  {}});
  if (capture)
    capture = Take(work, {"response",
                          "dark",
                          "cover the lens",
                          StillOrder("dark", {recipe.exposures_us.front()}, recipe.pairs),
                          {}});
  if (capture && recipe.grey_card)
    capture =
        Take(work, {"response",
                    "grey",
                    "hold a grey card so that it fills the picture",
                    StillOrder("grey", {recipe.exposures_us[recipe.exposures_us.size() / 2]}, 1),
                    {}});
  if (!capture) return Forward(capture);
  response::ResponseList list;
  list.source = (work.out / "response").string();
  list.bayer = capture->bayer;
  list.white = capture->radiometry.white;
  list.gain_db = work.recipe.devices.plan.gain_db;
  list.series = GroupsOf(*capture, "flat");
  list.dark = GroupsOf(*capture, "dark").front();
  auto flat = FlatGroup(*capture, list.series);
  if (!flat) return Forward(flat);
  list.flat = std::move(*flat);
  if (recipe.grey_card)
    list.grey_card = response::GreyCard{GroupsOf(*capture, "grey").front().images,
                                        cv::Rect({0, 0}, capture->devices.resolution)};
  auto found = response::CalibrateResponse(list);
  if (!found) return Forward(found);
  if (Status status = WriteResponsePages(*found, work.out / "response"); !status)
    return Forward(status);
  return std::optional<response::Response>(std::move(*found));
}

Result<LensFound> FindLens(const RigWork& work) {
  RawOrder order = StillOrder("board", {work.recipe.intrinsics_exposure_us}, 0);
  order.count = work.recipe.pictures;
  order.ask = work.asks;
  const auto capture =
      Take(work, {"lens",
                  "handheld",
                  "hold the board before the camera by hand, in another place and tilt for each "
                  "picture, into the corners too",
                  order,
                  {}});
  if (!capture) return Forward(capture);
  const auto frames = rig::FramesOfKind(*capture, "board");
  const auto detections = Detect(work, *capture, frames);
  if (!detections) return Forward(detections);
  const auto pictures = ViewsOf(*capture, frames, *detections);
  lens::LensOptions options;
  options.lens_model = work.recipe.lens_model;
  auto found = lens::CalibrateLens(work.recipe.board, pictures, options);
  if (!found) return Forward(found);
  const lens::LensAssessment assessment =
      lens::AssessLens(work.recipe.board, pictures, *found, options, std::nullopt);
  if (Status status = WriteLens(work, pictures, *found, assessment); !status)
    return Forward(status);
  return LensFound{std::move(*found), assessment.verdict};
}

Result<AxisFound> FindAxis(const RigWork& work, const LensFound& lens_found,
                           const std::optional<response::Response>& response_found) {
  const auto capture = Take(work, {"axis", "board", "lay the board flat on the table",
                                   TurningOrder("board"), work.recipe.axis});
  if (!capture) return Forward(capture);
  const auto frames = rig::FramesOfKind(*capture, "board");
  const auto detections = Detect(work, *capture, frames);
  if (!detections) return Forward(detections);
  std::vector<axis::AxisView> views;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const rig::RawCaptureFrame& frame = capture->frames[frames[i]];
    axis::AxisView& view = views.emplace_back();
    view.angle_deg = frame.angle_measured_deg.value_or(frame.angle_deg.value_or(0.0));
    view.approach = ApproachOf(work.recipe.devices.plan);
    if (!(*detections)[i].boards.empty()) view.board = (*detections)[i].boards.front().view;
  }
  const calib::CameraModel& camera = lens_found.calibration.camera();
  const auto count = static_cast<Eigen::Index>(camera.intrinsics().size());
  axis::AxisOptions options;
  options.origin_height = -work.recipe.board_height;
  options.intrinsics_covariance =
      lens_found.calibration.uncertainty.covariance().topLeftCorner(count, count);
  auto found = axis::CalibrateAxis(work.recipe.board, camera, views, options);
  if (!found) return Forward(found);
  rig::RigCalibration calibration = BeginCalibration(work, *capture, camera);
  PutAxis(*found, options.intrinsics_covariance, calibration);
  if (response_found)
    if (Status status = response::ApplyResponse(*response_found, calibration); !status)
      return Forward(status);
  const fs::path out = work.out / "axis";
  Status status = rig::WriteImage(out / "views.png", axis::DrawAxisViews(*found, views));
  if (status)
    status = rig::WriteImage(
        out / "plan.png", axis::DrawAxisPlan(*found, work.recipe.board, work.recipe.length_unit));
  if (status)
    status =
        WriteFileAtomic(out / "axis.txt", axis::AxisText(*found, views, work.recipe.length_unit));
  if (!status) return Forward(status);
  return AxisFound{std::move(calibration), std::move(*found)};
}

Result<TargetFound> FindTarget(const RigWork& work, const AxisFound& axis_found) {
  auto capture = Take(work, {"target",
                             "empty",
                             "clear the table",
                             StillOrder("empty", {work.recipe.target.exposure_us}, 1),
                             {}});
  if (capture)
    capture = Take(work, {"target", "target", "put the target on the table, where it stays",
                          TurningOrder("target"), work.recipe.target});
  if (!capture) return Forward(capture);
  const auto pictures = TargetPicturesOf(*capture, axis_found.calibration, {});
  if (!pictures) return Forward(pictures);
  const auto seen = FindOutlines(*pictures, {});
  if (!seen) return Forward(seen);
  placement::PlacementOptions options;
  options.upright = std::holds_alternative<calib::MeshShape>(work.recipe.shape);
  auto placed =
      placement::PlaceTarget(axis_found.calibration, work.recipe.shape, seen->views, {}, options);
  if (!placed) return Forward(placed);
  const fs::path out = work.out / "target";
  Status status = rig::WriteImage(out / "placement.png",
                                  placement::OverlayPage(seen->shown, axis_found.calibration,
                                                         work.recipe.shape, seen->views, *placed));
  if (status)
    status = rig::WriteImage(out / "residuals.png", placement::ResidualPage(seen->views, *placed));
  if (!status) return Forward(status);
  return TargetFound{placement::WithTarget(axis_found.calibration, *placed), std::move(*placed)};
}

}  // namespace turnlight::app
