#include "calib/calibrate/handheld/board_plane.h"

#include "calib/calibrate/board/number_lattice.h"

namespace turnlight::calib::calibrate::handheld {
namespace {

// As known beforehand, of a corner that was found.
constexpr double kFoundSigmaPx = 0.1;
constexpr double kWorstFoundRmsPx = 1.0;

}  // namespace

BoardPlane PlaneOf(const board::Board& board) {
  BoardPlane plane;
  plane.places = BoardPoints(board);
  plane.X_WB = PoseInMiddle(board);
  const std::vector<Pose> turns = SameLookingTurns(board);
  plane.options.same_looking.assign(turns.begin() + 1, turns.end());
  plane.options.pixel_sigma = kFoundSigmaPx;
  plane.options.worst_rms_px = kWorstFoundRmsPx;
  return plane;
}

PlaneView ViewOf(const std::string& name, const board::Detection& detection,
                 const BoardPlane& plane) {
  PlaneView view;
  view.name = name;
  if (detection.boards.empty()) {
    view.why_none = detection.remarks.empty() ? "no board in it" : detection.remarks.front();
    return view;
  }
  for (const board::SeenPoint& point : detection.boards.front().view.points)
    view.points.push_back({plane.places[point.point].head<2>(), point.pixel, point.spread});
  return view;
}

}  // namespace turnlight::calib::calibrate::handheld
