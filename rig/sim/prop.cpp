#include "rig/sim/prop.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/angles.h"
#include "base/random.h"
#include "calib/calibrate/board/board_print.h"
#include "calib/calibrate/board/board_words.h"
#include "calib/rig_geometry.h"
#include "rig/sim/board_picture.h"
#include "rig/sim/true_geometry.h"

namespace turnlight::rig::sim {
namespace {

namespace board = calib::calibrate::board;

constexpr Range kRadiance{.min = 0.0, .max = 100.0};
constexpr Range kLength{.min = -1e6, .max = 1e6};
constexpr double kFullLevel = 65535.0;  // of the 16 bits that boards are rendered in
constexpr int kMaxDraws = 2000;
constexpr double kPictureMarginPx = 2.0;

Range Above0(double max) { return {.max = max, .above = 0.0}; }

Result<Prop> ReadTableBoard(StrictObject& object, board::Board read) {
  TableBoard prop;
  prop.board = std::move(read);
  ReadLook(object, prop.look);
  if (const auto list = object.OptionalNumbers("offset", 3, kLength))
    prop.offset = {(*list)[0], (*list)[1], (*list)[2]};
  if (const auto list = object.OptionalNumbers("turn_deg", 3, {.min = -180.0, .max = 180.0}))
    prop.turn_deg = {(*list)[0], (*list)[1], (*list)[2]};
  if (const Status status = object.Finish(); !status) return Forward(status);
  return prop;
}

Result<Prop> ReadHandheld(StrictObject& object, board::Board read) {
  HandheldBoard prop;
  prop.board = std::move(read);
  ReadLook(object, prop.look);
  prop.seed = static_cast<std::uint64_t>(
      object.OptionalInteger("seed", 0, std::int64_t{1} << 53).value_or(1));
  if (const auto pair = object.OptionalNumbers("distance", 2, Above0(1e6)))
    prop.distance = {(*pair)[0], (*pair)[1]};
  if (object.ok() && prop.distance[0] > prop.distance[1])
    object.Refuse("distance", "the smaller one first");
  prop.tilt_max_deg =
      object.OptionalNumber("tilt_max_deg", {.min = 0.0, .max = 80.0}).value_or(prop.tilt_max_deg);
  prop.roll_max_deg =
      object.OptionalNumber("roll_max_deg", {.min = 0.0, .max = 180.0}).value_or(prop.roll_max_deg);
  if (const Status status = object.Finish(); !status) return Forward(status);
  return prop;
}

Result<Prop> ReadBall(StrictObject& object) {
  BallOnTable prop;
  const auto number = [&object](const char* key, Range range, double& value) {
    value = object.OptionalNumber(key, range).value_or(value);
  };
  number("radius", Above0(1e6), prop.radius);
  number("reflectance", {.min = 0.0, .max = 1.0}, prop.reflectance);
  number("diffuse", {.min = 0.0, .max = 1.0}, prop.diffuse);
  number("lamp_radius_deg", {.min = 0.05, .max = 45.0}, prop.lamp_radius_deg);
  number("lamp_radiance", {.min = 0.0, .max = 1e4}, prop.lamp_radiance);
  number("ceiling", kRadiance, prop.ceiling);
  number("floor", kRadiance, prop.floor);
  number("background", kRadiance, prop.background);
  number("blur_px", {.min = 0.0, .max = 50.0}, prop.blur_px);
  if (const auto list = object.OptionalNumbers("offset", 3, kLength))
    prop.offset = {(*list)[0], (*list)[1], (*list)[2]};
  if (const Status status = object.Finish(); !status) return Forward(status);
  return prop;
}

Result<Prop> ReadField(StrictObject& object, double radiance) {
  const double level = object.OptionalNumber("radiance", kRadiance).value_or(radiance);
  EvenField field{Eigen::Vector3d::Constant(level)};
  if (const auto list = object.OptionalNumbers("colour", 3, {.min = 0.0, .max = 10.0}))
    field.radiance = level * Eigen::Vector3d((*list)[0], (*list)[1], (*list)[2]);
  if (const Status status = object.Finish(); !status) return Forward(status);
  return field;
}

// A point of the board there, so that its middle is at p_C.
calib::Pose WithMiddleAt(const board::Board& placed, const Eigen::Matrix3d& R_CB,
                         const Eigen::Vector3d& p_C) {
  const Eigen::Vector2d middle = board::BoardPrint(placed).extent().center();
  return {R_CB, p_C - R_CB * Eigen::Vector3d(middle.x(), middle.y(), 0.0)};
}

bool IsInPicture(const HandheldBoard& prop, const calib::Pose& X_CB,
                 const calib::CameraModel& camera) {
  Eigen::AlignedBox2d print = board::BoardPrint(prop.board).extent();
  print.min().array() -= prop.look.quiet_border;
  print.max().array() += prop.look.quiet_border;
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {print.min().x(), print.max().x()})
    for (const double y : {print.min().y(), print.max().y()})
      corners.push_back(X_CB * Eigen::Vector3d(x, y, 0.0));
  for (const Eigen::Vector2d& pixel : camera.Project(corners)) {
    const bool in = pixel.x() >= kPictureMarginPx && pixel.y() >= kPictureMarginPx &&
                    pixel.x() <= camera.width() - 1 - kPictureMarginPx &&
                    pixel.y() <= camera.height() - 1 - kPictureMarginPx;
    if (!in) return false;  // nor where the lens does not reach
  }
  return true;
}

}  // namespace

void ReadLook(StrictObject& object, BoardLook& look) {
  const auto number = [&object](const char* key, Range range, double& value) {
    value = object.OptionalNumber(key, range).value_or(value);
  };
  number("bright", kRadiance, look.bright);
  number("dark", kRadiance, look.dark);
  number("background", kRadiance, look.background);
  number("quiet_border", {.min = 0.0, .max = 1e6}, look.quiet_border);
  number("blur_px", {.min = 0.0, .max = 50.0}, look.blur_px);
}

Result<Prop> ReadProp(StrictObject object) {
  const std::string kind = object.Choice(
      "kind", {"board", "handheld", "ball", "flat", "grey", "dark", "empty", "lamp-off"});
  if (!object.ok()) return Forward(object.Finish());
  if (kind == "ball") return ReadBall(object);
  if (kind == "flat") return ReadField(object, 0.8);
  if (kind == "grey") return ReadField(object, 0.5);
  if (kind == "board" || kind == "handheld") {
    const StrictObject keys = object.Object("board");
    if (!object.ok()) return Forward(object.Finish());
    auto read = board::ReadBoard(keys);
    if (!read) return Forward(read);
    return kind == "board" ? ReadTableBoard(object, std::move(*read))
                           : ReadHandheld(object, std::move(*read));
  }
  if (const Status status = object.Finish(); !status) return Forward(status);
  if (kind == "lamp-off") return LampOff{};
  return EvenField{};
}

calib::Pose PoseOf(const TableBoard& prop) {
  const calib::Pose flat = calib::Turn(Eigen::Vector3d::UnitX(), std::numbers::pi);
  return WithMiddleAt(prop.board, (TurnBy(prop.turn_deg) * flat).rotation, prop.offset);
}

calib::Pose PoseOf(const HandheldBoard& prop, const calib::CameraModel& camera,
                   std::uint64_t picture) {
  const RandomStream random(prop.seed, picture);
  calib::Pose X_CB;
  for (std::uint64_t draw = 0; draw < kMaxDraws; ++draw) {
    const auto uniform = [&](std::uint64_t i, double low, double high) {
      return random.Uniform(8 * draw + i, low, high);
    };
    const double azimuth = uniform(0, 0.0, 2.0 * std::numbers::pi);
    const double tilt = DegToRad(uniform(1, 0.0, prop.tilt_max_deg));
    const double roll = DegToRad(uniform(2, -prop.roll_max_deg, prop.roll_max_deg));
    const Eigen::Vector2d pixel(uniform(3, 0.0, camera.width() - 1.0),
                                uniform(4, 0.0, camera.height() - 1.0));
    const double distance = uniform(5, prop.distance[0], prop.distance[1]);
    const calib::Pose turned = calib::Turn({std::cos(azimuth), std::sin(azimuth), 0.0}, tilt) *
                               calib::Turn(Eigen::Vector3d::UnitZ(), roll);
    const Eigen::Vector3d ray = camera.Unproject({pixel}).front();
    if (!ray.allFinite()) continue;
    X_CB = WithMiddleAt(prop.board, turned.rotation, distance * ray);
    if (IsInPicture(prop, X_CB, camera)) break;
  }
  return X_CB;
}

cv::Mat3f RenderBoard(const board::Board& placed, const BoardLook& look, const calib::Pose& X_CB,
                      const calib::CameraModel& camera) {
  // In levels of the brightest, so that no level is above white.
  const double full = std::max({look.bright, look.dark, look.background, 1e-9});
  BoardPictureOptions options;
  options.bright = look.bright / full;
  options.dark = look.dark / full;
  options.background = look.background / full;
  options.blur_sigma = look.blur_px;
  options.depth = CV_16U;
  const cv::Mat levels = RenderBoards({{placed, X_CB, look.quiet_border}}, camera, options);
  cv::Mat1f radiance;
  levels.convertTo(radiance, CV_32F, full / kFullLevel);
  cv::Mat3f picture;
  cv::merge(std::vector<cv::Mat>(3, radiance), picture);
  return picture;
}

}  // namespace turnlight::rig::sim
