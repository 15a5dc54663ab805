// Proves that a script is read strictly, strikes where and as often as it says, and that its random
// part follows from the seed alone. Does not prove what the faults do; the devices' tests do.
#include "rig/sim/fault_script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace turnlight::rig::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

Result<std::vector<FaultEntry>> Parse(const std::string& yaml, const KeyframeAngles& angles = {}) {
  const auto document = ParseYaml(yaml, "f.yaml");
  if (!document) return Forward(document);
  return ReadFaultScript(StrictObject(*document), angles);
}

std::string RefusalOfScript(const std::string& yaml) {
  const auto entries = Parse(yaml);
  return entries ? "accepted" : entries.error().text;
}

TEST(FaultScript, ReadsPlacesAmountsAndTimes) {
  const auto entries = Parse(R"(
list:
  - {at: {keyframe: 3}, fault: lost_steps, deg: 2.5}
  - {at: {angle_deg: 120}, device: table, fault: stall, times: 2}
  - {at: {time_s: 12.5}, device: camera, fault: unplugged, ms: 300}
  - {fault: exposure_drift, share: -0.2}
  - {fault: gain_drift}
)",
                             {5.0, -10.0, 36});
  ASSERT_TRUE(entries) << entries.error().text;
  ASSERT_EQ(entries->size(), 5u);
  const auto& list = *entries;
  EXPECT_EQ(list[0].kind, FaultKind::kLostSteps);
  EXPECT_EQ(list[0].device, FaultDevice::kTable);
  EXPECT_EQ(list[0].angle_deg, -25.0);
  EXPECT_EQ(list[0].amount, 2.5);
  EXPECT_EQ(list[0].times, 1);
  EXPECT_EQ(list[1].angle_deg, 120.0);
  EXPECT_EQ(list[1].times, 2);
  EXPECT_EQ(list[2].device, FaultDevice::kCamera);
  EXPECT_EQ(list[2].from, milliseconds(12500));
  EXPECT_FALSE(list[2].angle_deg);
  EXPECT_EQ(list[3].amount, -0.2);
  EXPECT_EQ(list[4].amount, 0.5);
  EXPECT_FALSE(list[4].from || list[4].angle_deg);
}

TEST(FaultScript, EveryWordReadsBackToItsKind) {
  for (int i = 0; i <= static_cast<int>(FaultKind::kControlLost); ++i) {
    const auto kind = static_cast<FaultKind>(i);
    const auto entries = Parse("list: [{fault: " + FaultWord(kind) +
                               (kind == FaultKind::kUnplugged ? ", device: table" : "") + "}]");
    ASSERT_TRUE(entries) << entries.error().text;
    EXPECT_EQ(entries->front().kind, kind) << FaultWord(kind);
    EXPECT_EQ(entries->front().amount, MakeFault(kind).amount) << FaultWord(kind);
  }
}

TEST(FaultScript, RefusesByFileLineKeyAndWhatIsAllowed) {
  EXPECT_EQ(RefusalOfScript("{}"), "accepted");
  EXPECT_THAT(
      RefusalOfScript("list: [{fault: gremlin}]"),
      HasSubstr("f.yaml:1: list/0/fault: \"gremlin\", allowed is one of lost_steps, stall"));
  EXPECT_THAT(RefusalOfScript("list: [{deg: 1}]"), HasSubstr("list/0/fault: this key is missing"));
  EXPECT_THAT(RefusalOfScript("list: [{fault: stall, deg: 1}]"), HasSubstr("unknown key"));
  EXPECT_THAT(RefusalOfScript("list: [{fault: lost_steps, deg: -1}]"), HasSubstr("list/0/deg: -1"));
  EXPECT_THAT(RefusalOfScript("list: [{fault: stall, device: camera}]"),
              HasSubstr("allowed is table, as stall is a fault of it"));
  EXPECT_THAT(RefusalOfScript("list: [{fault: unplugged}]"), HasSubstr("device"));
  EXPECT_THAT(RefusalOfScript("list: [{fault: stall, at: {keyframe: 36}}]"),
              HasSubstr("from 0 to 35"));
  EXPECT_THAT(RefusalOfScript("list: [{fault: stall, at: {keyframe: 3, time_s: 1}}]"),
              HasSubstr("list/0/at: allowed is exactly one of keyframe, angle_deg, time_s"));
  EXPECT_THAT(RefusalOfScript("list: [{fault: stall, at: {}}]"), HasSubstr("exactly one"));
  EXPECT_THAT(RefusalOfScript("list: [{fault: stall, times: 0}]"), HasSubstr("list/0/times"));
  EXPECT_THAT(RefusalOfScript("random: {share: 2}"), HasSubstr("random/share: 2"));
  EXPECT_THAT(RefusalOfScript("random: {share: 1, faults: [gremlin]}"),
              HasSubstr("a list of any of"));
  EXPECT_THAT(RefusalOfScript("random: {share: 1, faults: stall}"), HasSubstr("a list of any of"));
  EXPECT_THAT(RefusalOfScript("random: {share: 1, faults: []}"), HasSubstr("a list of any of"));
  EXPECT_THAT(RefusalOfScript("fault: stall"), HasSubstr("unknown key"));
}

TEST(FaultScript, StrikesAtItsAngleAndOnlySoOften) {
  FaultEntry entry = MakeFault(FaultKind::kDroppedFrame);
  entry.angle_deg = 30.0;
  entry.times = 2;
  FaultScript script({entry});
  const auto strike = [&](double angle_deg) {
    return script.Strike(FaultKind::kDroppedFrame, FaultDevice::kCamera, angle_deg, seconds(1))
        .has_value();
  };
  EXPECT_FALSE(strike(29.999));
  EXPECT_FALSE(
      script.Strike(FaultKind::kStaleFrame, FaultDevice::kCamera, 30.0, seconds(1)).has_value());
  EXPECT_TRUE(strike(30.0));
  EXPECT_EQ(script.Remaining(), 1);
  EXPECT_TRUE(strike(30.0 + 1e-10));
  EXPECT_FALSE(strike(30.0));
  EXPECT_EQ(script.Remaining(), 0);
  ASSERT_EQ(script.Fired().size(), 2u);
  EXPECT_EQ(script.Fired()[0].commanded_deg, 30.0);
}

TEST(FaultScript, StrikesFromItsTimeOnAndOnlyItsDevice) {
  FaultEntry entry = MakeFault(FaultKind::kUnplugged);
  entry.device = FaultDevice::kCamera;
  entry.from = seconds(10);
  FaultScript script({entry});
  const auto strike = [&](FaultDevice device, DeviceTime now) {
    return script.Strike(FaultKind::kUnplugged, device, 0.0, now).has_value();
  };
  EXPECT_FALSE(strike(FaultDevice::kCamera, seconds(10) - DeviceTime(1)));
  EXPECT_FALSE(strike(FaultDevice::kTable, seconds(10)));
  EXPECT_TRUE(strike(FaultDevice::kCamera, seconds(11)));
}

TEST(FaultScript, EntriesOfOneKindStrikeOneAfterTheOther) {
  FaultEntry first = MakeFault(FaultKind::kLostSteps), second = first;
  first.amount = 1.0;
  second.amount = 2.0;
  FaultScript script({first, second});
  const auto amount = [&] {
    return script.Strike(FaultKind::kLostSteps, FaultDevice::kTable, 0.0, seconds(1))->amount;
  };
  EXPECT_EQ(amount(), 1.0);
  EXPECT_EQ(amount(), 2.0);
}

TEST(FaultScript, RandomPartFollowsFromTheSeed) {
  const std::string yaml = "random: {seed: 5, share: 0.3}";
  const auto a = Parse(yaml, {0.0, 1.0, 1000}), b = Parse(yaml, {0.0, 1.0, 1000});
  const auto c = Parse("random: {seed: 6, share: 0.3}", {0.0, 1.0, 1000});
  ASSERT_TRUE(a && b && c);
  EXPECT_NEAR(static_cast<double>(a->size()), 300.0, 60.0);
  std::set<FaultKind> kinds;
  std::set<double> angles_a, angles_c;
  ASSERT_EQ(a->size(), b->size());
  for (std::size_t i = 0; i < a->size(); ++i) {
    EXPECT_EQ((*a)[i].kind, (*b)[i].kind);
    EXPECT_EQ((*a)[i].angle_deg, (*b)[i].angle_deg);
    kinds.insert((*a)[i].kind);
    angles_a.insert(*(*a)[i].angle_deg);
  }
  for (const FaultEntry& entry : *c) angles_c.insert(*entry.angle_deg);
  EXPECT_NE(angles_a, angles_c);
  EXPECT_GE(kinds.size(), 10u);
  EXPECT_FALSE(kinds.contains(FaultKind::kNeverHomes));
  EXPECT_FALSE(kinds.contains(FaultKind::kLampOff));
}

TEST(FaultScript, RandomPartDrawsOnlyWhatIsListed) {
  const auto entries = Parse("random: {share: 1, faults: [stall, lamp_off]}");
  ASSERT_TRUE(entries) << entries.error().text;
  ASSERT_EQ(entries->size(), 36u);
  std::set<FaultKind> kinds;
  for (const FaultEntry& entry : *entries) kinds.insert(entry.kind);
  EXPECT_EQ(kinds, (std::set<FaultKind>{FaultKind::kStall, FaultKind::kLampOff}));
}

TEST(FaultScript, FaultsOfALineAreOfRealProtocolsOnly) {
  const auto parse = [](const std::string& yaml, FaultWorld world) {
    const auto document = ParseYaml(yaml, "f.yaml");
    return ReadFaultScript(StrictObject(*document), {0.0, 1.0, 2000}, world);
  };
  for (int i = static_cast<int>(FaultKind::kSerialGarbage);
       i <= static_cast<int>(FaultKind::kDisplaced); ++i) {
    const auto kind = static_cast<FaultKind>(i);
    const std::string yaml = "list: [{fault: " + FaultWord(kind) + "}]";
    EXPECT_FALSE(parse(yaml, FaultWorld::kMocks));
    const auto entries = parse(yaml, FaultWorld::kRealProtocols);
    ASSERT_TRUE(entries) << entries.error().text;
    EXPECT_EQ(entries->front().kind, kind);
  }
  const std::string random = "random: {seed: 5, share: 1}";
  const auto drawn = [&](FaultWorld world) {
    const auto entries = parse(random, world);
    std::set<FaultKind> kinds;
    for (const FaultEntry& entry : *entries) kinds.insert(entry.kind);
    return kinds;
  };
  const std::set<FaultKind> mocks = drawn(FaultWorld::kMocks);
  const std::set<FaultKind> real = drawn(FaultWorld::kRealProtocols);
  EXPECT_EQ(mocks.size(), 15u);
  EXPECT_FALSE(mocks.contains(FaultKind::kLostStatus));
  EXPECT_TRUE(real.contains(FaultKind::kLostStatus));
  EXPECT_TRUE(real.contains(FaultKind::kLimit));
  EXPECT_FALSE(real.contains(FaultKind::kSilent));
}

TEST(FaultScript, AnglesFitWithinTheResolution) {
  FaultEntry entry = MakeFault(FaultKind::kStall);
  entry.angle_deg = 360.0 / 37.0;
  FaultScript script({entry});
  EXPECT_FALSE(script.Strike(FaultKind::kStall, FaultDevice::kTable, 9.73, seconds(1)));
  script.SetResolution(0.01);
  EXPECT_FALSE(script.Strike(FaultKind::kStall, FaultDevice::kTable, 9.74, seconds(1)));
  EXPECT_TRUE(script.Strike(FaultKind::kStall, FaultDevice::kTable, 9.73, seconds(1)));
}

}  // namespace
}  // namespace turnlight::rig::sim
