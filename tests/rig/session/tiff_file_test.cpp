// Proves: TIFFs of every layout and kind of samples that is read come with the values that were
// written, and every other is refused with words that name what it is and what is allowed. Does not
// prove: files of every program; image_file_test.cpp has truncated ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/session/image_file.h"
#include "tests/rig/session/fixture.h"
#include "tests/rig/session/tiff_parts.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;

cv::Mat Read(const std::string& bytes) {
  testing::internal::CaptureStderr();
  const auto picture = DecodePicture(bytes, "a.tif");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(picture) << picture.error().text;
  return picture ? picture->image : cv::Mat();
}

std::string RefusalOf(const std::vector<TiffPage>& pages) {
  const auto picture = DecodePicture(TiffOfPages(pages), "a.tif");
  EXPECT_FALSE(picture);
  return picture ? "" : picture.error().text;
}

template <typename T>
TiffPage PageOf(const std::vector<T>& values, int format) {
  return {.width = static_cast<int>(values.size()),
          .height = 1,
          .bits = 8 * static_cast<int>(sizeof(T)),
          .format = format,
          .pixels = BytesOf(values)};
}

TEST(TiffFile, SamplesOfEveryKind) {
  const cv::Mat whole = (cv::Mat_<float>(1, 4) << 0, 1, 77, 16777216);
  EXPECT_TRUE(SamePixels(
      Read(TiffOfPages({PageOf<std::uint32_t>({0, 1, 77, 16777216}, SAMPLEFORMAT_UINT)})), whole));
  const cv::Mat below = (cv::Mat_<float>(1, 3) << -128, 0, 127);
  EXPECT_TRUE(SamePixels(Read(TiffOfPages({PageOf<std::int8_t>({-128, 0, 127}, SAMPLEFORMAT_INT)})),
                         below));
  EXPECT_TRUE(SamePixels(
      Read(TiffOfPages({PageOf<std::int16_t>({-128, 0, 127}, SAMPLEFORMAT_INT)})), below));
  EXPECT_TRUE(SamePixels(
      Read(TiffOfPages({PageOf<std::int32_t>({-128, 0, 127}, SAMPLEFORMAT_INT)})), below));
  const cv::Mat floats = (cv::Mat_<float>(1, 3) << -0.5f, 0.0f, 1.25f);
  EXPECT_TRUE(SamePixels(
      Read(TiffOfPages({PageOf<double>({-0.5, 0.0, 1.25}, SAMPLEFORMAT_IEEEFP)})), floats));
  EXPECT_TRUE(SamePixels(
      Read(TiffOfPages({PageOf<std::uint16_t>({0xb800, 0, 0x3d00}, SAMPLEFORMAT_IEEEFP)})),
      floats));
  EXPECT_THAT(RefusalOf({PageOf<std::uint32_t>({1, 16777217}, SAMPLEFORMAT_UINT)}),
              AllOf(HasSubstr("16777217 at pixel 1, 0"), HasSubstr("up to 16777216")));
}

TEST(TiffFile, TwelveBitsPacked) {
  const TiffPage page{.width = 3,
                      .height = 2,
                      .bits = 12,
                      .pixels = std::string("\x12\x34\x56\xff\xf0\xab\xcd\xef\x00\x10", 10)};
  EXPECT_TRUE(SamePixels(Read(TiffOfPages({page})),
                         (cv::Mat_<std::uint16_t>(2, 3) << 0x123, 0x456, 0xfff, 0xabc, 0xdef, 1)));
}

// R, G, B of 5 x 3 pixels: side by side, in planes, in tiles, in planes of tiles, of other
// machines.
TEST(TiffFile, EveryLayoutGivesTheSamePixels) {
  constexpr int kColumns = 5, kRows = 3;
  const cv::Mat image = Pattern(CV_16UC3, kColumns, kRows);
  const std::string together(reinterpret_cast<const char*>(image.data),
                             image.total() * image.elemSize());
  std::vector<cv::Mat> split;
  cv::split(image, split);
  std::string apart, tile, tiles;
  for (const cv::Mat& plane : split) {
    apart += std::string(reinterpret_cast<const char*>(plane.data), plane.total() * 2);
    cv::Mat padded = cv::Mat::zeros(16, 16, CV_16U);
    plane.copyTo(padded(cv::Rect(0, 0, kColumns, kRows)));
    tiles += std::string(reinterpret_cast<const char*>(padded.data), padded.total() * 2);
  }
  cv::Mat padded = cv::Mat::zeros(16, 16, CV_16UC3);
  image.copyTo(padded(cv::Rect(0, 0, kColumns, kRows)));
  tile = std::string(reinterpret_cast<const char*>(padded.data), padded.total() * 6);
  const auto planes = [](TIFF* tiff) {
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_SEPARATE);
  };
  const auto in_tiles = [](TIFF* tiff) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
  };
  TiffPage page{.width = kColumns,
                .height = kRows,
                .bits = 16,
                .samples = 3,
                .photometric = PHOTOMETRIC_RGB,
                .pixels = together};
  for (const char* mode : {"w", "wb", "w8", "wb8"})
    EXPECT_TRUE(SamePixels(Read(TiffOfPages({page}, mode)), image)) << mode;
  page.pixels = apart;
  page.tags = planes;
  EXPECT_TRUE(SamePixels(Read(TiffOfPages({page})), image));
  page.pixels = tile;
  page.tags = in_tiles;
  EXPECT_TRUE(SamePixels(Read(TiffOfPages({page})), image));
  page.pixels = tiles;
  page.tags = [&](TIFF* tiff) {
    planes(tiff);
    in_tiles(tiff);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
  };
  EXPECT_TRUE(SamePixels(Read(TiffOfPages({page})), image));
}

TEST(TiffFile, PagesAreColourOnlyIfTheFileSaysSo) {
  std::vector<TiffPage> pages(3);
  for (int i = 0; i < 3; ++i)
    pages[static_cast<std::size_t>(i)].pixels = std::string(12, static_cast<char>(10 + i));
  EXPECT_THAT(RefusalOf(pages), AllOf(HasSubstr("a TIFF of 3 pages"), HasSubstr("allowed is one")));
  const auto described = [&](const char* text) {
    pages[0].tags = [text](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, text); };
    return pages;
  };
  const std::string colour =
      TiffOfPages(described("ImageJ=1.53t\nimages=3\nchannels=3\nmode=composite\nloop=false\n"));
  const auto picture = DecodePicture(colour, "a.tif");
  ASSERT_TRUE(picture) << picture.error().text;
  EXPECT_TRUE(SamePixels(picture->image, cv::Mat(3, 4, CV_8UC3, cv::Scalar(10, 11, 12))));
  EXPECT_THAT(picture->claims.remarks, testing::ElementsAre(HasSubstr("read as R, G, B")));
  EXPECT_THAT(RefusalOf(described("ImageJ=1.53t\nimages=3\nslices=3\n")), HasSubstr("3 pages"));
  EXPECT_THAT(RefusalOf(described("ImageJ=1.53t\nimages=3\nchannels=3\nmode=grayscale\n")),
              HasSubstr("3 pages"));
  described("ImageJ=1.53t\nimages=3\nchannels=3\nmode=composite\n");
  pages[2].width = 6;
  EXPECT_THAT(RefusalOf(pages), HasSubstr("differ in size or kind"));
  pages.resize(1);
  EXPECT_THAT(RefusalOf(pages), HasSubstr("ImageJ says that it is 3 pictures"));
}

TEST(TiffFile, ThumbnailsAreNoPages) {
  TiffPage small{.width = 2, .height = 2, .pixels = std::string(4, '\x01')};
  small.tags = [](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, FILETYPE_REDUCEDIMAGE); };
  const TiffPage large{.pixels = std::string(12, '\x07')};
  const cv::Mat expected(3, 4, CV_8U, 7);
  EXPECT_TRUE(SamePixels(Read(TiffOfPages({large, small})), expected));
  EXPECT_TRUE(SamePixels(Read(TiffOfPages({small, large})), expected));
  EXPECT_THAT(RefusalOf({small}), HasSubstr("thumbnails or masks"));
}

TEST(TiffFile, OthersAreRefusedInWords) {
  const auto refused = [](
                           int photometric, int samples, int bits, int format,
                           const std::function<void(TIFF*)>& tags = [](TIFF*) {}) {
    return RefusalOf({{.bits = bits,
                       .samples = samples,
                       .format = format,
                       .photometric = photometric,
                       .tags = tags}});
  };
  const int whole = SAMPLEFORMAT_UINT;
  EXPECT_THAT(refused(PHOTOMETRIC_MINISWHITE, 1, 8, whole),
              AllOf(HasSubstr("0 (grey, white is 0)"), HasSubstr("against the light")));
  EXPECT_THAT(refused(PHOTOMETRIC_RGB, 4, 8, whole,
                      [](TIFF* tiff) {
                        const std::uint16_t kind = EXTRASAMPLE_UNASSALPHA;
                        TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &kind);
                      }),
              AllOf(HasSubstr("4 channels, of which 1 beyond the colours (alpha)"),
                    HasSubstr("export without alpha")));
  EXPECT_THAT(refused(PHOTOMETRIC_CIELAB, 3, 8, whole), HasSubstr("8 (CIE Lab) with 3 channels"));
  EXPECT_THAT(refused(PHOTOMETRIC_MINISBLACK, 1, 1, whole), HasSubstr("samples of 1 bits"));
  EXPECT_THAT(refused(PHOTOMETRIC_MINISBLACK, 1, 64, SAMPLEFORMAT_COMPLEXIEEEFP),
              HasSubstr("format 6 (complex)"));
  EXPECT_THAT(
      refused(PHOTOMETRIC_MINISBLACK, 1, 8, whole,
              [](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_JPEG); }),
      HasSubstr("7 (JPEG, which changes values)"));
  for (int turn = 2; turn <= 8; ++turn)
    EXPECT_THAT(refused(PHOTOMETRIC_MINISBLACK, 1, 8, whole,
                        [turn](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_ORIENTATION, turn); }),
                AllOf(HasSubstr("Orientation tag gives the orientation " + std::to_string(turn)),
                      HasSubstr("allowed is 1")));
}

TEST(TiffFile, ClaimsOfTheTransfer) {
  const auto claim = [](const std::function<void(TIFF*)>& tags) {
    const auto picture = DecodePicture(TiffOfPages({{.tags = tags}}), "a.tif");
    EXPECT_TRUE(picture) << picture.error().text;
    return picture->claims.transfer;
  };
  EXPECT_FALSE(claim([](TIFF*) {}));
  const auto curve = claim([](TIFF* tiff) {
    std::vector<std::uint16_t> table(256);
    for (std::size_t i = 0; i < 256; ++i)
      table[i] =
          static_cast<std::uint16_t>(65535.0 * std::pow(static_cast<double>(i) / 255.0, 1.8));
    TIFFSetField(tiff, TIFFTAG_TRANSFERFUNCTION, table.data());
  });
  ASSERT_TRUE(curve);
  EXPECT_EQ(curve->kind, Transfer::kGamma);
  EXPECT_NEAR(curve->gamma, 1.8, 0.02);
}

}  // namespace
}  // namespace turnlight::rig
