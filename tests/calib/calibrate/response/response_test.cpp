// Proves on files of a simulated mosaic of 12 bits: everything is found in one go, written as the
// radiometry of a rig's calibration, read back to the same values there and in words; pictures that
// do not fit are refused by name. Does not prove the parts' accuracy: they have tests of their own.
#include "calib/calibrate/response/response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/parallel.h"
#include "calib/calibrate/response/response_pictures.h"
#include "rig/session/image_file.h"
#include "tests/calib/calibrate/response/sensor.h"
#include "tests/temporary_folder.h"

namespace turnlight::calib::calibrate::response {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

const cv::Size kPictures(192, 144);

// A mosaic's light: red and blue are weaker, and the corners are darker.
cv::Mat1d Mosaic(double level) {
  cv::Mat1d scene(kPictures);
  for (int row = 0; row < scene.rows; ++row)
    for (int column = 0; column < scene.cols; ++column) {
      const double r = std::hypot(column - 95.5, row - 71.5) / 120.0;
      const double colour = row % 2 == 0 && column % 2 == 0 ? 0.6
                            : row % 2 && column % 2         ? 0.5
                                                            : 1.0;
      scene(row, column) = level * colour * (1.0 - 0.25 * r * r);
    }
  return scene;
}

class ResponseTest : public testing::Test {
 protected:
  ResponseTest() {
    sensor_.black = 100.0;
    list_.source = "list";
    list_.bayer = "RGGB";
    list_.gain_db = 3.0;
    for (double exposure = 1.0 / 32.0; exposure < 1.8; exposure *= std::sqrt(2.0)) {
      ListedGroup group{1000.0 * exposure, {}};
      for (int i = 0; i < 2; ++i) group.images.push_back(Take(Mosaic(0.9), exposure));
      list_.series.push_back(group);
    }
    for (int i = 0; i < 2; ++i) list_.dark.images.push_back(Take(Mosaic(0.0), 1.0));
    for (int i = 0; i < 2; ++i) list_.flat.images.push_back(Take(Mosaic(0.8), 1.0));
    list_.grey_card = GreyCard{{Take(Mosaic(0.7), 1.0)}, {60, 50, 40, 40}};
  }
  fs::path Take(const cv::Mat1d& scene, double exposure) {
    const fs::path file = folder_ / (std::to_string(++taken_) + ".png");
    EXPECT_TRUE(rig::WriteImage(file, Expose(sensor_, scene, exposure, taken_)));
    return file;
  }

  // Of its own: tests run beside each other.
  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  SimulatedSensor sensor_;
  ResponseList list_;
  std::uint64_t taken_ = 0;
};

TEST_F(ResponseTest, EverythingInOneGo) {
  const auto found = CalibrateResponse(list_);
  ASSERT_TRUE(found) << found.error().text;
  const Radiometry& radiometry = found->radiometry;
  EXPECT_EQ(radiometry.encoding, Encoding::kLinear);
  EXPECT_NEAR(radiometry.black, 100.0, 0.1);
  EXPECT_EQ(radiometry.white, 4095.0);
  EXPECT_EQ(found->saturation, 4095.0);
  EXPECT_NEAR(radiometry.white_balance[0], 0.6, 0.005);
  EXPECT_NEAR(radiometry.white_balance[2], 0.5, 0.005);
  ASSERT_TRUE(radiometry.noise);
  EXPECT_NEAR(radiometry.noise->dn_per_electron, sensor_.Gain(), 0.03 * sensor_.Gain());
  EXPECT_NEAR(radiometry.noise->read_noise_dn, 5.0 * sensor_.Gain(), 0.05 * 5.0 * sensor_.Gain());
  EXPECT_EQ(radiometry.noise->gain_db, 3.0);
  ASSERT_TRUE(radiometry.vignetting);
  EXPECT_NEAR(radiometry.vignetting->ShareAt(0.0, 0.0), 0.753, 0.004);
  EXPECT_EQ(found->planes, (std::vector<std::string>{"red", "green", "green (2nd)", "blue"}));
  EXPECT_THAT(found->words, Contains(HasSubstr("linear: ")));
  EXPECT_THAT(found->words, Contains(HasSubstr("DN per electron")));
  EXPECT_GT(DrawPhotonTransfer(*found->transfer, found->planes).rows, 100);
  EXPECT_GT(DrawLinearity(found->curve).rows, 100);
  EXPECT_GT(DrawFlatField(*found->flat, found->size).rows, 100);
}

TEST_F(ResponseTest, TheSameBitsForAnyNumberOfThreads) {
  SetThreads(1);
  const auto one = CalibrateResponse(list_);
  SetThreads(5);
  const auto many = CalibrateResponse(list_);
  SetThreads(0);
  ASSERT_TRUE(one && many);
  EXPECT_EQ(PrintResponse(*one), PrintResponse(*many));
}

TEST_F(ResponseTest, IntoARigsCalibrationAndBack) {
  list_.grey_card.reset();
  const auto found = CalibrateResponse(list_);
  ASSERT_TRUE(found) << found.error().text;
  rig::RigCalibration calibration(CameraModel::Pinhole(192, 144, 300, 300, 95.5, 71.5));
  calibration.devices.resolution = kPictures;
  calibration.radiometry.reference_exposure_us = 777.0;
  calibration.radiometry.white_balance = {0.5, 1.0, 0.7};
  ASSERT_TRUE(ApplyResponse(*found, calibration));
  EXPECT_EQ(calibration.radiometry.reference_exposure_us, 777.0);
  EXPECT_EQ(calibration.radiometry.white_balance[0], 0.5) << "no grey card was taken";
  const fs::path file = folder_ / "rig-calibration.json";
  ASSERT_TRUE(rig::WriteRigCalibration(calibration, file));
  const auto read = rig::ReadRigCalibration(file);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->radiometry.black, found->radiometry.black);
  EXPECT_EQ(read->radiometry.noise->dn_per_electron, found->transfer->dn_per_electron);
  EXPECT_EQ(read->radiometry.noise->gain_db, 3.0);
  EXPECT_EQ(read->noise.read_noise_dn, found->transfer->read_noise_dn);
  EXPECT_EQ(*read->covariances.noise, Eigen::MatrixXd(found->transfer->covariance));
  EXPECT_EQ(read->radiometry.vignetting->coefficients, found->radiometry.vignetting->coefficients);
  // The fragment is what the calibration's file has.
  const auto fragment = nlohmann::json::parse(PrintResponse(*found))["radiometry"];
  const auto written = nlohmann::json::parse(*ReadFile(file))["radiometry"];
  for (const char* key :
       {"encoding", "black", "white", "vignetting", "noise", "covariance", "unit"})
    EXPECT_EQ(fragment[key], written[key]) << key;
  calibration.devices.resolution = {640, 480};
  const Status other = ApplyResponse(*found, calibration);
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().text, HasSubstr("identity/camera/resolution: 640 x 480"));
}

TEST_F(ResponseTest, PicturesThatDoNotFitAreRefused) {
  ResponseList list = list_;
  list.series[3].images.push_back(folder_ / "missing.png");
  const auto missing = CalibrateResponse(list);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().text, HasSubstr("missing.png"));
  ASSERT_TRUE(rig::WriteImage(folder_ / "small.png", cv::Mat(20, 30, CV_16U, cv::Scalar(200))));
  list = list_;
  list.flat.images = {folder_ / "small.png"};
  const auto small = CalibrateResponse(list);
  ASSERT_FALSE(small);
  EXPECT_THAT(small.error().text, HasSubstr("small.png: 30 x 20 pixels, 16 bits"));
  list = list_;
  list.grey_card->rectangle = {180, 10, 40, 40};
  const auto outside = CalibrateResponse(list);
  ASSERT_FALSE(outside);
  EXPECT_THAT(outside.error().text, HasSubstr("grey_card/rectangle"));
  list = list_;
  ASSERT_TRUE(rig::WriteImage(folder_ / "colour.png", cv::Mat(144, 192, CV_8UC3, cv::Scalar(9))));
  list.dark.images = {folder_ / "colour.png"};
  const auto colour = CalibrateResponse(list);
  ASSERT_FALSE(colour);
  EXPECT_THAT(colour.error().text, HasSubstr("bayer"));
}

TEST_F(ResponseTest, ItCanBeStopped) {
  const auto stopped =
      CalibrateResponse(list_, [](std::size_t done, std::size_t) { return done < 2; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kInterrupted);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::response
