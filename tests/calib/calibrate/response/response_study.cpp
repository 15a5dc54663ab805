// A study: over 200 draws of a series, how often the stated sigmas of gain and read noise cover the
// truth, for a linear sensor of 12 bits and for one of 8 bits with a gamma of 2.2; and the largest
// errors of the recovered encodings.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/calib/calibrate/response/fitted.h"

namespace turnlight::calib::calibrate::response {
namespace {

constexpr int kDraws = 200;
// Binomial 99 % bands of 68.3 % and 95.4 % in 200 draws.
constexpr int kLeastOne = 119, kMostOne = 153, kLeastTwo = 182;

struct Covered {
  int one = 0, two = 0;
  double pull = 0.0, square = 0.0;

  void Add(double error, double sigma) {
    const double pulled = error / sigma;
    one += std::abs(pulled) <= 1.0 ? 1 : 0;
    two += std::abs(pulled) <= 2.0 ? 1 : 0;
    pull += pulled / kDraws;
    square += pulled * pulled / kDraws;
  }
  void Expect(const char* name) const {
    std::printf("%s: %d of %d within 1 sigma, %d within 2; mean %.2f, rms %.2f sigma\n", name, one,
                kDraws, two, pull, std::sqrt(square));
    EXPECT_GE(one, kLeastOne) << name;
    EXPECT_LE(one, kMostOne) << name;
    EXPECT_GE(two, kLeastTwo) << name;
  }
};

void Study(const SimulatedSensor& sensor, const char* name) {
  Covered gain, read, black, gamma;
  double worst = 0.0;
  for (int draw = 1; draw <= kDraws; ++draw) {
    const auto fit = FitSeries(sensor, TakeSeries(sensor, static_cast<std::uint64_t>(draw) + 100));
    ASSERT_TRUE(fit) << fit.error().text;
    const PhotonTransfer& transfer = fit->transfer;
    gain.Add(transfer.dn_per_electron - sensor.Gain(), transfer.GainSigma());
    read.Add(transfer.read_noise_dn - sensor.Gain() * sensor.read_electrons, transfer.ReadSigma());
    black.Add(fit->curve.radiometry.black - sensor.black, fit->curve.black_sigma);
    if (fit->curve.gamma_sigma)
      gamma.Add(fit->curve.radiometry.gamma - 2.2, *fit->curve.gamma_sigma);
    worst = std::max(worst, CurveError(sensor, fit->curve));
  }
  std::printf("%s: the largest error of the linear share is %.3f %%\n", name, 100.0 * worst);
  std::printf("%s: black %d and %d, gamma %d and %d of %d within 1 and 2 sigma\n", name, black.one,
              black.two, gamma.one, gamma.two, kDraws);
  gain.Expect("gain");
  read.Expect("read noise");
  EXPECT_LT(worst, 0.005);
}

TEST(ResponseStudy, LinearTwelveBits) { Study(SimulatedSensor{}, "linear, 12 bits"); }

TEST(ResponseStudy, GammaEightBits) {
  SimulatedSensor sensor;
  sensor.bits = 8;
  sensor.black = 0.0;
  sensor.saturation = 255.0;
  sensor.encode = [](double x) { return std::pow(x, 1.0 / 2.2); };
  Study(sensor, "gamma 2.2, 8 bits");
}

TEST(ResponseStudy, BentTwelveBits) {
  SimulatedSensor sensor;
  sensor.encode = [](double x) { return x + 0.04 * x * (1.0 - x); };
  double worst = 0.0;
  for (std::uint64_t draw = 1; draw <= 50; ++draw) {
    const auto fit = FitSeries(sensor, TakeSeries(sensor, draw + 900));
    ASSERT_TRUE(fit) << fit.error().text;
    worst = std::max(worst, CurveError(sensor, fit->curve));
  }
  std::printf("bent, 12 bits: the largest error of the linear share is %.3f %%\n", 100.0 * worst);
  EXPECT_LT(worst, 0.005);
}

}  // namespace
}  // namespace turnlight::calib::calibrate::response
