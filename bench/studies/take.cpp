#include "bench/studies/take.h"

#include <chrono>

#include "bench/studies/score.h"
#include "estimator/results/result_json.h"

namespace turnlight::studies {
namespace {

std::string TargetWord(const rig::sim::SyntheticTarget& target) {
  if (std::holds_alternative<calib::SphereShape>(target)) return "sphere";
  return std::holds_alternative<calib::PlaneShape>(target) ? "board" : "blob";
}

std::string SensorWord(const rig::sim::Sensor& sensor) {
  const std::string depth = sensor.depth == rig::sim::SensorDepth::k8    ? "8"
                            : sensor.depth == rig::sim::SensorDepth::k16 ? "16"
                                                                         : "float";
  return depth + (sensor.encoding == calib::Encoding::kSrgb    ? " sRGB"
                  : sensor.encoding == calib::Encoding::kGamma ? " gamma"
                                                               : " linear");
}

// method: what to do with keyframes, geometry and rays.
template <typename Method>
Result<Json> EstimateBy(const rig::sim::SyntheticSession& session, const Method& method) {
  const auto keyframes = rig::sim::ToKeyframes(session);
  const auto start = std::chrono::steady_clock::now();
  const estimator::target::Geometry geometry(session.target);
  const calib::RayGrid rays(session.camera);
  const auto output = method(keyframes, geometry, rays);
  if (!output) return Forward(output);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return Json::parse(estimator::results::ResultToJson(
      output->estimate, "study", estimator::results::Method::kLeastSquares, {0.0, seconds}));
}

Json ScoreOrFailure(const rig::sim::SyntheticSession& session, const Result<Json>& result) {
  return result ? Score(session.scene, *result) : Json{{"failed", result.error().text}};
}

}  // namespace

Result<Json> EstimateSynthetic(const rig::sim::SyntheticSession& session,
                               const estimator::EstimateOptions& options) {
  return EstimateBy(session, [&](const auto& keyframes, const auto& geometry, const auto& rays) {
    return estimator::EstimateScene(keyframes, geometry, rays, options);
  });
}

Json EstimateAndScore(const rig::sim::SyntheticSession& session,
                      const estimator::EstimateOptions& options) {
  return ScoreOrFailure(session, EstimateSynthetic(session, options));
}

Json EstimateAndScoreByPaper(const rig::sim::SyntheticSession& session,
                             const estimator::baseline::PaperOptions& options) {
  return ScoreOrFailure(session, EstimateBy(session, [&](const auto& keyframes,
                                                         const auto& geometry, const auto& rays) {
                          return estimator::baseline::EstimateByPaper(
                              estimator::model::SourceOf(keyframes), geometry, rays, options);
                        }));
}

Json TakeAndScore(const rig::sim::SyntheticConfig& config,
                  const estimator::EstimateOptions& options) {
  const auto session = rig::sim::SynthesizeInMemory(config);
  if (!session) return Json{{"failed", session.error().text}};
  return Joined(Describe(config), EstimateAndScore(*session, options));
}

Json Joined(Json first, const Json& second) {
  first.update(second);
  return first;
}

Json Describe(const rig::sim::SyntheticConfig& config) {
  Json json;
  json["seed"] = config.seed;
  json["target"] = TargetWord(config.target);
  json["motion"] = config.motion.kind == rig::sim::MotionKind::kOrbit ? "orbit" : "table";
  json["views"] = config.motion.frames;
  json["width"] = config.camera.width;
  json["sensor"] = SensorWord(config.sensor);
  json["noise"] = Rounded(config.sensor.noise_relative, 3);
  if (const auto* material = std::get_if<estimator::model::Reflectance>(&config.reflectance)) {
    json["shininess"] = Rounded(material->lobes[0].shape, 3);
    json["diffuse_true"] = estimator::results::WordOf(material->diffuse_model);
  }
  return json;
}

}  // namespace turnlight::studies
