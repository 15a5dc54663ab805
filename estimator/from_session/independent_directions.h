// Independent directions of parameters that are known in blocks, with a joint covariance.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace turnlight::estimator::from_session {

// A square root of a covariance in as many columns as it has directions: root root^T = covariance.
// Units may differ from row to row.
struct BlockRoot {
  Eigen::MatrixXd root;     // size x directions
  Eigen::MatrixXd inverse;  // directions x size: inverse root = identity
};
BlockRoot RootOf(const Eigen::MatrixXd& covariance);

// Of blocks in their order, the columns of a square root of the whole covariance: so many for each
// block as its root has. Blocks that are not correlated have columns of their own rows alone; else
// those of a block are the nearest to its own.
Eigen::MatrixXd JointRoot(const Eigen::MatrixXd& covariance, const std::vector<BlockRoot>& blocks);

}  // namespace turnlight::estimator::from_session
