// Proves that `render` reproduces the session that a scene was made into, bit for bit where the
// pictures have 16 bits, that its output is a session itself, that it writes over none and tells of
// an unfinished one, and that --set and --light change what they say. Does not prove that the
// renderer is right; tests/estimator and the shared data do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <thread>

#include "calib/radiometry.h"
#include "rig/session/session.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using ::testing::HasSubstr;

using Words = std::vector<std::string>;

// The pictures of a session in linear radiance.
std::vector<cv::Mat> Radiances(const std::string& folder) {
  std::vector<cv::Mat> pictures;
  const auto session = rig::ReadSession(folder);
  EXPECT_TRUE(session) << session.error().text;
  if (!session) return pictures;
  for (std::size_t i = 0; i < session->frames.size(); ++i) {
    const auto images = rig::ReadFrameImages(*session, i);
    EXPECT_TRUE(images) << images.error().text;
    if (!images) return pictures;
    pictures.push_back(
        calib::Linearise(images->image, session->radiometry, session->frames[i].exposure).radiance);
  }
  return pictures;
}

double LargestDifference(const std::string& a, const std::string& b) {
  const auto first = Radiances(a), second = Radiances(b);
  EXPECT_EQ(first.size(), second.size());
  if (first.empty() || first.size() != second.size()) return 1e9;
  double largest = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i)
    largest = std::max(largest, cv::norm(first[i].reshape(1), second[i].reshape(1), cv::NORM_INF));
  return largest;
}

Outcome RenderTruth(const TemporaryFolder& folder, const std::string& out, const Words& more = {}) {
  Words words{"render", folder / "s", "--params", folder / "s/truth.json", "--out", folder / out};
  words.insert(words.end(), more.begin(), more.end());
  return RunProgram(words);
}

TEST(Render, ReproducesASixteenBitSessionExactly) {
  for (const bool mesh : {false, true}) {
    rig::sim::SyntheticConfig config = SmallConfig();
    if (mesh) config.target = rig::sim::Blob{40.0, 0.3, 32};
    config.sensor.black = 300.0;
    config.sensor.clip_share = 0.0;
    const TemporaryFolder folder;
    WriteSession(config, folder / "s");
    const Outcome outcome = RenderTruth(folder, "r");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const std::string name : {"frames/000.png", "frames/001.png", "frames/002.png"})
      EXPECT_EQ(ReadText(folder / ("s/" + name)), ReadText(folder / ("r/" + name))) << name;
    const Outcome verified = RunProgram({"verify", folder / "r"});
    EXPECT_EQ(verified.exit_code, 0) << verified.out;
  }
}

TEST(Render, WidensEightBits) {
  rig::sim::SyntheticConfig config = SmallConfig();
  config.sensor.depth = rig::sim::SensorDepth::k8;
  config.sensor.black = 10.0;
  config.sensor.white = 250.0;
  config.sensor.encoding = calib::Encoding::kSrgb;
  const TemporaryFolder folder;
  WriteSession(config, folder / "s");
  const Outcome outcome = RenderTruth(folder, "r");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("widened to 16 bits"));
  // Half a step of 8 bits, where the curve is steepest.
  EXPECT_LT(LargestDifference(folder / "s", folder / "r"), 0.5 / 240.0 * 2.4);
  const auto json = nlohmann::json::parse(ReadText(folder / "r/session.json"));
  EXPECT_EQ(json["radiometry"]["white"], 65535.0);
}

TEST(Render, FloatSessionsStayFloat) {
  rig::sim::SyntheticConfig config = SmallConfig();
  config.sensor.depth = rig::sim::SensorDepth::kFloat;
  config.sensor.saturation = 100.0;
  const TemporaryFolder folder;
  WriteSession(config, folder / "s");
  const Outcome outcome = RenderTruth(folder, "r");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "r/frames/000.exr"));
  EXPECT_EQ(LargestDifference(folder / "s", folder / "r"), 0.0);
}

TEST(Render, SettingsAndLightsAreTheScene) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "s");
  rig::sim::SyntheticConfig other = SmallConfig();
  auto& reflectance = std::get<estimator::model::Reflectance>(other.reflectance);
  reflectance.lobes[0].shape = 80.0;
  reflectance.albedo = {0.1, 0.2, 0.3};
  other.lights = std::vector<rig::sim::LightSpec>{{{0, 0, 1}, {}, 0.25, {1, 1, 1}},
                                                  {{-1, 0, 1}, 700.0, 0.5, {1, 1, 1}}};
  WriteSession(other, folder / "other");
  const Outcome outcome =
      RenderTruth(folder, "r",
                  {"--set", "shininess=80", "--set", "albedo=0.1,0.2,0.3", "--light", "0,0,1,inf,1",
                   "--light", "-1,0,1,700,0.5", "--set", "light.0.intensity=0.25"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_LE(LargestDifference(folder / "r", folder / "other"), 1.01 / 65535.0);
  EXPECT_GT(LargestDifference(folder / "r", folder / "s"), 0.05);
}

TEST(Render, NoShadowsLeavesOutCastShadows) {
  rig::sim::SyntheticConfig config = SmallConfig();
  config.target = rig::sim::Blob{40.0, 0.5, 32};
  config.lights = std::vector<rig::sim::LightSpec>{{{0.2, 1.0, 0.1}, {}, 1.0, {1, 1, 1}}};
  const TemporaryFolder folder;
  WriteSession(config, folder / "s");
  ASSERT_EQ(RenderTruth(folder, "r", {"--no-shadows"}).exit_code, 0);
  const auto with = Radiances(folder / "s"), without = Radiances(folder / "r");
  double darker = 0.0;
  for (std::size_t i = 0; i < with.size(); ++i)
    darker = std::max(darker, cv::norm(cv::Mat(without[i] - with[i]).reshape(1), cv::NORM_INF));
  EXPECT_GT(darker, 0.05);
}

TEST(Render, RefusesWhatIsNoScene) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "s");
  WriteText(folder / "lights.json",
            R"({"lights": [{"direction": [0, 0, 1], "position": null}], "note": "by eye"})");
  const Outcome no_scene = RunProgram(
      {"render", folder / "s", "--params", folder / "lights.json", "--out", folder / "r"});
  EXPECT_EQ(no_scene.exit_code, 2);
  EXPECT_THAT(no_scene.err, HasSubstr("rendering needs it"));

  WriteText(folder / "factors.json",
            R"({"lights": [{"direction": [0, 0, 1], "position": null, "intensity": 1,
                 "factors": [1, 0.9, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]}],
                "reflectance": {"model": "none", "albedo": [1, 1, 1], "ambient": 0, "diffuse": 1}})");
  const Outcome too_many = RunProgram(
      {"render", folder / "s", "--params", folder / "factors.json", "--out", folder / "r"});
  EXPECT_EQ(too_many.exit_code, 2);
  EXPECT_THAT(too_many.err, HasSubstr("lights/0/factors: 13 numbers, allowed is one for each of"));

  struct Case {
    Words words;
    std::string message;
  };
  for (const Case& c : {
           Case{{"--light", "0,0,1,40,1"}, "target's radius"},
           Case{{"--light", "0,0,1,40"}, "five numbers"},
           Case{{"--set", "shinines=3"}, "did you mean shininess?"},
           Case{{"--set", "shininess=0"}, "0.5 to 100000"},
           Case{{"--set", "light.1.intensity=1"}, "1 lights"},
       }) {
    const Outcome outcome = RenderTruth(folder, "r", c.words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(c.message));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "r"));
}

TEST(Render, NeverTouchesTheSession) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "s");
  std::filesystem::create_directory_symlink(folder / "s", folder / "link");
  for (const std::string out : {"s", "s/new", "link/new", "s/../s/x", "link"}) {
    const Outcome outcome = RenderTruth(folder, out);
    EXPECT_EQ(outcome.exit_code, 2) << out;
    EXPECT_THAT(outcome.err, HasSubstr("never changes")) << out;
  }
  EXPECT_EQ(RunProgram({"verify", folder / "s"}).exit_code, 0);
  const Outcome file = RenderTruth(folder, "s.txt");
  EXPECT_EQ(file.exit_code, 0) << file.err;  // beside it, with a name that begins alike
}

TEST(Render, NeverWritesOverAnotherSession) {
  const TemporaryFolder folder;
  WriteSession(SmallConfig(), folder / "s");
  rig::sim::SyntheticConfig other = SmallConfig();
  other.motion.frames = 4;
  WriteSession(other, folder / "other");
  const std::string before = ContentOf(folder / "other");
  const Outcome outcome = RenderTruth(folder, "other");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("other is not empty, allowed is a new or empty folder"));
  EXPECT_EQ(ContentOf(folder / "other"), before);
}

TEST(Render, CtrlCSaysThatTheSessionIsNotComplete) {
  const TemporaryFolder folder;
  rig::sim::SyntheticConfig config = SmallConfig();
  config.motion.frames = 12;
  config.motion.step_deg = 30.0;
  WriteSession(config, folder / "s");
  // So many rays that there is time to interrupt.
  const pid_t process = Start({"render", folder / "s", "--params", folder / "s/truth.json", "--out",
                               folder / "r", "--samples", "32"},
                              folder / "err");
  for (int i = 0; i < 3000 && !std::filesystem::exists(folder / "r/frames/000.png"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_EQ(::kill(process, SIGINT), 0);
  EXPECT_EQ(Finish(process), 130);
  EXPECT_THAT(ReadText(folder / "err"), HasSubstr("r is no complete session"));
  EXPECT_FALSE(std::filesystem::exists(folder / "r/session.json"));
}

}  // namespace
}  // namespace turnlight::app
