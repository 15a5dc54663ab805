// Proves, through the real camera driver on real GigE Vision packets and real nodes: every picture
// that is kept is the scene at rest at its angle to within 5 sigma of its noise, in several pixel
// formats, whatever a camera and its network do of what docs/faults.md lists; what cannot be gone
// on with ends in time with its reason, and what was good is kept. Does not prove: anything of a
// real camera; and no check of one picture sees a flicker within the limits of its levels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/aravis/gobject.h"
#include "tests/loop/rig_loop.h"
#include "tests/temporary_folder.h"

namespace turnlight::loop {
namespace {

using rig::sim::FaultKind;
using testing::HasSubstr;

constexpr double kSigmas = 5.0;

RigLoopOptions With(const rig::sim::FaultEntry& fault) {
  RigLoopOptions options = SmallRigLoop("zaber");
  options.faults = {fault};
  return options;
}

std::string Word(const RigLoopOptions& options) {
  return rig::sim::FaultWord(options.faults.front().kind);
}

void ExpectAllRight(const RigLoopRun& run, std::size_t count) {
  const std::string lines = testing::PrintToString(run.lines);
  EXPECT_FALSE(run.report.failure) << run.report.failure->text << lines;
  EXPECT_EQ(run.faults_left, 0) << "the fault never struck";
  EXPECT_EQ(run.brackets.size(), count) << lines;
  EXPECT_LT(run.worst_sigmas, kSigmas) << lines;
}

double Reading(const RigLoopRun& run, const std::string& name) {
  for (const rig::DeviceReading& reading : run.brackets.back().exposures.back().readings)
    if (reading.name == name) return reading.value;
  ADD_FAILURE() << "no reading " << name;
  return 0.0;
}

TEST(CameraLoop, EveryFormatGivesTheStaticRender) {
  std::vector<RigLoopOptions> all;
  for (const char* format : {"Mono8", "Mono12", "Mono12Packed", "Mono16", "BayerRG8", "BayerRG12",
                             "BayerRG16", "RGB8"}) {
    all.push_back(SmallRigLoop("grbl"));
    all.back().pixel_format = format;
  }
  const std::vector<RigLoopRun> runs = RunAll(all);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SCOPED_TRACE(all[i].pixel_format);
    ExpectAllRight(runs[i], 4);
    ASSERT_FALSE(runs[i].brackets.empty());
    EXPECT_EQ(runs[i].Rejected(), 0u) << testing::PrintToString(runs[i].lines);
    // The measure itself: a tenth of a degree is enough to be seen; in 8 bits it may change a grey
    // value by less than two, and a quarter of a degree is.
    const nodes::StaticScene scene = SceneOf(all[i]);
    const bool coarse = runs[i].brackets.front().exposures.front().image.depth() == CV_8U;
    for (nodes::Bracket bracket : runs[i].brackets) {
      bracket.angle_deg += coarse ? 0.25 : 0.1;
      EXPECT_GT(scene.WorstSigmas(bracket), kSigmas) << bracket.angle_deg;
    }
  }
}

// What the driver gets over by triggering again, or passes over: the nodes see one good picture.
TEST(CameraLoop, TheDriverGetsOverWhatAShotMayMeet) {
  std::vector<RigLoopOptions> all;
  for (const FaultKind kind :
       {FaultKind::kStaleFrame, FaultKind::kDuplicateFrame, FaultKind::kDroppedFrame,
        FaultKind::kIncompleteFrame, FaultKind::kTriggerIgnored, FaultKind::kUntriggeredFrame})
    all.push_back(With(CameraFault(kind, 60.0)));
  const std::vector<RigLoopRun> runs = RunAll(all);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SCOPED_TRACE(Word(all[i]));
    ExpectAllRight(runs[i], 4);
    EXPECT_EQ(runs[i].Rejected(), 0u) << testing::PrintToString(runs[i].lines);
  }
  EXPECT_GE(Reading(runs[0], "PicturesStale"), 1.0);
  EXPECT_EQ(Reading(runs[2], "TriggersUnanswered"), 1.0);
  EXPECT_EQ(Reading(runs[3], "PicturesBroken"), 1.0);
  EXPECT_EQ(Reading(runs[4], "TriggersUnanswered"), 1.0);
  EXPECT_GE(Reading(runs[5], "PicturesStale"), 1.0);
}

// What the nodes reject and take again. At the fourth keyframe: a lamp that is off is known by the
// three before.
TEST(CameraLoop, WhatAPictureShowsIsRejectedAndRepeated) {
  const std::pair<FaultKind, const char*> cases[] = {{FaultKind::kBlurred, "deg"},
                                                     {FaultKind::kExposureDrift, "exposed for"},
                                                     {FaultKind::kGainDrift, "gain"},
                                                     {FaultKind::kLampOff, "lamp"},
                                                     {FaultKind::kSaturated, "saturat"},
                                                     {FaultKind::kAllBlack, "black"},
                                                     {FaultKind::kControlLost, "sends no picture"}};
  std::vector<RigLoopOptions> all;
  for (const auto& [kind, why] : cases) all.push_back(With(CameraFault(kind, 90.0)));
  const std::vector<RigLoopRun> runs = RunAll(all);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    SCOPED_TRACE(Word(all[i]));
    ExpectAllRight(runs[i], 4);
    EXPECT_GE(runs[i].Rejected(), 1u);
    EXPECT_TRUE(runs[i].Mentions(cases[i].second)) << testing::PrintToString(runs[i].lines);
  }
}

TEST(CameraLoop, WithoutTheChecksABlurredPictureIsKeptAndSeen) {
  RigLoopOptions options = With(CameraFault(FaultKind::kBlurred, 60.0));
  options.check_arrival = options.settle = false;
  const RigLoopRun run = RunRigLoop(options);
  ASSERT_EQ(run.brackets.size(), 4u);
  EXPECT_EQ(run.faults_left, 0);
  EXPECT_GT(run.worst_sigmas, 2.0 * kSigmas);
}

// Nothing in one picture tells it from another lamp; the comparison with the scene does.
TEST(CameraLoop, AFlickerWithinTheLimitsOfTheLevelsIsNotSeen) {
  std::vector<RigLoopOptions> all{With(CameraFault(FaultKind::kFlicker, 60.0)),
                                  With(CameraFault(FaultKind::kFlicker, 90.0))};
  all[1].faults.front().amount = 1.5;  // beyond the limits
  const std::vector<RigLoopRun> runs = RunAll(all);
  ASSERT_FALSE(runs[0].report.failure) << runs[0].report.failure->text;
  EXPECT_EQ(runs[0].brackets.size(), 4u);
  EXPECT_EQ(runs[0].Rejected(), 0u);
  EXPECT_GT(runs[0].worst_sigmas, kSigmas);
  ExpectAllRight(runs[1], 4);
  EXPECT_GE(runs[1].Rejected(), 1u);
}

TEST(CameraLoop, LostPacketsCostTriggersAndNoPicture) {
  std::vector<RigLoopOptions> all;
  for (const double loss : {0.001, 0.01, 0.05}) {
    all.push_back(SmallRigLoop("grbl"));
    all.back().packet_loss = loss;
    all.back().packet_size = 576;  // 13 packets a picture
    all.back().plan.count = 12;
  }
  const std::vector<RigLoopRun> runs = RunAll(all);
  for (const RigLoopRun& run : runs) ExpectAllRight(run, 12);
  EXPECT_GE(Reading(runs.back(), "PicturesBroken"), 1.0);
  EXPECT_GE(Reading(runs.back(), "TriggersAgain"), 1.0);
}

TEST(CameraLoop, UnpluggedItComesBackAndIsSetAnew) {
  std::vector<RigLoopOptions> all;
  for (const double ms : {300.0, 3000.0}) {
    all.push_back(With(CameraFault(FaultKind::kUnplugged, 60.0)));
    all.back().faults.front().amount = ms;
    all.back().keyframes_params = "{retry_wait_ms: 200, lost_timeout_s: 20}";
  }
  for (const RigLoopRun& run : RunAll(all)) ExpectAllRight(run, 4);
}

void ExpectEndInTime(const RigLoopOptions& options, const RigLoopRun& run, const char* code) {
  SCOPED_TRACE(Word(options));
  const std::string lines = testing::PrintToString(run.lines);
  ASSERT_TRUE(run.report.failure) << lines;
  EXPECT_EQ(run.report.failure->code, code);
  EXPECT_THAT(run.report.failure->text, HasSubstr("all good frames are kept"));
  EXPECT_EQ(run.brackets.size(), 2u) << lines;
  EXPECT_LT(run.worst_sigmas, kSigmas);
  EXPECT_LT(run.seconds_from_fault, 20.0) << lines;
}

TEST(CameraLoop, GoneForGoodTheCaptureEndsInTimeAndKeepsItsFrames) {
  RigLoopOptions options = With(CameraFault(FaultKind::kUnplugged, 60.0));
  options.faults.front().amount = 1e7;
  options.keyframes_params = "{retry_wait_ms: 200, lost_timeout_s: 3}";
  const RigLoopRun run = RunRigLoop(options);
  ExpectEndInTime(options, run, "device");
  EXPECT_GE(run.seconds_from_fault, 3.0);
}

TEST(CameraLoop, ThereAndOfNoUseTheCaptureEndsAfterItsRetries) {
  std::vector<RigLoopOptions> all{With(CameraFault(FaultKind::kAllBlack, 60.0, 1000)),
                                  With(CameraFault(FaultKind::kTriggerIgnored, 60.0, 1000))};
  for (RigLoopOptions& options : all)
    options.keyframes_params = "{retry_wait_ms: 200, lost_timeout_s: 3}";
  const std::vector<RigLoopRun> runs = RunAll(all);
  ExpectEndInTime(all[0], runs[0], "incomplete");
  ExpectEndInTime(all[1], runs[1], "device");
}

// A client that has nothing to do with us may read, and is not let in to set or take anything.
TEST(CameraLoop, ASecondClientDisturbsNothing) {
  const TemporaryFolder folder;
  const RigPlace place = OwnPlace(folder.path());
  RigLoopOptions options = SmallRigLoop("zaber");
  const SimulatedRig simulated(options, place);
  std::vector<nodes::Bracket> brackets;
  rig::aravis::Owned<ArvCamera> second;
  bool in_control = true, refused = false;
  options.on_bracket = [&](const nodes::Bracket& bracket) {
    brackets.push_back(bracket);
    if (brackets.size() != 2) return;
    second.reset(arv_camera_new(place.address.c_str(), nullptr));
    if (!second) return;
    in_control = arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(second.get())));
    rig::aravis::Failure failure;
    arv_camera_set_exposure_time(second.get(), 100.0, failure.out());
    refused = static_cast<bool>(failure);
  };
  const RigLoopRun run = RunCapture(options, place);
  ASSERT_FALSE(run.report.failure) << run.report.failure->text;
  EXPECT_TRUE(second);
  EXPECT_FALSE(in_control);
  EXPECT_TRUE(refused);
  ASSERT_EQ(brackets.size(), 4u);
  const nodes::StaticScene scene = SceneOf(options);
  for (const nodes::Bracket& bracket : brackets) {
    EXPECT_LT(scene.WorstSigmas(bracket), kSigmas);
    EXPECT_EQ(bracket.attempts, 1);
  }
}

}  // namespace
}  // namespace turnlight::loop
