#include "calib/calibrate/response/photon_transfer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "calib/transfer.h"

namespace turnlight::calib::calibrate::response {
namespace {

constexpr double kLeastVariance = 0.24;  // DN^2: below, rounding is no noise of its own (EMVA 1288)
constexpr double kMostBend = 0.03;       // of the encoding's slope, within a sigma of the noise
constexpr double kClear = 4.0;           // sigmas from where DN are cut off
constexpr int kRounds = 10;
constexpr std::size_t kFewestPoints = 4;
constexpr double kLeastContrast = 2.0;  // between the brightest and the darkest point

std::optional<TransferPoint> PointOf(const Block& block, const Radiometry& radiometry,
                                     const Transfer& transfer, double saturation) {
  const double noise = std::sqrt(*block.variance);
  if (block.high >= saturation || block.mean + kClear * noise >= saturation) return std::nullopt;
  if (block.low <= 0.0 || block.mean - kClear * noise <= 0.0) return std::nullopt;
  const double range = radiometry.white - radiometry.black;
  const auto linear = [&](double dn) {
    return range * transfer.Decode((dn - radiometry.black) / range);
  };
  const double step = std::max(noise, 0.5);
  const double up = (linear(block.mean + step) - linear(block.mean)) / step,
               down = (linear(block.mean) - linear(block.mean - step)) / step;
  const double slope = 0.5 * (up + down);
  if (std::abs(up - down) > 2.0 * kMostBend * slope) return std::nullopt;
  TransferPoint point;
  point.plane = block.plane;
  point.signal = linear(block.mean);
  point.variance = slope * slope * (*block.variance - kRoundingVariance);
  // A sum of squares of so many normal differences.
  point.sigma = slope * slope * *block.variance * std::sqrt(2.0 / block.differences);
  return point;
}

// Whether the noise of a whole picture is large enough to be seen through rounding.
bool NoiseShows(const Group& group) {
  double sum = 0.0, count = 0.0;
  for (const Block& block : group.blocks)
    if (block.variance) {
      sum += *block.variance;
      ++count;
    }
  return count > 0.0 && sum / count >= kLeastVariance;
}

struct Line {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  // variance without light, gain
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double chi = 0.0;
  bool good = false;
};

// A straight line; the points' sigmas are those of its own variances, not of theirs, which would
// favour what came out small by chance.
Line FitLine(const std::vector<const TransferPoint*>& points) {
  Line line;
  if (points.size() < kFewestPoints) return line;
  double low = HUGE_VAL, high = 0.0;
  for (const TransferPoint* point : points) {
    low = std::min(low, point->signal);
    high = std::max(high, point->signal);
  }
  if (!(high > kLeastContrast * low)) return line;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    const auto sigma_of = [&](const TransferPoint& point) {
      const double expected = line.at[0] + line.at[1] * point.signal;
      const double least = 0.2 * std::abs(point.variance);
      return round == 0 ? point.sigma
                        : point.sigma * std::max(expected, least) / std::max(point.variance, least);
    };
    double chi = 0.0;
    for (const TransferPoint* point : points) {
      const Eigen::Vector2d row(1.0, point->signal);
      const double sigma = std::max(sigma_of(*point), 1e-12);
      normal += row * row.transpose() / (sigma * sigma);
      right += row * point->variance / (sigma * sigma);
      chi += std::pow((point->variance - line.at.dot(row)) / sigma, 2);
    }
    line.covariance = normal.inverse();
    line.at = line.covariance * right;
    line.chi = std::sqrt(chi / static_cast<double>(points.size() - 2));
  }
  line.good = line.at.allFinite() && line.at[1] > 0.0;
  return line;
}

// From the variance without light to its root, with what the black level's error adds.
void Finish(const Line& line, double black_sigma, PhotonTransfer& out) {
  out.dn_per_electron = line.at[1];
  out.read_noise_found = line.at[0] > 0.0;
  out.read_noise_dn = std::sqrt(std::max(line.at[0], 0.0));
  out.chi = line.chi;
  Eigen::Matrix2d covariance = std::pow(std::max(line.chi, 1.0), 2) * line.covariance;
  covariance(0, 0) += std::pow(line.at[1] * black_sigma, 2);
  const double sigma = std::sqrt(covariance(0, 0));
  // Near 0 the root bends: then as far as the variance may be.
  const double slope = 0.5 / std::max(out.read_noise_dn, std::sqrt(sigma) / 2.0);
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Identity();
  jacobian(0, 0) = slope;
  out.covariance = jacobian * covariance * jacobian.transpose();
}

}  // namespace

double PhotonTransfer::ReadSigma() const { return std::sqrt(covariance(0, 0)); }
double PhotonTransfer::GainSigma() const { return std::sqrt(covariance(1, 1)); }

Result<PhotonTransfer> FitPhotonTransfer(const std::vector<Group>& series,
                                         const std::vector<Group>& dark,
                                         const Radiometry& radiometry, double black_sigma,
                                         double saturation) {
  const Transfer transfer(radiometry);
  PhotonTransfer out;
  std::size_t planes = 0, pairs = 0;
  for (const auto* groups : {&series, &dark})
    for (const Group& group : *groups) {
      if (group.pictures < 2) continue;
      ++pairs;
      if (!NoiseShows(group)) {
        out.rounded_away = true;
        continue;
      }
      for (const Block& block : group.blocks) {
        planes = std::max(planes, block.plane + 1);
        if (!block.variance) continue;
        if (const auto point = PointOf(block, radiometry, transfer, saturation))
          out.points.push_back(*point);
      }
    }
  std::vector<const TransferPoint*> all;
  for (const TransferPoint& point : out.points) all.push_back(&point);
  const Line line = FitLine(all);
  if (!line.good)
    return InputError(Format(
        "series: %zu exposures have two pictures or more, and %zu of their blocks show noise "
        "that is neither clipped nor rounded away; allowed are pairs at several levels "
        "between black and white",
        pairs, out.points.size()));
  Finish(line, black_sigma, out);
  for (std::size_t plane = 0; plane < planes; ++plane) {
    std::vector<const TransferPoint*> own;
    for (const TransferPoint& point : out.points)
      if (point.plane == plane) own.push_back(&point);
    const Line alone = FitLine(own);
    out.by_plane.push_back(alone.good ? alone.at[1] : 0.0);
  }
  return out;
}

}  // namespace turnlight::calib::calibrate::response
