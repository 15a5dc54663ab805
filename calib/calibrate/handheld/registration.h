// Pictures of a camera that is carried by hand, registered: a pose for each that shows the plane,
// and which become keyframes.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/calibrate/handheld/plane_pose.h"
#include "calib/calibrate/handheld/view_change.h"
#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::handheld {

// What one picture shows of the plane; points empty: why it shows none.
struct PlaneView {
  std::string name;
  std::vector<SeenPosition> points;
  std::string why_none;
};

struct RegistrationOptions {
  double step_deg = 10.0;     // between keyframes, above 0, to 180
  double pixel_sigma = 0.1;   // of a point's coordinate, as known beforehand
  double worst_rms_px = 1.0;  // a picture that fits worse is left out
  // Under which turns of B the plane looks the same, the identity left out: B after the turn, in B.
  std::vector<Pose> same_looking;
};

struct RegisteredView {
  std::string name;
  std::optional<PlanePose> pose;  // of B in C
  bool keyframe = false;
  double view_change_deg = 0.0;  // from the nearest keyframe before it
  std::string why_left_out;      // of a picture without a pose
};

// Registers pictures one after the other, in the order in which they were taken. X_BT: the target
// in the plane's frame, whose origin view changes are about. Where the plane looks the same from
// several sides, a picture is taken to be turned as little as possible from the registered one
// before it; one that is turned by nearly half of what would look the same is left out, with that
// reason. A picture whose mirrored tilt would fit as well (PlanePose::mirrored_ratio) is left out
// as well.
class Registration {
 public:
  Registration(CameraModel camera, const Pose& X_BT, RegistrationOptions options)
      : camera_(std::move(camera)),
        X_BT_(X_BT),
        options_(std::move(options)),
        keyframes_(options_.step_deg) {}

  // keyframe: it may become one. It is none before Keep, so that a caller may have reasons of its
  // own against it.
  RegisteredView Register(const PlaneView& view);
  // A view with a pose is a keyframe from now on; and a view direction that was one before.
  void Keep(const RegisteredView& view) { keyframes_.Add(DirectionOf(view)); }
  void Keep(const Eigen::Vector3d& direction) { keyframes_.Add(direction); }
  const ViewChange& keyframes() const { return keyframes_; }
  // The camera in T, of a view with a pose.
  Pose CameraOf(const RegisteredView& view) const { return (view.pose->X_CB * X_BT_).Inverse(); }

 private:
  Eigen::Vector3d DirectionOf(const RegisteredView& view) const {
    return ViewDirection(CameraOf(view));
  }

  CameraModel camera_;
  Pose X_BT_;
  RegistrationOptions options_;
  ViewChange keyframes_;
  std::optional<Pose> before_;
};

// All of them, each that may become a keyframe being one.
std::vector<RegisteredView> RegisterViews(const CameraModel& camera,
                                          const std::vector<PlaneView>& views, const Pose& X_BT,
                                          const RegistrationOptions& options);

}  // namespace turnlight::calib::calibrate::handheld
