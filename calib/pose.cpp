#include "calib/pose.h"

#include <cmath>

#include "base/format.h"

namespace turnlight::calib {
namespace {

constexpr double kOrthonormalTolerance = 1e-6;
// Numbers of three decimal places or more are off by no more.
constexpr double kOfRounding = 3e-3;

}  // namespace

Result<Pose> PoseFromRows(const std::vector<double>& rows, const std::string& what) {
  if (rows.size() != 12)
    return InputError(what + ": " + std::to_string(rows.size()) +
                      " numbers, allowed is 3 rows of 4 numbers [R | t]");
  Pose pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      const double value = rows[static_cast<std::size_t>(4 * r + c)];
      if (!std::isfinite(value))
        return InputError(what + ": row " + std::to_string(r) + ", column " + std::to_string(c) +
                          " is " + NumberText(value) + ", allowed is a finite number");
      if (c < 3)
        pose.rotation(r, c) = value;
      else
        pose.translation(r) = value;
    }
  }
  const Eigen::Matrix3d gram = pose.rotation.transpose() * pose.rotation;
  const double deviation = (gram - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  // Written so that an overflow to infinity or NaN is refused too.
  if (!(deviation <= kOrthonormalTolerance))
    return InputError(
        what +
        ": the rotation is not orthonormal: its columns are not of length 1 and at "
        "right angles (the largest element of |R'R - I| is " +
        NumberText(deviation) + ", allowed is at most 1e-06)" +
        (deviation < kOfRounding ? "; were its numbers rounded? Write more digits" : ""));
  const double determinant = pose.rotation.determinant();
  if (determinant < 0.0)
    return InputError(what + ": the rotation is a reflection: its determinant is " +
                      NumberText(determinant) + ", allowed is +1");
  return pose;
}

std::vector<double> RowsFromPose(const Pose& pose) {
  std::vector<double> rows;
  rows.reserve(12);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) rows.push_back(pose.rotation(r, c));
    rows.push_back(pose.translation(r));
  }
  return rows;
}

}  // namespace turnlight::calib
