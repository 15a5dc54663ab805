#include "app/calibrate/board_options.h"

#include "base/format.h"
#include "calib/calibrate/board/marker_dictionary.h"

namespace turnlight::app {

void AddBoardOptions(CLI::App& command, calib::calibrate::board::BoardWords& words,
                     bool required) {
  const std::string group = "The board";
  command
      .add_option("--board", words.size,
                  "COLSxROWS: the board's inner corners across and down (of a grid: its tags)")
      ->required(required)
      ->group(group);
  command
      .add_option("--square-mm", words.square_mm,
                  "Distance between neighbouring corners (of a grid: from tag to tag)")
      ->required(required)
      ->group(group);
  command
      .add_option("--charuco", words.charuco,
                  "It is a ChArUco board with markers of this dictionary: " +
                      Listed(calib::calibrate::board::MarkerDictionaryNames()))
      ->group(group);
  command
      .add_option("--apriltag", words.apriltag,
                  "It is a grid of tags of this dictionary, such as APRILTAG_36h11")
      ->group(group);
  command
      .add_option("--marker-mm", words.marker_mm, "Side of its markers, with their dark border")
      ->group(group);
}

}  // namespace turnlight::app
