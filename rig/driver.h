// What a driver makes of its part of a config: a device behind its interface of rig/device.h, not
// yet open, and what a plan has to know of it without opening it. docs/drivers.md shows how to add
// one.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "rig/capture/capture_plan.h"
#include "rig/device.h"

namespace turnlight::rig {

struct TableDevice {
  std::shared_ptr<Turntable> turntable;
  TableKinematics kinematics;
  bool real_time = false;  // it moves while the clock on the wall goes on: no virtual executor
};

struct CameraDevice {
  std::shared_ptr<Camera> camera;
  // Of every picture; a camera that cannot give it fails to open.
  PictureFormat format;
  std::optional<std::string> bayer;     // RGGB, BGGR, GRBG or GBRG, of a mosaic of one channel
  std::array<int, 2> roi_offset{0, 0};  // of the picture's first pixel on the sensor, unbinned
  std::array<int, 2> binning{1, 1};     // pixels of the sensor per picture's, across and down
  // Between which DN a full pixel reads, by the pixel format; the calibration's saturation must lie
  // there. Not given: not known.
  std::optional<std::array<double, 2>> full_scale_dn;
  std::string lens;         // the config's note: which lens is on it; empty: none
  double readout_s = 0.05;  // from the end of an exposure to its picture, about
  bool real_time = false;   // as of the table
};

}  // namespace turnlight::rig
