// The published method that every comparison is made with: Mashita, Yasuhara, Plopski, Kiyokawa,
// Takemura, "Parallel Lighting and Reflectance Estimation based on Inverse Rendering".
//
// Lights' directions are those of clusters in the intensity map and stay as they are. Everything
// else starts from fixed values and is found by steepest descent on the paper's eq. 1, the mean
// over views, pixels and channels of |R - S|^2, pixels shaded at their centres. What the paper
// leaves open, and how it is filled here, is in docs/paper_method.md.
//
// Lights have a distance and no intensity: light l at p_l gives the irradiance (d0 / |p_l - x|)^2,
// so that its distance says how bright it is as well as where.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "base/result.h"
#include "base/stop_flag.h"
#include "calib/rig_geometry.h"
#include "estimator/model/scene.h"
#include "estimator/observe/intensity_map.h"
#include "estimator/observe/observations.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator::baseline {

struct PaperOptions {
  double ceiling_distance = 2500.0;               // d0 > 0, in the session's length unit
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // zenith angle 0; unit, in W
  int max_iterations = 228;                       // the most that the paper shows
  std::vector<std::size_t> frame_numbers;         // as EstimateOptions has them
};

// Where the paper measures zenith angles from: a plane's normal, W's +z for other shapes. A plane
// that turns gives the mean of its normals.
Eigen::Vector3d PaperUp(const std::vector<calib::RigPoses>& poses,
                        const target::Geometry& geometry);

// A cluster of the map's bright cells.
struct PaperCluster {
  Eigen::Vector3d leader;    // the brightest cell's direction
  Eigen::Vector3d centroid;  // of the cells' directions, unit: the light's direction
  std::size_t cells = 0;
};

// Bright cells (at or above half of the range of the map within 90 degrees of up) by leader
// clustering. Empty if the map has nothing there.
std::vector<PaperCluster> PaperClusters(const observe::IntensityMap& map,
                                        const Eigen::Vector3d& up);

// The clusters of points that come in some order, which the result depends on: a point joins the
// first cluster whose leader is within radius (radians), else it founds one.
std::vector<PaperCluster> ClustersOf(const std::vector<observe::MapPoint>& points, double radius);

// The optimisation problem: 4 + channels + lights variables, scaled to the size of their ranges.
class PaperProblem {
 public:
  // Where each variable stands; the first ones as in Columns.
  int Colour(int channel) const { return channel; }
  int Ambient() const { return observations_.channels; }
  int Diffuse() const { return observations_.channels + 1; }
  int Specular() const { return observations_.channels + 2; }
  int Shininess() const { return observations_.channels + 3; }                  // n / 128
  int Distance(int light) const { return observations_.channels + 4 + light; }  // d / d0
  int count() const { return Distance(static_cast<int>(directions_.size())); }

  // directions are unit, from the observations' reference. The observations must outlive this.
  PaperProblem(const observe::Observations& observations, std::vector<Eigen::Vector3d> directions,
               double ceiling_distance);

  // Median colour, everything else at the middle of its range, distances at d0.
  Eigen::VectorXd Start() const;
  // The nearest point within the ranges of the paper's Table 1.
  Eigen::VectorXd Projected(const Eigen::VectorXd& variables) const;
  // In the observations' coordinates.
  model::Scene ToScene(const Eigen::VectorXd& variables) const;
  // The paper's E, and its gradient by the variables (optional).
  double Cost(const Eigen::VectorXd& variables, Eigen::VectorXd* gradient) const;

 private:
  const observe::Observations& observations_;
  std::vector<Eigen::Vector3d> directions_;
  double radius_;            // R / d0
  double nearest_distance_;  // of d / d0
};

struct PaperDescent {
  Eigen::VectorXd variables;
  std::vector<double> cost_history;  // E before the first and after each iteration
  int iterations = 0;
  bool converged = false;  // no step along the gradient lowers E any more
};

// Steepest descent projected on the ranges, with Armijo's backtracking. Deterministic for any
// number of threads. With stop set it ends before the next iteration.
PaperDescent Descend(const PaperProblem& problem, const Eigen::VectorXd& start, int max_iterations,
                     const StopFlag* stop = nullptr);

struct PaperSolution {
  model::Scene scene;  // in the observations' coordinates
  std::vector<PaperCluster> clusters;
  PaperDescent descent;
};

// The whole method. Fails with kNoEstimate if the map shows nothing within 90 degrees of up.
Result<PaperSolution> SolveByPaper(const observe::Observations& observations,
                                   const observe::IntensityMap& map, const PaperOptions& options,
                                   const StopFlag* stop = nullptr);

}  // namespace turnlight::estimator::baseline
