// From corners to half a pixel to corners to some hundredths.
#pragma once

#include <opencv2/core.hpp>

#include "calib/calibrate/board/corner_lattice.h"

namespace turnlight::calib::calibrate::board {

// Moves a corner of four squares to where the levels' gradients cross (cv::cornerSubPix), looking
// no further than `reach` pixels, the distance to the next edge that does not meet it. Nothing
// where it is led further away than a third of that. picture: CV_32F.
std::optional<Eigen::Vector2d> RefineCorner(const cv::Mat& picture, const Eigen::Vector2d& corner,
                                            double reach);

// All corners of a lattice; drops those that are led away.
void RefineCorners(const cv::Mat& picture, CornerLattice& lattice);

// Does each point lie where a plane under a lens has it: a homography, and a polynomial of the
// third or fourth degree on top for the lens, fitted robustly? places: on the board, any unit.
// step: pixels between neighbouring points; a paper's waves are a few hundredths of it, and no
// fault.
std::vector<bool> Regular(const std::vector<Eigen::Vector2d>& places,
                          const std::vector<Eigen::Vector2d>& pixels, double step);

// Drops corners that are not regular.
void DropOutliers(CornerLattice& lattice);

// Pixels between a corner and the nearest edge that does not meet it, by its neighbours. 0 where it
// has none in a row or none in a column.
double FreeReach(const CornerLattice& lattice, int column, int row);

}  // namespace turnlight::calib::calibrate::board
