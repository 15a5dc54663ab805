#include "rig/capture/provenance.h"

#include <nlohmann/json.hpp>

#include "base/sha256.h"

namespace turnlight::rig {
namespace {

using nlohmann::ordered_json;

std::string Line(const ordered_json& object) {
  return object.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

template <typename T>
ordered_json ToObject(const std::vector<std::pair<std::string, T>>& pairs) {
  ordered_json object = ordered_json::object();
  for (const auto& [key, value] : pairs) object[key] = value;
  return object;
}

double Seconds(DeviceTime time) { return std::chrono::duration<double>(time).count(); }

}  // namespace

std::string PrintRunLine(const RunProvenance& run, const JournalHeader& header, std::size_t kept,
                         const std::vector<std::string>& dropped) {
  ordered_json object{{"kind", "run"},
                      {"utc", run.utc},
                      {"program_version", run.program_version},
                      {"program_commit", run.program_commit},
                      {"frames_kept", kept},
                      {"frames_dropped", dropped},
                      {"camera_device", header.camera_identity},
                      {"camera_settings",
                       {{"exposure_us", run.camera_settings.exposure_us},
                        {"gain_db", run.camera_settings.gain_db}}},
                      {"table_device", header.table_identity},
                      {"settings", ToObject(run.notes)},
                      {"camera_model_sha256", header.camera_sha256}};
  if (header.mesh_sha256) object["mesh_sha256"] = *header.mesh_sha256;
  object["config_sha256"] = Sha256Hex(header.config_text);
  object["config"] = header.config_text;
  return Line(object);
}

std::string PrintKeyframeLine(const KeyframeProvenance& provenance, const JournalEntry& entry) {
  ordered_json counters = ordered_json::array();
  for (const auto& of_exposure : provenance.counters) counters.push_back(ToObject(of_exposure));
  ordered_json object{{"kind", "keyframe"},
                      {"index", entry.index},
                      {"angle_deg", entry.frame.angle_deg.value_or(0.0)},
                      {"angle_measured_deg", entry.frame.angle_measured_deg.value_or(0.0)},
                      {"utc", provenance.utc},
                      {"exposure_begin_s", Seconds(provenance.exposure_begin)},
                      {"exposure_end_s", Seconds(provenance.exposure_end)},
                      {"attempts", provenance.attempts},
                      {"rejected", provenance.rejected},
                      {"counters", counters}};
  for (const DeviceReading& reading : provenance.readings)
    object["readings"][reading.name] = reading.value;
  object["sha256"] = entry.frame.sha256.value_or("");
  return Line(object);
}

}  // namespace turnlight::rig
