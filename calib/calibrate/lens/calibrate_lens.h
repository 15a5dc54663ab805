// From boards in pictures to a lens with its uncertainty, by mrcal's optimizer.
//
// All pictures are of one camera whose lens did not change; each board in a picture has a pose of
// its own. The seed comes from homographies, then mrcal fits in turn the poses, the focal length
// and centre of a simple lens, and everything with the lens model that was asked for: first with a
// flat board, then with a bent one. mrcal marks points that lie too far off as outliers; views that
// do not fit as a whole are dropped.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "calib/calibrate/board/board.h"
#include "calib/calibrate/lens/projection_uncertainty.h"
#include "calib/camera_model.h"
#include "calib/pose.h"

namespace turnlight::calib::calibrate::lens {

// What one picture shows. Without boards it says why, for the list of those dropped.
struct PictureViews {
  std::string picture;        // its name, for people
  int width = 0, height = 0;  // pixels
  std::vector<board::BoardView> boards;
  std::string why_none;  // "no board found"
};

struct LensOptions {
  std::string lens_model = "LENSMODEL_OPENCV8";  // as FullLensModelName gives it
  bool fits_warp = true;
  bool rejects_outliers = true;
  std::function<void(const std::string& stage)> progress;  // may be empty
};

// A board in a picture that the fit used.
struct FittedView {
  std::size_t picture = 0, board = 0;  // of the input
  Pose X_CB;
  double rms_px = 0.0;                   // per axis, of its points that are not outliers
  std::size_t points = 0, outliers = 0;  // points counts the outliers too
};

struct FittedPoint {
  std::size_t view = 0;             // of LensCalibration::views
  std::size_t point = 0;            // of the board
  Eigen::Vector2d pixel, residual;  // residual: observed less projected, pixels
  double weight = 1.0;
  bool outlier = false;
};

struct DroppedView {
  std::size_t picture = 0;
  std::optional<std::size_t> board;  // nothing: the whole picture
  std::string reason;
};

struct LensCalibration {
  explicit LensCalibration(ProjectionUncertainty of) : uncertainty(std::move(of)) {}
  const CameraModel& camera() const { return uncertainty.camera(); }

  ProjectionUncertainty uncertainty;  // holds the covariance of the intrinsics, too
  std::vector<FittedView> views;
  std::vector<FittedPoint> points;
  std::vector<DroppedView> dropped;
  // How far the board's points leave their plane half way along its rows and along its columns,
  // along z of its frame, in its length unit (mrcal's calobject_warp); 0 if it was not fitted.
  Eigen::Vector2d warp = Eigen::Vector2d::Zero();
  bool warp_fitted = false;
  double rms_px = 0.0;    // per axis, weighted, outliers left out
  double noise_px = 0.0;  // what the uncertainty assumes: standard deviation of the same residuals
  std::size_t parameters = 0;  // that were fitted
  std::size_t outliers = 0;
  std::vector<std::string> notes;  // what a user should know, whole sentences
};

// Fails (kInput): pictures of several sizes, none with a board, one view only, a board seen
// mirrored where that can be told, too few points for the model's parameters. Fails (kNoEstimate)
// with the reason where the views do not determine the lens: the uncertainty of a projection, where
// there are points, is more than 5 % of the picture's diagonal. Points outside the board, twice in
// a view, or not finite are a bug of the caller.
Result<LensCalibration> CalibrateLens(const board::Board& board,
                                      const std::vector<PictureViews>& pictures,
                                      const LensOptions& options);

}  // namespace turnlight::calib::calibrate::lens
