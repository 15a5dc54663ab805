#include "calib/calibrate/lens/assess_lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/format.h"
#include "base/statistics.h"
#include "calib/calibrate/lens/cross_validation.h"

namespace turnlight::calib::calibrate::lens {
namespace {

constexpr double kUncovered = 0.25;      // of a region's area: with less it is not covered
constexpr double kWellCovered = 0.6;     // with less a picture more would help
constexpr double kUncertainRatio = 3.0;  // against the middle's sigma
// A view whose rms is so many times the median's, or of whose points so many are outliers.
constexpr double kDoubtfulRatio = 2.0, kDoubtfulOutliers = 0.2;
// Of the halves' difference to what noise explains; a dozen intrinsics give it a spread of a third.
constexpr double kHalvesRatio = 2.5;

constexpr std::array<const char*, 9> kRegionNames{
    "top left corner", "top edge",           "top right corner", "left edge",          "middle",
    "right edge",      "bottom left corner", "bottom edge",      "bottom right corner"};

Coverage CoverageOf(const LensCalibration& calibration) {
  const int width = calibration.camera().width(), height = calibration.camera().height();
  Coverage coverage;
  coverage.rows = std::max(
      1, static_cast<int>(std::lround(static_cast<double>(height) / width * coverage.columns)));
  coverage.points.resize(static_cast<std::size_t>(coverage.columns * coverage.rows));
  for (const FittedPoint& point : calibration.points) {
    if (point.outlier) continue;
    const auto cell = [](double at, int size, int count) {
      return std::clamp(static_cast<int>(std::floor((at + 0.5) / size * count)), 0, count - 1);
    };
    const int column = cell(point.pixel.x(), width, coverage.columns);
    const int row = cell(point.pixel.y(), height, coverage.rows);
    ++coverage.points[static_cast<std::size_t>(row * coverage.columns + column)];
  }
  return coverage;
}

std::vector<double> WorstSigmas(const std::vector<Eigen::Matrix2d>& covariances) {
  std::vector<double> sigmas;
  for (const Eigen::Matrix2d& covariance : covariances) sigmas.push_back(WorstSigma(covariance));
  return sigmas;
}

double MedianOfFinite(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : Median(values);
}

std::vector<Region> Regions(const LensAssessment& assessment) {
  const ImageGrid& grid = assessment.grid;
  std::array<std::vector<double>, 9> sigmas;
  std::array<double, 9> covered{}, count{};
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * grid.columns + column);
      const auto region =
          static_cast<std::size_t>(3 * (3 * row / grid.rows) + 3 * column / grid.columns);
      sigmas[region].push_back(assessment.sigma_px[i]);
      covered[region] += assessment.covered[i] ? 1.0 : 0.0;
      count[region] += 1.0;
    }
  std::vector<Region> regions;
  for (std::size_t i = 0; i < 9; ++i)
    regions.push_back({kRegionNames[i], covered[i] / count[i], MedianOfFinite(sigmas[i])});
  return regions;
}

// "the corners", or "the top left corner, the left edge".
std::string NamesOf(const std::vector<Region>& regions, std::vector<std::size_t> which) {
  std::vector<std::string> names;
  const std::array<std::array<std::size_t, 4>, 2> groups{{{0, 2, 6, 8}, {1, 3, 5, 7}}};
  for (std::size_t g = 0; g < 2; ++g) {
    const auto in = [&](std::size_t i) {
      return std::find(which.begin(), which.end(), i) != which.end();
    };
    if (!std::all_of(groups[g].begin(), groups[g].end(), in)) continue;
    names.emplace_back(g == 0 ? "the corners" : "the edges");
    for (const std::size_t i : groups[g]) std::erase(which, i);
  }
  for (const std::size_t i : which) names.push_back("the " + regions[i].name);
  return Listed(names);
}

std::vector<std::size_t> Doubtful(const LensCalibration& calibration) {
  std::vector<double> rms;
  for (const FittedView& view : calibration.views) rms.push_back(view.rms_px);
  const double median = Median(rms);
  std::vector<std::size_t> doubtful;
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const FittedView& view = calibration.views[i];
    if (view.rms_px > kDoubtfulRatio * median ||
        static_cast<double>(view.outliers) > kDoubtfulOutliers * static_cast<double>(view.points))
      doubtful.push_back(i);
  }
  return doubtful;
}

std::string HalvesInWords(const Result<CrossValidation>& halves) {
  if (!halves) return "No cross-validation: " + halves.error().text + ".";
  const bool agree = halves->rms_px <= kHalvesRatio * halves->expected_px;
  return Format(
      "Two halves of the pictures %s: %.2g px apart where both cover, noise explains %.2g "
      "px.%s",
      agree ? "agree" : "disagree", halves->rms_px, halves->expected_px,
      agree ? ""
            : " The lens model, the board's flatness or the corners are worse than the "
              "noise says: believe the difference, not the stated uncertainty.");
}

std::string Verdict(const LensAssessment& assessment, const LensCalibration& calibration) {
  const double middle = assessment.regions[4].sigma_px;
  std::string text = Format(
      "Good for %.2g px in the middle, for %.2g px over 95 %% of what the "
      "boards covered (1 sigma in the worst direction, at infinity)",
      middle, assessment.covered_sigma_px);
  std::vector<std::size_t> uncovered;
  for (std::size_t i = 0; i < assessment.regions.size(); ++i)
    if (assessment.regions[i].covered_share < kUncovered) uncovered.push_back(i);
  const bool plural = uncovered.size() > 1;
  text += uncovered.empty() ? "; all of the picture is covered."
                            : "; " + NamesOf(assessment.regions, uncovered) +
                                  (plural ? " are not covered." : " is not covered.");
  text += Format(" The points fit with %.2g px rms per axis. ", calibration.rms_px);
  return text + HalvesInWords(assessment.halves);
}

std::vector<std::string> Advice(const LensAssessment& assessment,
                                const LensCalibration& calibration,
                                const std::vector<PictureViews>& pictures) {
  std::vector<std::string> advice;
  std::vector<double> rms;
  for (const FittedView& view : calibration.views) rms.push_back(view.rms_px);
  const double median = Median(rms);
  for (const std::size_t i : assessment.doubtful) {
    const FittedView& view = calibration.views[i];
    advice.push_back(Format(
        "Look at %s, and leave it out if it is blurred or the board moved: rms "
        "%.2g px, the median view's is %.2g px; %zu of %zu points are outliers.",
        pictures[view.picture].picture.c_str(), view.rms_px, median, view.outliers, view.points));
  }
  std::vector<std::size_t> add;
  const double middle = assessment.regions[4].sigma_px;
  for (std::size_t i = 0; i < assessment.regions.size(); ++i) {
    const Region& region = assessment.regions[i];
    if (region.covered_share < kWellCovered || !(region.sigma_px <= kUncertainRatio * middle))
      add.push_back(i);
  }
  if (!add.empty())
    advice.push_back("Add two or three pictures with the board in each of: " +
                     NamesOf(assessment.regions, add) + ".");
  return advice;
}

}  // namespace

LensAssessment AssessLens(const board::Board& board, const std::vector<PictureViews>& pictures,
                          const LensCalibration& calibration, const LensOptions& options,
                          std::optional<double> distance) {
  LensAssessment result;
  const CameraModel& camera = calibration.camera();
  result.grid = GridOverImage(camera.width(), camera.height());
  result.covered = CoveredPixels(calibration, result.grid.pixels);
  result.sigma_px = WorstSigmas(calibration.uncertainty.At(result.grid.pixels));
  result.distance = distance;
  if (distance)
    result.sigma_at_distance_px =
        WorstSigmas(calibration.uncertainty.At(result.grid.pixels, distance));
  result.coverage = CoverageOf(calibration);
  std::vector<double> covered_sigmas;
  for (std::size_t i = 0; i < result.covered.size(); ++i)
    if (result.covered[i]) covered_sigmas.push_back(result.sigma_px[i]);
  result.covered_share = static_cast<double>(covered_sigmas.size()) /
                         static_cast<double>(std::max<std::size_t>(1, result.covered.size()));
  result.covered_sigma_px = NearestRank(covered_sigmas, 0.95);
  result.regions = Regions(result);
  result.halves = CompareHalves(board, pictures, calibration, options, result.grid);
  result.doubtful = Doubtful(calibration);
  result.verdict = Verdict(result, calibration);
  result.advice = Advice(result, calibration, pictures);
  return result;
}

}  // namespace turnlight::calib::calibrate::lens
