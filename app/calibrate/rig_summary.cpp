#include "app/calibrate/rig_summary.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/angles.h"
#include "base/document.h"
#include "base/file.h"
#include "base/format.h"
#include "rig/sim/mock_drivers.h"

namespace turnlight::app {
namespace {

using nlohmann::ordered_json;

constexpr std::uint64_t kMaxResultBytes = std::uint64_t{64} << 20;

double AngleDegBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

Eigen::Vector3d RotationVectorDeg(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return RadToDeg(turn.angle()) * turn.axis();
}

ordered_json ListOf(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// W' in W: z along the axis, its origin at A's, x in the half-plane of the camera.
calib::Pose ChosenFrame(const calib::TurntableGeometry& geometry) {
  calib::Pose X_WV;
  const Eigen::Vector3d z = geometry.X_WA.rotation.col(2);
  X_WV.translation = geometry.X_WA.translation;
  const Eigen::Vector3d to_camera = geometry.X_WC.translation - X_WV.translation;
  X_WV.rotation.col(2) = z;
  X_WV.rotation.col(1) = z.cross(to_camera).normalized();
  X_WV.rotation.col(0) = X_WV.rotation.col(1).cross(z);
  return X_WV;
}

estimator::model::Light Seen(const estimator::model::Light& light, const calib::Pose& X_WV) {
  estimator::model::Light seen = estimator::model::Recentred(light, X_WV.translation);
  seen.direction = X_WV.rotation.transpose() * seen.direction;
  return seen;
}

ordered_json AxisSummary(const AxisFound& found, const std::optional<TrueRig>& truth) {
  const auto& axis = found.axis;
  ordered_json json{{"direction_sigma_deg", axis.direction_sigma_deg},
                    {"offset_sigma", axis.offset_sigma},
                    {"angle_scale", axis.angle_scale},
                    {"angle_scale_sigma", axis.scale_sigma},
                    {"corner_sigma_px", axis.corner_sigma_px},
                    {"angle_sigma_deg", axis.angle_sigma_deg},
                    {"views_used", axis.used}};
  if (!truth) return json;
  const calib::Pose X_CW = truth->calibration.geometry.X_WC.Inverse();
  const Eigen::Vector3d direction = X_CW.rotation.col(2);
  const Eigen::Vector3d apart = axis.origin_C - X_CW.translation;
  json["error"] = {{"direction_deg", AngleDegBetween(axis.direction_C, direction)},
                   {"offset", (apart - direction * direction.dot(apart)).norm()},
                   {"height", direction.dot(apart)},
                   {"angle_scale", axis.angle_scale - truth->calibration.geometry.angle_scale}};
  return json;
}

ordered_json TargetSummary(const TargetFound& found, const std::optional<TrueRig>& truth) {
  const auto& placed = found.placement;
  const Eigen::Matrix<double, 6, 1> sigma = placed.covariance.diagonal().cwiseSqrt();
  ordered_json json{{"position", ListOf(placed.X_AT.translation)},
                    {"position_sigma", ListOf(sigma.tail<3>())},
                    {"rotation_sigma_deg", ListOf(sigma.head<3>() * (180.0 / M_PI))},
                    {"rms_px", placed.rms}};
  if (!truth) return json;
  const calib::Pose& X_AT = truth->calibration.geometry.X_AT;
  const Eigen::Matrix3d turned = placed.X_AT.rotation * X_AT.rotation.transpose();
  json["error"] = {{"position", ListOf(placed.X_AT.translation - X_AT.translation)},
                   {"rotation_deg", ListOf(RotationVectorDeg(turned))}};
  return json;
}

std::string ListText(const ordered_json& list, const char* format) {
  std::string text;
  for (const auto& value : list)
    text += (text.empty() ? "" : ", ") + Format(format, value.get<double>());
  return text;
}

std::string LightText(const ordered_json& light, std::size_t number) {
  const auto& sigma = light["direction_sigma_deg"];
  std::string text = Format("light %zu     direction ", number) +
                     ListText(light["direction"], "%.4f") +
                     (sigma.is_number() ? Format(", sigma %.3f deg", sigma.get<double>()) : "");
  if (light.contains("error_deg"))
    text += Format(", off by %.3f deg", light["error_deg"].get<double>());
  text += "\n";
  for (const auto& item : light["budget"])
    text += Format("             %.4f deg of ", item["sigma"].get<double>()) +
            item["item"].get<std::string>() + ": " + item["words"].get<std::string>() + "\n";
  return text;
}

}  // namespace

Result<TrueRig> TruthOf(const SimulatorConfig& simulator) {
  auto calibration = CalibrationOf(simulator);
  if (!calibration) return Forward(calibration);
  const auto world = rig::sim::BuildWorld(simulator.simulation);
  if (!world) return Forward(world);
  calib::TurntableGeometry& geometry = calibration->geometry;
  const calib::Pose X_WV = ChosenFrame(geometry), X_VW = X_WV.Inverse();
  TrueRig truth{*calibration, world->studio->scene};
  for (auto& light : truth.scene.lights) light = Seen(light, X_WV);
  calib::TurntableGeometry& chosen = truth.calibration.geometry;
  const calib::Pose zero =
      calib::Turn(Eigen::Vector3d::UnitZ(), DegToRad(geometry.angle_offset_deg));
  chosen.X_WC = X_VW * geometry.X_WC;
  chosen.X_AT = X_VW * geometry.X_WA * zero * geometry.X_AT;
  chosen.X_WA = {};
  chosen.angle_offset_deg = 0.0;
  return truth;
}

ordered_json SummaryOf(const RigFindings& found, const std::optional<TrueRig>& truth) {
  ordered_json summary;
  if (found.response) summary["response"] = {{"words", found.response->words}};
  const auto& lens = found.lens.calibration;
  summary["lens"] = {{"lens_model", lens.camera().lens_model()},
                     {"rms_px", lens.rms_px},
                     {"noise_px", lens.noise_px},
                     {"views_used", lens.views.size()},
                     {"verdict", found.lens.verdict}};
  summary["axis"] = AxisSummary(found.axis, truth);
  summary["target"] = TargetSummary(found.target, truth);
  return summary;
}

Status AddLights(const std::filesystem::path& result, const std::optional<TrueRig>& truth,
                 ordered_json& summary) {
  const auto text = ReadFile(result, kMaxResultBytes);
  if (!text) return Forward(text);
  const auto document = ParseJson(*text, result.string());
  if (!document) return Forward(document);
  summary["lights"] = ordered_json::array();
  for (const auto& light : document->root.value("lights", nlohmann::json::array())) {
    ordered_json entry{{"direction", light["direction"]},
                       {"direction_sigma_deg", light["direction_sigma_deg"]}};
    entry["budget"] = ordered_json::array();
    if (light.contains("budget") && light["budget"].contains("direction_sigma_deg"))
      for (const auto& item : light["budget"]["direction_sigma_deg"])
        entry["budget"].push_back(
            {{"item", item["item"]}, {"sigma", item["sigma"]}, {"words", item["words"]}});
    if (truth) {
      const auto& d = light["direction"];
      const Eigen::Vector3d direction(d[0].get<double>(), d[1].get<double>(), d[2].get<double>());
      double error = std::numeric_limits<double>::infinity();
      for (const auto& real : truth->scene.lights)
        error = std::min(error, AngleDegBetween(direction, real.direction));
      entry["error_deg"] = error;
    }
    summary["lights"].push_back(entry);
  }
  return {};
}

std::string SummaryText(const ordered_json& summary) {
  std::string text;
  if (summary.contains("response"))
    for (const auto& words : summary["response"]["words"])
      text += "response     " + words.get<std::string>() + "\n";
  const auto& lens = summary["lens"];
  text += Format("lens         %s of %zu views, %.3f px rms; ",
                 lens["lens_model"].get<std::string>().c_str(),
                 lens["views_used"].get<std::size_t>(), lens["rms_px"].get<double>()) +
          lens["verdict"].get<std::string>() + "\n";
  const auto& axis = summary["axis"];
  text += Format("axis         sigma %.4f deg and %.4f; %.6f deg/deg, sigma %.6f\n",
                 axis["direction_sigma_deg"].get<double>(), axis["offset_sigma"].get<double>(),
                 axis["angle_scale"].get<double>(), axis["angle_scale_sigma"].get<double>());
  if (axis.contains("error"))
    text +=
        Format("             off by %.4f deg and %.4f, scale by %.6f\n",
               axis["error"]["direction_deg"].get<double>(), axis["error"]["offset"].get<double>(),
               axis["error"]["angle_scale"].get<double>());
  const auto& target = summary["target"];
  text += "target       at " + ListText(target["position"], "%.3f") + ", sigma " +
          ListText(target["position_sigma"], "%.3f") + "; turned, sigma " +
          ListText(target["rotation_sigma_deg"], "%.3f") + " deg\n";
  if (target.contains("error"))
    text += "             off by " + ListText(target["error"]["position"], "%.3f") + " and " +
            ListText(target["error"]["rotation_deg"], "%.3f") + " deg\n";
  std::size_t number = 0;
  for (const auto& light : summary.value("lights", ordered_json::array()))
    text += LightText(light, ++number);
  return text;
}

}  // namespace turnlight::app
