#include "calib/calibrate/response/response_curve.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/format.h"
#include "base/statistics.h"
#include "calib/calibrate/response/least_squares.h"
#include "calib/transfer.h"

namespace turnlight::calib::calibrate::response {
namespace {

// How well exposure times and lamps keep what they say, as a share of the light.
constexpr double kSteadiness = 1e-3;
// Of a simple encoding that is taken, and how much better a curve may be then; and from which on
// nothing explains the pictures.
constexpr double kMostChi = 1.5, kWorthACurve = 1.25, kUnexplained = 3.0;
constexpr double kLeastGamma = 0.1, kMostGamma = 10.0;
constexpr int kPieces = 16;           // of a curve
constexpr double kSmoothness = 0.15;  // by how much the logarithms of neighbouring rises differ
constexpr double kFlooredSigma = 0.3, kUnknownBlackSigma = 1e4;  // DN
constexpr double kStuck = 0.05;                       // d log(DN) / d log(t) of what is clipped
constexpr double kLeastStep = 1.05, kMostStep = 8.0;  // between two exposures
constexpr double kCollapsed = 0.1;                    // of the spread in the exposure before
constexpr std::size_t kFewestSamples = 6;

struct Sample {
  std::size_t source = 0;
  double exposure = 0.0;                         // of the longest
  double mean = 0.0, sigma = 0.0, spread = 0.0;  // DN; sigma is the mean's
};

struct Data {
  std::vector<Sample> samples;
  std::size_t sources = 0;
  double white = 1.0;
  BlackLevel black;
};

Data Collect(const std::vector<Group>& series, double black, double saturation) {
  double longest = 0.0;
  for (const Group& group : series) longest = std::max(longest, group.exposure_us);
  std::map<std::pair<std::size_t, std::size_t>, std::vector<Sample>> sources;
  for (const Group& group : series)
    for (const Block& block : group.blocks) {
      const double noise = block.variance.value_or(block.spread);
      const double clear = 4.0 * std::sqrt(noise);
      const bool clipped = block.high >= saturation || block.mean + clear >= saturation;
      const bool floored = block.low <= 0.0 || block.mean - clear <= 0.0;
      if (clipped || floored || block.mean - black < std::max(1.0, 0.5 * std::sqrt(noise)))
        continue;
      const double pictures = static_cast<double>(group.pictures);
      Sample sample{0, group.exposure_us / longest, block.mean, 0.0,
                    std::sqrt(std::max(block.spread - kRoundingVariance, 0.0))};
      sample.sigma = std::sqrt(std::max(noise, kRoundingVariance) / (block.pixels * pictures));
      sources[{block.plane, block.place}].push_back(sample);
    }
  Data data;
  for (auto& [key, samples] : sources) {
    const auto [least, most] = std::minmax_element(
        samples.begin(), samples.end(),
        [](const Sample& a, const Sample& b) { return a.exposure < b.exposure; });
    if (!(most->exposure > kLeastStep * least->exposure)) continue;
    for (Sample& sample : samples) {
      sample.source = data.sources;
      data.samples.push_back(sample);
    }
    ++data.sources;
  }
  return data;
}

// What a fit's parameters mean: the black level, then those of the encoding.
struct Model {
  Encoding encoding = Encoding::kLinear;
  double base_gamma = 1.0;  // a curve starts from this power

  Eigen::Index Count() const {
    return encoding == Encoding::kCurve ? 1 + kPieces : encoding == Encoding::kGamma ? 2 : 1;
  }
  Radiometry At(const Eigen::VectorXd& parameters, double white) const {
    Radiometry out;
    out.encoding = encoding;
    out.black = parameters[0];
    out.white = white;
    if (encoding == Encoding::kGamma)
      out.gamma = std::clamp(std::exp(parameters[1]), kLeastGamma, kMostGamma);
    if (encoding != Encoding::kCurve) return out;
    std::vector<double> rises;
    double sum = 0.0;
    for (int k = 0; k < kPieces; ++k) {
      const double low = std::pow(static_cast<double>(k) / kPieces, base_gamma),
                   high = std::pow(static_cast<double>(k + 1) / kPieces, base_gamma);
      rises.push_back((high - low) * std::exp(std::clamp(parameters[1 + k], -20.0, 20.0)));
      sum += rises.back();
    }
    double at = 0.0;
    out.curve.push_back({0.0, 0.0});
    for (int k = 0; k + 1 < kPieces; ++k) {
      at += rises[static_cast<std::size_t>(k)] / sum;
      out.curve.push_back({static_cast<double>(k + 1) / kPieces, at});
    }
    out.curve.push_back({1.0, 1.0});
    return out;
  }
};

struct Light {
  double value = 0.0, sigma = 0.0;  // linear share
};

// A block's mean light: of DN that scatter by their spread, not of the mean DN.
Light LightOf(const Sample& sample, const Transfer& transfer, const Radiometry& radiometry) {
  const double range = radiometry.white - radiometry.black;
  const double s = (sample.mean - radiometry.black) / range, spread = sample.spread / range;
  const double step = std::max(spread, 0.25 / range);
  const double up = transfer.Decode(s + step), down = transfer.Decode(s - step);
  Light light;
  light.value = 0.5 * (transfer.Decode(s + spread) + transfer.Decode(s - spread));
  const double slope = (up - down) / (2.0 * step);
  light.sigma = std::hypot(slope * sample.sigma / range, kSteadiness * light.value);
  return light;
}

// Each block's light by exposure, compared with its best constant times the exposure.
struct Compared {
  std::vector<double> deviation, sigma;  // shares of the light
};

Compared Compare(const Data& data, const Radiometry& radiometry) {
  const Transfer transfer(radiometry);
  std::vector<Light> lights;
  std::vector<double> product(data.sources, 0.0), square(data.sources, 0.0);
  for (const Sample& sample : data.samples) {
    lights.push_back(LightOf(sample, transfer, radiometry));
    const double weight = 1.0 / (lights.back().sigma * lights.back().sigma);
    product[sample.source] += weight * sample.exposure * lights.back().value;
    square[sample.source] += weight * sample.exposure * sample.exposure;
  }
  Compared out;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const Sample& sample = data.samples[i];
    const double expected = product[sample.source] / square[sample.source] * sample.exposure;
    out.deviation.push_back((lights[i].value - expected) / expected);
    out.sigma.push_back(lights[i].sigma / expected);
  }
  return out;
}

struct Fit {
  Radiometry radiometry;
  LeastSquares solution;
  EncodingTrial trial;
};

Fit FitModel(const Data& data, const Model& model, const std::string& name) {
  const auto residuals = [&](const Eigen::VectorXd& parameters) {
    const Compared compared = Compare(data, model.At(parameters, data.white));
    const auto n = static_cast<Eigen::Index>(compared.deviation.size());
    const bool curve = model.encoding == Encoding::kCurve;
    Eigen::VectorXd out(n + 1 + (curve ? kPieces : 0));
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      out[i] = compared.deviation[at] / compared.sigma[at];
    }
    out[n] = (parameters[0] - data.black.dn) / data.black.sigma;
    if (!curve) return out;
    for (int k = 1; k < kPieces; ++k)
      out[n + k] = (parameters[1 + k] - parameters[k]) / kSmoothness;
    out[n + kPieces] = parameters.tail(kPieces).mean();
    return out;
  };
  Eigen::VectorXd start = Eigen::VectorXd::Zero(model.Count());
  Eigen::VectorXd scale = Eigen::VectorXd::Constant(model.Count(), 0.1);
  start[0] = data.black.dn;
  scale[0] = std::clamp(data.black.sigma, 0.01, 1.0);
  Fit out;
  out.solution = Minimise(residuals, start, scale);
  if (model.encoding == Encoding::kGamma) {
    start[1] = std::log(2.0);
    LeastSquares other = Minimise(residuals, start, scale);
    if (other.residuals.squaredNorm() < out.solution.residuals.squaredNorm())
      out.solution = std::move(other);
  }
  out.radiometry = model.At(out.solution.parameters, data.white);
  const auto n = static_cast<Eigen::Index>(data.samples.size());
  const double freedom = std::max(static_cast<double>(n) - static_cast<double>(data.sources) -
                                      static_cast<double>(model.Count()),
                                  1.0);
  out.trial.name = name;
  out.trial.chi = std::sqrt(out.solution.residuals.head(n).squaredNorm() / freedom);
  const Compared compared = Compare(data, out.radiometry);
  for (const double deviation : compared.deviation)
    out.trial.worst = std::max(out.trial.worst, std::abs(deviation));
  return out;
}

// Of the linear shares of a curve's points.
std::vector<double> CurveSigma(const Model& model, const LeastSquares& solution, double white,
                               double inflation) {
  const Eigen::VectorXd& at = solution.parameters;
  Eigen::MatrixXd jacobian(kPieces + 1, at.size());
  for (Eigen::Index p = 0; p < at.size(); ++p) {
    constexpr double kStep = 1e-4;
    Eigen::VectorXd up = at, down = at;
    up[p] += kStep;
    down[p] -= kStep;
    const Radiometry a = model.At(up, white), b = model.At(down, white);
    for (std::size_t k = 0; k < a.curve.size(); ++k)
      jacobian(static_cast<Eigen::Index>(k), p) = (a.curve[k][1] - b.curve[k][1]) / (2.0 * kStep);
  }
  const Eigen::VectorXd variance =
      (jacobian * solution.covariance * jacobian.transpose()).diagonal();
  std::vector<double> out;
  for (const double v : variance) out.push_back(inflation * std::sqrt(std::max(v, 0.0)));
  return out;
}

// The simplest that explains the pictures; a curve only if it explains much more.
std::size_t Choose(const std::vector<Fit>& fits) {
  const double enough = std::max(kMostChi, kWorthACurve * fits[3].trial.chi);
  if (fits[0].trial.chi <= enough) return 0;
  const std::size_t power = fits[1].trial.chi <= fits[2].trial.chi ? 1 : 2;
  return fits[power].trial.chi <= enough ? power : 3;
}

}  // namespace

std::optional<BlackLevel> FindBlack(const std::vector<Group>& dark) {
  std::vector<double> means, middles;
  double weighted = 0.0, weights = 0.0;
  bool floored = false;
  for (const Group& group : dark)
    for (const Block& block : group.blocks) {
      const double count = block.pixels * static_cast<double>(group.pictures);
      means.push_back(block.mean);
      middles.push_back(block.middle);
      weighted += count * block.mean;
      weights += count;
      floored |= block.low <= 0.0;
    }
  if (means.empty()) return std::nullopt;
  const double mean = weighted / weights;
  if (floored) {
    const double middle = Median(middles);
    return BlackLevel{middle, middle > 0.0 ? kFlooredSigma : std::max(kFlooredSigma, mean)};
  }
  double squares = 0.0;
  for (const double m : means) squares += (m - mean) * (m - mean);
  const double count = static_cast<double>(means.size());
  // Blocks differ by noise and by the sensor's own pattern: of either, their mean is this well
  // known.
  const double scatter = std::sqrt(squares / std::max(count - 1.0, 1.0) / count);
  return BlackLevel{mean, std::max(scatter, std::sqrt(kRoundingVariance / weights))};
}

std::optional<double> FindSaturation(const std::vector<Group>& series, double black) {
  std::vector<const Group*> ordered;
  for (const Group& group : series) ordered.push_back(&group);
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const Group* a, const Group* b) { return a->exposure_us < b->exposure_us; });
  double brightest = 0.0;
  for (const Group* group : ordered)
    for (const Block& block : group->blocks) brightest = std::max(brightest, block.mean - black);
  std::vector<double> levels;
  for (std::size_t g = 1; g < ordered.size(); ++g) {
    const double step = ordered[g]->exposure_us / ordered[g - 1]->exposure_us;
    if (step < kLeastStep) continue;
    for (std::size_t i = 0; i < ordered[g]->blocks.size(); ++i) {
      const Block &now = ordered[g]->blocks[i], &before = ordered[g - 1]->blocks[i];
      const double growth = std::log((now.mean - black) / std::max(before.mean - black, 1e-3));
      const bool stuck = growth < kStuck * std::log(step);
      const bool collapsed = step < kMostStep && now.spread < kCollapsed * before.spread;
      if (now.mean - black > 0.5 * brightest && (stuck || collapsed)) levels.push_back(now.low);
    }
  }
  if (levels.empty()) return std::nullopt;
  return Median(levels);
}

Result<ResponseCurve> FitResponseCurve(const std::vector<Group>& series,
                                       const std::optional<BlackLevel>& black, double white,
                                       double saturation) {
  Data data = Collect(series, black ? black->dn : 0.0, saturation);
  if (data.sources == 0 || data.samples.size() < data.sources + kFewestSamples)
    return InputError(
        Format("series: %zu blocks in %zu exposures are neither clipped nor black, "
               "allowed is a scene whose brightness follows the exposure over a wide "
               "range, at least 3 exposures of it",
               data.samples.size(), series.size()));
  data.white = white;
  data.black = black.value_or(BlackLevel{0.0, kUnknownBlackSigma});
  std::vector<Model> models{{Encoding::kLinear}, {Encoding::kSrgb}, {Encoding::kGamma}};
  const char* const names[] = {"linear", "srgb", "gamma", "curve"};
  std::vector<Fit> fits;
  for (std::size_t i = 0; i < 3; ++i) fits.push_back(FitModel(data, models[i], names[i]));
  models.push_back({Encoding::kCurve, std::clamp(fits[2].radiometry.gamma, 0.2, 5.0)});
  fits.push_back(FitModel(data, models[3], names[3]));
  const std::size_t chosen = Choose(fits);
  const Fit& fit = fits[chosen];
  const double inflation = std::max(fit.trial.chi, 1.0);
  ResponseCurve out;
  out.radiometry = fit.radiometry;
  out.black_sigma = inflation * std::sqrt(fit.solution.covariance(0, 0));
  if (chosen == 2)
    out.gamma_sigma = inflation * fit.radiometry.gamma * std::sqrt(fit.solution.covariance(1, 1));
  if (chosen == 3) out.curve_sigma = CurveSigma(models[3], fit.solution, white, inflation);
  for (const Fit& each : fits) out.trials.push_back(each.trial);
  out.explained = fit.trial.chi <= kUnexplained;
  const Compared compared = Compare(data, fit.radiometry),
                 linear = Compare(data, fits[0].radiometry);
  for (std::size_t i = 0; i < data.samples.size(); ++i)
    out.points.push_back(
        {data.samples[i].mean, compared.deviation[i], linear.deviation[i], compared.sigma[i]});
  return out;
}

}  // namespace turnlight::calib::calibrate::response
