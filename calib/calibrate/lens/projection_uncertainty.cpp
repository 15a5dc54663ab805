#include "calib/calibrate/lens/projection_uncertainty.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"

extern "C" {
#include <mrcal/mrcal.h>
}

namespace turnlight::calib::calibrate::lens {
namespace {

// The pixel's derivatives: by the intrinsics that move it (a splined lens has few of many), then by
// the six of the motion.
struct Gradient {
  std::vector<Eigen::Index> columns;
  Eigen::Matrix<double, 2, Eigen::Dynamic> values;
};

Gradient GradientAt(const mrcal_lensmodel_t& model, const std::vector<double>& intrinsics,
                    const Eigen::Vector3d& p, bool at_infinity) {
  const std::size_t count = intrinsics.size();
  const mrcal_point3_t point{{p.x(), p.y(), p.z()}};
  mrcal_point2_t pixel;
  std::array<mrcal_point3_t, 2> by_point;
  std::vector<double> by_intrinsics(2 * count);
  mrcal_project(&pixel, by_point.data(), by_intrinsics.data(), &point, 1, &model,
                intrinsics.data());
  Gradient gradient;
  for (std::size_t i = 0; i < count; ++i)
    if (by_intrinsics[i] != 0.0 || by_intrinsics[count + i] != 0.0)
      gradient.columns.push_back(static_cast<Eigen::Index>(i));
  const auto used = static_cast<Eigen::Index>(gradient.columns.size());
  const Eigen::Index motion = at_infinity ? 3 : 6;
  gradient.values.resize(2, used + motion);
  for (int row = 0; row < 2; ++row) {
    for (Eigen::Index i = 0; i < used; ++i)
      gradient.values(row, i) =
          by_intrinsics[static_cast<std::size_t>(row) * count +
                        static_cast<std::size_t>(gradient.columns[static_cast<std::size_t>(i)])];
    const mrcal_point3_t& d = by_point[static_cast<std::size_t>(row)];
    const Eigen::Vector3d dq_dp(d.x, d.y, d.z);
    // p moves by w x p + t.
    gradient.values.block<1, 3>(row, used) = p.cross(dq_dp).transpose();
    if (!at_infinity) gradient.values.block<1, 3>(row, used + 3) = dq_dp.transpose();
  }
  for (Eigen::Index i = 0; i < motion; ++i)
    gradient.columns.push_back(static_cast<Eigen::Index>(count) + i);
  return gradient;
}

}  // namespace

double WorstSigma(const Eigen::Matrix2d& c) {
  const double mean = 0.5 * (c(0, 0) + c(1, 1)), half = 0.5 * (c(0, 0) - c(1, 1));
  return std::sqrt(mean + std::sqrt(half * half + c(0, 1) * c(1, 0)));
}

Eigen::MatrixXd PixelDerivatives(const CameraModel& camera,
                                 const std::vector<Eigen::Vector2d>& pixels) {
  mrcal_lensmodel_t model{};
  mrcal_lensmodel_from_name(&model, camera.lens_model().c_str());
  const auto rays = camera.Unproject(pixels);
  Eigen::MatrixXd derivatives =
      Eigen::MatrixXd::Zero(2 * static_cast<Eigen::Index>(pixels.size()),
                            static_cast<Eigen::Index>(camera.intrinsics().size()) + 3);
  ParallelFor(pixels.size(), [&](std::size_t i) {
    auto rows = derivatives.middleRows<2>(2 * static_cast<Eigen::Index>(i));
    if (rays[i].hasNaN()) {
      rows.setConstant(std::numeric_limits<double>::quiet_NaN());
      return;
    }
    const Gradient gradient = GradientAt(model, camera.intrinsics(), rays[i], true);
    for (std::size_t k = 0; k < gradient.columns.size(); ++k)
      rows.col(gradient.columns[k]) = gradient.values.col(static_cast<Eigen::Index>(k));
  });
  return derivatives;
}

std::vector<Eigen::Matrix2d> ProjectionUncertainty::At(const std::vector<Eigen::Vector2d>& pixels,
                                                       std::optional<double> distance) const {
  mrcal_lensmodel_t model{};
  mrcal_lensmodel_from_name(&model, camera_.lens_model().c_str());
  const auto rays = camera_.Unproject(pixels);
  std::vector<Eigen::Matrix2d> result(
      pixels.size(), Eigen::Matrix2d::Constant(std::numeric_limits<double>::quiet_NaN()));
  ParallelFor(pixels.size(), [&](std::size_t i) {
    if (rays[i].hasNaN()) return;
    const Gradient gradient = GradientAt(model, camera_.intrinsics(),
                                         distance.value_or(1.0) * rays[i], !distance.has_value());
    const auto size = static_cast<Eigen::Index>(gradient.columns.size());
    Eigen::MatrixXd part(size, size);
    for (Eigen::Index r = 0; r < size; ++r)
      for (Eigen::Index c = 0; c < size; ++c)
        part(r, c) = covariance_(gradient.columns[static_cast<std::size_t>(r)],
                                 gradient.columns[static_cast<std::size_t>(c)]);
    result[i] = gradient.values * part * gradient.values.transpose();
  });
  return result;
}

}  // namespace turnlight::calib::calibrate::lens
