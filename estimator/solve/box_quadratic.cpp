#include "estimator/solve/box_quadratic.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

namespace turnlight::estimator::solve {
namespace {

enum class State { kFree, kLow, kHigh, kNull };

std::vector<Eigen::Index> FreeOnes(const std::vector<State>& states) {
  std::vector<Eigen::Index> out;
  for (std::size_t i = 0; i < states.size(); ++i)
    if (states[i] == State::kFree) out.push_back(static_cast<Eigen::Index>(i));
  return out;
}

// How far from d towards `target` the box lets the free ones go, and which of them stops there.
struct Reach {
  double share = 1.0;
  Eigen::Index stopped = -1;  // index into the free ones
};

Reach HowFar(const Eigen::VectorXd& d, const Eigen::VectorXd& target,
             const std::vector<Eigen::Index>& free, const Eigen::VectorXd& low,
             const Eigen::VectorXd& high) {
  Reach reach;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const Eigen::Index i = free[k];
    const double to = target[static_cast<Eigen::Index>(k)];
    const double bound = to < low[i] ? low[i] : to > high[i] ? high[i] : to;
    if (bound == to) continue;
    const double share = (bound - d[i]) / (to - d[i]);
    if (share < reach.share) reach = {share, static_cast<Eigen::Index>(k)};
  }
  return reach;
}

// The one at a bound that would lower the quadratic most by leaving it; -1: none.
Eigen::Index MostEager(const Eigen::VectorXd& slope, const Eigen::MatrixXd& matrix,
                       const std::vector<State>& states) {
  constexpr double kRounding = 1e-12;
  Eigen::Index best = -1;
  double most = 0.0;
  for (std::size_t s = 0; s < states.size(); ++s) {
    const auto i = static_cast<Eigen::Index>(s);
    const double inwards = states[s] == State::kLow    ? -slope[i]
                           : states[s] == State::kHigh ? slope[i]
                                                       : 0.0;
    const double gain = inwards / std::sqrt(matrix(i, i) > 0.0 ? matrix(i, i) : 1.0);
    if (gain > kRounding && gain > most) {
      most = gain;
      best = i;
    }
  }
  return best;
}

}  // namespace

Eigen::VectorXd MinimiseInBox(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& slope,
                              const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
  const Eigen::Index n = slope.size();
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  std::vector<State> states(static_cast<std::size_t>(n), State::kFree);
  for (Eigen::Index i = 0; i < n; ++i) {
    State& state = states[static_cast<std::size_t>(i)];
    if (!(matrix(i, i) > 0.0))
      state = State::kNull;
    else if (low[i] == 0.0 && slope[i] >= 0.0)
      state = State::kLow;
    else if (high[i] == 0.0 && slope[i] <= 0.0)
      state = State::kHigh;
  }
  // Finite by itself; the limit is against rounding, which could let two take turns.
  for (Eigen::Index round = 0; round < 4 * n; ++round) {
    const std::vector<Eigen::Index> free = FreeOnes(states);
    Eigen::VectorXd held = d;
    for (const Eigen::Index i : free) held[i] = 0.0;
    const Eigen::VectorXd target =
        Eigen::LLT<Eigen::MatrixXd>(matrix(free, free)).solve(-(slope + matrix * held)(free));
    const Reach reach = HowFar(d, target, free, low, high);
    for (std::size_t k = 0; k < free.size(); ++k) {
      const Eigen::Index i = free[k];
      d[i] += reach.share * (target[static_cast<Eigen::Index>(k)] - d[i]);
    }
    if (reach.stopped >= 0) {
      const Eigen::Index i = free[static_cast<std::size_t>(reach.stopped)];
      const bool at_low = target[reach.stopped] < low[i];
      d[i] = at_low ? low[i] : high[i];
      states[static_cast<std::size_t>(i)] = at_low ? State::kLow : State::kHigh;
      continue;
    }
    const Eigen::Index released = MostEager(slope + matrix * d, matrix, states);
    if (released < 0) break;
    states[static_cast<std::size_t>(released)] = State::kFree;
  }
  return d;
}

}  // namespace turnlight::estimator::solve
