// Proves: what people write becomes the board they mean, and what cannot be is refused in the
// options' words.
#include "calib/calibrate/board/board_words.h"

#include <gmock/gmock.h>

namespace turnlight::calib::calibrate::board {
namespace {

using testing::HasSubstr;

TEST(ParseBoard, ReadsEachKind) {
  const auto chessboard = ParseBoard({"9x6", 25.0, {}, "", ""});
  ASSERT_TRUE(chessboard);
  EXPECT_EQ(BoardText(*chessboard), "a chessboard of 9 x 6 inner corners 25 mm apart");
  const auto charuco = ParseBoard({"8X5", 22.0, 16.0, "DICT_5X5_100", ""});
  ASSERT_TRUE(charuco);
  EXPECT_EQ(charuco->kind, BoardKind::kCharuco);
  const auto tags = ParseBoard({"6x6", 35.2, 27.0, "", "tag36h11"});
  ASSERT_TRUE(tags);
  EXPECT_EQ(tags->kind, BoardKind::kAprilTagGrid);
  EXPECT_THAT(BoardText(*tags), HasSubstr("6 x 6 tags 35.2 mm apart"));
}

TEST(ParseBoard, RefusesInTheOptionsWords) {
  const auto text = [](const BoardWords& words) {
    const auto board = ParseBoard(words);
    return board ? std::string() : board.error().text;
  };
  for (const char* size : {"", "9", "9x", "9by6", "9x6x3", "x6", "9 x 6", "99999999999x6"})
    EXPECT_THAT(text({size, 25.0, {}, "", ""}), HasSubstr("--board \"")) << size;
  EXPECT_THAT(text({"-9x6", 25.0, {}, "", ""}), HasSubstr("-9 x 6"));
  EXPECT_THAT(text({"9x6", {}, {}, "", ""}), HasSubstr("--square-mm"));
  EXPECT_THAT(text({"9x6", 0.0, {}, "", ""}), HasSubstr("above 0"));
  EXPECT_THAT(text({"9x6", 25.0, 10.0, "", ""}), HasSubstr("--charuco or --apriltag"));
  EXPECT_THAT(text({"9x6", 25.0, {}, "4X4_50", ""}), HasSubstr("--marker-mm"));
  EXPECT_THAT(text({"9x6", 25.0, 30.0, "4X4_50", ""}), HasSubstr("below"));
  EXPECT_THAT(text({"9x6", 25.0, 10.0, "9X9", ""}), HasSubstr("allowed: 4X4_50"));
  EXPECT_THAT(text({"9x6", 25.0, 10.0, "4X4_50", "tag36h11"}), HasSubstr("not both"));
}

TEST(ReadBoard, TakesTheMembersNames) {
  const auto read = [](const std::string& text) {
    const auto document = ParseYaml(text, "b.yaml");
    return ReadBoard(StrictObject(*document));
  };
  const auto plain = read("{columns: 9, rows: 6, spacing: 25}");
  ASSERT_TRUE(plain) << plain.error().text;
  EXPECT_EQ(BoardText(*plain), "a chessboard of 9 x 6 inner corners 25 mm apart");
  const auto charuco =
      read("{kind: charuco, columns: 8, rows: 5, spacing: 22, marker: 16, dictionary: 4X4_50}");
  ASSERT_TRUE(charuco) << charuco.error().text;
  EXPECT_EQ(charuco->marker, 16.0);
  EXPECT_THAT(read("{columns: 9, rows: 6}").error().text, HasSubstr("spacing"));
  EXPECT_THAT(read("{columns: 9, rows: 6, spacing: 25, marker: 3}").error().text,
              HasSubstr("marker"));
  EXPECT_THAT(read("{kind: charuco, columns: 8, rows: 5, spacing: 22, marker: 23, "
                   "dictionary: 4X4_50}")
                  .error()
                  .text,
              HasSubstr("b.yaml"));
}

}  // namespace
}  // namespace turnlight::calib::calibrate::board
