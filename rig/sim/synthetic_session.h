// A seeded scene generator: sessions whose lights and reflectance are known exactly, in memory for
// tests and on disk for everything else.
//
// Everything random is keyed by (seed, what it is for, index): the same config gives the same bits
// for any number of threads.
#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/pose.h"
#include "calib/radiometry.h"
#include "calib/target_shape.h"
#include "estimator/model/keyframe.h"
#include "estimator/model/scene.h"
#include "rig/sim/synthetic_config.h"

namespace turnlight::rig::sim {

struct SyntheticFrame {
  cv::Mat image;   // DN; R, G, B; CV_8U, CV_16U or CV_32F, h x w
  cv::Mat1b mask;  // 255 where any of the pixel's footprint is on the target, else 0
  calib::Pose X_WC;
  calib::Pose X_WT;
  double angle_deg = 0.0;
  calib::Exposure exposure;
};

struct SyntheticSession {
  calib::CameraModel camera;
  calib::TargetShape target;
  calib::Radiometry radiometry;  // references filled in
  std::vector<SyntheticFrame> frames;
  estimator::model::Scene scene;  // the truth
};

// Fails (kInput): what Validate refuses, lights that cannot be placed as far apart as asked.
Result<SyntheticSession> SynthesizeInMemory(const SyntheticConfig& config);

// The frames as the estimator takes them.
std::vector<estimator::model::Keyframe> ToKeyframes(const SyntheticSession& session);

// Called after each frame; false stops.
using FrameProgress = std::function<bool(std::size_t done, std::size_t total)>;

struct SyntheticReport {
  double clipped_share = 0.0;        // of the target's pixels, over all frames
  std::vector<std::string> remarks;  // what the user should know: unexpected clipping, empty frames
  bool stopped = false;              // by the progress function; no session.json was written
};

// Writes a whole session with checksums, and truth.json, into root (created if needed).
// session.json comes last: a folder without it is not a session.
Result<SyntheticReport> WriteSynthetic(const SyntheticConfig& config,
                                       const std::filesystem::path& root,
                                       const FrameProgress& progress = {});

}  // namespace turnlight::rig::sim
