#include "lenses.h"

#include <cmath>
#include <cstdio>

namespace turnlight::calib {
namespace {

// A splined lens whose surface is a gentle barrel distortion.
LensExample Splined(int order, int columns, int rows) {
  LensExample lens;
  lens.name = "LENSMODEL_SPLINED_STEREOGRAPHIC_order=" + std::to_string(order) +
              "_Nx=" + std::to_string(columns) + "_Ny=" + std::to_string(rows) + "_fov_x_deg=110";
  lens.intrinsics = {420.0, 421.0, 321.25, 238.5};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double x = 2.0 * i / (columns - 1) - 1.0;
      const double y = 2.0 * j / (rows - 1) - 1.0;
      const double radius2 = x * x + y * y;
      lens.intrinsics.push_back(-0.03 * x * radius2 + 0.002 * std::sin(3.0 * y));
      lens.intrinsics.push_back(-0.02 * y * radius2 + 0.001 * std::cos(4.0 * x));
    }
  }
  return lens;
}

std::string Digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace

std::vector<LensExample> LensExamples() {
  const double fx = 612.5, fy = 610.25, cx = 322.75, cy = 236.5;
  return {
      {"LENSMODEL_PINHOLE", {fx, fy, cx, cy}},
      {"LENSMODEL_STEREOGRAPHIC", {fx, fy, cx, cy}},
      {"LENSMODEL_LONLAT", {fx, fy, cx, cy}},
      {"LENSMODEL_LATLON", {fx, fy, cx, cy}},
      {"LENSMODEL_OPENCV4", {fx, fy, cx, cy, -0.21, 0.09, 3e-4, -6e-4}},
      {"LENSMODEL_OPENCV5", {fx, fy, cx, cy, -0.21, 0.09, 3e-4, -6e-4, -0.011}},
      {"LENSMODEL_OPENCV8", {fx, fy, cx, cy, 0.31, -0.12, 3e-4, -6e-4, 0.021, 0.52, -0.071, 0.034}},
      {"LENSMODEL_OPENCV12",
       {fx, fy, cx, cy, 0.31, -0.12, 3e-4, -6e-4, 0.021, 0.52, -0.071, 0.034, 1e-3, -2e-4, -8e-4,
        1e-4}},
      {"LENSMODEL_CAHVOR", {fx, fy, cx, cy, 0.012, -0.009, 0.002, -0.15, 0.04}},
      {"LENSMODEL_CAHVORE_linearity=0.37",
       {fx, fy, cx, cy, 0.012, -0.009, 0.002, -0.05, 0.01, 0.003, -0.002, 0.001}},
      {"LENSMODEL_CAHVORE_linearity=0",
       {fx, fy, cx, cy, 0.012, -0.009, 0.002, 0.01, -0.02, 0.0, 0.0, 0.0}},
      Splined(3, 14, 11),
      Splined(2, 13, 10),
  };
}

std::string ModelText(const LensExample& lens, int width, int height) {
  std::string text = "{ 'lensmodel': '" + lens.name + "',\n";
  text += "  'extrinsics': [ 0.1, -0.2, 0.3, 10., 20., 30. ],\n  'intrinsics': [";
  for (const double value : lens.intrinsics) text += " " + Digits(value) + ",";
  return text + " ],\n  'imagersize': [ " + std::to_string(width) + ", " + std::to_string(height) +
         " ]\n}\n";
}

}  // namespace turnlight::calib
