// A session whose target is a mirror ball, as what lights are found from.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/probe/ball.h"
#include "calib/calibrate/probe/lights.h"
#include "calib/calibrate/probe/spots.h"
#include "rig/rig_calibration.h"
#include "rig/session/session.h"

namespace turnlight::calib::calibrate::probe {

struct ProbeOptions {
  // Where the ball is on the table is found from its outlines (masks, or edges in the pictures near
  // where the session says), one place in T for all frames; otherwise the session says.
  bool sphere_from_outline = false;
  double center_sigma =
      0.0;  // length unit, per axis of T; of the session's place, not the outlines'
  double radius_sigma = 0.0;  // length unit
  // Whose covariances of X_WC, X_WA and X_AT are propagated.
  std::optional<rig::RigCalibration> calibration;
};

struct ProbeSession {
  std::unique_ptr<RayGrid> rays;
  std::unique_ptr<rig::Session> session;
  std::vector<BallView> views;           // of the frames
  std::vector<std::vector<Spot>> spots;  // of the frames
  std::vector<Perturbation> perturbations;
  std::vector<cv::Mat> pictures;            // linear radiance, of the frames
  std::optional<Eigen::Vector3d> center_T;  // from outlines
  std::optional<Eigen::Vector3d> center_sigma_T;
  std::vector<std::string> notes;  // for people, one sentence each
};

// step is called as each frame is done, and may end the work by returning false (kInterrupted).
// Fails (kInput): what ReadSession and ReadFrameImages refuse, a target that is no sphere, outlines
// that give none, a calibration in another unit of length.
Result<ProbeSession> ReadProbeSession(const std::filesystem::path& folder,
                                      const ProbeOptions& options,
                                      const std::function<bool()>& step);

// Several sessions of one room as one: views, spots and perturbations in order. A perturbation of
// one session leaves the others' views alone.
struct ProbeInput {
  std::vector<BallView> views;
  std::vector<std::vector<Spot>> spots;
  std::vector<Perturbation> perturbations;
};
ProbeInput Joined(const std::vector<ProbeSession>& sessions);

}  // namespace turnlight::calib::calibrate::probe
