// Proves that each camera fault of the script has its effect on a plain client of Aravis', and that
// the next trigger gives the good picture again. Does not prove that a capture notices: that is the
// driver's and the nodes'.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <thread>

#include "tests/rig/sim/gige/gige_bench.h"

namespace turnlight::rig::sim::gige {
namespace {

constexpr double kAngleDeg = 40.0;

// Within five seconds.
bool Becomes(const std::function<bool()>& condition) {
  for (int i = 0; i < 2500 && !condition(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return condition();
}

// One fault at 40 degrees; the client streams, and has had a good frame at 0 degrees.
class GigeFault : public testing::Test {
 protected:
  void Begin(FaultKind kind, double amount = 0.0) {
    FaultEntry fault = CameraFault(kind, kAngleDeg);
    if (amount != 0.0) fault.amount = amount;
    bench_.emplace(std::vector<FaultEntry>{fault});
    client_.emplace(bench_->config.address);
    ASSERT_TRUE(client_->open());
    client_->Start();
    bench_->Move(0.0);
    before_ = client_->Shoot();
    good_ = bench_->Picture(kAngleDeg, 8);
    bench_->Move(kAngleDeg);
  }
  void ExpectGoodAgain() {
    const ClientFrame frame = client_->Shoot();
    EXPECT_EQ(frame.bytes, Good());
    EXPECT_EQ(bench_->world.faults->Remaining(), 0);
  }
  std::vector<std::uint8_t> Good() const { return {good_.datastart, good_.dataend}; }
  static double Mean(const ClientFrame& frame) {
    double sum = 0.0;
    for (const std::uint8_t value : frame.bytes) sum += value;
    return sum / static_cast<double>(frame.bytes.size());
  }

  std::optional<GigeBench> bench_;
  std::optional<Client> client_;
  ClientFrame before_;
  cv::Mat good_;
};

TEST_F(GigeFault, AStaleFrameComesFirst) {
  Begin(FaultKind::kStaleFrame, 700.0);
  const auto triggered_ns = static_cast<std::uint64_t>(g_get_real_time()) * 1000;
  client_->Trigger();
  const auto stale = client_->Pop(), frame = client_->Pop();
  ASSERT_TRUE(stale && frame);
  EXPECT_LT(stale->timestamp_ns, triggered_ns - 600'000'000);
  EXPECT_GE(frame->timestamp_ns, triggered_ns);
  EXPECT_EQ(frame->bytes, Good());
  ExpectGoodAgain();
}

// Aravis' client throws a frame of an id away that it has had already, so that only the camera
// knows that one more was sent.
TEST_F(GigeFault, ADuplicateFrameIsSent) {
  Begin(FaultKind::kDuplicateFrame);
  client_->Trigger();
  const auto frame = client_->Pop();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->id, before_.id + 1);
  EXPECT_EQ(frame->bytes, Good());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(bench_->camera->counts().frames, 3u);
  ExpectGoodAgain();
}

TEST_F(GigeFault, ADroppedFrameLeavesAGapInTheIds) {
  Begin(FaultKind::kDroppedFrame);
  client_->Trigger();
  EXPECT_FALSE(client_->Pop(150));
  EXPECT_EQ(client_->Shoot().id, before_.id + 2);
  ExpectGoodAgain();
}

TEST_F(GigeFault, OfAnIncompleteFramePacketsAreMissing) {
  Begin(FaultKind::kIncompleteFrame);
  client_->Trigger();
  const auto frame = client_->Pop();
  ASSERT_TRUE(frame);
  EXPECT_NE(frame->status, ARV_BUFFER_STATUS_SUCCESS);
  ExpectGoodAgain();
}

TEST_F(GigeFault, ABlurredFrameIsAnother) {
  Begin(FaultKind::kBlurred, 5.0);
  const ClientFrame frame = client_->Shoot();
  EXPECT_NE(frame.bytes, Good());
  EXPECT_NEAR(bench_->world.table->TrueAngleDeg(bench_->Now()), kAngleDeg + 5.0, 1e-6);
}

TEST_F(GigeFault, AnIgnoredTriggerLeavesNoGap) {
  Begin(FaultKind::kTriggerIgnored);
  client_->Trigger();
  EXPECT_FALSE(client_->Pop(150));
  EXPECT_EQ(client_->Shoot().id, before_.id + 1);
  ExpectGoodAgain();
}

TEST_F(GigeFault, AnUntriggeredFrameFollows) {
  Begin(FaultKind::kUntriggeredFrame);
  client_->Trigger();
  const auto frame = client_->Pop(), extra = client_->Pop();
  ASSERT_TRUE(frame && extra);
  EXPECT_EQ(frame->bytes, Good());
  EXPECT_EQ(extra->id, frame->id + 1);
  EXPECT_GT(extra->timestamp_ns, frame->timestamp_ns);
  ExpectGoodAgain();
}

TEST_F(GigeFault, ExposureDriftsForOneFrameAndReadsBackSo) {
  Begin(FaultKind::kExposureDrift, 0.5);
  const ClientFrame frame = client_->Shoot();
  EXPECT_NE(frame.bytes, Good());
  EXPECT_EQ(client_->Float("ExposureTime"), 12000.0);
  ExpectGoodAgain();
  EXPECT_EQ(client_->Float("ExposureTime"), 8000.0);
}

TEST_F(GigeFault, WhatTheClientSetsAfterADriftStays) {
  Begin(FaultKind::kExposureDrift, 0.5);
  client_->Shoot();
  client_->Set("ExposureTime", 5000.0);
  client_->Shoot();
  EXPECT_EQ(client_->Float("ExposureTime"), 5000.0);
}

TEST_F(GigeFault, GainDriftsForOneFrameAndReadsBackSo) {
  Begin(FaultKind::kGainDrift, 1.5);
  EXPECT_NE(client_->Shoot().bytes, Good());
  EXPECT_DOUBLE_EQ(client_->Float("Gain"), 1.5);
  ExpectGoodAgain();
  EXPECT_DOUBLE_EQ(client_->Float("Gain"), 0.0);
}

TEST_F(GigeFault, FlickerBrightens) {
  Begin(FaultKind::kFlicker, 0.3);
  const ClientFrame bright = client_->Shoot(), frame = client_->Shoot();
  EXPECT_GT(Mean(bright), 1.1 * Mean(frame));
  EXPECT_EQ(frame.bytes, Good());
}

TEST_F(GigeFault, WithoutTheLampItIsDarker) {
  Begin(FaultKind::kLampOff);
  const ClientFrame dark = client_->Shoot(), frame = client_->Shoot();
  EXPECT_LT(Mean(dark), 0.8 * Mean(frame));
  EXPECT_EQ(frame.bytes, Good());
}

TEST_F(GigeFault, ASaturatedFrameIsWhite) {
  Begin(FaultKind::kSaturated);
  EXPECT_EQ(Mean(client_->Shoot()), 255.0);
  ExpectGoodAgain();
}

TEST_F(GigeFault, ABlackFrameIsBlack) {
  Begin(FaultKind::kAllBlack);
  EXPECT_EQ(Mean(client_->Shoot()), 0.0);
  ExpectGoodAgain();
}

TEST_F(GigeFault, ControlIsLostUntilItIsTakenAgain) {
  Begin(FaultKind::kControlLost);
  client_->Trigger();
  EXPECT_FALSE(client_->Pop(150));
  ASSERT_TRUE(arv_gv_device_take_control(ARV_GV_DEVICE(client_->device()), nullptr));
  ExpectGoodAgain();
}

TEST_F(GigeFault, UnpluggedItIsGoneAndComesBackWithoutItsSettings) {
  Begin(FaultKind::kUnplugged, 400.0);
  EXPECT_TRUE(Becomes([&] { return *IsFree(bench_->config.address); }));
  EXPECT_TRUE(Becomes([&] { return !*IsFree(bench_->config.address); }));
  client_.reset();
  client_.emplace(bench_->config.address);
  ASSERT_TRUE(client_->open());
  EXPECT_NE(client_->Integer("GevSCPSPacketSize"), 9000);
  client_->Start();
  ExpectGoodAgain();
}

// A few losses are got over by triggering again.
TEST(GigePackets, SomeAreLost) {
  GigeBench bench({}, "RGB8", [](CameraConfig& config) { config.packet_loss = 0.05; });
  Client client(bench.config.address);
  ASSERT_TRUE(client.open());
  client.Start(true, 1000);
  int bad = 0, good = 0;
  for (int i = 0; i < 20; ++i) {
    client.Trigger();
    const auto frame = client.Pop(300);
    (frame && frame->good() ? good : bad) += 1;
  }
  EXPECT_GT(bad, 0);
  EXPECT_GT(good, 0);
}

}  // namespace
}  // namespace turnlight::rig::sim::gige
