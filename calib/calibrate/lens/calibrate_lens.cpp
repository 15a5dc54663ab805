#include "calib/calibrate/lens/calibrate_lens.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/angles.h"
#include "base/format.h"
#include "base/statistics.h"
#include "calib/calibrate/board/number_lattice.h"
#include "calib/calibrate/lens/agreeing_numbering.h"
#include "calib/calibrate/lens/board_shape.h"
#include "calib/calibrate/lens/covariance.h"
#include "calib/calibrate/lens/fit_views.h"
#include "calib/calibrate/lens/problem.h"

namespace turnlight::calib::calibrate::lens {
namespace {

constexpr std::size_t kLeastPoints = 6;
constexpr double kMaxUncertainty = 0.05;  // of the picture's diagonal: then there is no calibration
constexpr double kLargeUncertaintyPx = 1.0;
// The place of each point is fitted where that leaves less than this share of the residuals, and
// they are no noise of the corners. A board that is flat but for its bend leaves all of them.
constexpr double kShapeGain = 0.7;
constexpr double kShapePx = 0.1;
constexpr double kBadFitPx = 2.0;       // rms per axis: more than any corner that was found is off
constexpr double kSmallTiltDeg = 15.0;  // between two boards: less tells little of the focal length

struct Chosen {
  std::vector<board::BoardView> views;
  std::vector<std::size_t> picture, board;  // of each view
  std::vector<DroppedView> dropped;
};

Status CheckSizes(const std::vector<PictureViews>& pictures) {
  std::map<std::pair<int, int>, std::size_t> counts;
  for (const PictureViews& picture : pictures) ++counts[{picture.width, picture.height}];
  const auto common =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
        return a.second < b.second;
      })->first;
  std::string odd;
  std::size_t others = 0;
  for (const PictureViews& picture : pictures) {
    if (std::pair(picture.width, picture.height) == common || ++others > 5) continue;
    odd += Format("%s%s (%d x %d)", odd.empty() ? "" : ", ", picture.picture.c_str(), picture.width,
                  picture.height);
  }
  if (others == 0) return {};
  return InputError(
      odd + (others > 5 ? Format(" and %zu more", others - 5) : "") +
      Format(": other sizes than the %zu pictures of %d x %d; a calibration is of one "
             "camera at one resolution",
             counts[common], common.first, common.second));
}

// Points as a homography would have them: the sign of the area that the board's axes span.
bool SeenMirrored(const std::vector<Eigen::Vector3d>& p_B, const board::BoardView& view) {
  const auto count = static_cast<Eigen::Index>(view.points.size());
  Eigen::MatrixXd from(count, 3), to(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const board::SeenPoint& seen = view.points[static_cast<std::size_t>(i)];
    from.row(i) << p_B[seen.point].x(), p_B[seen.point].y(), 1.0;
    to.row(i) = seen.pixel.transpose();
  }
  const Eigen::MatrixXd affine = from.colPivHouseholderQr().solve(to);
  return affine.topRows<2>().determinant() < 0.0;
}

bool OnALine(const std::vector<Eigen::Vector3d>& p_B, const board::BoardView& view) {
  Eigen::MatrixXd points(3, static_cast<Eigen::Index>(view.points.size()));
  for (std::size_t i = 0; i < view.points.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = p_B[view.points[i].point];
  const Eigen::MatrixXd centered = points.colwise() - points.rowwise().mean();
  const Eigen::VectorXd sizes = centered.jacobiSvd().singularValues();
  return sizes[1] < 1e-6 * sizes[0];
}

// Point i becomes to(i).
template <typename To>
board::BoardView Renumbered(const board::BoardView& view, const To& to) {
  board::BoardView result = view;
  for (board::SeenPoint& seen : result.points) seen.point = to(seen.point);
  std::sort(result.points.begin(), result.points.end(),
            [](const auto& a, const auto& b) { return a.point < b.point; });
  return result;
}

Chosen ChooseViews(const board::Board& board, const std::vector<PictureViews>& pictures) {
  const auto p_B = board::BoardPoints(board);
  Chosen chosen;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const PictureViews& picture = pictures[i];
    if (picture.boards.empty())
      chosen.dropped.push_back(
          {i, std::nullopt, picture.why_none.empty() ? "no board found" : picture.why_none});
    for (std::size_t k = 0; k < picture.boards.size(); ++k) {
      board::BoardView view = picture.boards[k];
      const auto drop = [&](std::string why) { chosen.dropped.push_back({i, k, std::move(why)}); };
      if (view.points.size() < kLeastPoints) {
        drop(Format("%zu points of the board found, at least %zu are needed", view.points.size(),
                    kLeastPoints));
        continue;
      }
      if (OnALine(p_B, view)) {
        drop("all points found are on a line");
        continue;
      }
      if (SeenMirrored(p_B, view)) {
        if (board.kind != board::BoardKind::kChessboard) {
          drop("the board is mirrored: it was printed mirrored, or the picture is flipped");
          continue;
        }
        // It is a chessboard whose points are numbered the other way round.
        const auto columns = static_cast<std::size_t>(board.columns);
        view = Renumbered(view, [columns](std::size_t point) {
          return point / columns * columns + (columns - 1 - point % columns);
        });
      }
      chosen.views.push_back(std::move(view));
      chosen.picture.push_back(i);
      chosen.board.push_back(k);
    }
  }
  return chosen;
}

// The reasons, and one picture's name with each.
std::string ReasonsOf(const std::vector<DroppedView>& dropped,
                      const std::vector<PictureViews>& pictures) {
  std::map<std::string, std::vector<std::string>> names;
  for (const DroppedView& drop : dropped)
    names[drop.reason].push_back(pictures[drop.picture].picture);
  std::string text;
  for (const auto& [reason, which] : names)
    text += Format("\n  %zu: %s (%s%s)", which.size(), reason.c_str(), which.front().c_str(),
                   which.size() > 1 ? ", ..." : "");
  return text;
}

Status CheckEnough(const Chosen& chosen, const std::vector<PictureViews>& pictures,
                   const LensOptions& options) {
  if (chosen.views.empty())
    return InputError(
        Format("none of the %zu pictures shows the board as it should be:", pictures.size()) +
        ReasonsOf(chosen.dropped, pictures));
  if (chosen.views.size() < 2)
    return InputError(
        Format(
            "one view of the board (%s) does not determine a lens: allowed are at least 2, and 10 "
            "to 30 are good, tilted differently and together covering the picture",
            pictures[chosen.picture.front()].picture.c_str()) +
        (chosen.dropped.empty() ? "" : "; not used:" + ReasonsOf(chosen.dropped, pictures)));
  std::size_t points = 0;
  for (const board::BoardView& view : chosen.views) points += view.points.size();
  const mrcal_lensmodel_t model = LensModelOf(options.lens_model);
  const std::size_t core = static_cast<std::size_t>(
      model.type == MRCAL_LENSMODEL_SPLINED_STEREOGRAPHIC ? 4 : mrcal_lensmodel_num_params(&model));
  const std::size_t parameters = core + 6 * chosen.views.size();
  if (2 * points <= parameters)
    return InputError(
        Format("%zu points in %zu views give %zu numbers for %zu unknowns of %s and "
               "the boards' poses: take more pictures, or a simpler lens model",
               points, chosen.views.size(), 2 * points, parameters, options.lens_model.c_str()));
  return {};
}

double LargestTiltBetween(const std::vector<FittedView>& views) {
  double least = 1.0;
  for (const FittedView& a : views)
    for (const FittedView& b : views)
      least = std::min(least, a.X_CB.rotation.col(2).dot(b.X_CB.rotation.col(2)));
  return RadToDeg(std::acos(std::clamp(least, -1.0, 1.0)));
}

void AddViews(const ViewsFit& fit, const Chosen& chosen, LensCalibration& result) {
  const std::size_t per_view = fit.problem.points_per_view();
  for (std::size_t i = 0; i < fit.used.size(); ++i) {
    const std::size_t view = fit.used[i];
    FittedView fitted{chosen.picture[view], chosen.board[view], ToPose(fit.problem.poses[i])};
    const auto residuals = Residuals(fit.problem, i);
    double sum = 0.0;
    for (const board::SeenPoint& seen : chosen.views[view].points) {
      const auto cell = static_cast<std::size_t>(fit.problem.grid.cells[seen.point]);
      FittedPoint point{i,
                        seen.point,
                        seen.pixel,
                        residuals[cell],
                        1.0 / seen.spread,
                        fit.problem.observed[i * per_view + cell].z < 0.0};
      ++fitted.points;
      if (point.outlier)
        ++fitted.outliers;
      else
        sum += 0.5 * point.residual.squaredNorm();
      result.points.push_back(point);
    }
    fitted.rms_px = std::sqrt(
        sum / static_cast<double>(std::max<std::size_t>(1, fitted.points - fitted.outliers)));
    result.outliers += fitted.outliers;
    result.views.push_back(fitted);
  }
}

// Median over the points of how uncertain a projection is there, in pixels, at infinity.
double UncertaintyWherePointsAre(const LensCalibration& calibration) {
  std::vector<Eigen::Vector2d> pixels;
  const std::size_t step = std::max<std::size_t>(1, calibration.points.size() / 500);
  for (std::size_t i = 0; i < calibration.points.size(); i += step)
    pixels.push_back(calibration.points[i].pixel);
  std::vector<double> sigmas;
  for (const Eigen::Matrix2d& covariance : calibration.uncertainty.At(pixels))
    if (!covariance.hasNaN()) sigmas.push_back(WorstSigma(covariance));
  return sigmas.empty() ? std::numeric_limits<double>::infinity() : Median(sigmas);
}

// Fits the place of each of the board's points if the residuals ask for it: then they repeat from
// view to view. Gives what they were before.
std::optional<double> FitShapeIfBetter(double before, ViewsFit& fit) {
  Problem shaped = fit.problem;
  if (!FitShape(shaped, fit.pass)) return std::nullopt;
  const Linearization linear = Linearize(shaped, fit.pass);
  const double after = NoiseOf(shaped, linear).rms_px;
  const double left = static_cast<double>(linear.observation_rows - linear.jacobian.cols());
  if (!(left > 0.0)) return std::nullopt;
  const double unbiased = after * std::sqrt(static_cast<double>(linear.observation_rows) / left);
  if (unbiased > kShapeGain * before) return std::nullopt;
  fit.problem = std::move(shaped);
  return before;
}

std::optional<double> FitShapeIfNeeded(const std::array<int, 2>& size, const board::Board& board,
                                       const LensOptions& options, Chosen& chosen, ViewsFit& fit) {
  const double before = NoiseOf(fit.problem, Linearize(fit.problem, fit.pass)).rms_px;
  if (!options.fits_shape || before < kShapePx) return std::nullopt;
  if (const auto agreeing = AgreeingNumberings(board, fit.problem, fit.pass)) {
    const auto ways = board::SameLookingNumberings(board);
    std::vector<board::BoardView> views = chosen.views;
    for (std::size_t i = 0; i < fit.used.size(); ++i)
      views[fit.used[i]] = Renumbered(
          views[fit.used[i]], [&](std::size_t point) { return ways[(*agreeing)[i]][point]; });
    auto turned = FitViews(size, board, views, options);
    if (turned && FitShapeIfBetter(before, *turned)) {
      chosen.views = std::move(views);
      fit = std::move(*turned);
      return before;
    }
  }
  return FitShapeIfBetter(before, fit);
}

void AddShape(const Problem& problem, double rms_before, LensCalibration& result) {
  double largest = 0.0;
  for (const int cell : problem.grid.cells) {
    result.shape.push_back(problem.shape[static_cast<std::size_t>(cell)]);
    largest = std::max(largest, result.shape.back().norm());
  }
  result.notes.push_back(Format(
      "The board is not flat: its points are up to %.2g %% of a square off a smooth bend, and "
      "with that alone the rms was %.2g px. The place of each point was fitted as well. Glue "
      "the board to glass or aluminium.",
      100.0 * largest / problem.grid.spacing, rms_before));
}

// What a fit this bad says, or nothing.
std::string MisfitAdvice(double rms_px, const std::string& lens_model) {
  if (rms_px < kBadFitPx) return "";
  return Format(
      "The points lie %.3g px (rms per axis) off where %s puts them: it is not the model "
      "of this lens, or the corners are bad. OPENCV8 suits most lenses, a splined model "
      "fisheyes. ",
      rms_px, lens_model.c_str());
}

std::string TiltAdvice(double tilt_deg, std::size_t views) {
  std::string advice =
      Format("%zu views, tilted against each other by at most %.0f degrees", views, tilt_deg);
  return advice + (tilt_deg < kSmallTiltDeg
                       ? ": boards that are parallel leave focal length and distance "
                         "interchangeable; tilt the board by 30 to 45 degrees in several directions"
                       : ": take more pictures, closer, and from more sides");
}

Status Judge(LensCalibration& result) {
  const double sigma = UncertaintyWherePointsAre(result);
  const double diagonal = std::hypot(result.camera().width(), result.camera().height());
  const double tilt = LargestTiltBetween(result.views);
  if (!(sigma <= kMaxUncertainty * diagonal))
    return NoEstimateError(Format("the views do not determine the lens: where its points are, a "
                                  "projection is uncertain by %.3g px (allowed is 5 %% of the "
                                  "picture's diagonal, %.3g px). ",
                                  sigma, kMaxUncertainty * diagonal) +
                           MisfitAdvice(result.rms_px, result.camera().lens_model()) +
                           TiltAdvice(tilt, result.views.size()));
  if (result.rms_px >= kBadFitPx)
    result.notes.push_back(MisfitAdvice(result.rms_px, result.camera().lens_model()));
  if (sigma > kLargeUncertaintyPx || tilt < kSmallTiltDeg)
    result.notes.push_back(
        Format("A projection is uncertain by %.3g px where the points are. ", sigma) +
        TiltAdvice(tilt, result.views.size()) + ".");
  return {};
}

Result<CameraModel> ToCameraModel(const Problem& problem, const std::string& name) {
  std::string text =
      "{'lensmodel': '" + name + "', 'extrinsics': [0,0,0,0,0,0], 'imagersize': " +
      Format("[%d, %d], 'intrinsics': [", problem.image_size[0], problem.image_size[1]);
  for (const double value : problem.intrinsics) text += Format("%.17g,", value);
  return CameraModel::FromString(text + "]}", "the fitted lens");
}

}  // namespace

Result<LensCalibration> CalibrateLens(const board::Board& board,
                                      const std::vector<PictureViews>& pictures,
                                      const LensOptions& options) {
  if (pictures.empty()) return InputError("no pictures given, allowed are at least 2");
  if (const Status status = CheckSizes(pictures); !status) return Forward(status);
  Chosen chosen = ChooseViews(board, pictures);
  if (const Status status = CheckEnough(chosen, pictures, options); !status) return Forward(status);
  const std::array<int, 2> size{pictures.front().width, pictures.front().height};
  auto fit = FitViews(size, board, chosen.views, options);
  if (!fit) return Forward(fit);
  const auto rms_before_shape = FitShapeIfNeeded(size, board, options, chosen, *fit);
  auto camera = ToCameraModel(fit->problem, options.lens_model);
  if (!camera) return Forward(camera);
  if (options.progress) options.progress("uncertainty");
  const Linearization linear = Linearize(fit->problem, fit->pass);
  const FitNoise noise = NoiseOf(fit->problem, linear);
  const auto covariance = CalibrationCovariance(fit->problem, linear, noise.noise_px);
  LensCalibration result(
      ProjectionUncertainty(std::move(*camera), covariance.value_or(Eigen::MatrixXd())));
  result.dropped = std::move(chosen.dropped);
  AddViews(*fit, chosen, result);
  for (const FitDrop& drop : fit->dropped)
    result.dropped.push_back({chosen.picture[drop.view], chosen.board[drop.view], drop.reason});
  if (!covariance)
    return NoEstimateError("the views do not determine the lens: the equations are singular. " +
                           MisfitAdvice(noise.rms_px, options.lens_model) +
                           TiltAdvice(LargestTiltBetween(result.views), result.views.size()));
  if (rms_before_shape) AddShape(fit->problem, *rms_before_shape, result);
  result.warp_fitted = fit->pass.warp;
  result.warp = {fit->problem.warp.x2, fit->problem.warp.y2};
  result.rms_px = noise.rms_px;
  result.noise_px = noise.noise_px;
  result.parameters = noise.parameters;
  if (Status status = Judge(result); !status) {
    if (!result.dropped.empty())
      status.error().text += "; not used:" + ReasonsOf(result.dropped, pictures);
    return Forward(status);
  }
  return result;
}

}  // namespace turnlight::calib::calibrate::lens
