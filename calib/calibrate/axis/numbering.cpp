#include "calib/calibrate/axis/numbering.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/angles.h"
#include "base/format.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::axis {
namespace {

// The board is seen to the degree; symmetric boards differ by 90.
constexpr double kOff = DegToRad(15.0);
// Of a table's scale before it is known, and of the guessed poses.
constexpr double kScaleTolerance = 0.15;
constexpr double kAngleTolerance = DegToRad(4.0);
// Two views this far apart, or as near to a whole turn, tell no axis.
constexpr double kSmallestTurn = DegToRad(0.5);
constexpr std::size_t kMostSeedViews = 40;
// Axes nearer to each other than this lead to the same fit.
const double kSameAxis = std::cos(DegToRad(5.0));
constexpr std::size_t kMostCandidates = 6;

double Wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

Eigen::Matrix3d SeenRotation(const TurningView& view, const std::vector<Pose>& turns,
                             std::size_t turn, std::size_t tilt) {
  return view.X_CB[tilt].rotation * turns[turn].rotation;
}

// The angle about u of the rotation about u that is nearest to this one.
double TwistAngle(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& u) {
  const Eigen::Quaterniond q(rotation);
  return Wrapped(2.0 * std::atan2(q.vec().dot(u), q.w()));
}

struct Walk {
  double cost = 0.0;
  TurningBoard board;
};

// What a view shows if the board turned about u, and was expected to have turned by so much.
TurningBoard::Choice Choose(const TurningView& view, const std::vector<Pose>& turns,
                            const Eigen::Matrix3d& R_CB, const Eigen::Vector3d& u,
                            double expected) {
  TurningBoard::Choice best;
  best.turned = expected;
  double least = kOff;
  for (std::size_t turn = 0; turn < turns.size(); ++turn)
    for (std::size_t tilt = 0; tilt < view.X_CB.size(); ++tilt) {
      const Eigen::Matrix3d turned = SeenRotation(view, turns, turn, tilt) * R_CB.transpose();
      const double off = Eigen::AngleAxisd(turned * Turn(u, -expected).rotation).angle();
      best.off_deg = best.off_deg == 0.0 ? RadToDeg(off) : std::min(best.off_deg, RadToDeg(off));
      if (!(off < least)) continue;
      least = off;
      best = {turn, tilt, expected + Wrapped(TwistAngle(turned, u) - expected), RadToDeg(off),
              true};
    }
  return best;
}

// The slope of the line through turned against reported angles.
double ScaleOf(const std::vector<TurningView>& views, const TurningBoard& board) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!board.choices[i].fits) continue;
    const double angle = DegToRad(views[i].angle_deg), turned = board.choices[i].turned;
    n += 1.0;
    x += angle;
    y += turned;
    xx += angle * angle;
    xy += angle * turned;
  }
  const double spread = n * xx - x * x;
  return spread > 0.0 ? (n * xy - x * y) / spread : 1.0;
}

// From the reference view to its neighbours and on, so that an error of the scale does not add up.
Walk WalkViews(const std::vector<TurningView>& views, const std::vector<Pose>& turns,
               const std::vector<std::size_t>& order, std::size_t reference,
               std::size_t reference_tilt, const Eigen::Vector3d& u) {
  Walk walk;
  walk.board.direction_C = u;
  walk.board.reference = reference;
  walk.board.choices.resize(views.size());
  const Eigen::Matrix3d R_CB = views[reference].X_CB[reference_tilt].rotation;
  walk.board.choices[reference] = {0, reference_tilt, 0.0, 0.0, true};
  const auto at = std::find(order.begin(), order.end(), reference);
  const auto visit = [&](std::size_t from, std::size_t to) {
    const double expected =
        walk.board.choices[from].turned + DegToRad(views[to].angle_deg - views[from].angle_deg);
    walk.board.choices[to] = Choose(views[to], turns, R_CB, u, expected);
    const double off =
        walk.board.choices[to].fits ? DegToRad(walk.board.choices[to].off_deg) : kOff;
    walk.cost += off * off;
  };
  for (auto to = at + 1; to != order.end(); ++to) visit(*(to - 1), *to);
  for (auto to = at; to != order.begin(); --to) visit(*to, *(to - 1));
  TurningBoard& board = walk.board;
  board.scale = ScaleOf(views, board);
  if (board.scale > 0.0) return walk;
  // The same turning, told about the opposite direction.
  board.scale = -board.scale;
  board.direction_C = -u;
  for (TurningBoard::Choice& choice : board.choices) choice.turned = -choice.turned;
  return walk;
}

struct Seed {
  Eigen::Vector3d u;
  std::size_t reference_tilt = 0;
};

// The axis of the rotation between the reference and another view, wherever its angle is what the
// table says.
void AddSeeds(const std::vector<TurningView>& views, const std::vector<Pose>& turns,
              std::size_t reference, std::size_t other, std::vector<Seed>& seeds) {
  const double planned = DegToRad(views[other].angle_deg - views[reference].angle_deg);
  const double wrapped = Wrapped(planned);
  const double tolerance = kAngleTolerance + kScaleTolerance * std::min(std::abs(planned), 1.0);
  for (std::size_t from = 0; from < views[reference].X_CB.size(); ++from)
    for (std::size_t turn = 0; turn < turns.size(); ++turn)
      for (std::size_t tilt = 0; tilt < views[other].X_CB.size(); ++tilt) {
        const Eigen::AngleAxisd turned(SeenRotation(views[other], turns, turn, tilt) *
                                       views[reference].X_CB[from].rotation.transpose());
        if (std::abs(turned.angle() - std::abs(wrapped)) > tolerance) continue;
        seeds.push_back({wrapped < 0.0 ? (-turned.axis()).eval() : turned.axis(), from});
        // Near half a turn either direction may be meant.
        if (std::abs(wrapped) > std::numbers::pi - tolerance)
          seeds.push_back({-seeds.back().u, from});
      }
}

std::vector<Seed> SeedsOf(const std::vector<TurningView>& views, const std::vector<Pose>& turns,
                          std::size_t reference) {
  std::vector<std::size_t> others(views.size());
  std::iota(others.begin(), others.end(), std::size_t{0});
  const auto tells = [&](std::size_t view) {
    return std::abs(std::sin(0.5 * DegToRad(views[view].angle_deg - views[reference].angle_deg)));
  };
  std::erase_if(others, [&](std::size_t view) { return tells(view) < 0.5 * kSmallestTurn; });
  std::stable_sort(others.begin(), others.end(),
                   [&](std::size_t a, std::size_t b) { return tells(a) > tells(b); });
  if (others.size() > kMostSeedViews) others.resize(kMostSeedViews);
  std::vector<Seed> seeds;
  for (const std::size_t other : others) AddSeeds(views, turns, reference, other, seeds);
  return seeds;
}

std::size_t Fitting(const TurningBoard& board) {
  return static_cast<std::size_t>(std::count_if(board.choices.begin(), board.choices.end(),
                                                [](const auto& choice) { return choice.fits; }));
}

// Of the walks about one axis the best.
void Keep(Walk walk, std::vector<Walk>& walks) {
  const auto same = std::find_if(walks.begin(), walks.end(), [&walk](const Walk& other) {
    return walk.board.direction_C.dot(other.board.direction_C) > kSameAxis;
  });
  if (same == walks.end())
    walks.push_back(std::move(walk));
  else if (walk.cost < same->cost)
    *same = std::move(walk);
}

tl::unexpected<Error> NoTurning(std::size_t fitting, std::size_t views) {
  return NoEstimateError(
      "the views do not show one board that turns about one axis by the angles that the table "
      "reports: at best " +
      std::to_string(fitting) + " of " + std::to_string(views) +
      " do, allowed is more than half. Did the board or the camera move, are the pictures in the "
      "order of their angles, is it this board and this lens?");
}

}  // namespace

Result<std::vector<TurningBoard>> FindTurning(const std::vector<TurningView>& views,
                                              const std::vector<Pose>& turns) {
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&views](std::size_t a, std::size_t b) {
    return views[a].angle_deg < views[b].angle_deg;
  });
  std::vector<Walk> walks;
  // A view that is wrong itself must not be what all others are judged by.
  for (const std::size_t place : {order.size() / 2, std::size_t{0}, order.size() - 1})
    for (const Seed& seed : SeedsOf(views, turns, order[place]))
      Keep(WalkViews(views, turns, order, order[place], seed.reference_tilt, seed.u), walks);
  std::stable_sort(walks.begin(), walks.end(),
                   [](const Walk& a, const Walk& b) { return a.cost < b.cost; });
  std::vector<TurningBoard> boards;
  std::size_t most = 0;
  for (Walk& walk : walks) {
    const std::size_t fitting = Fitting(walk.board);
    most = std::max(most, fitting);
    if (2 * fitting <= views.size() || fitting < 2 || boards.size() == kMostCandidates) continue;
    boards.push_back(std::move(walk.board));
  }
  if (boards.empty()) return NoTurning(most, views.size());
  return boards;
}

}  // namespace turnlight::calib::calibrate::axis
