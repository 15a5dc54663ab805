#include "estimator/solve/photograph_solve.h"

#include <cmath>

#include "estimator/observe/photograph.h"

namespace turnlight::estimator::solve {
namespace {

constexpr double kBlur = 2.6;        // pixels: of a demosaiced pixel and its lens, as a box
constexpr double kDepartures = 0.1;  // their size that is expected
constexpr double kRobust = 1.0;      // expected sigmas: the scale of the loss
constexpr double kTolerance = 1e-6;  // a highlight is a small share of the cost

}  // namespace

SolveOptions PhotographSolveOptions(std::size_t lights) {
  SolveOptions options;
  options.fixed_distance.assign(lights, true);
  options.function_tolerance = kTolerance;
  options.evaluate.aperture = kBlur;
  options.evaluate.huber = kRobust * observe::kWeighedSigma;
  options.evaluate.shading_price = std::pow(observe::kWeighedSigma / kDepartures, 2);
  return options;
}

}  // namespace turnlight::estimator::solve
