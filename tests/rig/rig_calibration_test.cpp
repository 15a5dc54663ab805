// Proves: a rig's calibration comes back from its file bit for bit, covariances and all; every
// wrong value is refused by file, key, value and what is allowed; a calibration of other devices or
// other pictures is refused and told apart. Does not prove: that any rig's numbers are right.
#include "rig/rig_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "tests/temporary_folder.h"

namespace turnlight::rig {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

Eigen::MatrixXd Covariance(Eigen::Index size) {
  Eigen::MatrixXd root(size, size);
  for (Eigen::Index i = 0; i < root.size(); ++i)
    root.data()[i] = std::sin(1.0 + static_cast<double>(i)) / 3.0;
  const Eigen::MatrixXd product = root * root.transpose();
  return 0.5 * (product + product.transpose());
}

calib::Pose PoseOf(double angle, const Eigen::Vector3d& translation) {
  calib::Pose pose = calib::Turn(Eigen::Vector3d(1, -2, 0.5).normalized(), angle);
  pose.translation = translation;
  return pose;
}

// No number of it is short in decimals.
RigCalibration Example() {
  RigCalibration calibration(calib::CameraModel::Pinhole(640, 480, 700.1, 701.3, 320, 239));
  calibration.length_unit = "m";
  calibration.geometry = {PoseOf(0.1, {0.1, 1.0 / 3.0, 0.7}), PoseOf(0.2, {1e-3, -0.0, 2.0 / 7.0}),
                          PoseOf(0.3, {0.01, 0.02, -1e-17}), 1.0 + 1e-15, -0.1};
  calibration.radiometry.black = 64.0 / 3.0;
  calibration.radiometry.white = 4095.7;
  calibration.radiometry.saturation = 4000.1;
  calibration.radiometry.reference_exposure_us = 8000.3;
  calibration.radiometry.reference_gain_db = 0.1;
  calibration.radiometry.white_balance = {1.1, 1.0, 0.9};
  calibration.noise = {3.3, 0.7, 1.5};
  calibration.devices = {
      {"Maker", "C", "77"},          {"Other", "T", ""}, {640, 480}, {8, 16}, {2, 2},
      "50 mm, focused at 0.5 m, f/8"};
  CalibrationCovariances& known = calibration.covariances;
  known.camera_model = Covariance(4);
  known.X_WC = Covariance(6);
  known.X_WA = Covariance(6);
  known.X_AT = Covariance(6);
  known.angle_scale = Covariance(1);
  known.angle_offset = Covariance(1);
  known.radiometry = Covariance(2);
  known.noise = Covariance(2);
  calibration.radiometry.noise = calib::NoiseModel{3.3, 0.7, 0.1};
  Eigen::MatrixXd joint = Covariance(7);
  known.X_WC = joint.topLeftCorner(6, 6);
  known.angle_scale = joint.bottomRightCorner(1, 1);
  known.joint = JointCovariance{{"X_WC", "angle_scale"}, std::move(joint)};
  return calibration;
}

// The bits of all that the file holds, in order.
std::string Bits(const RigCalibration& calibration) {
  std::string bits = calibration.length_unit + calibration.lens.ToString();
  const auto add = [&bits](double value) {
    bits.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const auto& geometry = calibration.geometry;
  for (const calib::Pose& pose : {geometry.X_WC, geometry.X_WA, geometry.X_AT})
    for (const double value : calib::RowsFromPose(pose)) add(value);
  add(geometry.angle_scale);
  add(geometry.angle_offset_deg);
  const auto& radiometry = calibration.radiometry;
  for (const double value : {radiometry.black, radiometry.white, *radiometry.saturation,
                             *radiometry.reference_exposure_us, *radiometry.reference_gain_db})
    add(value);
  for (const double value : radiometry.white_balance) add(value);
  add(calibration.noise.read_noise_dn);
  add(calibration.noise.dn_per_electron);
  add(*calibration.noise.black_limit_dn);
  add(radiometry.noise->read_noise_dn);
  add(radiometry.noise->dn_per_electron);
  add(*radiometry.noise->gain_db);
  const CalibrationCovariances& known = calibration.covariances;
  for (const auto& matrix :
       {known.camera_model, known.X_WC, known.X_WA, known.X_AT, known.angle_scale,
        known.angle_offset, known.radiometry, known.noise}) {
    bits += matrix ? "covariance" : "none";
    for (Eigen::Index i = 0; matrix && i < matrix->size(); ++i) add(matrix->data()[i]);
  }
  if (known.joint) {
    for (const std::string& part : known.joint->of) bits += part;
    for (Eigen::Index i = 0; i < known.joint->matrix.size(); ++i)
      add(known.joint->matrix.data()[i]);
  }
  const CalibratedDevices& devices = calibration.devices;
  for (const DeviceIdentity& device : {devices.camera, devices.table})
    bits += device.vendor + "," + device.model + "," + device.serial + ";";
  for (const int value :
       {devices.resolution.width, devices.resolution.height, devices.roi_offset[0],
        devices.roi_offset[1], devices.binning[0], devices.binning[1]})
    bits += std::to_string(value) + " ";
  return bits + devices.lens;
}

class RigCalibrationTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(WriteRigCalibration(Example(), path_)); }

  // What is said of the file, as if written by hand, when it has that value under a pointer;
  // without it if null.
  std::string Refusal(const std::string& pointer, const json& value) const {
    json root = json::parse(*ReadFile(path_));
    root.erase("sha256");
    if (value.is_null()) {
      const json::json_pointer at(pointer);
      root.at(at.parent_pointer()).erase(at.back());
    } else {
      root[json::json_pointer(pointer)] = value;
    }
    const std::string changed = folder_ / "changed.json";
    EXPECT_TRUE(WriteFileAtomic(changed, root.dump()));
    const auto read = ReadRigCalibration(changed);
    if (read) return "accepted";
    EXPECT_EQ(read.error().kind, ErrorKind::kInput);
    EXPECT_THAT(read.error().text, StartsWith(changed + ": "));
    return read.error().text.substr(changed.size() + 2);
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_ / "rig-calibration.json";
};

TEST_F(RigCalibrationTest, ComesBackBitForBit) {
  const auto read = ReadRigCalibration(path_);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_TRUE(Bits(*read) == Bits(Example()));
  EXPECT_EQ(read->source, path_);
  const std::string again = folder_ / "again/rig-calibration.json";
  ASSERT_TRUE(MakeDirectory(folder_ / "again"));
  ASSERT_TRUE(WriteRigCalibration(*read, again));
  EXPECT_EQ(*ReadFile(again), *ReadFile(path_));
  EXPECT_EQ(*ReadFile(folder_ / "again/rig-calibration.cameramodel"),
            *ReadFile(folder_ / "rig-calibration.cameramodel"));
}

TEST_F(RigCalibrationTest, WhatIsOptionalMayBeMissing) {
  json root = json::parse(*ReadFile(path_));
  for (const char* part :
       {"camera_model", "X_WC", "X_WA", "X_AT", "angle_scale", "angle_offset", "radiometry"})
    root[part].erase("covariance");
  root.erase("joint_covariance");
  for (const char* key :
       {"saturation", "reference_exposure_us", "reference_gain_db", "white_balance", "noise"})
    root["radiometry"].erase(key);
  root["identity"].erase("lens");
  root.erase("sha256");
  root["identity"]["camera"].erase("roi_offset");
  root["identity"]["camera"].erase("binning");
  ASSERT_TRUE(WriteFileAtomic(path_, root.dump()));
  const auto read = ReadRigCalibration(path_);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_FALSE(read->covariances.X_WC);
  EXPECT_EQ(read->devices.binning, (std::array{1, 1}));
  EXPECT_EQ(read->noise.read_noise_dn, SensorNoise{}.read_noise_dn);
  EXPECT_FALSE(read->radiometry.noise) << "what nobody measured weighs no pixels";
  ASSERT_TRUE(WriteRigCalibration(*read, path_));
  EXPECT_FALSE(json::parse(*ReadFile(path_))["radiometry"].contains("noise"));
}

TEST_F(RigCalibrationTest, TheTargetMayHaveNoPlaceYet) {
  RigCalibration calibration = Example();
  EXPECT_TRUE(CheckTargetPlaced(calibration));
  calibration.target_placed = false;
  calibration.covariances.X_AT.reset();
  ASSERT_TRUE(WriteRigCalibration(calibration, path_));
  EXPECT_FALSE(json::parse(*ReadFile(path_)).contains("X_AT"));
  const auto read = ReadRigCalibration(path_);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_FALSE(read->target_placed);
  EXPECT_EQ(CheckTargetPlaced(*read).error().text,
            path_ +
                ": X_AT: this key is missing, as the target's place on the table is not "
                "calibrated yet; turnlight calibrate target finds it");
}

TEST_F(RigCalibrationTest, AJointCovarianceRepeatsThoseOfItsParts) {
  const std::string key = "/joint_covariance";
  EXPECT_THAT(Refusal(key + "/of", json::array({"X_WC", "lens"})),
              AllOf(StartsWith("joint_covariance/of"), HasSubstr("X_WC, X_WA, X_AT")));
  EXPECT_THAT(Refusal(key + "/of", json::array({"X_WC", "X_WC"})), HasSubstr("each once"));
  EXPECT_THAT(Refusal(key + "/of", json::array({"X_WC"})), HasSubstr("two or more"));
  EXPECT_THAT(Refusal(key + "/of", "X_WC"), HasSubstr("a list"));
  EXPECT_THAT(Refusal(key + "/of", nullptr), StartsWith("joint_covariance/of: "));
  EXPECT_THAT(Refusal(key + "/of", json::array({"X_WC", "X_WA"})), HasSubstr("12 rows of 12"));
  EXPECT_EQ(Refusal("/angle_scale/covariance/0/0", 0.5),
            "joint_covariance/matrix: its block of angle_scale is not angle_scale/covariance, "
            "allowed is the same");
  EXPECT_THAT(Refusal(key + "/matrix/0/6", 1e3), HasSubstr("symmetric"));
  EXPECT_THAT(Refusal(key + "/units", "mm"), HasSubstr("unknown key"));
}

TEST_F(RigCalibrationTest, EveryKeyThatIsNotOptionalMustBeThere) {
  for (const std::string key : {"/format",
                                "/version",
                                "/camera_model",
                                "/camera_model/path",
                                "/camera_model/sha256",
                                "/camera_model/unit",
                                "/X_WC",
                                "/X_WC/value",
                                "/X_WC/unit",
                                "/X_WA",
                                "/angle_scale",
                                "/angle_scale/value",
                                "/angle_scale/unit",
                                "/angle_offset",
                                "/radiometry",
                                "/radiometry/black",
                                "/radiometry/white",
                                "/radiometry/unit",
                                "/identity",
                                "/identity/camera",
                                "/identity/table",
                                "/identity/camera/vendor",
                                "/identity/table/serial",
                                "/identity/camera/resolution"})
    EXPECT_THAT(Refusal(key, nullptr),
                StartsWith(key.substr(1) + ": this key is missing, allowed is "));
}

TEST_F(RigCalibrationTest, WrongValuesAreRefusedByKeyAndWhatIsAllowed) {
  EXPECT_THAT(Refusal("/format", "turnlight-session"), HasSubstr("turnlight-rig-calibration"));
  EXPECT_EQ(Refusal("/version", 2),
            "version: 2, allowed is 1, the version that this program reads");
  EXPECT_THAT(Refusal("/length_unit", "a mile"), HasSubstr("a word without spaces"));
  EXPECT_EQ(Refusal("/X_WC/unit", "mm"),
            "X_WC/unit: \"mm\", allowed is \"m\", the unit of this number in this file");
  EXPECT_THAT(Refusal("/angle_offset/unit", "rad"), HasSubstr("allowed is \"deg\""));
  EXPECT_THAT(Refusal("/radiometry/unit", "e-"), HasSubstr("allowed is \"DN\""));
  EXPECT_THAT(Refusal("/X_WA/value", json::array({1, 2})), HasSubstr("3 rows of 4"));
  EXPECT_THAT(Refusal("/X_AT/value/0/0", 2.0), HasSubstr("not orthonormal"));
  EXPECT_EQ(Refusal("/angle_scale/value", 0.0),
            "angle_scale/value: 0, allowed is any other number");
  EXPECT_THAT(Refusal("/X_WC/covariance", json::array({json::array({1.0})})),
              AllOf(StartsWith("X_WC/covariance"), HasSubstr("6 rows of 6")));
  EXPECT_EQ(Refusal("/angle_scale/covariance/0/0", -1.0),
            "angle_scale/covariance: a variance is negative, allowed is 0 or more");
  EXPECT_EQ(Refusal("/radiometry/covariance/0/1", 9.0),
            "radiometry/covariance: rows and columns differ, allowed is a symmetric matrix");
  EXPECT_THAT(Refusal("/radiometry/white", 1.0), HasSubstr("above black"));
  EXPECT_THAT(Refusal("/radiometry/noise/read_noise_dn", -1), HasSubstr("read_noise_dn: -1"));
  EXPECT_THAT(Refusal("/identity/camera/resolution", json::array({640, 479})),
              "identity/camera/resolution: 640 x 479, allowed is the camera model's, 640 x 480");
  EXPECT_THAT(Refusal("/identity/camera/binning", json::array({0, 1})), HasSubstr("binning"));
  EXPECT_THAT(Refusal("/identity/camera/roi_offset", json::array({0.5, 1})),
              HasSubstr("2 whole numbers"));
  EXPECT_THAT(Refusal("/angle_ofset", 1), HasSubstr("unknown key"));
}

TEST_F(RigCalibrationTest, TheLensIsTheOneThatItWasMadeWith) {
  EXPECT_THAT(Refusal("/camera_model/path", "other.cameramodel"),
              AllOf(StartsWith("camera_model/path: "), HasSubstr("other.cameramodel")));
  EXPECT_THAT(Refusal("/camera_model/sha256", std::string(64, 'a')),
              AllOf(StartsWith("camera_model/sha256: "),
                    EndsWith("allowed is the file that the calibration was made with")));
  EXPECT_THAT(Refusal("/camera_model/sha256", "abc"), HasSubstr("64 lower-case"));
}

TEST_F(RigCalibrationTest, AFileThatWasChangedIsRefused) {
  json root = json::parse(*ReadFile(path_));
  ASSERT_TRUE(WriteFileAtomic(path_, root.dump(4)));
  EXPECT_TRUE(ReadRigCalibration(path_)) << "laid out otherwise, and nothing is changed";
  const std::string made = root["sha256"];
  root["X_WC"]["value"][0][3] = 0.25;
  ASSERT_TRUE(WriteFileAtomic(path_, root.dump()));
  const auto read = ReadRigCalibration(path_);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::kInput);
  EXPECT_THAT(read.error().text,
              AllOf(StartsWith(path_ + ": sha256: \"" + made + "\", of the rest of the file it is"),
                    HasSubstr("changed after it was made; if that was meant, remove the key")));
  root.erase("sha256");
  ASSERT_TRUE(WriteFileAtomic(path_, root.dump()));
  EXPECT_TRUE(ReadRigCalibration(path_));
}

TEST_F(RigCalibrationTest, APartThatWasFoundWithAnotherLensIsStale) {
  RigCalibration calibration = Example();
  MarkFound(calibration, {"X_WC", "angle_scale", "X_AT"});
  ASSERT_TRUE(WriteRigCalibration(calibration, path_));
  const auto fresh = ReadRigCalibration(path_);
  ASSERT_TRUE(fresh) << fresh.error().text;
  EXPECT_EQ(fresh->found_with, calibration.found_with);
  calibration.lens = calib::CameraModel::Pinhole(640, 480, 702.0, 701.3, 320, 239);
  ASSERT_TRUE(WriteRigCalibration(calibration, path_));
  const auto stale = ReadRigCalibration(path_);
  ASSERT_FALSE(stale);
  EXPECT_THAT(stale.error().text,
              AllOf(StartsWith(path_ + ": X_WC/with: X_WC was found with another lens"),
                    EndsWith("turnlight calibrate axis finds it anew")));
  MarkFound(calibration, {"X_WC", "angle_scale"});
  ASSERT_TRUE(WriteRigCalibration(calibration, path_));
  EXPECT_THAT(ReadRigCalibration(path_).error().text,
              AllOf(HasSubstr("X_AT was found with another lens"),
                    EndsWith("turnlight calibrate target finds it anew")));
}

TEST_F(RigCalibrationTest, TheSameKeysMayStandInAConfig) {
  json root = json::parse(*ReadFile(path_));
  root.erase("format");
  root.erase("version");
  root.erase("sha256");
  const auto document = ParseYaml("calibration: " + root.dump(), "c.yaml");
  ASSERT_TRUE(document) << document.error().text;
  StrictObject config(*document);
  const auto read = ReadRigCalibration(config.Object("calibration"), folder_.path());
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_TRUE(Bits(*read) == Bits(Example()));
  EXPECT_EQ(read->source, "c.yaml:1: calibration");
}

TEST(RigCalibrationOfOthers, IsRefusedNamingWhatDiffers) {
  RigCalibration calibration = Example();
  calibration.source = "r.json";
  const DeviceIdentity camera{"Maker", "C", "77"}, table{"Other", "T", ""};
  EXPECT_TRUE(CheckIdentity(calibration, camera, table));
  EXPECT_EQ(CheckIdentity(calibration, {"Maker", "C", "78"}, table).error().text,
            "r.json: identity/camera/serial: \"77\", the camera that was opened says \"78\"; "
            "allowed is a calibration of these devices");
  EXPECT_THAT(CheckIdentity(calibration, camera, {"Other", "U", ""}).error().text,
              HasSubstr("identity/table/model: \"T\", the table that was opened says \"U\""));
  EXPECT_THAT(CheckIdentity(calibration, {"Fake", "C", "77"}, table).error().text,
              HasSubstr("identity/camera/vendor"));
}

TEST(RigCalibrationOfOthers, PicturesOfAnotherRegionAreRefused) {
  RigCalibration calibration = Example();
  calibration.source = "r.json";
  CameraDevice camera;
  camera.format.size = {640, 480};
  camera.roi_offset = {8, 16};
  camera.binning = {2, 2};
  EXPECT_TRUE(CheckPictures(calibration, camera));
  camera.lens = calibration.devices.lens;
  EXPECT_TRUE(CheckPictures(calibration, camera));
  camera.lens = "35 mm";
  EXPECT_EQ(CheckPictures(calibration, camera).error().text,
            "r.json: identity/lens: \"50 mm, focused at 0.5 m, f/8\", this config's "
            "rig/camera/lens is \"35 mm\"; allowed is a calibration made with this lens, as it is "
            "set now");
  camera.lens.clear();
  camera.format.size.width = 320;
  EXPECT_EQ(CheckPictures(calibration, camera).error().text,
            "r.json: identity/camera/resolution: 640 x 480, this config's camera gives 320 x 480; "
            "allowed is a calibration made with these pictures");
  camera.format.size.width = 640;
  camera.roi_offset = {8, 0};
  EXPECT_THAT(CheckPictures(calibration, camera).error().text, HasSubstr("roi_offset: 8 x 16"));
  camera.roi_offset = {8, 16};
  camera.binning = {1, 2};
  EXPECT_THAT(CheckPictures(calibration, camera).error().text, HasSubstr("binning: 2 x 2"));
  camera.binning = {2, 2};
  camera.full_scale_dn = {{2048.0, 4095.0}};
  EXPECT_TRUE(CheckPictures(calibration, camera));
  camera.full_scale_dn = {{128.0, 255.0}};
  EXPECT_EQ(CheckPictures(calibration, camera).error().text,
            "r.json: radiometry/saturation: 4000.1, a full pixel of this config's camera reads at "
            "most 255; allowed is 128..255, or another pixel_format");
}

}  // namespace
}  // namespace turnlight::rig
