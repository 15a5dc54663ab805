// The board on a command line, the same for every command that looks for one.
#pragma once

#include <CLI/CLI.hpp>

#include "calib/calibrate/board/board_words.h"

namespace turnlight::app {

// --board COLSxROWS and --square-mm S; --charuco or --apriltag DICT with --marker-mm M. `words` must live until
// the command runs, which hands them to ParseBoard.
void AddBoardOptions(CLI::App& command, calib::calibrate::board::BoardWords& words,
                     bool required = true);

}  // namespace turnlight::app
