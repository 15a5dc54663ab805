#include "rig/session/png_chunks.h"

#include <zlib.h>

#include <array>
#include <string_view>

namespace turnlight::rig {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t kHeaderBytes = 13;
constexpr std::size_t kMostProfileBytes = std::size_t{1} << 22;

std::uint32_t BigEndian32(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
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

Status CheckKind(int bits, int colour, const std::string& file, PictureUse use) {
  if (colour != kPngGrey && colour != kPngRgb && use == PictureUse::kFrame)
    return InputError(file + ": PNG colour type " + std::to_string(colour) + " (" +
                      (colour == kPngPalette ? "palette"
                       : colour == 4         ? "grey with alpha, 2 channels"
                       : colour == 6         ? "RGB with alpha, 4 channels"
                                             : "unknown") +
                      "), allowed are grey (0) and RGB (2)" +
                      (colour == 4 || colour == 6 ? "; export without alpha" : ""));
  if (bits != 8 && bits != 16 && use == PictureUse::kFrame)
    return InputError(file + ": " + std::to_string(bits) +
                      " bits per channel, allowed are 8 and 16 in a PNG");
  const bool known = colour == kPngGrey || colour == kPngRgb || colour == kPngPalette ||
                     colour == 4 || colour == 6;
  const bool small = bits == 1 || bits == 2 || bits == 4;
  const bool fits = colour == kPngGrey      ? small || bits == 8 || bits == 16
                    : colour == kPngPalette ? small || bits == 8
                                            : bits == 8 || bits == 16;
  if (!known || !fits)
    return InputError(file + ": damaged PNG: colour type " + std::to_string(colour) + " with " +
                      std::to_string(bits) + " bits, which no PNG has");
  return {};
}

Status ReadHeader(std::string_view data, const std::string& file, cv::Size expected,
                  std::size_t file_bytes, PictureUse use, PngChunks& png) {
  static constexpr std::array<int, 7> kChannels = {1, 1, 3, 1, 2, 1, 4};
  png.bits = static_cast<unsigned char>(data[8]);
  png.colour = static_cast<unsigned char>(data[9]);
  if (Status status = CheckKind(png.bits, png.colour, file, use); !status) return status;
  const ImageHeader header{BigEndian32(data), BigEndian32(data.substr(4)),
                           png.bits * kChannels[static_cast<std::size_t>(png.colour)]};
  if (Status status = CheckImageHeader(header, file, expected, file_bytes); !status) return status;
  png.width = static_cast<int>(header.width);
  png.height = static_cast<int>(header.height);
  return {};
}

// Name, zero, compression method 0, a deflated ICC profile.
std::optional<TransferClaim> ProfileClaim(std::string_view data) {
  const std::size_t end = data.substr(0, 80).find('\0');
  if (end == std::string_view::npos || end + 2 > data.size()) return {};
  data.remove_prefix(end + 2);
  std::string profile(kMostProfileBytes, '\0');
  uLongf length = profile.size();
  uLong taken = data.size();
  if (uncompress2(reinterpret_cast<Bytef*>(profile.data()), &length,
                  reinterpret_cast<const Bytef*>(data.data()), &taken) != Z_OK)
    return {};
  return IccClaim(std::string_view(profile).substr(0, length));
}

// What one chunk says of the transfer, by PNG's order of precedence: the first that says anything.
constexpr std::array<std::string_view, 5> kByPrecedence = {"cICP", "iCCP", "sRGB", "gAMA", "eXIf"};

std::optional<TransferClaim> ClaimOf(const Chunk& chunk) {
  if (chunk.type == "cICP" && chunk.data.size() == 4)
    return CicpClaim(static_cast<unsigned char>(chunk.data[1]));
  if (chunk.type == "iCCP") return ProfileClaim(chunk.data);
  if (chunk.type == "sRGB") return TransferClaim{Transfer::kSrgb, 2.2, "the sRGB chunk"};
  if (chunk.type == "gAMA" && chunk.data.size() == 4) {
    const double exponent = BigEndian32(chunk.data) / 1e5;
    if (exponent < 0.1 || exponent > 10.0) return {};
    return GammaClaim(exponent, "the gAMA chunk (" + std::to_string(BigEndian32(chunk.data)) + ")");
  }
  if (chunk.type == "eXIf" && ReadExif(chunk.data).srgb)
    return TransferClaim{Transfer::kSrgb, 2.2, "EXIF's ColorSpace (1)"};
  return {};
}

struct Claims {
  std::array<bool, kByPrecedence.size()> seen{};  // of each kind the first counts
  std::array<std::optional<TransferClaim>, kByPrecedence.size()> transfers;
};

// What the chunks beside the pixels forbid or say.
Status ReadAncillary(const Chunk& chunk, const std::string& file, PictureUse use, Claims& claims) {
  if (chunk.type == "tRNS" && use == PictureUse::kFrame)
    return InputError(file + ": a PNG with a transparent colour, allowed are grey and RGB");
  if (chunk.type == "acTL" && chunk.data.size() == 8 && BigEndian32(chunk.data) > 1)
    return InputError(file + ": an animated PNG of " + std::to_string(BigEndian32(chunk.data)) +
                      " pictures, allowed is one picture");
  if (chunk.type == "eXIf")
    if (const int orientation = ReadExif(chunk.data).orientation; orientation != 1)
      return InputError(file + ": " + TurnedText(orientation, "the eXIf chunk"));
  if (use == PictureUse::kMask) return {};
  for (std::size_t i = 0; i < kByPrecedence.size(); ++i) {
    if (chunk.type != kByPrecedence[i] || claims.seen[i]) continue;
    claims.seen[i] = true;
    claims.transfers[i] = ClaimOf(chunk);
  }
  return {};
}

bool IsOfPixels(std::string_view type, PictureUse use) {
  return type == "IHDR" || type == "IDAT" || type == "IEND" ||
         (use == PictureUse::kMask && (type == "PLTE" || type == "tRNS"));
}

}  // namespace

Result<PngChunks> WalkPng(const std::string& bytes, const std::string& file, cv::Size expected,
                          PictureUse use) {
  std::string_view rest(bytes);
  if (!rest.starts_with(kSignature))
    return InputError(file + ": not a PNG file: its first 8 bytes are not PNG's signature");
  rest.remove_prefix(kSignature.size());
  PngChunks png;
  png.pixels = kSignature;
  Claims claims;
  for (bool first = true;; first = false) {
    const auto chunk = TakeChunk(rest, file);
    if (!chunk) return Forward(chunk);
    Status status;
    if (first) {
      if (chunk->type != "IHDR" || chunk->data.size() != kHeaderBytes)
        return InputError(file + ": damaged PNG: it does not begin with a header chunk");
      status = ReadHeader(chunk->data, file, expected, bytes.size(), use, png);
    } else {
      status = ReadAncillary(*chunk, file, use, claims);
    }
    if (!status) return Forward(status);
    if (IsOfPixels(chunk->type, use)) png.pixels += chunk->whole;
    if (chunk->type != "IEND") continue;
    for (const auto& claim : claims.transfers)
      if (!png.claims.transfer) png.claims.transfer = claim;
    return png;
  }
}

}  // namespace turnlight::rig
