#include "calib/calibrate/lens/fit_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/format.h"
#include "base/statistics.h"
#include "calib/calibrate/lens/lens_model_name.h"
#include "calib/calibrate/lens/seed.h"

namespace turnlight::calib::calibrate::lens {
namespace {

// A view whose points lie so many times as far off as the median view's, and at least so far, does
// not belong: another board, corners taken for others, a blur. What noise does stays within 2
// times.
constexpr double kMisfitRatio = 5.0;
constexpr double kMisfitPx = 1.0;
constexpr double kMostOutliers = 0.5;  // of a view's points
constexpr int kMaxRounds = 6;
// Points so near to where they should be, on average, are those of the right fit: no other is
// tried.
constexpr double kGoodFitPx = 1.0;
constexpr std::size_t kWarpViews = 3, kLeastViews = 2;

std::vector<board::BoardView> Chosen(const std::vector<board::BoardView>& views,
                                     const std::vector<std::size_t>& used) {
  std::vector<board::BoardView> chosen;
  for (const std::size_t view : used) chosen.push_back(views[view]);
  return chosen;
}

// Distortions that are not exactly zero, where some models have no derivatives. Those of the
// denominator begin smaller: numerator and denominator do nearly the same.
std::vector<double> ExpandCore(const std::array<double, 4>& core, const mrcal_lensmodel_t& model) {
  std::vector<double> intrinsics(core.begin(), core.end());
  const auto count = static_cast<std::size_t>(mrcal_lensmodel_num_params(&model));
  for (std::size_t i = intrinsics.size(); i < count; ++i) {
    const bool denominator = MRCAL_LENSMODEL_IS_OPENCV(model.type) && i >= 9 && i < 12;
    intrinsics.push_back((i % 2 == 0 ? 1e-6 : -1e-6) * (denominator ? 1e-3 : 1.0));
  }
  return intrinsics;
}

// Mean distance of all points from where they should be: less moved by what is far off than the sum
// of squares that the optimizer minimizes.
double Misfit(const Problem& problem) {
  double sum = 0.0, count = 0.0;
  for (std::size_t view = 0; view < problem.poses.size(); ++view)
    for (const Eigen::Vector2d& residual : Residuals(problem, view))
      if (!residual.hasNaN()) {
        sum += residual.norm();
        count += 1.0;
      }
  return sum / count;
}

struct Fit {
  Problem problem;
  Pass pass;
};

std::optional<Fit> FitFrom(const Seed& seed, Problem problem, const LensOptions& options,
                           bool warp) {
  problem.intrinsics = ExpandCore(seed.core, problem.model);
  problem.poses = seed.poses;
  Pass pass{.core = !IsSplined(options.lens_model),
            .distortions = true,
            .regularized = true,
            .rejects_outliers = options.rejects_outliers};
  if (!Optimize(problem, pass)) return std::nullopt;
  pass.warp = warp;
  if (warp && !Optimize(problem, pass)) return std::nullopt;
  if (!(problem.intrinsics[0] > 0.0 && problem.intrinsics[1] > 0.0)) return std::nullopt;
  return Fit{std::move(problem), pass};
}

std::optional<Fit> FitOnce(const std::array<int, 2>& image_size, const board::Board& board,
                           const std::vector<board::BoardView>& views, const LensOptions& options) {
  Problem problem;
  problem.model = LensModelOf(options.lens_model);
  problem.image_size = image_size;
  problem.grid = GridOfBoard(board);
  for (const board::BoardView& view : views) {
    const auto observed = Observations(problem.grid, view);
    problem.observed.insert(problem.observed.end(), observed.begin(), observed.end());
  }
  const bool warp =
      options.fits_warp && views.size() >= kWarpViews && board.columns >= 3 && board.rows >= 3;
  std::optional<Fit> best;
  double least = 0.0;
  for (const Seed& seed : FindSeeds(image_size, board, views)) {
    auto fit = FitFrom(seed, problem, options, warp);
    if (!fit) continue;
    const double misfit = Misfit(fit->problem);
    if (best && !(misfit < (1.0 - 1e-6) * least)) continue;
    least = misfit;
    best = std::move(fit);
    if (least < kGoodFitPx) break;
  }
  return best;
}

struct ViewMisfit {
  double px = 0.0;  // root of the mean squared distance of all points, outliers too
  double outlier_share = 0.0;
};

std::vector<ViewMisfit> Misfits(const Problem& problem) {
  std::vector<ViewMisfit> misfits;
  const std::size_t points = problem.points_per_view();
  for (std::size_t view = 0; view < problem.poses.size(); ++view) {
    const auto residuals = Residuals(problem, view);
    double sum = 0.0, seen = 0.0, outliers = 0.0;
    for (std::size_t i = 0; i < points; ++i) {
      if (residuals[i].hasNaN()) continue;
      sum += residuals[i].squaredNorm();
      seen += 1.0;
      if (problem.observed[view * points + i].z < 0.0) outliers += 1.0;
    }
    misfits.push_back({std::sqrt(sum / seen), outliers / seen});
  }
  return misfits;
}

// Which of the fitted views do not belong, the worst ones: what is half as bad as the worst may be
// its victim.
std::vector<std::size_t> Misfitting(const std::vector<ViewMisfit>& misfits, double median) {
  double worst = 0.0;
  for (const ViewMisfit& misfit : misfits) worst = std::max(worst, misfit.px);
  std::vector<std::size_t> bad;
  for (std::size_t i = 0; i < misfits.size(); ++i) {
    const bool far = misfits[i].px > std::max(kMisfitPx, kMisfitRatio * median);
    if ((far && misfits[i].px > 0.5 * worst) || misfits[i].outlier_share > kMostOutliers)
      bad.push_back(i);
  }
  return bad;
}

}  // namespace

Result<ViewsFit> FitViews(const std::array<int, 2>& image_size, const board::Board& board,
                          const std::vector<board::BoardView>& views, const LensOptions& options) {
  ViewsFit result;
  result.used.resize(views.size());
  std::iota(result.used.begin(), result.used.end(), std::size_t{0});
  for (int round = 0;; ++round) {
    if (options.progress)
      options.progress("fitting " + std::to_string(result.used.size()) + " views");
    auto fit = FitOnce(image_size, board, Chosen(views, result.used), options);
    if (!fit)
      return NoEstimateError(
          "no lens of the model " + options.lens_model + " fits the " +
          std::to_string(result.used.size()) +
          " views: is it this board, with its squares as wide as told, and are all "
          "pictures of one lens? If so, try a simpler lens model");
    const auto misfits = Misfits(fit->problem);
    std::vector<double> sizes;
    for (const ViewMisfit& misfit : misfits) sizes.push_back(misfit.px);
    const double median = Median(sizes);
    const auto bad = Misfitting(misfits, median);
    result.problem = std::move(fit->problem);
    result.pass = fit->pass;
    if (bad.empty() || round == kMaxRounds || result.used.size() < bad.size() + kLeastViews)
      return result;
    for (std::size_t i = bad.size(); i-- > 0;) {  // the last first, so that places stay
      const std::size_t view = bad[i];
      result.dropped.push_back(
          {result.used[view],
           Format("does not fit: its points lie %.3g px off, the median view's %.3g px",
                  misfits[view].px, median)});
      result.used.erase(result.used.begin() + static_cast<std::ptrdiff_t>(view));
    }
  }
}

}  // namespace turnlight::calib::calibrate::lens
