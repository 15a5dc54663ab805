// Photon transfer (EMVA 1288; Janesick, 2007): how the noise grows with the light tells how many DN
// an electron makes, and what noise there is without light.
//
// Of linear DN x above black: variance = read^2 + gain x. What is measured is in DN as stored, so
// it is carried through the encoding: without the 1/12 of rounding, times the square of the slope.
// It comes from differences of two pictures, where what pixels differ by each for itself falls out.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/response/blocks.h"
#include "calib/radiometry.h"

namespace turnlight::calib::calibrate::response {

struct TransferPoint {
  std::size_t plane = 0;
  double signal = 0.0;    // linear DN
  double variance = 0.0;  // linear DN^2, without rounding
  double sigma = 0.0;     // of the variance
};

struct PhotonTransfer {
  double dn_per_electron = 0.0, read_noise_dn = 0.0;  // of linear DN
  Eigen::Matrix2d covariance;                         // of read noise, gain
  double chi = 0.0;  // root of chi^2 per degree of freedom; sigmas are larger by it, if above 1
  bool read_noise_found = false;  // else its variance came out below 0, and it is 0
  bool rounded_away = false;     // some pictures' noise is smaller than rounding; they do not count
  std::vector<double> by_plane;  // gain of each plane alone; 0 where it has too few points
  std::vector<TransferPoint> points;

  double ReadSigma() const;
  double GainSigma() const;
};

// groups: series and dark frames; those with pairs count. Fails (kInput) if there are too few pairs
// at different levels.
Result<PhotonTransfer> FitPhotonTransfer(const std::vector<Group>& series,
                                         const std::vector<Group>& dark,
                                         const Radiometry& radiometry, double black_sigma,
                                         double saturation);

}  // namespace turnlight::calib::calibrate::response
