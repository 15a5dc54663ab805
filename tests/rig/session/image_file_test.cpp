// Proves: pictures of every format, depth and channel count come back as they were written; what is
// damaged, cut short, too large or of another kind is refused with the reason, without a word of a
// library on standard error. Does not prove: files of every other program; shared_data_test.cpp
// reads some.
#include "rig/session/image_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <half.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/rig/session/fixture.h"
#include "tests/rig/session/png_parts.h"

namespace turnlight::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string LittleEndian(std::uint64_t value, int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> 8 * i);
  return bytes;
}

// A PNG that ends after its header, but for an empty data chunk and the end chunk.
std::string PngOf(std::uint32_t width, std::uint32_t height, int bits, int colour) {
  std::string header = BigEndian(width) + BigEndian(height);
  header += {static_cast<char>(bits), static_cast<char>(colour), 0, 0, 0};
  return std::string("\x89PNG\r\n\x1a\n", 8) + PngChunk("IHDR", header) + PngChunk("IDAT", "") +
         PngChunk("IEND", "");
}

// A TIFF with one strip of 8 bytes.
std::string TiffOf(std::uint32_t width, std::uint32_t height, int bits, int channels,
                   int photometric = 1) {
  const std::vector<std::pair<int, std::uint32_t>> tags{
      {256, width}, {257, height},   {258, bits},   {259, 1}, {262, photometric},
      {273, 8},     {277, channels}, {278, height}, {279, 8}};
  std::string bytes = "II" + LittleEndian(42, 2) + LittleEndian(16, 4) + std::string(8, '\x40');
  bytes += LittleEndian(tags.size(), 2);
  for (const auto& [tag, value] : tags)
    bytes += LittleEndian(static_cast<std::uint64_t>(tag), 2) + LittleEndian(4, 2) +
             LittleEndian(1, 4) + LittleEndian(value, 4);
  return bytes + LittleEndian(0, 4);
}

std::string DecodeError(const std::string& bytes, const std::string& file, cv::Size expected = {}) {
  testing::internal::CaptureStderr();
  const auto image = DecodeImage(bytes, file, expected);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << file;
  EXPECT_FALSE(image) << file;
  return image ? "" : image.error().text;
}

struct Case {
  const char* name;
  int type;
};

class RoundTrip : public testing::TestWithParam<Case> {
 protected:
  TemporaryFolder folder_;
};

TEST_P(RoundTrip, GivesTheSamePixelsAndBytes) {
  const auto& [name, type] = GetParam();
  const cv::Mat image = Pattern(type, 61, 43);
  const auto path = folder_.path() / name;
  ASSERT_TRUE(WriteImage(path, image));
  const std::string bytes = ReadFile(path).value();
  const auto read = ReadImage(path, image.size());
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_TRUE(SamePixels(*read, image));
  ASSERT_TRUE(WriteImage(path, image));
  EXPECT_TRUE(ReadFile(path).value() == bytes) << "two writes differ";
}

TEST_P(RoundTrip, RefusesEveryTruncatedFile) {
  const auto& [name, type] = GetParam();
  const auto path = folder_.path() / name;
  const cv::Mat image = Pattern(type, 21, 33);
  ASSERT_TRUE(WriteImage(path, image));
  const std::string bytes = ReadFile(path).value();
  // A TIFF ends with the offset of a next picture, and with optional values; libtiff does without.
  const std::size_t optional = path.extension() == ".tif" || path.extension() == ".TIF" ? 32 : 0;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    if (length > 200 && length + 200 < bytes.size() && length % 13 != 0) continue;
    if (length + optional >= bytes.size()) {
      const auto read = DecodeImage(bytes.substr(0, length), name);
      EXPECT_TRUE(!read || SamePixels(*read, image)) << length;
    } else {
      EXPECT_THAT(DecodeError(bytes.substr(0, length), name), HasSubstr(name)) << length;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Values(Case{"g8.png", CV_8UC1}, Case{"c8.png", CV_8UC3},
                                         Case{"g16.png", CV_16UC1}, Case{"c16.png", CV_16UC3},
                                         Case{"g8.tif", CV_8UC1}, Case{"c8.tiff", CV_8UC3},
                                         Case{"g16.tif", CV_16UC1}, Case{"c16.TIF", CV_16UC3},
                                         Case{"g32.tif", CV_32FC1}, Case{"c32.tif", CV_32FC3},
                                         Case{"g32.exr", CV_32FC1}, Case{"c32.exr", CV_32FC3}),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           name[name.find('.')] = '_';
                           return name;
                         });

TEST(ImageFile, ColourIsRedGreenBlue) {
  const TemporaryFolder folder;
  const cv::Mat bgr(4, 4, CV_8UC3, cv::Scalar(30, 20, 10));
  for (const char* name : {"a.png", "a.tif"}) {
    ASSERT_TRUE(cv::imwrite((folder.path() / name).string(), bgr));
    const auto image = ReadImage(folder.path() / name);
    ASSERT_TRUE(image) << image.error().text;
    EXPECT_EQ(image->at<cv::Vec3b>(1, 2), cv::Vec3b(10, 20, 30)) << name;
  }
}

// Written by the library's own calls: half floats, and a data window away from the origin.
TEST(ImageFile, HalfFloatExrComesAsFloat) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "half.exr";
  {
    const Imath::Box2i window({-2, 5}, {0, 6});
    Imf::Header header(window, window);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    const half values[6] = {half(0.5f),  half(-1.0f),   half(2.0f),
                            half(0.25f), half(1000.0f), half(0.0f)};
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice::Make(Imf::HALF, values, window, sizeof(half), 3 * sizeof(half)));
    Imf::OutputFile file(path.string().c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  const auto image = ReadImage(path, {3, 2});
  ASSERT_TRUE(image) << image.error().text;
  const cv::Mat expected = (cv::Mat_<float>(2, 3) << 0.5f, -1.0f, 2.0f, 0.25f, 1000.0f, 0.0f);
  EXPECT_TRUE(SamePixels(*image, expected));
}

TEST(ImageFile, WrongSizeNamesBothSizes) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.tif", "a.exr"}) {
    ASSERT_TRUE(WriteImage(folder.path() / name, Pattern(name[2] == 'e' ? CV_32FC1 : CV_8UC1)));
    const auto image = ReadImage(folder.path() / name, {640, 480});
    ASSERT_FALSE(image);
    EXPECT_THAT(image.error().text,
                AllOf(HasSubstr(name), HasSubstr("16 x 12"), HasSubstr("640 x 480")));
  }
}

TEST(ImageFile, HugeHeadersAreRefusedBeforeMemoryIsTaken) {
  const std::string png = PngOf(100000, 100000, 8, 2);
  const std::string tiff = TiffOf(100000, 100000, 8, 1);
  EXPECT_THAT(DecodeError(png, "a.png"),
              AllOf(HasSubstr("a.png"), HasSubstr("100000 x 100000"), HasSubstr("268435456")));
  EXPECT_THAT(DecodeError(tiff, "a.tif"),
              AllOf(HasSubstr("a.tif"), HasSubstr("100000 x 100000"), HasSubstr("268435456")));
  EXPECT_THAT(DecodeError(png, "a.png", {640, 480}),
              AllOf(HasSubstr("100000 x 100000"), HasSubstr("640 x 480")));
  EXPECT_THAT(DecodeError(tiff, "a.tif", {640, 480}),
              AllOf(HasSubstr("100000 x 100000"), HasSubstr("640 x 480")));
  // Within the limit, but not in a file of this length.
  EXPECT_THAT(DecodeError(PngOf(16384, 16384, 16, 2), "a.png"), HasSubstr("truncated"));
  EXPECT_THAT(DecodeError(TiffOf(16384, 16384, 16, 1), "a.tif"), HasSubstr("truncated"));
}

TEST(ImageFile, OtherChannelsAndDepthsAreRefused) {
  std::vector<unsigned char> rgba;
  ASSERT_TRUE(cv::imencode(".png", cv::Mat(4, 4, CV_8UC4, cv::Scalar::all(9)), rgba));
  EXPECT_THAT(DecodeError({rgba.begin(), rgba.end()}, "a.png"),
              AllOf(HasSubstr("a.png"), HasSubstr("4 channels"), HasSubstr("allowed are grey")));
  ASSERT_TRUE(cv::imencode(".tif", cv::Mat(4, 4, CV_8UC4, cv::Scalar::all(9)), rgba));
  EXPECT_THAT(DecodeError({rgba.begin(), rgba.end()}, "a.tif"),
              AllOf(HasSubstr("4 channels"), HasSubstr("allowed are 1 (grey) and 3 (RGB)")));
  EXPECT_THAT(DecodeError(PngOf(4, 4, 8, 4), "a.png"), HasSubstr("2 channels"));
  EXPECT_THAT(DecodeError(PngOf(4, 4, 8, 3), "a.png"), HasSubstr("palette"));
  EXPECT_THAT(DecodeError(PngOf(4, 4, 4, 0), "a.png"), HasSubstr("4 bits"));
  EXPECT_THAT(DecodeError(TiffOf(4, 2, 4, 1), "a.tif"), HasSubstr("4 bits"));
  EXPECT_THAT(DecodeError(TiffOf(4, 2, 8, 1, 0), "a.tif"), HasSubstr("photometric"));
  EXPECT_THAT(DecodeError("", "a.jpg"), AllOf(HasSubstr("\".jpg\""), HasSubstr(".png, .tif")));
}

TEST(ImageFile, PlainTiffIsRead) {
  const auto image = DecodeImage(TiffOf(4, 2, 8, 1), "a.tif");
  ASSERT_TRUE(image) << image.error().text;
  EXPECT_TRUE(SamePixels(*image, cv::Mat(2, 4, CV_8U, 0x40)));
}

TEST(ImageFile, DamagedPngIsRefused) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteImage(folder.path() / "a.png", Pattern(CV_16UC3)));
  std::string bytes = ReadFile(folder.path() / "a.png").value();
  bytes[bytes.size() / 2] ^= 1;
  EXPECT_THAT(DecodeError(bytes, "a.png"), HasSubstr("checksum is wrong"));
  const std::string transparent = PngOf(4, 4, 8, 0);
  const std::size_t at = transparent.find("IDAT") - 4;
  EXPECT_THAT(DecodeError(transparent.substr(0, at) + PngChunk("tRNS", std::string(2, '\0')) +
                              transparent.substr(at),
                          "a.png"),
              HasSubstr("transparent"));
}

TEST(ImageFile, WriteRefusesWhatTheFormatCannotHold) {
  const TemporaryFolder folder;
  const auto text = [&](const char* name, int type) {
    const Status status = WriteImage(folder.path() / name, Pattern(type));
    return status ? "" : status.error().text;
  };
  EXPECT_THAT(text("a.png", CV_32FC1), HasSubstr("PNG holds 8 and 16 bits"));
  EXPECT_THAT(text("a.exr", CV_16UC1), HasSubstr("32-bit float"));
  EXPECT_THAT(text("a.png", CV_8UC4), HasSubstr("4 channels"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace turnlight::rig
