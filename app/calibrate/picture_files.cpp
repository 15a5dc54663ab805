#include "app/calibrate/picture_files.h"

#include <algorithm>
#include <cctype>
#include <opencv2/imgproc.hpp>
#include <set>

#include "base/file.h"
#include "base/format.h"
#include "rig/session/image_file.h"
#include "rig/session/jpeg_file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

std::string LowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

bool IsJpeg(const fs::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".jpg" || extension == ".jpeg";
}

namespace {

bool IsPicture(const fs::path& path) {
  const std::string extension = LowerExtension(path);
  return IsJpeg(path) || extension == ".png" || extension == ".tif" || extension == ".tiff";
}

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Takes a run of digits off the front, without its leading zeros.
std::string_view TakeDigits(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && IsDigit(text[end])) ++end;
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  return digits;
}

// Numbers within names by their value.
bool ComesBefore(const fs::path& a, const fs::path& b) {
  const std::string first = a.filename().string();
  const std::string second = b.filename().string();
  std::string_view x(first);
  std::string_view y(second);
  while (!x.empty() && !y.empty()) {
    if (IsDigit(x.front()) && IsDigit(y.front())) {
      const std::string_view m = TakeDigits(x);
      const std::string_view n = TakeDigits(y);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
      continue;
    }
    if (x.front() != y.front()) return x.front() < y.front();
    x.remove_prefix(1);
    y.remove_prefix(1);
  }
  if (x.empty() != y.empty()) return x.empty();
  return first < second;
}

Result<std::vector<fs::path>> PicturesIn(const fs::path& folder) {
  std::vector<fs::path> pictures;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (IsPicture(entry->path()) && !fs::is_directory(entry->path()))
      pictures.push_back(entry->path());
  if (error) return InputError(folder.string() + ": " + error.message());
  if (pictures.empty())
    return InputError(folder.string() + ": no pictures in it (.png, .tif, .tiff, .jpg, .jpeg)");
  std::sort(pictures.begin(), pictures.end(), ComesBefore);
  return pictures;
}

}  // namespace

Result<std::vector<fs::path>> ListPictures(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return InputError("no pictures named: give files or a folder");
  std::vector<fs::path> pictures;
  for (const std::string& argument : arguments) {
    std::error_code error;
    const auto status = fs::status(argument, error);
    if (!fs::exists(status))
      return InputError(argument + ": no such file or folder" + NearestPath(argument));
    if (!fs::is_directory(status)) {
      pictures.emplace_back(argument);
      continue;
    }
    const auto inside = PicturesIn(argument);
    if (!inside) return Forward(inside);
    pictures.insert(pictures.end(), inside->begin(), inside->end());
  }
  std::set<fs::path> seen;
  for (const fs::path& picture : pictures) {
    std::error_code error;
    const fs::path real = fs::canonical(picture, error);
    if (!seen.insert(error ? picture : real).second)
      return InputError(picture.string() + ": named twice");
  }
  return pictures;
}

Result<cv::Mat> ReadPicture(const fs::path& path) {
  if (!IsJpeg(path)) return rig::ReadImage(path);
  const auto bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  auto jpeg = rig::DecodeJpeg(*bytes, path.string(), rig::JpegChannels::kAsStored);
  if (!jpeg) return Forward(jpeg);
  return std::move(jpeg->image);
}

Result<GreyPicture> ReadGreyPicture(const fs::path& path) {
  GreyPicture picture;
  if (IsJpeg(path)) {
    const auto bytes = ReadFile(path);
    if (!bytes) return Forward(bytes);
    auto jpeg = rig::DecodeJpeg(*bytes, path.string());
    if (!jpeg) return Forward(jpeg);
    picture.grey = jpeg->image;
    if (jpeg->orientation != 1)
      picture.remarks.push_back(
          Format("EXIF says that it be turned (orientation %d); kept as the sensor has it",
                 jpeg->orientation));
    return picture;
  }
  if (!IsPicture(path))
    return InputError(path.string() + ": the extension is \"" + LowerExtension(path) +
                      "\", allowed are .png, .tif, .tiff, .jpg and .jpeg");
  auto image = rig::ReadImage(path);
  if (!image) return Forward(image);
  if (image->depth() != CV_8U && image->depth() != CV_16U)
    return InputError(path.string() +
                      ": a picture of floating-point numbers, allowed are 8 and 16 bits");
  if (image->channels() == 3) {
    cv::cvtColor(*image, picture.grey, cv::COLOR_RGB2GRAY);
  } else {
    picture.grey = *image;
  }
  return picture;
}

CommonSize FindCommonSize(const std::vector<cv::Size>& sizes) {
  CommonSize common;
  std::ptrdiff_t most = 0;
  for (const cv::Size& size : sizes) {
    const auto count = std::count(sizes.begin(), sizes.end(), size);
    if (size.empty() || count <= most) continue;
    most = count;
    common.size = size;
  }
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (!sizes[i].empty() && sizes[i] != common.size) common.others.push_back(i);
  return common;
}

}  // namespace turnlight::app
