// Proves: what mrcal writes is read, with comments, other keys, tuples and either quote; each way
// for a file to be bad is refused with a message that names file, key, value and what is allowed.
// Does not prove: that no input at all crashes (the fuzz target looks for those).
#include "calib/camera_model_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

#include "base/file.h"
#include "calib/camera_model.h"

extern "C" {
#include <mrcal/mrcal.h>
}

namespace turnlight::calib {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kGood[] = R"({
    'lensmodel':  'LENSMODEL_PINHOLE',
    'extrinsics': [ 0, 0, 0, 0, 0, 0 ],
    'intrinsics': [ 520.5, 521, 159.5, 119.5 ],
    'imagersize': [ 320, 240 ]
}
)";

std::string Replaced(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string ErrorOf(const std::string& text) {
  const auto camera = CameraModel::FromString(text, "lens.cameramodel");
  if (camera) return "accepted";
  EXPECT_EQ(camera.error().kind, ErrorKind::kInput);
  EXPECT_THAT(camera.error().text, HasSubstr("lens.cameramodel"));
  return camera.error().text;
}

TEST(CameraModelText, ReadsWhatMrcalWrites) {
  const std::string text =
      "# generated on some day by\n#   mrcal-calibrate-cameras --outdir \"x\" 'y'\n"
      "# the outliers are { } [ ] \n{\n"
      "    \"lensmodel\":  'LENSMODEL_OPENCV4', # a comment with 'quotes'\n"
      "    'extrinsics': ( -0., 1e-3, 2E+1, .5, 5., -7 ,),\n"
      "    'intrinsics': [ 1761.181055, 1761.250444, 1965.706996, 1087.518797, -0.01266096516,\n"
      "        0.03590794372, -0.0002547045941, 0.0005275929652,],\n"
      "    'valid_intrinsics_region': [\n    [ 294, 43 ],\n    [ 3830, 43 ]\n],\n"
      "    'imagersize': [ 4000, 2200,],\n"
      "    'icam_intrinsics': 0,\n    'nothing': None,\n"
      "    'optimization_inputs': b'P<O*3{}[]#\\n%x\"y',\n}\n\n# the end\n";
  const auto camera = CameraModel::FromString(text, "lens");
  ASSERT_TRUE(camera) << camera.error().text;
  EXPECT_EQ(camera->lens_model(), "LENSMODEL_OPENCV4");
  EXPECT_EQ(camera->width(), 4000);
  EXPECT_EQ(camera->height(), 2200);
  EXPECT_THAT(camera->intrinsics(),
              ElementsAre(1761.181055, 1761.250444, 1965.706996, 1087.518797, -0.01266096516,
                          0.03590794372, -0.0002547045941, 0.0005275929652));
}

// The two readers give the same numbers.
TEST(CameraModelText, AgreesWithMrcalsReader) {
  mrcal_cameramodel_t* read = mrcal_read_cameramodel_string(kGood, sizeof kGood - 1);
  ASSERT_NE(read, nullptr);
  const auto camera = CameraModel::FromString(kGood, "lens");
  ASSERT_TRUE(camera);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(camera->intrinsics()[i], read->intrinsics[i]);
  EXPECT_EQ(camera->width(), static_cast<int>(read->imagersize[0]));
  EXPECT_EQ(camera->height(), static_cast<int>(read->imagersize[1]));
  mrcal_free_cameramodel(&read);
}

std::string LensModelOf(const std::string& text) {
  const auto camera = CameraModel::FromString(text, "lens.cameramodel");
  return camera ? camera->lens_model() : camera.error().text;
}

// Files as other versions of mrcal write them.
TEST(CameraModelText, CasesAreRead) {
  const auto folder = std::filesystem::path(TURNLIGHT_SOURCE_DIR) / "tests/calib/cases";
  for (const auto& [file, lens, count] :
       {std::tuple("old_key.cameramodel", "LENSMODEL_PINHOLE", 4u),
        {"pose_named_rt_cam_ref.cameramodel", "LENSMODEL_OPENCV4", 8u}}) {
    const auto camera = CameraModel::FromFile(folder / file);
    ASSERT_TRUE(camera) << camera.error().text;
    EXPECT_EQ(camera->lens_model(), lens);
    EXPECT_EQ(camera->intrinsics().size(), count);
    EXPECT_EQ(camera->width(), 640);
  }
}

// What mrcal called things before, and what it calls them since 2.5.
TEST(CameraModelText, NamesOfOtherVersions) {
  const std::string model = "'lensmodel':  'LENSMODEL_PINHOLE'";
  for (const char* text :
       {"'distortion_model': 'DISTORTION_NONE'", "'lens_model': 'LENSMODEL_PINHOLE'",
        "'lensmodel': 'DISTORTION_PINHOLE'", "'lensmodel': 'LENSMODEL_NONE'",
        "'lens_model': 'unknown', 'distortion_model': 'DISTORTION_NONE'",
        "'distortion_model': 'unknown', 'lensmodel': 'LENSMODEL_PINHOLE'"})
    EXPECT_EQ(LensModelOf(Replaced(model, text)), "LENSMODEL_PINHOLE") << text;
  EXPECT_EQ(LensModelOf(Replaced(model + ",\n    'extrinsics': [ 0, 0, 0, 0, 0, 0 ],\n    "
                                         "'intrinsics': [ 520.5, 521, 159.5, 119.5 ]",
                                 "'rt_cam_ref': [ 0.1, 0.2, 0.3, 10, 20, 30 ],\n"
                                 "'distortion_model': 'DISTORTION_OPENCV4',\n"
                                 "'intrinsics': [ 900, 901, 320, 240, -0.1, 0.02, 0.0005, 0 ]")),
            "LENSMODEL_OPENCV4");
  EXPECT_EQ(LensModelOf(Replaced("'imagersize'", "'rt_cam_ref': [0, 0, 0, 0, 0, 1], 'imagersize'")),
            "LENSMODEL_PINHOLE");
  EXPECT_THAT(ErrorOf(Replaced("extrinsics': [ 0, ", "rt_cam_ref': [ ")),
              HasSubstr("'rt_cam_ref': 5 numbers"));
  EXPECT_THAT(ErrorOf(Replaced(model, "'distortion_model': 'DISTORTION_FISH'")),
              AllOf(HasSubstr("'lensmodel'"), HasSubstr("'LENSMODEL_FISH'")));
  EXPECT_THAT(ErrorOf(Replaced(model, "'lens_model': 'a', 'lens_model': 'a'")),
              AllOf(HasSubstr("'lens_model'"), HasSubstr("more than once")));
}

TEST(CameraModelText, UnknownLensNamesTheAllowedOnes) {
  EXPECT_THAT(ErrorOf(Replaced("LENSMODEL_PINHOLE", "LENSMODEL_FISHEYE9")),
              AllOf(HasSubstr("'lensmodel'"), HasSubstr("'LENSMODEL_FISHEYE9'"),
                    HasSubstr("LENSMODEL_OPENCV8"), HasSubstr("LENSMODEL_CAHVORE")));
  EXPECT_THAT(ErrorOf(Replaced("LENSMODEL_PINHOLE", "")), HasSubstr("unknown lens model"));
  EXPECT_THAT(ErrorOf(Replaced("LENSMODEL_PINHOLE", std::string("LENSMODEL_PINHOLE\0x", 19))),
              HasSubstr("unknown lens model"));
}

TEST(CameraModelText, MissingKey) {
  for (const char* key : {"lensmodel", "extrinsics", "intrinsics", "imagersize"})
    EXPECT_THAT(ErrorOf(Replaced(key, "x")),
                HasSubstr(std::string("'") + key + "': this key is missing"));
}

TEST(CameraModelText, RepeatedKey) {
  EXPECT_THAT(ErrorOf(Replaced("'imagersize'", "'imagersize': [ 1, 1 ], 'imagersize'")),
              AllOf(HasSubstr("lens.cameramodel:5"), HasSubstr("more than once")));
}

TEST(CameraModelText, WrongCountOfIntrinsics) {
  EXPECT_THAT(ErrorOf(Replaced("119.5 ]", "119.5, 0.1 ]")),
              AllOf(HasSubstr("'intrinsics': 5 numbers"), HasSubstr("LENSMODEL_PINHOLE has 4")));
  EXPECT_THAT(ErrorOf(Replaced("[ 520.5, 521, 159.5, 119.5 ]", "[]")), HasSubstr("0 numbers"));
  EXPECT_THAT(ErrorOf(Replaced("0, 0, 0 ]", "0, 0 ]")), HasSubstr("'extrinsics': 5 numbers"));
}

TEST(CameraModelText, NumbersMustBeFinite) {
  for (const char* number : {"nan", "NaN", "inf", "-inf", "1e999", "0x10", "1_0", "--1", "'1'", ""})
    EXPECT_THAT(ErrorOf(Replaced("520.5", number)),
                AllOf(HasSubstr("lens.cameramodel:4: 'intrinsics'"),
                      HasSubstr("allowed is a finite number")))
        << number;
}

TEST(CameraModelText, FocalLengthMustBePositive) {
  for (const char* number : {"0", "-520"})
    EXPECT_THAT(ErrorOf(Replaced("520.5", number)), HasSubstr("focal length")) << number;
  EXPECT_THAT(ErrorOf(Replaced("521", "-521")), HasSubstr("-521, allowed is a number above 1e-6"));
  EXPECT_THAT(ErrorOf(Replaced("521", "6e-308")), HasSubstr("allowed is a number above 1e-6"));
}

TEST(CameraModelText, ImagerSize) {
  for (const char* side : {"0", "-1", "65537", "1.5", "1e30"})
    EXPECT_THAT(ErrorOf(Replaced("320", side)),
                AllOf(HasSubstr("'imagersize'"), HasSubstr("whole number from 1 to 65536")))
        << side;
  EXPECT_THAT(ErrorOf(Replaced("320, 240", "100000, 100000")),
              HasSubstr("100000, allowed is a whole number from 1 to 65536"));
  EXPECT_THAT(ErrorOf(Replaced("320, 240", "65536, 65536")), HasSubstr("at most 268435456"));
  EXPECT_THAT(ErrorOf(Replaced("320, 240", "320")), HasSubstr("1 numbers, allowed are 2"));
}

TEST(CameraModelText, TruncatedAnywhere) {
  const std::string text = kGood;
  for (std::size_t length = 0; length + 2 < text.size(); ++length)
    EXPECT_NE(ErrorOf(text.substr(0, length)), "accepted") << length;
  EXPECT_THAT(ErrorOf(""), HasSubstr("the text ends"));
  EXPECT_THAT(ErrorOf(text.substr(0, 30)), HasSubstr("closing quote is missing"));
}

TEST(CameraModelText, Junk) {
  std::string junk;
  for (int i = 0; i < 4096; ++i) junk.push_back(static_cast<char>((i * 2654435761u) >> 13));
  EXPECT_THAT(ErrorOf(junk), HasSubstr("allowed is '{'"));
  EXPECT_THAT(ErrorOf(std::string(100, '\0')), HasSubstr("allowed is '{'"));
  EXPECT_THAT(ErrorOf("{" + std::string(100000, '(')), HasSubstr("a text in quotes"));
  EXPECT_THAT(ErrorOf("{ 'x': " + std::string(100000, '(')), HasSubstr("the text ends"));
  EXPECT_THAT(ErrorOf(std::string(kGood) + "x"), HasSubstr("after the closing '}'"));
  EXPECT_THAT(ErrorOf("\x89PNG\r\n\x1a\n"), HasSubstr("allowed is '{'"));
}

TEST(CameraModelText, TooLong) {
  EXPECT_THAT(ErrorOf(std::string(kMaxCameraModelBytes + 1, ' ')),
              HasSubstr("allowed are at most"));
}

// mrcal aborts the process on several of these.
TEST(CameraModelText, HostileConfigurations) {
  const auto error = [](const std::string& name) {
    return ErrorOf(Replaced("LENSMODEL_PINHOLE", name));
  };
  const std::string spline = "LENSMODEL_SPLINED_STEREOGRAPHIC";
  EXPECT_THAT(error(spline), HasSubstr("lacks its configuration"));
  EXPECT_THAT(error(spline + "_order=3"), HasSubstr("lacks its configuration"));
  EXPECT_THAT(error(spline + "_order=1_Nx=9_Ny=9_fov_x_deg=90"), HasSubstr("order must be 2 or 3"));
  EXPECT_THAT(error(spline + "_order=3_Nx=3_Ny=9_fov_x_deg=90"),
              HasSubstr("larger than the order"));
  EXPECT_THAT(error(spline + "_order=3_Nx=9_Ny=9_fov_x_deg=0"), HasSubstr("fov_x_deg"));
  EXPECT_THAT(error(spline + "_order=3_Nx=9_Ny=9_fov_x_deg=360"), HasSubstr("fov_x_deg"));
  EXPECT_THAT(error(spline + "_order=3_Nx=65545_Ny=9_fov_x_deg=90"), HasSubstr("_Nx=9_"));
  EXPECT_THAT(error(spline + "_order=3_Nx=65535_Ny=65535_fov_x_deg=90"),
              HasSubstr("has 8589672454"));
  EXPECT_THAT(error("LENSMODEL_CAHVORE"), HasSubstr("lacks its configuration"));
  EXPECT_THAT(error("LENSMODEL_CAHVORE_linearity=nan"), HasSubstr("finite"));
  EXPECT_THAT(error("LENSMODEL_CAHVORE_linearity=0.5"), HasSubstr("has 12"));
}

TEST(CameraModelText, FromFile) {
  const auto path = std::filesystem::path(testing::TempDir()) / "turnlight_lens.cameramodel";
  ASSERT_TRUE(WriteFileAtomic(path, kGood));
  const auto camera = CameraModel::FromFile(path);
  ASSERT_TRUE(camera) << camera.error().text;
  EXPECT_EQ(camera->width(), 320);
  std::filesystem::remove(path);
  const auto missing = CameraModel::FromFile(path);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().text, HasSubstr("turnlight_lens.cameramodel: cannot open"));
}

}  // namespace
}  // namespace turnlight::calib
