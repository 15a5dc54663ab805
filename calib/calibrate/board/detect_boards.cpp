#include "calib/calibrate/board/detect_boards.h"

#include <algorithm>
#include <optional>

#include "base/format.h"
#include "base/parallel.h"
#include "calib/calibrate/board/board_print.h"
#include "calib/calibrate/board/detect_chessboards.h"
#include "calib/calibrate/board/detect_marker_boards.h"
#include "calib/calibrate/board/picture_levels.h"

namespace turnlight::calib::calibrate::board {
namespace {

constexpr double kBlurred = 2.0;  // pixels, of an edge's sigma: it is 5 pixels wide from 10 to 90 %
constexpr double kSaturated = 0.25;  // of the bright pixels

void Remark(DetectedBoard& found, const Board& board) {
  const std::size_t points = found.view.points.size();
  if (points < board.PointCount())
    found.remarks.push_back(Format("%zu of %zu points seen", points, board.PointCount()));
  if (found.edge_sigma > kBlurred)
    found.remarks.push_back(
        Format("blurred: edges are %.1f pixels wide from 10 to 90 %%", 2.563 * found.edge_sigma));
  if (found.saturated > kSaturated)
    found.remarks.push_back(Format(
        "overexposed: %.0f %% of its bright pixels are at the sensor's limit, which moves edges",
        100.0 * found.saturated));
}

}  // namespace

Result<Detection> DetectBoards(const cv::Mat& picture, const Board& board) {
  if (const Status status = CheckBoard(board); !status) return Forward(status);
  if (const Status status = CheckPicture(picture); !status) return Forward(status);
  const cv::Mat levelled = Levelled(picture);
  Detection detection = board.kind == BoardKind::kChessboard
                            ? DetectChessboards(picture, levelled, board)
                            : DetectMarkerBoards(picture, levelled, board);
  for (DetectedBoard& found : detection.boards) Remark(found, board);
  if (detection.boards.empty()) {
    for (const std::string& level : RemarksOnLevels(picture))
      detection.remarks.push_back("no board found: " + level);
    if (detection.remarks.empty()) detection.remarks.push_back("no board found");
  }
  return detection;
}

std::vector<Result<Detection>> DetectInPictures(
    std::size_t count, const std::function<Result<cv::Mat>(std::size_t)>& picture,
    const Board& board, const std::function<void(std::size_t)>& done) {
  std::vector<std::optional<Result<Detection>>> found(count);
  ParallelFor(count, [&](std::size_t i) {
    const Result<cv::Mat> loaded = picture(i);
    found[i] = loaded ? DetectBoards(*loaded, board) : Result<Detection>(Forward(loaded));
    if (done) done(i);
  });
  std::vector<Result<Detection>> detections;
  for (auto& detection : found) detections.push_back(std::move(*detection));
  return detections;
}

}  // namespace turnlight::calib::calibrate::board
