// A session of pictures that were taken by hand, once their poses are known.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"
#include "calib/camera_model.h"
#include "calib/pose.h"
#include "calib/radiometry.h"
#include "calib/target_shape.h"

namespace turnlight::app {

struct HandheldKeyframe {
  std::filesystem::path picture;
  calib::Pose X_WC;
};

struct HandheldSession {
  std::string name;
  calib::CameraModel camera;
  calib::Radiometry radiometry;
  std::variant<calib::SphereShape, calib::PlaneShape, std::filesystem::path>
      target;  // a mesh's file
  calib::Pose X_WT;
  std::vector<HandheldKeyframe> keyframes;
};

// Copies mesh and pictures byte for byte into a new or empty folder, a JPEG as the PNG of its
// values, and writes the session there, in mm, session.json last. Fails (kInput): a folder with
// something in it, a picture that a session cannot have.
Status WriteHandheldSession(const HandheldSession& session, const std::filesystem::path& out);

}  // namespace turnlight::app
