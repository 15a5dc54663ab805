// What a picture's file says of itself beside its pixels: how its values are encoded, whether it is
// to be turned. Only said, not obeyed: what a pixel means is the session's to say.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/radiometry.h"

namespace turnlight::rig {

enum class Transfer {
  kLinear,
  kSrgb,
  kGamma,  // light = stored^gamma
  kOther,  // known, and none of the above
};

struct TransferClaim {
  Transfer kind = Transfer::kLinear;
  double gamma = 1.0;   // of kGamma
  std::string said_by;  // what says so, and what it says: "the sRGB chunk", "the gAMA chunk (0.45)"
};

struct PictureClaims {
  std::optional<TransferClaim> transfer;  // none: the file says nothing that can be told
  // How it was read where more than one way is possible, in words that follow "FILE: ".
  std::vector<std::string> remarks;
};

// Of values that were raised to `exponent` when they were stored: 1 is linear, 0.4545 gamma 2.2.
TransferClaim GammaClaim(double exponent, const std::string& said_by);

// Of light as a function of what is stored, as samples of [0, 1] at even steps of [0, 1]: linear,
// sRGB, a gamma, or other. samples: 16 or more.
TransferClaim CurveClaim(const std::vector<double>& samples, const std::string& said_by);

// Of the code of transfer characteristics in ITU-T H.273, as PNG's cICP has it.
std::optional<TransferClaim> CicpClaim(int code);

// Of an ICC profile's bytes, hostile or not; none if it has no tone curve.
std::optional<TransferClaim> IccClaim(std::string_view profile);

// What an EXIF block (a TIFF's bytes, of either order) says; hostile or not.
struct ExifClaims {
  int orientation = 1;  // 1 to 8: how to turn the picture for the eye
  bool srgb = false;    // its ColorSpace is sRGB
};
ExifClaims ReadExif(std::string_view tiff);

// Why a turned picture is refused. source: what says so, such as "the eXIf chunk".
std::string TurnedText(int orientation, const std::string& source);

// Whether values that a file claims to be encoded in one way may be read in another. A measured
// curve is never contradicted; sRGB and gammas about 2.2 are taken for the same.
bool Contradicts(const TransferClaim& claim, const calib::Radiometry& radiometry);

// "sRGB encoded", "linear", "encoded with gamma 2.2"; and what to set in session.json for it.
std::string ClaimWords(const TransferClaim& claim);
std::string EncodingOf(const TransferClaim& claim);

}  // namespace turnlight::rig
