// Proves: a raw capture comes back from its file as it was; every wrong value is refused by file,
// key, value and what is allowed; no path leaves the folder; pictures that changed, are damaged or
// of another size are refused; a mosaic comes in both ways. Does not prove: that devices take such
// pictures.
#include "rig/session/raw_capture.h"

#include "base/sha256.h"
#include "tests/rig/session/fixture.h"

namespace turnlight::rig {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr char kNoSha[] = "0000000000000000000000000000000000000000000000000000000000000000";

class RawCaptureTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(root() / "frames");
    capture_.name = "first";
    capture_.radiometry.white = 65535.0;
    capture_.devices = {
        {"Maker", "C", "77"}, {"Other", "T", ""}, {kWidth, kHeight}, {8, 16}, {2, 2}, "50 mm"};
    for (const char* image : {"frames/a.png", "frames/b.png"}) {
      ASSERT_TRUE(WriteImage(root() / image, Pattern(CV_16UC1)));
      RawCaptureFrame frame;
      frame.image = image;
      frame.sha256 = Sha256Hex(*ReadFile(root() / image));
      capture_.frames.push_back(frame);
    }
    RawCaptureFrame& first = capture_.frames.front();
    first.kind = "board";
    first.angle_deg = 1.0 / 3.0;
    first.angle_measured_deg = 1.0 / 3.0 + 1e-15;
    first.exposure = {8000.1, 0.7};
    first.has_gain = true;
    ASSERT_TRUE(WriteRawCapture(capture_, root()));
  }

  const std::filesystem::path& root() const { return folder_.path(); }

  // What is said of the file when it has that value under a pointer; without it if null.
  std::string Refusal(const std::string& pointer, const json& value) const {
    const std::string original = *ReadFile(root() / kCaptureFile);
    json object = json::parse(original);
    if (value.is_null()) {
      const json::json_pointer at(pointer);
      object.at(at.parent_pointer()).erase(at.back());
    } else {
      object[json::json_pointer(pointer)] = value;
    }
    EXPECT_TRUE(WriteFileAtomic(root() / kCaptureFile, object.dump()));
    const auto read = ReadRawCapture(root());
    EXPECT_TRUE(WriteFileAtomic(root() / kCaptureFile, original));
    if (read) return "accepted";
    EXPECT_EQ(read.error().kind, ErrorKind::kInput);
    EXPECT_THAT(read.error().text, StartsWith((root() / kCaptureFile).string() + ": "));
    return read.error().text;
  }

  const TemporaryFolder folder_;
  RawCapture capture_;
};

TEST_F(RawCaptureTest, ComesBackAsItWas) {
  const auto read = ReadRawCapture(root());
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->root, root());
  EXPECT_EQ(read->frames.size(), 2u);
  EXPECT_EQ(*read->frames[0].angle_measured_deg, 1.0 / 3.0 + 1e-15);
  EXPECT_EQ(read->frames[0].exposure.gain_db, 0.7);
  EXPECT_FALSE(read->frames[1].has_gain || read->frames[1].kind || read->frames[1].angle_deg);
  EXPECT_EQ(read->devices.roi_offset, (std::array{8, 16}));
  EXPECT_EQ(read->devices.lens, "50 mm");
  EXPECT_THAT(FramesOfKind(*read, "board"), ElementsAre(0u));
  const std::string text = *ReadFile(root() / kCaptureFile);
  ASSERT_TRUE(WriteRawCapture(*read, root()));
  EXPECT_EQ(*ReadFile(root() / kCaptureFile), text);
}

TEST_F(RawCaptureTest, IsFoundByItsFolderAndByItsFile) {
  EXPECT_TRUE(IsRawCapture(root()));
  EXPECT_TRUE(IsRawCapture(root() / kCaptureFile));
  EXPECT_FALSE(IsRawCapture(root() / "frames"));
  EXPECT_TRUE(ReadRawCapture(root() / kCaptureFile));
  EXPECT_THAT(ReadRawCapture(root() / "frames").error().text, HasSubstr(kCaptureFile));
}

TEST_F(RawCaptureTest, EveryKeyThatIsNotOptionalMustBeThere) {
  for (const std::string key :
       {"/format", "/version", "/name", "/radiometry", "/radiometry/encoding", "/radiometry/black",
        "/radiometry/white", "/identity", "/identity/camera", "/identity/camera/resolution",
        "/identity/camera/serial", "/identity/table", "/frames", "/frames/0/image"})
    EXPECT_THAT(Refusal(key, nullptr), HasSubstr("missing")) << key;
  for (const std::string key : {"/identity/lens", "/identity/camera/binning", "/frames/0/kind",
                                "/frames/0/angle_deg", "/frames/0/sha256", "/frames/0/gain_db"})
    EXPECT_EQ(Refusal(key, nullptr), "accepted") << key;
}

TEST_F(RawCaptureTest, WrongValuesAreNamed) {
  EXPECT_THAT(Refusal("/format", "turnlight-session"), HasSubstr("turnlight-capture"));
  EXPECT_THAT(Refusal("/version", 2), AllOf(HasSubstr("version: 2"), HasSubstr("allowed is 1")));
  EXPECT_THAT(Refusal("/frames", json::array()), HasSubstr("frames"));
  EXPECT_THAT(Refusal("/radiometry/white", -1), HasSubstr("above black"));
  EXPECT_THAT(Refusal("/radiometry/bayer", "RGBG"), HasSubstr("RGGB"));
  EXPECT_THAT(Refusal("/frames/1/kind", "two words"), HasSubstr("frames/1/kind"));
  EXPECT_THAT(Refusal("/frames/1/exposure_us", 0), HasSubstr("frames/1/exposure_us: 0"));
  EXPECT_THAT(Refusal("/frames/1/sha256", "abc"), HasSubstr("64 lower-case"));
  EXPECT_THAT(Refusal("/frames/1/X_WC", 1), HasSubstr("X_WC"));
  EXPECT_THAT(Refusal("/frames/1/image", "frames/./a.png"), HasSubstr("that is frames/0 already"));
  EXPECT_EQ(Refusal("/frames/1/x-note", "free"), "accepted");
}

TEST_F(RawCaptureTest, NoPathLeavesTheFolder) {
  std::filesystem::create_symlink("/etc/passwd", root() / "link.png");
  EXPECT_THAT(Refusal("/frames/1/image", "/etc/passwd"), HasSubstr("is absolute"));
  EXPECT_THAT(Refusal("/frames/1/image", "../a.png"), HasSubstr("\"..\""));
  EXPECT_THAT(Refusal("/frames/1/image", "link.png"), HasSubstr("leads out"));
  EXPECT_THAT(Refusal("/frames/1/image", "frames/c.png"), HasSubstr("every file"));
  EXPECT_THAT(Refusal("/frames/1/image", "a\nb.png"), HasSubstr("control character"));
  capture_.frames[1].image = "../a.png";
  EXPECT_FALSE(WriteRawCapture(capture_, root()));
}

TEST_F(RawCaptureTest, APictureMayBeMissingWhereOneGoesOn) {
  std::filesystem::remove(root() / "frames/b.png");
  EXPECT_FALSE(ReadRawCapture(root()));
  const auto capture = ReadRawCapture(root(), RawPictures::kMayBeMissing);
  ASSERT_TRUE(capture) << capture.error().text;
  EXPECT_TRUE(ReadRawImage(*capture, 0));
  EXPECT_FALSE(ReadRawImage(*capture, 1));
}

TEST_F(RawCaptureTest, WhatWouldBeRefusedIsNotWritten) {
  const std::string text = *ReadFile(root() / kCaptureFile);
  RawCapture wrong = capture_;
  wrong.frames.clear();
  EXPECT_FALSE(WriteRawCapture(wrong, root()));
  wrong = capture_;
  wrong.name = "\xff";
  EXPECT_FALSE(WriteRawCapture(wrong, root()));
  EXPECT_EQ(*ReadFile(root() / kCaptureFile), text);
}

TEST_F(RawCaptureTest, PicturesAreTheOnesThatWereTaken) {
  const auto capture = ReadRawCapture(root());
  ASSERT_TRUE(capture);
  const auto image = ReadRawImage(*capture, 0);
  ASSERT_TRUE(image) << image.error().text;
  EXPECT_TRUE(SamePixels(*image, Pattern(CV_16UC1)));
  EXPECT_THAT(ReadRawImage(*capture, 2).error().text,
              HasSubstr("frame 2 was asked for, it has 2, counted from 0"));

  RawCapture changed = *capture;
  changed.frames[0].sha256 = kNoSha;
  EXPECT_THAT(ReadRawImage(changed, 0).error().text,
              AllOf(HasSubstr("a.png"), HasSubstr("changed"), HasSubstr("frames/0/sha256")));
  changed = *capture;
  changed.devices.resolution.width += 1;
  EXPECT_THAT(ReadRawImage(changed, 0).error().text, HasSubstr("17"));
}

TEST_F(RawCaptureTest, AMosaicComesBothWays) {
  auto capture = ReadRawCapture(root());
  ASSERT_TRUE(capture);
  capture->bayer = "GRBG";
  EXPECT_EQ(ReadRawImage(*capture, 0)->channels(), 3);
  EXPECT_TRUE(SamePixels(*ReadRawImage(*capture, 0, Mosaic::kAsRecorded), Pattern(CV_16UC1)));
  ASSERT_TRUE(WriteImage(root() / "frames/a.png", Pattern(CV_16UC3)));
  capture->frames[0].sha256.reset();
  EXPECT_THAT(ReadRawImage(*capture, 0).error().text, HasSubstr("needs pictures of 1 channel"));
}

}  // namespace
}  // namespace turnlight::rig
