// The first byte says what the rest is: '0' a session.json in a folder that is otherwise sound, '1'
// a PNG, '2' a TIFF, '3' an OpenEXR picture, '4' a PNG and '5' a TIFF that are masks. Refused with
// a message that names the file, or read into something that keeps its promises.
#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <string>

#include "rig/session/image_file.h"
#include "rig/session/session.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;

void Require(bool condition) {
  if (!condition) std::abort();
}

void Put(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// A folder with a camera, two pictures, a mask and a mesh, gone at exit.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "session_fuzz.XXXXXX").string();
    root_ = mkdtemp(name.data());
    fs::create_directories(root_ / "frames");
    const auto camera = calib::CameraModel::Pinhole(8, 6, 20.0, 20.0, 3.5, 2.5);
    Put(root_ / "camera.cameramodel", camera.ToString());
    Put(root_ / "target.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    Require(WriteImage(root_ / "frames/000.png", cv::Mat(6, 8, CV_16UC3, cv::Scalar::all(900)))
                .has_value());
    Require(WriteImage(root_ / "frames/001.png", cv::Mat(6, 8, CV_8UC1, cv::Scalar::all(90)))
                .has_value());
    Require(WriteImage(root_ / "frames/mask.png", cv::Mat(6, 8, CV_8UC1, cv::Scalar::all(255)))
                .has_value());
  }
  ~Folder() { fs::remove_all(root_); }
  const fs::path& root() const { return root_; }

 private:
  fs::path root_;
};

void CheckSession(const std::string& text) {
  static const Folder folder;
  Put(folder.root() / "session.json", text);
  const auto session = ReadSession(folder.root());
  if (!session) {
    Require(session.error().text.starts_with(folder.root().string()));
    return;
  }
  Require(session->camera.has_value() && !session->frames.empty());
  Require(ReadTarget(*session).has_value() || std::holds_alternative<MeshFile>(session->target));
  for (std::size_t i = 0; i < std::min<std::size_t>(session->frames.size(), 4); ++i) {
    const auto images = ReadFrameImages(*session, i);
    Require(!images || (images->image.size() == cv::Size(8, 6) &&
                        images->mask.size() == images->image.size()));
  }
  // The camera is left alone: it may be any file of the folder.
  Session copy = *session;
  copy.camera_path = "copy.cameramodel";
  Require(WriteSession(copy, folder.root()).has_value());
  const auto again = ReadSession(folder.root());
  fs::remove(folder.root() / "copy.cameramodel");
  Require(again && again->frames.size() == session->frames.size());
  for (std::size_t i = 0; i < session->frames.size(); ++i)
    Require(calib::RowsFromPose(again->frames[i].X_WT) ==
            calib::RowsFromPose(session->frames[i].X_WT));
}

// Gives every chunk the checksum it should have: a mutation almost never hits it.
std::string WithPngChecksums(std::string bytes) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  for (std::size_t start = 8; start + 12 <= bytes.size();) {
    const std::size_t length =
        std::size_t{at(start)} << 24 | at(start + 1) << 16 | at(start + 2) << 8 | at(start + 3);
    if (length > bytes.size() - start - 12) break;
    const auto sum =
        crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data() + start + 4), length + 4);
    for (std::size_t i = 0; i < 4; ++i)
      bytes[start + 8 + length + i] = static_cast<char>(sum >> (24 - 8 * i));
    start += length + 12;
  }
  return bytes;
}

void CheckImage(const std::string& bytes, const std::string& file) {
  const auto picture = DecodePicture(bytes, file);
  if (!picture) {
    Require(picture.error().text.starts_with(file));
    return;
  }
  const cv::Mat* const image = &picture->image;
  Require(!image->empty() && (image->channels() == 1 || image->channels() == 3));
  Require(image->depth() == CV_8U || image->depth() == CV_16U || image->depth() == CV_32F);
  cv::Scalar mean = cv::mean(*image);  // touches every pixel
  Require(mean[3] == 0.0);
  Require(DecodeImage(bytes, file, image->size()).has_value());
  Require(!DecodeImage(bytes, file, {image->cols + 1, image->rows}));
  const PictureFacts facts{file, picture->claims,
                           MeasureLevels(*image, cv::Mat1b(image->size(), std::uint8_t{255}))};
  for (const PictureNote& note : PictureNotes({}, {facts}))
    Require(!note.code.empty() && !note.text.empty());
}

void CheckMask(const std::string& bytes, const std::string& file) {
  const auto mask = DecodeMask(bytes, file);
  if (!mask) {
    Require(mask.error().text.starts_with(file));
    return;
  }
  Require(!mask->empty() && cv::countNonZero((*mask != 0) & (*mask != 255)) == 0);
  Require(DecodeMask(bytes, file, mask->size()).has_value());
}

}  // namespace
}  // namespace turnlight::rig

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 6) {
    case 0:
      turnlight::rig::CheckSession(bytes);
      break;
    case 1:
      turnlight::rig::CheckImage(turnlight::rig::WithPngChecksums(bytes), "fuzz.png");
      break;
    case 2:
      turnlight::rig::CheckImage(bytes, "fuzz.tif");
      break;
    case 3:
      turnlight::rig::CheckImage(bytes, "fuzz.exr");
      break;
    case 4:
      turnlight::rig::CheckMask(turnlight::rig::WithPngChecksums(bytes), "fuzz.png");
      break;
    default:
      turnlight::rig::CheckMask(bytes, "fuzz.tif");
      break;
  }
  return 0;
}
