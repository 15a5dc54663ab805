#include "calib/calibrate/response/flat_field.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "calib/calibrate/response/least_squares.h"
#include "calib/transfer.h"

namespace turnlight::calib::calibrate::response {
namespace {

constexpr int kCoefficients = 3;
constexpr double kEvenness = 1e-3;     // of the surface's light, as a share
constexpr double kLeastFall = 2e-3;    // of the corner's share: less is not worth a correction
constexpr double kSignificance = 3.0;  // sigmas
constexpr double kMostOffset = 0.2;    // of the picture's size, for a centre that is believed
constexpr double kDustSigmas = 4.0;    // dust
constexpr double kClearSigmas = 3.0;   // sigmas below what is clipped
constexpr double kMostClipped = 0.01;  // of a card's pixels: broken ones
constexpr double kLeastLight = 0.02;   // of white

struct FlatSample {
  std::size_t curve = 0;  // group and plane: an amplitude of its own
  double x = 0.0, y = 0.0;
  double light = 0.0, sigma = 0.0;
  bool dust = false;
};

double Farthest(const cv::Size& size, double x, double y) {
  return std::hypot(std::max(x, size.width - 1.0 - x), std::max(y, size.height - 1.0 - y));
}

Vignetting At(const Eigen::VectorXd& parameters, const cv::Size& size) {
  Vignetting out;
  out.center_x = 0.5 * (size.width - 1) + parameters[0] * size.width;
  out.center_y = 0.5 * (size.height - 1) + parameters[1] * size.height;
  out.radius = Farthest(size, out.center_x, out.center_y) + 1.0;
  out.coefficients.assign(parameters.data() + 2, parameters.data() + 2 + kCoefficients);
  return out;
}

std::vector<double> Amplitudes(const std::vector<FlatSample>& samples, const Vignetting& shape,
                               std::size_t curves) {
  std::vector<double> product(curves, 0.0), square(curves, 1e-300);
  for (const FlatSample& sample : samples) {
    if (sample.dust) continue;
    const double share = shape.ShareAt(sample.x, sample.y);
    product[sample.curve] += share * sample.light / (sample.sigma * sample.sigma);
    square[sample.curve] += share * share / (sample.sigma * sample.sigma);
  }
  for (std::size_t i = 0; i < curves; ++i) product[i] /= square[i];
  return product;
}

struct ShapeFit {
  LeastSquares solution;
  double chi = 1.0;
};

ShapeFit FitShape(const std::vector<FlatSample>& samples, std::size_t curves, const cv::Size& size,
                  bool free_center) {
  const auto whole = [&](const Eigen::VectorXd& of) {
    if (free_center) return of;
    Eigen::VectorXd out = Eigen::VectorXd::Zero(2 + kCoefficients);
    out.tail(kCoefficients) = of;
    return out;
  };
  const auto residuals = [&](const Eigen::VectorXd& of) {
    const Vignetting shape = At(whole(of), size);
    const std::vector<double> amplitude = Amplitudes(samples, shape, curves);
    Eigen::VectorXd out(static_cast<Eigen::Index>(samples.size()));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const FlatSample& sample = samples[i];
      const double expected = amplitude[sample.curve] * shape.ShareAt(sample.x, sample.y);
      out[static_cast<Eigen::Index>(i)] =
          sample.dust ? 0.0 : (sample.light - expected) / sample.sigma;
    }
    return out;
  };
  const Eigen::Index count = (free_center ? 2 : 0) + kCoefficients;
  ShapeFit out;
  out.solution =
      Minimise(residuals, Eigen::VectorXd::Zero(count), Eigen::VectorXd::Constant(count, 0.05));
  const auto used = std::count_if(samples.begin(), samples.end(),
                                  [](const FlatSample& sample) { return !sample.dust; });
  out.chi = std::sqrt(out.solution.residuals.squaredNorm() /
                      std::max(static_cast<double>(used) - static_cast<double>(count), 1.0));
  if (free_center) return out;
  out.solution.parameters = whole(out.solution.parameters);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2 + kCoefficients, 2 + kCoefficients);
  covariance.bottomRightCorner(kCoefficients, kCoefficients) = out.solution.covariance;
  out.solution.covariance = covariance;
  return out;
}

std::vector<FlatSample> CollectFlat(const std::vector<Group>& flat, const Radiometry& radiometry,
                                    double saturation, std::size_t& curves) {
  const Transfer transfer(radiometry);
  const double range = radiometry.white - radiometry.black;
  std::vector<FlatSample> samples;
  curves = 0;
  for (const Group& group : flat) {
    std::size_t planes = 0;
    for (const Block& block : group.blocks) {
      planes = std::max(planes, block.plane + 1);
      const double s = (block.mean - radiometry.black) / range;
      const double clear = kClearSigmas * std::sqrt(block.spread);
      if (std::max(block.high, block.mean + clear) >= saturation || block.low <= 0.0 ||
          s < kLeastLight)
        continue;
      const double noise =
          std::sqrt(block.spread / (block.pixels * static_cast<double>(group.pictures)));
      const double light = transfer.Decode(s);
      const double slope = (transfer.Decode(s + 0.5 / range) - transfer.Decode(s - 0.5 / range));
      samples.push_back({curves + block.plane, block.x, block.y, light,
                         std::hypot(slope * noise, kEvenness * light), false});
    }
    curves += planes;
  }
  return samples;
}

void FillCorner(const ShapeFit& fit, const cv::Size& size, FlatField& out) {
  for (const double x : {0.0, size.width - 1.0})
    for (const double y : {0.0, size.height - 1.0}) {
      const double share = out.vignetting.ShareAt(x, y);
      if (share >= out.corner_share && out.corner_sigma > 0.0) continue;
      out.corner_share = share;
      const double dx = x - out.vignetting.center_x, dy = y - out.vignetting.center_y;
      const double q = (dx * dx + dy * dy) / std::pow(out.vignetting.radius, 2);
      const Eigen::Vector3d row(q, q * q, q * q * q);
      out.corner_sigma =
          std::max(fit.chi, 1.0) *
          std::sqrt(row.dot(fit.solution.covariance.bottomRightCorner<3, 3>() * row));
    }
}

void FillMaps(const std::vector<FlatSample>& samples, const std::vector<double>& amplitude,
              const cv::Size& size, const cv::Size& grid, FlatField& out) {
  out.measured = cv::Mat1d(grid, std::nan(""));
  out.fitted = cv::Mat1d(grid, std::nan(""));
  double squares = 0.0, count = 0.0;
  for (const FlatSample& sample : samples) {
    const double share = out.vignetting.ShareAt(sample.x, sample.y);
    const double measured = sample.light / amplitude[sample.curve];
    if (!sample.dust) {
      squares += std::pow(measured / share - 1.0, 2);
      ++count;
    }
    if (sample.curve != 0) continue;
    const int column =
        std::min(static_cast<int>(sample.x * grid.width / size.width), grid.width - 1);
    const int row =
        std::min(static_cast<int>(sample.y * grid.height / size.height), grid.height - 1);
    out.measured(row, column) = measured;
    out.fitted(row, column) = share;
  }
  out.rms = std::sqrt(squares / std::max(count, 1.0));
}

// The light of the card's pixels in a plane; clipped ones are counted.
void CollectCard(const Plane& plane, const cv::Rect& card, const Radiometry& radiometry,
                 double saturation, std::vector<double>& lights, std::size_t& clipped,
                 std::size_t& all) {
  const Transfer transfer(radiometry);
  const double range = radiometry.white - radiometry.black;
  cv::Mat1d values;
  plane.values.convertTo(values, CV_64F);
  for (int row = 0; row < values.rows; ++row)
    for (int column = 0; column < values.cols; ++column) {
      const double x = plane.PixelX(column), y = plane.PixelY(row);
      if (!card.contains(cv::Point(static_cast<int>(x), static_cast<int>(y)))) continue;
      ++all;
      const double dn = values(row, column);
      if (dn >= saturation) {
        ++clipped;
        continue;
      }
      const double share = radiometry.vignetting ? radiometry.vignetting->ShareAt(x, y) : 1.0;
      lights.push_back(transfer.Decode((dn - radiometry.black) / range) / share);
    }
}

}  // namespace

Result<FlatField> FitVignetting(const std::vector<Group>& flat, const Radiometry& radiometry,
                                double saturation, cv::Size size, cv::Size grid) {
  std::size_t curves = 0;
  std::vector<FlatSample> samples = CollectFlat(flat, radiometry, saturation, curves);
  std::size_t blocks = 0;
  for (const Group& group : flat) blocks += group.blocks.size();
  if (2 * samples.size() < blocks || samples.size() < 30)
    return InputError(
        Format("flat: %zu of %zu blocks are neither clipped nor darker than %.0f %% of "
               "white, allowed are flat frames that are exposed to about half of white",
               samples.size(), blocks, 100.0 * kLeastLight));
  FlatField out;
  out.center_known = true;
  ShapeFit fit = FitShape(samples, curves, size, true);
  for (int round = 0; round < 2; ++round) {  // dust found, the shape again
    const double limit = kDustSigmas * std::max(fit.chi, 1.0);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i].dust |= std::abs(fit.solution.residuals[static_cast<Eigen::Index>(i)]) > limit;
    const Eigen::VectorXd& at = fit.solution.parameters;
    if (!at.allFinite() || at.head<2>().cwiseAbs().maxCoeff() > kMostOffset)
      out.center_known = false;
    fit = FitShape(samples, curves, size, out.center_known);
  }
  out.vignetting = At(fit.solution.parameters, size);
  for (int k = 0; k < kCoefficients; ++k)
    out.sigma.push_back(std::max(fit.chi, 1.0) *
                        std::sqrt(std::max(fit.solution.covariance(2 + k, 2 + k), 0.0)));
  FillCorner(fit, size, out);
  FillMaps(samples, Amplitudes(samples, out.vignetting, curves), size, grid, out);
  const double fall = std::abs(1.0 - out.corner_share);
  out.significant = fall > kLeastFall && fall > kSignificance * out.corner_sigma;
  return out;
}

Result<WhiteBalance> FindWhiteBalance(const std::vector<cv::Mat>& pictures,
                                      const std::optional<std::string>& bayer, const cv::Rect& card,
                                      const Radiometry& radiometry, double saturation) {
  std::array<std::vector<double>, 3> lights;
  std::size_t clipped = 0, all = 0;
  for (const cv::Mat& picture : pictures)
    for (const Plane& plane : PlanesOf(picture, bayer))
      CollectCard(plane, card, radiometry, saturation,
                  lights[static_cast<std::size_t>(plane.channel)], clipped, all);
  if (static_cast<double>(clipped) > kMostClipped * static_cast<double>(all))
    return InputError(
        Format("grey_card: %zu of the card's %zu values are clipped, allowed is a card "
               "that is darker than %.6g DN everywhere",
               clipped, all, saturation));
  WhiteBalance out;
  std::array<Moments, 3> light;
  for (std::size_t c = 0; c < 3; ++c) {
    light[c] = RobustMoments(lights[c]);
    if (light[c].mean > 0.0) continue;
    return InputError(
        "grey_card: the card has no light in one of red, green and blue; allowed is "
        "a colour picture, or a mosaic with its bayer pattern, of a lit card");
  }
  const auto relative = [&](std::size_t c) {
    return std::sqrt(light[c].variance / light[c].count) / light[c].mean;
  };
  for (std::size_t c = 0; c < 3; ++c) {
    out.balance[c] = light[c].mean / light[1].mean;
    out.sigma[c] = c == 1 ? 0.0 : out.balance[c] * std::hypot(relative(c), relative(1));
  }
  return out;
}

}  // namespace turnlight::calib::calibrate::response
