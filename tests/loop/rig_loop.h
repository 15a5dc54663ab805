// A capture wholly in the loop: the real nodes, a real serial driver and the real camera driver,
// against a simulated controller on a port and a simulated GigE Vision camera on an address of its
// own, both in one simulated world. In real time, with small pictures.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "nodes/graph/graph.h"
#include "nodes/messages.h"
#include "rig/capture/capture_plan.h"
#include "rig/sim/fault_script.h"
#include "rig/sim/gige/gige_camera.h"
#include "rig/sim/mock_drivers.h"
#include "rig/sim/stage/stage_simulator.h"
#include "tests/nodes/static_render.h"

namespace turnlight::loop {

struct RigLoopOptions {
  std::string firmware;                 // grbl, zaber, smc100
  std::string pixel_format = "Mono16";  // one that the simulated camera has
  double packet_loss = 0.0;
  int packet_size = 9000;  // bytes
  std::vector<rig::sim::FaultEntry> faults;
  rig::CapturePlan plan;  // 4 keyframes of 30 degrees unless changed
  std::string keyframes_params = "{retry_wait_ms: 200, lost_timeout_s: 10}";
  std::string turntable_params = "{poll_ms: 10, home_timeout_s: 5}";
  // As of KeyframesJob: for the tests that show what the checks are good for.
  bool check_arrival = true;
  bool settle = true;
  // Of each bracket, on the graph's thread; given, they are not kept.
  std::function<void(const nodes::Bracket&)> on_bracket = nullptr;
};
RigLoopOptions SmallRigLoop(const std::string& firmware);

// A link in a folder, and an address 127.x.y.z that no other test has.
struct RigPlace {
  std::string link, address;
};
RigPlace OwnPlace(const std::string& folder);

// The devices, for as long as it lives. Throws what does not start: a test's set-up is wrong then.
class SimulatedRig {
 public:
  SimulatedRig(const RigLoopOptions& options, const RigPlace& place);

  rig::sim::FaultScript& faults() { return *world_.faults; }
  bool IsMoving() const;
  double SecondsSinceFirstFault() const;

 private:
  rig::sim::SimulatedWorld world_;
  rig::sim::stage::SimulatorEpoch epoch_ = std::chrono::steady_clock::now();
  std::unique_ptr<rig::sim::stage::StageSimulator> stage_;
  std::unique_ptr<rig::sim::gige::GigeCamera> camera_;
};

struct RigLoopRun {
  std::vector<nodes::Bracket> brackets;
  std::vector<std::string> lines;  // faults and notes, as a log shows them
  nodes::graph::RunReport report;
  std::string opened;  // the port, by which library
  // Of RunRigLoop only.
  int faults_left = 0;              // that never struck
  double seconds_from_fault = 0.0;  // from the first that struck to the end, drivers let go
  bool moving = false;              // the motor, then
  // The largest deviation of a picture from the static render at its angle, in sigmas of its noise.
  double worst_sigmas = 0.0;

  std::size_t Rejected() const;
  bool Mentions(const std::string& text) const;
};
// Throws what does not open.
RigLoopRun RunCapture(const RigLoopOptions& options, const RigPlace& place);
RigLoopRun RunRigLoop(const RigLoopOptions& options);
// Waiting is most of what a capture in real time does, so they run side by side.
std::vector<RigLoopRun> RunAll(const std::vector<RigLoopOptions>& all);

nodes::StaticScene SceneOf(const RigLoopOptions& options);

// At most times times, while that angle is commanded.
rig::sim::FaultEntry Fault(rig::sim::FaultKind kind, std::optional<double> angle_deg,
                           int times = 1);
rig::sim::FaultEntry CameraFault(rig::sim::FaultKind kind, std::optional<double> angle_deg,
                                 int times = 1);

}  // namespace turnlight::loop
