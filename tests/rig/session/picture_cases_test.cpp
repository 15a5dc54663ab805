// Proves: each file in cases/, made after what people reported of other tools, is read as its owner
// would want it or refused with words that name the true cause; a session that holds it says so
// when it is verified. Does not prove: other files of these kinds; the tests of the formats do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rig/session/session.h"
#include "tests/rig/session/fixture.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

std::string CaseBytes(const std::string& name) {
  return ReadFile(fs::path(TURNLIGHT_SOURCE_DIR) / "tests/rig/session/cases" / name).value();
}

Result<Picture> CasePicture(const std::string& name) {
  return DecodePicture(CaseBytes(name), name);
}

// All cases are of the fixture's 16 x 12 pixels.
class PictureCases : public SessionFixture {
 protected:
  // What verify says of a session whose frames are this case.
  VerifyReport Verified(const std::string& name) {
    for (auto& frame : json_["frames"]) frame["image"] = "frames/" + name;
    Put("frames/" + name, CaseBytes(name));
    WriteJson();
    return VerifySession(root()).value();
  }
};

TEST_F(PictureCases, EncodingsThatContradictTheSession) {
  for (const auto& [name, said, set] :
       {std::tuple("srgb_chunk.png", "the sRGB chunk says that the values are sRGB encoded",
                   "set \"encoding\": \"srgb\""),
        {"gamma_chunk.png",
         "the gAMA chunk (45455) says that the values are encoded with gamma 2.2",
         "set \"encoding\": {\"gamma\": 2.2}"}}) {
    const VerifyReport report = Verified(name);
    EXPECT_THAT(report.problems, testing::IsEmpty());
    EXPECT_THAT(report.remarks,
                Contains(AllOf(HasSubstr("2 of 2 pictures, the first is frames/"), HasSubstr(name),
                               HasSubstr(said), HasSubstr("says linear"), HasSubstr(set))));
    json_["radiometry"]["encoding"] = "srgb";
    EXPECT_THAT(Verified(name).remarks, testing::Not(Contains(HasSubstr("encoding"))));
    json_["radiometry"]["encoding"] = "linear";
  }
}

TEST_F(PictureCases, APictureTurnedByExif) {
  const VerifyReport report = Verified("turned_by_exif.png");
  EXPECT_EQ(report.problems.size(), 2u);
  EXPECT_THAT(report.problems,
              testing::Each(AllOf(HasSubstr("turned_by_exif.png"), HasSubstr("orientation 3"),
                                  HasSubstr("turned by 180 degrees"))));
}

// As OpenCV itself reads it back.
TEST_F(PictureCases, OpenCvsFloatTiff) {
  const auto picture = CasePicture("opencv_default_float.tif");
  ASSERT_TRUE(picture) << picture.error().text;
  const fs::path path =
      fs::path(TURNLIGHT_SOURCE_DIR) / "tests/rig/session/cases/opencv_default_float.tif";
  cv::Mat expected = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(expected.type(), CV_32FC3);
  cv::cvtColor(expected, expected, cv::COLOR_BGR2RGB);
  EXPECT_EQ(picture->image.type(), CV_32FC3);
  EXPECT_LT(cv::norm(picture->image, expected, cv::NORM_INF), 1e-4);
  EXPECT_GT(cv::norm(expected, cv::NORM_INF), 0.1);
  EXPECT_THAT(picture->claims.remarks,
              testing::ElementsAre(AllOf(HasSubstr("LogLuv"), HasSubstr("rounded"),
                                         HasSubstr("IMWRITE_TIFF_COMPRESSION, 1"))));
}

TEST_F(PictureCases, PagesWithoutWords) {
  const auto picture = CasePicture("three_pages.tif");
  ASSERT_FALSE(picture);
  EXPECT_THAT(picture.error().text,
              AllOf(HasSubstr("three_pages.tif: a TIFF of 3 pages"), HasSubstr("allowed is one")));
}

TEST_F(PictureCases, ThreeSamplesThatAreCalledGrey) {
  const auto picture = CasePicture("three_samples_minisblack.tif");
  ASSERT_TRUE(picture) << picture.error().text;
  EXPECT_EQ(picture->image.type(), CV_16UC3);
  EXPECT_THAT(Verified("three_samples_minisblack.tif").remarks,
              Contains(AllOf(HasSubstr("3 channels"), HasSubstr("read as R, G, B"))));
}

TEST_F(PictureCases, Masks) {
  for (const std::string name : {"mask_1_bit.png", "mask_palette.png"}) {
    const auto mask = DecodeMask(CaseBytes(name), name, {kWidth, kHeight});
    ASSERT_TRUE(mask) << mask.error().text;
    const int set = cv::countNonZero(*mask);
    EXPECT_TRUE(set > 0 && set < kWidth * kHeight) << name << " " << set;
    EXPECT_FALSE(CasePicture(name)) << "no frame";
    for (auto& frame : json_["frames"]) frame["mask"] = "frames/" + name;
    Put("frames/" + name, CaseBytes(name));
    WriteJson();
    const auto images = ReadFrameImages(ReadSession(root()).value(), 0);
    ASSERT_TRUE(images) << images.error().text;
    EXPECT_EQ(cv::countNonZero(images->mask), set);
  }
}

}  // namespace
}  // namespace turnlight::rig
