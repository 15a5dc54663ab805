#include "estimator/consistency/explanation.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "estimator/consistency/picture_order.h"
#include "estimator/model/direction_lattice.h"

namespace turnlight::estimator::consistency {
namespace {

using Eigen::Vector3d;

constexpr double kRays = 12000.0;                    // of all views
constexpr int kWideLights = 32, kNarrowLights = 96;  // as far apart as their lobes are wide
constexpr int kSweeps = 200;
constexpr float kSettled = 1e-5f;
constexpr int kReassignments = 20;

struct Seen {
  Vector3d normal, mirrored;  // W axes
};

void FillRow(const Seen& seen, const std::vector<Vector3d>& wide,
             const std::vector<Vector3d>& narrow, Eigen::MatrixXf& columns, Eigen::Index row) {
  Eigen::Index at = 0;
  columns(row, at++) = 1.0f;
  const auto lambert = [&](const Vector3d& light) { return std::max(seen.normal.dot(light), 0.0); };
  const auto lobe = [&](const Vector3d& light) {  // cos^5
    const double cosine = seen.mirrored.dot(light), square = cosine * cosine;
    return cosine > 0.0 && seen.normal.dot(light) > 0.0 ? square * square * cosine : 0.0;
  };
  const auto narrow_lobe = [&](const Vector3d& light) {  // cos^40
    const double square = lobe(light) * lobe(light);
    return square * square * square * square;
  };
  for (const Vector3d& light : wide) {
    columns(row, at++) = static_cast<float>(lambert(light));
    columns(row, at++) = static_cast<float>(lobe(light));
  }
  for (const Vector3d& light : narrow) columns(row, at++) = static_cast<float>(narrow_lobe(light));
}

// The x >= 0 that minimises |A x - y|^2, by turns: gram = A^T A, b = A^T y.
Eigen::VectorXf NonNegative(const Eigen::MatrixXf& gram, const Eigen::VectorXf& b) {
  Eigen::VectorXf x = Eigen::VectorXf::Zero(b.size());
  Eigen::VectorXf slope = b;  // b - gram x
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    float gain = 0.0f;
    for (Eigen::Index j = 0; j < b.size(); ++j) {
      if (gram(j, j) <= 0.0f) continue;
      const float step = std::max(slope[j] / gram(j, j), -x[j]);
      if (step == 0.0f) continue;
      gain += step * (2.0f * slope[j] - step * gram(j, j));
      x[j] += step;
      slope -= step * gram.col(j);
    }
    if (gain <= kSettled * b.dot(x)) break;
  }
  return x;
}

using Order = std::vector<std::size_t>;
}  // namespace

Explainer::Explainer(const SmallViews& views, const target::Geometry& geometry,
                     const calib::RayGrid& rays, const StopFlag* stop)
    : geometry_(geometry),
      rays_(rays),
      stop_(stop),
      wide_(model::SphereDirections(kWideLights)),
      narrow_(model::SphereDirections(kNarrowLights)) {
  const double pixels = static_cast<double>(views.views.size()) * rays.width() * rays.height();
  const auto stride =
      static_cast<std::uint32_t>(std::max(1.0, std::floor(std::sqrt(pixels / kRays))));
  for (std::uint32_t row = stride / 2; row < static_cast<std::uint32_t>(rays.height());
       row += stride)
    for (std::uint32_t column = stride / 2; column < static_cast<std::uint32_t>(rays.width());
         column += stride)
      samples_.push_back({row, column});
  for (const SmallView& view : views.views) {
    const cv::Mat1f masked = Masked(view);
    std::vector<float>& values = radiance_.emplace_back();
    std::vector<bool>& inside = inside_.emplace_back();
    for (const Sampled& sample : samples_) {
      const int row = static_cast<int>(sample.row), column = static_cast<int>(sample.column);
      values.push_back(masked(row, column));
      inside.push_back(view.mask(row, column) != 0);
    }
  }
}

Design Explainer::DesignOf(const std::vector<calib::RigPoses>& poses) const {
  Design out;
  out.seen.resize(poses.size());
  std::vector<std::vector<Seen>> seen(poses.size());
  ParallelFor(poses.size(), [&](std::size_t k) {
    const calib::Pose X_TC = poses[k].X_WT.Inverse() * poses[k].X_WC;
    for (std::uint32_t s = 0; s < samples_.size(); ++s) {
      const Vector3d ray =
          rays_.Ray(static_cast<int>(samples_[s].column), static_cast<int>(samples_[s].row));
      if (!ray.allFinite()) continue;
      const Vector3d direction = X_TC.rotation * ray;
      const auto hit = geometry_.Intersect(X_TC.translation, direction);
      if (!hit) continue;
      const Vector3d v = -direction;
      out.seen[k].push_back(s);
      seen[k].push_back({poses[k].X_WT.rotation * hit->normal,
                         poses[k].X_WT.rotation * (2.0 * hit->normal.dot(v) * hit->normal - v)});
    }
  });
  Eigen::Index rows = 0;
  for (const auto& of_pose : seen) rows += static_cast<Eigen::Index>(of_pose.size());
  out.columns.resize(rows, 1 + 2 * kWideLights + kNarrowLights);
  Eigen::Index row = 0;
  for (const auto& of_pose : seen)
    for (const Seen& one : of_pose) FillRow(one, wide_, narrow_, out.columns, row++);
  out.gram = Eigen::MatrixXf::Zero(out.columns.cols(), out.columns.cols());
  if (rows == 0) return out;
  out.gram.selfadjointView<Eigen::Lower>().rankUpdate(out.columns.transpose());
  out.gram = Eigen::MatrixXf(out.gram.selfadjointView<Eigen::Lower>());
  return out;
}

Explainer::Fit Explainer::FitTo(const Design& design, const Order& picture) const {
  Eigen::VectorXf y(design.columns.rows());
  Eigen::Index row = 0;
  double beside = 0.0, beside_squares = 0.0;  // sums over what is not the target
  std::size_t count = 0;
  for (std::size_t k = 0; k < picture.size(); ++k) {
    const std::vector<float>& values = radiance_[picture[k]];
    std::size_t next = 0;
    for (std::uint32_t s = 0; s < samples_.size(); ++s) {
      const auto value = static_cast<double>(values[s]);
      if (next < design.seen[k].size() && design.seen[k][next] == s) {
        y[row++] = values[s];
        ++next;
      } else {
        beside += value;
        beside_squares += value * value;
        ++count;
      }
    }
  }
  Fit out;
  out.beside = count > 0 ? beside / static_cast<double>(count) : 0.0;
  double left = beside_squares - out.beside * beside;
  if (y.size() > 0) {
    out.model = design.columns * NonNegative(design.gram, design.columns.transpose() * y);
    left += static_cast<double>((y - out.model).squaredNorm());
  }
  const double all = static_cast<double>(samples_.size()) * static_cast<double>(picture.size());
  out.residual = std::isfinite(left) ? std::sqrt(std::max(left, 0.0) / all) : HUGE_VAL;
  return out;
}

double Explainer::Residual(const Design& design, const Order& picture) const {
  return StopRequested(stop_) ? HUGE_VAL : FitTo(design, picture).residual;
}

double Explainer::ShareInMasks(const Design& design, const Order& picture) const {
  std::size_t all = 0, inside = 0;
  for (std::size_t k = 0; k < picture.size(); ++k) {
    all += design.seen[k].size();
    for (const std::uint32_t s : design.seen[k]) inside += inside_[picture[k]][s] ? 1 : 0;
  }
  return all > 0 ? static_cast<double>(inside) / static_cast<double>(all) : 0.0;
}

Order Explainer::Reassigned(const Design& design, Order picture) const {
  const auto count = static_cast<Eigen::Index>(picture.size());
  for (int round = 0; round < kReassignments && !StopRequested(stop_); ++round) {
    const Fit fit = FitTo(design, picture);
    Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(count, count);
    Eigen::Index first = 0;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto& seen = design.seen[static_cast<std::size_t>(k)];
      for (Eigen::Index v = 0; v < count; ++v) {
        const std::vector<float>& values = radiance_[static_cast<std::size_t>(v)];
        for (std::size_t i = 0; i < seen.size(); ++i) {
          const auto value = static_cast<double>(values[seen[i]]);
          const auto model = static_cast<double>(fit.model[first + static_cast<Eigen::Index>(i)]);
          // Against what it would leave as a pixel beside the target.
          cost(k, v) +=
              (value - model) * (value - model) - (value - fit.beside) * (value - fit.beside);
        }
      }
      first += static_cast<Eigen::Index>(seen.size());
    }
    Order next = Exchanged(cost, picture);
    if (next == picture) break;
    picture = std::move(next);
  }
  return picture;
}

}  // namespace turnlight::estimator::consistency
