// One pass over the observations: cost, gradient and Gauss-Newton matrix of the whole problem.
//
// The Jacobian of a pixel's channel c is O_c a_i + b_i for every parameter i that the colours share
// (a: diffuse part, b: specular part, white), so the sum over channels of its outer products is
// that of two rows, not three: with [sum O^2, sum O; sum O, C] = L L^T, the rows L11 a + L21 b and
// L22 b. Rows are accumulated in float lanes, flushed to double every 2048 pixels, and summed over
// fixed chunks in their order: the same bits for any number of threads and any instruction set.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimator/observations.h"
#include "estimator/scene.h"
#include "estimator/shadows.h"

namespace turnlight::estimator {

// Where each parameter's row and column stand. Shininess is in log; Oren-Nayar's roughness by its
// square, for the model is even in it and a start at 0 would not move; directions are two tangent
// coordinates in TangentBasis(u); inverse distances are in units of 1/R, as all of a Scene here.
struct Columns {
  int channels = 3;
  int lights = 0;

  int Albedo(int channel) const { return channel; }
  int Ambient() const { return channels; }
  int Diffuse() const { return channels + 1; }
  int Specular() const { return channels + 2; }
  int LogShininess() const { return channels + 3; }
  int RoughnessSquared() const { return channels + 4; }
  int Intensity(int light) const { return channels + 5 + 4 * light; }
  int Tangent(int light) const { return Intensity(light) + 1; }  // and the next
  int InverseDistance(int light) const { return Intensity(light) + 3; }
  int count() const { return channels + 5 + 4 * lights; }
};

// Two unit vectors that with unit u form a right-handed basis (u, e1, e2 orthonormal). Duff et al.,
// "Building an Orthonormal Basis, Revisited" (JCGT 2017).
Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& u);

struct NormalEquations {
  Eigen::MatrixXd hessian;   // J^T J, Columns::count() squared, symmetric
  Eigen::VectorXd gradient;  // J^T r, r = model - observed
  double cost = 0.0;         // sum of r^2 / 2 over pixels and channels
};

struct EvaluateOptions {
  // Sub-samples per side of a pixel's footprint for the highlight, one per tile; empty: 1
  // everywhere.
  std::vector<std::uint8_t> samples_per_side;
  // The part of a pixel's width that those cover.
  double aperture = kAperture;
  // Which lights the observations see; empty: all of them.
  Shadows shadows;
  // Scale of Huber's loss on the root-mean-square residual of a pixel, in radiance; 0: squares.
  double huber = 0.0;
  // Cost and gradient are enough: the hessian is left without meaning.
  bool gradient_only = false;
};

// scene is in the observations' coordinates (about the reference, lengths / R), lights white.
NormalEquations Evaluate(const Observations& observations, const Scene& scene,
                         const EvaluateOptions& options);
// The gradient of each tile by itself: columns x tiles.
Eigen::MatrixXd TileGradients(const Observations& observations, const Scene& scene,
                              const EvaluateOptions& options);
// As Evaluate in double precision, for tests of derivatives.
NormalEquations EvaluateDouble(const Observations& observations, const Scene& scene,
                               const EvaluateOptions& options);

// Radiance of every observation, channel by channel, in the observations' order.
using Prediction = std::vector<std::vector<float>>;

// The model's radiances; 0 where an observation is not usable.
Prediction Predict(const Observations& observations, const Scene& scene,
                   const EvaluateOptions& options);

// How many values, pixels times channels, a cost is a sum over.
double ValueCount(const Observations& observations, const EvaluateOptions& options);

// How finely each tile's footprint must be sampled for a lobe of this shininess: the mirrored ray's
// change across the pixel against the lobe's half-width (design, section 2). least: 1 or 2. Where
// the centre would do, shininess is off by up to 0.5 % with 1, which for a start is good enough.
std::vector<std::uint8_t> FootprintSamples(const Observations& observations, double shininess,
                                           int least = 1);

// The half-width of a lobe cos^n, radians: acos(2^(-1/n)).
double LobeHalfWidth(double shininess);

// Scene in W to the observations' coordinates and back (exact; see Recentred).
Scene ToSolver(const Scene& scene, const Observations& observations);
Scene ToWorld(const Scene& scene, const Observations& observations);

}  // namespace turnlight::estimator
