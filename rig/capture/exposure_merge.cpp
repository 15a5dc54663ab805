#include "rig/capture/exposure_merge.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>

#include "base/parallel.h"

namespace turnlight::rig {
namespace {

constexpr double kRoundingVariance = 1.0 / 12.0;  // of whole DN
constexpr double kClippedFactor = 2.0;

// One exposure, ready to be merged: DN as float, and where another exposure is preferred.
struct Layer {
  cv::Mat dn;           // CV_32F
  cv::Mat1b near_clip;  // 255: a channel here or of one of the 8 neighbours is clipped
  double factor = 1.0;  // radiance of the reference for each share of white
};

struct Sensor {
  double black = 0.0, range = 1.0;  // DN; range = white - black
  double saturation = 0.0;          // DN
  double black_limit = -std::numeric_limits<double>::infinity();
  double read_variance = 0.0;  // DN^2, with rounding
  double dn_per_electron = 0.0;

  bool Clipped(double dn) const { return !(dn < saturation); }  // NaN too
};

// A channel of a pixel in one exposure.
struct Sample {
  double share;   // of white, above black
  double factor;  // share to radiance
};

// Inverse-variance mean. The variance is taken at the merged value, which a first mean, with the
// weights that are right for pure shot noise, gives well enough.
double MergeSamples(const std::vector<Sample>& samples, const Sensor& sensor) {
  double signal = 0.0;
  double time = 0.0;
  for (const Sample& sample : samples) {
    signal += sample.share;
    time += 1.0 / sample.factor;
  }
  const double first = signal / time;
  double sum = 0.0;
  double weights = 0.0;
  for (const Sample& sample : samples) {
    const double dn = std::max(first / sample.factor, 0.0) * sensor.range;  // above black
    const double variance = sensor.read_variance + sensor.dn_per_electron * dn;
    const double weight = 1.0 / (std::max(variance, 1e-12) * sample.factor * sample.factor);
    sum += weight * sample.share * sample.factor;
    weights += weight;
  }
  return sum / weights;
}

struct Merged {
  double radiance = 0.0;
  bool valid = false;
};

// layers are ordered from the longest exposure to the shortest. at: index of the channel in a row.
Merged MergeChannel(const std::vector<Layer>& layers, const Sensor& sensor, int row, int x, int at,
                    std::vector<Sample>& samples) {
  for (const bool neighbours_count : {false, true}) {
    samples.clear();
    for (const Layer& layer : layers) {
      const double dn = layer.dn.ptr<float>(row)[at];
      if (sensor.Clipped(dn) || dn <= sensor.black_limit) continue;
      if (!neighbours_count && layer.near_clip(row, x) != 0) continue;
      samples.push_back({(dn - sensor.black) / sensor.range, layer.factor});
    }
    if (!samples.empty()) return {MergeSamples(samples, sensor), true};
  }
  // Nothing is left: dark if the longest exposure says so, else brighter than the shortest shows.
  const double longest = layers.front().dn.ptr<float>(row)[at];
  if (!sensor.Clipped(longest))
    return {(longest - sensor.black) / sensor.range * layers.front().factor, false};
  return {kClippedFactor * (sensor.saturation - sensor.black) / sensor.range * layers.back().factor,
          false};
}

cv::Mat1b FindClipped(const cv::Mat& dn, const Sensor& sensor) {
  cv::Mat1b clipped(dn.size(), 0);
  const int channels = dn.channels();
  for (int row = 0; row < dn.rows; ++row)
    for (int i = 0; i < dn.cols * channels; ++i)
      if (sensor.Clipped(dn.ptr<float>(row)[i])) clipped(row, i / channels) = 255;
  return clipped;
}

Sensor DescribeSensor(const calib::Radiometry& radiometry, const SensorNoise& noise, int depth) {
  Sensor sensor{radiometry.black, radiometry.white - radiometry.black, radiometry.SaturationDn()};
  if (noise.black_limit_dn)
    sensor.black_limit = *noise.black_limit_dn;
  else if (radiometry.black > 0.0 && depth != CV_32F)
    sensor.black_limit = 0.0;
  sensor.read_variance =
      noise.read_noise_dn * noise.read_noise_dn + (depth == CV_32F ? 0.0 : kRoundingVariance);
  sensor.dn_per_electron = noise.dn_per_electron;
  return sensor;
}

Status CheckBracket(const std::vector<ExposedImage>& bracket, const calib::Radiometry& radiometry) {
  if (bracket.empty() || bracket.front().image.empty())
    return InputError("exposure bracket: no picture, allowed is at least one");
  if (bracket.size() == 1) return {};
  if (radiometry.encoding != calib::Encoding::kLinear)
    return InputError("exposure bracket: the encoding is not linear, allowed is linear");
  if (!radiometry.reference_exposure_us || !(*radiometry.reference_exposure_us > 0.0))
    return InputError("exposure bracket: no reference exposure, allowed is one above 0 us");
  const cv::Mat& first = bracket.front().image;
  for (std::size_t i = 0; i < bracket.size(); ++i) {
    const auto& [image, exposure] = bracket[i];
    const std::string begin = "exposure bracket: picture " + std::to_string(i);
    if (image.size() != first.size() || image.type() != first.type() ||
        (image.channels() != 1 && image.channels() != 3) ||
        (image.depth() != CV_8U && image.depth() != CV_16U && image.depth() != CV_32F))
      return InputError(begin + " has " + std::to_string(image.cols) + " x " +
                        std::to_string(image.rows) + " pixels of type " +
                        cv::typeToString(image.type()) + ", the first has " +
                        std::to_string(first.cols) + " x " + std::to_string(first.rows) + " of " +
                        cv::typeToString(first.type()) +
                        "; allowed are equal ones of 1 or 3 channels, 8 or 16 bits or float");
    if (!exposure.exposure_us || !(*exposure.exposure_us > 0.0) ||
        !std::isfinite(*exposure.exposure_us) || !std::isfinite(exposure.gain_db))
      return InputError(begin + " has no exposure, allowed is one above 0 us");
  }
  return {};
}

MergedFrame Merge(const std::vector<ExposedImage>& bracket, const calib::Radiometry& radiometry,
                  const SensorNoise& noise) {
  const cv::Mat& first = bracket.front().image;
  const Sensor sensor = DescribeSensor(radiometry, noise, first.depth());
  std::vector<Layer> layers;
  for (const ExposedImage& exposed : bracket) {
    Layer layer;
    exposed.image.convertTo(layer.dn, CV_32F);
    cv::dilate(FindClipped(layer.dn, sensor), layer.near_clip, cv::Mat());
    layer.factor = calib::ExposureFactor(radiometry, exposed.exposure);
    layers.push_back(std::move(layer));
  }
  std::stable_sort(layers.begin(), layers.end(),
                   [](const Layer& a, const Layer& b) { return a.factor < b.factor; });

  const int channels = first.channels();
  MergedFrame merged;
  merged.image.create(first.size(), CV_32FC(channels));
  merged.validity.create(first.size());
  merged.exposure = {radiometry.reference_exposure_us, radiometry.reference_gain_db.value_or(0.0)};
  ParallelFor(static_cast<std::size_t>(first.rows), [&](std::size_t index) {
    const int row = static_cast<int>(index);
    std::vector<Sample> samples;
    for (int x = 0; x < first.cols; ++x) {
      bool valid = true;
      for (int c = 0; c < channels; ++c) {
        const int at = x * channels + c;
        const Merged value = MergeChannel(layers, sensor, row, x, at, samples);
        merged.image.ptr<float>(row)[at] = static_cast<float>(value.radiance);
        valid &= value.valid;
      }
      merged.validity(row, x) = valid ? 255 : 0;
    }
  });
  return merged;
}

}  // namespace

Result<MergedFrame> MergeExposures(const std::vector<ExposedImage>& bracket,
                                   const calib::Radiometry& radiometry, const SensorNoise& noise) {
  if (const Status status = CheckBracket(bracket, radiometry); !status) return Forward(status);
  if (bracket.size() == 1)
    return MergedFrame{bracket.front().image, cv::Mat1b(), bracket.front().exposure};
  try {
    return Merge(bracket, radiometry, noise);
  } catch (const std::exception& error) {  // of OpenCV: no memory
    return SystemError(std::string("exposure bracket: ") + error.what());
  }
}

calib::Radiometry RawRadiometry(const calib::Radiometry& raw,
                                const std::vector<double>& exposures_us, double gain_db) {
  calib::Radiometry radiometry = raw;
  if (!radiometry.reference_exposure_us && !exposures_us.empty())
    radiometry.reference_exposure_us = exposures_us.front();
  if (!radiometry.reference_gain_db) radiometry.reference_gain_db = gain_db;
  return radiometry;
}

calib::Radiometry SessionRadiometry(const calib::Radiometry& raw,
                                    const std::vector<double>& exposures_us, double gain_db) {
  calib::Radiometry radiometry = RawRadiometry(raw, exposures_us, gain_db);
  if (exposures_us.size() < 2) return radiometry;
  radiometry.noise.reset();  // of a mean that is weighted pixel by pixel
  const double shortest = *std::min_element(exposures_us.begin(), exposures_us.end());
  const double range = radiometry.white - radiometry.black;
  radiometry.saturation = (radiometry.SaturationDn() - radiometry.black) / range *
                          calib::ExposureFactor(radiometry, {shortest, gain_db});
  radiometry.black = 0.0;
  radiometry.white = 1.0;
  return radiometry;
}

}  // namespace turnlight::rig
