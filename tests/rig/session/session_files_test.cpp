// Proves: the files that a session names are read as declared, and each fault of theirs is refused
// with the file, what is wrong and what is allowed, by the reader and by verify.
// Does not prove: damage within the formats; image_file_test.cpp and mesh_file_test.cpp do.
#include <filesystem>

#include "base/sha256.h"
#include "rig/session/session.h"
#include "tests/rig/session/fixture.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class SessionFilesTest : public SessionFixture {
 protected:
  std::string ReadError() {
    WriteJson();
    const auto session = ReadSession(root());
    EXPECT_FALSE(session) << json_.dump(1);
    return session ? "" : session.error().text;
  }
  // Of frame 1.
  std::string FrameError() {
    WriteJson();
    const auto session = ReadSession(root());
    EXPECT_TRUE(session) << session.error().text;
    if (!session) return "";
    const auto images = ReadFrameImages(*session, 1);
    EXPECT_FALSE(images);
    const std::string text = images ? "" : images.error().text;
    const auto report = VerifySession(root());
    EXPECT_TRUE(report);
    EXPECT_THAT(report->problems, ElementsAre("frame 1 (10.0 deg): " + text));
    EXPECT_EQ(report->content_sha256, "");
    return text;
  }
};

TEST_F(SessionFilesTest, FrameIsRead) {
  cv::Mat mask(kHeight, kWidth, CV_8UC3, cv::Scalar::all(0));
  mask.at<cv::Vec3b>(2, 3) = {0, 0, 1};
  mask.at<cv::Vec3b>(2, 4) = {9, 0, 0};
  cv::Mat validity(kHeight, kWidth, CV_16U, cv::Scalar(7));
  validity.at<std::uint16_t>(2, 4) = 0;
  ASSERT_TRUE(WriteImage(root() / "frames/mask.png", mask));
  ASSERT_TRUE(WriteImage(root() / "frames/valid.tif", validity));
  json_["frames"][1]["validity"] = "frames/valid.tif";
  json_["frames"][1]["sha256"] = Sha256Hex(Get("frames/001.png"));
  WriteJson();
  const auto session = ReadSession(root());
  ASSERT_TRUE(session) << session.error().text;
  const auto images = ReadFrameImages(*session, 1);
  ASSERT_TRUE(images) << images.error().text;
  EXPECT_TRUE(SamePixels(images->image, Pattern(CV_16UC3)));
  EXPECT_EQ(cv::countNonZero(images->mask), 1);
  EXPECT_EQ(images->mask(2, 3), 255);
  EXPECT_FALSE(ReadFrameImages(*session, 2));
}

TEST_F(SessionFilesTest, FrameWithoutMaskIsWhole) {
  json_["frames"][0].erase("mask");
  WriteJson();
  const auto images = ReadFrameImages(ReadSession(root()).value(), 0);
  ASSERT_TRUE(images) << images.error().text;
  EXPECT_EQ(cv::countNonZero(images->mask), kWidth * kHeight);
}

TEST_F(SessionFilesTest, BlackAndSaturatedPicturesAreRead) {
  for (const int value : {0, 65535}) {
    ASSERT_TRUE(WriteImage(root() / "frames/000.png", cv::Mat(kHeight, kWidth, CV_16U, value)));
    WriteJson();
    const auto images = ReadFrameImages(ReadSession(root()).value(), 0);
    EXPECT_TRUE(images) << images.error().text;
  }
}

TEST_F(SessionFilesTest, MosaicsOfOneColourComeBackAsThatColour) {
  const cv::Vec3w colour(1000, 2000, 3000);
  for (const std::string pattern : {"RGGB", "BGGR", "GRBG", "GBRG"}) {
    cv::Mat1w mosaic(kHeight, kWidth);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const char letter = pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
        mosaic(y, x) = colour[letter == 'R' ? 0 : letter == 'G' ? 1 : 2];
      }
    ASSERT_TRUE(WriteImage(root() / "frames/000.png", mosaic));
    json_["radiometry"]["bayer"] = pattern;
    WriteJson();
    const auto images = ReadFrameImages(ReadSession(root()).value(), 0);
    ASSERT_TRUE(images) << images.error().text;
    EXPECT_TRUE(SamePixels(images->image, cv::Mat(kHeight, kWidth, CV_16UC3, colour))) << pattern;
  }
  EXPECT_THAT(FrameError(), AllOf(HasSubstr("001.png"), HasSubstr("radiometry/bayer is GBRG"),
                                  HasSubstr("1 channel")));
}

TEST_F(SessionFilesTest, MissingImageIsRefused) {
  fs::remove(root() / "frames/001.png");
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("session.json: frames/1/image: \"frames/001.png\""),
                                 HasSubstr("No such file"), HasSubstr("must be there")));
}

TEST_F(SessionFilesTest, PathsOutOfTheFolderAreRefused) {
  const TemporaryFolder outside;
  ASSERT_TRUE(WriteImage(outside.path() / "a.png", Pattern(CV_16UC3)));
  const std::string name = outside.path().filename().string();
  json_["frames"][1]["image"] = "../" + name + "/a.png";
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames/1/image"), HasSubstr("../" + name),
                                 HasSubstr("contains \"..\""), HasSubstr("allowed are paths")));
  json_["frames"][1]["image"] = (outside.path() / "a.png").string();
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames/1/image"), HasSubstr("is absolute"),
                                 HasSubstr("allowed are paths relative")));
  fs::create_symlink(outside.path() / "a.png", root() / "frames/link.png");
  json_["frames"][1]["image"] = "frames/link.png";
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames/1/image"), HasSubstr("frames/link.png"),
                                 HasSubstr("link that leads out")));
  fs::create_directory_symlink(outside.path(), root() / "away");
  json_["frames"][1]["image"] = "frames/001.png";
  json_["frames"][1]["mask"] = "away/a.png";
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("frames/1/mask"), HasSubstr("link that leads out")));
  json_["frames"][1]["mask"] = "frames";
  EXPECT_THAT(ReadError(), HasSubstr("not a regular file"));
  json_["frames"][1]["mask"] = std::string("frames/mask.png\0/x", 18);
  EXPECT_THAT(ReadError(), HasSubstr("control character"));
  json_["frames"][1]["mask"] = "frames/mask.png";
  json_["camera"] = "../" + root().filename().string() + "/camera.cameramodel";
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("camera: "), HasSubstr("contains \"..\"")));
}

TEST_F(SessionFilesTest, LinksWithinTheFolderAndSharedPicturesAreAllowed) {
  fs::create_symlink("000.png", root() / "frames/link.png");
  json_["frames"][0]["image"] = "frames/link.png";
  json_["frames"][1]["image"] = "frames/000.png";
  WriteJson();
  const auto report = VerifySession(root());
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_THAT(report->problems, ElementsAre());
}

TEST_F(SessionFilesTest, WrongSizeNamesBoth) {
  ASSERT_TRUE(WriteImage(root() / "frames/001.png", Pattern(CV_8UC1, 20, 12)));
  EXPECT_THAT(FrameError(), AllOf(HasSubstr("frames/001.png"), HasSubstr("20 x 12"),
                                  HasSubstr("16 x 12"), HasSubstr("camera")));
}

TEST_F(SessionFilesTest, WrongMaskSizeNamesBoth) {
  ASSERT_TRUE(WriteImage(root() / "frames/small.png", Pattern(CV_8UC1, 8, 6)));
  json_["frames"][1]["mask"] = "frames/small.png";
  EXPECT_THAT(FrameError(),
              AllOf(HasSubstr("small.png"), HasSubstr("8 x 6"), HasSubstr("16 x 12")));
}

TEST_F(SessionFilesTest, TruncatedPictureIsRefused) {
  const std::string whole = Get("frames/001.png");
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{20}, whole.size() / 2, whole.size() - 12, whole.size() - 1}) {
    Put("frames/001.png", whole.substr(0, length));
    EXPECT_THAT(FrameError(), HasSubstr("frames/001.png")) << length;
  }
}

TEST_F(SessionFilesTest, EmptyMaskIsRefused) {
  ASSERT_TRUE(WriteImage(root() / "frames/none.png", cv::Mat(kHeight, kWidth, CV_8U, 0.0)));
  json_["frames"][1]["mask"] = "frames/none.png";
  EXPECT_THAT(FrameError(), AllOf(HasSubstr("frames/none.png"), HasSubstr("mask leaves no pixel"),
                                  HasSubstr("at least one non-zero pixel")));
}

TEST_F(SessionFilesTest, ChangedPictureIsRefused) {
  json_["frames"][1]["sha256"] = std::string(64, '0');
  EXPECT_THAT(FrameError(), AllOf(HasSubstr("frames/001.png"), HasSubstr("the file changed"),
                                  HasSubstr(Sha256Hex(Get("frames/001.png"))),
                                  HasSubstr("frames/1/sha256 is 000")));
}

TEST_F(SessionFilesTest, CameraModelWithUnknownLensIsRefused) {
  std::string camera = Get("camera.cameramodel");
  const std::size_t at = camera.find("LENSMODEL_PINHOLE");
  ASSERT_NE(at, std::string::npos);
  Put("camera.cameramodel", camera.replace(at, 17, "LENSMODEL_MONOCLE"));
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("camera.cameramodel"), HasSubstr("LENSMODEL_MONOCLE")));
}

TEST_F(SessionFilesTest, MeshIsReadAndItsFaultsAreTold) {
  json_["target"] = {{"shape", "mesh"}, {"path", "target.obj"}};
  EXPECT_THAT(ReadError(), AllOf(HasSubstr("target/path"), HasSubstr("target.obj")));
  Put("target.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  WriteJson();
  const auto session = ReadSession(root());
  ASSERT_TRUE(session) << session.error().text;
  const auto target = ReadTarget(*session);
  ASSERT_TRUE(target) << target.error().text;
  EXPECT_EQ(std::get<calib::MeshShape>(*target).faces.size(), 1u);
  const std::string hash = VerifySession(root()).value().content_sha256;

  Put("target.obj", "v 0 0 0\n");
  EXPECT_FALSE(ReadTarget(*session));
  const auto report = VerifySession(root());
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, ElementsAre(AllOf(HasSubstr("target.obj"), HasSubstr("no faces"))));
  Put("target.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_NE(VerifySession(root()).value().content_sha256, hash);
}

// A tetrahedron that is wound inwards, and a vertex to spare.
TEST_F(SessionFilesTest, WhatWasMendedInAMeshIsARemark) {
  json_["target"] = {{"shape", "mesh"}, {"path", "target.obj"}};
  Put("target.obj",
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
  WriteJson();
  const auto report = VerifySession(root());
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems, testing::IsEmpty());
  EXPECT_THAT(report->remarks,
              testing::IsSupersetOf({HasSubstr("target.obj: all 4 faces were wound inwards"),
                                     HasSubstr("target.obj: 1 vertex that no face names")}));
}

TEST_F(SessionFilesTest, VerifyListsEveryProblem) {
  fs::remove(root() / "frames/000.png");
  Put("frames/001.png", "not a picture");
  json_["frames"].push_back(json_["frames"][1]);
  json_["frames"].push_back(json_["frames"][1]);
  json_["frames"][2]["X_WC"][0][0] = -1;
  json_["frames"][3]["image"] = "frames/002.png";
  ASSERT_TRUE(WriteImage(root() / "frames/002.png", Pattern(CV_8UC3)));
  json_["frames"][3].erase("angle_deg");
  WriteJson();
  const auto report = VerifySession(root());
  ASSERT_TRUE(report);
  EXPECT_THAT(report->problems,
              ElementsAre(HasSubstr("frames/2/X_WC"),
                          AllOf(HasSubstr("frame 0 (0.0 deg): "), HasSubstr("frames/000.png")),
                          AllOf(HasSubstr("frame 1 (10.0 deg): "), HasSubstr("not a PNG file")),
                          AllOf(HasSubstr("frame 2 (10.0 deg): "), HasSubstr("not a PNG file"))));
  EXPECT_EQ(report->frames, 1u);
  EXPECT_EQ(report->content_sha256, "");
  EXPECT_FALSE(VerifySession(root() / "nowhere"));
}

TEST_F(SessionFilesTest, ContentHashIsThatOfTheSumsOfTheFilesNamed) {
  json_["frames"][0]["sha256"] = Sha256Hex(Get("frames/000.png"));
  WriteJson();
  std::string lines;
  for (const char* name : {"camera.cameramodel", "frames/000.png", "frames/001.png",
                           "frames/mask.png", "session.json"})
    lines += Sha256Hex(Get(name)) + "  " + name + "\n";
  auto report = VerifySession(root());
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_THAT(report->problems, ElementsAre());
  EXPECT_EQ(report->frames, 2u);
  EXPECT_THAT(report->remarks, ElementsAre(HasSubstr("1 of 2 frames have no sha256")));
  EXPECT_EQ(report->content_sha256, Sha256Hex(lines));
  Put("truth.json", "{}");
  Put("provenance.jsonl", "{}");
  EXPECT_EQ(VerifySession(root()).value().content_sha256, report->content_sha256);
}

}  // namespace
}  // namespace turnlight::rig
