#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/angles.h"
#include "base/format.h"
#include "calib/calibrate/axis/board_pose.h"
#include "calib/calibrate/board/number_lattice.h"
#include "calib/calibrate/drift/sights.h"

namespace turnlight::calib::calibrate::drift {
namespace {

constexpr std::size_t kFewestPoints = 6;
constexpr double kFarTurnDeg = 20.0;  // no drift, and no second tilt of a board, is taken for this

struct SeenBoard {
  std::size_t view = 0;
  std::vector<Pose> X_CB;  // tilts, the best first
};

// Of a view: which tilt, numbered from which corner, and the board's place on the table so.
struct Choice {
  std::size_t turn = 0;
  Pose X_AB;
  double turned_deg = 0.0;  // from the reference's
  double off = HUGE_VAL;    // length unit: how far its points are from the reference's, about
};

struct Candidate {
  std::vector<Choice> choices;  // of each seen board
  double off = HUGE_VAL;        // their sum
};

Choice NearestTo(const Pose& X_AB, const Pose& X_AC, const SeenBoard& seen,
                 const std::vector<Pose>& turns, const Eigen::Vector3d& middle_B, double size) {
  Choice best;
  for (const Pose& X_CB : seen.X_CB)
    for (std::size_t turn = 0; turn < turns.size(); ++turn) {
      Choice choice;
      choice.turn = turn;
      choice.X_AB = X_AC * X_CB * turns[turn];
      const double angle =
          Eigen::AngleAxisd(choice.X_AB.rotation * X_AB.rotation.transpose()).angle();
      choice.turned_deg = RadToDeg(angle);
      choice.off = (choice.X_AB * middle_B - X_AB * middle_B).norm() + size * angle;
      if (choice.off < best.off) best = choice;
    }
  return best;
}

// The reference and its tilt with which the others agree best.
Candidate BestCandidate(const std::vector<SeenBoard>& seen, const std::vector<Pose>& X_AC,
                        const board::Board& board) {
  const auto points = BoardPoints(board);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) middle += point / static_cast<double>(points.size());
  const double size = (points.back() - points.front()).norm();
  const std::vector<Pose> turns = SameLookingTurns(board);
  Candidate best;
  for (std::size_t r = 0; r < seen.size(); ++r)
    for (const Pose& X_CB : seen[r].X_CB) {
      const Pose X_AB = X_AC[r] * X_CB;
      Candidate candidate{{}, 0.0};
      for (std::size_t i = 0; i < seen.size(); ++i) {
        candidate.choices.push_back(NearestTo(X_AB, X_AC[i], seen[i], turns, middle, size));
        candidate.off += std::min(candidate.choices.back().off, size);
      }
      if (candidate.off < best.off) best = std::move(candidate);
    }
  return best;
}

std::vector<SeenBoard> SeeBoards(const rig::RigCalibration& calibration, const board::Board& board,
                                 const std::vector<axis::AxisView>& views,
                                 std::vector<std::string>& left_out) {
  std::vector<SeenBoard> seen;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::size_t points = views[i].board.points.size();
    std::string why_not;
    if (points == 0)
      why_not = "no board was found";
    else if (points < kFewestPoints)
      why_not = "only " + std::to_string(points) + " points of the board were found";
    else
      seen.push_back({i, axis::GuessBoardPoses(board, calibration.lens, views[i].board).X_CB});
    if (why_not.empty() && seen.back().X_CB.empty()) {
      why_not = "no pose of the board fits its points";
      seen.pop_back();
    }
    if (!why_not.empty())
      left_out.push_back(axis::ViewLabel(i, views[i].angle_deg) + ": " + why_not);
  }
  return seen;
}

// Measured points of all views, each with its spread.
struct BoardMeasured {
  std::vector<placement::PickedPoint> points;
  std::vector<double> spread;
};

void AddView(const board::Board& board, const axis::AxisView& view, std::size_t index,
             const Pose& turn, Sights& sights, BoardMeasured& measured) {
  const auto points = BoardPoints(board);
  const Pose back = turn.Inverse();
  const std::string label = axis::ViewLabel(index, view.angle_deg);
  for (const board::SeenPoint& seen : view.board.points) {
    measured.points.push_back({sights.views.size(), seen.pixel, back * points[seen.point], label});
    measured.spread.push_back(seen.spread);
  }
  sights.views.push_back({view.angle_deg, label, {}});
}

std::vector<placement::Residual> BoardResiduals(const BoardMeasured& measured,
                                                const rig::RigCalibration& rig,
                                                const std::vector<placement::View>& views) {
  placement::State state;
  state.X_AT = rig.geometry.X_AT;
  auto residuals = placement::PickedModel(rig, views, measured.points, 1.0)(state, 0.0);
  for (std::size_t i = 0; i < residuals.size(); ++i) residuals[i].sigma = measured.spread[i / 2];
  return residuals;
}

}  // namespace

Result<Sights> SightsOfBoard(const rig::RigCalibration& calibration, const board::Board& board,
                             const std::vector<axis::AxisView>& views) {
  Sights sights(calibration);
  sights.object_free = true;
  const auto seen = SeeBoards(calibration, board, views, sights.left_out);
  if (seen.empty())
    return InputError(sights.left_out.empty()
                          ? "no views, allowed are at least two of the board, at different angles"
                          : "no view shows the board (" + sights.left_out.front() +
                                "); allowed are at least two that do, at different angles");
  std::vector<Pose> X_AC;
  for (const SeenBoard& one : seen)
    X_AC.push_back(
        placement::PoseOfTableInCamera(calibration.geometry, views[one.view].angle_deg).Inverse());
  const Candidate best = BestCandidate(seen, X_AC, board);
  const std::vector<Pose> turns = SameLookingTurns(board);
  auto measured = std::make_shared<BoardMeasured>();
  bool first = true;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const axis::AxisView& view = views[seen[i].view];
    const Choice& choice = best.choices[i];
    if (choice.turned_deg > kFarTurnDeg) {
      sights.left_out.push_back(axis::ViewLabel(seen[i].view, view.angle_deg) +
                                ": the board is turned " + NumberText(choice.turned_deg, 3) +
                                " degrees away from where the others and its angle put it");
      continue;
    }
    if (first) sights.start.geometry.X_AT = choice.X_AB;
    first = false;
    AddView(board, view, seen[i].view, turns[choice.turn], sights, *measured);
  }
  sights.residuals = [measured](const rig::RigCalibration& rig,
                                const std::vector<placement::View>& at,
                                double) { return BoardResiduals(*measured, rig, at); };
  return sights;
}

}  // namespace turnlight::calib::calibrate::drift
