// Where a solve starts, and which lights it starts with.
#pragma once

#include <vector>

#include "estimator/model_choice.h"
#include "estimator/observations.h"
#include "estimator/scene.h"
#include "estimator/shadows.h"

namespace turnlight::estimator {

// What a start is looked for on.
struct Sample {
  Observations pixels;
  double noise = 0.0;  // sigma of a value
  ModelChoice choice;
};

// Standard deviation of the pixels' noise, in radiance: the median absolute second difference along
// rows, which smooth shading hardly moves. An upper bound where texture or highlights rule.
double EstimateNoise(const Observations& observations);

// Per-channel median radiance, the paper's start for the diffuse colour (Wood et al., 2000).
Eigen::Vector3d MedianColour(const Observations& observations);

// K directions spread evenly over the hemisphere around `up` (a Fibonacci lattice).
std::vector<Eigen::Vector3d> HemisphereDirections(int count, const Eigen::Vector3d& up);

// A start in the observations' coordinates with a light of equal strength in each direction: colour
// from the median, ambient from the 5 % quantile, a broad lobe, lights at 20 R.
Scene StartFromDirections(const Observations& observations,
                          const std::vector<Eigen::Vector3d>& directions);

// Fits from a start with perhaps too many lights, then merges lights that are closer than their
// lobe can tell apart, removes the negligible, and eliminates backwards every light without which
// the excess variance (over noise^2) is less than three times as large; all of them, if there are
// no lights. With sample.choice.lights it stops at so many instead. See docs/design.md, "Starts".
struct Candidate {
  Scene scene;                      // in the observations' coordinates
  Shadows shadows;                  // that it was fitted with
  double mean_square = 0.0;         // residual variance per value
  double excess = 0.0;              // of it what is above the noise, with a floor
  std::vector<double> rms_history;  // on the sample: the start, and after each iteration since
};
Candidate FitAndEliminate(const Sample& sample, const Scene& start);

// Its parts: a fit of a start, strengths first and then everything; all but the elimination; and
// the elimination from what is already a fit.
Candidate FitStart(const Sample& sample, const Scene& start);
Candidate FitAndMerge(const Sample& sample, const Scene& start);
Candidate Eliminate(const Sample& sample, const Candidate& fitted);

// What of a residual variance is above noise^2, with a floor that stands for what the model cannot
// describe anyway and for what the noise's estimate is off.
double ExcessVariance(double mean_square, double noise);

// Whether an excess variance is no more than its floor and the statistical uncertainty of the
// noise: no other model can explain more.
bool NothingLeft(double excess, const Sample& sample);

}  // namespace turnlight::estimator
