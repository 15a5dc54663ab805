#include "rig/session/picture_claims.h"

#include <lcms2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/format.h"
#include "calib/transfer.h"

namespace turnlight::rig {
namespace {

// Two encodings that differ by less are the same: writers round.
constexpr double kSameGamma = 0.05;      // relative
constexpr double kSameCurve = 0.01;      // of white
constexpr double kLeastSrgbGamma = 2.0;  // gammas that stand for sRGB
constexpr double kMostSrgbGamma = 2.4;
constexpr int kCurveSamples = 65;
constexpr std::size_t kMostName = 80;

bool IsAboutOne(double gamma) { return std::abs(gamma - 1.0) <= kSameGamma; }
bool IsAboutSrgb(double gamma) { return gamma >= kLeastSrgbGamma && gamma <= kMostSrgbGamma; }

template <typename Function>
double LargestDifference(const std::vector<double>& samples, Function function) {
  double largest = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double stored = static_cast<double>(i) / static_cast<double>(samples.size() - 1);
    largest = std::max(largest, std::abs(samples[i] - function(stored)));
  }
  return largest;
}

// Of the middle half, where neither black nor white decides.
double MeanGamma(const std::vector<double>& samples) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = samples.size() / 4; i < samples.size() * 3 / 4; ++i) {
    const double stored = static_cast<double>(i) / static_cast<double>(samples.size() - 1);
    if (!(samples[i] > 0.0)) continue;
    sum += std::log(samples[i]) / std::log(stored);
    ++count;
  }
  return count > 0 ? sum / count : 1.0;
}

// A number of a TIFF's bytes, of either order; 0 beyond their end.
unsigned TiffNumber(std::string_view tiff, std::size_t at, int count) {
  const bool little = tiff.starts_with("II");
  unsigned value = 0;
  for (int i = 0; i < count; ++i) {
    const std::size_t place = at + static_cast<std::size_t>(little ? count - 1 - i : i);
    if (place >= tiff.size()) return 0;
    value = value << 8 | static_cast<unsigned char>(tiff[place]);
  }
  return value;
}

// The value of a tag of one number in the folder at `folder`; 0 if it has none.
unsigned TiffValue(std::string_view tiff, std::size_t folder, unsigned tag) {
  constexpr unsigned kShort = 3;
  const unsigned entries = TiffNumber(tiff, folder, 2);
  for (unsigned i = 0; i < entries; ++i) {
    const std::size_t entry = folder + 2 + std::size_t{12} * i;
    if (entry >= tiff.size()) return 0;
    if (TiffNumber(tiff, entry, 2) != tag) continue;
    return TiffNumber(tiff, entry + 8, TiffNumber(tiff, entry + 2, 2) == kShort ? 2 : 4);
  }
  return 0;
}

std::string ProfileName(cmsHPROFILE profile) {
  std::array<char, 256> text{};
  cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", text.data(),
                         static_cast<cmsUInt32Number>(text.size() - 1));
  std::string name(text.data());
  return name.substr(0, kMostName);
}

}  // namespace

TransferClaim GammaClaim(double exponent, const std::string& said_by) {
  const double gamma = 1.0 / exponent;
  return {IsAboutOne(gamma) ? Transfer::kLinear : Transfer::kGamma, gamma, said_by};
}

TransferClaim CurveClaim(const std::vector<double>& samples, const std::string& said_by) {
  TransferClaim claim{Transfer::kOther, MeanGamma(samples), said_by};
  calib::Radiometry srgb;
  srgb.encoding = calib::Encoding::kSrgb;
  const calib::Transfer transfer(srgb);
  if (LargestDifference(samples, [](double x) { return x; }) < kSameCurve)
    claim.kind = Transfer::kLinear;
  else if (LargestDifference(samples, [&](double x) { return transfer.Decode(x); }) < kSameCurve)
    claim.kind = Transfer::kSrgb;
  else if (LargestDifference(samples, [&](double x) { return std::pow(x, claim.gamma); }) <
           kSameCurve)
    claim.kind = Transfer::kGamma;
  return claim;
}

std::optional<TransferClaim> CicpClaim(int code) {
  const std::string said_by = "the cICP chunk (transfer characteristics " + std::to_string(code);
  switch (code) {
    case 8:
      return TransferClaim{Transfer::kLinear, 1.0, said_by + ")"};
    case 13:
      return TransferClaim{Transfer::kSrgb, 2.2, said_by + ")"};
    case 4:
      return TransferClaim{Transfer::kGamma, 2.2, said_by + ")"};
    case 5:
      return TransferClaim{Transfer::kGamma, 2.8, said_by + ")"};
    case 1:
    case 6:
    case 14:
    case 15:
      return TransferClaim{Transfer::kOther, 2.0, said_by + ", BT.709)"};
    case 16:
      return TransferClaim{Transfer::kOther, 2.2, said_by + ", PQ)"};
    case 18:
      return TransferClaim{Transfer::kOther, 2.2, said_by + ", HLG)"};
    default:
      return {};
  }
}

std::optional<TransferClaim> IccClaim(std::string_view bytes) {
  const std::unique_ptr<void, decltype(&cmsCloseProfile)> profile(
      cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())),
      cmsCloseProfile);
  if (!profile) return {};
  const void* tag = nullptr;
  for (const cmsTagSignature name : {cmsSigRedTRCTag, cmsSigGrayTRCTag})
    if (!tag && cmsIsTag(profile.get(), name)) tag = cmsReadTag(profile.get(), name);
  if (!tag) return {};
  const auto* curve = static_cast<const cmsToneCurve*>(tag);
  std::vector<double> samples;
  for (int i = 0; i < kCurveSamples; ++i) {
    const float light = cmsEvalToneCurveFloat(curve, static_cast<float>(i) / (kCurveSamples - 1));
    samples.push_back(std::isfinite(light) ? std::clamp(double{light}, 0.0, 1.0) : 0.0);
  }
  return CurveClaim(samples, "the ICC profile \"" + ProfileName(profile.get()) + "\"");
}

ExifClaims ReadExif(std::string_view tiff) {
  constexpr unsigned kTiff = 42, kOrientation = 0x0112, kExifFolder = 0x8769, kColorSpace = 0xa001;
  ExifClaims claims;
  if (!tiff.starts_with("II") && !tiff.starts_with("MM")) return claims;
  if (TiffNumber(tiff, 2, 2) != kTiff) return claims;  // a BigTIFF has other numbers
  const std::size_t folder = TiffNumber(tiff, 4, 4);
  const unsigned orientation = TiffValue(tiff, folder, kOrientation);
  if (orientation >= 1 && orientation <= 8) claims.orientation = static_cast<int>(orientation);
  const std::size_t exif = TiffValue(tiff, folder, kExifFolder);
  claims.srgb = exif != 0 && TiffValue(tiff, exif, kColorSpace) == 1;
  return claims;
}

std::string TurnedText(int orientation, const std::string& source) {
  static constexpr std::array<const char*, 9> kHow = {"",
                                                      "",
                                                      "mirrored left to right",
                                                      "turned by 180 degrees",
                                                      "mirrored top to bottom",
                                                      "mirrored about its main diagonal",
                                                      "turned by 90 degrees clockwise",
                                                      "mirrored about its other diagonal",
                                                      "turned by 90 degrees anticlockwise"};
  const bool known = orientation >= 2 && orientation <= 8;
  return "a turned picture: " + source + " gives the orientation " + std::to_string(orientation) +
         (known ? std::string(", to be shown ") + kHow[static_cast<std::size_t>(orientation)]
                : "") +
         "; allowed is 1, rows from the top left. Pixels are used as the sensor has them: if they "
         "are stored so, have the tag removed or set to 1; if a program has turned the camera's "
         "pictures, export them unturned";
}

bool Contradicts(const TransferClaim& claim, const calib::Radiometry& radiometry) {
  switch (radiometry.encoding) {
    case calib::Encoding::kLinear:
      return claim.kind != Transfer::kLinear;
    case calib::Encoding::kSrgb:
      return claim.kind != Transfer::kSrgb &&
             !(claim.kind == Transfer::kGamma && IsAboutSrgb(claim.gamma));
    case calib::Encoding::kGamma:
      if (claim.kind == Transfer::kLinear) return !IsAboutOne(radiometry.gamma);
      if (claim.kind == Transfer::kSrgb) return !IsAboutSrgb(radiometry.gamma);
      return claim.kind == Transfer::kOther ||
             std::abs(claim.gamma / radiometry.gamma - 1.0) > kSameGamma;
    case calib::Encoding::kCurve:
      return false;
  }
  return false;
}

std::string ClaimWords(const TransferClaim& claim) {
  switch (claim.kind) {
    case Transfer::kLinear:
      return "linear";
    case Transfer::kSrgb:
      return "sRGB encoded";
    case Transfer::kGamma:
      return "encoded with gamma " + NumberText(claim.gamma, 3);
    case Transfer::kOther:
      break;
  }
  return "neither linear nor sRGB nor a gamma";
}

std::string EncodingOf(const TransferClaim& claim) {
  switch (claim.kind) {
    case Transfer::kLinear:
      return "\"linear\"";
    case Transfer::kSrgb:
      return "\"srgb\"";
    case Transfer::kGamma:
      return "{\"gamma\": " + NumberText(claim.gamma, 3) + "}";
    case Transfer::kOther:
      break;
  }
  return "{\"curve\": [points]} of what it is";
}

}  // namespace turnlight::rig
