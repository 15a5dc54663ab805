// Proves: which files a line names and in which order, that they are read as grey and unturned, and
// what is refused. The formats' own tests are tests/rig/session/image_file_test.cpp and
// jpeg_file_test.cpp.
#include "app/calibrate/picture_files.h"

#include <gmock/gmock.h>

#include "base/file.h"
#include "rig/session/image_file.h"
#include "tests/rig/session/jpeg_writer.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class PictureFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Write(const std::string& name, const std::string& bytes) {
    EXPECT_TRUE(WriteFileAtomic(folder_ / name, bytes));
    return (folder_ / name).string();
  }
  fs::path folder_;
};

TEST_F(PictureFiles, AFoldersPicturesAreInTheOrderOfTheirNumbers) {
  for (const char* name : {"image10.JPG", "image2.png", "image1.tif", "notes.txt", "image02.jpeg"})
    Write(name, "");
  const auto pictures = ListPictures({folder_.string()});
  ASSERT_TRUE(pictures) << pictures.error().text;
  std::vector<std::string> names;
  for (const fs::path& picture : *pictures) names.push_back(picture.filename().string());
  EXPECT_THAT(names, ElementsAre("image1.tif", "image02.jpeg", "image2.png", "image10.JPG"));
}

TEST_F(PictureFiles, RefusesWhatIsNotThereAndWhatIsNamedTwice) {
  const auto text = [](const std::vector<std::string>& arguments) {
    const auto pictures = ListPictures(arguments);
    return pictures ? std::string() : pictures.error().text;
  };
  EXPECT_THAT(text({}), HasSubstr("no pictures named"));
  EXPECT_THAT(text({folder_.string()}), HasSubstr("no pictures in it"));
  EXPECT_THAT(text({(folder_ / "none.png").string()}), HasSubstr("none.png: no such file"));
  const std::string one = Write("a.png", "");
  EXPECT_THAT(text({one, folder_.string()}), HasSubstr("a.png: named twice"));
}

TEST_F(PictureFiles, ReadsGreyOfEveryFormat) {
  const cv::Mat grey(40, 50, CV_16U, cv::Scalar(3000));
  ASSERT_TRUE(rig::WriteImage(folder_ / "a.png", grey));
  const auto png = ReadGreyPicture(folder_ / "a.png");
  ASSERT_TRUE(png) << png.error().text;
  EXPECT_EQ(cv::norm(png->grey, grey, cv::NORM_INF), 0.0);
  ASSERT_TRUE(rig::WriteImage(folder_ / "b.tif", cv::Mat(40, 50, CV_8UC3, cv::Scalar(90, 90, 90))));
  const auto tiff = ReadGreyPicture(folder_ / "b.tif");
  ASSERT_TRUE(tiff) << tiff.error().text;
  EXPECT_EQ(tiff->grey.type(), CV_8UC1);
  EXPECT_EQ(tiff->grey.at<unsigned char>(3, 3), 90);
  const std::string turned =
      Write("c.jpg", rig::WriteJpeg(cv::Mat(40, 50, CV_8U, cv::Scalar(70)), 6));
  const auto jpeg = ReadGreyPicture(turned);
  ASSERT_TRUE(jpeg) << jpeg.error().text;
  EXPECT_EQ(jpeg->grey.size(), cv::Size(50, 40));
  EXPECT_THAT(jpeg->remarks, ElementsAre(HasSubstr("orientation 6")));
}

TEST_F(PictureFiles, RefusesWithTheFilesName) {
  const auto text = [](const fs::path& path) {
    const auto picture = ReadGreyPicture(path);
    return picture ? std::string() : picture.error().text;
  };
  EXPECT_THAT(text(Write("a.png", "no")), HasSubstr("a.png: not a PNG"));
  EXPECT_THAT(text(Write("b.jpg", "no")), HasSubstr("b.jpg: not a JPEG"));
  EXPECT_THAT(text(Write("c.bmp", "BM")), HasSubstr("allowed are .png"));
  EXPECT_THAT(text(folder_ / "none.jpg"), HasSubstr("none.jpg"));
  ASSERT_TRUE(rig::WriteImage(folder_ / "f.tif", cv::Mat(40, 50, CV_32F, cv::Scalar(0.5))));
  EXPECT_THAT(text(folder_ / "f.tif"), HasSubstr("floating-point"));
}

TEST(FindCommonSize, TheMostFrequentAndWhoDiffers) {
  const CommonSize common = FindCommonSize({{40, 30}, {60, 50}, {}, {60, 50}, {30, 40}});
  EXPECT_EQ(common.size, cv::Size(60, 50));
  EXPECT_THAT(common.others, ElementsAre(0u, 4u));
  EXPECT_THAT(FindCommonSize({}).others, IsEmpty());
}

}  // namespace
}  // namespace turnlight::app
