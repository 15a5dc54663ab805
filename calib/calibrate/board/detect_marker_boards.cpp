#include "calib/calibrate/board/detect_marker_boards.h"

#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <optional>

#include "base/format.h"
#include "calib/calibrate/board/homography.h"
#include "calib/calibrate/board/marker_dictionary.h"
#include "calib/calibrate/board/marker_layout.h"
#include "calib/calibrate/board/refine_corners.h"
#include "calib/calibrate/board/refine_quad.h"
#include "calib/calibrate/board/saddle_points.h"
#include "calib/calibrate/board/view_quality.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr std::size_t kLeastPoints = 8;  // a pose of fewer is anyone's guess
constexpr double kLook = 0.75;           // of the distance to the next foreign edge
constexpr std::size_t kNearest = 6;      // markers from which a ChArUco corner is expected

std::vector<SeenMarker> FindMarkers(const cv::Mat& bytes, const Board& board, int border_bits) {
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border_bits;
  parameters->adaptiveThreshWinSizeMax = 53;  // large markers, too
  parameters->minMarkerPerimeterRate = 0.01;  // of the picture's longer side
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  try {
    cv::aruco::detectMarkers(bytes, *FindMarkerDictionary(board.dictionary), corners, ids,
                             parameters);
  } catch (const std::exception&) {
    return {};  // what it cannot take is a picture in which it finds nothing
  }
  std::vector<SeenMarker> seen(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    seen[i].id = ids[i];
    for (std::size_t k = 0; k < 4; ++k) seen[i].corners[k] = {corners[i][k].x, corners[i][k].y};
  }
  // OpenCV's threads decide the order in which it finds them.
  std::sort(seen.begin(), seen.end(), [](const SeenMarker& a, const SeenMarker& b) {
    return std::tuple(a.id, a.corners[0].x(), a.corners[0].y()) <
           std::tuple(b.id, b.corners[0].x(), b.corners[0].y());
  });
  return seen;
}

struct Fit {
  MarkerLayout layout;
  std::vector<SeenMarker> markers;
};

// The layout that most markers fit, and those; they are taken out of seen.
std::optional<Fit> TakeBoard(std::vector<SeenMarker>& seen, const Board& board) {
  std::vector<std::size_t> best;
  Fit fit;
  for (const MarkerLayout& layout : MarkerLayouts(board)) {
    auto chosen = FittingMarkers(seen, MarkerPlaces(board, layout));
    if (chosen.size() <= best.size()) continue;
    best = std::move(chosen);
    fit.layout = layout;
  }
  if (best.empty()) return std::nullopt;
  std::sort(best.begin(), best.end());
  for (std::size_t i = best.size(); i-- > 0;) {  // the last first, so that places stay
    fit.markers.push_back(seen[best[i]]);
    seen.erase(seen.begin() + static_cast<std::ptrdiff_t>(best[i]));
  }
  return fit;
}

// From B to the picture, by the markers nearest to a place.
std::optional<Eigen::Matrix3d> MapAround(const Eigen::Vector2d& place, const Fit& fit,
                                         const std::map<int, Quad>& places) {
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t i = 0; i < fit.markers.size(); ++i)
    nearest.emplace_back((places.at(fit.markers[i].id)[0] - place).norm(), i);
  std::sort(nearest.begin(), nearest.end());
  nearest.resize(std::min(nearest.size(), kNearest));
  std::vector<Eigen::Vector2d> from, to;
  for (const auto& [distance, i] : nearest) {
    const Quad& quad = places.at(fit.markers[i].id);
    from.insert(from.end(), quad.begin(), quad.end());
    to.insert(to.end(), fit.markers[i].corners.begin(), fit.markers[i].corners.end());
  }
  return FitHomography(from, to);
}

// Is a marker next to the corner, so that the corner is not hidden?
bool IsBesideMarker(const Eigen::Vector2d& place, const Board& board, const Fit& fit,
                    const std::map<int, Quad>& places) {
  return std::any_of(fit.markers.begin(), fit.markers.end(), [&](const SeenMarker& marker) {
    const Quad& quad = places.at(marker.id);
    const Eigen::Vector2d centre = (quad[0] + quad[2]) / 2.0;
    return (centre - place).cwiseAbs().maxCoeff() < 0.75 * board.spacing;
  });
}

CornerLattice CharucoCorners(const cv::Mat& levelled, const Board& board, const Fit& fit) {
  const auto places = MarkerPlaces(board, fit.layout);
  const double margin = (board.spacing - board.marker) / 2.0;
  CornerLattice lattice{board.columns, board.rows, {}, fit.layout.begins_dark};
  for (const Eigen::Vector3d& point : BoardPoints(board)) {
    lattice.corners.emplace_back();
    const Eigen::Vector2d place = point.head<2>();
    if (!IsBesideMarker(place, board, fit, places)) continue;
    const auto homography = MapAround(place, fit, places);
    if (!homography) continue;
    const Eigen::Vector2d expected = Map(*homography, place);
    // The nearest foreign edges are the markers' corners, on the diagonals.
    double reach = std::numeric_limits<double>::infinity();
    for (const double x : {-margin, margin})
      for (const double y : {-margin, margin})
        reach =
            std::min(reach, (Map(*homography, place + Eigen::Vector2d(x, y)) - expected).norm());
    if (!std::isfinite(reach)) continue;
    const auto refined = RefineCorner(levelled, expected, reach);
    // Something in front of it would make it look otherwise.
    if (refined && SaddleAt(levelled, *refined, kLook * reach)) lattice.corners.back() = refined;
  }
  DropOutliers(lattice);
  return lattice;
}

DetectedBoard CharucoFrom(const cv::Mat& levelled, const Board& board, const Fit& fit) {
  const CornerLattice lattice = CharucoCorners(levelled, board, fit);
  DetectedBoard found;
  const double rim = (board.spacing - board.marker) / 2.0 / board.spacing;
  found.edge_sigma = EdgeSigma(levelled, EdgesOf(lattice, 0.7 * rim));
  for (std::size_t i = 0; i < lattice.corners.size(); ++i)
    if (lattice.corners[i])
      found.view.points.push_back({i, *lattice.corners[i], SpreadOf(found.edge_sigma)});
  return found;
}

DetectedBoard TagGridFrom(const cv::Mat& levelled, const Board& board, const Fit& fit) {
  const auto places = MarkerPlaces(board, fit.layout);
  const auto dictionary = FindMarkerDictionary(board.dictionary);
  // Levels are even as far as a tag's border, and as the gap between tags.
  const double even = std::min(board.marker / ((*dictionary)->markerSize + 2.0),
                               (board.spacing - board.marker) / 2.0) /
                      board.marker;
  const auto points = BoardPoints(board);
  std::vector<PrintEdge> edges;
  double shortest = std::numeric_limits<double>::infinity();  // side of a tag
  std::vector<SeenPoint> seen;
  std::vector<Eigen::Vector2d> on_board, pixels;
  for (const SeenMarker& marker : fit.markers) {
    double side = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 4; ++k)
      side = std::min(side, (marker.corners[k] - marker.corners[(k + 1) % 4]).norm());
    shortest = std::min(shortest, side);
    const auto refined =
        RefineQuad(levelled, marker.corners, std::clamp(0.5 * even * side, 1.5, 4.0));
    if (!refined) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      edges.push_back({(*refined)[k], (*refined)[(k + 1) % 4], 0.8 * even * side});
      const Eigen::Vector2d place = places.at(marker.id)[k];
      const auto number = std::min_element(points.begin(), points.end(), [&](auto& a, auto& b) {
        return (a.template head<2>() - place).norm() < (b.template head<2>() - place).norm();
      });
      seen.push_back({static_cast<std::size_t>(number - points.begin()), (*refined)[k], 1.0});
      on_board.push_back(place);
      pixels.push_back((*refined)[k]);
    }
  }
  DetectedBoard found;
  found.edge_sigma = EdgeSigma(levelled, edges);
  const auto regular = Regular(on_board, pixels, shortest);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    seen[i].spread = SpreadOf(found.edge_sigma);
    if (regular[i]) found.view.points.push_back(seen[i]);
  }
  std::sort(found.view.points.begin(), found.view.points.end(),
            [](const SeenPoint& a, const SeenPoint& b) { return a.point < b.point; });
  return found;
}

// What the markers say when they make no board.
std::vector<std::string> WhyNone(const cv::Mat& bytes, const Board& board,
                                 const std::vector<SeenMarker>& left) {
  cv::Mat mirrored;
  cv::flip(bytes, mirrored, 1);
  auto markers = FindMarkers(mirrored, board, 1);
  if (TakeBoard(markers, board))
    return {
        "the board is printed mirrored, or the picture is: its markers can be read in a mirror "
        "only"};
  if (left.empty()) return {"no marker of dictionary " + board.dictionary + " is in sight"};
  const int highest =
      std::max_element(left.begin(), left.end(), [](auto& a, auto& b) { return a.id < b.id; })->id;
  return {
      Format("%zu markers are in sight, the highest number is %d, but not as a board of %d x %d "
             "has them",
             left.size(), highest, board.columns, board.rows)};
}

}  // namespace

Detection DetectMarkerBoards(const cv::Mat& picture, const cv::Mat& levelled, const Board& board) {
  cv::Mat bytes;
  levelled.convertTo(bytes, CV_8U);
  auto seen = FindMarkers(bytes, board, 1);
  if (seen.size() < 2 && board.kind == BoardKind::kAprilTagGrid)
    seen = FindMarkers(bytes, board, 2);  // as Kalibr prints them
  Detection detection;
  const auto all = seen;
  while (const auto fit = TakeBoard(seen, board)) {
    DetectedBoard found = board.kind == BoardKind::kCharuco ? CharucoFrom(levelled, board, *fit)
                                                            : TagGridFrom(levelled, board, *fit);
    if (found.view.points.size() < kLeastPoints) continue;
    found.saturated = SaturatedShare(picture, levelled, found.view);
    detection.boards.push_back(std::move(found));
  }
  if (detection.boards.empty()) detection.remarks = WhyNone(bytes, board, all);
  return detection;
}

}  // namespace turnlight::calib::calibrate::board
