// Which board is in the pictures, as options of a command: --board, --square-mm and, of boards with
// markers, --markers and --marker-mm.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "base/result.h"
#include "calib/calibrate/board/board.h"

namespace turnlight::app {

struct BoardArguments {
  std::string size;  // COLSxROWS
  double square_mm = 0.0, marker_mm = 0.0;
  std::string markers = "none";
  std::string dictionary;
};

void AddBoardOptions(CLI::App& command, BoardArguments& arguments);
// Lengths in mm. Fails (kInput) with option, value and what is allowed.
Result<calib::calibrate::board::Board> BoardOf(const BoardArguments& arguments);

}  // namespace turnlight::app
