// A simulated sensor: electrons, read noise, black level, encoding, clipping and whole numbers. It
// shares no code with what it tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <random>

namespace turnlight::calib::calibrate::response {

struct SimulatedSensor {
  int bits = 12;
  double full_well = 10000.0;  // electrons at a linear share of 1
  double read_electrons = 5.0;
  double black = 64.0;         // DN
  double saturation = 4095.0;  // DN, at most the largest number
  double prnu = 0.01;          // pixels' own gains
  double hot = 0.0;            // share of pixels that are stuck bright
  std::function<double(double)> encode = [](double x) { return x; };  // linear to stored share

  double White() const { return std::pow(2.0, bits) - 1.0; }
  double Gain() const { return (White() - black) / full_well; }  // linear DN per electron
};

// Light as a linear share at exposure 1, by pixel.
inline cv::Mat1d Ramp(cv::Size size, double low, double high) {
  cv::Mat1d scene(size);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
      scene(row, column) = low + (high - low) * column / (size.width - 1.0);
  return scene;
}

inline cv::Mat Expose(const SimulatedSensor& sensor, const cv::Mat1d& scene, double exposure,
                      std::uint64_t seed) {
  std::mt19937_64 random(seed * 7919 + 17);
  std::mt19937_64 pattern(4711);                        // the same for every picture
  std::normal_distribution<double> normal, own_normal;  // each keeps a number back
  std::uniform_real_distribution<double> uniform;
  cv::Mat image(scene.size(), sensor.bits > 8 ? CV_16U : CV_8U);
  for (int row = 0; row < scene.rows; ++row)
    for (int column = 0; column < scene.cols; ++column) {
      const double own = 1.0 + sensor.prnu * own_normal(pattern);
      const bool stuck = uniform(pattern) < sensor.hot;
      const double electrons = sensor.full_well * exposure * scene(row, column) * own;
      const double noise = std::sqrt(electrons + std::pow(sensor.read_electrons, 2));
      const double x = (electrons + noise * normal(random)) / sensor.full_well;
      const double stored = std::copysign(sensor.encode(std::abs(x)), x);
      double dn = std::floor(sensor.black + (sensor.White() - sensor.black) * stored + 0.5);
      dn = std::clamp(stuck ? sensor.White() : dn, 0.0, sensor.saturation);
      if (sensor.bits > 8)
        image.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(dn);
      else
        image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(dn);
    }
  return image;
}

}  // namespace turnlight::calib::calibrate::response
