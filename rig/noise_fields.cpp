#include "rig/noise_fields.h"

#include "rig/covariance_fields.h"

namespace turnlight::rig {

Status ReadSensorNoise(StrictObject object, RigCalibration& calibration) {
  SensorNoise& noise = calibration.noise;
  noise.read_noise_dn = object.Number("read_noise_dn", {.min = 0.0});
  noise.dn_per_electron = object.Number("dn_per_electron", {.min = 0.0});
  noise.black_limit_dn = object.OptionalNumber("black_limit_dn");
  const auto gain_db = object.OptionalNumber("gain_db");
  calibration.covariances.noise = ReadCovariance(object, 2);
  if (noise.read_noise_dn > 0.0 || noise.dn_per_electron > 0.0)
    calibration.radiometry.noise =
        calib::NoiseModel{noise.read_noise_dn, noise.dn_per_electron, gain_db};
  return object.Finish();
}

std::optional<nlohmann::ordered_json> PrintSensorNoise(const RigCalibration& calibration) {
  const SensorNoise& noise = calibration.noise;
  const std::optional<calib::NoiseModel>& known = calibration.radiometry.noise;
  const SensorNoise assumed;
  if (!known && !noise.black_limit_dn && noise.read_noise_dn == assumed.read_noise_dn &&
      noise.dn_per_electron == assumed.dn_per_electron)
    return std::nullopt;
  nlohmann::ordered_json object{{"read_noise_dn", noise.read_noise_dn},
                                {"dn_per_electron", noise.dn_per_electron}};
  if (known && known->gain_db) object["gain_db"] = *known->gain_db;
  if (noise.black_limit_dn) object["black_limit_dn"] = *noise.black_limit_dn;
  AddCovariance(object, calibration.covariances.noise);
  return object;
}

}  // namespace turnlight::rig
