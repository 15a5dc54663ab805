// Proves: the same corners give the solution and the uncertainties of mrcal's own tool and Python,
// and Python reads the same bits from our camera model.
// Does not prove: that either is right; calibrate_lens_test.cpp and the coverage study do.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>

#include "base/file.h"
#include "base/format.h"
#include "calib/calibrate/lens/projection_difference.h"
#include "simulated_views.h"
#include "tests/temporary_folder.h"

namespace turnlight::calib::calibrate::lens {
namespace {

namespace fs = std::filesystem;

std::string CornersFile(const std::vector<PictureViews>& pictures, std::size_t points) {
  std::string text = "# filename x y level\n";
  for (const PictureViews& picture : pictures) {
    std::vector<std::string> lines(points, "- - -");
    for (const board::SeenPoint& seen : picture.boards[0].points)
      lines[seen.point] = Format("%.17g %.17g 0", seen.pixel.x(), seen.pixel.y());
    for (const std::string& line : lines) text += picture.picture + ".png " + line + "\n";
  }
  return text;
}

std::string UncertaintyFile(const LensCalibration& calibration) {
  const ImageGrid grid =
      GridOverImage(calibration.camera().width(), calibration.camera().height(), 7);
  const auto far = calibration.uncertainty.At(grid.pixels);
  const auto near = calibration.uncertainty.At(grid.pixels, 500.0);
  std::string text;
  for (std::size_t i = 0; i < grid.pixels.size(); ++i)
    text += Format("%.17g %.17g %.17g %.17g\n", grid.pixels[i].x(), grid.pixels[i].y(),
                   WorstSigma(far[i]), WorstSigma(near[i]));
  return text;
}

std::string FitFile(const LensCalibration& calibration) {
  std::string text =
      Format("{\"warp\": [%.17g, %.17g], \"poses\": [", calibration.warp.x(), calibration.warp.y());
  for (const FittedView& view : calibration.views) {
    const std::vector<double> rows = RowsFromPose(view.X_CB);
    for (std::size_t i = 0; i < 12; ++i)
      text += Format("%s%.17g%s",
                     i == 0       ? "[["
                     : i % 4 == 0 ? "["
                                  : "",
                     rows[i],
                     i == 11      ? "]],"
                     : i % 4 == 3 ? "],"
                                  : ",");
  }
  text.back() = ']';
  return text + "}";
}

void CompareWithMrcal(const std::string& how_compared, const std::string& lens_model) {
  const TemporaryFolder folder;
  const board::Board board = ExampleBoard();
  SimulatedViews how;
  how.warp = {0.15, -0.1};
  const auto pictures = SimulateViews(ExampleLens(), board, how);
  LensOptions options;
  options.lens_model = lens_model;
  const auto ours = CalibrateLens(board, pictures, options);
  ASSERT_TRUE(ours) << ours.error().text;
  const fs::path path = folder.path();
  ASSERT_TRUE(WriteFileAtomic(path / "corners.vnl", CornersFile(pictures, 100)));
  ASSERT_TRUE(WriteFileAtomic(path / "ours.cameramodel", ours->camera().ToString()));
  ASSERT_TRUE(WriteFileAtomic(path / "uncertainty.txt", UncertaintyFile(*ours)));
  ASSERT_TRUE(WriteFileAtomic(path / "fit.json", FitFile(*ours)));
  const std::string command = "/usr/bin/python3 " TURNLIGHT_SOURCE_DIR
                              "/tests/calib/calibrate/lens/compare_with_mrcal.py " +
                              how_compared + " " + path.string() + " " + lens_model +
                              " 1800 20 10 10 2000 1400 > " + (path / "out.txt").string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::istringstream lines(*ReadFile(path / "out.txt"));
  std::map<std::string, double> values;
  std::vector<double> intrinsics;
  std::string name;
  for (double value = 0.0; lines >> name >> value;) {
    if (name == "intrinsic") intrinsics.push_back(value);
    values[name] = value;
  }
  EXPECT_LT(values.at("difference_px"), 0.001);
  EXPECT_LT(values.at("worst_ratio_far"), 0.02);
  EXPECT_LT(values.at("worst_ratio_near"), 0.02);
  EXPECT_EQ(intrinsics, ours->camera().intrinsics());
}

TEST(MrcalComparison, TheToolFindsTheSame) { CompareWithMrcal("tool", "LENSMODEL_OPENCV8"); }

TEST(MrcalComparison, UncertaintyOfASplinedLens) {
  CompareWithMrcal("optimum", "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=12_Ny=9_fov_x_deg=80");
}

}  // namespace
}  // namespace turnlight::calib::calibrate::lens
