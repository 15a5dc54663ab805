#include "rig/session/tiff_layout.h"

#include <map>
#include <string_view>

#include "rig/session/tiff_memory.h"

namespace turnlight::rig {
namespace {

constexpr int kNoPhotometric = 0xffff;
constexpr std::size_t kMostPages = 1000;

std::string Named(int value, const std::map<int, std::string>& names) {
  const auto name = names.find(value);
  return std::to_string(value) + (name == names.end() ? "" : " (" + name->second + ")");
}

std::string PhotometricName(int value) {
  if (value == kNoPhotometric) return "none";
  return Named(value, {{PHOTOMETRIC_MINISWHITE, "grey, white is 0"},
                       {PHOTOMETRIC_MINISBLACK, "grey, black is 0"},
                       {PHOTOMETRIC_RGB, "RGB"},
                       {PHOTOMETRIC_PALETTE, "palette"},
                       {PHOTOMETRIC_MASK, "mask"},
                       {PHOTOMETRIC_SEPARATED, "inks"},
                       {PHOTOMETRIC_YCBCR, "YCbCr"},
                       {PHOTOMETRIC_CIELAB, "CIE Lab"},
                       {PHOTOMETRIC_CFA, "colour mosaic"},
                       {PHOTOMETRIC_LOGL, "LogL"},
                       {PHOTOMETRIC_LOGLUV, "LogLuv"},
                       {34892, "DNG's linear raw"}});
}

bool IsFax(int compression) {
  return compression == COMPRESSION_CCITTRLE || compression == COMPRESSION_CCITTRLEW ||
         compression == COMPRESSION_CCITT_T4 || compression == COMPRESSION_CCITT_T6;
}

Status CheckCompression(TIFF* tiff, const std::string& file, PictureUse use) {
  const int compression =
      TiffField<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, std::uint16_t{COMPRESSION_NONE});
  switch (compression) {
    case COMPRESSION_NONE:
    case COMPRESSION_LZW:
    case COMPRESSION_DEFLATE:
    case COMPRESSION_ADOBE_DEFLATE:
    case COMPRESSION_PACKBITS:
    case COMPRESSION_SGILOG:
    case COMPRESSION_SGILOG24:
      return {};
    default:
      break;
  }
  if (use == PictureUse::kMask && IsFax(compression)) return {};
  return InputError(file + ": TIFF compression " +
                    Named(compression, {{COMPRESSION_JPEG, "JPEG, which changes values"},
                                        {COMPRESSION_OJPEG, "old JPEG, which changes values"},
                                        {COMPRESSION_LZMA, "LZMA"},
                                        {COMPRESSION_ZSTD, "Zstandard"},
                                        {COMPRESSION_WEBP, "WebP"},
                                        {COMPRESSION_CCITT_T6, "fax"},
                                        {34712, "JPEG 2000"}}) +
                    ", allowed are none, LZW, deflate and PackBits");
}

// The kind and size of samples, and the depth of a picture that holds them without loss.
Status ReadSamples(TIFF* tiff, const std::string& file, PictureUse use, TiffLayout& layout) {
  const int bits = TiffField<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  const int format =
      TiffField<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, std::uint16_t{SAMPLEFORMAT_UINT});
  const int least = use == PictureUse::kMask ? 1 : 8;
  layout.bits = bits;
  const bool is_unsigned = format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID;
  if (is_unsigned && ((bits >= least && bits <= 16) || bits == 32)) {
    layout.sample = TiffSample::kUnsigned;
    layout.depth = bits <= 8 ? CV_8U : bits <= 16 ? CV_16U : CV_32F;
    return {};
  }
  layout.depth = CV_32F;
  layout.sample = format == SAMPLEFORMAT_INT ? TiffSample::kSigned : TiffSample::kFloat;
  if (format == SAMPLEFORMAT_INT && (bits == 8 || bits == 16 || bits == 32)) return {};
  if (format == SAMPLEFORMAT_IEEEFP && (bits == 16 || bits == 32 || bits == 64)) return {};
  return InputError(file + ": TIFF samples of " + std::to_string(bits) + " bits, format " +
                    Named(format, {{SAMPLEFORMAT_UINT, "unsigned"},
                                   {SAMPLEFORMAT_INT, "signed"},
                                   {SAMPLEFORMAT_IEEEFP, "float"},
                                   {SAMPLEFORMAT_COMPLEXINT, "complex"},
                                   {SAMPLEFORMAT_COMPLEXIEEEFP, "complex"}}) +
                    ", allowed are 8 to 16 and 32 bits unsigned, 8, 16 and 32 bits signed, and "
                    "16, 32 and 64 bits float");
}

// Values in logarithms of brightness, which libtiff turns into CIE XYZ or Y as floats.
void ReadLogarithms(TIFF* tiff, int photometric, TiffLayout& layout) {
  TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);
  const bool grey = photometric == PHOTOMETRIC_LOGL;
  layout.bits = 32;
  layout.sample = grey ? TiffSample::kLogL : TiffSample::kLogLuv;
  layout.channels = grey ? 1 : 3;
  layout.depth = CV_32F;
  layout.remarks.emplace_back(
      grey ? "a LogL TIFF, whose values are rounded to 0.3 %: read as linear; better write plain "
             "32-bit float"
           : "a LogLuv TIFF, whose values are rounded to 0.3 % and colours more: read as linear R, "
             "G, B of the primaries of sRGB; better write plain 32-bit float "
             "(OpenCV: IMWRITE_TIFF_COMPRESSION, 1)");
}

Status CheckFrameChannels(int photometric, int samples, int extra, const std::string& file,
                          TiffLayout& layout) {
  if (samples != 1 && samples != 3)
    return InputError(
        file + ": " + std::to_string(samples) + " channels" +
        (extra > 0 ? ", of which " + std::to_string(extra) + " beyond the colours (alpha)" : "") +
        ", allowed are 1 (grey) and 3 (RGB)" + (extra > 0 ? "; export without alpha" : ""));
  if (photometric == PHOTOMETRIC_MINISWHITE)
    return InputError(file + ": TIFF photometric interpretation " + PhotometricName(photometric) +
                      ": its values run against the light; allowed are 1 (grey, black is 0) and 2 "
                      "(RGB)");
  if (samples == 1 && photometric == PHOTOMETRIC_MINISBLACK) return {};
  if (samples == 3 && photometric == PHOTOMETRIC_RGB) return {};
  if (photometric == PHOTOMETRIC_MINISBLACK || photometric == kNoPhotometric) {
    layout.remarks.push_back(std::to_string(samples) + (samples == 1 ? " channel" : " channels") +
                             " with the photometric interpretation " +
                             PhotometricName(photometric) +
                             (samples == 1 ? ": read as grey" : ": read as R, G, B"));
    return {};
  }
  return InputError(file + ": TIFF photometric interpretation " + PhotometricName(photometric) +
                    " with " + std::to_string(samples) + (samples == 1 ? " channel" : " channels") +
                    ", allowed are 1 (grey, black is 0) with 1 channel and 2 (RGB) with 3");
}

Status CheckMaskChannels(int photometric, int samples, const std::string& file,
                         TiffLayout& layout) {
  layout.inverted = photometric == PHOTOMETRIC_MINISWHITE;
  layout.palette = photometric == PHOTOMETRIC_PALETTE;
  const bool known = photometric == PHOTOMETRIC_MINISWHITE ||
                     photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_RGB ||
                     photometric == PHOTOMETRIC_PALETTE || photometric == kNoPhotometric;
  if (!known)
    return InputError(file + ": TIFF photometric interpretation " + PhotometricName(photometric) +
                      ", allowed in a mask are 0 and 1 (grey), 2 (RGB) and 3 (palette)");
  const bool plain = layout.sample == TiffSample::kUnsigned && layout.bits <= 16;
  if (layout.palette && !(plain && layout.bits <= 8 && samples == 1))
    return InputError(file + ": a palette of " + std::to_string(layout.bits) + " bits and " +
                      std::to_string(samples) + " channels, allowed are 1 to 8 bits and 1 channel");
  if (layout.inverted && !(plain && samples <= 2))
    return InputError(file + ": a mask whose white is 0, allowed are 1 to 16 bits and 1 channel");
  if (samples > 4)
    return InputError(file + ": " + std::to_string(samples) +
                      " channels, allowed in a mask are 1 (grey) and 3 (RGB), with or without "
                      "alpha");
  return {};
}

// ImageJ's description has a line "key=value" each.
std::string ImageJValue(std::string_view text, std::string_view key) {
  if (!text.starts_with("ImageJ=")) return "";
  const std::string begin = "\n" + std::string(key) + "=";
  const std::size_t at = text.find(begin);
  if (at == std::string_view::npos) return "";
  const std::size_t from = at + begin.size();
  return std::string(text.substr(from, text.find_first_of("\r\n", from) - from));
}

bool SaysColour(std::string_view description) {
  const std::string mode = ImageJValue(description, "mode");
  const auto single = [&](std::string_view key) {
    const std::string value = ImageJValue(description, key);
    return value.empty() || value == "1";
  };
  return ImageJValue(description, "channels") == "3" && single("slices") && single("frames") &&
         (mode == "composite" || mode == "color");
}

}  // namespace

Result<TiffLayout> LayoutOfPage(TIFF* tiff, const std::string& file, PictureUse use) {
  TiffLayout layout;
  layout.width = TiffField<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
  layout.height = TiffField<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
  if (const auto slices = TiffField<std::uint32_t>(tiff, TIFFTAG_IMAGEDEPTH, 1); slices != 1)
    return InputError(file + ": a TIFF of " + std::to_string(slices) + " slices, allowed is one");
  const int samples = TiffField<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  const int photometric =
      TiffField<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, std::uint16_t{kNoPhotometric});
  const int orientation =
      TiffField<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, std::uint16_t{ORIENTATION_TOPLEFT});
  std::uint16_t extra = 0;
  const std::uint16_t* kinds = nullptr;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_EXTRASAMPLES, &extra, &kinds);
  if (orientation != ORIENTATION_TOPLEFT)
    return InputError(file + ": " + TurnedText(orientation, "the TIFF's Orientation tag"));
  if (Status status = CheckCompression(tiff, file, use); !status) return Forward(status);
  layout.planes = samples > 1 && TiffField<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG,
                                                          std::uint16_t{PLANARCONFIG_CONTIG}) ==
                                     PLANARCONFIG_SEPARATE;
  layout.channels = samples;
  const int compression =
      TiffField<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, std::uint16_t{COMPRESSION_NONE});
  const bool logarithms = compression == COMPRESSION_SGILOG || compression == COMPRESSION_SGILOG24;
  if (logarithms && use == PictureUse::kFrame && !layout.planes &&
      ((photometric == PHOTOMETRIC_LOGL && samples == 1) ||
       (photometric == PHOTOMETRIC_LOGLUV && samples == 3))) {
    ReadLogarithms(tiff, photometric, layout);
    return layout;
  }
  if (logarithms)
    return InputError(file + ": TIFF compression " + std::to_string(compression) +
                      " (LogLuv) with the photometric interpretation " +
                      PhotometricName(photometric) + ", which is not read" +
                      (use == PictureUse::kMask ? " as a mask" : ""));
  Status status = ReadSamples(tiff, file, use, layout);
  if (status)
    status = use == PictureUse::kFrame
                 ? CheckFrameChannels(photometric, samples, extra, file, layout)
                 : CheckMaskChannels(photometric, samples, file, layout);
  if (!status) return Forward(status);
  return layout;
}

Result<std::vector<tdir_t>> PagesOfPicture(TIFF* tiff, const std::string& file) {
  const char* text = nullptr;
  TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text);
  const std::string description = text ? text : "";
  std::vector<tdir_t> pages;
  tdir_t all = 0;
  do {
    const auto kind = TiffField<std::uint32_t>(tiff, TIFFTAG_SUBFILETYPE, 0);
    if ((kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) == 0) pages.push_back(all);
    ++all;
  } while (all <= kMostPages && TIFFReadDirectory(tiff) == 1);
  const std::string allowed =
      ", allowed is one, or three that ImageJ's description names as the channels of a composite";
  if (all > kMostPages)
    return InputError(file + ": a TIFF of more than " + std::to_string(kMostPages) + " pages" +
                      allowed);
  if (pages.empty())
    return InputError(file + ": a TIFF whose " + std::to_string(all) +
                      " page(s) are thumbnails or masks, allowed is a whole picture as a page");
  const std::string images = ImageJValue(description, "images");
  if (pages.size() == 1 && !images.empty() && images != "1")
    return InputError(file + ": a TIFF of 1 page, of which ImageJ says that it is " + images +
                      " pictures" + allowed);
  if (pages.size() == 1 || (pages.size() == 3 && SaysColour(description))) return pages;
  return InputError(file + ": a TIFF of " + std::to_string(pages.size()) + " pages" + allowed +
                    "; save each picture as a file of its own");
}

}  // namespace turnlight::rig
