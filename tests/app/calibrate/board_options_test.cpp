// Proves: the options of a board reach ParseBoard's words.
#include "app/calibrate/board_options.h"

#include <gtest/gtest.h>

namespace turnlight::app {
namespace {

TEST(BoardOptions, FillTheWords) {
  CLI::App command;
  calib::calibrate::board::BoardWords words;
  AddBoardOptions(command, words);
  command.parse("--board 8x5 --square-mm 22 --charuco 5X5_100 --marker-mm 16.5");
  const auto board = ParseBoard(words);
  ASSERT_TRUE(board) << board.error().text;
  EXPECT_EQ(board->columns, 8);
  EXPECT_EQ(board->spacing, 22.0);
  EXPECT_EQ(board->marker, 16.5);
  EXPECT_EQ(board->dictionary, "5X5_100");
}

TEST(BoardOptions, AreRequiredUnlessSaidOtherwise) {
  calib::calibrate::board::BoardWords words;
  CLI::App needs, may;
  AddBoardOptions(needs, words);
  AddBoardOptions(may, words, false);
  EXPECT_THROW(needs.parse("--board 8x5"), CLI::RequiredError);
  EXPECT_NO_THROW(may.parse(""));
}

}  // namespace
}  // namespace turnlight::app
