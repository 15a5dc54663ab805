#include "estimator/uncertainty/correlation.h"

#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "estimator/model/tangent_basis.h"
#include "estimator/uncertainty/quantities.h"

namespace turnlight::estimator::uncertainty {
namespace {

constexpr const char* kChannels[] = {"red", "green", "blue"};

// The axes of the two coordinates of a direction that people know, in columns.
Eigen::Matrix<double, 3, 2> SkyBasis(const Eigen::Vector3d& u) {
  const double across = std::hypot(u.x(), u.y());
  const double cos_a = across > 0.0 ? u.x() / across : 1.0;
  const double sin_a = across > 0.0 ? u.y() / across : 0.0;
  Eigen::Matrix<double, 3, 2> basis;
  basis << -sin_a, u.z() * cos_a,  //
      cos_a, u.z() * sin_a,        //
      0.0, -across;
  return basis;
}

// Of the covariance, each light's direction in those coordinates instead of the tangent basis'.
Eigen::MatrixXd WithSkyDirections(Eigen::MatrixXd covariance, const Reported& at) {
  for (std::size_t l = 0; l < at.lights.size(); ++l) {
    const Eigen::Vector3d& u = at.lights[l].light.direction;
    const Eigen::Matrix2d turn = SkyBasis(u).transpose() * model::TangentBasis(u);
    const Eigen::Index row = At(OfLight::kDirection, l);
    covariance.middleRows<2>(row) = (turn * covariance.middleRows<2>(row)).eval();
    covariance.middleCols<2>(row) = (covariance.middleCols<2>(row) * turn.transpose()).eval();
  }
  return covariance;
}

// The rows that results have, and where in the vector each stands.
class Rows {
 public:
  Rows(const Eigen::MatrixXd& covariance, int channels)
      : covariance_(covariance), channels_(channels) {}

  // unit: what its sigma is multiplied by in results.
  void Add(Eigen::Index at, CorrelatedQuantity quantity, double unit = 1.0) {
    quantity.sigma = unit * std::sqrt(std::max(covariance_(at, at), 0.0));
    if (std::isnan(covariance_(at, at)) || !(quantity.sigma > 0.0) ||
        !std::isfinite(quantity.sigma))
      return;
    quantities_.push_back(std::move(quantity));
    at_.push_back(at);
  }
  // One of three channels.
  void AddColour(Eigen::Index at, const CorrelatedQuantity& quantity) {
    for (int c = 0; c < channels_; ++c) {
      CorrelatedQuantity channel = quantity;
      if (channels_ > 1) channel.part = kChannels[c];
      Add(at + c, std::move(channel));
    }
  }

  Correlation Take() {
    const auto count = static_cast<Eigen::Index>(at_.size());
    Correlation out{std::move(quantities_), Eigen::MatrixXd::Identity(count, count)};
    const Eigen::MatrixXd chosen = covariance_(at_, at_);
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index j = 0; j < i; ++j) {
        const double r = chosen(i, j) / std::sqrt(chosen(i, i)) / std::sqrt(chosen(j, j));
        out.matrix(i, j) = out.matrix(j, i) = std::clamp(r, -1.0, 1.0);
      }
    return out;
  }

 private:
  const Eigen::MatrixXd& covariance_;
  int channels_;
  std::vector<CorrelatedQuantity> quantities_;
  std::vector<Eigen::Index> at_;
};

bool IsWhite(const Eigen::Vector3d& colour) { return colour == Eigen::Vector3d::Ones(); }

void AddLight(const ReportedLight& light, std::size_t l, Rows& rows) {
  constexpr const char* kCoordinates[] = {"azimuth", "zenith"};
  for (int axis = 0; axis < 2; ++axis)
    rows.Add(At(OfLight::kDirection, l) + axis, {"direction", kCoordinates[axis], l},
             RadToDeg(1.0));
  if (light.light.inverse_distance > 0.0)
    rows.Add(At(OfLight::kDistance, l), {"distance", "", l});
  else
    rows.Add(At(OfLight::kInverseDistance, l), {"inverse distance", "", l});
  if (l > 0) rows.Add(At(OfLight::kIntensity, l), {"intensity", "", l});
  if (!IsWhite(light.light.color)) rows.AddColour(At(OfLight::kColour, l), {"colour", "", l});
  rows.AddColour(At(OfLight::kDiffuseProduct, l), {"diffuse product", "", l});
  rows.Add(At(OfLight::kSpecularProduct, l), {"specular product", "", l});  // of the first lobe
}

void AddLobes(const model::Reflectance& r, std::size_t lights, Rows& rows) {
  for (std::size_t k = 0; k < model::kMostLobes; ++k) {
    if (!r.lobes[k].present()) continue;
    const model::reflectance::LobeFacts& facts = model::FactsOf(r.lobes[k].model);
    const std::string of_lobe = k > 0 ? " of lobe " + std::to_string(k + 1) : "";
    const Eigen::Index at = At(OfTarget::kLobes, lights) + 3 * static_cast<Eigen::Index>(k);
    rows.Add(at, {"specular" + of_lobe, "", {}});
    rows.Add(at + 1, {facts.shape_key + of_lobe, "", {}});
    if (facts.physical) rows.Add(at + 2, {"f0" + of_lobe, "", {}});
  }
}

void AddTarget(const model::Reflectance& r, std::size_t lights, Rows& rows) {
  rows.AddColour(At(OfTarget::kAlbedo, lights), {"albedo", "", {}});
  rows.Add(At(OfTarget::kAmbient, lights), {"ambient", "", {}});
  if (!r.harmonics.isZero(0.0))
    for (Eigen::Index j = 0; j < model::kHarmonics; ++j)
      rows.Add(At(OfTarget::kHarmonics, lights) + j,
               {"ambient harmonic " + std::to_string(j + 1), "", {}});
  if (!IsWhite(r.ambient_colour))
    rows.AddColour(At(OfTarget::kAmbientColour, lights), {"ambient colour", "", {}});
  rows.Add(At(OfTarget::kDiffuse, lights), {"diffuse", "", {}});
  if (r.diffuse_model == model::DiffuseModel::kOrenNayar)
    rows.Add(At(OfTarget::kRoughness, lights), {"roughness", "", {}}, RadToDeg(1.0));
  AddLobes(r, lights, rows);
  if (r.lobes[0].present() && !IsWhite(r.specular_colour))
    rows.AddColour(At(OfTarget::kSpecularColour, lights), {"specular colour", "", {}});
  rows.AddColour(At(OfTarget::kAmbientProduct, lights), {"ambient product", "", {}});
}

}  // namespace

std::string CorrelatedQuantity::name() const {
  return quantity + (light ? " of light " + std::to_string(*light + 1) : "") +
         (part.empty() ? "" : ", " + part);
}

Correlation CorrelationOf(const Eigen::MatrixXd& covariance, const Reported& at, int channels) {
  const Eigen::MatrixXd turned = WithSkyDirections(covariance, at);
  Rows rows(turned, channels);
  for (std::size_t l = 0; l < at.lights.size(); ++l) AddLight(at.lights[l], l, rows);
  AddTarget(at.reflectance, at.lights.size(), rows);
  return rows.Take();
}

Correlation WithoutLight(const Correlation& correlation, std::size_t light) {
  Correlation out;
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < correlation.quantities.size(); ++i) {
    CorrelatedQuantity quantity = correlation.quantities[i];
    if (quantity.light == light) continue;
    if (quantity.light && *quantity.light > light) --*quantity.light;
    out.quantities.push_back(std::move(quantity));
    kept.push_back(static_cast<Eigen::Index>(i));
  }
  out.matrix = correlation.matrix(kept, kept);
  return out;
}

}  // namespace turnlight::estimator::uncertainty
