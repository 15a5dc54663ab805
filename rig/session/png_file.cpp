// PNG by OpenCV (libpng), after this file has walked the chunks: the size is checked before memory
// is taken, damage is told by its kind, palettes and alpha are seen before they are converted away,
// and the decoder, which writes to standard error about damage and odd chunks, gets neither.
#include <zlib.h>

#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <vector>

#include "rig/session/image_formats.h"

namespace turnlight::rig {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t kHeaderBytes = 13;
constexpr int kGrey = 0;
constexpr int kRgb = 2;

std::uint32_t BigEndian32(std::string_view bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

struct Chunk {
  std::string_view type;
  std::string_view data;
  std::string_view whole;  // length, type, data and checksum
};

// Takes the first chunk off `rest` and checks its length and checksum.
Result<Chunk> TakeChunk(std::string_view& rest, const std::string& file) {
  if (rest.size() < 12) return InputError(file + ": truncated PNG: it ends before its end chunk");
  const std::size_t length = BigEndian32(rest);
  if (length > rest.size() - 12)
    return InputError(file + ": truncated PNG: a chunk of " + std::to_string(length) +
                      " bytes, but " + std::to_string(rest.size() - 12) + " are left");
  const Chunk chunk{rest.substr(4, 4), rest.substr(8, length), rest.substr(0, length + 12)};
  const auto* checked = reinterpret_cast<const Bytef*>(rest.data() + 4);
  if (crc32_z(0, checked, length + 4) != BigEndian32(rest.substr(8 + length)))
    return InputError(file + ": damaged PNG: a chunk's checksum is wrong");
  rest.remove_prefix(chunk.whole.size());
  return chunk;
}

Status CheckHeader(std::string_view data, const std::string& file, cv::Size expected,
                   std::size_t file_bytes) {
  const int bits = data[8];
  const int colour = data[9];
  if (colour != kGrey && colour != kRgb)
    return InputError(file + ": PNG colour type " + std::to_string(colour) + " (" +
                      (colour == 3   ? "palette"
                       : colour == 4 ? "grey with alpha, 2 channels"
                       : colour == 6 ? "RGB with alpha, 4 channels"
                                     : "unknown") +
                      "), allowed are grey (0) and RGB (2)");
  if (bits != 8 && bits != 16)
    return InputError(file + ": " + std::to_string(bits) +
                      " bits per channel, allowed are 8 and 16 in a PNG");
  const ImageHeader header{BigEndian32(data), BigEndian32(data.substr(4)),
                           (bits / 8) * (colour == kRgb ? 3 : 1)};
  return CheckImageHeader(header, file, expected, file_bytes);
}

// The chunks that make up the pixels, all checked, without the optional ones.
Result<std::string> PixelChunks(const std::string& bytes, const std::string& file,
                                cv::Size expected) {
  std::string_view rest(bytes);
  if (!rest.starts_with(kSignature))
    return InputError(file + ": not a PNG file: its first 8 bytes are not PNG's signature");
  rest.remove_prefix(kSignature.size());
  std::string kept(kSignature);
  for (bool first = true;; first = false) {
    const auto chunk = TakeChunk(rest, file);
    if (!chunk) return Forward(chunk);
    if (first) {
      if (chunk->type != "IHDR" || chunk->data.size() != kHeaderBytes)
        return InputError(file + ": damaged PNG: it does not begin with a header chunk");
      const Status status = CheckHeader(chunk->data, file, expected, bytes.size());
      if (!status) return Forward(status);
    }
    if (chunk->type == "tRNS")
      return InputError(file + ": a PNG with a transparent colour, allowed are grey and RGB");
    if (chunk->type == "IHDR" || chunk->type == "IDAT" || chunk->type == "IEND")
      kept += chunk->whole;
    if (chunk->type == "IEND") return kept;
  }
}

}  // namespace

Result<cv::Mat> DecodePng(const std::string& bytes, const std::string& file, cv::Size expected) {
  const auto chunks = PixelChunks(bytes, file, expected);
  if (!chunks) return Forward(chunks);
  if (chunks->size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return InputError(file + ": a PNG of more than 2^31 bytes");
  const cv::Mat view(1, static_cast<int>(chunks->size()), CV_8U, const_cast<char*>(chunks->data()));
  cv::Mat image = cv::imdecode(view, cv::IMREAD_UNCHANGED);
  if (image.empty() || (image.channels() != 1 && image.channels() != 3))
    return InputError(file + ": damaged or truncated PNG: its pixels cannot be decoded");
  if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  return image;
}

Result<std::string> EncodePng(const cv::Mat& image, const std::string& file) {
  if (image.depth() != CV_8U && image.depth() != CV_16U)
    return InputError(file + ": PNG holds 8 and 16 bits, not this depth; use .tif or .exr");
  cv::Mat bgr;  // not the caller's pixels
  if (image.channels() == 3) cv::cvtColor(image, bgr, cv::COLOR_RGB2BGR);
  std::vector<unsigned char> buffer;
  if (!cv::imencode(".png", bgr.empty() ? image : bgr, buffer))
    return SystemError(file + ": cannot encode the PNG");
  return std::string(buffer.begin(), buffer.end());
}

}  // namespace turnlight::rig
