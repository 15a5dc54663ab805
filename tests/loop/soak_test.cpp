// Proves, at length: twenty revolutions in real time, with a seeded fault of table or camera at
// about every eighth keyframe, give every frame, each of them the static render at its angle to
// within 6 sigma; memory, descriptors and threads do not grow. Labelled soak: a quarter of an hour
// of `ctest --preset release -L soak`. Does not prove: anything of real devices; memory is that of
// drivers and simulated devices together, as they share the process.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
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
// Of two million values one is beyond 5 sigma by chance, and of 250 soaks one has one beyond 6.
constexpr double kSigmas = 6.0;

// What a capture gets over by itself, drawn keyframe by keyframe.
constexpr char kFaults[] = R"(random:
  seed: 12
  share: 0.12
  faults: [lost_steps, stall, late_arrival, wrong_position, alarm, reset, limit, displaced, silent,
    unplugged, serial_garbage, split_line, nul_bytes, long_line, dropped_reply, duplicate_reply,
    late_reply, lost_status, altered_status, stale_frame, duplicate_frame, dropped_frame,
    incomplete_frame, blurred, trigger_ignored, untriggered_frame, exposure_drift, gain_drift,
    lamp_off, saturated, all_black, control_lost]
)";

std::vector<rig::sim::FaultEntry> DrawFaults() {
  const auto document = ParseYaml(kFaults, "soak");
  if (!document) throw std::runtime_error(document.error().text);
  auto faults =
      rig::sim::ReadFaultScript(StrictObject(*document), {0.0, 10.0, kRevolutions * kPerRevolution},
                                rig::sim::FaultWorld::kRealProtocols);
  if (!faults) throw std::runtime_error(faults.error().text);
  return std::move(*faults);
}

// The simulated camera keeps its renders, of every angle one, up to 640 MB.
constexpr double kRenderMb = 64 * 48 * 3 * 4 / 1048576.0;

// Of this process, now.
struct Resources {
  double memory_mb = 0.0;  // resident, without the renders
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
  int frames = 0, rejected = 0;
  double worst_sigmas = 0.0, seconds = 0.0;
  Resources at_end;
};

// Frames are looked at as they come, and not kept.
class Diary {
 public:
  explicit Diary(const nodes::StaticScene& scene) : scene_(scene), begun_(Clock::now()) {
    std::cout << "| revolution | after s | frames | taken again | worst sigmas | memory, MB | "
                 "descriptors | threads |\n|---|---|---|---|---|---|---|---|\n";
  }
  void Note(const nodes::Bracket& bracket) {
    now_.worst_sigmas = std::max(now_.worst_sigmas, scene_.WorstSigmas(bracket));
    now_.rejected += static_cast<int>(bracket.rejected.size());
    if (++now_.frames < kPerRevolution) return;
    now_.at_end = Measure();
    now_.at_end.memory_mb -=
        kRenderMb * kPerRevolution * static_cast<double>(1 + revolutions_.size());
    now_.seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
    std::cout << Format("| %zu | %.0f | %d | %d | %.2f | %.1f | %zu | %zu |",
                        revolutions_.size() + 1, now_.seconds, now_.frames, now_.rejected,
                        now_.worst_sigmas, now_.at_end.memory_mb, now_.at_end.descriptors,
                        now_.at_end.threads)
              << std::endl;
    revolutions_.push_back(now_);
    now_ = {};
  }
  const std::vector<Revolution>& revolutions() const { return revolutions_; }

 private:
  using Clock = std::chrono::steady_clock;
  const nodes::StaticScene& scene_;
  const Clock::time_point begun_;
  Revolution now_;
  std::vector<Revolution> revolutions_;
};

// From the fourth revolution on, when everything has been used once.
void ExpectFlat(const std::vector<Revolution>& revolutions) {
  Resources first{}, last{};
  const auto raise = [](Resources& most, const Resources& at) {
    most = {std::max(most.memory_mb, at.memory_mb), std::max(most.descriptors, at.descriptors),
            std::max(most.threads, at.threads)};
  };
  for (std::size_t i = 3; i < 8; ++i) raise(first, revolutions[i].at_end);
  for (std::size_t i = revolutions.size() - 5; i < revolutions.size(); ++i)
    raise(last, revolutions[i].at_end);
  EXPECT_LT(last.memory_mb, first.memory_mb + 8.0);
  // A camera that was lost is let go in its own time.
  EXPECT_LE(last.descriptors, first.descriptors + 8);
  EXPECT_LE(last.threads, first.threads + 4);
}

TEST(Soak, TwentyRevolutionsWithFaults) {
  RigLoopOptions options = SmallRigLoop("zaber");
  options.plan.count = kRevolutions * kPerRevolution;
  options.plan.step_deg = 10.0;
  options.packet_loss = 0.001;
  options.faults = DrawFaults();
  const nodes::StaticScene scene = SceneOf(options);
  const TemporaryFolder folder;
  const RigPlace place = OwnPlace(folder.path());
  SimulatedRig simulated(options, place);
  Diary diary(scene);
  options.on_bracket = [&](const nodes::Bracket& bracket) { diary.Note(bracket); };
  const RigLoopRun run = RunCapture(options, place);
  std::map<std::string, int> counts;
  for (const rig::sim::FaultEntry& entry : options.faults)
    ++counts[rig::sim::FaultWord(entry.kind)];
  std::cout << "\n" << options.faults.size() << " faults:";
  for (const auto& [word, count] : counts) std::cout << " " << word << " " << count;
  std::cout << "; " << simulated.faults().Remaining() << " did not strike" << std::endl;
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  ASSERT_EQ(diary.revolutions().size(), static_cast<std::size_t>(kRevolutions));
  for (const Revolution& revolution : diary.revolutions())
    EXPECT_LT(revolution.worst_sigmas, kSigmas);
  // A fault of a homing or of a reply that is not sent may have found no occasion.
  EXPECT_LE(simulated.faults().Remaining(), static_cast<int>(options.faults.size()) / 10);
  ExpectFlat(diary.revolutions());
}

}  // namespace
}  // namespace turnlight::loop
