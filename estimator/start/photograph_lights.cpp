#include "estimator/start/photograph_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "base/angles.h"
#include "base/format.h"
#include "estimator/observe/observation_access.h"
#include "estimator/solve/coordinates.h"
#include "estimator/solve/photograph_solve.h"
#include "estimator/solve/prediction.h"
#include "estimator/solve/settled_solve.h"
#include "estimator/start/eliminate_lights.h"
#include "estimator/start/merge_lights.h"
#include "estimator/start/start_scene.h"

namespace turnlight::estimator::start {
namespace {

using observe::Observations;
using observe::Photograph;

constexpr double kSharpAlpha = 0.03, kBroadAlpha = 0.2;
constexpr double kSharpPeak = 0.5, kBroadPeak = 0.05;  // of the diffuse part, at the start
constexpr int kHeldIterations = 6, kFitIterations = 40, kFewIterations = 8;
constexpr double kTolerance = 1e-6, kRoughly = 1e-4;
constexpr double kMergeDeg = 5.0, kApartDeg = 6.0, kStrayDeg = 10.0;
constexpr std::size_t kWeakest = 4, kHottest = 60, kMostTried = 3, kMostStarts = 24;
constexpr int kRounds = 3;
// The price of a light: a view's independent pixels times the logarithm of what the misfit grows by
// without it, of all pixels and of those around its own highlight.
constexpr double kPrice = 300.0, kOwnPrice = 90.0;
constexpr double kSurfaceRatio = 1.25;  // of the misfit: what another surface must lower it by

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

struct Fit {
  model::Scene scene;
  solve::Shadows shadows;
  std::vector<std::uint8_t> samples;
  double cost = 0.0;
};

struct PhotographSearch {
  const Photograph& photograph;
  const StopFlag* stop;

  const Observations& pixels() const { return photograph.pixels; }
  double independent() const { return pixels().independent; }
  double Misfit(const Fit& fit) const { return MisfitOf(pixels(), fit.cost); }

  Fit Refit(const Fit& start, int iterations, double tolerance, bool free_directions = true) const {
    solve::SolveOptions options = solve::PhotographSolveOptions(start.scene.lights.size());
    options.gauge = solve::Gauge::kDiffuse;
    options.max_iterations = iterations;
    options.function_tolerance = tolerance;
    options.free_directions = free_directions;
    options.stop = stop;
    solve::Solution solution =
        solve::SolveSettled(pixels(), start.scene, options, 1, start.shadows);
    return {std::move(solution.scene), std::move(solution.evaluate.shadows),
            std::move(solution.evaluate.samples_per_side), solution.equations.cost};
  }
};

solve::Prediction ModelOf(const PhotographSearch& search, const Fit& fit) {
  solve::EvaluateOptions options = solve::PhotographSolveOptions(0).evaluate;
  options.samples_per_side = fit.samples;
  options.shadows = fit.shadows;
  return solve::Predict(search.pixels(), fit.scene, options);
}

// Each pixel's squared residual, in expected sigmas.
std::vector<double> Squares(const Observations& all, const solve::Prediction& model) {
  std::vector<double> out(all.size(), 0.0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.pixel[i] == Observations::kNoPixel) continue;
    double square = 0.0, sum = 0.0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(all.channels); ++c) {
      const double residual =
          static_cast<double>(model[c][i]) - static_cast<double>(all.radiance[c][i]);
      sum += residual;
      square += residual * residual;
    }
    if ((all.at_white[i] & 1) != 0 && sum > 0.0) continue;
    out[i] = std::pow(all.WeightOf(i) / observe::kWeighedSigma, 2) * square / all.channels;
  }
  return out;
}

std::vector<double> Squares(const PhotographSearch& search, const Fit& fit) {
  return Squares(search.pixels(), ModelOf(search, fit));
}

double PixelTurn(const Observations& all) {
  double most = 0.0;
  for (const float turn : all.tile_footprint) most = std::max(most, static_cast<double>(turn));
  return 0.5 * most;
}

// What a light is worth: see kPrice.
struct Worth {
  double all = 0.0, own = 0.0;

  // Its price's share; it counts from 1.
  double Share() const { return std::max(all / kPrice, own / kOwnPrice); }
  bool Enough() const { return Share() > 1.0; }
};

// Of a light of a scene with these lobes. a, b: the squares with it and without.
Worth WorthOf(const PhotographSearch& search, const model::Light& light,
              const model::Reflectance& reflectance, const std::vector<double>& a,
              const std::vector<double>& b) {
  const Observations& pixels = search.pixels();
  const double turn = PixelTurn(pixels);
  const double width = model::MirroredHalfWidth(reflectance.lobes[0]);
  const double cosine = std::cos(2.5 * std::max(width, 1.2 * turn) + 2.0 * turn);
  double sum_a = 0.0, sum_b = 0.0, own_a = 0.0, own_b = 0.0, own = 0.0;
  std::size_t keyframe = 0, views = 0, last = kNone;
  for (std::size_t i = 0; i < a.size(); ++i) {
    while (i / observe::kTile >= pixels.tile_begin[keyframe + 1]) ++keyframe;
    sum_a += a[i];
    sum_b += b[i];
    if (pixels.pixel[i] == Observations::kNoPixel ||
        (pixels.at_white[i] & observe::kInHighlight) == 0 ||
        observe::At(pixels.mirrored, i).dot(light.direction) < cosine)
      continue;
    own += 1.0;
    views += std::exchange(last, keyframe) != keyframe ? 1 : 0;
    own_a += a[i];
    own_b += b[i];
  }
  Worth out;
  out.all = search.independent() * std::log(std::max(sum_b, 1e-300) / std::max(sum_a, 1e-300));
  if (own > 0.0) out.own = own * std::log(std::max(own_b, 1e-300) / std::max(own_a, 1e-300));
  // What a model leaves of one view it leaves of others.
  out.all /= static_cast<double>(pixels.tile_begin.size() - 1);
  out.own /= static_cast<double>(std::max<std::size_t>(views, 1));
  return out;
}

Fit WithoutLight(const PhotographSearch& search, const Fit& full, std::size_t light) {
  Fit start = full;
  start.scene.lights.erase(start.scene.lights.begin() + static_cast<std::ptrdiff_t>(light));
  return search.Refit(start, kFewIterations, kRoughly);
}

std::string Told(const model::Light& light, const Worth& worth) {
  return Format(
      "the light from (%+.2f, %+.2f, %+.2f) is worth %.0f in all and %.0f in its own "
      "highlight; it counts from %.0f or %.0f",
      light.direction.x(), light.direction.y(), light.direction.z(), worth.all, worth.own, kPrice,
      kOwnPrice);
}

// What was decided of lights, and by how much.
struct Decisions {
  std::vector<model::Rung> ladder;
  std::size_t added = 0;
  double least_kept = std::numeric_limits<double>::infinity(), most_dropped = 0.0;
};

// Takes out what is not worth its price, or down to so many.
Fit Prune(const PhotographSearch& search, Fit fit, std::optional<int> wanted,
          Decisions& decisions) {
  while (!StopRequested(search.stop)) {
    if (MergeClosest(fit.scene, DegToRad(kMergeDeg), 1)) {
      fit = search.Refit(fit, kFitIterations, kRoughly);
      continue;
    }
    const auto& lights = fit.scene.lights;
    if (wanted && lights.size() <= static_cast<std::size_t>(*wanted)) break;
    if (lights.size() <= 1 && !wanted) break;
    struct Tried {
      std::size_t light;
      Worth worth;
      Fit without;
    };
    std::vector<Tried> tried;
    const std::vector<double> with = Squares(search, fit);
    for (const std::size_t light : WeakestLights(fit.scene, kWeakest)) {
      Fit without = WithoutLight(search, fit, light);
      const Worth worth =
          WorthOf(search, lights[light], fit.scene.reflectance, with, Squares(search, without));
      tried.push_back({light, worth, std::move(without)});
    }
    std::stable_sort(tried.begin(), tried.end(),
                     [](const Tried& a, const Tried& b) { return a.worth.all < b.worth.all; });
    decisions.least_kept = std::numeric_limits<double>::infinity();
    for (const Tried& one : tried)
      decisions.least_kept = std::min(decisions.least_kept, one.worth.Share());
    const auto dropped = std::find_if(tried.begin(), tried.end(), [&](const Tried& one) {
      return wanted || !one.worth.Enough();
    });
    if (dropped == tried.end()) break;
    decisions.ladder.push_back(
        {"highlight light", false, Told(lights[dropped->light], dropped->worth)});
    decisions.most_dropped = std::max(decisions.most_dropped, dropped->worth.Share());
    fit = search.Refit(dropped->without, kFitIterations, kTolerance);
  }
  return fit;
}

// Directions of the brightest residuals, apart from each other and from the lights.
std::vector<Eigen::Vector3d> HotDirections(const PhotographSearch& search, const Fit& fit) {
  const Observations& all = search.pixels();
  const solve::Prediction model = ModelOf(search, fit);
  const std::vector<double> squares = Squares(all, model);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (squares[i] > 0.0 && (all.at_white[i] & observe::kInHighlight) != 0 &&
        all.radiance[0][i] > model[0][i])
      order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return squares[a] > squares[b]; });
  order.resize(std::min(order.size(), kHottest));
  const double cosine = std::cos(DegToRad(kApartDeg));
  std::vector<Eigen::Vector3d> out;
  for (const std::size_t i : order) {
    const Eigen::Vector3d direction = observe::At(all.mirrored, i).normalized();
    const auto close = [&](const Eigen::Vector3d& d) { return d.dot(direction) > cosine; };
    const bool known = std::any_of(fit.scene.lights.begin(), fit.scene.lights.end(),
                                   [&](const model::Light& l) { return close(l.direction); });
    if (known || std::any_of(out.begin(), out.end(), close)) continue;
    out.push_back(direction);
    if (out.size() == kMostTried) break;
  }
  return out;
}

// Adds what is worth its price, or up to so many.
Fit Add(const PhotographSearch& search, Fit fit, std::optional<int> wanted, Decisions& decisions) {
  for (int round = 0; (wanted || round < kRounds) && !StopRequested(search.stop); ++round) {
    if (wanted && fit.scene.lights.size() >= static_cast<std::size_t>(*wanted)) break;
    std::optional<Fit> best;
    Worth most;
    const std::vector<double> without = Squares(search, fit);
    for (const Eigen::Vector3d& direction : HotDirections(search, fit)) {
      Fit start = fit;
      model::Light light;
      light.direction = direction;
      light.inverse_distance = fit.scene.lights.front().inverse_distance;
      double strongest = 0.0;
      for (const model::Light& l : fit.scene.lights) strongest = std::max(strongest, l.intensity);
      light.intensity = 0.2 * strongest;
      start.scene.lights.push_back(light);
      Fit with = search.Refit(search.Refit(start, kHeldIterations, kRoughly, false), kFewIterations,
                              kRoughly);
      const Worth worth = WorthOf(search, with.scene.lights.back(), with.scene.reflectance,
                                  Squares(search, with), without);
      if (!best || worth.all > most.all) {
        most = worth;
        best = std::move(with);
      }
    }
    if (!best) break;
    if (!wanted && !most.Enough()) {
      decisions.most_dropped = std::max(decisions.most_dropped, most.Share());
      break;
    }
    decisions.ladder.push_back({"highlight light", true, Told(best->scene.lights.back(), most)});
    ++decisions.added;
    fit = search.Refit(*best, kFitIterations, kTolerance);
  }
  return fit;
}

model::Scene FirstScene(const Photograph& photograph, const model::ModelChoice& choice) {
  std::vector<Eigen::Vector3d> directions;
  for (const observe::SpotCluster& spot : photograph.spots)
    if (directions.size() < kMostStarts) directions.push_back(spot.direction);
  model::Scene scene = StartFromDirections(photograph.pixels, directions);
  for (model::Light& light : scene.lights)
    light.inverse_distance = photograph.spots.front().inverse_distance;
  scene.free_shading = true;
  scene.distance = solve::ToSolver(choice.distance, photograph.pixels);
  model::Reflectance& r = scene.reflectance;
  r.diffuse_model = choice.diffuse.value_or(model::DiffuseModel::kCoated);
  if (r.diffuse_model == model::DiffuseModel::kOrenNayar) r.roughness = 0.3;
  const auto lobe = [&](double alpha, double peak) {
    model::Lobe ggx{model::SpecularModel::kGgx, 1.0, alpha, 1.0};
    ggx.strength = peak / model::LobePeak(ggx);
    return model::Converted(ggx, choice.specular.value_or(model::SpecularModel::kGgx));
  };
  r.lobes[0] = lobe(kSharpAlpha, kSharpPeak);
  if (choice.lobes != 1 && r.lobes[0].present()) r.lobes[1] = lobe(kBroadAlpha, kBroadPeak);
  return scene;
}

// Lights beside all spots, but for as many as came from elsewhere.
std::size_t StraysOf(const model::Scene& scene, const std::vector<observe::SpotCluster>& spots,
                     std::size_t added) {
  const double cosine = std::cos(DegToRad(kStrayDeg));
  const auto beside = static_cast<std::size_t>(
      std::count_if(scene.lights.begin(), scene.lights.end(), [&](const model::Light& light) {
        return std::none_of(spots.begin(), spots.end(), [&](const observe::SpotCluster& spot) {
          return spot.direction.dot(light.direction) > cosine;
        });
      }));
  return beside > added ? beside - added : 0;
}

void PutSharperFirst(model::Reflectance& r) {
  if (r.lobes[1].present() && model::LobeHalfWidth(r.lobes[1]) < model::LobeHalfWidth(r.lobes[0]))
    std::swap(r.lobes[0], r.lobes[1]);
}

// Of the surfaces that can be meant, that which leaves the least; the coat unless another leaves
// clearly less.
Fit ChooseSurface(const PhotographSearch& search, const Fit& coated,
                  std::vector<model::Rung>& ladder) {
  Fit rough = coated;
  rough.scene.reflectance.diffuse_model = model::DiffuseModel::kOrenNayar;
  rough.scene.reflectance.roughness = 0.3;
  rough = search.Refit(rough, kFitIterations, kTolerance);
  const bool taken = search.Misfit(rough) * kSurfaceRatio < search.Misfit(coated);
  ladder.push_back(
      {"coated", !taken,
       Format("a diffuse part under a coat leaves %.3g of the misfit that is expected, Oren and "
              "Nayar's %.3g, which counts from a ratio of %.2f",
              search.Misfit(coated), search.Misfit(rough), kSurfaceRatio)});
  return taken ? rough : coated;
}

}  // namespace

double MisfitOf(const Observations& pixels, double cost) {
  return 2.0 * cost /
         (observe::kWeighedSigma * observe::kWeighedSigma *
          solve::ValueCount(pixels, solve::EvaluateOptions()));
}

PhotographLights FindPhotographLights(const Photograph& photograph,
                                      const model::ModelChoice& choice, const StopFlag* stop) {
  const PhotographSearch search{photograph, stop};
  PhotographLights out;
  Fit fit;
  fit.scene = FirstScene(photograph, choice);
  std::string spots;
  for (const observe::SpotCluster& spot : photograph.spots)
    spots += Format("%s(%+.2f, %+.2f, %+.2f)", spots.empty() ? "" : ", ", spot.direction.x(),
                    spot.direction.y(), spot.direction.z());
  out.ladder.push_back({"highlights", true,
                        Format("%zu compact bright spots, where lights from %s would show",
                               photograph.spots.size(), spots.c_str())});
  fit = search.Refit(fit, kHeldIterations, kRoughly, false);
  fit = search.Refit(fit, kFitIterations, kTolerance);
  Decisions decisions;
  fit = Prune(search, std::move(fit), choice.lights, decisions);
  fit = Add(search, std::move(fit), choice.lights, decisions);
  fit = Prune(search, std::move(fit), choice.lights, decisions);
  out.ladder.insert(out.ladder.end(), decisions.ladder.begin(), decisions.ladder.end());
  out.least_kept = decisions.least_kept;
  out.most_dropped = decisions.most_dropped;
  if (!choice.diffuse) fit = ChooseSurface(search, fit, out.ladder);
  PutSharperFirst(fit.scene.reflectance);
  out.strays = StraysOf(fit.scene, photograph.spots, decisions.added);
  out.misfit = search.Misfit(fit);
  if (choice.lights)
    out.ladder.push_back({"lights", static_cast<int>(fit.scene.lights.size()) == *choice.lights,
                          Format("%d were asked for, %zu could be fitted", *choice.lights,
                                 fit.scene.lights.size())});
  out.scene = std::move(fit.scene);
  return out;
}

}  // namespace turnlight::estimator::start
