#include "calib/calibrate/response/response_words.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "calib/transfer.h"

namespace turnlight::calib::calibrate::response {
namespace {

constexpr double kFlickerTold = 2e-3;    // of the light
constexpr double kMostGainSpread = 0.1;  // between colours
constexpr double kMostTransferChi = 2.0;

const EncodingTrial& TrialOf(const ResponseCurve& curve, const std::string& name) {
  return *std::find_if(curve.trials.begin(), curve.trials.end(),
                       [&](const EncodingTrial& trial) { return trial.name == name; });
}

std::string ChosenName(const ResponseCurve& curve) {
  switch (curve.radiometry.encoding) {
    case Encoding::kLinear:
      return "linear";
    case Encoding::kSrgb:
      return "srgb";
    case Encoding::kGamma:
      return "gamma";
    case Encoding::kCurve:
      return "curve";
  }
  return "linear";
}

std::string LinearityWords(const ResponseCurve& curve) {
  const EncodingTrial& linear = TrialOf(curve, "linear");
  const EncodingTrial& chosen = TrialOf(curve, ChosenName(curve));
  const std::string off =
      Format("a straight line is off by up to %.2g %% of a block's light", 100.0 * linear.worst);
  const std::string left = Format("it leaves %.2g %% at most", 100.0 * chosen.worst);
  switch (curve.radiometry.encoding) {
    case Encoding::kLinear:
      return "linear: " + off;
    case Encoding::kSrgb:
      return "not linear: " + off + "; sRGB's encoding explains it, " + left;
    case Encoding::kGamma:
      return Format("not linear: %s; a gamma of %.4f +- %.2g explains it, %s", off.c_str(),
                    curve.radiometry.gamma, curve.gamma_sigma.value_or(0.0), left.c_str());
    case Encoding::kCurve:
      return Format("not linear: %s; a curve of %zu points explains it, %s", off.c_str(),
                    curve.radiometry.curve.size(), left.c_str());
  }
  return off;
}

void AddNoiseWords(const Response& response, std::vector<std::string>& words) {
  if (!response.transfer) {
    words.push_back("noise: not measured; it takes two pictures or more at each exposure");
    return;
  }
  const PhotonTransfer& transfer = *response.transfer;
  std::string text = Format(
      "noise: %.4g +- %.2g DN per electron, read noise %.3g +- %.2g DN (%.3g "
      "electrons)",
      transfer.dn_per_electron, transfer.GainSigma(), transfer.read_noise_dn, transfer.ReadSigma(),
      transfer.read_noise_dn / transfer.dn_per_electron);
  if (response.saturation)
    text += Format(", saturation at %.4g electrons",
                   SaturationElectrons(response, *response.saturation));
  words.push_back(text);
  if (!transfer.read_noise_found)
    words.push_back("read noise: below what these pictures show; add dark frames");
  if (transfer.rounded_away)
    words.push_back(
        "some pictures' noise is smaller than a DN's rounding and was not used; more "
        "bits or a higher gain would show it");
  if (transfer.chi > kMostTransferChi)
    words.push_back(
        Format("the noise is no straight line of the light (chi %.1f): sigmas are larger "
               "for it; pictures that were sharpened, denoised, compressed or "
               "demosaiced look so",
               transfer.chi));
  const auto [least, most] =
      std::minmax_element(transfer.by_plane.begin(), transfer.by_plane.end());
  if (*least > 0.0 && *most > (1.0 + kMostGainSpread) * *least)
    words.push_back(
        Format("the colours' gains differ, %.3g to %.3g DN per electron: the camera "
               "multiplies them; switch its own white balance off",
               *least, *most));
  if (response.planes.size() == 3)
    words.push_back(
        "pictures of three channels: where the camera interpolated colours, the noise is "
        "less than a pixel's own; take raw mosaics if it gives them");
}

void AddFlatWords(const FlatField& flat, std::vector<std::string>& words) {
  if (!flat.significant) {
    words.push_back(
        Format("vignetting: none; the darkest corner has %.4g +- %.2g of the centre's "
               "light",
               flat.corner_share, flat.corner_sigma));
    return;
  }
  words.push_back(
      Format("vignetting: the darkest corner has %.3f +- %.2g of the centre's light; the "
             "map leaves %.2g %% (rms)",
             flat.corner_share, flat.corner_sigma, 100.0 * flat.rms));
  if (!flat.center_known)
    words.push_back(
        "the flat frames' brightest place is far from the picture's middle, which was "
        "taken as the centre: the surface is not evenly lit, or the lens is not centred");
}

}  // namespace

double SaturationElectrons(const Response& response, double saturation_dn) {
  const Radiometry& radiometry = response.radiometry;
  const double range = radiometry.white - radiometry.black;
  return range * Transfer(radiometry).Decode((saturation_dn - radiometry.black) / range) /
         response.transfer->dn_per_electron;
}

std::vector<std::string> WordsOf(const Response& response) {
  std::vector<std::string> words{LinearityWords(response.curve)};
  if (!response.curve.explained)
    words.push_back(
        "no encoding explains the series down to noise and 0.1 % of the light: the lamp, "
        "the scene or the exposure times were not steady; take it again");
  const std::string black =
      Format("black: %.4g +- %.2g DN", response.radiometry.black, response.curve.black_sigma);
  words.push_back(response.dark ? black
                                : black + ", from the series; dark frames would tell it better");
  words.push_back(response.saturation
                      ? Format("saturation: from %.6g DN on", *response.saturation)
                      : Format("saturation: no picture is clipped; white, %.6g DN, was taken",
                               response.radiometry.white));
  AddNoiseWords(response, words);
  if (response.flat) AddFlatWords(*response.flat, words);
  if (const auto& balance = response.balance)
    words.push_back(Format("white balance: red %.4f +- %.1g, blue %.4f +- %.1g of green",
                           balance->balance[0], balance->sigma[0], balance->balance[2],
                           balance->sigma[2]));
  if (response.flicker > kFlickerTold)
    words.push_back(
        Format("flicker: the light changes by up to %.2g %% between the two pictures of a "
               "pair; it was taken out of the noise, but not out of the linearity",
               100.0 * response.flicker));
  return words;
}

}  // namespace turnlight::calib::calibrate::response
