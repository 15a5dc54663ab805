#include "calib/calibrate/drift/hypothesis.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "calib/calibrate/placement/calibration_share.h"

namespace turnlight::calib::calibrate::drift {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMostSteps = 25;
constexpr double kFirstDamping = 1e-3, kMostDamping = 1e6;
constexpr double kConverged = 1e-2;   // of the misfit, that a step would gain
constexpr double kLeastReach = 12.0;  // pixels: what a point counts as off that is not seen
constexpr double kTukey = 4.685;      // 95 % efficient for normal residuals
constexpr double kOutlier = 4.0;      // sigma
constexpr double kLeastNoise = 1e-3;  // pixels; exact corners have none
constexpr double kTold = 10.0;        // information of a drift over that of the prior
constexpr double kPixelStep = 0.01;   // of an intrinsic whose sigma is not known
constexpr double kSmallStep = 0.1;    // of one whose sigma is, in sigmas
constexpr int kSiftings = 3;

// What shading does to outlines is much the same in all views, as the lights stay: a function of
// the outline's direction in the picture, by its first harmonics. The first is a shift of all
// pictures.
constexpr Index kHarmonics = 4;

// Numbers that pictures depend on: a step of the rig, then the edge offset, cosine and sine of each
// harmonic, and a deviation of each view's angle in degrees.
struct Numbers {
  Index edge, harmonics, deviation, size;
  Numbers(const Layout& layout, std::size_t views)
      : edge(layout.size),
        harmonics(edge + 1),
        deviation(harmonics + 2 * kHarmonics),
        size(deviation + static_cast<Index>(views)) {}
};

using Harmonics = Eigen::Matrix<double, 2 * kHarmonics, 1>;

// At a point's normal.
Harmonics HarmonicsAt(const Eigen::Vector2d& normal) {
  const double angle = std::atan2(normal.y(), normal.x());
  Harmonics at;
  for (Index k = 1; k <= kHarmonics; ++k)
    at.segment<2>(2 * (k - 1)) << std::cos(static_cast<double>(k) * angle),
        std::sin(static_cast<double>(k) * angle);
  return at;
}

// The unknowns, each with mean 0 and sigma 1, and how they move the numbers: first the drift.
struct Unknowns {
  MatrixXd moves;  // numbers x unknowns
  Index drift = 0, stored = 0;
};

void Append(const MatrixXd& block, Index row, MatrixXd& moves) {
  const Index before = moves.cols();
  moves.conservativeResize(Eigen::NoChange, before + block.cols());
  moves.rightCols(block.cols()).setZero();
  moves.block(row, before, block.rows(), block.cols()) = block;
}

Unknowns UnknownsOf(const Sights& sights, const Hypothesis& hypothesis, const Nuisances& nuisances,
                    const Layout& layout, const Numbers& numbers) {
  Unknowns unknowns{MatrixXd::Zero(numbers.size, 0)};
  for (const Cause cause : hypothesis.causes)
    Append(StepsOf(cause, sights.start, layout), 0, unknowns.moves);
  unknowns.drift = unknowns.moves.cols();
  if (hypothesis.stored_errors)
    Append(StoredRoot(sights.start, layout, !sights.object_free), 0, unknowns.moves);
  unknowns.stored = unknowns.moves.cols() - unknowns.drift;
  if (sights.object_free) Append(StepsOf(Cause::kTarget, sights.start, layout), 0, unknowns.moves);
  const auto one = [](double sigma) { return MatrixXd::Constant(1, 1, sigma); };
  if (sights.edges && nuisances.edge_offset > 0.0)
    Append(one(nuisances.edge_offset), numbers.edge, unknowns.moves);
  if (sights.edges && nuisances.shading > 0.0)
    for (Index i = numbers.harmonics; i < numbers.deviation; ++i)
      Append(one(nuisances.shading), i, unknowns.moves);
  if (nuisances.angle_deg > 0.0)
    for (Index v = numbers.deviation; v < numbers.size; ++v)
      Append(one(nuisances.angle_deg), v, unknowns.moves);
  return unknowns;
}

struct Evaluated {
  rig::RigCalibration rig;
  std::vector<placement::View> views;
  std::vector<placement::Residual> residuals;
};

Evaluated Evaluate(const Sights& sights, const Layout& layout, const Numbers& numbers,
                   const VectorXd& values) {
  Evaluated at{Changed(sights.start, layout, values.head(layout.size)), sights.views, {}};
  for (std::size_t v = 0; v < at.views.size(); ++v)
    at.views[v].angle_deg +=
        values[numbers.deviation + static_cast<Index>(v)] / at.rig.geometry.angle_scale;
  at.residuals = sights.residuals(at.rig, at.views, values[numbers.edge]);
  for (placement::Residual& residual : at.residuals) {
    residual.value -=
        HarmonicsAt(residual.normal).dot(values.segment<2 * kHarmonics>(numbers.harmonics));
    if (!residual.valid || !std::isfinite(residual.value)) {
      residual.valid = false;
      residual.value = std::max(sights.reach, kLeastReach);
    }
  }
  return at;
}

// By an intrinsic: it moves the image of what a measured point's ray meets.
void PutIntrinsics(const Evaluated& at, const Layout& layout, MatrixXd& by) {
  const calib::CameraModel& camera = at.rig.lens;
  const auto& covariance = at.rig.covariances.camera_model;
  std::vector<Eigen::Vector2d> pixels;
  for (const placement::Residual& residual : at.residuals) pixels.push_back(residual.pixel);
  const std::vector<Vector3d> rays = camera.Unproject(pixels);
  const std::vector<Eigen::Vector2d> before = camera.Project(rays);
  for (Index k = 0; k < layout.X_WC; ++k) {
    double step = covariance ? kSmallStep * std::sqrt((*covariance)(k, k)) : 0.0;
    if (!(step > 0.0)) step = k < 4 ? kPixelStep : 0.0;
    if (!(step > 0.0)) continue;
    std::vector<double> intrinsics = camera.intrinsics();
    intrinsics[static_cast<std::size_t>(k)] += step;
    const auto after = camera.WithIntrinsics(std::move(intrinsics)).Project(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double value = -at.residuals[i].normal.dot(after[i] - before[i]) / step;
      if (std::isfinite(value)) by(static_cast<Index>(i), k) = value;
    }
  }
}

// Residuals by numbers.
MatrixXd Linearise(const Evaluated& at, const Layout& layout, const Numbers& numbers) {
  MatrixXd by = MatrixXd::Zero(static_cast<Index>(at.residuals.size()), numbers.size);
  std::vector<Pose> X_CA;
  for (const placement::View& view : at.views)
    X_CA.push_back(placement::PoseOfTableInCamera(at.rig.geometry, view.angle_deg));
  placement::State state;
  state.X_AT = at.rig.geometry.X_AT;
  PutIntrinsics(at, layout, by);
  for (std::size_t i = 0; i < at.residuals.size(); ++i) {
    const placement::Residual& residual = at.residuals[i];
    const auto row = static_cast<Index>(i);
    if (!residual.valid) {
      by.row(row).setZero();
      continue;
    }
    const auto geometry = placement::PointByGeometry(
        at.rig.geometry, at.views[residual.view].angle_deg, residual.p_A);
    by.block<1, 6>(row, layout.X_WC) = residual.by_p_C * geometry.X_WC;
    by.block<1, 6>(row, layout.X_WA) = residual.by_p_C * geometry.X_WA;
    by(row, layout.angle_scale) = residual.by_p_C * geometry.angle_scale;
    by(row, layout.angle_offset) = residual.by_p_C * geometry.angle_offset;
    const placement::Row object = placement::ParameterRow(residual, state, X_CA[residual.view]);
    by.block<1, 6>(row, layout.object) = object.head<6>();
    by(row, numbers.edge) = object[placement::kEdgeOffset];
    by.block<1, 2 * kHarmonics>(row, numbers.harmonics) = -HarmonicsAt(residual.normal).transpose();
    by(row, numbers.deviation + static_cast<Index>(residual.view)) = by(row, layout.angle_offset);
  }
  return by;
}

// What each residual counts: 1 / sigma, or less.
VectorXd RootWeights(const std::vector<placement::Residual>& residuals, const Sifted& sifted) {
  VectorXd weights(static_cast<Index>(residuals.size()));
  std::vector<double> sizes;
  for (const placement::Residual& residual : residuals)
    sizes.push_back(std::abs(residual.value) / residual.sigma);
  double scale = sifted.noise * std::sqrt(sifted.correlation);
  if (sifted.used.empty()) {
    std::vector<double> sorted = sizes;
    scale = std::max(kLeastNoise, Median(sorted) / kMedianOfNormal);
  }
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    double share = sizes[i] / (kTukey * scale);
    double weight = share < 1.0 ? 1.0 - share * share : 0.0;
    if (!sifted.used.empty()) weight = sifted.used[i] ? 1.0 : 0.0;
    weights[static_cast<Index>(i)] = weight / (scale * residuals[i].sigma);
  }
  return weights;
}

double MisfitOf(const std::vector<placement::Residual>& residuals, const VectorXd& weights,
                const VectorXd& unknowns) {
  double sum = unknowns.squaredNorm();
  for (std::size_t i = 0; i < residuals.size(); ++i)
    sum += std::pow(weights[static_cast<Index>(i)] * residuals[i].value, 2);
  return sum;
}

struct Minimum {
  VectorXd unknowns;
  Evaluated at;
  MatrixXd information;  // of the unknowns, without their priors
  double misfit = 0.0;
};

// The weighted problem at a point.
struct Linear {
  VectorXd weights;
  MatrixXd weighted;  // residuals by unknowns
  VectorXd gradient;
};

Linear LineariseAt(const Minimum& now, const Layout& layout, const Numbers& numbers,
                   const Unknowns& unknowns, const Sifted& sifted) {
  Linear linear{RootWeights(now.at.residuals, sifted), {}, {}};
  VectorXd sizes(linear.weights.size());
  for (Index i = 0; i < sizes.size(); ++i)
    sizes[i] = linear.weights[i] * now.at.residuals[static_cast<std::size_t>(i)].value;
  linear.weighted =
      linear.weights.asDiagonal() * (Linearise(now.at, layout, numbers) * unknowns.moves).eval();
  linear.gradient = linear.weighted.transpose() * sizes + now.unknowns;
  return linear;
}

// Levenberg and Marquardt, with the weights of each step held while it is judged.
Minimum Minimise(const Sights& sights, const Layout& layout, const Numbers& numbers,
                 const Unknowns& unknowns, const Sifted& sifted) {
  const Index count = unknowns.moves.cols();
  Minimum now{
      VectorXd::Zero(count), Evaluate(sights, layout, numbers, VectorXd::Zero(numbers.size)), {}};
  double damping = kFirstDamping;
  for (int steps = 0;; ++steps) {
    const Linear linear = LineariseAt(now, layout, numbers, unknowns, sifted);
    now.information = linear.weighted.transpose() * linear.weighted;
    now.misfit = MisfitOf(now.at.residuals, linear.weights, now.unknowns);
    if (steps == kMostSteps) return now;
    const MatrixXd normal = now.information + MatrixXd::Identity(count, count);
    const VectorXd newton = normal.ldlt().solve(linear.gradient);
    if (newton.dot(linear.gradient) < kConverged) return now;
    bool better = false;
    for (; !better && damping < kMostDamping; damping *= better ? 0.1 : 10.0) {
      MatrixXd damped = normal;
      damped.diagonal() *= 1.0 + damping;
      const VectorXd tried = now.unknowns - damped.ldlt().solve(linear.gradient);
      Evaluated at = Evaluate(sights, layout, numbers, unknowns.moves * tried);
      better = MisfitOf(at.residuals, linear.weights, tried) < now.misfit;
      if (!better) continue;
      now.unknowns = tried;
      now.at = std::move(at);
    }
    if (!better) return now;
  }
}

// Of the drift, the other unknowns being free within their priors: `others` of the unknowns, from
// column `from` on.
MatrixXd MarginalOf(const MatrixXd& information, Index drift, Index from) {
  const Index others = information.cols() - from;
  const MatrixXd across = information.block(0, from, drift, others);
  const MatrixXd normal =
      information.bottomRightCorner(others, others) + MatrixXd::Identity(others, others);
  return information.topLeftCorner(drift, drift) -
         across * normal.ldlt().solve(across.transpose().eval());
}

// What the pictures tell of the drift, and no more: directions that they do not tell stay 0.
struct Told {
  MatrixXd directions;         // projects the drift's unknowns onto what is told
  MatrixXd covariance, prior;  // of the drift, and what is taken of it in the told directions
};

Told ToldBy(const MatrixXd& marginal, const MatrixXd& steps) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(marginal);
  const MatrixXd none = MatrixXd::Zero(steps.rows(), steps.rows());
  Told told{MatrixXd::Zero(marginal.rows(), marginal.rows()), none, none};
  for (Index i = 0; i < marginal.rows(); ++i) {
    const double information = eigen.eigenvalues()[i];
    if (information < kTold) continue;
    const VectorXd unknown = eigen.eigenvectors().col(i);
    const VectorXd direction = steps * unknown;
    told.directions += unknown * unknown.transpose();
    told.prior += direction * direction.transpose();
    told.covariance += direction * direction.transpose() / (1.0 + information);
  }
  return told;
}

double FreedomOf(const MatrixXd& information) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(information);
  double freedom = 0.0;
  for (const double told : eigen.eigenvalues())
    freedom += std::max(0.0, told) / (1.0 + std::max(0.0, told));
  return freedom;
}

}  // namespace

HypothesisFit FitHypothesis(const Sights& sights, const Hypothesis& hypothesis,
                            const Nuisances& nuisances, const Sifted& sifted) {
  const Layout layout(sights.start);
  const Numbers numbers(layout, sights.views.size());
  const Unknowns unknowns = UnknownsOf(sights, hypothesis, nuisances, layout, numbers);
  const Minimum minimum = Minimise(sights, layout, numbers, unknowns, sifted);
  HypothesisFit fit;
  fit.hypothesis = hypothesis;
  fit.residuals = minimum.at.residuals;
  fit.misfit = minimum.misfit;
  fit.taken = FreedomOf(minimum.information);
  const MatrixXd steps = unknowns.moves.block(0, 0, layout.size, unknowns.drift);
  fit.drift = VectorXd::Zero(layout.size);
  fit.covariance = fit.from_pictures = MatrixXd::Zero(layout.size, layout.size);
  if (unknowns.drift == 0) return fit;
  const MatrixXd marginal = MarginalOf(minimum.information, unknowns.drift, unknowns.drift);
  fit.freedom = FreedomOf(marginal);
  const Told told = ToldBy(marginal, steps);
  fit.drift = steps * (told.directions * minimum.unknowns.head(unknowns.drift));
  fit.covariance = told.covariance;
  fit.told = told.prior;
  fit.could_be = steps * steps.transpose();
  fit.from_pictures =
      ToldBy(MarginalOf(minimum.information, unknowns.drift, unknowns.drift + unknowns.stored),
             steps)
          .covariance;
  return fit;
}

Sifted Sift(const Sights& sights, const std::vector<Cause>& causes, const Nuisances& nuisances) {
  Sifted sifted;
  const Hypothesis everything{causes};
  for (int round = 0; round < kSiftings; ++round) {
    const HypothesisFit fit = FitHypothesis(sights, everything, nuisances, sifted);
    const std::size_t count = fit.residuals.size();
    std::vector<double> sizes;
    for (const placement::Residual& residual : fit.residuals)
      sizes.push_back(std::abs(residual.value) / residual.sigma);
    std::vector<double> sorted = sizes;
    const double scale = std::max(kLeastNoise, Median(sorted) / kMedianOfNormal);
    placement::Fit told;
    told.residuals = fit.residuals;
    double sum = 0.0, used = 0.0;
    for (std::size_t i = 0; i < count; ++i)
      told.used.push_back(fit.residuals[i].valid && sizes[i] < kOutlier * scale);
    // A corner has two residuals, and is right or wrong as one.
    for (std::size_t i = 0; i + 1 < count; i += 2)
      if (!fit.residuals[i].edge)
        told.used[i] = told.used[i + 1] = told.used[i] && told.used[i + 1];
    for (std::size_t i = 0; i < count; ++i) {
      if (!told.used[i]) continue;
      sum += sizes[i] * sizes[i];
      used += 1.0;
    }
    sifted.noise = std::max(kLeastNoise, std::sqrt(sum / std::max(1.0, used - fit.taken)));
    sifted.correlation = sights.edges ? placement::CorrelationOf(told, sights.views.size()) : 1.0;
    sifted.used = std::move(told.used);
  }
  return sifted;
}

}  // namespace turnlight::calib::calibrate::drift
