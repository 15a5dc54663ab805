#include "calib/calibrate/response/response.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/format.h"
#include "calib/calibrate/response/response_words.h"
#include "rig/session/image_file.h"
#include "rig/session/session_fields.h"

namespace turnlight::calib::calibrate::response {
namespace {

using nlohmann::ordered_json;

const cv::Size kSeriesGrid(8, 6), kFlatGrid(24, 18);

std::string KindOf(const cv::Mat& image) {
  return Format("%d x %d pixels, %d bits, %d channel%s", image.cols, image.rows,
                image.depth() == CV_8U    ? 8
                : image.depth() == CV_16U ? 16
                                          : 32,
                image.channels(), image.channels() == 1 ? "" : "s");
}

// Reads groups of pictures that are all alike.
class Reader {
 public:
  Reader(const ResponseList& list, const ResponseProgress& progress)
      : list_(list), progress_(progress) {
    total_ = list.series.size() + (list.dark.images.empty() ? 0 : 1) +
             (list.flat.images.empty() && !list.series_is_flat ? 0 : 1) + (list.grey_card ? 1 : 0);
  }

  Result<std::vector<cv::Mat>> Read(const std::vector<std::filesystem::path>& files) {
    if (progress_ && !progress_(done_, total_)) return InterruptedError();
    std::vector<cv::Mat> pictures;
    for (const auto& file : files) {
      auto image = rig::ReadImage(file);
      if (!image) return Forward(image);
      if (const Status status = Check(*image, file.string()); !status) return Forward(status);
      pictures.push_back(std::move(*image));
    }
    if (progress_) progress_(++done_, total_);
    return pictures;
  }

  Result<Group> Measure(const ListedGroup& group, double black, cv::Size grid) {
    const auto pictures = Read(group.images);
    if (!pictures) return Forward(pictures);
    return MeasureGroup(*pictures, list_.bayer, group.exposure_us, black, grid);
  }

  const cv::Mat& first() const { return first_; }
  double largest() const { return largest_; }

 private:
  Status Check(const cv::Mat& image, const std::string& file) {
    if (first_.empty()) {
      const bool whole = image.depth() == CV_8U || image.depth() == CV_16U;
      if (!whole || image.cols < 16 || image.rows < 16)
        return InputError(file + ": " + KindOf(image) +
                          ", allowed are raw pictures of 8 or 16 bits, at least 16 x 16 pixels");
      if (list_.bayer && image.channels() != 1)
        return InputError(list_.source + ": bayer: \"" + *list_.bayer + "\", but " + file +
                          " has " + std::to_string(image.channels()) +
                          " channels; allowed is bayer of pictures of one channel");
      first_ = image;
    }
    if (image.size() != first_.size() || image.type() != first_.type())
      return InputError(file + ": " + KindOf(image) + ", the first picture has " + KindOf(first_) +
                        "; allowed are pictures of one kind");
    double most = 0.0;
    cv::minMaxLoc(image.reshape(1), nullptr, &most);
    largest_ = std::max(largest_, most);
    return {};
  }

  const ResponseList& list_;
  const ResponseProgress& progress_;
  std::size_t done_ = 0, total_ = 0;
  cv::Mat first_;
  double largest_ = 0.0;
};

// The full scale of 8, 10, 12, 14 or 16 bits.
double FullScale(const cv::Mat& image, double largest) {
  if (image.depth() == CV_8U) return 255.0;
  for (const double white : {1023.0, 4095.0, 16383.0})
    if (largest <= white) return white;
  return 65535.0;
}

struct Measured {
  std::vector<Group> series, dark, flat;
};

// Of a series of an even surface the brightest exposure that is not clipped anywhere.
Status MeasureBrightest(const ResponseList& list, Reader& reader, double black, const Response& out,
                        Measured& measured) {
  const double saturation = out.saturation.value_or(HUGE_VAL);
  for (std::size_t i = list.series.size(); i-- > 0;) {
    const auto& blocks = measured.series[i].blocks;
    if (std::any_of(blocks.begin(), blocks.end(),
                    [&](const Block& block) { return block.high >= saturation; }))
      continue;
    auto group = reader.Measure(list.series[i], black, kFlatGrid);
    if (!group) return Forward(group);
    measured.flat.push_back(std::move(*group));
    return {};
  }
  return {};
}

Result<Measured> MeasureAll(const ResponseList& list, Reader& reader, Response& out) {
  Measured measured;
  if (!list.dark.images.empty()) {
    auto group = reader.Measure(list.dark, 0.0, kSeriesGrid);
    if (!group) return Forward(group);
    measured.dark.push_back(std::move(*group));
    out.dark = FindBlack(measured.dark);
  }
  const double black = out.dark ? out.dark->dn : 0.0;
  for (const ListedGroup& listed : list.series) {
    auto group = reader.Measure(listed, black, kSeriesGrid);
    if (!group) return Forward(group);
    out.flicker = std::max(out.flicker, group->flicker);
    measured.series.push_back(std::move(*group));
  }
  if (!list.flat.images.empty()) {
    auto group = reader.Measure(list.flat, black, kFlatGrid);
    if (!group) return Forward(group);
    measured.flat.push_back(std::move(*group));
  }
  out.saturation = FindSaturation(measured.series, black);
  if (measured.flat.empty() && list.series_is_flat)
    if (const Status status = MeasureBrightest(list, reader, black, out, measured); !status)
      return Forward(status);
  const auto planes = PlanesOf(reader.first(), list.bayer);
  for (std::size_t i = 0; i < planes.size(); ++i) out.planes.push_back(PlaneName(planes, i));
  out.size = reader.first().size();
  return measured;
}

bool HasPairs(const std::vector<Group>& series) {
  return std::any_of(series.begin(), series.end(),
                     [](const Group& group) { return group.pictures > 1; });
}

Status FindBalance(const ResponseList& list, Reader& reader, double saturation, Response& out) {
  const cv::Rect& card = list.grey_card->rectangle;
  if ((card & cv::Rect({0, 0}, out.size)) != card)
    return InputError(list.source + ": grey_card/rectangle: it leaves the picture of " +
                      std::to_string(out.size.width) + " x " + std::to_string(out.size.height) +
                      " pixels, allowed is one within it");
  const auto pictures = reader.Read(list.grey_card->images);
  if (!pictures) return Forward(pictures);
  const auto balance = FindWhiteBalance(*pictures, list.bayer, card, out.radiometry, saturation);
  if (!balance) return InputError(list.source + ": " + balance.error().text);
  out.balance = *balance;
  out.radiometry.white_balance = balance->balance;
  return {};
}

ordered_json MatrixOf(const Eigen::Matrix2d& matrix) {
  return {{matrix(0, 0), matrix(0, 1)}, {matrix(1, 0), matrix(1, 1)}};
}

Eigen::Matrix2d BlackCovariance(const Response& response) {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  covariance(0, 0) = response.curve.black_sigma * response.curve.black_sigma;
  return covariance;
}

ordered_json PrintFound(const Response& response) {
  ordered_json found;
  const ResponseCurve& curve = response.curve;
  found["linearity"] = ordered_json::array();
  for (const EncodingTrial& trial : curve.trials)
    found["linearity"].push_back(
        {{"encoding", trial.name}, {"chi", trial.chi}, {"largest_deviation", trial.worst}});
  found["black_sigma"] = curve.black_sigma;
  if (curve.gamma_sigma) found["gamma_sigma"] = *curve.gamma_sigma;
  if (!curve.curve_sigma.empty()) found["curve_sigma"] = curve.curve_sigma;
  if (const auto& transfer = response.transfer) {
    found["photon_transfer"] = {{"dn_per_electron", transfer->dn_per_electron},
                                {"dn_per_electron_sigma", transfer->GainSigma()},
                                {"read_noise_dn", transfer->read_noise_dn},
                                {"read_noise_dn_sigma", transfer->ReadSigma()},
                                {"chi", transfer->chi},
                                {"planes", response.planes},
                                {"dn_per_electron_by_plane", transfer->by_plane},
                                {"flicker", response.flicker}};
    if (response.saturation)
      found["photon_transfer"]["saturation_electrons"] =
          SaturationElectrons(response, *response.saturation);
  }
  if (const auto& flat = response.flat)
    found["vignetting"] = {{"significant", flat->significant},
                           {"coefficients_sigma", flat->sigma},
                           {"corner_share", flat->corner_share},
                           {"corner_share_sigma", flat->corner_sigma},
                           {"rms", flat->rms}};
  if (response.balance) found["white_balance_sigma"] = response.balance->sigma;
  return found;
}

}  // namespace

Result<Response> CalibrateResponse(const ResponseList& list, const ResponseProgress& progress) {
  Reader reader(list, progress);
  Response out;
  const auto measured = MeasureAll(list, reader, out);
  if (!measured) return Forward(measured);
  const auto fail = [&](const auto& result) {
    return InputError(list.source + ": " + result.error().text);
  };
  const double white = list.white.value_or(FullScale(reader.first(), reader.largest()));
  const double saturation = out.saturation.value_or(white);
  auto curve = FitResponseCurve(measured->series, out.dark, white, saturation);
  if (!curve) return fail(curve);
  out.curve = std::move(*curve);
  out.radiometry = out.curve.radiometry;
  if (out.saturation && *out.saturation < white) out.radiometry.saturation = *out.saturation;
  if (HasPairs(measured->series)) {
    auto transfer = FitPhotonTransfer(measured->series, measured->dark, out.radiometry,
                                      out.curve.black_sigma, saturation);
    if (!transfer) return fail(transfer);
    out.transfer = std::move(*transfer);
    out.radiometry.noise =
        NoiseModel{out.transfer->read_noise_dn, out.transfer->dn_per_electron, list.gain_db};
  }
  if (!measured->flat.empty()) {
    auto flat = FitVignetting(measured->flat, out.radiometry, saturation, out.size, kFlatGrid);
    if (!flat) return fail(flat);
    out.flat = std::move(*flat);
    if (out.flat->significant) out.radiometry.vignetting = out.flat->vignetting;
  }
  if (list.grey_card)
    if (const Status status = FindBalance(list, reader, saturation, out); !status)
      return Forward(status);
  out.words = WordsOf(out);
  return out;
}

std::string PrintResponse(const Response& response) {
  const Radiometry& radiometry = response.radiometry;
  ordered_json fragment = rig::PrintRadiometryCore(radiometry);
  fragment["white_balance"] = radiometry.white_balance;
  if (radiometry.vignetting) fragment["vignetting"] = rig::PrintVignetting(*radiometry.vignetting);
  fragment["unit"] = "DN";
  if (radiometry.noise) {
    fragment["noise"] = rig::PrintNoise(*radiometry.noise);
    fragment["noise"]["covariance"] = MatrixOf(response.transfer->covariance);
  }
  fragment["covariance"] = MatrixOf(BlackCovariance(response));
  const ordered_json document{{"format", "turnlight-response"},
                              {"version", 1},
                              {"resolution", {response.size.width, response.size.height}},
                              {"radiometry", fragment},
                              {"found", PrintFound(response)},
                              {"words", response.words}};
  return document.dump(1) + "\n";
}

Status ApplyResponse(const Response& response, rig::RigCalibration& calibration) {
  const cv::Size& size = calibration.devices.resolution;
  if (size != response.size)
    return InputError(
        calibration.source + ": identity/camera/resolution: " + std::to_string(size.width) + " x " +
        std::to_string(size.height) + ", the response's pictures have " +
        std::to_string(response.size.width) + " x " + std::to_string(response.size.height) +
        "; allowed are pictures of the calibrated camera's size");
  const Radiometry before = calibration.radiometry;
  Radiometry& radiometry = calibration.radiometry;
  radiometry = response.radiometry;
  radiometry.reference_exposure_us = before.reference_exposure_us;
  radiometry.reference_gain_db = before.reference_gain_db;
  if (!response.balance) radiometry.white_balance = before.white_balance;
  if (!response.flat) radiometry.vignetting = before.vignetting;
  calibration.covariances.radiometry = BlackCovariance(response);
  if (!response.transfer) {
    radiometry.noise = before.noise;
    return {};
  }
  calibration.noise.read_noise_dn = response.transfer->read_noise_dn;
  calibration.noise.dn_per_electron = response.transfer->dn_per_electron;
  calibration.covariances.noise = response.transfer->covariance;
  return {};
}

}  // namespace turnlight::calib::calibrate::response
