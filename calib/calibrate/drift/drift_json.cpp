#include "calib/calibrate/drift/drift_json.h"

#include <nlohmann/json.hpp>

#include "calib/calibrate/drift/drift_words.h"

namespace turnlight::calib::calibrate::drift {
namespace {

using nlohmann::ordered_json;

ordered_json JsonOf(const Finding& finding) {
  ordered_json causes = ordered_json::array(), quantities = ordered_json::array();
  for (const Cause cause : finding.causes) causes.push_back(CauseName(cause));
  for (const Quantity& quantity : finding.quantities)
    quantities.push_back({{"key", quantity.key},
                          {"unit", quantity.unit},
                          {"value", quantity.value},
                          {"sigma", quantity.sigma},
                          {"sigma_of_pictures", quantity.sigma_of_pictures}});
  return {{"causes", causes},
          {"chi_squared", finding.gain},
          {"freedom", finding.freedom},
          {"chance", finding.chance},
          {"left_chance", finding.left_chance},
          {"explains", finding.explains},
          {"quantities", quantities}};
}

ordered_json JsonOf(const std::vector<Finding>& findings) {
  ordered_json list = ordered_json::array();
  for (const Finding& finding : findings) list.push_back(JsonOf(finding));
  return list;
}

}  // namespace

std::string PrintDrift(const DriftReport& report) {
  ordered_json json{{"format", "turnlight-check"},
                    {"version", 1},
                    {"verdict", VerdictWord(report.verdict)},
                    {"words", DriftVerdict(report)},
                    {"to_do", Remedies(report)},
                    {"false_alarms", kFalseAlarms},
                    {"length_unit", report.length_unit}};
  const bool fitted = !report.alone.empty();
  json["stored"] = fitted ? ordered_json{{"rms_px", report.stored_rms}, {"worst_px", report.worst}}
                          : ordered_json();
  json["noise_px"] = fitted ? ordered_json(report.noise) : ordered_json();
  json["moved_rms_px"] = fitted ? ordered_json(report.moved_rms) : ordered_json();
  json["found"] = report.verdict == Verdict::kDrifted ? JsonOf(report.found) : ordered_json();
  json["as_well"] = JsonOf(report.as_well);
  json["alone"] = JsonOf(report.alone);
  json["everything"] = fitted ? JsonOf(report.everything) : ordered_json();
  json["views"] = report.views;
  json["left_out"] = report.left_out;
  json["points"] = report.points.size();
  json["outliers"] = report.outliers;
  json["remarks"] = report.remarks;
  return json.dump(1) + "\n";
}

}  // namespace turnlight::calib::calibrate::drift
