// What a start is looked for on, and how well it is explained.
#pragma once

#include "base/stop_flag.h"
#include "estimator/model/model_choice.h"
#include "estimator/observe/observations.h"

namespace turnlight::estimator::start {

// What a start is looked for on.
struct Sample {
  observe::Observations pixels;
  double noise = 0.0;  // sigma of a value
  model::ModelChoice choice;
  const StopFlag* stop = nullptr;  // set: every fit ends at its next iteration
};

// How many values, pixels times channels, a sample has.
double ValuesIn(const observe::Observations& pixels);

// What of a residual variance is above noise^2, with a floor that stands for what the model cannot
// describe anyway and for what the noise's estimate is off.
double ExcessVariance(double mean_square, double noise);

// Whether an excess variance is no more than its floor and the statistical uncertainty of the
// noise: no other model can explain more.
bool NothingLeft(double excess, const Sample& sample);

}  // namespace turnlight::estimator::start
