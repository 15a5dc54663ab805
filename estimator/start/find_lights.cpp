#include "estimator/start/find_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/format.h"
#include "estimator/model/direction_lattice.h"
#include "estimator/model/reflectance/models.h"
#include "estimator/solve/footprints.h"
#include "estimator/solve/prediction.h"
#include "estimator/start/add_missing_lights.h"
#include "estimator/start/eliminate_lights.h"
#include "estimator/start/merge_lights.h"
#include "estimator/start/score.h"
#include "estimator/start/start_scene.h"

namespace turnlight::estimator::start {
namespace {

namespace reflectance = model::reflectance;

constexpr std::size_t kMaxClusters = 12;
constexpr int kLatticeLights = 24;
// Of the excess variance, in a direction of colours that neither shading nor highlights have.
constexpr double kColourShare = 0.01;
constexpr double kGrey = 0.02;           // of an albedo: what is no colour
constexpr double kFirstRoughness = 0.3;  // radians

Eigen::Vector3d MeanNormal(const observe::Observations& all) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.pixel[i] != observe::Observations::kNoPixel)
      for (int k = 0; k < 3; ++k) sum[k] += static_cast<double>(all.normal[k][i]);
  return sum.norm() > 1e-6 * static_cast<double>(all.used) ? Eigen::Vector3d(sum.normalized())
                                                           : Eigen::Vector3d::UnitZ();
}

bool Rough(const Candidate& candidate) {
  return candidate.scene.reflectance.diffuse_model == model::DiffuseModel::kOrenNayar;
}

const char* Name(model::DiffuseModel model) { return model::FactsOf(model).name; }

Candidate WithDiffuse(Candidate candidate, model::DiffuseModel model) {
  model::Reflectance& r = candidate.scene.reflectance;
  r.diffuse_model = model;
  r.roughness = model == model::DiffuseModel::kOrenNayar ? kFirstRoughness : 0.0;
  return candidate;
}

Candidate WithLobe(Candidate candidate, model::SpecularModel model) {
  model::SetLobeModel(candidate.scene.reflectance, model);
  return candidate;
}

// Whether a fit with white lights leaves what only colours can explain: residuals that are neither
// of the albedo's colour, as of shading, nor white, as of highlights, beyond noise and a good part
// of all.
bool LeavesColour(const Sample& sample, const Candidate& candidate) {
  const observe::Observations& pixels = sample.pixels;
  solve::EvaluateOptions options;
  options.samples_per_side = solve::FootprintSamples(pixels, candidate.scene.reflectance);
  options.shadows = candidate.shadows;
  const solve::Prediction model = solve::Predict(pixels, candidate.scene, options);
  const Eigen::Vector3d white = Eigen::Vector3d::Ones().normalized();
  Eigen::Vector3d beside = candidate.scene.reflectance.albedo;
  beside -= white * white.dot(beside);
  const bool grey = beside.norm() < kGrey * candidate.scene.reflectance.albedo.norm();
  beside.normalize();
  double sum = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.pixel[i] == observe::Observations::kNoPixel) continue;
    Eigen::Vector3d residual;
    for (int c = 0; c < 3; ++c)
      residual[c] =
          static_cast<double>(pixels.radiance[c][i] - model[static_cast<std::size_t>(c)][i]);
    residual -= white * white.dot(residual);
    if (!grey) residual -= beside * beside.dot(residual);
    sum += pixels.WeightOf(i) * pixels.WeightOf(i) * residual.squaredNorm();
  }
  const double values = ValuesIn(pixels) / 3.0 * (grey ? 2.0 : 1.0);
  return sum / values - sample.noise * sample.noise > kColourShare * candidate.excess;
}

// The candidates so far, and what became of each.
struct Search {
  const Sample& sample;
  std::vector<Candidate> found;
  std::vector<std::string> names;
  std::string tried;
  bool done = false;     // the last leaves nothing
  bool colours = false;  // of the lights are free

  // Returns the excess variance that the start led to.
  double Try(const char* from, const std::vector<Eigen::Vector3d>& directions,
             model::DiffuseModel diffuse) {
    return Try(from, StartFromDirections(sample.pixels, directions), diffuse);
  }
  double Try(const char* from, model::Scene scene, model::DiffuseModel diffuse) {
    Candidate start;
    start.scene = std::move(scene);
    start.scene.free_colours = colours;
    start.scene.free_factors = sample.choice.changing.value_or(false);
    start.scene.free_harmonics = sample.choice.harmonics.value_or(false);
    start = WithDiffuse(std::move(start), diffuse);
    start =
        WithLobe(std::move(start), sample.choice.specular.value_or(model::SpecularModel::kPhong));
    found.push_back(AddMissingLights(sample, Eliminate(sample, FitAndMerge(sample, start.scene))));
    names.push_back(std::string(from) + " with " + Name(diffuse) +
                    (colours ? " and colours of their own" : ""));
    const Candidate& last = found.back();
    tried += (tried.empty() ? "" : "; ") + names.back() +
             Format(" lead to %zu lights with an excess variance of %.3g", last.scene.lights.size(),
                    last.excess);
    done = NothingLeft(last.excess, sample);
    return last.excess;
  }

  std::size_t Best() const {
    std::vector<Compared> compared;
    for (const Candidate& one : found) compared.push_back({&one.scene, one.excess});
    return BestOf(sample.choice, compared);
  }
  const Candidate& Lowest() const {
    return *std::min_element(
        found.begin(), found.end(),
        [](const Candidate& a, const Candidate& b) { return a.excess < b.excess; });
  }
};

}  // namespace

Candidate FindLights(const Sample& sample, const std::vector<observe::MapPoint>& clusters,
                     std::vector<model::Rung>& ladder, const Beyond& beyond) {
  std::vector<Eigen::Vector3d> directions;
  for (const observe::MapPoint& cluster : clusters)
    if (directions.size() < kMaxClusters) directions.push_back(cluster.direction);
  const auto lattice = model::HemisphereDirections(kLatticeLights, MeanNormal(sample.pixels));
  Search search{sample, {}, {}, {}};
  const bool grey = sample.pixels.channels == 1;
  search.colours = sample.choice.coloured.value_or(false) && !grey;
  model::DiffuseModel diffuse = sample.choice.diffuse.value_or(model::DiffuseModel::kLambert);
  const double first = search.Try("the intensity map's clusters", directions, diffuse);
  if (!search.done && beyond && beyond(sample)) return std::move(search.found.front());
  if (!search.done && !sample.choice.diffuse) {
    const double rough = search.Try("the clusters", directions, model::DiffuseModel::kOrenNayar);
    // Oren-Nayar can be as smooth as Lambert; Lambert has fewer ways to go wrong.
    if (first > RatioFor(kRoughPrice) * rough) diffuse = model::DiffuseModel::kOrenNayar;
  }
  if (!search.done) search.Try("a lattice of lights", lattice, diffuse);
  // A fit of the other surface may have got past where this one stops.
  if (!search.done && !sample.choice.diffuse)
    search.Try(
        "the lights of the least of these", search.Lowest().scene,
        Rough(search.Lowest()) ? model::DiffuseModel::kLambert : model::DiffuseModel::kOrenNayar);
  if (!search.done && !sample.choice.coloured && !grey && LeavesColour(sample, search.Lowest())) {
    search.colours = true;
    search.Try("the clusters", directions, diffuse);
    if (!search.done) search.Try("a lattice of lights", lattice, diffuse);
  }
  const std::size_t at = search.Best();
  Candidate best = std::move(search.found[at]);
  ladder.push_back({"start", true, search.tried + ". Taken: " + search.names[at]});
  if (sample.choice.lights)
    ladder.push_back({"lights", static_cast<int>(best.scene.lights.size()) == *sample.choice.lights,
                      Format("%d were asked for, %zu could be fitted", *sample.choice.lights,
                             best.scene.lights.size())});
  return best;
}

Candidate ChooseDiffuse(const Sample& sample, const Candidate& candidate,
                        std::vector<model::Rung>& ladder) {
  if (sample.choice.diffuse) {
    ladder.push_back({"oren-nayar", Rough(candidate), "as asked for"});
    return candidate;
  }
  if (!Rough(candidate) && NothingLeft(candidate.excess, sample)) {
    ladder.push_back({"oren-nayar", false,
                      Format("with Lambert the excess variance is %.3g: nothing is left to explain",
                             candidate.excess)});
    return candidate;
  }
  const auto with = [&](model::DiffuseModel model) {
    return Eliminate(sample, model == candidate.scene.reflectance.diffuse_model
                                 ? candidate
                                 : WithDiffuse(candidate, model));
  };
  Candidate smooth = with(model::DiffuseModel::kLambert),
            rough = with(model::DiffuseModel::kOrenNayar);
  const bool accepted =
      BestOf(sample.choice, {{&smooth.scene, smooth.excess}, {&rough.scene, rough.excess}}) == 1;
  ladder.push_back(
      {"oren-nayar", accepted,
       Format("excess variance %.3g with Lambert and %zu lights, %.3g with Oren-Nayar and %zu; "
              "in the smaller of both a rough surface costs %.2f and each light %.0f",
              smooth.excess, smooth.scene.lights.size(), rough.excess, rough.scene.lights.size(),
              kRoughPrice, kLightPrice)});
  return accepted ? rough : smooth;
}

namespace {

// A surface that is tried: a lobe on a diffuse model.
struct Surface {
  model::SpecularModel lobe;
  model::DiffuseModel diffuse;
  Candidate fitted;

  bool coated() const { return diffuse == model::DiffuseModel::kCoated; }
};

// What may be, the simplest first: that of the candidate. What the user chose is not varied. All of
// them together: a lobe that is wrong and a coat that lacks can stand for each other.
std::vector<Surface> SurfacesToTry(const Sample& sample, const Candidate& candidate) {
  const model::Reflectance& r = candidate.scene.reflectance;
  std::vector<model::SpecularModel> lobes{r.lobes[0].model};
  for (int number = 1; number <= reflectance::Lobes::kCount && !sample.choice.specular; ++number)
    if (const auto lobe = static_cast<model::SpecularModel>(number); lobe != lobes[0])
      lobes.push_back(lobe);
  std::vector<model::DiffuseModel> bodies{r.diffuse_model};
  if (!sample.choice.diffuse && r.diffuse_model != model::DiffuseModel::kCoated)
    bodies.push_back(model::DiffuseModel::kCoated);
  std::vector<Surface> surfaces;
  for (const model::DiffuseModel body : bodies)
    for (const model::SpecularModel lobe : lobes) surfaces.push_back({lobe, body, {}});
  return surfaces;
}

// The least excess of those that a condition chooses.
template <typename Condition>
double LeastExcess(const std::vector<Surface>& surfaces, const Condition& condition) {
  double least = std::numeric_limits<double>::infinity();
  for (const Surface& surface : surfaces)
    if (condition(surface)) least = std::min(least, surface.fitted.excess);
  return least;
}

// The best by the score, without more lights.
Surface& Cheapest(const Sample& sample, std::vector<Surface>& surfaces) {
  Surface& simplest = surfaces.front();
  std::vector<Compared> compared;
  for (const Surface& surface : surfaces)
    compared.push_back({&surface.fitted.scene, surface.fitted.excess});
  Surface& best = surfaces[BestOf(sample.choice, compared)];
  if (&best == &simplest) return simplest;
  const std::size_t lights = simplest.fitted.scene.lights.size();
  best.fitted = Eliminate(sample, best.fitted);
  return best.fitted.scene.lights.size() > lights ? simplest : best;
}

// Of each lobe but Phong, the simplest.
void TellLobes(const std::vector<Surface>& surfaces, const Surface& taken,
               std::vector<model::Rung>& ladder) {
  const auto least = [&](model::SpecularModel lobe) {
    return LeastExcess(surfaces, [&](const Surface& surface) { return surface.lobe == lobe; });
  };
  const double phong = least(model::SpecularModel::kPhong);
  for (int number = 2; number <= reflectance::Lobes::kCount; ++number) {
    const auto lobe = static_cast<model::SpecularModel>(number);
    const reflectance::LobeFacts& facts = model::FactsOf(lobe);
    ladder.push_back(
        {facts.word, taken.lobe == lobe,
         Format("excess variance %.3g with Phong, %.3g with %s; it counts from a ratio of %.2f",
                phong, least(lobe), facts.name, RatioFor(kLobePrice))});
  }
}

void TellCoat(const std::vector<Surface>& surfaces, const Surface& taken,
              std::vector<model::Rung>& ladder) {
  const auto least = [&](bool coated) {
    return LeastExcess(surfaces,
                       [&](const Surface& surface) { return surface.coated() == coated; });
  };
  ladder.push_back({model::FactsOf(model::DiffuseModel::kCoated).word, taken.coated(),
                    Format("excess variance %.3g without a coat over the diffuse part, %.3g with "
                           "one; it counts from a ratio of %.2f",
                           least(false), least(true), RatioFor(kCoatPrice))});
}

// What is not varied, because the user chose it or nothing is left to explain.
void TellWhatStands(const Sample& sample, const Candidate& candidate,
                    std::vector<model::Rung>& ladder) {
  const std::string first = model::FactsOf(model::SpecularModel::kBlinnPhong).word;
  if (const auto& asked = sample.choice.specular) {
    const bool plain =
        *asked == model::SpecularModel::kNone || *asked == model::SpecularModel::kPhong;
    ladder.push_back({plain ? first : model::FactsOf(*asked).word, !plain, "as asked for"});
  } else if (NothingLeft(candidate.excess, sample)) {
    ladder.push_back({first, false,
                      Format("with Phong the excess variance is %.3g: nothing is left to explain",
                             candidate.excess)});
  }
  if (sample.choice.diffuse == model::DiffuseModel::kCoated)
    ladder.push_back({model::FactsOf(*sample.choice.diffuse).word, true, "as asked for"});
}

}  // namespace

Candidate ChooseLobeAndCoat(const Sample& sample, const Candidate& candidate,
                            std::vector<model::Rung>& ladder) {
  TellWhatStands(sample, candidate, ladder);
  std::vector<Surface> surfaces = SurfacesToTry(sample, candidate);
  if (surfaces.size() == 1 || NothingLeft(candidate.excess, sample)) return candidate;
  for (Surface& surface : surfaces) {
    if (&surface == &surfaces.front()) {
      surface.fitted = candidate;
      continue;
    }
    Candidate start = WithLobe(candidate, surface.lobe);
    if (surface.diffuse != surfaces.front().diffuse)
      start = WithDiffuse(std::move(start), surface.diffuse);
    surface.fitted = Refit(sample, start, 40, sample.noise, kToKeep);
  }
  const Surface& taken = Cheapest(sample, surfaces);
  if (!sample.choice.specular) TellLobes(surfaces, taken, ladder);
  if (surfaces.back().diffuse != surfaces.front().diffuse) TellCoat(surfaces, taken, ladder);
  return taken.fitted;
}

}  // namespace turnlight::estimator::start
