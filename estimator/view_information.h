// What a view that was not taken would tell: the information matrix J^T W J that the model predicts
// for it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "calib/camera_model.h"
#include "calib/radiometry.h"
#include "calib/rig_geometry.h"
#include "estimator/fit_state.h"
#include "estimator/target/geometry.h"

namespace turnlight::estimator {

// How pictures come: what clips, and how noisy a value is if radiometry.noise is there, as it must
// be if the fit was weighted by it. Else all values are as noisy as those of the fit were.
struct Sensor {
  calib::Radiometry radiometry;  // its references filled in
  int depth = CV_16U;            // of DN: CV_8U, CV_16U or CV_32F
};

struct CandidateView {
  calib::RigPoses poses;
  calib::Exposure exposure;
  std::optional<double> angle_deg;  // of the table, if it has one
  std::string label;                // for people, as "at 125°"
};

// Over all columns of model::Parameters of fit.scene, in the fit's units. The geometry, shadows,
// outlines and grazing pixels are those of the view; pixels that the model predicts to clip, and
// their neighbours, tell nothing. Of views that see nothing of the target it is 0. Deterministic
// for any number of threads.
Eigen::MatrixXd InformationOf(const CandidateView& view, const FitState& fit,
                              const target::Geometry& geometry, const calib::RayGrid& rays,
                              const Sensor& sensor);

}  // namespace turnlight::estimator
