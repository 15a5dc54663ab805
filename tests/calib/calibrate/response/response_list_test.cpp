// Proves: the list of pictures is read strictly, whatever order and form it is in, and each refusal
// names file, key and what is allowed.
#include "calib/calibrate/response/response_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "tests/temporary_folder.h"

namespace turnlight::calib::calibrate::response {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ResponseListTest : public testing::Test {
 protected:
  Result<ResponseList> Read(const std::string& text) {
    EXPECT_TRUE(WriteFileAtomic(folder_ / "response.yaml", text));
    return ReadResponseList(folder_);
  }
  void ExpectRefused(const std::string& text, const std::string& words) {
    const auto list = Read(text);
    ASSERT_FALSE(list) << text;
    EXPECT_THAT(list.error().text, HasSubstr("response.yaml"));
    EXPECT_THAT(list.error().text, HasSubstr(words));
  }

  // Of its own: tests run beside each other.
  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

const std::string kSeries =
    "series:\n- {exposure_us: 2000, images: [c.png]}\n- {exposure_us: 500, images: [a.png]}\n"
    "- {exposure_us: 1000, images: [b.png]}\n- {exposure_us: 500, images: [a2.png]}\n";

TEST_F(ResponseListTest, Everything) {
  const auto list = Read(kSeries +
                         "dark: [d.png, e.png]\nflat: [f.png]\nbayer: RGGB\nwhite: 4095\n"
                         "gain_db: 6\ngrey_card: {images: [g.png], rectangle: [10, 20, 30, 40]}\n");
  ASSERT_TRUE(list) << list.error().text;
  ASSERT_EQ(list->series.size(), 3u);
  EXPECT_EQ(list->series[0].exposure_us, 500.0);
  EXPECT_EQ(list->series[0].images, (std::vector<fs::path>{folder_ / "a.png", folder_ / "a2.png"}));
  EXPECT_EQ(list->dark.images.size(), 2u);
  EXPECT_EQ(list->flat.images.size(), 1u);
  EXPECT_EQ(list->bayer, "RGGB");
  EXPECT_EQ(list->white, 4095.0);
  EXPECT_EQ(list->gain_db, 6.0);
  EXPECT_EQ(list->grey_card->rectangle, cv::Rect(10, 20, 30, 40));
}

TEST_F(ResponseListTest, RefusalsNameTheKey) {
  ExpectRefused("dark: [d.png]\n", "series");
  ExpectRefused("series: [{exposure_us: 1, images: [a.png]}]\n", "series");
  ExpectRefused(
      "series:\n- {exposure_us: 1, images: [a]}\n- {exposure_us: 1, images: [b]}\n"
      "- {exposure_us: 1, images: [c]}\n",
      "1 different exposures, allowed are at least 3");
  ExpectRefused(
      "series:\n- {exposure_us: 0, images: [a]}\n- {exposure_us: 1, images: [b]}\n"
      "- {exposure_us: 2, images: [c]}\n",
      "series/0/exposure_us: 0, allowed");
  ExpectRefused(
      "series:\n- {exposure_us: 3, images: []}\n- {exposure_us: 1, images: [b]}\n"
      "- {exposure_us: 2, images: [c]}\n",
      "series/0/images");
  ExpectRefused(kSeries + "dark: d.png\n", "dark");
  ExpectRefused(kSeries + "darks: [d.png]\n", "darks: unknown key");
  ExpectRefused(kSeries + "bayer: RGBG\n", "bayer: \"RGBG\", allowed");
  ExpectRefused(kSeries + "grey_card: {images: [a], rectangle: [1, 2, 3]}\n",
                "grey_card/rectangle");
  ExpectRefused(kSeries + "grey_card: {images: [a], rectangle: [1, 2, 1, 9]}\n", "at least 2 x 2");
}

TEST_F(ResponseListTest, WhatIsNotThere) {
  const auto empty = ReadResponseList(folder_);
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error().text, HasSubstr("holds no list of pictures, allowed is a folder with"));
  EXPECT_FALSE(ReadResponseList(folder_ / "nothing.yaml"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::response
