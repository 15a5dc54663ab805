// The closure check: after the last keyframe the first view is photographed once more, whole turns
// later. If the table kept its place the two pictures differ by their noise only; a table without
// an encoder that lost steps, a target that slid and a lamp that drifted are seen nowhere else.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/result.h"
#include "rig/capture/frame_check.h"

namespace turnlight::rig {

// The check fails if the pictures differ both by more than noise explains and by more than matters:
// FrameDifference::block_sigmas and block_share.
inline constexpr double kClosureSigmas = 2.0;
inline constexpr double kClosureShare = 0.002;

struct ClosureCheck {
  double first_deg = 0.0;
  double closure_deg = 0.0;
  FrameDifference difference;
  bool closed = false;
  std::string text;  // measured against allowed, and what to do if it is not closed
};

// Of two pictures of one size and type, with what their DN mean.
ClosureCheck CompareClosure(double first_deg, const cv::Mat& first, double closure_deg,
                            const cv::Mat& closure, const calib::Radiometry& radiometry);

// Of a finished session, from what is on disk. Nothing if it was not captured with a closure frame.
// Fails (kInput): pictures that cannot be read or compared.
Result<std::optional<ClosureCheck>> CheckClosure(const std::filesystem::path& session);

}  // namespace turnlight::rig
