// The config of `turnlight calibrate rig`: that of a run (app/run_config.h) without a calibration,
// and beside its sections
//
//   calibrate:
//     board: {columns: 10, rows: 7, spacing: 15}    # rig/sim/prop.h, ReadBoard; length unit
//     lens_model: OPENCV8
//     lens_note: "16 mm, focused at 0.5 m, f/8"     # optional, for people
//     response: {exposures_us: [1000, 2000, 4000], pairs: 2, grey_card: false}   # optional: else
//                                                   # the pictures count as linear
//     intrinsics: {pictures: 25, exposure_us: 8000}
//     axis: {count: 12, step_deg: 30, board_height: 2, exposure_us: 8000}
//     target: {count: 12, step_deg: 30, exposure_us: 8000}
//   simulator:                                      # optional: the rig is simulated by this
//   program
//     config: sim_calibrate.yaml                    # app/simulator.h
//     noise_seed: 1                                 # optional
//     props: {flat: {...}, dark: {...}, grey: {...}, handheld: {...}, board: {...}, empty: {...}}
//                                                   # rig/sim/prop.h
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/device_config.h"
#include "app/simulator.h"
#include "base/result.h"
#include "calib/calibrate/board/board.h"
#include "calib/target_shape.h"
#include "rig/sim/prop.h"

namespace turnlight::app {

struct ResponseRecipe {
  std::vector<double> exposures_us;  // at least 3
  int pairs = 2;
  bool grey_card = false;
};
struct TurningRecipe {
  int count = 12;
  double step_deg = 30.0;
  double exposure_us = 8000.0;
};
struct RigRecipe {
  std::string text;              // of the file, as read
  std::string run_text;          // without the two sections
  std::filesystem::path folder;  // what the files that it names are relative to
  std::string length_unit = "mm";
  calib::calibrate::board::Board board;
  std::string lens_model = "LENSMODEL_OPENCV8";
  std::string lens_note;
  std::optional<ResponseRecipe> response;
  int pictures = 25;  // of the board held by hand
  double intrinsics_exposure_us = 8000.0;
  TurningRecipe axis, target;
  double board_height = 0.0;  // length unit; of the print above the table
  DeviceConfig devices;       // of run_text
  calib::TargetShape shape;   // rig/target
  std::optional<SimulatorConfig> simulator;
  std::map<std::string, rig::sim::Prop> props;
};

// Whether the file is one: it has a section calibrate. Fails (kInput) if it is no YAML.
Result<bool> IsRigRecipe(const std::filesystem::path& path);

// Fails (kInput) with file, line, key and what is allowed.
Result<RigRecipe> ReadRigRecipe(const std::filesystem::path& path);

// The text of a run's config for a calibration: run_text with `calibration` in its section rig, and
// the files that it names as absolute paths. Fails (kInput) if rig is not written as a block.
Result<std::string> RunTextWith(const RigRecipe& recipe, const std::filesystem::path& calibration);

}  // namespace turnlight::app
