// A camera's response as a whole: what its digital numbers mean, and their noise.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/response/flat_field.h"
#include "calib/calibrate/response/photon_transfer.h"
#include "calib/calibrate/response/response_curve.h"
#include "calib/calibrate/response/response_list.h"
#include "rig/rig_calibration.h"

namespace turnlight::calib::calibrate::response {

struct Response {
  // All that was found: encoding, black, white, saturation, white balance, vignetting, noise.
  Radiometry radiometry;
  cv::Size size;                    // of the pictures
  std::vector<std::string> planes;  // "grey", "red", ...
  std::optional<BlackLevel> dark;   // of the dark frames
  std::optional<double> saturation;
  ResponseCurve curve;
  std::optional<PhotonTransfer> transfer;  // of series with pairs
  std::optional<FlatField> flat;
  std::optional<WhiteBalance> balance;
  double flicker = 0.0;            // largest change of light within a pair, a share
  std::vector<std::string> words;  // what it says, for people: verdict first, then remarks
};

// Called before each picture's group; false stops.
using ResponseProgress = std::function<bool(std::size_t done, std::size_t total)>;

// Reads the pictures, an exposure at a time. The same bits for any number of threads. Fails
// (kInput) with the file of a picture that cannot be read or is unlike the first, or with what the
// pictures lack; (kInterrupted) if it was stopped.
Result<Response> CalibrateResponse(const ResponseList& list, const ResponseProgress& progress = {});

// radiometry and noise with units and covariance, as rig-calibration.json has them, and how they
// were found.
std::string PrintResponse(const Response& response);

// Puts it into a rig's calibration. Keeps what was not measured: references, and the white balance
// without a grey card. Fails (kInput) if that is of pictures of another size.
Status ApplyResponse(const Response& response, rig::RigCalibration& calibration);

}  // namespace turnlight::calib::calibrate::response
