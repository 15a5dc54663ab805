// Proves, with the real program, mock devices and a small controller on a pseudo-terminal: home,
// jog, snap and doctor say what will move before it moves, do it, and end with the code that is
// due; Ctrl-C and SIGTERM halt the motor; JSON stands alone on standard output. Does not prove:
// real hardware.
#include "app/device_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "rig/session/image_file.h"
#include "tests/app/fake_devices.h"
#include "tests/app/program.h"
#include "tests/rig/serial/tiny_controller.h"
#include "tests/temporary_folder.h"

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kMockRig[] =
    "rig:\n"
    "  table: {driver: mock, max_speed_deg_s: 1000, acceleration_deg_s2: 10000, home_speed_deg_s: "
    "1000}\n"
    "  camera: {driver: mock, readout_ms: 1}\n"
    "simulation:\n"
    "  target: {shape: blob, radius: 40, depth: 0.3, segments: 24}\n"
    "  motion: {kind: table, distance: 420, elevation_deg: 30}\n"
    "  camera: {size: [80, 60], focal_px: 130}\n";

class DeviceCommands : public testing::Test {
 protected:
  DeviceCommands() { WriteText(rig_, kMockRig); }
  std::string Write(const std::string& name, const std::string& text) {
    WriteText(folder_ / name, text);
    return folder_ / name;
  }

  const TemporaryFolder folder_;
  const std::string rig_ = folder_ / "rig.yaml";
};

TEST_F(DeviceCommands, JogTakesItsWordsInAnyOrder) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> lines = {
      {{"jog", rig_, "120"}, "120.000"},
      {{"jog", "-10", rig_}, "-10.000"},
      {{"jog", rig_, "-0.5"}, "-0.500"},
      {{"jog", rig_, "+10"}, "10.000"},
      {{"jog", "+-10", "--config", rig_}, "-10.000"},
      {{"home", "--config", rig_}, "0.000"},
      {{"home", rig_}, "0.000"}};
  for (const auto& [line, angle] : lines) {
    const Outcome outcome = RunProgram(line);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "the table stands at " + angle + " degrees\n") << line[1];
    EXPECT_THAT(outcome.err, HasSubstr("the table mock will home"));
  }
  EXPECT_THAT(RunProgram({"jog", rig_, "120"}).err,
              AllOf(HasSubstr("the position is not known: not homed since power-on; homing comes "
                              "first"),
                    HasSubstr("will turn from 0.000 to 120.000 degrees, 120 degrees "
                              "counter-clockwise, at 1000 deg/s")));
}

TEST_F(DeviceCommands, WhatIsRefused) {
  const auto refusal = [](const std::vector<std::string>& line, int code) {
    const Outcome outcome = RunProgram(line);
    EXPECT_EQ(outcome.exit_code, code) << line[0];
    EXPECT_EQ(outcome.out, "") << line[0];
    return outcome.err;
  };
  EXPECT_THAT(refusal({"jog", rig_, "5", "--no-home"}, 4), HasSubstr("turnlight home"));
  EXPECT_THAT(refusal({"jog", rig_}, 2), HasSubstr("an angle or a step"));
  EXPECT_THAT(refusal({"jog", "5"}, 2), HasSubstr("no config is given"));
  EXPECT_THAT(refusal({"home", folder_ / "none.yaml"}, 2), HasSubstr("none.yaml"));
  EXPECT_THAT(refusal({"snap", rig_, "picture.jpg"}, 2), HasSubstr("one word too many"));
  EXPECT_THAT(refusal({"jog", rig_, "5", "--no-homing"}, 2), HasSubstr("did you mean --no-home"));
  const std::string limited =
      Write("limited.yaml", std::string("capture: {count: 2, limits_deg: [-20, 40]}\n") + kMockRig);
  EXPECT_THAT(refusal({"jog", limited, "50"}, 2), HasSubstr("capture/limits_deg: -20 to 40"));
  const std::string absent =
      Write("absent.yaml", "rig: {table: {driver: grbl, port: /dev/none}}\n");
  EXPECT_THAT(refusal({"home", absent}, 4), HasSubstr("turnlight devices lists"));
}

TEST_F(DeviceCommands, InterruptsHaltTheMotor) {
  std::string slow = kMockRig;
  Replace(slow, "max_speed_deg_s: 1000", "max_speed_deg_s: 20");
  const std::string config = Write("slow.yaml", slow);
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string err = folder_ / ("err" + std::to_string(signal));
    const pid_t process = Start({"jog", config, "3600"}, err);
    while (ReadText(err).find("will turn") == std::string::npos) ::usleep(2000);
    ::kill(process, signal);
    EXPECT_EQ(Finish(process), 130);
    EXPECT_THAT(ReadText(err), AllOf(HasSubstr("note: the motor was stopped, at "),
                                     HasSubstr("turnlight: interrupted")));
  }
  const Outcome late = RunProgram({"jog", config, "3600", "--timeout", "0.3"});
  EXPECT_EQ(late.exit_code, 4);
  EXPECT_THAT(late.err, AllOf(HasSubstr("still moves after 0.3"), HasSubstr("was stopped"),
                              HasSubstr("turnlight doctor")));
}

TEST_F(DeviceCommands, AControllerOnASerialPort) {
  rig::serial::TinyController controller("table");
  const std::string config =
      Write("grbl.yaml", "rig: {table: {driver: grbl, port: " + controller.path() + "}}\n");
  const Outcome outcome = RunProgram({"jog", config, "30"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "the table stands at 30.000 degrees\n");
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("grbl at " + controller.path() + ": "),
                                 HasSubstr("to 30.000 degrees")));
  EXPECT_THAT(controller.Heard(), HasSubstr("X30"));
  const Outcome doctor = RunProgram({"doctor", config, "--out", folder_.path()});
  EXPECT_EQ(doctor.exit_code, 0) << doctor.out;
  EXPECT_THAT(doctor.out, AllOf(HasSubstr("yours to read and write"), HasSubstr("0 failed"),
                                HasSubstr("the config has no rig/camera")));
}

TEST_F(DeviceCommands, SnapWritesAPictureAndItsLevels) {
  const std::string picture = folder_ / "picture.png";
  const Outcome outcome = RunProgram({"snap", rig_, picture});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("picture.png: 80 x 60 pixels, 16 bits, R, G, B"),
                    HasSubstr("exposure 8000 us asked, 8000 us read back"), HasSubstr("median"),
                    HasSubstr("\u2588"), HasSubstr("a capture would keep this picture")));
  EXPECT_THAT(outcome.err, HasSubstr("nothing moves"));
  const auto read = rig::ReadImage(picture);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->type(), CV_16UC3);
  const Outcome dark = RunProgram({"snap", picture, "--config", rig_, "--exposure", "40"});
  EXPECT_EQ(dark.exit_code, 0) << dark.err;
  EXPECT_THAT(dark.out, AllOf(HasSubstr("multiply the exposure"), HasSubstr("all black")));
}

// A mosaic stays one; what the camera measures is told; a calibration that is not there is no
// reason to take no picture.
TEST_F(DeviceCommands, SnapOfARawCamera) {
  const FakeDevices fakes;
  const std::string config =
      Write("fake.yaml", "rig: {camera: {driver: fake}, calibration: none.json}\n");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  fakes.camera->notes = {"it has no gamma"};
  EXPECT_EQ(RunSnap({.config = config, .out = folder_ / "p.png", .gain_db = 3.0}, fakes.WithThem()),
            0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("3 dB read back"), HasSubstr("DeviceTemperature 41.5"),
                    HasSubstr("white 255")));
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              AllOf(HasSubstr("note: it has no gamma"), HasSubstr("none.json")));
  fakes.camera->lost = 100;
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunSnap({.config = config, .out = folder_ / "q.png"}, fakes.WithThem()), 4);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("it did not answer"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "q.png"));
}

TEST_F(DeviceCommands, DoctorForPeopleAndPrograms) {
  const std::string junit = folder_ / "doctor.xml";
  const Outcome outcome =
      RunProgram({"doctor", rig_, "--json", "--junit", junit, "--out", folder_.path()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["failed"], 0);
  EXPECT_EQ(json["checks"].back()["name"], "once around");
  EXPECT_THAT(std::string(json["checks"].back()["figure"]), HasSubstr("kept its place"));
  EXPECT_THAT(outcome.err, HasSubstr("to 0.000 degrees and on to 360.000 degrees"));
  EXPECT_THAT(ReadText(junit), HasSubstr("<testcase classname=\"doctor\" name=\"once around\""));
  const Outcome still = RunProgram({"doctor", rig_, "--no-move", "--out", folder_.path()});
  EXPECT_THAT(still.err, Not(HasSubstr("will")));
}

TEST_F(DeviceCommands, DoctorSeesWhatIsWrong) {
  std::string wrong = kMockRig;
  wrong += "  table: {scale: 1.01}\n";  // degrees that are none
  const Outcome lost = RunProgram({"doctor", Write("wrong.yaml", wrong), "--out", folder_.path()});
  EXPECT_EQ(lost.exit_code, 4);
  EXPECT_THAT(lost.out, AllOf(HasSubstr("failed   once around"), HasSubstr("lost its place")));
  const Outcome refused = RunProgram({"doctor", Write("bad.yaml", "rig: {table: {}}\n")});
  EXPECT_EQ(refused.exit_code, 2);
  const std::string run = Write("run.yaml", std::string(kMockRig) + "graph: {nodes: {}}\n");
  EXPECT_EQ(RunProgram({"doctor", run, "--no-move", "--out", folder_.path()}).exit_code, 2);
}

TEST_F(DeviceCommands, DevicesAreListed) {
  const Outcome outcome = RunProgram({"devices", "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(nlohmann::json::parse(outcome.out).contains("cameras"));
  EXPECT_THAT(RunProgram({"devices"}).out, AllOf(HasSubstr("serial ports"), HasSubstr("cameras")));
}

}  // namespace
}  // namespace turnlight::app
