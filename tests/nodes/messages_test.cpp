// Proves that the messages with pictures in them come back from their wire format as they were, and
// that damaged bytes are refused. Does not test the log: its own tests do.
#include "nodes/messages.h"

#include <gtest/gtest.h>

#include "nodes/graph/message.h"

namespace turnlight::nodes {
namespace {

Bracket MakeBracket() {
  Bracket bracket;
  bracket.index = 7;
  bracket.closure = true;
  bracket.angle_deg = 360.0;
  bracket.angle_measured_deg = 359.99;
  Frame frame;
  frame.image = cv::Mat(3, 4, CV_16UC3, cv::Scalar(1, 2, 65535));
  frame.frame_id = 65535;
  frame.asked_trigger = 9;
  frame.exposure_begin = rig::DeviceTime(5);
  frame.exposure_end = rig::DeviceTime(6);
  frame.actual = {8001.0, 0.5};
  frame.readings = {{"DeviceTemperature", 41.5}, {"PacketsMissing", 3.0}};
  bracket.exposures = {frame, frame};
  bracket.utc = "virtual+1.000000000s";
  bracket.attempts = 2;
  bracket.rejected = {"stale"};
  return bracket;
}

template <typename T>
std::string Bytes(const T& value) {
  std::string bytes;
  graph::WireWriter out(bytes);
  graph::Wire<T>::Encode(value, out);
  return bytes;
}

template <typename T>
void ExpectSameBytesAgain(const T& value) {
  const std::string bytes = Bytes(value);
  const auto decoded = graph::DecodeMessage(graph::TypeOf<T>(), bytes);
  ASSERT_TRUE(decoded) << decoded.error().text;
  EXPECT_EQ(Bytes(*std::static_pointer_cast<const T>(*decoded)), bytes);
}

TEST(Messages, ComeBackAsTheyWere) {
  const Bracket bracket = MakeBracket();
  ExpectSameBytesAgain(bracket);
  Bracket by_hand = bracket;
  by_hand.placed = calib::RigPoses{};
  by_hand.placed->X_WC.translation = {1.0, 2.0, 3.0};
  ExpectSameBytesAgain(by_hand);
  ExpectSameBytesAgain(Guidance{"move on up", 3, 36});
  Keyframe keyframe;
  keyframe.bracket = bracket;
  keyframe.camera_sha256 = "abc";
  keyframe.image = bracket.exposures[0].image;
  keyframe.exposure = {8000.0, 1.0};
  keyframe.linear.radiance = cv::Mat(3, 4, CV_32FC3, cv::Scalar(0.1, 0.2, -0.3));
  keyframe.linear.saturated = cv::Mat1b(3, 4, std::uint8_t{255});
  keyframe.X_WT.translation = {1.0, 2.0, 3.0};
  ExpectSameBytesAgain(keyframe);
  keyframe.linear.variance = cv::Mat1f(3, 4, 0.01f);
  ExpectSameBytesAgain(keyframe);
  ExpectSameBytesAgain(Pace{1.0, 2.0, 3.0, 4.0, 5.0});
  ExpectSameBytesAgain(Estimate{3, 12, {LightNow{}, LightNow{}}, 0.01});
  ExpectSameBytesAgain(Verdict{Verdict::Kind::kOneMore, 36, 122.5, "", "One more."});
  ExpectSameBytesAgain(MoveGoal{{358.0, 360.0}, rig::DeviceTime(7)});
  ExpectSameBytesAgain(ExposeResult{bracket.exposures[0], "why"});
}

TEST(Messages, PixelsSurvive) {
  const auto decoded = graph::DecodeMessage(graph::TypeOf<Bracket>(), Bytes(MakeBracket()));
  ASSERT_TRUE(decoded) << decoded.error().text;
  const auto bracket = std::static_pointer_cast<const Bracket>(*decoded);
  ASSERT_EQ(bracket->exposures.size(), 2u);
  EXPECT_EQ(cv::norm(bracket->exposures[1].image, MakeBracket().exposures[1].image, cv::NORM_INF),
            0.0);
}

TEST(Messages, EveryCutIsRefused) {
  const std::string bytes = Bytes(MakeBracket());
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(graph::DecodeMessage(graph::TypeOf<Bracket>(), bytes.substr(0, length))) << length;
}

}  // namespace
}  // namespace turnlight::nodes
