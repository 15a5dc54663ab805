// The config of a run: what is captured, with which devices, and the graph that does it.
//
//   name: simulated_turntable        # of the session; optional: the file's, without its ending
//   capture: {...}                   # rig/capture/capture_plan.h
//   rig:                             # what a real rig has as well
//     table: {driver: mock, ...}     # app/drivers.h; the other keys are the driver's
//     camera: {driver: mock, ...}
//     calibration: FILE or {...}     # rig/rig_calibration.h; of a simulated rig optional: else it
//                                    # is what is true of the simulation
//     target: {...}                  # as in session.json; of a simulated rig optional: else the
//                                    # simulation's
//     length_unit: mm                # of the session; optional: the calibration's, or mm
// A graph with the node handheld_keyframes is of a camera that is carried by hand: rig has no table
// then, and instead of a calibration
//     lens: FILE                     # as app/calibrate/camera_option.h
//     radiometry: {...}              # of raw DN, as in session.json
// which of a simulated rig are optional, too.
//   simulation: {...}                # rig/sim/simulation.h: the world of mock devices, and theirs
//                                    # only
//   graph: {...}                     # nodes/graph/config.h
// Files that are named are relative to the config's folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "base/result.h"
#include "base/strict_object.h"
#include "nodes/graph/config.h"
#include "rig/capture/capture_plan.h"
#include "rig/rig_calibration.h"
#include "rig/rig_setup.h"
#include "rig/sim/simulation.h"

namespace turnlight::app {

struct RunConfig {
  // Its sections point into graph.document.
  RunConfig(StrictObject rig_section, nodes::graph::GraphConfig graph_config)
      : rig(rig_section), camera(rig_section), graph(std::move(graph_config)) {}

  std::string file;
  std::string text;              // as read
  std::string calibration_text;  // of the file, if the calibration is one; or of the lens
  std::string name;
  rig::CapturePlan plan;
  StrictObject rig;                   // the section, for messages
  std::optional<StrictObject> table;  // with the key driver; none: the camera is carried by hand
  StrictObject camera;                // with the key driver
  std::optional<rig::RigCalibration> calibration;
  std::optional<calib::CameraModel> lens;  // these two of a camera that is carried by hand
  std::optional<calib::Radiometry> radiometry;
  std::optional<rig::RigTarget> target;
  std::string length_unit = "mm";
  std::optional<rig::sim::SimulationConfig> simulation;
  std::string simulation_where;  // "FILE:LINE: simulation"
  nodes::graph::GraphConfig graph;
};

// Fails (kInput) with file, line, key and what is allowed; also of a graph that would take no
// frames, or keep none.
Result<RunConfig> ReadRunConfig(const std::filesystem::path& path);
// Of a copy in a run's folder: origin is the file that it is a copy of, for its name and for the
// files that it names.
Result<RunConfig> ReadRunConfig(const std::filesystem::path& path,
                                const std::filesystem::path& origin);
// file names the text in messages.
Result<RunConfig> ParseRunConfig(const std::string& text, const std::string& file,
                                 const std::filesystem::path& origin);

// The commanded angles of a plan, as the script of faults counts them. By hand there is one, 0,
// that holds all the time.
rig::sim::KeyframeAngles AnglesOf(const rig::CapturePlan& plan);

// Whether the file is one for a run, or one for a generated session, which has none of these keys.
// Fails (kInput) if it cannot be read.
Result<bool> IsRunConfig(const std::filesystem::path& path);

// Takes the nodes of a type out, with their connections and records. Whether there were any.
bool RemoveNodes(nodes::graph::GraphConfig& graph, const std::string& type);

}  // namespace turnlight::app
