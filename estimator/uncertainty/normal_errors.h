// Normals that are wrong: all of them tilted together, as those of a target that is registered a
// little wrong, or each by itself, as those of a noisy scan.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "estimator/observe/observations.h"
#include "estimator/solve/solver.h"
#include "estimator/uncertainty/score_test.h"

namespace turnlight::estimator::uncertainty {

struct TiltResponse {
  // By the angle (radians) about each axis: the target's where observations know its poses (what
  // can shadow itself), else W's.
  std::array<Score, 3> scores;
  // Of squares, the angles' Gauss-Newton matrix.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  // Per pixel the squared change of its radiances by a tilt's angle, over two axes across its
  // normal.
  std::vector<double> by_any;
};

TiltResponse TiltNormals(const observe::Observations& pixels, const model::Scene& scene,
                         const solve::EvaluateOptions& options, const ScoreProbe& probe);

// The scene that fits the pixels with the tilt that they ask for, found in turns by Gauss-Newton
// steps. None if the cost (squares) does not fall by a fifth. solution: of all pixels; options: of
// these. untilted, response: of these at the solution's scene, by which most cases end at once.
std::optional<model::Scene> FitTilts(const observe::Observations& pixels,
                                     const solve::Solution& solution,
                                     const solve::EvaluateOptions& options,
                                     const solve::NormalEquations& untilted,
                                     const TiltResponse& response);

// The variance (radians^2, along an axis across) of normals that are wrong each by itself: the
// squared residuals are larger where tilts change the picture more, beside what noise may do, which
// is constant or grows with the radiance or its square. 0 if that is not beyond chance.
double NormalVariance(const observe::Observations& pixels, const solve::Prediction& model,
                      const std::vector<double>& by_any_tilt);

}  // namespace turnlight::estimator::uncertainty
