// Proves with the real program: a list of pictures and a raw capture become response.json, charts
// and words; a rig's calibration is updated in place and reads back; refusals have exit code 2 and
// write nothing into it. That the numbers are right response_test shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "rig/rig_calibration.h"
#include "rig/session/image_file.h"
#include "rig/session/raw_capture.h"
#include "tests/app/program.h"
#include "tests/calib/calibrate/response/sensor.h"

namespace turnlight::app {
namespace {

namespace response = calib::calibrate::response;
using testing::AllOf;
using testing::HasSubstr;

const cv::Size kSensorSize(96, 72);

class CalibrateResponse : public testing::Test {
 protected:
  CalibrateResponse() {
    sensor_.bits = 8;
    sensor_.black = 10.0;
    sensor_.saturation = 255.0;
    sensor_.full_well = 2000.0;
    capture_.name = "response";
    capture_.radiometry.white = 255.0;
    capture_.devices.camera = {"Maker", "C", "1"};
    capture_.devices.resolution = kSensorSize;
    std::filesystem::create_directories(folder_ / "frames");
    for (int i = 0; i < 2; ++i) Take("dark", 0.0, 1000.0);
    for (double exposure = 1.0 / 32.0; exposure < 1.5; exposure *= std::sqrt(2.0))
      for (int i = 0; i < 2; ++i) Take("flat", exposure, 1000.0 * exposure);
    EXPECT_TRUE(rig::WriteRawCapture(capture_, folder_.path()));
    rig::RigCalibration calibration(calib::CameraModel::Pinhole(96, 72, 100, 100, 47.5, 35.5));
    calibration.devices = capture_.devices;
    EXPECT_TRUE(rig::WriteRigCalibration(calibration, calibration_));
  }
  void Take(const std::string& kind, double light, double exposure_us) {
    const std::string name = "frames/" + std::to_string(capture_.frames.size()) + ".png";
    const cv::Mat1d scene(kSensorSize, 0.9);
    EXPECT_TRUE(rig::WriteImage(
        folder_ / name, response::Expose(sensor_, scene, light, capture_.frames.size() + 1)));
    rig::RawCaptureFrame frame;
    frame.image = name;
    frame.kind = kind;
    frame.exposure.exposure_us = exposure_us;
    capture_.frames.push_back(frame);
  }
  // The same pictures as a list.
  std::string List() const {
    std::string text = "dark: [frames/0.png, frames/1.png]\nseries:\n";
    for (std::size_t i = 2; i < capture_.frames.size(); ++i)
      text += "- {exposure_us: " + std::to_string(*capture_.frames[i].exposure.exposure_us) +
              ", images: [" + capture_.frames[i].image + "]}\n";
    return text;
  }

  TemporaryFolder folder_;
  response::SimulatedSensor sensor_;
  rig::RawCapture capture_;
  std::string calibration_ = folder_ / "rig-calibration.json", out_ = folder_ / "out";
};

TEST_F(CalibrateResponse, OfACaptureIntoARigsCalibration) {
  const Outcome outcome = RunProgram(
      {"calibrate", "response", folder_.path().string(), "--update", calibration_, "--out", out_});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("linear: "), HasSubstr("DN per electron"),
                                 HasSubstr("vignetting: none"), HasSubstr("written: ")));
  for (const char* name :
       {"response.json", "linearity.png", "photon_transfer.png", "flat_field.png"})
    EXPECT_TRUE(std::filesystem::exists(out_ + "/" + name)) << name;
  const auto read = rig::ReadRigCalibration(calibration_);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_NEAR(read->radiometry.black, 10.0, 0.1);
  ASSERT_TRUE(read->radiometry.noise);
  EXPECT_NEAR(read->radiometry.noise->dn_per_electron, sensor_.Gain(), 0.1 * sensor_.Gain());
  EXPECT_TRUE(read->covariances.noise);
}

TEST_F(CalibrateResponse, OfAListIsTheSame) {
  WriteText(folder_ / "response.yaml", List());
  const std::string other = folder_ / "other";
  ASSERT_EQ(RunProgram({"calibrate", "response", folder_.path().string(), "--out", out_}).exit_code,
            0);
  const Outcome outcome =
      RunProgram({"calibrate", "response", folder_ / "response.yaml", "--out", other});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto noise = [](const std::string& folder) {
    return nlohmann::json::parse(ReadText(folder + "/response.json"))["radiometry"]["noise"];
  };
  // The pictures have another order, and sums with it other last digits.
  for (const char* key : {"read_noise_dn", "dn_per_electron"}) {
    const double expected = noise(out_)[key];
    EXPECT_NEAR(noise(other)[key], expected, 1e-6 * expected) << key;
  }
}

TEST_F(CalibrateResponse, WhatIsRefused) {
  const std::string before = ReadText(calibration_);
  capture_.frames.resize(6);
  ASSERT_TRUE(rig::WriteRawCapture(capture_, folder_.path()));
  const Outcome few = RunProgram(
      {"calibrate", "response", folder_.path().string(), "--update", calibration_, "--out", out_});
  EXPECT_EQ(few.exit_code, 2);
  EXPECT_THAT(few.err, HasSubstr("at 2 exposures, allowed are at least 3"));
  EXPECT_EQ(ReadText(calibration_), before);
  const Outcome card = RunProgram(
      {"calibrate", "response", folder_.path().string(), "--card", "1,2,3,4", "--out", out_});
  EXPECT_EQ(card.exit_code, 2);
  const Outcome nothing = RunProgram({"calibrate", "response", folder_ / "nothing", "--out", out_});
  EXPECT_EQ(nothing.exit_code, 2);
}

}  // namespace
}  // namespace turnlight::app
