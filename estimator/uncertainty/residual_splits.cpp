#include "estimator/uncertainty/residual_splits.h"

#include <algorithm>
#include <functional>
#include <memory>

#include "base/statistics.h"
#include "estimator/solve/kernel/tile_kernel.h"
#include "estimator/solve/prediction.h"

namespace turnlight::estimator::uncertainty {
namespace {

float Grey(const solve::Prediction& model, std::size_t i) {
  float sum = 0.0f;
  for (const auto& channel : model) sum += channel[i];
  return sum;
}

constexpr std::size_t kPlaces = 32;    // from the target's top to its bottom
constexpr std::uint32_t kSquares = 8;  // squares along a single view's target, and across it
constexpr double kNearEdge = 4.0;      // half footprints
constexpr double kHardlyRough = 1e-3;  // radians

// The gradient of the views that are chosen.
Eigen::VectorXd OfViews(const observe::Observations& all, const Eigen::MatrixXd& tiles,
                        const std::function<bool(std::size_t)>& chosen) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(tiles.rows());
  for (std::size_t k = 0; k + 1 < all.tile_begin.size(); ++k)
    if (chosen(k))
      for (std::size_t t = all.tile_begin[k]; t < all.tile_begin[k + 1]; ++t)
        sum += tiles.col(static_cast<Eigen::Index>(t));
  return sum;
}

bool IsUsed(const observe::Observations& all, const solve::PixelMask& usable, std::size_t i) {
  return all.pixel[i] != observe::Observations::kNoPixel && (!usable || (*usable)[i] != 0);
}

// Of each pixel that is used, in which of kSquares equal parts of the used pixels' extent it lies,
// by column or by row; kSquares of the others.
std::vector<std::uint8_t> PartsOfExtent(const observe::Observations& all,
                                        const solve::PixelMask& usable, bool by_column) {
  const auto width = static_cast<std::uint32_t>(all.width);
  const auto used = [&](std::size_t i) { return IsUsed(all, usable, i); };
  const auto at = [&](std::size_t i) {
    return by_column ? all.pixel[i] % width : all.pixel[i] / width;
  };
  std::uint32_t first = observe::Observations::kNoPixel, last = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (used(i)) first = std::min(first, at(i)), last = std::max(last, at(i));
  std::vector<std::uint8_t> out(all.size(), static_cast<std::uint8_t>(kSquares));
  for (std::size_t i = 0; i < all.size(); ++i)
    if (used(i))
      out[i] = static_cast<std::uint8_t>((at(i) - first) * kSquares / (last - first + 1));
  return out;
}

// The gradients of the squares of a grid over the target in a single view. A tile, a few rows
// high, belongs to the row of squares where its first pixel is.
Eigen::MatrixXd OfSquares(const observe::Observations& all, const solve::Solution& solution) {
  const solve::PixelMask& usable = solution.evaluate.shadows.usable;
  const std::vector<std::uint8_t> column = PartsOfExtent(all, usable, true),
                                  row = PartsOfExtent(all, usable, false);
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(solution.equations.gradient.size(), kSquares * kSquares);
  for (std::uint32_t strip = 0; strip < kSquares; ++strip) {
    auto mask = std::make_shared<std::vector<std::uint8_t>>(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) (*mask)[i] = column[i] == strip ? 1 : 0;
    solve::EvaluateOptions options = solution.evaluate;
    options.shadows.usable = mask;
    const Eigen::MatrixXd tiles = solve::TileGradients(all, solution.scene, options);
    for (std::size_t t = 0; t < all.tiles(); ++t)
      for (std::size_t i = t * observe::kTile; i < (t + 1) * observe::kTile; ++i)
        if ((*mask)[i] != 0) {
          out.col(strip * kSquares + row[i]) += tiles.col(static_cast<Eigen::Index>(t));
          break;
        }
  }
  // Squares beside the target are no clusters.
  std::vector<Eigen::Index> seen;
  for (Eigen::Index k = 0; k < out.cols(); ++k)
    if (!out.col(k).isZero(0.0)) seen.push_back(k);
  return out(Eigen::all, seen);
}

// The gradient of the observations whose value is below the median over all that are used.
Eigen::VectorXd GradientOfLower(const observe::Observations& all, const solve::Solution& solution,
                                const std::function<float(std::size_t)>& value) {
  const solve::PixelMask& usable = solution.evaluate.shadows.usable;
  const auto used = [&](std::size_t i) { return IsUsed(all, usable, i); };
  std::vector<float> values;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (used(i)) values.push_back(value(i));
  if (values.empty()) return Eigen::VectorXd::Zero(solution.equations.gradient.size());
  const float middle = Median(values);
  auto half = std::make_shared<std::vector<std::uint8_t>>(all.size(), std::uint8_t{0});
  for (std::size_t i = 0; i < all.size(); ++i)
    if (used(i) && value(i) < middle) (*half)[i] = 1;
  solve::EvaluateOptions options = solution.evaluate;
  options.gradient_only = true;
  options.shadows.usable = std::move(half);
  return solve::Evaluate(all, solution.scene, options).gradient;
}

// Of the observations that are used, those near an attached shadow's edge.
solve::NormalEquations EdgesAlone(const observe::Observations& all,
                                  const solve::Solution& solution) {
  const solve::PixelMask& usable = solution.evaluate.shadows.usable;
  const solve::PixelMask away = solve::AwayFromTerminators(all, solution.scene.lights, kNearEdge);
  auto edges = std::make_shared<std::vector<std::uint8_t>>(all.size(), std::uint8_t{0});
  for (std::size_t i = 0; i < all.size(); ++i)
    (*edges)[i] = (*away)[i] == 0 && (!usable || (*usable)[i] != 0) ? 1 : 0;
  solve::EvaluateOptions options = solution.evaluate;
  options.shadows.usable = std::move(edges);
  return solve::Evaluate(all, solution.scene, options);
}

solve::NormalEquations WithAlternatives(const observe::Observations& all,
                                        const solve::Solution& solution) {
  model::Scene scene = solution.scene;
  if (scene.reflectance.diffuse_model == model::DiffuseModel::kLambert) {
    scene.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
    scene.reflectance.roughness = kHardlyRough;
  }
  return solve::Evaluate(all, scene, solution.evaluate);
}

// From pixels this far apart in a row: what a sensor's interpolation spreads is nearer, and most
// patterns reach further.
double Texture(const observe::Observations& all, const solve::Prediction& model,
               const solve::PixelMask& usable) {
  constexpr std::size_t kApart = 3;
  constexpr double kSigmas = 4.0;
  constexpr double kLeast = 1e-3;  // less is in any picture: quantisation
  double common = 0.0, squares = 0.0, radiance = 0.0;
  for (std::size_t i = 0; i + kApart < all.size(); ++i) {
    const std::size_t j = i + kApart;
    if (all.pixel[i] == observe::Observations::kNoPixel || all.pixel[j] != all.pixel[i] + kApart)
      continue;
    if (usable && ((*usable)[i] == 0 || (*usable)[j] == 0)) continue;
    if (all.IsAtWhite(i) || all.IsAtWhite(j)) continue;
    for (std::size_t c = 0; c < model.size(); ++c) {
      const auto residual = [&](std::size_t k) {
        return static_cast<double>(all.radiance[c][k]) - static_cast<double>(model[c][k]);
      };
      const double product = residual(i) * residual(j);
      common += product;
      squares += product * product;
      radiance += static_cast<double>(model[c][i]) * static_cast<double>(model[c][j]);
    }
  }
  if (!(radiance > 0.0) || !(common > kSigmas * std::sqrt(squares))) return 0.0;
  const double texture = std::sqrt(common / radiance);
  return texture >= kLeast ? texture : 0.0;
}

// Factors of a part of the observations follow the other parameters as those of all do.
solve::Solution WithFactorsFollowing(solve::Solution solution) {
  solution.evaluate.factors = solution.equations.factors;
  return solution;
}

}  // namespace

ResidualSplits SplitResiduals(const observe::Observations& all, const solve::Solution& fitted) {
  const solve::Solution solution = WithFactorsFollowing(fitted);
  ResidualSplits out;
  out.clusters = solve::TileGradients(all, solution.scene, solution.evaluate);
  const Eigen::MatrixXd& tiles = out.clusters;
  const std::size_t views = all.tile_begin.size() - 1;
  if (views > 1) {
    out.places = Eigen::MatrixXd::Zero(tiles.rows(), kPlaces);
    for (std::size_t k = 0; k < views; ++k) {
      const std::size_t begin = all.tile_begin[k], count = all.tile_begin[k + 1] - begin;
      for (std::size_t t = 0; t < count; ++t)
        out.places.col(static_cast<Eigen::Index>(t * kPlaces / count)) +=
            tiles.col(static_cast<Eigen::Index>(begin + t));
    }
  }
  if (views == 1 && solution.evaluate.huber > 0.0) out.squares = OfSquares(all, solution);
  if (views > 1) {
    out.halves.push_back(OfViews(all, tiles, [](std::size_t k) { return k % 2 == 0; }));
  }
  if (views > 2)
    out.halves.push_back(OfViews(all, tiles, [&](std::size_t k) { return 2 * k < views; }));
  const auto dot = [&](std::size_t i) {
    return all.normal[0][i] * all.mirrored[0][i] + all.normal[1][i] * all.mirrored[1][i] +
           all.normal[2][i] * all.mirrored[2][i];
  };
  out.halves.push_back(GradientOfLower(all, solution, dot));
  // By the model's brightness: by the observed one, noise would choose the half.
  const auto model = solve::Predict(all, solution.scene, solution.evaluate);
  out.halves.push_back(
      GradientOfLower(all, solution, [&](std::size_t i) { return Grey(model, i); }));
  for (int k = 0; k < 3; ++k)
    out.halves.push_back(GradientOfLower(
        all, solution, [&](std::size_t i) { return all.normal[static_cast<std::size_t>(k)][i]; }));

  solve::EvaluateOptions finer = solution.evaluate;
  finer.gradient_only = true;
  for (std::uint8_t& s : finer.samples_per_side)
    s = static_cast<std::uint8_t>(2 * s <= solve::kernel::kMaxSamples ? 2 * s : s / 2);
  out.finer = solve::Evaluate(all, solution.scene, finer).gradient - solution.equations.gradient;
  out.texture = Texture(all, model, solution.evaluate.shadows.usable);
  out.edges = EdgesAlone(all, solution);
  out.alternatives = WithAlternatives(all, fitted);
  out.unmodelled = TryUnmodelled(all, fitted);
  return out;
}

}  // namespace turnlight::estimator::uncertainty
