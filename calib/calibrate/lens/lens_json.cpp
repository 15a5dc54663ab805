#include "calib/calibrate/lens/lens_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/sha256.h"

namespace turnlight::calib::calibrate::lens {
namespace {

using Json = nlohmann::ordered_json;

constexpr Eigen::Index kMostIntrinsics = 300;

const char* KindName(board::BoardKind kind) {
  switch (kind) {
    case board::BoardKind::kCharuco:
      return "charuco";
    case board::BoardKind::kAprilTagGrid:
      return "apriltag-grid";
    case board::BoardKind::kChessboard:
      break;
  }
  return "chessboard";
}

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

template <typename Value>
Json Rows(const std::vector<Value>& values, int columns) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % static_cast<std::size_t>(columns) == 0) rows.push_back(Json::array());
    rows.back().push_back(NumberOrNull(static_cast<double>(values[i])));
  }
  return rows;
}

Json MatrixRows(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(matrix(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json PoseRows(const Pose& pose) {
  const std::vector<double> numbers = RowsFromPose(pose);
  Json rows = Json::array();
  for (std::size_t r = 0; r < 3; ++r)
    rows.push_back(std::vector<double>(numbers.begin() + static_cast<std::ptrdiff_t>(4 * r),
                                       numbers.begin() + static_cast<std::ptrdiff_t>(4 * r + 4)));
  return rows;
}

Json Images(const std::vector<PictureViews>& pictures, const LensCalibration& calibration,
            const LensAssessment& assessment) {
  Json used = Json::array(), dropped = Json::array();
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const FittedView& view = calibration.views[i];
    const auto& doubtful = assessment.doubtful;
    used.push_back({{"image", pictures[view.picture].picture},
                    {"board", view.board},
                    {"rms_px", view.rms_px},
                    {"points", view.points},
                    {"outliers", view.outliers},
                    {"doubtful", std::find(doubtful.begin(), doubtful.end(), i) != doubtful.end()},
                    {"X_CB", PoseRows(view.X_CB)}});
  }
  for (const DroppedView& drop : calibration.dropped)
    dropped.push_back({{"image", pictures[drop.picture].picture},
                       {"board", drop.board ? Json(*drop.board) : Json(nullptr)},
                       {"reason", drop.reason}});
  return {{"used", std::move(used)}, {"dropped", std::move(dropped)}};
}

Json Uncertainty(const LensAssessment& assessment, const std::string& length_unit) {
  Json regions = Json::array();
  for (const Region& region : assessment.regions)
    regions.push_back({{"name", region.name},
                       {"covered_share", region.covered_share},
                       {"sigma_px", NumberOrNull(region.sigma_px)}});
  Json uncertainty = {{"columns", assessment.grid.columns},
                      {"rows", assessment.grid.rows},
                      {"worst_sigma_px", Rows(assessment.sigma_px, assessment.grid.columns)},
                      {"regions", std::move(regions)},
                      {"covered_sigma_px", NumberOrNull(assessment.covered_sigma_px)}};
  if (assessment.distance)
    uncertainty["at_distance"] = {
        {"distance", *assessment.distance},
        {"unit", length_unit},
        {"worst_sigma_px", Rows(assessment.sigma_at_distance_px, assessment.grid.columns)}};
  return uncertainty;
}

Json Shape(const std::vector<Eigen::Vector3d>& shape) {
  if (shape.empty()) return nullptr;
  Json points = Json::array();
  for (const Eigen::Vector3d& offset : shape)
    points.push_back(std::vector<double>{offset.x(), offset.y(), offset.z()});
  return points;
}

Json Halves(const Result<CrossValidation>& halves) {
  if (!halves) return {{"reason", halves.error().text}};
  return {{"rms_px", halves->rms_px},
          {"largest_px", halves->largest_px},
          {"expected_px", halves->expected_px}};
}

}  // namespace

std::string IntrinsicsJson(const board::Board& board, const std::vector<PictureViews>& pictures,
                           const LensCalibration& calibration, const LensAssessment& assessment,
                           const std::string& model_text, const std::string& length_unit) {
  const CameraModel& camera = calibration.camera();
  const auto count = static_cast<Eigen::Index>(camera.intrinsics().size());
  const Eigen::MatrixXd& covariance = calibration.uncertainty.covariance();
  const bool small = count <= kMostIntrinsics;
  Json json;
  json["format"] = "turnlight-intrinsics";
  json["version"] = 1;
  json["camera_model"] = {{"path", "camera.cameramodel"}, {"sha256", Sha256Hex(model_text)}};
  json["lens_model"] = camera.lens_model();
  json["resolution"] = {camera.width(), camera.height()};
  json["board"] = {{"kind", KindName(board.kind)},
                   {"columns", board.columns},
                   {"rows", board.rows},
                   {"spacing", board.spacing},
                   {"unit", length_unit}};
  json["verdict"] = assessment.verdict;
  json["advice"] = assessment.advice;
  json["notes"] = calibration.notes;
  json["rms_px"] = calibration.rms_px;
  json["noise_px"] = calibration.noise_px;
  json["points"] = calibration.points.size();
  json["outliers"] = calibration.outliers;
  json["parameters"] = calibration.parameters;
  json["board_warp"] = {{"fitted", calibration.warp_fitted},
                        {"along_rows", calibration.warp.x()},
                        {"along_columns", calibration.warp.y()},
                        {"unit", length_unit}};
  json["board_shape"] = Shape(calibration.shape);
  json["intrinsics"] = {
      {"value", camera.intrinsics()},
      {"covariance", small ? MatrixRows(covariance.topLeftCorner(count, count)) : Json(nullptr)}};
  json["projection_covariance"] = small ? MatrixRows(covariance) : Json(nullptr);
  json["images"] = Images(pictures, calibration, assessment);
  json["coverage"] = {{"share", assessment.covered_share},
                      {"columns", assessment.coverage.columns},
                      {"rows", assessment.coverage.rows},
                      {"points", Rows(assessment.coverage.points, assessment.coverage.columns)}};
  json["uncertainty"] = Uncertainty(assessment, length_unit);
  json["cross_validation"] = Halves(assessment.halves);
  // A line for each key: a matrix is no reading matter.
  std::string text;
  for (const auto& [key, value] : json.items())
    text += (text.empty() ? "{\n \"" : ",\n \"") + key +
            "\": " + value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text + "\n}\n";
}

}  // namespace turnlight::calib::calibrate::lens
