// The list of pictures that a response is calibrated from, a YAML or JSON file beside them:
//
//   bayer: RGGB            # optional: the pictures are mosaics
//   white: 4095            # optional: DN of full scale; default by the pictures' bits
//   gain_db: 0             # optional: of all of them
//   series:                # one still scene in steady light, at least 3 exposures; for the noise
//   two
//   - exposure_us: 1000    # pictures or more of most
//     images: [e1000_a.png, e1000_b.png]
//   dark: [d1.png, d2.png]                # optional: lens cap on
//   flat: [f1.png, f2.png]                # optional: an evenly lit surface over the whole picture
//   grey_card: {images: [card.png], rectangle: [x, y, width, height]}   # optional, colour only
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/session/raw_capture.h"

namespace turnlight::calib::calibrate::response {

struct ListedGroup {
  double exposure_us = 0.0;  // 0: not told
  std::vector<std::filesystem::path> images;
};

struct GreyCard {
  std::vector<std::filesystem::path> images;
  cv::Rect rectangle;  // pixels
};

struct ResponseList {
  std::string source;  // as messages begin
  std::optional<std::string> bayer;
  std::optional<double> white;
  double gain_db = 0.0;
  std::vector<ListedGroup> series;  // by exposure
  ListedGroup dark, flat;
  // Without flat frames: the series shows an evenly lit surface, and its brightest exposure that is
  // not clipped will do.
  bool series_is_flat = false;
  std::optional<GreyCard> grey_card;
};

// path: the file, or a folder with response.yaml or response.json. Fails (kInput) with file, key,
// value and what is allowed.
Result<ResponseList> ReadResponseList(const std::filesystem::path& path);

// That of a raw capture: frames of kind "flat" at several exposures are the series of an evenly lit
// surface, "dark" and "grey" what they say. card: where the grey card is. Fails (kInput) with what
// the capture lacks, or if gains or pictures differ.
Result<ResponseList> ListOfCapture(const rig::RawCapture& capture,
                                   const std::optional<cv::Rect>& card);

}  // namespace turnlight::calib::calibrate::response
