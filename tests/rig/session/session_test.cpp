// Proves: a session comes back as it was written, to the last bit of every double; every fault of
// session.json is refused with file, key, value and what is allowed.
// Does not prove: faults of the files that it names; session_files_test.cpp does.
#include "rig/session/session.h"

#include <cmath>

#include "tests/rig/session/fixture.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SessionTest : public SessionFixture {
 protected:
  std::string ReadError() {
    WriteJson();
    const auto session = ReadSession(root());
    EXPECT_FALSE(session) << json_.dump(1);
    if (session) return "";
    EXPECT_EQ(session.error().kind, ErrorKind::kInput);
    EXPECT_THAT(session.error().text, HasSubstr((root() / "session.json").string()));
    return session.error().text;
  }
};

TEST_F(SessionTest, SmallestSessionIsRead) {
  WriteJson();
  const auto session = ReadSession(root());
  ASSERT_TRUE(session) << session.error().text;
  EXPECT_EQ(session->name, "small");
  EXPECT_EQ(session->length_unit, "mm");
  EXPECT_EQ(session->root, root());
  EXPECT_EQ(session->camera->width(), kWidth);
  EXPECT_EQ(std::get<calib::SphereShape>(session->target).radius, 50.0);
  ASSERT_EQ(session->frames.size(), 2u);
  EXPECT_EQ(session->frames[1].angle_deg, 10.0);
  EXPECT_EQ(session->frames[1].X_WC.translation, Eigen::Vector3d(0, 0, -300));
  EXPECT_EQ(session->radiometry.SaturationDn(), 65535.0);
  EXPECT_FALSE(session->radiometry.reference_exposure_us);
  EXPECT_EQ(session->radiometry.reference_gain_db, 0.0);
}

TEST_F(SessionTest, ReferencesComeFromFrameZero) {
  json_["frames"][0]["exposure_us"] = 8000;
  json_["frames"][1]["exposure_us"] = 4000;
  json_["frames"][0]["gain_db"] = 3.0;
  WriteJson();
  auto session = ReadSession(root());
  ASSERT_TRUE(session) << session.error().text;
  EXPECT_EQ(session->radiometry.reference_exposure_us, 8000.0);
  EXPECT_EQ(session->radiometry.reference_gain_db, 3.0);
  EXPECT_EQ(session->frames[1].exposure.gain_db, 3.0);  // not given: the reference
  EXPECT_DOUBLE_EQ(calib::ExposureFactor(session->radiometry, session->frames[1].exposure), 2.0);

  ASSERT_TRUE(WriteSession(*session, root()));
  EXPECT_THAT(Get("session.json"), testing::Not(HasSubstr("reference")));
  session->radiometry.reference_exposure_us = 1000.0;
  session->radiometry.reference_gain_db = 6.0;
  ASSERT_TRUE(WriteSession(*session, root()));
  const auto again = ReadSession(root());
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(again->radiometry.reference_exposure_us, 1000.0);
  EXPECT_EQ(again->radiometry.reference_gain_db, 6.0);
}

// A frame and a session with everything that they can hold, and doubles that have no short decimal.
FrameRecord FullFrame() {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.0 / 3.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  FrameRecord frame;
  frame.image = "frames/000.png";
  frame.mask = "frames/mask.png";
  frame.validity = "frames/mask.png";
  frame.angle_deg = 0.1 + 0.2;
  frame.angle_measured_deg = 1e-300;
  frame.exposure = {8000.1, 0.3};
  frame.has_gain = true;
  frame.X_WC = {turn, Eigen::Vector3d(0.1, -1e17, 1.0 / 3.0)};
  frame.X_WT = {turn.transpose(), Eigen::Vector3d(-0.0, 5e-324, 0.7)};
  frame.sha256 = std::string(64, 'a');
  return frame;
}
Session FullSession() {
  Session session;
  session.name = "everything \"quoted\" \xc3\xa9";
  session.length_unit = "m";
  session.camera_path = "calibration/left.cameramodel";
  session.camera = calib::CameraModel::Pinhole(kWidth, kHeight, 20.0 / 3.0, 21.0 / 7.3, 7.1, 5.3);
  session.radiometry.encoding = calib::Encoding::kGamma;
  session.radiometry.gamma = 1.0 / 0.45;
  session.radiometry.black = 64.1;
  session.radiometry.white = 65000.3;
  session.radiometry.saturation = 64000.7;
  session.radiometry.reference_exposure_us = 1.0 / 3.0;
  session.radiometry.reference_gain_db = -0.1;
  session.radiometry.white_balance = {1.1, 1.0, 1.0 / 1.7};
  session.radiometry.vignetting = calib::Vignetting{7.1, 5.3, 100.0 / 3.0, {-0.1, 0.02 / 3.0}};
  session.radiometry.noise = calib::NoiseModel{1.0 / 3.0, 0.1, 0.7};
  session.bayer = "GBRG";
  session.target = calib::PlaneShape{200.1, 150.3, 2};
  session.frames = {FullFrame(), FullFrame()};
  return session;
}

void ExpectSame(const calib::Radiometry& read, const calib::Radiometry& written) {
  EXPECT_EQ(read.encoding, written.encoding);
  EXPECT_EQ(read.gamma, written.gamma);
  EXPECT_EQ(read.black, written.black);
  EXPECT_EQ(read.white, written.white);
  EXPECT_EQ(read.saturation, written.saturation);
  EXPECT_EQ(read.reference_exposure_us, written.reference_exposure_us);
  EXPECT_EQ(read.reference_gain_db, written.reference_gain_db);
  EXPECT_EQ(read.white_balance, written.white_balance);
  ASSERT_TRUE(read.vignetting && read.noise);
  EXPECT_EQ(read.vignetting->center_x, written.vignetting->center_x);
  EXPECT_EQ(read.vignetting->center_y, written.vignetting->center_y);
  EXPECT_EQ(read.vignetting->radius, written.vignetting->radius);
  EXPECT_EQ(read.vignetting->coefficients, written.vignetting->coefficients);
  EXPECT_EQ(read.noise->read_noise_dn, written.noise->read_noise_dn);
  EXPECT_EQ(read.noise->dn_per_electron, written.noise->dn_per_electron);
  EXPECT_EQ(read.noise->gain_db, written.noise->gain_db);
}

void ExpectSame(const FrameRecord& read, const FrameRecord& written) {
  EXPECT_EQ(read.image, written.image);
  EXPECT_EQ(read.mask, written.mask);
  EXPECT_EQ(read.validity, written.validity);
  EXPECT_EQ(read.angle_deg, written.angle_deg);
  EXPECT_EQ(read.angle_measured_deg, written.angle_measured_deg);
  EXPECT_EQ(read.exposure.exposure_us, written.exposure.exposure_us);
  EXPECT_EQ(read.exposure.gain_db, written.exposure.gain_db);
  EXPECT_TRUE(read.has_gain);
  EXPECT_EQ(calib::RowsFromPose(read.X_WC), calib::RowsFromPose(written.X_WC));
  EXPECT_EQ(calib::RowsFromPose(read.X_WT), calib::RowsFromPose(written.X_WT));
  EXPECT_TRUE(std::signbit(read.X_WT.translation.x()));
  EXPECT_EQ(read.sha256, written.sha256);
}

TEST_F(SessionTest, WriteThenReadGivesTheSame) {
  const Session written = FullSession();
  const auto status = WriteSession(written, root());
  ASSERT_TRUE(status) << status.error().text;

  const auto read = ReadSession(root());
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->name, written.name);
  EXPECT_EQ(read->length_unit, written.length_unit);
  EXPECT_EQ(read->camera_path, written.camera_path);
  EXPECT_EQ(read->camera->intrinsics(), written.camera->intrinsics());
  ExpectSame(read->radiometry, written.radiometry);
  EXPECT_EQ(read->bayer, written.bayer);
  const auto& plane = std::get<calib::PlaneShape>(read->target);
  EXPECT_EQ(std::tie(plane.width, plane.height), std::tuple(200.1, 150.3));
  EXPECT_EQ(plane.sides, 2);
  ASSERT_EQ(read->frames.size(), 2u);
  ExpectSame(read->frames[1], written.frames[1]);

  const std::string bytes = Get("session.json");
  ASSERT_TRUE(WriteSession(*read, root()));
  EXPECT_EQ(Get("session.json"), bytes);
}

TEST_F(SessionTest, WriteRefusesWhatReadWouldRefuse) {
  WriteJson();
  const Session good = ReadSession(root()).value();
  const std::string before = Get("session.json");
  const auto error = [&](const Session& session) {
    const Status status = WriteSession(session, root());
    return status ? "" : status.error().text;
  };
  Session bad = good;
  bad.frames[1].X_WT.rotation(0, 0) = std::nan("");
  EXPECT_THAT(error(bad), HasSubstr("frames/1/X_WT"));
  bad = good;
  bad.camera_path = "../camera.cameramodel";
  EXPECT_THAT(error(bad), HasSubstr("\"..\""));
  bad = good;
  bad.frames.clear();
  EXPECT_THAT(error(bad), HasSubstr("at least 1"));
  bad = good;
  bad.camera.reset();
  EXPECT_THAT(error(bad), HasSubstr("camera: missing"));
  EXPECT_EQ(Get("session.json"), before);
}

TEST_F(SessionTest, MissingSessionIsNamed) {
  const auto session = ReadSession(root() / "nowhere");
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().text, HasSubstr("nowhere/session.json"));
}

TEST_F(SessionTest, UnknownKeysAreRefusedEverywhere) {
  const nlohmann::json good = json_;
  for (const char* pointer : {"", "/radiometry", "/target", "/frames/1"}) {
    json_ = good;
    json_[nlohmann::json::json_pointer(pointer)]["colour"] = 1;
    const std::string key = std::string(pointer).empty() ? "" : std::string(pointer + 1) + "/";
    EXPECT_THAT(ReadError(),
                AllOf(HasSubstr(key + "colour: unknown key"), HasSubstr("allowed are")));
  }
  json_ = good;
  json_["radiometry"]["encoding"] = {{"gamma", 2.2}, {"offset", 1}};
  EXPECT_THAT(ReadError(), HasSubstr("radiometry/encoding/offset: unknown key"));
}

TEST_F(SessionTest, KeysOfExtensionsAreAllowedEverywhere) {
  json_["radiometry"]["encoding"] = {{"gamma", 2.2}, {"x-from", "chart"}};
  for (const char* pointer : {"", "/radiometry", "/target", "/frames/1"})
    json_[nlohmann::json::json_pointer(pointer)]["x-lab"] = {{"any", {1, "thing"}}};
  WriteJson();
  const auto session = ReadSession(root());
  EXPECT_TRUE(session) << session.error().text;
}

TEST_F(SessionTest, OtherVersionsAndFormatsAreRefused) {
  json_["version"] = 2;
  json_["novelty"] = "of version 2";
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("version: 2"), HasSubstr("1, the version")));
  json_["format"] = "another-session";
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("another-session"), HasSubstr("turnlight-session")));
}

TEST_F(SessionTest, NoFramesAreRefused) {
  json_["frames"] = nlohmann::json::array();
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames: []"), HasSubstr("at least 1")));
  json_.erase("frames");
  EXPECT_THAT(ReadError(), HasSubstr("frames: this key is missing"));
}

TEST_F(SessionTest, NanPoseIsRefused) {
  std::string text = json_.dump();
  const std::size_t at = text.rfind("-300");
  ASSERT_NE(at, std::string::npos);
  Put("session.json", text.replace(at, 4, "NaN"));
  auto session = ReadSession(root());
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().text, AllOf(HasSubstr("session.json"), HasSubstr("X_WT holds NaN"),
                                          HasSubstr("allowed are finite numbers")));
  json_["frames"][1]["X_WT"][2][3] = nullptr;  // what many writers make of NaN
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames/1/X_WT"), HasSubstr("null"),
                                 HasSubstr("3 rows of 4 finite numbers")));
}

TEST_F(SessionTest, ReflectedAndSkewedPosesAreRefused) {
  json_["frames"][1]["X_WC"] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -1, 0}};
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames/1/X_WC"), HasSubstr("determinant is -1"),
                                 HasSubstr("allowed is +1")));
  json_["frames"][1]["X_WC"] = {{1, 0.01, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames/1/X_WC"), HasSubstr("orthonormal")));
  json_["frames"][1]["X_WC"] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_THAT(ReadError(), HasSubstr("3 rows of 4"));
}

TEST_F(SessionTest, ExposureOnSomeFramesIsRefused) {
  json_["frames"][1]["exposure_us"] = 8000;
  EXPECT_THAT(ReadError(),
              AllOf(HasSubstr("frames/0/exposure_us: missing"), HasSubstr("frames/1 has one"),
                    HasSubstr("all frames or on none")));
  json_["frames"][0]["exposure_us"] = 8000;
  json_["frames"][1].erase("exposure_us");
  EXPECT_THAT(ReadError(), HasSubstr("frames/1/exposure_us: missing"));
  json_["frames"][1]["exposure_us"] = 0;
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames/1/exposure_us: 0"), HasSubstr("above 0")));
}

TEST_F(SessionTest, ACurveComesBackToTheBit) {
  Session session = FullSession();
  session.radiometry.encoding = calib::Encoding::kCurve;
  session.radiometry.curve = {
      {0.0, 0.0}, {1.0 / 3.0, 0.1}, {0.7, std::nextafter(0.1, 1.0)}, {1.0, 1.0}};
  ASSERT_TRUE(WriteSession(session, root()));
  const auto read = ReadSession(root());
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->radiometry.encoding, calib::Encoding::kCurve);
  EXPECT_EQ(read->radiometry.curve, session.radiometry.curve);
}

TEST_F(SessionTest, ValuesOutOfRangeAreRefused) {
  struct BadValue {
    const char* pointer;
    nlohmann::json value;
    const char* says;
  };
  const nlohmann::json good = json_;
  for (const BadValue& bad : std::vector<BadValue>{
           {"/radiometry/white", 0, "white: 0, allowed is a finite number above black"},
           {"/radiometry/saturation", -1, "saturation: -1, allowed"},
           {"/radiometry/encoding", "log", "encoding: \"log\", allowed is \"linear\""},
           {"/radiometry/encoding", {{"gamma", 0}}, "encoding/gamma: 0, allowed"},
           {"/radiometry/encoding",
            {{"curve", {{0, 0}, {0.5, 0.6}, {0.4, 0.7}, {1, 1}}}},
            "encoding/curve: allowed are 2 to 4096 points"},
           {"/radiometry/encoding", {{"curve", {{0, 0}, {0.9, 0.9}}}}, "from [0, 0] to [1, 1]"},
           {"/radiometry/encoding", {{"curve", {{0, 0}, {1, 1}}}, {"gamma", 2}}, "unknown key"},
           {"/radiometry/vignetting",
            {{"center", {1, 2}}, {"radius", 9}, {"coefficients", {-0.96}}},
            "a share of light of 0.05 to 2"},
           {"/radiometry/vignetting",
            {{"center", {1, 2}}, {"radius", 0}, {"coefficients", {0.1}}},
            "vignetting/radius: 0, allowed"},
           {"/radiometry/noise",
            {{"read_noise_dn", 0}, {"dn_per_electron", 0}},
            "a number above 0"},
           {"/radiometry/noise", {{"read_noise_dn", 1}}, "dn_per_electron"},
           {"/radiometry/white_balance", {1, 0, 1}, "white_balance: [1,0,1], allowed"},
           {"/radiometry/bayer", "RGBG", "bayer: \"RGBG\", allowed is one of RGGB"},
           {"/radiometry/reference_exposure_us", 0, "reference_exposure_us: 0, allowed"},
           {"/target/shape", "cone", "shape: \"cone\", allowed is one of sphere"},
           {"/target/radius", -50, "radius: -50, allowed is a finite number above 0"},
           {"/target",
            {{"shape", "plane"}, {"size", {200}}},
            "size: [200], allowed is a list of 2"},
           {"/target", {{"shape", "plane"}, {"size", {2, 1}}, {"sides", 3}}, "sides: 3, allowed"},
           {"/length_unit", "milli metre", "length_unit: \"milli metre\", allowed is a word"},
           {"/frames/0/sha256", "ABC", "frames/0/sha256: \"ABC\", allowed is 64"},
           {"/frames/0/image", 7, "frames/0/image: 7, allowed is a text"},
           {"/camera", "", "camera: \"\" is empty"}}) {
    json_ = good;
    json_[nlohmann::json::json_pointer(bad.pointer)] = bad.value;
    EXPECT_THAT(ReadError(), HasSubstr(bad.says));
  }
}

}  // namespace
}  // namespace turnlight::rig
