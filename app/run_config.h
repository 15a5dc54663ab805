// The config of a run: what is captured, with which devices, and the graph that does it.
//
//   name: simulated_turntable        # of the session; optional
//   capture: {...}                   # rig/capture/capture_plan.h
//   rig:
//     driver: mock                   # simulated devices, the only driver so far
//     table: {...}                   # rig/sim/mock_turntable.h
//     camera: {...}                  # rig/sim/mock_camera.h
//     faults: {...}                  # rig/sim/fault_script.h; optional: what goes wrong
//   graph: {...}                     # nodes/graph/config.h
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "nodes/graph/config.h"
#include "nodes/graph/graph.h"
#include "rig/capture/capture_plan.h"
#include "rig/capture/exposure_merge.h"
#include "rig/capture/session_recorder.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/mock_turntable.h"

namespace turnlight::app {

struct RunConfig {
  std::string file, text;  // as read
  std::string name;
  rig::CapturePlan plan;
  rig::MockTurntableConfig table;
  rig::MockCameraConfig camera;
  std::vector<rig::FaultEntry> faults;
  graph::GraphConfig graph;
};

// Fails (kInput) with file, line, key and what is allowed.
Result<RunConfig> ReadRunConfig(const std::filesystem::path& path);
Result<RunConfig> ParseRunConfig(const std::string& text, const std::string& file);

// Whether the file is one for a run, or one for a generated session, which has none of these keys.
// Fails (kInput) if it cannot be read.
Result<bool> IsRunConfig(const std::filesystem::path& path);

// The devices of a config, and what the session says of them.
struct Rig {
  std::shared_ptr<rig::MockTurntable> table;
  std::shared_ptr<rig::MockCamera> camera;
  std::shared_ptr<rig::FaultScript> faults;
  rig::PictureFormat format;
  rig::SensorNoise noise;
};
Result<Rig> MakeRig(const RunConfig& config);

struct RigIdentity {
  rig::DeviceIdentity camera, table;
};
// Opens the devices; a graph takes them open. Fails (kDevice) with the device's name.
Result<RigIdentity> OpenRig(const Rig& rig);

// What the recorder needs to know.
rig::CaptureSetup MakeCaptureSetup(const RunConfig& config, const Rig& rig,
                                   const RigIdentity& identity);

// What a graph is for; by default for being checked and drawn.
struct GraphUse {
  std::vector<rig::PlannedFrame> frames;  // still to be taken
  std::shared_ptr<rig::SessionRecorder> recorder;
  std::function<void(const std::string&)> log_line = [](const std::string&) {};
};
// Built and given its params; nothing runs. Fails (kInput) with file, line, key and what is
// allowed; also of a graph that would take no frames, or keep none.
Result<graph::Graph> BuildGraph(const RunConfig& config, const Rig& rig, GraphUse use);

// Takes the nodes of a type out, with their connections and records.
void RemoveNodes(graph::GraphConfig& graph, const std::string& type);

}  // namespace turnlight::app
