#include "calib/calibrate/board/corner_lattice.h"

#include <algorithm>

namespace turnlight::calib::calibrate::board {

std::size_t CornerLattice::Count() const {
  return static_cast<std::size_t>(
      std::count_if(corners.begin(), corners.end(), [](const auto& c) { return c.has_value(); }));
}

CornerLattice Turned(const CornerLattice& lattice, int quarters) {
  CornerLattice turned = lattice;
  for (int turn = 0; turn < quarters; ++turn) {
    CornerLattice next;
    next.columns = turned.rows;
    next.rows = turned.columns;
    next.corners.resize(turned.corners.size());
    // The new row direction is the old column's; the new column direction the old row's, backwards.
    for (int row = 0; row < next.rows; ++row)
      for (int column = 0; column < next.columns; ++column)
        next.corners[next.Index(column, row)] =
            turned.corners[turned.Index(turned.columns - 1 - row, column)];
    next.begins_dark = turned.begins_dark == (turned.columns % 2 == 0);
    turned = std::move(next);
  }
  return turned;
}

CornerLattice Trimmed(const CornerLattice& lattice) {
  int left = lattice.columns, top = lattice.rows, right = -1, bottom = -1;
  for (int row = 0; row < lattice.rows; ++row)
    for (int column = 0; column < lattice.columns; ++column) {
      if (!lattice.Has(column, row)) continue;
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = std::max(bottom, row);
    }
  CornerLattice trimmed;
  if (right < 0) return trimmed;
  trimmed.columns = right - left + 1;
  trimmed.rows = bottom - top + 1;
  trimmed.begins_dark = lattice.begins_dark == ((left + top) % 2 == 0);
  for (int row = top; row <= bottom; ++row)
    for (int column = left; column <= right; ++column)
      trimmed.corners.push_back(lattice.corners[lattice.Index(column, row)]);
  return trimmed;
}

}  // namespace turnlight::calib::calibrate::board
