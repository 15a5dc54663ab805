// One camera of each lens model that mrcal 2.2 knows, with coefficients as real lenses have them.
#pragma once

#include <string>
#include <vector>

namespace turnlight::calib {

struct LensExample {
  std::string name;
  std::vector<double> intrinsics;
};

// 640 x 480 pixels each.
std::vector<LensExample> LensExamples();

// The text of a .cameramodel of that lens, written here and not by the code under test.
std::string ModelText(const LensExample& lens, int width = 640, int height = 480);

}  // namespace turnlight::calib
