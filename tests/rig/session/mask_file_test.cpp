// Proves: masks as image programs save them (few bits, palettes, alpha, a transparent colour, white
// as 0) are read as they are meant, as PNG and TIFF. Does not prove: pictures; the readers of those
// are stricter.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "rig/session/image_file.h"
#include "tests/rig/session/fixture.h"
#include "tests/rig/session/png_parts.h"
#include "tests/rig/session/tiff_parts.h"

namespace turnlight::rig {
namespace {

using testing::HasSubstr;

// Of 4 x 1 pixels: 'x' is target.
std::string Shown(const std::string& bytes, const char* file) {
  const auto mask = DecodeMask(bytes, file, {4, 1});
  EXPECT_TRUE(mask) << mask.error().text;
  std::string text;
  for (int x = 0; mask && x < 4; ++x)
    text += (*mask)(0, x) == 255 ? 'x' : (*mask)(0, x) ? '?' : '.';
  return text;
}

std::string Png(int bits, int colour, const std::string& row, const std::string& before = "") {
  return PngOfRows(4, 1, bits, colour, std::string(1, '\0') + row, before);
}

TEST(MaskFile, FewBits) {
  EXPECT_EQ(Shown(Png(1, 0, "\x50"), "m.png"), ".x.x");
  EXPECT_EQ(Shown(Png(2, 0, "\x1b"), "m.png"), ".xxx");
  EXPECT_EQ(Shown(Png(4, 0, std::string("\x01\xf0", 2)), "m.png"), ".xx.");
  EXPECT_EQ(Shown(Png(16, 0, std::string("\0\1\0\0\1\0\0\0", 8)), "m.png"), "x.x.");
}

TEST(MaskFile, Palettes) {
  const std::string colours = PngChunk("PLTE", std::string("\0\0\0\xff\xff\xff\0\0\x80\0\0\0", 12));
  EXPECT_EQ(Shown(Png(8, 3, std::string("\0\1\2\3", 4), colours), "m.png"), ".xx.");
  EXPECT_EQ(Shown(Png(2, 3, "\x1b", colours), "m.png"), ".xx.");
  EXPECT_EQ(Shown(Png(1, 3, "\x50", colours), "m.png"), ".x.x");
  // White is index 0, and transparent: alpha varies, colours too.
  EXPECT_EQ(Shown(Png(1, 3, "\x50",
                      PngChunk("PLTE", std::string("\xff\xff\xff\x10\x20\x30", 6)) +
                          PngChunk("tRNS", std::string(1, '\0'))),
                  "m.png"),
            ".x.x");
  EXPECT_FALSE(DecodeMask(Png(8, 3, std::string(4, '\0')), "m.png"));  // no palette
  EXPECT_FALSE(DecodePicture(Png(8, 3, std::string("\0\1\2\3", 4), colours), "m.png"));
}

TEST(MaskFile, AlphaDecidesWhereItVaries) {
  const std::string opaque("\0\0\0\xff\xff\0\0\xff\0\0\0\xff\0\0\1\xff", 16);
  EXPECT_EQ(Shown(Png(8, 6, opaque), "m.png"), ".x.x");
  const std::string cut_out("\0\0\0\xff\0\0\0\0\0\0\0\x01\0\0\0\0", 16);  // black, with alpha
  EXPECT_EQ(Shown(Png(8, 6, cut_out), "m.png"), "x.x.");
  const std::string white("\xff\xff\xff\0\xff\xff\xff\xff\xff\xff\xff\0\xff\xff\xff\xff", 16);
  EXPECT_EQ(Shown(Png(8, 6, white), "m.png"), ".x.x");
  const std::string both("\xff\xff\xff\0\xff\xff\xff\xff\0\0\0\xff\0\0\0\0", 16);
  EXPECT_EQ(Shown(Png(8, 6, both), "m.png"), ".x..");
  EXPECT_EQ(Shown(Png(8, 4, std::string("\0\xff\x09\xff\0\xff\x09\xff", 8)), "m.png"), ".x.x");
  // A colour that stands for transparent.
  EXPECT_EQ(
      Shown(Png(8, 0, "\x09\x07\x09\x08", PngChunk("tRNS", std::string("\0\x09", 2))), "m.png"),
      ".x.x");
}

TEST(MaskFile, Tiffs) {
  const TiffPage bits{.width = 4, .height = 1, .bits = 1, .pixels = "\x50"};
  EXPECT_EQ(Shown(TiffOfPages({bits}), "m.tif"), ".x.x");
  TiffPage inverted = bits;
  inverted.photometric = PHOTOMETRIC_MINISWHITE;
  EXPECT_EQ(Shown(TiffOfPages({inverted}), "m.tif"), "x.x.");
  inverted.tags = [](TIFF* tiff) {
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_CCITTFAX4);
  };
  EXPECT_EQ(Shown(TiffOfPages({inverted}), "m.tif"), "x.x.");
  TiffPage palette{.width = 4,
                   .height = 1,
                   .photometric = PHOTOMETRIC_PALETTE,
                   .pixels = std::string("\0\1\2\3", 4)};
  palette.tags = [](TIFF* tiff) {
    std::vector<std::uint16_t> red(256), green(256), blue(256);
    blue[1] = 256;
    red[3] = 65535;
    TIFFSetField(tiff, TIFFTAG_COLORMAP, red.data(), green.data(), blue.data());
  };
  EXPECT_EQ(Shown(TiffOfPages({palette}), "m.tif"), ".x.x");
  TiffPage alpha{.width = 4,
                 .height = 1,
                 .samples = 4,
                 .photometric = PHOTOMETRIC_RGB,
                 .pixels = std::string("\0\0\0\xff\0\0\0\0\0\0\0\x01\0\0\0\0", 16)};
  alpha.tags = [](TIFF* tiff) {
    const std::uint16_t kind = EXTRASAMPLE_UNASSALPHA;
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &kind);
  };
  EXPECT_EQ(Shown(TiffOfPages({alpha}), "m.tif"), "x.x.");
}

TEST(MaskFile, AnExrWithAlpha) {
  const TemporaryFolder folder;
  const std::string path = folder / "m.exr";
  {
    Imf::Header header(4, 1);
    Imf::FrameBuffer buffer;
    const float black[4] = {}, alpha[4] = {0.0f, 1.0f, 0.0f, 0.5f};
    for (const char* channel : {"R", "G", "B", "A"}) {
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
      buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, *channel == 'A' ? alpha : black,
                                              header.dataWindow(), sizeof(float)));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(1);
  }
  EXPECT_EQ(Shown(ReadFile(path).value(), "m.exr"), ".x.x");
  EXPECT_FALSE(ReadImage(path));
}

TEST(MaskFile, ABlankMaskOfOneBitMayBeSmall) {
  std::vector<unsigned char> bytes;
  ASSERT_TRUE(cv::imencode(".png", cv::Mat(3000, 4000, CV_8U, cv::Scalar(255)), bytes,
                           {cv::IMWRITE_PNG_BILEVEL, 1, cv::IMWRITE_PNG_COMPRESSION, 9}));
  const auto mask = DecodeMask({bytes.begin(), bytes.end()}, "m.png", {4000, 3000});
  ASSERT_TRUE(mask) << mask.error().text;
  EXPECT_EQ(cv::countNonZero(*mask), 12000000);
}

TEST(MaskFile, AJpegIsRefusedInWords) {
  const auto mask = DecodeMask("\xff\xd8\xff", "m.jpg");
  ASSERT_FALSE(mask);
  EXPECT_THAT(mask.error().text, testing::AllOf(HasSubstr("allowed are .png"), HasSubstr("JPEG")));
}

}  // namespace
}  // namespace turnlight::rig
