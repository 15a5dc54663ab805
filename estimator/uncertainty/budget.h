// The error budget: what a sigma_total is made of, item by item. For every reported quantity the
// squares of the items add up to the square of sigma_total.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimator/solve/normal_equations.h"

namespace turnlight::estimator::uncertainty {

// An item's stable name, such as "axis", what it is, and what makes it smaller: "expose longer".
struct BudgetWords {
  std::string item, words, advice;
};

// The items that every estimate may have.
const BudgetWords& NoiseWords();       // sigma_stat
const BudgetWords& HalvesWords();      // halves of the pictures that disagree
const BudgetWords& PixelsWords();      // what a pixel averages over
const BudgetWords& EdgesWords();       // of attached shadows
const BudgetWords& NormalsWords();     // of the target
const BudgetWords& SurfaceWords();     // roughness, texture
const BudgetWords& LightsWords();      // extent, another light, a distance that was left out
const BudgetWords& HighlightsWords();  // where they are in a photograph
const BudgetWords& DistanceWords();    // of a light in a photograph, that is not known
const BudgetWords& EarlierWords();     // of quantities whose sigma is that of an earlier fit

// How the fit answers to the errors of a calibration, on a sample of the pixels.
struct CalibrationResponse {
  solve::NormalEquations as_modelled;  // of the sample
  struct Item {
    BudgetWords words;
    // The change of the cost's gradient by the solver's columns, for one sigma along each of the
    // item's directions, in columns.
    Eigen::MatrixXd gradients;
  };
  std::vector<Item> items;
};

}  // namespace turnlight::estimator::uncertainty
