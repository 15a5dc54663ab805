// Proves, through real drivers, ports and nodes against simulated controllers: every frame is the
// scene at rest at its angle to within 5 sigma of its noise, whatever a serial line or a stage does
// of what docs/faults.md lists; what cannot be gone on with ends in time with its reason. Built
// twice: through termios, and through libserialport. Does not prove: anything of a real controller.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/loop/stage_loop.h"

namespace turnlight::loop {
namespace {

using rig::sim::FaultKind;
using testing::HasSubstr;

constexpr double kSigmas = 5.0;

rig::sim::FaultEntry Fault(FaultKind kind, std::optional<double> angle_deg, int times = 1) {
  rig::sim::FaultEntry entry = rig::sim::MakeFault(kind);
  entry.angle_deg = angle_deg;
  entry.times = times;
  return entry;
}

// Waiting is most of what a capture in real time does, so they run side by side.
std::vector<StageLoopRun> RunAll(const std::vector<StageLoopOptions>& all) {
  std::vector<StageLoopRun> runs(all.size());
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < all.size(); ++i)
    threads.emplace_back([&, i] { runs[i] = RunStageLoop(all[i]); });
  threads.clear();
  return runs;
}

class StageLoop : public testing::TestWithParam<std::string> {};

TEST_P(StageLoop, EveryFrameIsTheStaticRenderAtItsAngle) {
  const StageLoopRun run = RunStageLoop(SmallStageLoop(GetParam()));
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_THAT(run.opened, HasSubstr(TURNLIGHT_PORT_BACKEND));
  ASSERT_EQ(run.brackets.size(), 4u);
  EXPECT_LT(run.worst_sigmas, kSigmas);
  EXPECT_EQ(run.Rejected(), 0u) << testing::PrintToString(run.lines);
}

// What a capture survives by itself, with or without a repetition.
TEST_P(StageLoop, SurvivesWhatALineAndAStageDo) {
  std::vector<FaultKind> kinds{
      FaultKind::kSerialGarbage, FaultKind::kSplitLine,    FaultKind::kNulBytes,
      FaultKind::kLongLine,      FaultKind::kDroppedReply, FaultKind::kDuplicateReply,
      FaultKind::kLateReply,     FaultKind::kLostStatus,   FaultKind::kAlteredStatus,
      FaultKind::kUnplugged,     FaultKind::kAlarm,        FaultKind::kReset,
      FaultKind::kLateArrival,   FaultKind::kLimit,        FaultKind::kWrongPosition};
  std::vector<StageLoopOptions> all;
  for (const FaultKind kind : kinds) {
    all.push_back(SmallStageLoop(GetParam()));
    all.back().faults = {Fault(kind, 60.0)};
  }
  const std::vector<StageLoopRun> runs = RunAll(all);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SCOPED_TRACE(rig::sim::FaultWord(kinds[i]));
    const StageLoopRun& run = runs[i];
    const std::string lines = testing::PrintToString(run.lines);
    EXPECT_FALSE(run.report.failure) << run.report.failure->text << lines;
    EXPECT_EQ(run.faults_left, 0) << "the fault never struck";
    EXPECT_EQ(run.brackets.size(), 4u) << lines;
    EXPECT_LT(run.worst_sigmas, kSigmas) << lines;
  }
}

INSTANTIATE_TEST_SUITE_P(Firmwares, StageLoop, testing::Values("grbl", "zaber", "smc100"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace turnlight::loop
