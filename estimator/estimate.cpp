#include "estimator/estimate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/angles.h"
#include "base/format.h"
#include "estimator/find_lights.h"
#include "estimator/held_out.h"
#include "estimator/paper_estimate.h"
#include "estimator/uncertainty.h"

namespace turnlight::estimator {
namespace {

// Pixels that a start is found on; with noise of more than 2 % of white more, up to eight times.
constexpr double kSampleSize = 6000.0, kSampledNoise = 0.02, kMostSamples = 8.0;
constexpr std::size_t kMinPixels = 30;
constexpr double kManyOutliers = 0.005, kMostOutliers = 0.35;  // of the target's pixels
constexpr double kDarkRadiance = 1e-7;                         // white is 1: nothing was lit
constexpr double kUnexplained = 2.0;  // residual rms over noise that something is missing from
constexpr double kNoisy = 0.15;       // noise over the brightest radiance that hides lights
constexpr double kNinetyFivePercent = 1.6449;

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Pixels of the target by what was found about them, over all keyframes.
struct FlagCounts {
  std::size_t on_target = 0, saturated = 0, outliers = 0, lost = 0, edge = 0;
};

FlagCounts Count(const std::vector<cv::Mat1b>& flags) {
  FlagCounts counts;
  for (const cv::Mat1b& picture : flags)
    for (const std::uint8_t flag : picture) {
      if (flag & kOffTarget) continue;
      ++counts.on_target;
      counts.saturated += (flag & kSaturated) != 0 ? 1 : 0;
      counts.outliers += (flag & kUnlikeOthers) != 0 ? 1 : 0;
      counts.lost += (flag & kLostInNoise) != 0 ? 1 : 0;
      counts.edge += (flag & (kSilhouette | kGrazing)) != 0 ? 1 : 0;
    }
  return counts;
}

// Why nothing usable was observed.
std::string WhyNothing(const FlagCounts& counts) {
  if (counts.on_target == 0)
    return "No pixel shows the target: check the poses, the masks and the target's size.";
  const auto of = [&](std::size_t count) {
    return Format("%zu of %zu target pixels ", count, counts.on_target);
  };
  if (2 * counts.saturated > counts.on_target)
    return of(counts.saturated) + "are clipped: lower the exposure or the gain.";
  if (2 * counts.lost > counts.on_target)
    return of(counts.lost) +
           "are lost in noise: expose longer, lower the gain, or average pictures.";
  return of(counts.edge) + "are at the outline or too oblique: move the camera closer.";
}

// 99.9 % quantile of the grey radiance.
double Brightest(const Observations& all) {
  std::vector<float> values;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != Observations::kNoPixel) values.push_back(all.radiance[0][i]);
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(values.size() - 1) * 0.999);
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

// Views whose pictures differ by more than noise from every earlier distinct one.
int DistinctViews(const std::vector<cv::Mat>& signatures, double noise) {
  std::vector<const cv::Mat*> distinct;
  for (const cv::Mat& signature : signatures) {
    const auto same = [&](const cv::Mat* other) {
      if (other->size() != signature.size() || other->type() != signature.type()) return false;
      double sum = 0.0;
      std::size_t count = 0;
      const float* a = signature.ptr<float>();
      const float* b = other->ptr<float>();
      const std::size_t values = signature.total() * static_cast<std::size_t>(signature.channels());
      for (std::size_t i = 0; i < values; ++i) {
        if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
        const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        sum += difference * difference;
        ++count;
      }
      const double limit = 1.5 * std::sqrt(2.0) * noise + 1e-6;
      return count > 0 && sum <= limit * limit * static_cast<double>(count);
    };
    if (std::none_of(distinct.begin(), distinct.end(), same)) distinct.push_back(&signature);
  }
  return static_cast<int>(distinct.size());
}

LightEstimate MakeLight(const ReportedLight& reported, const LightSigma& sigma, bool near,
                        double rho_free, double rho_sigma, bool strongest) {
  LightEstimate out;
  out.light = reported.light;
  out.near = near;
  out.direction_sigma = sigma.direction;
  // A light held at infinity: what the fit with free distances found belongs to the error of 0.
  out.inverse_distance_sigma = near ? sigma.inverse_distance : std::hypot(rho_sigma, rho_free);
  const double upper = rho_free + kNinetyFivePercent * rho_sigma;
  if (upper > 0.0 && std::isfinite(upper)) out.distance_min = 1.0 / upper;
  if (near) {
    out.distance = 1.0 / reported.light.inverse_distance;
    out.distance_sigma = sigma.distance;
    out.position = reported.light.direction / reported.light.inverse_distance;
    out.position_covariance = sigma.position_covariance;
  }
  out.direction_at_reference = reported.direction_at_reference;
  if (!strongest) out.intensity_sigma = sigma.intensity;
  out.diffuse_product = reported.diffuse_product;
  out.diffuse_product_sigma = sigma.diffuse_product;
  out.specular_product = reported.specular_product;
  out.specular_product_sigma = sigma.specular_product;
  return out;
}

void FillSigmas(const Uncertainty& sigma, double specular_limit, Estimate& out) {
  out.sigma.albedo = sigma.albedo;
  out.sigma.ambient = sigma.ambient;
  out.sigma.diffuse = sigma.diffuse;
  out.sigma.specular = sigma.specular;
  out.ambient_product_sigma = sigma.ambient_product;
  if (out.reflectance.specular_model == SpecularModel::kNone) {
    out.sigma.specular = specular_limit;
    for (LightEstimate& light : out.lights)
      light.specular_product_sigma = specular_limit * light.light.intensity;
  } else if (std::isfinite(sigma.shininess)) {
    out.sigma.shininess = sigma.shininess;
  }
  if (out.reflectance.diffuse_model == DiffuseModel::kOrenNayar && std::isfinite(sigma.roughness))
    out.sigma.roughness = sigma.roughness;
  out.condition = sigma.condition;
  out.weak = sigma.weak;
}

void AddViewsNote(Estimate& out) {
  if (out.distinct_views < out.views)
    out.notes.push_back(
        {"views-add-nothing",
         std::to_string(out.distinct_views) + " of " + std::to_string(out.views) +
             " views differ by more than noise; the others add nothing, and the sigmas are those "
             "of the distinct ones. A homogeneous body of revolution on the axis looks the same at "
             "every angle: use another target, tilt it, or move the camera."});
}

void AddNotes(Estimate& out) {
  AddViewsNote(out);
  if (out.reflectance.specular_model == SpecularModel::kNone)
    out.notes.push_back(
        {"no-highlight",
         "No highlight was found: shininess is null, and the lights' places rest on "
         "diffuse shading alone."});
  if (out.channels == 1)
    out.notes.push_back(
        {"grey", "The pictures are grey: albedo and products repeat one value for R, G and B."});
  const bool any_distant = std::any_of(out.lights.begin(), out.lights.end(),
                                       [](const LightEstimate& l) { return !l.near; });
  if (any_distant)
    out.notes.push_back({"distance-unknown",
                         "Lights with distance null are too far for the data to tell how far; "
                         "distance_min is a 95 % bound."});
  if (out.stopped != "converged")
    out.notes.push_back({"not-converged", "The solver reached its limit of iterations."});
}

// Which lights there are was decided by what explains the pictures down to the noise.
void AddCountNote(double noise, double brightest, Estimate& out) {
  constexpr std::size_t kFewPixels = 1000;
  if (noise > kNoisy * brightest)
    out.notes.push_back({"count-uncertain",
                         Format("The noise is %.2g, %.0f %% of the brightest radiance: lights and "
                                "highlights may be hidden in it.",
                                noise, 100.0 * noise / brightest)});
  if (out.pixels < kFewPixels)
    out.notes.push_back(
        {"count-uncertain",
         Format("Only %zu pixels are usable: they may not show every light.", out.pixels)});
  if (out.rms <= kUnexplained * noise) return;
  out.notes.push_back(
      {"count-uncertain",
       Format("The model leaves %.3g rms of the pictures unexplained, %.1f times their noise: a "
              "light, a shadow or a property of the surface may be missing, and the number of "
              "lights is uncertain.",
              out.rms, out.rms / std::max(noise, 1e-12))});
}

std::vector<cv::Mat1f> ResidualMaps(const Observations& all, const Scene& scene,
                                    const EvaluateOptions& options, cv::Size size) {
  const auto model = Predict(all, scene, options);
  std::vector<cv::Mat1f> maps;
  for (std::size_t k = 0; k + 1 < all.tile_begin.size(); ++k) {
    cv::Mat1f& map = maps.emplace_back(size, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = all.tile_begin[k] * kTile; i < all.tile_begin[k + 1] * kTile; ++i) {
      if (all.pixel[i] == Observations::kNoPixel) continue;
      if (options.shadows.usable && (*options.shadows.usable)[i] == 0) continue;
      float sum = 0.0f;
      for (int c = 0; c < all.channels; ++c)
        sum += all.radiance[c][i] - model[static_cast<std::size_t>(c)][i];
      const int at = static_cast<int>(all.pixel[i]);
      map(at / size.width, at % size.width) = sum / static_cast<float>(all.channels);
    }
  }
  return maps;
}

double RmsOf(double values, double cost) { return std::sqrt(2.0 * cost / values); }

void FillEstimate(const Observations& all, const Refined& refined, Estimate& out) {
  const Solution& solution = refined.solution;
  const auto order = StrengthOrder(solution.scene, all);
  const Reported reported = Report(solution.scene, all, order);
  const Uncertainties sigmas =
      EstimateUncertainty(solution, all, order, refined.options, refined.splits);
  const Uncertainty& sigma = sigmas.total;
  out.stat = sigmas.stat;
  out.reflectance = reported.reflectance;
  out.reference_point = all.reference;
  out.channels = all.channels;
  out.ambient_product = reported.ambient_product;
  for (std::size_t i = 0; i < order.size(); ++i)
    out.lights.push_back(MakeLight(reported.lights[i], sigma.lights[i], refined.near[order[i]],
                                   refined.inverse_distance[order[i]],
                                   refined.inverse_distance_sigma[order[i]], i == 0));
  FillSigmas(sigma, refined.specular_sigma, out);
  for (std::size_t i = 0; i < order.size(); ++i)
    if (!refined.near[order[i]])
      out.stat.lights[i].inverse_distance = refined.inverse_distance_sigma_stat[order[i]];
  if (out.reflectance.specular_model == SpecularModel::kNone) {
    out.stat.specular = refined.specular_sigma_stat;
    for (std::size_t i = 0; i < order.size(); ++i)
      out.stat.lights[i].specular_product =
          refined.specular_sigma_stat * out.lights[i].light.intensity;
  }
  EvaluateOptions squares = refined.options.evaluate;
  squares.huber = 0.0;
  squares.gradient_only = true;
  const double values = ValueCount(all, squares);
  out.rms = RmsOf(values, Evaluate(all, solution.scene, squares).cost);
  out.pixels = all.used - squares.shadows.left_out;
  out.iterations = refined.iterations;
  out.stopped = solution.converged ? "converged" : "iteration-limit";
  for (const double cost : refined.cost_history)
    out.history.push_back({static_cast<int>(out.history.size()), RmsOf(values, cost)});
}

}  // namespace

Scene Estimate::ToScene() const {
  Scene scene;
  scene.reflectance = reflectance;
  for (const LightEstimate& light : lights) scene.lights.push_back(light.light);
  return scene;
}

cv::Mat ViewSignature(const Keyframe& keyframe) {
  constexpr int kStep = 3;
  const cv::Mat& image = keyframe.image.radiance;
  cv::Mat out((image.rows + kStep - 1) / kStep, (image.cols + kStep - 1) / kStep, image.type());
  for (int row = 0; row < out.rows; ++row)
    for (int column = 0; column < out.cols; ++column)
      std::copy_n(image.ptr<float>(kStep * row) + kStep * column * image.channels(),
                  image.channels(), out.ptr<float>(row) + column * image.channels());
  return out;
}

namespace {

// Where the full solve starts, with the decisions and the residuals on the way there.
Scene FindStart(const Observations& all, const EstimateOptions& options, double noise,
                const IntensityMap& map, Estimate& estimate) {
  if (options.warm_start) return ToSolver(*options.warm_start, all);
  const double more = std::clamp(std::pow(noise / kSampledNoise, 2), 1.0, kMostSamples);
  const Sample sample{Subsample(all, static_cast<std::size_t>(kSampleSize * more), 1), noise,
                      options.model};
  const auto clusters =
      LeaderClustering(HighIntensityArea(map, kHighShare), DegToRad(kClusterRadiusDeg));
  Candidate candidate;
  if (options.initial) {
    candidate = FitGuess(sample, *options.initial, clusters, estimate.ladder);
  } else {
    candidate = FindLights(sample, clusters, estimate.ladder);
    candidate = ChooseDiffuse(sample, candidate, estimate.ladder);
    candidate = ChooseLobe(sample, candidate, estimate.ladder);
    candidate = CheckHeldOut(Subsample(all, static_cast<std::size_t>(kSampleSize), 2), sample,
                             std::move(candidate), estimate.ladder);
  }
  for (const double rms : candidate.rms_history)
    estimate.history.push_back({static_cast<int>(estimate.history.size()), rms});
  return candidate.scene;
}

// Thresholds are shares of white, for pictures that were exposed for what they show. A power of two
// that brings others there; 1 for most.
double ExposureLevel(const Observations& all) {
  const double brightest = Brightest(all);
  return brightest > 0.02 && brightest < 50.0 ? 1.0 : std::exp2(std::round(std::log2(brightest)));
}

void Scale(Reflectance& r, double by) {
  r.ambient *= by;
  r.diffuse *= by;
  r.specular *= by;
}

// Radiances of an estimate times a factor.
void Scale(Estimate& estimate, double by) {
  Scale(estimate.reflectance, by);
  for (auto* sigma : {&estimate.sigma.ambient, &estimate.sigma.diffuse, &estimate.sigma.specular,
                      &estimate.stat.ambient, &estimate.stat.diffuse, &estimate.stat.specular,
                      &estimate.initial_rms, &estimate.rms})
    *sigma *= by;
  for (auto* color :
       {&estimate.ambient_product, &estimate.ambient_product_sigma, &estimate.stat.ambient_product})
    *color *= by;
  for (LightEstimate& light : estimate.lights) {
    light.diffuse_product *= by;
    light.diffuse_product_sigma *= by;
    light.specular_product *= by;
    light.specular_product_sigma *= by;
  }
  for (LightSigma& light : estimate.stat.lights) {
    light.diffuse_product *= by;
    light.specular_product *= by;
  }
  for (IterationRecord& record : estimate.history) record.rms *= by;
}

// The estimate of pictures that are far darker or brighter than white: at a level of about 1, then
// scaled back.
Result<Estimate> EstimateAtLevel(const Observations& all, const std::vector<cv::Mat>& signatures,
                                 const EstimateOptions& options, double level, Refined* refined) {
  Observations scaled = all;
  for (auto& channel : scaled.radiance)
    for (float& value : channel) value /= static_cast<float>(level);
  std::vector<cv::Mat> scaled_signatures;
  for (const cv::Mat& signature : signatures) scaled_signatures.emplace_back(signature / level);
  EstimateOptions scaled_options = options;
  if (scaled_options.warm_start) Scale(scaled_options.warm_start->reflectance, 1.0 / level);
  auto estimate = EstimateObservations(scaled, scaled_signatures, scaled_options, nullptr, refined);
  if (!estimate) return estimate;
  Scale(*estimate, level);
  estimate->notes.push_back(
      {"exposure",
       Format("The brightest radiance is about %.2g of white: decisions, and the numbers in their "
              "reasons, take that as white.",
              level)});
  if (refined) Scale(refined->solution.scene.reflectance, level);
  return estimate;
}

Result<Estimate> EstimateByPaper(const Observations& all, const IntensityMap& map,
                                 const PaperOptions& options, Refined* refined) {
  auto solution = SolveByPaper(all, map, options);
  if (!solution) return Forward(solution);
  Estimate estimate;
  FillFromPaper(all, *solution, options, estimate);
  if (refined) refined->solution.scene = std::move(solution->scene);
  return estimate;
}

}  // namespace

Result<Estimate> EstimateObservations(const Observations& all,
                                      const std::vector<cv::Mat>& signatures,
                                      const EstimateOptions& options, IntensityMap* map,
                                      Refined* refined) {
  const double begin = Seconds();
  if (all.used < kMinPixels)
    return NoEstimateError("no usable estimate: " + std::to_string(all.used) +
                           " usable pixels, at least " + std::to_string(kMinPixels) +
                           " are needed. ");
  if (Brightest(all) <= kDarkRadiance)
    return NoEstimateError("no usable estimate: every usable pixel is black (99.9 % at or below " +
                           std::to_string(Brightest(all)) +
                           " of white): check the lamp, the exposure and "
                           "radiometry.black.");
  const double noise = EstimateNoise(all);
  Estimate estimate;
  IntensityMap own_map;
  IntensityMap& used_map = map ? *map : own_map;
  if (map || !options.warm_start) used_map = MakeIntensityMap(all);
  if (options.paper) {
    const double mapped = Seconds();
    auto by_paper = EstimateByPaper(all, used_map, *options.paper, refined);
    if (!by_paper) return by_paper;
    by_paper->views = static_cast<int>(signatures.size());
    by_paper->distinct_views = DistinctViews(signatures, noise);
    AddViewsNote(*by_paper);
    by_paper->initial_s = mapped - begin;
    by_paper->solve_s = Seconds() - mapped;
    return by_paper;
  }
  const double level = ExposureLevel(all);
  if (level != 1.0) return EstimateAtLevel(all, signatures, options, level, refined);
  const Scene start = FindStart(all, options, noise, used_map, estimate);
  const double started = Seconds();
  estimate.views = static_cast<int>(signatures.size());
  estimate.distinct_views = DistinctViews(signatures, noise);
  SolveOptions solve;
  if (estimate.distinct_views > 0)
    solve.redundancy = static_cast<double>(estimate.views) / estimate.distinct_views;
  Refined result = Refine(all, start, noise, solve, options.model, estimate.ladder);
  FillEstimate(all, result, estimate);
  const double brightest = Brightest(all);
  // Pictures without a light's share are ambient light alone, unless noise could hide one.
  if (estimate.lights.empty() &&
      (estimate.rms > kUnexplained * noise || noise > kNoisy * brightest))
    return NoEstimateError(
        Format("no usable estimate: no light explains more of the pictures than ambient light does "
               "(residual rms %.2g, noise %.2g, brightest radiance %.2g): expose longer, check the "
               "poses and the masks.",
               estimate.rms, noise, brightest));
  estimate.initial_rms = estimate.history.empty() ? estimate.rms : estimate.history.front().rms;
  AddNotes(estimate);
  AddCountNote(noise, brightest, estimate);
  estimate.initial_s = started - begin;
  estimate.solve_s = Seconds() - started;
  if (refined) *refined = std::move(result);
  return estimate;
}

Result<EstimateOutput> EstimateScene(const std::vector<Keyframe>& keyframes,
                                     const Geometry& geometry, const calib::RayGrid& rays,
                                     const EstimateOptions& options) {
  const double begin = Seconds();
  std::vector<cv::Mat1b> flags;
  const Observations all = BuildObservations(keyframes, geometry, rays, &flags);
  const FlagCounts counts = Count(flags);
  if (static_cast<double>(counts.outliers) > kMostOutliers * static_cast<double>(counts.on_target))
    return NoEstimateError(
        Format("no usable estimate: %zu of %zu target pixels are unlike all around them: the "
               "pictures show something else than a surface; check their format and the masks.",
               counts.outliers, counts.on_target));
  std::vector<cv::Mat> signatures;
  for (const Keyframe& keyframe : keyframes) signatures.push_back(ViewSignature(keyframe));
  const double built = Seconds();
  EstimateOutput out;
  Refined refined;
  auto estimate = EstimateObservations(all, signatures, options, &out.map, &refined);
  if (!estimate) {
    Error error = estimate.error();
    if (all.used < kMinPixels) error.text += WhyNothing(counts);
    return tl::unexpected<Error>(std::move(error));
  }
  out.estimate = std::move(*estimate);
  out.estimate.initial_s += built - begin;
  if (static_cast<double>(counts.outliers) > kManyOutliers * static_cast<double>(counts.on_target))
    out.estimate.notes.push_back(
        {"outliers",
         Format("%zu of %zu target pixels are unlike all around them and were left out; "
                "some may have been missed.",
                counts.outliers, counts.on_target)});
  out.residuals = ResidualMaps(all, refined.solution.scene, refined.options.evaluate,
                               {rays.width(), rays.height()});
  return out;
}

}  // namespace turnlight::estimator
