// Proves, at length: twenty revolutions in real time, each a capture of its own with a seeded fault
// of table or camera at about every eighth keyframe, give every frame, each of them the static
// render at its angle to within 5 sigma; memory, descriptors and threads do not grow. Labelled
// soak: eight minutes of `ctest --preset release -L soak`. Does not prove: anything of real
// devices; memory is that of drivers and simulated devices together, as they share the process.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "base/document.h"
#include "base/format.h"
#include "base/strict_object.h"
#include "tests/loop/rig_loop.h"
#include "tests/temporary_folder.h"

namespace turnlight::loop {
namespace {

constexpr int kRevolutions = 20, kPerRevolution = 36;
constexpr double kSigmas = 5.0;

// What a capture gets over by itself, drawn keyframe by keyframe.
constexpr char kFaults[] = R"(random:
  seed: %d
  share: 0.12
  faults: [lost_steps, stall, late_arrival, wrong_position, alarm, reset, limit, displaced, silent,
    unplugged, serial_garbage, split_line, nul_bytes, long_line, dropped_reply, duplicate_reply,
    late_reply, lost_status, altered_status, stale_frame, duplicate_frame, dropped_frame,
    incomplete_frame, blurred, trigger_ignored, untriggered_frame, exposure_drift, gain_drift,
    lamp_off, saturated, all_black, control_lost]
)";

std::vector<rig::sim::FaultEntry> DrawFaults(int seed) {
  const auto document = ParseYaml(Format(kFaults, seed), "soak");
  if (!document) throw std::runtime_error(document.error().text);
  auto faults = rig::sim::ReadFaultScript(StrictObject(*document), {0.0, 10.0, kPerRevolution},
                                          rig::sim::FaultWorld::kRealProtocols);
  if (!faults) throw std::runtime_error(faults.error().text);
  return std::move(*faults);
}

// Of this process, now.
struct Resources {
  double memory_mb = 0.0;  // resident
  std::size_t descriptors = 0, threads = 0;
};

std::size_t EntriesOf(const char* folder) {
  const std::filesystem::directory_iterator entries(folder);
  return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
}

Resources Measure() {
  std::size_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return {static_cast<double>(resident * static_cast<std::size_t>(::getpagesize())) / 1048576.0,
          EntriesOf("/proc/self/fd"), EntriesOf("/proc/self/task")};
}

struct Revolution {
  int frames = 0, rejected = 0, struck = 0, not_struck = 0;
  double worst_sigmas = 0.0, seconds = 0.0;
  std::string failure;
  Resources after;  // everything closed
};

// Frames are looked at as they come, and not kept.
Revolution Turn(RigLoopOptions options, const nodes::StaticScene& scene) {
  Revolution now;
  options.on_bracket = [&](const nodes::Bracket& bracket) {
    ++now.frames;
    now.rejected += static_cast<int>(bracket.rejected.size());
    now.worst_sigmas = std::max(now.worst_sigmas, scene.WorstSigmas(bracket));
  };
  const auto begun = std::chrono::steady_clock::now();
  {
    const TemporaryFolder folder;
    const RigPlace place = OwnPlace(folder.path());
    SimulatedRig simulated(options, place);
    const RigLoopRun run = RunCapture(options, place);
    if (run.report.failure) now.failure = run.report.failure->text;
    now.not_struck = simulated.faults().Remaining();
    now.struck = static_cast<int>(options.faults.size()) - now.not_struck;
  }
  now.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  now.after = Measure();
  return now;
}

// From the fourth revolution on, when everything has been used once.
void ExpectFlat(const std::vector<Revolution>& revolutions) {
  Resources first{}, last{};
  const auto raise = [](Resources& most, const Resources& at) {
    most = {std::max(most.memory_mb, at.memory_mb), std::max(most.descriptors, at.descriptors),
            std::max(most.threads, at.threads)};
  };
  for (std::size_t i = 3; i < 8; ++i) raise(first, revolutions[i].after);
  for (std::size_t i = revolutions.size() - 5; i < revolutions.size(); ++i)
    raise(last, revolutions[i].after);
  EXPECT_LT(last.memory_mb, first.memory_mb + 8.0);
  // A camera that was lost is let go in its own time.
  EXPECT_LE(last.descriptors, first.descriptors + 4);
  EXPECT_LE(last.threads, first.threads + 4);
}

TEST(Soak, TwentyRevolutionsWithFaults) {
  RigLoopOptions options = SmallRigLoop("zaber");
  options.plan.count = kPerRevolution;
  options.plan.step_deg = 10.0;
  options.plan.move_timeout_s = 15.0;  // from home to anywhere
  options.packet_loss = 0.001;
  const nodes::StaticScene scene = SceneOf(options);
  std::cout << "| revolution | s | frames | faults struck | not struck | taken again | worst "
               "sigmas | memory, MB "
               "| descriptors | threads |\n|---|---|---|---|---|---|---|---|---|---|\n";
  std::vector<Revolution> revolutions;
  int struck = 0, not_struck = 0;
  for (int i = 1; i <= kRevolutions; ++i) {
    options.faults = DrawFaults(i);
    const Revolution now = Turn(options, scene);
    std::cout << Format("| %d | %.0f | %d | %d | %d | %d | %.2f | %.1f | %zu | %zu |", i,
                        now.seconds, now.frames, now.struck, now.not_struck, now.rejected,
                        now.worst_sigmas, now.after.memory_mb, now.after.descriptors,
                        now.after.threads)
              << std::endl;
    EXPECT_EQ(now.failure, "");
    EXPECT_EQ(now.frames, kPerRevolution);
    EXPECT_LT(now.worst_sigmas, kSigmas);
    struck += now.struck;
    not_struck += now.not_struck;
    revolutions.push_back(now);
  }
  EXPECT_GT(struck, 60);
  // What needs a message that is not sent at that angle finds no occasion.
  EXPECT_LE(not_struck, struck / 10);
  ExpectFlat(revolutions);
}

}  // namespace
}  // namespace turnlight::loop
