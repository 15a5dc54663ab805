// A board that is not flat: where each of its points really is.
//
// mrcal bends a board by a parabola each way. Paper does more than that, and its points' errors,
// the same in every view, then bend the lens. Where many views show a board, the place of each
// point can be fitted along with all else; this is the one thing that mrcal's optimizer does not
// do, so that from its optimum on the steps (Gauss and Newton's) are our own, with its derivatives.
#pragma once

#include "calib/calibrate/lens/problem.h"

namespace turnlight::calib::calibrate::lens {

// Fits Problem::shape, from mrcal's optimum, with all that the pass fits. Outliers are judged anew.
// False, and the problem unchanged, where it cannot: fewer than 8 views, a point seen in fewer than
// 5, a grid of tags, or no descent.
bool FitShape(Problem& problem, const Pass& pass);

}  // namespace turnlight::calib::calibrate::lens
