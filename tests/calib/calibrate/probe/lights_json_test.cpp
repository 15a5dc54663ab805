// Proves: lights.json holds what was found, null where it is not known, and can be read back as the
// lights to compare with; the lines for people say how well. Of pictures: that each is drawn, with
// the size of what it shows (how they look is for the eye).
#include "calib/calibrate/probe/lights_json.h"

#include <gtest/gtest.h>

#include "base/angles.h"
#include "calib/calibrate/probe/against.h"
#include "calib/calibrate/probe/pictures.h"
#include "tests/calib/calibrate/probe/ball_session.h"
#include "tests/temporary_folder.h"

namespace turnlight::calib::calibrate::probe {
namespace {

using Eigen::Vector3d;

struct Found {
  TemporaryFolder folder;
  std::vector<ProbeSession> sessions;
  ProbeLights lights;
};

void Find(Found& found) {
  BallPictures pictures;
  pictures.views = 4;
  pictures.noise = 0.002;
  pictures.white = 1.0;
  const Vector3d position(300.0, 200.0, 500.0);
  pictures.room.lamps = {{position.normalized(), 1.0 / position.norm(), DegToRad(1.5), 5.0},
                         {Vector3d(-0.2, 0.1, 0.9).normalized(), 0.0, DegToRad(0.5), 0.5}};
  WriteBallSession(pictures, false, Vector3d::Zero(), found.folder.path());
  auto session = ReadProbeSession(found.folder.path(), {}, [] { return true; });
  ASSERT_TRUE(session) << session.error().text;
  found.sessions.push_back(std::move(*session));
  const ProbeInput input = Joined(found.sessions);
  found.lights = FindLights(input.views, input.spots, input.perturbations);
  ASSERT_EQ(found.lights.lights.size(), 1u);
  ASSERT_EQ(found.lights.candidates.size(), 1u);
}

TEST(LightsJson, HoldsWhatWasFound) {
  Found found;
  Find(found);
  const std::string text = LightsJson(found.lights, found.sessions, 0.02);
  const auto written = nlohmann::json::parse(text);
  EXPECT_EQ(written["format"], "turnlight-lights");
  EXPECT_EQ(written["length_unit"], "mm");
  EXPECT_EQ(written["balls"][0]["radius"], 25.0);
  EXPECT_EQ(written["balls"][0]["center_T"], nullptr);
  const auto& light = written["lights"][0];
  EXPECT_NEAR(light["distance"].get<double>(), Vector3d(300.0, 200.0, 500.0).norm(), 30.0);
  EXPECT_EQ(light["position_covariance"].size(), 3u);
  EXPECT_EQ(light["intensity"], nullptr);
  EXPECT_EQ(light["spots"].size(), 4u);
  EXPECT_EQ(light["budget"][0]["item"], "spots");
  EXPECT_EQ(written["candidates"].size(), 1u);
  const auto stated = ReadStatedLights(text, "lights.json");
  ASSERT_TRUE(stated) << stated.error().text;
  EXPECT_TRUE(CompareLights(found.lights.lights, *stated, "mm").agrees);
}

TEST(LightsJson, TheLinesSayHowWellItIsKnown) {
  Found found;
  Find(found);
  const std::string line = LightText(found.lights.lights[0], 1, "mm");
  EXPECT_NE(line.find("mm away"), std::string::npos) << line;
  EXPECT_NE(line.find("clipped, in 4 views"), std::string::npos) << line;
  EXPECT_NE(CandidateText(found.lights.candidates[0]).find("in 4 views: "), std::string::npos);
}

TEST(LightsJson, FramesAreFoundAgain) {
  std::vector<ProbeSession> sessions(2);
  sessions[0].views.resize(3);
  sessions[1].views.resize(2);
  EXPECT_EQ(FindFrame(sessions, 2).session, 0u);
  EXPECT_EQ(FindFrame(sessions, 3).session, 1u);
  EXPECT_EQ(FindFrame(sessions, 4).frame, 1u);
}

TEST(ProbePictures, AreDrawn) {
  Found found;
  Find(found);
  const cv::Mat3b spots = SpotsPicture(found.sessions, 0, found.lights);
  EXPECT_GT(spots.rows, 500);
  const cv::Mat3b sky = SkyPicture(found.sessions, found.lights, "mm");
  EXPECT_GT(sky.cols, 1080);
  EXPECT_EQ(ViewsToDraw(12, 6), (std::vector<std::size_t>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(ViewsToDraw(2, 6), (std::vector<std::size_t>{0, 1}));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::probe
