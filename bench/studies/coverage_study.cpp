#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>
#include <optional>

#include "base/angles.h"
#include "base/format.h"
#include "base/random.h"
#include "bench/studies/random_scene.h"
#include "bench/studies/score.h"
#include "bench/studies/studies.h"
#include "bench/studies/take.h"
#include "rig/sim/studio.h"

namespace turnlight::studies {
namespace {

constexpr int kDraws = 20;
constexpr int kNumbersPerScene = 10;  // the first that fits is taken
constexpr std::size_t kMostLights = 4;
constexpr double kLeastNoise = 0.002;
constexpr double kMostlyOpen = 10.0;       // sigma_total over sigma_stat
constexpr int kWidth = 120, kHeight = 90;  // small pictures: the noise counts, and it is quick
constexpr std::uint64_t kNoiseStream = std::uint64_t{1} << 52;

bool Fits(const rig::sim::SyntheticConfig& config) {
  return !std::holds_alternative<rig::sim::Blob>(config.target) &&
         config.sensor.noise_relative >= kLeastNoise &&
         std::get<std::vector<rig::sim::LightSpec>>(config.lights).size() <= kMostLights;
}

Result<rig::sim::SyntheticConfig> CoverageScene(int scene) {
  for (int i = 0; i < kNumbersPerScene; ++i) {
    auto config = RandomScene(static_cast<std::uint64_t>(scene * kNumbersPerScene + i));
    if (!config || !Fits(*config)) continue;
    config->camera.focal_px *= static_cast<double>(kWidth) / config->camera.width;
    config->camera.width = kWidth;
    config->camera.height = kHeight;
    return config;
  }
  return InputError("none of its numbers has noise, few lights and is no lump");
}

// The pictures without noise, and the sensor that photographs them again and again.
class Camera {
 public:
  static Result<Camera> Build(const rig::sim::SyntheticConfig& config) {
    auto studio = rig::sim::BuildStudio(config);
    if (!studio) return Forward(studio);
    Camera camera(config, std::move(*studio));
    for (int i = 0; i < config.motion.frames; ++i) {
      camera.placements_.push_back(rig::sim::PlaceAt(config.motion, i * config.motion.step_deg));
      camera.renderings_.push_back(
          rig::sim::RenderPlacement(camera.studio_, camera.placements_.back()));
    }
    return camera;
  }

  rig::sim::SyntheticSession Draw(int draw) const {
    rig::sim::SyntheticSession session{
        studio_.camera, studio_.target, studio_.radiometry, {}, studio_.scene};
    for (std::size_t i = 0; i < placements_.size(); ++i) {
      const RandomStream random(config_.seed,
                                kNoiseStream + static_cast<std::uint64_t>(draw) * 1000 + i);
      session.frames.push_back({rig::sim::Photograph(config_.sensor, studio_.radiometry, {}, random,
                                                     renderings_[i].radiance),
                                renderings_[i].coverage > 0.0f, placements_[i].X_WC,
                                placements_[i].X_WT, 0.0, calib::Exposure{}});
    }
    return session;
  }

 private:
  Camera(rig::sim::SyntheticConfig config, rig::sim::Studio studio)
      : config_(std::move(config)), studio_(std::move(studio)) {}
  rig::sim::SyntheticConfig config_;
  rig::sim::Studio studio_;
  std::vector<calib::RigPoses> placements_;
  std::vector<estimator::target::Rendering> renderings_;
};

// A light's direction errors of all draws, in the tangent plane of the truth.
struct Tangent {
  std::vector<Eigen::Vector2d> errors;  // radians
  std::vector<double> sigmas;           // radians; NaN where null
  // Stated, of the position, which is the direction's but for the scale; none for a distant light.
  std::vector<std::optional<Eigen::Matrix2d>> covariances;
};

Eigen::Vector2d PrincipalAxis(const Eigen::Matrix2d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvectors().col(1);
}

// The stated sigma of a direction is that of its worst axis. Along that axis the error is one
// number with one sigma. Which axis it is the stated covariance tells, and where there is none the
// errors of the other draws.
std::vector<double> AlongWorstAxis(const Tangent& tangent) {
  std::vector<double> out;
  for (std::size_t i = 0; i < tangent.errors.size(); ++i) {
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (std::size_t j = 0; j < tangent.errors.size(); ++j)
      if (j != i) scatter += tangent.errors[j] * tangent.errors[j].transpose();
    const Eigen::Vector2d axis = PrincipalAxis(tangent.covariances[i].value_or(scatter));
    out.push_back(axis.dot(tangent.errors[i]) / tangent.sigmas[i]);
  }
  return out;
}

// What the draws add up to: per quantity its errors in sigmas, signed.
class Collector {
 public:
  explicit Collector(const estimator::model::Scene& truth) : truth_(truth) {}

  // False if the count is wrong: then nothing can be compared.
  bool Add(const Json& result) {
    const Json record = Score(truth_, result);
    if (!record["right"].get<bool>()) return false;
    std::vector<Eigen::Vector3d> truth, found;
    for (const estimator::model::Light& light : truth_.lights) truth.push_back(light.direction);
    for (const Json& light : result["lights"]) {
      const Json& d = light["direction"];
      found.emplace_back(d[0].get<double>(), d[1].get<double>(), d[2].get<double>());
    }
    for (const Match& match : MatchLights(truth, found))
      AddDirection(static_cast<int>(match.truth), truth[match.truth], found[match.found],
                   result["lights"][match.found]);
    for (const Json& json : record["quantities"]) {
      const Quantity quantity = QuantityFromJson(json);
      if (quantity.name == "direction" || quantity.name == "distance") continue;
      // A distant light's rho has its truth at the bound of 0: half of its errors are 0.
      const bool at_bound = quantity.name == "inverse_distance" && quantity.truth == 0.0;
      const double sigma = quantity.sigma.value_or(NAN);
      // What the scene leaves open, as roughness on a board under one light, is wrong by the same
      // in every draw: noise does not test it.
      const bool open = quantity.sigma_stat && sigma > kMostlyOpen * *quantity.sigma_stat;
      const char* const kind = at_bound ? "_distant" : open ? "_open" : "";
      Values& values = values_[{quantity.name + kind, quantity.light}];
      values.in_sigmas.push_back(quantity.Error() / sigma);
      if (quantity.sigma_stat)
        values.in_stat_sigmas.push_back(quantity.Error() / *quantity.sigma_stat);
    }
    return true;
  }

  // [[name, light, [errors in sigma_total], [errors in sigma_stat]], ...]
  Json ToJson() const {
    Json json = Json::array();
    for (const auto& [key, values] : values_)
      json.push_back(
          {key.first, key.second, Short(values.in_sigmas), Short(values.in_stat_sigmas)});
    for (const auto& [light, tangent] : directions_)
      json.push_back({"direction", light, Short(AlongWorstAxis(tangent)), Json::array()});
    return json;
  }

 private:
  struct Values {
    std::vector<double> in_sigmas, in_stat_sigmas;
  };

  static Json Short(const std::vector<double>& values) {
    Json json = Json::array();
    for (const double value : values) json.push_back(Rounded(value, 3));
    return json;
  }

  void AddDirection(int light, const Eigen::Vector3d& truth, const Eigen::Vector3d& found,
                    const Json& stated) {
    const Json& sigma_deg = stated["direction_sigma_deg"];
    const Json& covariance = stated["position_covariance"];
    Eigen::Matrix<double, 3, 2> basis;
    basis.col(0) = truth.unitOrthogonal();
    basis.col(1) = truth.cross(basis.col(0));
    Tangent& tangent = directions_[light];
    tangent.errors.push_back(basis.transpose() * found);
    tangent.sigmas.push_back(sigma_deg.is_number() ? DegToRad(sigma_deg.get<double>()) : NAN);
    tangent.covariances.emplace_back();
    if (!covariance.is_array()) return;
    Eigen::Matrix3d position;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        position(row, column) = covariance[row][column].get<double>();
    tangent.covariances.back() = basis.transpose() * position * basis;
  }

  const estimator::model::Scene& truth_;
  std::map<std::pair<std::string, int>, Values> values_;
  std::map<int, Tangent> directions_;
};

Json Cover(int scene) {
  const auto config = CoverageScene(scene);
  if (!config) return Json{{"left_out", config.error().text}};
  const auto camera = Camera::Build(*config);
  if (!camera) return Json{{"failed", camera.error().text}};
  const estimator::model::Scene truth = camera->Draw(0).scene;
  Collector collector(truth);
  int wrong = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto result = EstimateSynthetic(camera->Draw(draw));
    if (!result || !collector.Add(*result)) ++wrong;
  }
  Json record = Describe(*config);
  record["lights_true"] = truth.lights.size();
  record["draws"] = kDraws;
  record["wrong_counts"] = wrong;
  record["errors"] = collector.ToJson();
  return record;
}

}  // namespace

std::vector<Job> CoverageJobs(Range scenes) {
  std::vector<Job> jobs;
  for (int i = scenes.begin; i < scenes.end; ++i) {
    jobs.push_back({Format("coverage/%04d", i), [i] { return Cover(i); }});
  }
  return jobs;
}

}  // namespace turnlight::studies
