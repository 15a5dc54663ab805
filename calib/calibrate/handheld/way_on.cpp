#include "calib/calibrate/handheld/way_on.h"

#include <cmath>
#include <utility>

#include "base/angles.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

constexpr double kLowestDeg = 20.0;  // above the board
constexpr double kTrialDeg = 1.0;
constexpr int kTrials = 180;

}  // namespace

std::string WayOn(const ViewChange& keyframes, const Pose& X_TC, const Eigen::Vector3d& up_T) {
  const Eigen::Vector3d here = ViewDirection(X_TC);
  const Eigen::Vector3d right = X_TC.rotation.col(0), down = X_TC.rotation.col(1);
  const std::pair<const char*, Eigen::Vector3d> ways[] = {
      {"to the left", -right}, {"to the right", right}, {"up", -down}, {"down", down}};
  const double lowest = std::sin(DegToRad(kLowestDeg));
  for (int trial = 1; trial <= kTrials; ++trial)
    for (const auto& [word, way] : ways) {
      const Eigen::Vector3d aside = (way - here * here.dot(way)).normalized();
      const double angle = DegToRad(kTrialDeg * trial);
      const Eigen::Vector3d there = std::cos(angle) * here + std::sin(angle) * aside;
      if (there.dot(up_T) > lowest && keyframes.IsKeyframe(there)) return word;
    }
  return "on, to where none was taken yet";
}

}  // namespace turnlight::calib::calibrate::handheld
