// Lights that change from keyframe to keyframe: a factor for each of them in each keyframe, which
// no other keyframe's pictures depend on. So the normal equations have a block for each keyframe,
// and the factors are eliminated (Schur complement): what stays is a problem as small as that of
// constant lights. The pictures are linear in a factor: given the other parameters, one step has
// them at their minimum.
//
// Of each light the mean of the factors over the keyframes that see it is 1, for its intensity has
// their scale. A keyframe in which it hardly shows (less than 1e-4 of the information of the best)
// does not see it; its factor stays as it is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/model/scene.h"
#include "estimator/solve/normal_equations.h"

namespace turnlight::estimator::solve {

struct FrameFactors {
  struct Keyframe {
    Eigen::VectorXd step;        // what the factors gain where the other parameters stay
    Eigen::MatrixXd by_others;   // lights x columns: how they follow the others
    Eigen::MatrixXd covariance;  // given the others, for residuals of variance 1
    std::vector<bool> seen;      // per light
  };
  std::vector<Keyframe> keyframes;
  double gain = 0.0;  // of the cost, by `step`

  // [1; by_others]: the columns of all by those of the others.
  Eigen::MatrixXd Substitution(std::size_t keyframe) const;
  // Parameters that the factors have beyond the intensities.
  int count() const;
};

// keyframes: of each its equations by the other parameters' columns and then its factors'.
FrameFactors EliminateFactors(const std::vector<NormalEquations>& keyframes, int others);

// Adds a keyframe's share to the equations of the other parameters.
void AddReduced(const FrameFactors& factors, std::size_t keyframe, const NormalEquations& equations,
                NormalEquations& sum);

// Gives each light as many factors as there are keyframes, 1 where it has none.
void CompleteFactors(std::size_t keyframes, model::Scene& scene);

// Moves the factors along with a step of the other parameters, and by `share` of their own step;
// none below 0; means are 1 again.
void MoveFactors(const FrameFactors& factors, const Eigen::VectorXd& step, double share,
                 model::Scene& scene);

}  // namespace turnlight::estimator::solve
