#include "estimator/model/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "estimator/model/reflectance/models.h"
#include "estimator/model/reflectance/scalar.h"

namespace turnlight::estimator::model {
namespace {

using Numbers = reflectance::Scalar<double>;

// What the function gives for the formulas of a lobe's model; without a model for those of Phong.
template <typename Function>
auto VisitLobe(SpecularModel model, const Function& function) {
  decltype(function(reflectance::Phong{})) result{};
  const auto take = [&](auto formulas) { result = function(formulas); };
  if (!reflectance::Lobes::Visit(static_cast<int>(model) - 1, take)) take(reflectance::Phong{});
  return result;
}

}  // namespace

Light Recentred(const Light& light, const Eigen::Vector3d& new_origin) {
  const Eigen::Vector3d to_light = light.Toward(new_origin);
  const double scale = to_light.norm();
  Light result = light;
  result.direction = to_light / scale;
  result.inverse_distance = light.inverse_distance / scale;
  result.intensity = light.intensity / (scale * scale);
  return result;
}

bool Scene::coloured() const {
  const Eigen::Vector3d white = Eigen::Vector3d::Ones();
  return reflectance.ambient_colour != white || reflectance.specular_colour != white ||
         std::any_of(lights.begin(), lights.end(),
                     [&](const Light& light) { return light.color != white; });
}

Scene WithoutAmbient(Scene scene) {
  scene.reflectance.ambient = 0.0;
  scene.reflectance.harmonics.setZero();
  scene.free_harmonics = false;
  return scene;
}

Scene WithLargestColoursOne(Scene scene) {
  const auto normalise = [](Eigen::Vector3d& colour) {
    const double largest = colour.maxCoeff();
    if (!(largest > 0.0)) return 1.0;
    colour /= largest;
    return largest;
  };
  Reflectance& r = scene.reflectance;
  for (Light& light : scene.lights) light.intensity *= normalise(light.color);
  const double ambient = normalise(r.ambient_colour), specular = normalise(r.specular_colour);
  r.ambient *= ambient;
  r.harmonics *= ambient;
  for (Lobe& lobe : r.lobes) lobe.strength *= specular;
  return scene;
}

bool Scene::flickers() const {
  return std::any_of(lights.begin(), lights.end(),
                     [](const Light& light) { return !light.factors.empty(); });
}

Scene AtKeyframe(const Scene& scene, std::size_t keyframe) {
  Scene out = scene;
  for (Light& light : out.lights) {
    if (!light.factors.empty()) light.intensity *= light.factors[keyframe];
  }
  return WithoutFactors(std::move(out));
}

Scene WithoutFactors(Scene scene) {
  for (Light& light : scene.lights) light.factors.clear();
  scene.free_factors = false;
  return scene;
}

const reflectance::LobeFacts& FactsOf(SpecularModel model) {
  return *VisitLobe(model, [](auto of) { return &decltype(of)::kFacts; });
}

const reflectance::DiffuseFacts& FactsOf(DiffuseModel model) {
  const reflectance::DiffuseFacts* facts = &reflectance::Lambert::kFacts;
  reflectance::DiffuseModels::Visit(static_cast<int>(model),
                                    [&](auto diffuse) { facts = &decltype(diffuse)::kFacts; });
  return *facts;
}

namespace {

double HarmonicSum(const Eigen::Matrix<double, kHarmonics, 1>& coefficients,
                   const Eigen::Vector3d& normal) {
  double values[kHarmonics], sum = 0.0;
  FillHarmonics<Numbers>(normal.x(), normal.y(), normal.z(), values);
  for (int j = 0; j < kHarmonics; ++j) sum += coefficients[j] * values[j];
  return sum;
}

}  // namespace

double AmbientTerm(const Reflectance& r, const Eigen::Vector3d& normal) {
  return r.ambient + HarmonicSum(r.harmonics, normal);
}

double DiffuseTerm(const Reflectance& r, const Eigen::Vector3d& normal,
                   const Eigen::Vector3d& to_light, const Eigen::Vector3d& to_viewer) {
  const double nl = normal.dot(to_light);
  if (nl <= 0.0) return 0.0;
  const double nv = normal.dot(to_viewer);
  double constants[reflectance::kDiffuseConstants]{}, value = 0.0;
  reflectance::DiffuseModels::Visit(static_cast<int>(r.diffuse_model), [&](auto diffuse) {
    using Model = decltype(diffuse);
    Model::FillConstants(r.roughness, constants);
    value =
        Model::template Evaluate<Numbers>(constants, {nl, nv, to_light.dot(to_viewer) - nl * nv})
            .value;
  });
  return r.shading.isZero(0.0) ? value : value * (1.0 + HarmonicSum(r.shading, normal));
}

double SpecularTerm(const Lobe& lobe, const Eigen::Vector3d& normal,
                    const Eigen::Vector3d& to_light, const Eigen::Vector3d& to_viewer) {
  const double nl = normal.dot(to_light), nv = normal.dot(to_viewer);
  if (nl <= 0.0 || !lobe.present()) return 0.0;
  return VisitLobe(lobe.model, [&](auto of) {
    using Model = decltype(of);
    // The cosine is taken from the chord between the two unit vectors: near 1 the dot product has
    // lost what a narrow lobe needs.
    const bool mirrored = Model::kFacts.about_mirrored_view;
    const Eigen::Vector3d axis = mirrored ? Eigen::Vector3d(2.0 * nv * normal - to_viewer) : normal;
    const Eigen::Vector3d half =
        mirrored ? to_light : Eigen::Vector3d((to_light + to_viewer).normalized());
    return Model::template Evaluate<Numbers>(
               lobe.shape, lobe.f0,
               {0.5 * (half - axis).squaredNorm(), nl, nv, to_viewer.dot(half), 1.0})
        .value;
  });
}

double LobeHalfWidth(const Lobe& lobe) {
  return VisitLobe(lobe.model, [&](auto of) { return decltype(of)::HalfWidth(lobe.shape); });
}

double MirroredHalfWidth(const Lobe& lobe) {
  return (FactsOf(lobe.model).about_mirrored_view ? 1.0 : 2.0) * LobeHalfWidth(lobe);
}

double LobeInverseVariance(const Lobe& lobe) {
  return VisitLobe(lobe.model, [&](auto of) { return decltype(of)::InverseVariance(lobe.shape); });
}

LobeSlopes LobeSlopesOf(const Lobe& lobe) {
  // An exponent is an inverse variance, alpha goes with its root; what is normalised keeps its
  // strength.
  const bool power = FactsOf(lobe.model).cosine_power;
  return {power ? 1.0 : -0.5, power ? lobe.strength : 0.0};
}

double LobePeak(const Lobe& lobe) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  return lobe.strength * SpecularTerm(lobe, up, up, up);
}

namespace {

// What a lobe of strength 1 would have there; one that is not there counts as Phong.
double UnitPeak(Lobe lobe) {
  lobe.strength = 1.0;
  if (!lobe.present()) lobe.model = SpecularModel::kPhong;
  return LobePeak(lobe);
}

// The lobe with another inverse variance, as bright at its peak.
Lobe Reshaped(const Lobe& lobe, SpecularModel model, double inverse_variance) {
  Lobe out = lobe;
  out.model = model;
  const reflectance::LobeFacts& facts = FactsOf(model);
  if (!facts.physical) out.f0 = 1.0;
  out.shape = VisitLobe(model, [&](auto of) { return decltype(of)::ShapeOf(inverse_variance); });
  out.shape = std::clamp(out.shape, facts.least_shape, facts.most_shape);
  out.strength = lobe.strength * (UnitPeak(lobe) / UnitPeak(out));
  return out;
}

}  // namespace

Lobe OfWidth(const Lobe& lobe, double times) {
  return Reshaped(lobe, lobe.model, LobeInverseVariance(lobe) / (times * times));
}

Lobe Converted(const Lobe& lobe, SpecularModel model) {
  if (model == SpecularModel::kNone) {
    Lobe none = lobe;
    none.model = model;
    none.f0 = 1.0;
    none.strength = 0.0;
    return none;
  }
  const reflectance::LobeFacts &from = FactsOf(lobe.model), &to = FactsOf(model);
  // Mirrored rays turn twice as fast as the normal.
  const double scale =
      (from.about_mirrored_view ? 4.0 : 1.0) / (to.about_mirrored_view ? 4.0 : 1.0);
  return Reshaped(lobe, model, scale * LobeInverseVariance(lobe));
}

void SetLobeModel(Reflectance& reflectance, SpecularModel model) {
  Lobe& first = reflectance.lobes[0];
  if (model != first.model) first = Converted(first, model);
  if (!first.present()) reflectance.lobes[1] = Lobe{};
}

Eigen::Vector3d Shade(const Scene& scene, const Eigen::Vector3d& p_W,
                      const Eigen::Vector3d& normal_W, const Eigen::Vector3d& to_viewer_W,
                      LightMask visible) {
  const Reflectance& r = scene.reflectance;
  if (normal_W.dot(to_viewer_W) <= 0.0) return Eigen::Vector3d::Zero();
  Eigen::Vector3d diffuse = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, kMostLobes> specular;
  specular.fill(Eigen::Vector3d::Zero());
  for (std::size_t l = 0; l < scene.lights.size(); ++l) {
    if ((visible >> l & 1) == 0) continue;
    const Light& light = scene.lights[l];
    const Eigen::Vector3d to_light = light.Toward(p_W);
    const double squared = to_light.squaredNorm();
    const Eigen::Vector3d unit = to_light / std::sqrt(squared);
    const Eigen::Vector3d irradiance = light.intensity / squared * light.color;
    diffuse += irradiance * DiffuseTerm(r, normal_W, unit, to_viewer_W);
    for (std::size_t k = 0; k < kMostLobes && r.lobes[k].present(); ++k)
      specular[k] += irradiance * SpecularTerm(r.lobes[k], normal_W, unit, to_viewer_W);
  }
  Eigen::Vector3d sum =
      r.albedo.cwiseProduct(AmbientTerm(r, normal_W) * r.ambient_colour + r.diffuse * diffuse);
  for (std::size_t k = 0; k < kMostLobes; ++k)
    sum += r.lobes[k].strength * r.specular_colour.cwiseProduct(specular[k]);
  return sum;
}

}  // namespace turnlight::estimator::model
