#include "estimator/observe/highlight_spots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/angles.h"
#include "base/statistics.h"
#include "estimator/observe/trace_pixels.h"

namespace turnlight::estimator::observe {
namespace {

constexpr std::array<double, 4> kScales{1.0, 2.0, 4.0, 8.0};  // pixels
constexpr double kSurround = 2.5;                             // scales
constexpr int kWidest = 512;                                  // pixels of the target
constexpr double kLeastContrast = 0.12, kLeastSigmas = 4.0;
constexpr double kTexture = 0.015;  // of the surround
constexpr double kFloor = 0.001;    // of the brightest
constexpr double kOfPeak = 0.3;
constexpr double kApartDeg = 7.0, kClusterDeg = 8.0;
constexpr double kLeastInside = 0.2;         // of a mean's weight
constexpr double kWidestScale = 1.0 / 17.0;  // of the target's width; beyond, shading is as bright
// Inverse distances that lights are tried at, in 1/R.
constexpr std::array<double, 6> kDistances{0.0, 0.05, 0.1, 0.2, 0.35, 0.5};

// A picture of the target alone, reduced so that it is at most kWidest wide.
struct Reduced {
  cv::Mat1f value, inside;  // mean over the pixels inside; their share
  cv::Point corner;         // of the picture
  int by = 1;
};

Reduced Reduce(const cv::Mat1f& grey, const cv::Mat1b& inside) {
  Reduced out;
  const cv::Rect box = cv::boundingRect(inside);
  if (box.empty()) return out;
  out.corner = box.tl();
  out.by = std::max((std::max(box.width, box.height) + kWidest - 1) / kWidest, 1);
  cv::Mat1f share;
  inside(box).convertTo(share, CV_32F, 1.0 / 255.0);
  cv::Mat1f sum = grey(box).mul(share);
  if (out.by > 1) {
    const cv::Size size((box.width + out.by - 1) / out.by, (box.height + out.by - 1) / out.by);
    for (cv::Mat1f* of : {&sum, &share}) {
      cv::Mat1f whole;
      cv::copyMakeBorder(*of, whole, 0, size.height * out.by - box.height, 0,
                         size.width * out.by - box.width, cv::BORDER_CONSTANT, cv::Scalar(0.0));
      cv::resize(whole, *of, size, 0.0, 0.0, cv::INTER_AREA);
    }
  }
  out.inside = share;
  out.value = sum / cv::max(share, 1e-6f);
  return out;
}

struct Peak {
  cv::Point at;
  double scale, surround, contrast, sigmas;
};

// Where a scale's difference of Gaussians is largest among its neighbours and clear; not at the
// edge, where what gets brighter outwards ends.
void AddPeaks(const Reduced& picture, double scale, double brightest, double noise,
              std::vector<Peak>& peaks) {
  cv::Mat1f weight;
  const cv::Mat1f around = MeanInside(picture.value, picture.inside, kSurround * scale, &weight);
  const cv::Mat1f difference = MeanInside(picture.value, picture.inside, scale) - around;
  for (int y = 1; y + 1 < difference.rows; ++y)
    for (int x = 1; x + 1 < difference.cols; ++x) {
      if (picture.inside(y, x) < 0.5f || weight(y, x) < static_cast<float>(kLeastInside)) continue;
      const double value = difference(y, x);
      const double surround = std::max(static_cast<double>(around(y, x)), 0.0);
      const double sigma = std::hypot(kFloor * brightest, kTexture * surround, noise);
      if (!(value > kLeastContrast * surround) || !(value > kLeastSigmas * sigma)) continue;
      bool largest = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          largest &= picture.inside(y + dy, x + dx) >= 0.5f && difference(y + dy, x + dx) <= value;
      if (largest)
        peaks.push_back({{x, y},
                         scale,
                         surround,
                         value / std::max(surround, kFloor * brightest),
                         value / sigma});
    }
}

// What is bright and together around the peak: its mean mirrored view and place, and how far the
// view turns there. Its direction is zero if that meets nothing.
Spot CentroidOf(const Reduced& picture, const Peak& peak, const PixelTracer& tracer) {
  const int reach = static_cast<int>(std::ceil(3.0 * peak.scale)) + 2;
  double top = 0.0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (picture.inside(peak.at.y + dy, peak.at.x + dx) >= 0.5f)
        top = std::max(top, static_cast<double>(picture.value(peak.at.y + dy, peak.at.x + dx)));
  const double least = peak.surround + kOfPeak * (top - peak.surround);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), place = sum;
  double weights = 0.0, turn = 0.0;
  std::vector<cv::Point> waiting{peak.at};
  cv::Mat1b seen(2 * reach + 1, 2 * reach + 1, std::uint8_t{0});
  seen(reach, reach) = 1;
  while (!waiting.empty()) {
    const cv::Point p = waiting.back();
    waiting.pop_back();
    const auto pixel = tracer.Trace(picture.corner.x + p.x * picture.by + picture.by / 2,
                                    picture.corner.y + p.y * picture.by + picture.by / 2);
    if (pixel) {
      const double weight = static_cast<double>(picture.value(p)) - peak.surround;
      sum += weight * pixel->mirrored;
      place += weight * pixel->position;
      turn += weight * std::sqrt(0.5 * (pixel->dw_du.squaredNorm() + pixel->dw_dv.squaredNorm()));
      weights += weight;
    }
    for (const cv::Point step : {cv::Point(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      const cv::Point q = p + step, local = q - peak.at + cv::Point(reach, reach);
      if (!cv::Rect({0, 0}, seen.size()).contains(local) || seen(local) != 0) continue;
      if (!cv::Rect({0, 0}, picture.value.size()).contains(q)) continue;
      seen(local) = 1;
      if (picture.inside(q) >= 0.5f && static_cast<double>(picture.value(q)) > least)
        waiting.push_back(q);
    }
  }
  Spot out;
  out.direction.setZero();
  if (!(sum.norm() > 0.0) || !(weights > 0.0)) return out;
  out.direction = sum.normalized();
  out.position = place / weights;
  out.turn = turn / weights * picture.by;
  out.contrast = peak.contrast;
  out.sigmas = peak.sigmas;
  return out;
}

}  // namespace

cv::Mat1f GreyOf(const cv::Mat& radiance) {
  cv::Mat1f grey;
  if (radiance.channels() == 1)
    grey = radiance.clone();
  else
    cv::transform(radiance, grey, cv::Matx13f(1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f));
  for (float& value : grey)
    if (!std::isfinite(value)) value = 0.0f;
  return grey;
}

cv::Mat1f MeanInside(const cv::Mat1f& value, const cv::Mat1f& inside, double sigma,
                     cv::Mat1f* weight) {
  const auto blurred = [sigma](const cv::Mat1f& of) {
    cv::Mat1f out;
    cv::GaussianBlur(of, out, cv::Size(), sigma, sigma, cv::BORDER_CONSTANT);
    return out;
  };
  const cv::Mat1f share = blurred(inside);
  if (weight != nullptr) *weight = share;
  return blurred(value.mul(inside)) / cv::max(share, 1e-6f);
}

double NoiseOf(const cv::Mat1f& grey, const cv::Mat1b& inside) {
  std::vector<float> differences;
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 1; x + 1 < grey.cols; ++x)
      if (inside(y, x - 1) != 0 && inside(y, x) != 0 && inside(y, x + 1) != 0)
        differences.push_back(std::abs(grey(y, x - 1) - 2.0f * grey(y, x) + grey(y, x + 1)));
  if (differences.empty()) return 0.0;
  return static_cast<double>(Median(differences)) / kMedianOfNormal / std::sqrt(6.0);
}

std::vector<Spot> FindSpots(const model::Keyframe& keyframe, std::size_t index,
                            const cv::Mat1b& inside, const target::Geometry& geometry,
                            const calib::RayGrid& rays) {
  const Reduced picture = Reduce(GreyOf(keyframe.image.radiance), inside);
  std::vector<Spot> out;
  if (picture.value.empty()) return out;
  double brightest = 0.0;
  cv::minMaxLoc(MeanInside(picture.value, picture.inside, kScales[0]), nullptr, &brightest, nullptr,
                nullptr, picture.inside > 0.5);
  const double noise = NoiseOf(picture.value, picture.inside > 0.5f);
  std::vector<Peak> peaks;
  const double widest = kWidestScale * std::max(picture.value.cols, picture.value.rows);
  for (const double scale : kScales)
    if (scale == kScales[0] || scale <= widest)
      AddPeaks(picture, scale, brightest, noise / scale, peaks);
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const Peak& a, const Peak& b) { return a.sigmas > b.sigmas; });
  const PixelTracer tracer({keyframe.X_WC, keyframe.X_WT}, geometry, rays);
  const double cosine = std::cos(DegToRad(kApartDeg));
  for (const Peak& peak : peaks) {
    Spot spot = CentroidOf(picture, peak, tracer);
    spot.keyframe = index;
    if (spot.direction.isZero(0.0)) continue;
    const auto close = [&](const Spot& known) {
      return known.direction.dot(spot.direction) > cosine;
    };
    if (std::none_of(out.begin(), out.end(), close)) out.push_back(spot);
  }
  return out;
}

namespace {

// The direction from the reference of a light at this inverse distance (1/R) that is seen along
// `direction` from x (in R about the reference): |s direction + rho x| = 1 has one positive s.
Eigen::Vector3d FromReference(const Eigen::Vector3d& direction, const Eigen::Vector3d& x,
                              double rho) {
  const double along = rho * direction.dot(x);
  const double s = -along + std::sqrt(std::max(along * along + 1.0 - rho * rho * x.dot(x), 0.0));
  return (s * direction + rho * x).normalized();
}

std::vector<SpotCluster> ClustersAt(const std::vector<Spot>& order,
                                    const Eigen::Vector3d& reference, double radius, double rho) {
  const double cosine = std::cos(DegToRad(kClusterDeg));
  struct Sum {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0.0;
    std::size_t views = 0;
  };
  std::vector<Sum> sums;
  for (const Spot& spot : order) {
    const Eigen::Vector3d direction =
        FromReference(spot.direction, (spot.position - reference) / radius, rho);
    const auto own = std::find_if(sums.begin(), sums.end(), [&](const Sum& sum) {
      return sum.sum.normalized().dot(direction) > cosine;
    });
    Sum& sum = own == sums.end() ? sums.emplace_back() : *own;
    sum.sum += direction / std::max(spot.turn * spot.turn, 1e-12);
    sum.squares += spot.sigmas * spot.sigmas;
    ++sum.views;
  }
  std::vector<SpotCluster> out;
  for (const Sum& sum : sums)
    out.push_back({sum.sum.normalized(), rho, std::sqrt(sum.squares), sum.views});
  std::stable_sort(out.begin(), out.end(),
                   [](const SpotCluster& a, const SpotCluster& b) { return a.sigmas > b.sigmas; });
  return out;
}

}  // namespace

std::vector<SpotCluster> ClusterSpots(const std::vector<Spot>& spots,
                                      const Eigen::Vector3d& reference, double radius) {
  // Where a pixel tells most first: those say best what belongs together.
  std::vector<Spot> order = spots;
  std::stable_sort(order.begin(), order.end(),
                   [](const Spot& a, const Spot& b) { return a.turn < b.turn; });
  std::vector<SpotCluster> best;
  for (const double rho : kDistances) {
    std::vector<SpotCluster> clusters = ClustersAt(order, reference, radius, rho);
    if (best.empty() || clusters.size() < best.size()) best = std::move(clusters);
  }
  return best;
}

}  // namespace turnlight::estimator::observe
