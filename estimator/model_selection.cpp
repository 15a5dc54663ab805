#include "estimator/model_selection.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "estimator/missing_lights.h"
#include "estimator/settled_solve.h"
#include "estimator/uncertainty.h"

namespace turnlight::estimator {
namespace {

constexpr std::size_t kMaxClusters = 12;
constexpr int kLatticeLights = 24;
constexpr double kRatioPerLight = 3.0;
constexpr double kRoughRatio = 1.25;
constexpr double kFirstRoughness = 0.3;       // radians
constexpr double kMinSpecularPeak = 0.003;    // of white
constexpr double kMinInverseDistance = 5e-4;  // rho R
constexpr double kSignificance = 3.0;
constexpr double kBeyondNoise = 2.0;  // residual rms over noise from which it is not noise
constexpr double kHuberSigmas = 1.0;  // scale of the loss in robust sigmas of the residual

Eigen::Vector3d MeanNormal(const Observations& all) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel)
      for (int k = 0; k < 3; ++k) sum[k] += static_cast<double>(all.normal[k][i]);
  return sum.norm() > 1e-6 * static_cast<double>(all.used) ? Eigen::Vector3d(sum.normalized())
                                                           : Eigen::Vector3d::UnitZ();
}

// The median absolute residual as a sigma.
double RobustSigma(const Observations& all, const Scene& scene, const EvaluateOptions& options) {
  const auto model = Predict(all, scene, options);
  const Plane& usable = options.shadows.usable;
  std::vector<float> residuals;
  residuals.reserve(all.used * static_cast<std::size_t>(all.channels));
  for (int c = 0; c < all.channels; ++c)
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all.pixel[i] != Observations::kNoPixel && (!usable || (*usable)[i] != 0))
        residuals.push_back(std::abs(model[static_cast<std::size_t>(c)][i] - all.radiance[c][i]));
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return static_cast<double>(*middle) / 0.6745;
}

double Rms(const Observations& all, const Solution& solution) {
  return std::sqrt(2.0 * solution.equations.cost / ValueCount(all, solution.evaluate));
}

constexpr int kRounds = 3;  // of footprints and shadows

// Solves on from the scene and with the options of `out`; its splits are then out of date.
void SolveOn(const Observations& observations, Refined& out) {
  out.solution = SolveSettled(observations, out.solution.scene, out.options, kRounds,
                              out.solution.evaluate.shadows);
  out.options.evaluate = out.solution.evaluate;
  out.iterations += out.solution.iterations;
  out.cost_history.insert(out.cost_history.end(), out.solution.cost_history.begin(),
                          out.solution.cost_history.end());
}

// Where the residual is mere noise, squares are the best there is. Where it is more, what is left
// is texture, dirt, or what the model lacks, and large residuals say little about the lights.
void ChooseLoss(const Observations& observations, double noise, Refined& out,
                std::vector<Rung>& ladder) {
  const double rms = Rms(observations, out.solution);
  const bool robust = rms > kBeyondNoise * noise;
  ladder.push_back(
      {"robust-loss", robust,
       Format("residual rms %.3g, noise %.3g; from %.1f times the noise on, large residuals "
              "are given less weight",
              rms, noise, kBeyondNoise)});
  if (!robust) return;
  const double sigma = RobustSigma(observations, out.solution.scene, out.options.evaluate);
  out.options.evaluate.huber = std::max(kHuberSigmas * sigma, 1e-6);
  SolveOn(observations, out);
}

void ChooseSpecular(const Observations& observations, Refined& out, std::vector<Rung>& ladder) {
  const Scene& scene = out.solution.scene;
  if (scene.reflectance.specular_model == SpecularModel::kNone) return;
  const auto order = StrengthOrder(scene, observations);
  // The statistical sigma: a highlight that the model describes badly is a highlight nevertheless.
  const Uncertainty sigma =
      EstimateUncertainty(out.solution, observations, order, out.options, out.splits).stat;
  const Reported reported = Report(scene, observations, order);
  // The highlight as it is at the target, wherever W's origin is.
  double strongest = 0.0;
  for (const Light& light : scene.lights) strongest = std::max(strongest, light.intensity);
  const double peak = scene.reflectance.specular * strongest;
  const double relative =
      sigma.lights.empty() || !(reported.lights.front().specular_product > 0.0)
          ? 1.0
          : sigma.lights.front().specular_product / reported.lights.front().specular_product;
  const double own = relative * peak;
  const bool matters = peak >= kMinSpecularPeak && peak > kSignificance * own;
  ladder.push_back(
      {"specular", matters,
       Format("the strongest highlight is %.3g of white with sigma %.2g; it counts from "
              "%.3g and 3 sigma",
              peak, own, kMinSpecularPeak)});
  if (matters) return;
  out.specular_sigma = sigma.lights.empty() ? own : sigma.lights.front().specular_product;
  out.solution.scene.reflectance.specular_model = SpecularModel::kNone;
  out.solution.scene.reflectance.specular = 0.0;
  SolveOn(observations, out);
  out.splits = SplitResiduals(observations, out.solution);
}

// A light is near if its inverse distance about the reference, in 1/R, says so.
void ChooseDistances(const Observations& observations, Refined& out, std::vector<Rung>& ladder) {
  const std::size_t lights = out.solution.scene.lights.size();
  std::vector<std::size_t> own_order(lights);
  for (std::size_t l = 0; l < lights; ++l) own_order[l] = l;
  const Uncertainty sigma =
      EstimateUncertainty(out.solution, observations, own_order, out.options, out.splits).total;
  const Reported reported = Report(out.solution.scene, observations, own_order);
  out.near.assign(lights, false);
  bool refit = false;
  for (std::size_t l = 0; l < lights; ++l) {
    // About W's origin, for the reader; the decision is about the target, wherever the origin is.
    out.inverse_distance.push_back(reported.lights[l].light.inverse_distance);
    out.inverse_distance_sigma.push_back(sigma.lights[l].inverse_distance);
    const double rho = out.solution.scene.lights[l].inverse_distance;
    const double own = sigma.lights[l].inverse_distance_at_reference;
    out.near[l] = rho >= kMinInverseDistance && rho > kSignificance * own;
    if (!out.near[l] && rho > 0.0) refit = true;
    ladder.push_back(
        {"near light " + std::to_string(l + 1), out.near[l],
         Format("radius over distance is %.3g with sigma %.2g; it counts from %.3g and 3 "
                "sigma",
                rho, own, kMinInverseDistance)});
  }
  if (!refit) return;
  out.options.fixed_distance.assign(lights, false);
  for (std::size_t l = 0; l < lights; ++l)
    if (!out.near[l]) {
      out.options.fixed_distance[l] = true;
      out.solution.scene.lights[l].inverse_distance = 0.0;
    }
  SolveOn(observations, out);
  out.splits = SplitResiduals(observations, out.solution);
}

bool Rough(const Candidate& candidate) {
  return candidate.scene.reflectance.diffuse_model == DiffuseModel::kOrenNayar;
}

// The simpler model is better unless the other makes the excess variance smaller: three times for
// each light, 1.25 times for a rough surface.
bool Better(const Candidate& a, const Candidate& b) {
  const double lights =
      static_cast<double>(a.scene.lights.size()) - static_cast<double>(b.scene.lights.size());
  const double rough = (Rough(a) ? 1.0 : 0.0) - (Rough(b) ? 1.0 : 0.0);
  return a.excess * std::pow(kRatioPerLight, lights) * std::pow(kRoughRatio, rough) < b.excess;
}

Candidate WithDiffuse(Candidate candidate, DiffuseModel model) {
  Reflectance& r = candidate.scene.reflectance;
  r.diffuse_model = model;
  r.roughness = model == DiffuseModel::kOrenNayar ? kFirstRoughness : 0.0;
  return candidate;
}

const char* Name(DiffuseModel model) {
  return model == DiffuseModel::kOrenNayar ? "Oren-Nayar" : "Lambert";
}

// The candidates so far, and what became of each.
struct Search {
  const Observations& sample;
  double noise;
  Candidate best;
  std::string winner, tried;
  bool done = false;

  // Returns the excess variance that the start led to.
  double Try(const char* from, const std::vector<Eigen::Vector3d>& directions,
             DiffuseModel diffuse) {
    Candidate start;
    start.scene = StartFromDirections(sample, directions);
    start = WithDiffuse(std::move(start), diffuse);
    Candidate found = AddMissingLights(sample, FitAndEliminate(sample, start.scene, noise), noise);
    const double excess = found.excess;
    const std::string name = std::string(from) + " with " + Name(diffuse);
    tried += (tried.empty() ? "" : "; ") + name +
             Format(" lead to %zu lights with an excess variance of %.3g",
                    found.scene.lights.size(), excess);
    done = done || NothingLeft(excess, sample, noise);
    if (winner.empty() || Better(found, best)) {
      best = std::move(found);
      winner = name;
    }
    return excess;
  }
};

}  // namespace

Candidate FindLights(const Observations& sample, const std::vector<MapPoint>& clusters,
                     double noise, std::vector<Rung>& ladder) {
  std::vector<Eigen::Vector3d> directions;
  for (const MapPoint& cluster : clusters)
    if (directions.size() < kMaxClusters) directions.push_back(cluster.direction);
  Search search{sample, noise, {}, {}, {}};
  const double lambert =
      search.Try("the intensity map's clusters", directions, DiffuseModel::kLambert);
  if (!search.done) {
    const double rough = search.Try("the clusters", directions, DiffuseModel::kOrenNayar);
    // Oren-Nayar can be as smooth as Lambert; Lambert has fewer ways to go wrong.
    const bool smooth = lambert <= kRoughRatio * rough;
    if (!search.done)
      search.Try("a lattice of lights", HemisphereDirections(kLatticeLights, MeanNormal(sample)),
                 smooth ? DiffuseModel::kLambert : DiffuseModel::kOrenNayar);
  }
  ladder.push_back({"start", true, search.tried + ". Taken: " + search.winner});
  return std::move(search.best);
}

Candidate ChooseDiffuse(const Observations& sample, const Candidate& candidate, double noise,
                        std::vector<Rung>& ladder) {
  if (!Rough(candidate) && NothingLeft(candidate.excess, sample, noise)) {
    ladder.push_back({"oren-nayar", false,
                      Format("with Lambert the excess variance is %.3g: nothing is left to explain",
                             candidate.excess)});
    return candidate;
  }
  const auto with = [&](DiffuseModel model) {
    return Eliminate(sample,
                     model == candidate.scene.reflectance.diffuse_model
                         ? candidate
                         : WithDiffuse(candidate, model),
                     noise);
  };
  Candidate smooth = with(DiffuseModel::kLambert), rough = with(DiffuseModel::kOrenNayar);
  const bool accepted = Better(rough, smooth);
  ladder.push_back(
      {"oren-nayar", accepted,
       Format("excess variance %.3g with Lambert and %zu lights, %.3g with Oren-Nayar and %zu; "
              "rough from a ratio of %.2f, each light saved is worth %.0f",
              smooth.excess, smooth.scene.lights.size(), rough.excess, rough.scene.lights.size(),
              kRoughRatio, kRatioPerLight)});
  return accepted ? rough : smooth;
}

Refined Refine(const Observations& observations, const Scene& start, double noise,
               const SolveOptions& options, std::vector<Rung>& ladder) {
  Refined out;
  out.options = options;
  out.solution.scene = start;
  SolveOn(observations, out);
  ChooseLoss(observations, noise, out, ladder);
  out.splits = SplitResiduals(observations, out.solution);
  ChooseSpecular(observations, out, ladder);
  ChooseDistances(observations, out, ladder);
  return out;
}

}  // namespace turnlight::estimator
