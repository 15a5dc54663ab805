#include "app/doctor/device_checks.h"

#include <cmath>
#include <utility>

#include "app/rig_config.h"
#include "app/run_config.h"
#include "app/table_motion.h"
#include "base/format.h"
#include "rig/capture/capture_setup.h"

namespace turnlight::app {
namespace {

constexpr double kExposureTolerance = 1e-3;  // as of every picture of a capture
constexpr double kGainToleranceDb = 0.05;

std::string Joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "; ") + line;
  return text;
}

}  // namespace

Check CheckRunConfig(Patient& patient) {
  const std::string& file = patient.config.file;
  if (!patient.config.has_graph)
    return Skipped("no section graph: enough for devices by themselves, not for turnlight run");
  const auto config = ReadRunConfig(file);
  if (!config) return Failed(config.error().text, "put it right in " + file);
  const auto rig = MakeRig(*config, *patient.drivers);
  if (!rig) return Failed(rig.error().text, "put it right in " + file);
  const auto graph = BuildGraph(*config, *rig);
  if (!graph) return Failed(graph.error().text, "put it right in " + file);
  return Fine(file + ", good for turnlight run");
}

Check CheckController(Patient& patient) {
  if (!patient.devices.table || !patient.config.table) return Skipped(kNoTable);
  rig::Turntable& table = *patient.devices.table->turntable;
  const auto identity = table.Open(patient.clock.Now());
  const auto notes = table.TakeNotes();
  if (!identity)
    return Failed(identity.error().text,
                  "check its cable, power, port and driver; turnlight devices lists the ports");
  patient.table = *identity;
  // Settings that a controller is better without.
  const std::string who = rig::Describe(*identity);
  return notes.empty() ? Fine(who) : Warning(who, Joined(notes));
}

Check CheckPosition(Patient& patient) {
  if (!patient.table) return Skipped(patient.config.table ? kTableShut : kNoTable);
  TableMotion motion{patient.devices.table->turntable.get(), &patient.clock, patient.stop};
  motion.note = patient.say;
  const auto state =
      WaitUntilStill(motion, patient.clock.Now() + FromSeconds(patient.config.plan.move_timeout_s));
  if (!state) return Failed(state.error().text, "check the table, then give the command again");
  const std::string home = "turnlight home " + patient.config.file;
  if (state->motion == rig::TableMotion::kUnhomed)
    return Warning("not known: " + state->fault, home + "; a capture does it by itself");
  if (state->motion == rig::TableMotion::kFault) return Failed(state->fault, home);
  return Fine(Format("stands at %.3f degrees", state->angle_deg));
}

Check CheckCamera(Patient& patient) {
  if (!patient.devices.camera) return Skipped(kNoCamera);
  rig::Camera& camera = *patient.devices.camera->camera;
  const auto identity = camera.Open(patient.clock.Now());
  const auto notes = camera.TakeNotes();
  if (!identity)
    return Failed(identity.error().text,
                  "check its cable, power and id; turnlight devices lists the cameras");
  patient.camera = *identity;
  // What an optional feature's absence means is in the note; a missing one that matters is refused.
  return Fine(rig::Describe(*identity) + (notes.empty() ? "" : "; " + Joined(notes)));
}

Check CheckExposure(Patient& patient) {
  if (!patient.camera) return Skipped(patient.devices.camera ? kCameraShut : kNoCamera);
  std::string figure;
  bool same = true;
  for (const double exposure_us : patient.config.plan.exposures_us) {
    const rig::CameraSettings asked{exposure_us, patient.config.plan.gain_db};
    const auto set = patient.devices.camera->camera->Set(asked, patient.clock.Now());
    if (!set) return Failed(set.error().text, "change capture/exposures_us or capture/gain_db");
    figure += (figure.empty() ? "" : ", ") +
              Format("%.6g us and %.4g dB asked, %.6g us and %.4g dB read back", asked.exposure_us,
                     asked.gain_db, set->exposure_us, set->gain_db);
    same = same && std::abs(set->exposure_us - exposure_us) <= kExposureTolerance * exposure_us &&
           std::abs(set->gain_db - asked.gain_db) <= kGainToleranceDb;
  }
  return same ? Fine(figure)
              : Failed(figure,
                       "put what was read back into capture/exposures_us and gain_db: a "
                       "capture refuses pictures that were exposed otherwise");
}

Check CheckCalibrationPictures(Patient& patient) {
  if (!patient.devices.camera) return Skipped(kNoCamera);
  const auto calibration = ReadCalibrationOf(patient.config);
  if (!calibration) return Failed(calibration.error().text, "calibrate the rig anew");
  if (!*calibration) return Skipped("the config has no rig/calibration");
  const Status status = rig::CheckPictures(**calibration, *patient.devices.camera);
  return status ? Fine((*calibration)->source + " is of pictures like these")
                : Failed(status.error().text, "calibrate the rig as it is now");
}

Check CheckCalibrationDevices(Patient& patient) {
  const auto calibration = ReadCalibrationOf(patient.config);
  if (!calibration || !*calibration) return Skipped("there is no calibration to compare with");
  if (!patient.camera || !patient.table) return Skipped("a device could not be opened");
  const Status status = rig::CheckIdentity(**calibration, *patient.camera, *patient.table);
  return status ? Fine((*calibration)->source + " is of these devices")
                : Failed(status.error().text, "calibrate the rig with these devices");
}

}  // namespace turnlight::app
