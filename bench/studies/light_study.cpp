#include <algorithm>
#include <array>
#include <cmath>

#include "base/format.h"
#include "base/random.h"
#include "bench/studies/random_scene.h"
#include "bench/studies/score.h"
#include "bench/studies/studies.h"
#include "bench/studies/take.h"
#include "estimator/model/direction_lattice.h"

namespace turnlight::studies {
namespace {

using rig::sim::LightSpec;
using rig::sim::SyntheticConfig;

constexpr std::size_t kMostLights = 4;
constexpr std::uint64_t kLightStream = std::uint64_t{1} << 53;
constexpr double kFlicker = 0.05, kWarming = 0.1;
constexpr double kLeastColour = 0.5;  // of the largest channel
constexpr double kUneven = 0.9;       // of the ambient light is lacking on its darkest side
constexpr std::array kKinds{"white", "coloured", "flickering", "warming", "light-field"};

std::vector<LightSpec>& LightsOf(SyntheticConfig& config) {
  return std::get<std::vector<LightSpec>>(config.lights);
}

// The first random scene with few lights from ten numbers per scene on.
Result<SyntheticConfig> FewLights(int scene) {
  for (int i = 0; i < 10; ++i) {
    auto config = RandomScene(static_cast<std::uint64_t>(scene * 10 + i));
    if (config && LightsOf(*config).size() <= kMostLights) return config;
  }
  return InputError("none of its numbers has few lights");
}

void Dress(const std::string& kind, int scene, SyntheticConfig& config) {
  const RandomStream random(static_cast<std::uint64_t>(scene), kLightStream);
  std::uint64_t draw = 0;
  auto& reflectance = std::get<estimator::model::Reflectance>(config.reflectance);
  for (LightSpec& light : LightsOf(config)) {
    const int frames = config.motion.frames;
    if (kind == "coloured") {
      for (int c = 0; c < 3; ++c) light.color[c] = random.Uniform(draw++, kLeastColour, 1.0);
      light.color /= light.color.maxCoeff();
    }
    for (int k = 0; kind == "flickering" && k < frames; ++k)
      light.factors.push_back(std::max(1.0 + kFlicker * random.Normal(draw++), 0.0));
    // Towards its end as a body warms up, with a time constant of a third of the capture.
    for (int k = 0; kind == "warming" && k < frames; ++k)
      light.factors.push_back(1.0 - kWarming * std::exp(-3.0 * k / frames));
  }
  if (kind != "light-field") return;
  for (double& harmonic : reflectance.harmonics) harmonic = random.Normal(draw++);
  // As uneven as light can be: of one side hardly any.
  double darkest = 0.0;
  for (const Eigen::Vector3d& normal : estimator::model::SphereDirections(500))
    darkest =
        std::min(darkest, estimator::model::AmbientTerm(reflectance, normal) - reflectance.ambient);
  reflectance.harmonics *= kUneven * reflectance.ambient / -darkest;
}

struct Count {
  int good = 0, all = 0;
  void Add(double off, const Json& sigma) {
    if (!sigma.is_number()) return;
    ++all;
    good += std::abs(off) <= 3.0 * sigma.get<double>() ? 1 : 0;
  }
  Json ToJson() const { return Json::array({good, all}); }
};

std::vector<Match> MatchesOf(const estimator::model::Scene& truth, const Json& result) {
  std::vector<Eigen::Vector3d> known, found;
  for (const auto& light : truth.lights) known.push_back(light.direction);
  for (const Json& light : result["lights"])
    found.emplace_back(light["direction"][0], light["direction"][1], light["direction"][2]);
  return MatchLights(known, found);
}

// Colours within 3 sigma, relative to the strongest found light's, the largest channel 1.
Count Colours(const estimator::model::Scene& truth, const Json& result,
              const std::vector<Match>& matches) {
  Count out;
  const auto strongest =
      std::find_if(matches.begin(), matches.end(), [](const Match& m) { return m.found == 0; });
  if (strongest == matches.end()) return out;
  const Eigen::Vector3d gauge = truth.lights[strongest->truth].color;
  for (const Match& match : matches) {
    const Json& light = result["lights"][match.found];
    if (match.found == 0) continue;
    Eigen::Vector3d known = truth.lights[match.truth].color.cwiseQuotient(gauge);
    known /= known.maxCoeff();
    for (int c = 0; c < 3; ++c) {
      const bool white = !light.contains("color");
      const double value = white ? 1.0 : light["color"][static_cast<std::size_t>(c)].get<double>();
      if (known[c] < 1.0 && white) ++out.all;  // called white, and is not
      if (!white && known[c] < 1.0)
        out.Add(value - known[c], light["color_sigma"][static_cast<std::size_t>(c)]);
    }
  }
  return out;
}

// Factors within 3 sigma, each light's about a mean of 1.
Count Factors(const estimator::model::Scene& truth, const Json& result,
              const std::vector<Match>& matches) {
  Count out;
  for (const Match& match : matches) {
    const Json& light = result["lights"][match.found];
    const std::vector<double>& factors = truth.lights[match.truth].factors;
    if (!light.contains("factors") || factors.empty()) continue;
    // The mean is over the frames that see the light.
    double sum = 0.0, seen = 0.0;
    for (std::size_t k = 0; k < factors.size(); ++k) {
      if (!light["factors_sigma"][k].is_number()) continue;
      sum += factors[k];
      seen += 1.0;
    }
    const double mean = sum / std::max(seen, 1.0);
    for (std::size_t k = 0; k < factors.size(); ++k)
      out.Add(light["factors"][k].get<double>() - factors[k] / mean, light["factors_sigma"][k]);
  }
  return out;
}

Count Harmonics(const estimator::model::Scene& truth, const Json& result) {
  Count out;
  const Json& reflectance = result["reflectance"];
  if (!reflectance.contains("ambient_harmonics")) return out;
  // As the results have them: max(albedo) = 1.
  const estimator::model::Reflectance& r = truth.reflectance;
  for (std::size_t j = 0; j < estimator::model::kHarmonics; ++j)
    out.Add(reflectance["ambient_harmonics"][j].get<double>() -
                r.harmonics[static_cast<Eigen::Index>(j)] * r.albedo.maxCoeff(),
            reflectance["sigma"]["ambient_harmonics"][j]);
  return out;
}

Json Measure(const std::string& kind, int scene) {
  const auto config = LightConfig(kind, scene);
  if (!config) return Json{{"left_out", config.error().text}};
  const auto session = rig::sim::SynthesizeInMemory(*config);
  if (!session) return Json{{"failed", session.error().text}};
  const auto result = EstimateSynthetic(*session);
  if (!result) return Joined(Describe(*config), Json{{"failed", result.error().text}});
  Json record = Joined(Describe(*config), Score(session->scene, *result));
  const auto any = [&](const char* key) {
    return std::any_of((*result)["lights"].begin(), (*result)["lights"].end(),
                       [&](const Json& light) { return light.contains(key); });
  };
  const auto matches = MatchesOf(session->scene, *result);
  record["kind"] = kind;
  record["found_coloured"] = any("color");
  record["found_changing"] = any("factors");
  record["found_uneven"] = (*result)["reflectance"].contains("ambient_harmonics");
  record["colours"] = Colours(session->scene, *result, matches).ToJson();
  record["factors"] = Factors(session->scene, *result, matches).ToJson();
  record["harmonics"] = Harmonics(session->scene, *result).ToJson();
  return record;
}

}  // namespace

Result<SyntheticConfig> LightConfig(const std::string& kind, int scene) {
  if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end())
    return InputError("--lights: \"" + kind +
                      "\", allowed are white, coloured, flickering, warming, light-field");
  auto config = FewLights(scene);
  if (config) Dress(kind, scene, *config);
  return config;
}

std::vector<Job> LightJobs(Range scenes) {
  std::vector<Job> jobs;
  for (int i = scenes.begin; i < scenes.end; ++i)
    for (const std::string kind : kKinds)
      jobs.push_back(
          {Format("lights/%04d/%s", i, kind.c_str()), [kind, i] { return Measure(kind, i); }});
  return jobs;
}

}  // namespace turnlight::studies
