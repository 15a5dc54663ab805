#include "calib/calibrate/probe/lights_json.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

template <typename Value>
json OrNull(const std::optional<Value>& value) {
  return value ? json(*value) : json(nullptr);
}

json ListOf(const Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

json RowsOf(const Eigen::Matrix3d& matrix) {
  json rows = json::array();
  for (int i = 0; i < 3; ++i) rows.push_back(ListOf(matrix.row(i).transpose()));
  return rows;
}

double SigmaDeg(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  return RadToDeg(std::sqrt(std::max(0.0, eigen.eigenvalues()[2])));
}

// A spot; with how far the light predicts it elsewhere, if it is one's.
json SpotJson(const std::vector<ProbeSession>& sessions, const SpotIndex& index,
              const ProbeLight* light) {
  const FrameOfView at = FindFrame(sessions, index.view);
  const ProbeSession& session = sessions[at.session];
  const Spot& spot = session.spots[at.frame][index.spot];
  const Eigen::Matrix2d covariance = spot.noise_covariance + spot.shape_covariance;
  json written = {{"session", at.session},
                  {"frame", at.frame},
                  {"pixel", {spot.pixel.x(), spot.pixel.y()}},
                  {"pixel_sigma", {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1))}},
                  {"peak", spot.peak},
                  {"ground", spot.ground},
                  {"noise", spot.noise},
                  {"area_px", spot.area_px},
                  {"extent_deg", spot.extent_deg},
                  {"clipped", spot.clipped}};
  if (light == nullptr) return written;
  const auto predicted =
      PixelOfLight(session.views[at.frame], light->direction, light->inverse_distance);
  written["residual_px"] = nullptr;
  if (predicted) {
    const Eigen::Vector2d off = spot.pixel - *predicted;
    written["residual_px"] = {off.x(), off.y()};
  }
  return written;
}

json SigmasJson(const LightSigmas& sigmas, bool near) {
  return {{"direction_sigma_deg", RadToDeg(sigmas.direction)},
          {"inverse_distance_sigma", near ? json(sigmas.inverse_distance) : json(nullptr)},
          {"distance_sigma", near ? json(sigmas.distance) : json(nullptr)}};
}

json LightJson(const ProbeLight& light, const std::vector<ProbeSession>& sessions) {
  json written = SigmasJson(light.sigma, light.near);
  written["stat"] = SigmasJson(light.stat, light.near);
  written["direction"] = ListOf(light.direction);
  written["inverse_distance"] = light.inverse_distance;
  written["distance"] = light.near ? json(1.0 / light.inverse_distance) : json(nullptr);
  written["distance_min"] = OrNull(light.distance_min);
  written["position"] = light.position ? ListOf(*light.position) : json(nullptr);
  written["position_covariance"] =
      light.position ? RowsOf(light.position_covariance) : json(nullptr);
  written["reference_point"] = ListOf(light.reference);
  written["direction_at_reference"] = ListOf(light.direction_at_reference);
  written["direction_at_reference_sigma_deg"] = SigmaDeg(light.reference_covariance);
  written["intensity"] = OrNull(light.intensity);
  written["intensity_sigma"] = OrNull(light.intensity_sigma);
  written["irradiance"] = light.irradiance;
  written["clipped"] = light.clipped;
  written["extent_deg"] = light.extent_deg;
  written["scatter"] = light.scatter > 0.0 ? json(light.scatter) : json(nullptr);
  written["budget"] = json::array();
  for (const BudgetItem& item : light.budget)
    written["budget"].push_back({{"item", item.item},
                                 {"direction_sigma_deg", RadToDeg(item.direction_sigma)},
                                 {"inverse_distance_sigma",
                                  light.near ? json(item.inverse_distance_sigma) : json(nullptr)}});
  written["spots"] = json::array();
  for (const SpotIndex& index : light.spots)
    written["spots"].push_back(SpotJson(sessions, index, &light));
  return written;
}

json BallJson(const ProbeSession& session, double radius_sigma) {
  json ball = {{"session", session.session->name},
               {"frames", session.views.size()},
               {"radius", std::get<SphereShape>(session.session->target).radius},
               {"radius_sigma", radius_sigma},
               {"center_T", nullptr},
               {"center_T_sigma", nullptr}};
  if (session.center_T) {
    ball["center_T"] = ListOf(*session.center_T);
    ball["center_T_sigma"] = ListOf(*session.center_sigma_T);
  }
  return ball;
}

}  // namespace

FrameOfView FindFrame(const std::vector<ProbeSession>& sessions, std::size_t view) {
  std::size_t session = 0;
  while (view >= sessions[session].views.size()) view -= sessions[session++].views.size();
  return {session, view};
}

std::string LightsJson(const ProbeLights& found, const std::vector<ProbeSession>& sessions,
                       double radius_sigma) {
  json written = {{"format", kLightsFormat},
                  {"version", 1},
                  {"length_unit", sessions.front().session->length_unit},
                  {"balls", json::array()},
                  {"lights", json::array()},
                  {"candidates", json::array()},
                  {"notes", json::array()}};
  for (const ProbeSession& session : sessions) {
    written["balls"].push_back(BallJson(session, radius_sigma));
    for (const std::string& note : session.notes)
      written["notes"].push_back(session.session->name + ": " + note);
  }
  for (const ProbeLight& light : found.lights)
    written["lights"].push_back(LightJson(light, sessions));
  for (const ProbeCandidate& candidate : found.candidates) {
    json spots = json::array();
    for (const SpotIndex& index : candidate.spots)
      spots.push_back(SpotJson(sessions, index, nullptr));
    written["candidates"].push_back({{"direction", ListOf(candidate.direction)},
                                     {"why", candidate.why},
                                     {"spots", std::move(spots)}});
  }
  return written.dump(1) + "\n";
}

std::string LightText(const ProbeLight& light, std::size_t number, const std::string& length_unit) {
  const Vector3d& u = light.direction;
  double azimuth = RadToDeg(std::atan2(u.y(), u.x()));
  if (azimuth < 0.0) azimuth += 360.0;
  std::string text =
      Format("%zu: azimuth %.2f deg, zenith %.2f deg, sigma %.2g deg", number, azimuth,
             RadToDeg(std::acos(std::clamp(u.z(), -1.0, 1.0))), RadToDeg(light.sigma.direction));
  const std::string unit = " " + length_unit;
  if (light.near)
    text += Format(", %.5g +- %.2g", 1.0 / light.inverse_distance, light.sigma.distance) + unit +
            " away";
  else if (light.distance_min)
    text += Format(", beyond %.3g", *light.distance_min) + unit + " (95 %)";
  else
    text += ", distance not known";
  if (light.intensity) text += Format(", intensity %.3g", *light.intensity);
  text += Format(", %.2g deg across", light.extent_deg);
  if (light.clipped) text += ", clipped";
  const std::size_t views = light.spots.size();
  return text + Format(", in %zu view%s", views, views == 1 ? "" : "s");
}

std::string CandidateText(const ProbeCandidate& candidate) {
  const Vector3d& u = candidate.direction;
  double azimuth = RadToDeg(std::atan2(u.y(), u.x()));
  if (azimuth < 0.0) azimuth += 360.0;
  const std::size_t views = candidate.spots.size();
  return Format("azimuth %.1f deg, zenith %.1f deg, in %zu view%s: ", azimuth,
                RadToDeg(std::acos(std::clamp(u.z(), -1.0, 1.0))), views, views == 1 ? "" : "s") +
         candidate.why;
}

}  // namespace turnlight::calib::calibrate::probe
