// Proves: in 25 real photographs (data beside the repository; skipped visibly where it is not
// there) the board of 7 x 7 inner corners is found whole in each, and what was left out is told.
// Does not prove how near the corners are to the truth, which nobody knows: the calibration's
// residuals speak of that.
#include <gmock/gmock.h>

#include <filesystem>

#include "base/file.h"
#include "calib/calibrate/board/detect_boards.h"
#include "rig/session/jpeg_file.h"
#include "tests/calib/calibrate/board/rendered_board.h"

namespace turnlight::calib::calibrate::board {
namespace {

TEST(RealBoards, EveryPhotographShowsAWholeBoard) {
  const std::filesystem::path folder = TURNLIGHT_SHARED_DATA "/chessboard";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << folder << " is not there: 25 photographs of a chessboard, image1.jpg and so on";
  const auto picture = [&](std::size_t i) -> Result<cv::Mat> {
    const std::string file = (folder / ("image" + std::to_string(i + 1) + ".jpg")).string();
    const auto bytes = ReadFile(file);
    if (!bytes) return Forward(bytes);
    const auto jpeg = rig::DecodeJpeg(*bytes, file);
    if (!jpeg) return Forward(jpeg);
    return jpeg->image;
  };
  const auto found = DetectInPictures(25, picture, Chessboard(7, 7));
  std::size_t all = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    SCOPED_TRACE("image" + std::to_string(i + 1));
    ASSERT_TRUE(found[i]) << found[i].error().text;
    ASSERT_GE(found[i]->boards.size(), 1u);
    const std::size_t points = found[i]->boards[0].view.points.size();
    EXPECT_GE(points, 48u);  // the paper waves: a corner may be taken for one that was led away
    all += points;
  }
  EXPECT_GE(all, 25u * 49u - 2u);
  // The second boards of these are cut off by the picture.
  for (const std::size_t i : {4, 22, 23})
    EXPECT_TRUE(found[i]->boards.size() == 2 || !found[i]->remarks.empty()) << i + 1;
}

}  // namespace
}  // namespace turnlight::calib::calibrate::board
