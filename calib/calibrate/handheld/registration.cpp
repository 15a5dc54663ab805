#include "calib/calibrate/handheld/registration.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

// By how much the next same-looking pose must be further away than the one that is taken.
constexpr double kClearTurnDeg = 20.0;
// Of rms, for the mirrored tilt to be ruled out: with four points or more and normal noise less
// than one in a hundred pictures exceeds it by chance.
constexpr double kClearMirrorRatio = 2.0;

double TurnDeg(const Pose& to, const Pose& from) {
  return RadToDeg(Eigen::AngleAxisd(from.rotation.transpose() * to.rotation).angle());
}

// The same picture, with B turned; the covariance is in C's axes, and stays but for the shift of
// the origin.
PlanePose Renumbered(const PlanePose& pose, const Pose& turn) {
  PlanePose turned = pose;
  turned.X_CB = pose.X_CB * turn;
  // t' = t + R s, so a rotation by w moves it by d + w x (R s).
  const Eigen::Vector3d arm = turned.X_CB.translation - pose.X_CB.translation;
  Eigen::Matrix<double, 6, 6> carry = Eigen::Matrix<double, 6, 6>::Identity();
  carry.block<3, 3>(3, 0) << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
  turned.covariance = carry * pose.covariance * carry.transpose();
  return turned;
}

// Turned as little as possible from the one before; nothing if two are about as near.
std::optional<PlanePose> Nearest(const PlanePose& pose, const Pose& before,
                                 const std::vector<Pose>& same_looking) {
  std::vector<PlanePose> all{pose};
  for (const Pose& turn : same_looking) all.push_back(Renumbered(pose, turn));
  std::stable_sort(all.begin(), all.end(), [&](const PlanePose& a, const PlanePose& b) {
    return TurnDeg(a.X_CB, before) < TurnDeg(b.X_CB, before);
  });
  if (all.size() > 1 && TurnDeg(all[1].X_CB, before) - TurnDeg(all[0].X_CB, before) < kClearTurnDeg)
    return std::nullopt;
  return all.front();
}

std::string WhyNotUsable(const PlanePose& pose, const RegistrationOptions& options) {
  if (pose.rms_px > options.worst_rms_px)
    return Format(
        "the points are %.2f px rms off, allowed is %g: another lens, a wrong size, a blurred "
        "picture",
        pose.rms_px, options.worst_rms_px);
  if (pose.mirrored_ratio < kClearMirrorRatio)
    return "the plane is too small or too far away in it: its tilt could be the mirrored one as "
           "well; take it from closer, or more at a slant";
  return "";
}

RegisteredView RegisterOne(const CameraModel& camera, const PlaneView& view,
                           const std::optional<Pose>& before, const RegistrationOptions& options) {
  RegisteredView registered;
  registered.name = view.name;
  if (view.points.empty()) {
    registered.why_left_out = view.why_none;
    return registered;
  }
  auto pose = EstimatePlanePose(camera, view.points, options.pixel_sigma);
  registered.why_left_out = pose ? WhyNotUsable(*pose, options) : pose.error().text;
  if (!registered.why_left_out.empty()) return registered;
  registered.pose = before ? Nearest(*pose, *before, options.same_looking) : std::move(*pose);
  if (!registered.pose)
    registered.why_left_out =
        "which side is up cannot be told: the board looks the same from several sides, and the "
        "camera was "
        "turned by too much since the picture before";
  return registered;
}

}  // namespace

RegisteredView Registration::Register(const PlaneView& view) {
  RegisteredView registered = RegisterOne(camera_, view, before_, options_);
  if (!registered.pose) return registered;
  before_ = registered.pose->X_CB;
  const Eigen::Vector3d direction = DirectionOf(registered);
  registered.view_change_deg = keyframes_.NearestDeg(direction).value_or(0.0);
  registered.keyframe = keyframes_.IsKeyframe(direction);
  return registered;
}

std::vector<RegisteredView> RegisterViews(const CameraModel& camera,
                                          const std::vector<PlaneView>& views, const Pose& X_BT,
                                          const RegistrationOptions& options) {
  Registration registration(camera, X_BT, options);
  std::vector<RegisteredView> all;
  for (const PlaneView& view : views) {
    all.push_back(registration.Register(view));
    if (all.back().keyframe) registration.Keep(all.back());
  }
  return all;
}

}  // namespace turnlight::calib::calibrate::handheld
