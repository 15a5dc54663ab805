#include "calib/calibrate/axis/axis_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "calib/calibrate/axis/board_pose.h"
#include "calib/calibrate/axis/numbering.h"
#include "calib/calibrate/board/number_lattice.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::axis {
namespace {

constexpr std::size_t kFewestPoints = 6;
// Scale and board take two of the angles, and the variance of Student's t with the degrees of
// freedom that remain is infinite below three of them.
constexpr std::size_t kFewestViews = 5;
constexpr std::size_t kFewestAngles = 3;
constexpr double kSameAngleDeg = 0.5;
// Of two coordinates with normal noise one in 3e5 is further out than 5 sigma.
constexpr double kOutlierSigmas = 5.0;
constexpr double kMedianOfRayleigh = 1.1774;
// Nobody's corners are better; it keeps pictures without noise from being sifted by rounding.
constexpr double kLeastSigmaPx = 0.01;
constexpr std::size_t kFewestForMedian = 8;  // views whose deviations are judged by their median
constexpr int kMostRounds = 20;
// To begin with; the data decide.
constexpr double kFirstAngleNoise = DegToRad(0.1) / 0.3;  // radians by pixels
// Of -2 log likelihood: odds of 20000 to 1.
constexpr double kDecisive = 20.0;
// Fits that left out other points differ by less, those of another axis by more.
constexpr double kSameDirection = DegToRad(0.5);
constexpr double kSameScale = 0.05;
constexpr double kLeastAngle = DegToRad(1e-4);
constexpr double kSettled = 1e-3;  // relative change of the noise

struct Guesses {
  std::vector<std::size_t> of;  // views of the input
  std::vector<TurningView> views;
  std::vector<std::vector<bool>> fits;
};

Guesses GuessAll(const board::Board& board, const CameraModel& camera,
                 const std::vector<AxisView>& views, std::vector<FitView>& fit) {
  std::vector<BoardPoses> poses(views.size());
  ParallelFor(views.size(), [&](std::size_t i) {
    if (views[i].board.points.size() >= kFewestPoints)
      poses[i] = GuessBoardPoses(board, camera, views[i].board);
  });
  Guesses guesses;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::size_t points = views[i].board.points.size();
    if (points == 0)
      fit[i].why_not = "no board was found";
    else if (points < kFewestPoints)
      fit[i].why_not = "only " + std::to_string(points) + " points of the board were found";
    else if (poses[i].X_CB.empty())
      fit[i].why_not = "no pose of the board fits its points";
    if (!fit[i].why_not.empty()) continue;
    guesses.of.push_back(i);
    guesses.views.push_back({views[i].angle_deg, poses[i].X_CB});
    guesses.fits.push_back(poses[i].fits);
  }
  return guesses;
}

// Angles that are the same up to whole turns count once.
std::size_t DistinctAngles(const std::vector<double>& angles_deg) {
  std::vector<double> distinct;
  for (const double angle : angles_deg)
    if (std::none_of(distinct.begin(), distinct.end(), [angle](double other) {
          return std::abs(std::remainder(angle - other, 360.0)) < kSameAngleDeg;
        }))
      distinct.push_back(angle);
  return distinct.size();
}

Status CheckEnough(const std::vector<double>& angles_deg, std::size_t views, bool fits_backlash) {
  const std::size_t distinct = DistinctAngles(angles_deg);
  const std::size_t fewest = kFewestViews + (fits_backlash ? 1 : 0);
  const std::string count =
      std::to_string(angles_deg.size()) + " of " + std::to_string(views) + " views can be used";
  if (angles_deg.size() < fewest)
    return NoEstimateError(count + ", allowed are at least " + std::to_string(fewest) +
                           ": with fewer the noise of the angles cannot be told from the scale" +
                           (fits_backlash ? " and the backlash" : ""));
  if (distinct < kFewestAngles)
    return NoEstimateError(count + ", and they are at " + std::to_string(distinct) +
                           " different angles, allowed are at least " +
                           std::to_string(kFewestAngles) + ": a circle takes three points");
  return {};
}

// The point that the views' boards turn about, nearest to the board's path.
Eigen::Vector3d PointOnAxis(const Guesses& guesses, const std::vector<Pose>& turns,
                            const TurningBoard& turning, const Eigen::Vector3d& middle_B) {
  Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
  double count = 0.0;
  const auto middle_of = [&](std::size_t i) {
    const TurningBoard::Choice& choice = turning.choices[i];
    return guesses.views[i].X_CB[choice.tilt] * (turns[choice.turn] * middle_B);
  };
  const Eigen::Vector3d first = middle_of(turning.reference);
  for (std::size_t i = 0; i < guesses.views.size(); ++i) {
    const TurningBoard::Choice& choice = turning.choices[i];
    if (!choice.fits) continue;
    const Eigen::Matrix3d turn = Turn(turning.direction_C, choice.turned).rotation;
    const Eigen::Matrix3d off_axis = Eigen::Matrix3d::Identity() - turn;
    const Eigen::Vector3d middle = middle_of(i);
    left += off_axis.transpose() * off_axis;
    right += off_axis.transpose() * (middle - turn * first);
    mean += middle;
    count += 1.0;
  }
  mean /= count;
  const Eigen::Vector3d& u = turning.direction_C;
  // Nothing tells where along the axis.
  left += left.trace() * u * u.transpose();
  const Eigen::Vector3d a = left.ldlt().solve(right);
  return a + u * u.dot(mean - a);
}

void Place(const board::Board& board, const std::vector<AxisView>& views, const Guesses& guesses,
           const std::vector<Pose>& turns, const TurningBoard& turning, AxisFit& fit) {
  const auto points = BoardPoints(board);
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < guesses.of.size(); ++i) {
    FitView& view = fit.views[guesses.of[i]];
    const TurningBoard::Choice& choice = turning.choices[i];
    view.used = choice.fits;
    view.numbering = choice.turn;
    if (!choice.fits) {
      view.why_not = "the board is turned " + NumberText(choice.off_deg, 3) +
                     " degrees away from where the others and its angle put it";
      continue;
    }
    sum += views[guesses.of[i]].angle_deg;
    count += 1.0;
    const Pose back = turns[choice.turn].Inverse();
    for (const board::SeenPoint& seen : views[guesses.of[i]].board.points)
      view.all.points.push_back({back * points[seen.point], seen.pixel, seen.spread});
    view.fits = guesses.fits[i];
  }
  fit.angle_ref_deg = sum / count;
  for (std::size_t i = 0; i < views.size(); ++i)
    fit.views[i].all.angle = DegToRad(views[i].angle_deg - fit.angle_ref_deg);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) middle += point / static_cast<double>(points.size());
  TurningState& state = fit.state;
  state.u = turning.direction_C;
  state.scale = turning.scale;
  state.a = PointOnAxis(guesses, turns, turning, middle);
  const std::size_t reference = turning.reference;
  const Pose& X_CB = guesses.views[reference].X_CB[turning.choices[reference].tilt];
  const Pose turn = Turn(state.u, -state.scale * fit.views[guesses.of[reference]].all.angle);
  state.X_CB = {turn.rotation * X_CB.rotation,
                state.a + turn.rotation * (X_CB.translation - state.a)};
}

// Views that were reached from both sides tell the backlash.
void SetApproaches(const std::vector<AxisView>& views, AxisFit& fit) {
  std::size_t rising = 0, falling = 0;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (fit.views[i].used && views[i].approach)
      ++(*views[i].approach == Approach::kRising ? rising : falling);
  fit.fits_backlash = rising >= 2 && falling >= 2;
  fit.columns = fit.fits_backlash ? kParameters : kBacklash;
  if (!fit.fits_backlash) return;
  for (std::size_t i = 0; i < views.size(); ++i) {
    ModelView& view = fit.views[i].all;
    view.free_angle = !views[i].approach;
    if (views[i].approach) view.approach = *views[i].approach == Approach::kRising ? -1.0 : 1.0;
  }
}

std::vector<FitView*> Used(AxisFit& fit) {
  std::vector<FitView*> used;
  for (FitView& view : fit.views)
    if (view.used) used.push_back(&view);
  return used;
}

void Keep(FitView& view) {
  view.kept = view.all;
  view.kept.points.clear();
  for (std::size_t i = 0; i < view.all.points.size(); ++i)
    if (view.fits[i]) view.kept.points.push_back(view.all.points[i]);
}

// Solves with what is kept, and takes the sums and the noise there.
Status Solve(const CameraModel& camera, double angle_noise, AxisFit& fit) {
  std::vector<ModelView> kept;
  fit.state.deviations.clear();
  const auto used = Used(fit);
  for (FitView* view : used) {
    Keep(*view);
    kept.push_back(view->kept);
    fit.state.deviations.push_back(view->deviation);
  }
  const Status status = FitTurning(camera, kept, angle_noise, fit.fits_backlash, fit.state);
  if (!status) return status;
  fit.sums.assign(used.size(), {});
  for (std::size_t i = 0; i < used.size(); ++i) {
    const double deviation = used[i]->deviation = fit.state.deviations[i];
    const ViewLinearization linear = Linearize(fit.state, camera, kept[i], deviation);
    const Eigen::VectorXd& z = linear.by_deviation;
    const Eigen::VectorXd y = linear.residuals - deviation * z;
    const Eigen::MatrixXd x = linear.by_step.leftCols(fit.columns);
    ViewSums& sums = fit.sums[i];
    sums = {x.transpose() * x, x.transpose() * z, x.transpose() * y,          z.squaredNorm(),
            z.dot(y),          y.squaredNorm(),   static_cast<int>(y.size()), kept[i].free_angle};
    used[i]->free_deviation = -sums.zy / sums.zz;
    used[i]->free_sigma = 1.0 / std::sqrt(sums.zz);
  }
  fit.noise = EstimateNoise(fit.sums, fit.fits_backlash ? 3 : 2, kLeastSigmaPx);
  for (FitView* view : used) view->free_sigma *= fit.noise.corner;
  return {};
}

// The median of what the points of a view say of its deviation, weighted by how far they move with
// it: points that lie off do not draw it away from the good ones.
double RobustDeviation(const TurningState& state, const CameraModel& camera, const FitView& view) {
  const ViewLinearization linear = Linearize(state, camera, view.all, view.deviation);
  std::vector<std::pair<double, double>> says;  // deviation, weight
  double half = 0.0;
  for (Eigen::Index i = 0; i + 1 < linear.residuals.size(); i += 2) {
    const Eigen::Vector2d z = linear.by_deviation.segment<2>(i);
    if (!(z.squaredNorm() > 0.0)) continue;
    says.emplace_back(-z.dot(linear.residuals.segment<2>(i)) / z.squaredNorm(), z.norm());
    half += 0.5 * z.norm();
  }
  std::sort(says.begin(), says.end());
  for (const auto& [deviation, weight] : says)
    if ((half -= weight) <= 0.0) return view.deviation + deviation;
  return view.deviation;
}

// Which points fit, all of the used views being judged by one sigma. Whether any changed.
bool SiftPoints(const CameraModel& camera, AxisFit& fit) {
  std::vector<double> sizes;
  std::vector<std::vector<double>> of_view;
  const auto used = Used(fit);
  for (FitView* view : used) {
    const double deviation = RobustDeviation(fit.state, camera, *view);
    const auto residuals = Residuals(fit.state, camera, view->all, deviation);
    std::vector<double>& of = of_view.emplace_back();
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      const double size = residuals[i].norm() / view->all.points[i].spread;
      of.push_back(std::isfinite(size) ? size : HUGE_VAL);
    }
    sizes.insert(sizes.end(), of.begin(), of.end());
  }
  const double sigma = std::max(Median(sizes) / kMedianOfRayleigh, kLeastSigmaPx);
  bool changed = false;
  for (std::size_t i = 0; i < used.size(); ++i) {
    std::vector<bool> fits;
    for (const double size : of_view[i]) fits.push_back(size <= kOutlierSigmas * sigma);
    changed = changed || fits != used[i]->fits;
    used[i]->fits = std::move(fits);
    const auto good =
        static_cast<std::size_t>(std::count(used[i]->fits.begin(), used[i]->fits.end(), true));
    if (2 * good > used[i]->fits.size() && good >= kFewestPoints) continue;
    used[i]->used = false;
    std::vector<double> of = of_view[i];
    used[i]->why_not = "most of its points do not fit the other views (they are " +
                       NumberText(Median(of), 2) + " px off; sigma is " + NumberText(sigma, 2) +
                       " px)";
  }
  return changed;
}

// Leaves out the view whose angle is furthest off, if it is off beyond doubt. Whether there is one.
bool SiftAngles(AxisFit& fit) {
  std::vector<double> sizes;
  const auto used = Used(fit);
  for (const FitView* view : used)
    if (!view->all.free_angle) sizes.push_back(std::abs(view->free_deviation));
  if (sizes.size() < kFewestForMedian) return false;
  const double spread = Median(sizes) / kMedianOfNormal;
  FitView* worst = nullptr;
  double most = kOutlierSigmas;
  for (FitView* view : used) {
    const double ratio = std::abs(view->free_deviation) / std::hypot(spread, view->free_sigma);
    if (view->all.free_angle || !(ratio > most)) continue;
    most = ratio;
    worst = view;
  }
  if (worst == nullptr) return false;
  worst->used = false;
  worst->why_not = "the board stands " + NumberText(RadToDeg(std::abs(worst->free_deviation)), 3) +
                   " degrees away from where the others and its angle put it (" +
                   NumberText(most, 2) + " sigmas)";
  return true;
}

Status Sift(const CameraModel& camera, const std::vector<AxisView>& views, AxisFit& fit) {
  double angle_noise = kFirstAngleNoise;
  for (int round = 0; round < kMostRounds; ++round) {
    std::vector<double> angles;
    for (std::size_t i = 0; i < views.size(); ++i)
      if (fit.views[i].used) angles.push_back(views[i].angle_deg);
    if (const Status status = CheckEnough(angles, views.size(), fit.fits_backlash); !status)
      return status;
    if (const Status status = Solve(camera, angle_noise, fit); !status) return status;
    const double next = std::max(fit.noise.angle, 1e-9) / fit.noise.corner;
    const bool settled = std::abs(next - angle_noise) <= kSettled * angle_noise;
    angle_noise = next;
    const bool changed = SiftPoints(camera, fit);
    if (changed) continue;
    if (settled && !SiftAngles(fit)) return {};
  }
  return Solve(camera, angle_noise, fit);
}

// -2 log likelihood but for constants: how well corners and angles fit, of as many of them.
double Misfit(const AxisFit& fit, int corners, int angles) {
  return 2.0 * (corners * std::log(fit.noise.corner) +
                angles * std::log(std::max(fit.noise.angle, kLeastAngle)));
}

// Two candidates that led to one fit.
bool IsSame(const AxisFit& a, const AxisFit& b) {
  return (a.state.u - b.state.u).norm() < kSameDirection &&
         std::abs(a.state.scale - b.state.scale) < kSameScale;
}

// The best of what the candidates led to.
Result<AxisFit> BestOf(std::vector<Result<AxisFit>> fits, std::size_t sides) {
  const Error first_error = fits.front() ? Error() : fits.front().error();
  std::erase_if(fits, [](const Result<AxisFit>& fit) { return !fit; });
  if (fits.empty()) return tl::unexpected(first_error);
  std::size_t most = 0;
  for (Result<AxisFit>& fit : fits) most = std::max(most, Used(*fit).size());
  std::erase_if(fits, [most](Result<AxisFit>& fit) { return 4 * Used(*fit).size() < 3 * most; });
  int corners = fits.front()->noise.corner_freedom, angles = fits.front()->noise.angle_freedom;
  for (const Result<AxisFit>& fit : fits) {
    corners = std::min(corners, fit->noise.corner_freedom);
    angles = std::min(angles, fit->noise.angle_freedom);
  }
  std::stable_sort(fits.begin(), fits.end(), [&](const auto& a, const auto& b) {
    return Misfit(*a, corners, angles) < Misfit(*b, corners, angles);
  });
  for (const Result<AxisFit>& other : fits)
    if (!IsSame(*fits.front(), *other) &&
        Misfit(*other, corners, angles) < Misfit(*fits.front(), corners, angles) + kDecisive)
      return NoEstimateError(
          "the views fit another axis, or the board turning the other way, as well: it looks the "
          "same from " +
          std::to_string(sides) + (sides == 1 ? " side" : " sides") +
          "; take views at angles that are no multiples of " +
          NumberText(180.0 / static_cast<double>(sides)) +
          " degrees apart, of a larger board, nearer to the camera");
  return std::move(fits.front());
}

}  // namespace

Result<AxisFit> FitAxis(const board::Board& board, const CameraModel& camera,
                        const std::vector<AxisView>& views) {
  AxisFit begin;
  begin.views.resize(views.size());
  const Guesses guesses = GuessAll(board, camera, views, begin.views);
  std::vector<double> angles;
  for (const std::size_t view : guesses.of) angles.push_back(views[view].angle_deg);
  if (const Status status = CheckEnough(angles, views.size(), false); !status)
    return Forward(status);
  const std::vector<Pose> turns = SameLookingTurns(board);
  const auto turnings = FindTurning(guesses.views, turns);
  if (!turnings) return Forward(turnings);
  std::vector<Result<AxisFit>> fits;
  for (const TurningBoard& turning : *turnings) {
    AxisFit fit = begin;
    Place(board, views, guesses, turns, turning, fit);
    SetApproaches(views, fit);
    const Status status = Sift(camera, views, fit);
    fits.push_back(status ? Result<AxisFit>(std::move(fit)) : Forward(status));
  }
  return BestOf(std::move(fits), turns.size());
}

}  // namespace turnlight::calib::calibrate::axis
