#include "rig/session/image_file.h"

#include <algorithm>
#include <cctype>
#include <exception>

#include "base/file.h"
#include "rig/session/image_formats.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
constexpr std::int64_t kMaxExpansion = 4096;

enum class Format { kPng, kTiff, kExr };

std::string ShowSize(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

Result<Format> FormatOf(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".png") return Format::kPng;
  if (extension == ".tif" || extension == ".tiff") return Format::kTiff;
  if (extension == ".exr") return Format::kExr;
  return InputError(
      file.string() + ": the extension is \"" + extension +
      "\", allowed are .png, .tif, .tiff and .exr" +
      (extension == ".jpg" || extension == ".jpeg"
           ? "; JPEG has changed the values, and converting it does not bring them back: "
             "have the camera write PNG or TIFF"
           : ""));
}

Result<Picture> Decode(const std::string& bytes, const fs::path& file, cv::Size expected,
                       PictureUse use) {
  const auto format = FormatOf(file);
  if (!format) return Forward(format);
  try {
    switch (*format) {
      case Format::kPng:
        return DecodePng(bytes, file.string(), expected, use);
      case Format::kTiff:
        return DecodeTiff(bytes, file.string(), expected, use);
      case Format::kExr:
        return DecodeExr(bytes, file.string(), expected, use);
    }
  } catch (const std::exception& error) {
    return InputError(file.string() + ": damaged or truncated: " + error.what());
  }
  return InputError(file.string() + ": unknown format");
}

bool Varies(const cv::Mat1b& values) {
  const int set = cv::countNonZero(values);
  return set > 0 && set < static_cast<int>(values.total());
}

cv::Mat1b MaskOf(const cv::Mat& image) {
  std::vector<cv::Mat> channels;
  cv::split(image, channels);
  const bool has_alpha = channels.size() == 2 || channels.size() == 4;
  const cv::Mat1b alpha =
      has_alpha ? cv::Mat1b(channels.back() != 0) : cv::Mat1b(image.size(), 255);
  if (has_alpha) channels.pop_back();
  cv::Mat1b colour(image.size(), 0);
  for (const cv::Mat& channel : channels) colour |= channel != 0;
  if (!Varies(alpha)) return colour;
  return Varies(colour) ? cv::Mat1b(colour & alpha) : alpha;
}

}  // namespace

Status CheckImageHeader(const ImageHeader& header, const std::string& file, cv::Size expected,
                        std::size_t file_bytes) {
  const std::string size = ShowSize(header.width, header.height);
  if (!expected.empty() && (header.width != expected.width || header.height != expected.height))
    return InputError(file + ": the picture is " + size + " pixels, allowed is " +
                      ShowSize(expected.width, expected.height) +
                      ", the size of the camera model's pictures");
  if (header.width < 1 || header.height < 1 || header.width > kMaxPixels / header.height)
    return InputError(file + ": the picture is " + size + " pixels, allowed are 1 to " +
                      std::to_string(kMaxPixels) + " pixels in all");
  const std::int64_t decoded = header.width * header.height * header.bits_per_pixel / 8;
  if (decoded / kMaxExpansion > static_cast<std::int64_t>(file_bytes))
    return InputError(file + ": truncated: the file's " + std::to_string(file_bytes) +
                      " bytes cannot hold a picture of " + size + " pixels");
  return {};
}

Result<Picture> DecodePicture(const std::string& bytes, const fs::path& file, cv::Size expected) {
  return Decode(bytes, file, expected, PictureUse::kFrame);
}

Result<cv::Mat> DecodeImage(const std::string& bytes, const fs::path& file, cv::Size expected) {
  auto picture = DecodePicture(bytes, file, expected);
  if (!picture) return Forward(picture);
  return std::move(picture->image);
}

Result<cv::Mat> ReadImage(const fs::path& path, cv::Size expected) {
  const auto bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  return DecodeImage(*bytes, path, expected);
}

Result<cv::Mat1b> DecodeMask(const std::string& bytes, const fs::path& file, cv::Size expected) {
  const auto picture = Decode(bytes, file, expected, PictureUse::kMask);
  if (!picture) return Forward(picture);
  try {
    return MaskOf(picture->image);
  } catch (const std::exception& error) {  // of OpenCV: no memory
    return SystemError(file.string() + ": " + error.what());
  }
}

Result<cv::Mat1b> ReadMask(const fs::path& path, cv::Size expected) {
  const auto bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  return DecodeMask(*bytes, path, expected);
}

Result<std::string> EncodeImage(const fs::path& path, const cv::Mat& image) {
  const auto format = FormatOf(path);
  if (!format) return Forward(format);
  if (image.empty() || (image.channels() != 1 && image.channels() != 3))
    return InputError(path.string() + ": the picture has " + std::to_string(image.channels()) +
                      " channels and " + std::to_string(image.total()) +
                      " pixels, allowed are 1 or 3 channels and at least one pixel");
  try {
    return *format == Format::kPng    ? EncodePng(image, path.string())
           : *format == Format::kTiff ? EncodeTiff(image, path.string())
                                      : EncodeExr(image, path.string());
  } catch (const std::exception& error) {
    return SystemError(path.string() + ": cannot encode the picture: " + error.what());
  }
}

Status WriteImage(const fs::path& path, const cv::Mat& image) {
  const auto bytes = EncodeImage(path, image);
  if (!bytes) return Forward(bytes);
  return WriteFileAtomic(path, *bytes);
}

}  // namespace turnlight::rig
