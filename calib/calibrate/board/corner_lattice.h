// Corners of a chessboard in a picture, in rows and columns.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace turnlight::calib::calibrate::board {

// Corner (column, row) is at corners[row * columns + column], or was not found. Turning from the
// direction of a row to that of a column is turning from x to y in the picture.
struct CornerLattice {
  int columns = 0;
  int rows = 0;
  std::vector<std::optional<Eigen::Vector2d>> corners;
  bool begins_dark = true;  // the square before corner (0, 0), or where it would be

  std::size_t Index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  bool Has(int column, int row) const {
    return column >= 0 && row >= 0 && column < columns && row < rows &&
           corners[Index(column, row)].has_value();
  }
  const Eigen::Vector2d& At(int column, int row) const { return *corners[Index(column, row)]; }
  std::size_t Count() const;
};

// The lattice turned by quarter turns in its plane (the picture stays): columns become rows.
CornerLattice Turned(const CornerLattice& lattice, int quarters);

// Without the outer columns and rows where nothing is.
CornerLattice Trimmed(const CornerLattice& lattice);

}  // namespace turnlight::calib::calibrate::board
