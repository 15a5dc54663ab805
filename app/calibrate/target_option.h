// A target's shape, as options name it: --sphere, --plane or --mesh.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"
#include "calib/target_shape.h"

namespace turnlight::app {

struct TargetWords {
  std::vector<double> plane;  // width, height
  double sphere = 0.0;        // radius
  std::string mesh;           // file
  bool given() const { return !plane.empty() || sphere > 0.0 || !mesh.empty(); }
};

void AddTargetShapeOptions(CLI::App& command, TargetWords& words);

// A mesh's file unread. Fails (kInput) unless exactly one shape is given.
Result<std::variant<calib::SphereShape, calib::PlaneShape, std::filesystem::path>> NamedTarget(
    const TargetWords& words);

// The same, read.
Result<calib::TargetShape> ReadTargetShape(const TargetWords& words);

}  // namespace turnlight::app
