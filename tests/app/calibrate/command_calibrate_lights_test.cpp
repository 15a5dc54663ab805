// Proves of the real program: `calibrate lights` finds a simulated ball's lamps from a session,
// writes lights.json and pictures, compares them with files of lights, and refuses what is no ball.
// How well it finds them is tested beside the library.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/angles.h"
#include "tests/app/program.h"
#include "tests/calib/calibrate/probe/ball_session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void WriteBall(const std::string& folder) {
  calib::calibrate::probe::BallPictures pictures;
  pictures.views = 3;
  pictures.noise = 0.002;
  pictures.white = 1.0;
  pictures.room.ceiling = 0.3;
  pictures.room.floor = 0.2;
  pictures.room.lamps = {{{0.0, 0.6, 0.8}, 0.0, DegToRad(1.0), 5.0}};
  calib::calibrate::probe::WriteBallSession(pictures, true, Eigen::Vector3d::Zero(), folder);
}

TEST(CalibrateLights, FindsTheLampAndComparesIt) {
  const TemporaryFolder folder;
  WriteBall(folder / "ball");
  WriteText(folder / "same.json",
            R"({"lights": [{"direction": [0, 0.6, 0.8], "direction_sigma_deg": 0.1}]})");
  WriteText(folder / "other.json",
            R"({"lights": [{"direction": [0, 0.65, 0.75], "direction_sigma_deg": 0.1}]})");
  const Outcome same = RunProgram({"calibrate", "lights", folder / "ball", "--sphere-from-outline",
                                   "--against", folder / "same.json", "--out", folder / "lights"});
  EXPECT_EQ(same.exit_code, 0) << same.err << same.out;
  EXPECT_THAT(same.out, HasSubstr("1 light\n"));
  EXPECT_THAT(same.out, HasSubstr("they agree within 3 sigmas"));
  const auto written = nlohmann::json::parse(ReadText(folder / "lights/lights.json"));
  EXPECT_EQ(written["lights"].size(), 1u);
  for (const char* picture : {"lights/sky.png", "lights/spots_000.png", "lights/spots_002.png"})
    EXPECT_TRUE(fs::exists(folder / picture)) << picture;
  const Outcome other =
      RunProgram({"calibrate", "lights", folder / "ball", "--center-sigma", "0.01", "--against",
                  folder / "other.json", "--out", folder / "again"});
  EXPECT_EQ(other.exit_code, 3) << other.err;
  EXPECT_THAT(other.out, HasSubstr("differ"));
}

TEST(CalibrateLights, JsonIsAllThatIsPrinted) {
  const TemporaryFolder folder;
  WriteBall(folder / "ball");
  const Outcome outcome = RunProgram({"calibrate", "lights", folder / "ball", "--second",
                                      folder / "ball", "--json", "--out", folder / "lights"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, ReadText(folder / "lights/lights.json"));
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["balls"].size(), 2u);
}

TEST(CalibrateLights, RefusesInWords) {
  const TemporaryFolder folder;
  WriteBall(folder / "ball");
  const Outcome nothing =
      RunProgram({"calibrate", "lights", folder / "none", "--out", folder / "lights"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("none"));
  const Outcome inside =
      RunProgram({"calibrate", "lights", folder / "ball", "--out", folder / "ball/lights"});
  EXPECT_EQ(inside.exit_code, 2);
  EXPECT_THAT(inside.err, HasSubstr("never changes"));
  const Outcome against = RunProgram({"calibrate", "lights", folder / "ball", "--against",
                                      folder / "gone.json", "--out", folder / "lights"});
  EXPECT_EQ(against.exit_code, 2);
  EXPECT_FALSE(fs::exists(folder / "lights"));
  std::string session = ReadText(folder / "ball/session.json");
  Replace(session, "\"shape\":\"sphere\"", "\"shape\":\"cube\"");
  WriteText(folder / "ball/session.json", session);
  const Outcome cube =
      RunProgram({"calibrate", "lights", folder / "ball", "--out", folder / "lights"});
  EXPECT_EQ(cube.exit_code, 2);
  EXPECT_THAT(cube.err, HasSubstr("shape"));
}

}  // namespace
}  // namespace turnlight::app
