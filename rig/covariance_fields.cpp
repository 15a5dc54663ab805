#include "rig/covariance_fields.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/format.h"

namespace turnlight::rig {
namespace {

using nlohmann::ordered_json;

// Sums of products differ by their order.
constexpr double kSymmetryTolerance = 1e-9;

Eigen::MatrixXd ReadSymmetric(StrictObject& object, const char* key, Eigen::Index size) {
  const auto count = static_cast<std::size_t>(size);
  const std::vector<double> rows = object.Matrix(key, count, count);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  if (!object.ok()) return matrix;
  for (Eigen::Index r = 0; r < size; ++r)
    for (Eigen::Index c = 0; c < size; ++c)
      matrix(r, c) = rows[static_cast<std::size_t>(r * size + c)];
  if ((matrix.diagonal().array() < 0.0).any())
    object.RefuseText(key, "a variance is negative, allowed is 0 or more");
  for (Eigen::Index r = 0; r < size; ++r)
    for (Eigen::Index c = 0; c < r; ++c)
      if (std::abs(matrix(r, c) - matrix(c, r)) >
          kSymmetryTolerance * std::sqrt(matrix(r, r) * matrix(c, c)))
        object.RefuseText(key, "rows and columns differ, allowed is a symmetric matrix");
  return matrix;
}

ordered_json PrintMatrix(const Eigen::MatrixXd& matrix) {
  ordered_json rows = ordered_json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    rows.push_back(ordered_json::array());
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) rows.back().push_back(matrix(r, c));
  }
  return rows;
}

using NamedCovariance = std::pair<std::string, const std::optional<Eigen::MatrixXd>*>;

std::vector<NamedCovariance> NamedParts(const CalibrationCovariances& known) {
  return {{"camera_model", &known.camera_model},
          {"X_WC", &known.X_WC},
          {"X_WA", &known.X_WA},
          {"X_AT", &known.X_AT},
          {"angle_scale", &known.angle_scale},
          {"angle_offset", &known.angle_offset}};
}

// The parts that the key of names; a refusal in the object if it names others.
std::vector<NamedCovariance> ReadParts(StrictObject& object, const CalibrationCovariances& known) {
  std::vector<NamedCovariance> with_covariance, named;
  std::vector<std::string> words;
  for (const NamedCovariance& part : NamedParts(known)) {
    if (!*part.second) continue;
    with_covariance.push_back(part);
    words.push_back(part.first);
  }
  const nlohmann::json& of = object.Raw("of");
  for (const nlohmann::json& word : of) {
    const auto part = std::find_if(
        with_covariance.begin(), with_covariance.end(),
        [&word](const NamedCovariance& one) { return word.is_string() && word == one.first; });
    if (part == with_covariance.end()) break;
    named.push_back(*part);
    with_covariance.erase(part);
  }
  if (!of.is_array() || named.size() < 2 || named.size() != of.size())
    object.Refuse("of", "a list of two or more of the parts that have a covariance (" +
                            Listed(words) + "), each once");
  return named;
}

bool SameBlock(const Eigen::MatrixXd& block, const Eigen::MatrixXd& own) {
  for (Eigen::Index r = 0; r < own.rows(); ++r)
    for (Eigen::Index c = 0; c < own.cols(); ++c)
      if (!(std::abs(block(r, c) - own(r, c)) <=
            kSymmetryTolerance * std::sqrt(own(r, r) * own(c, c))))
        return false;
  return true;
}

}  // namespace

std::optional<Eigen::MatrixXd> ReadCovariance(StrictObject& object, Eigen::Index size) {
  if (object.Raw("covariance").is_null()) return std::nullopt;
  Eigen::MatrixXd matrix = ReadSymmetric(object, "covariance", size);
  if (!object.ok()) return std::nullopt;
  return matrix;
}

void AddCovariance(ordered_json& object, const std::optional<Eigen::MatrixXd>& covariance) {
  if (covariance) object["covariance"] = PrintMatrix(*covariance);
}

Result<JointCovariance> ReadJointCovariance(StrictObject object,
                                            const CalibrationCovariances& known) {
  const std::vector<NamedCovariance> parts = ReadParts(object, known);
  JointCovariance joint;
  Eigen::Index size = 0;
  for (const NamedCovariance& part : parts) {
    joint.of.push_back(part.first);
    size += (*part.second)->rows();
  }
  if (object.ok()) joint.matrix = ReadSymmetric(object, "matrix", size);
  Eigen::Index at = 0;
  for (const NamedCovariance& part : parts) {
    const Eigen::MatrixXd& own = **part.second;
    if (object.ok() && !SameBlock(joint.matrix.block(at, at, own.rows(), own.cols()), own))
      object.RefuseText("matrix", "its block of " + part.first + " is not " + part.first +
                                      "/covariance, allowed is the same");
    at += own.rows();
  }
  if (const Status status = object.Finish(); !status) return Forward(status);
  return joint;
}

ordered_json PrintJointCovariance(const JointCovariance& joint) {
  return {{"of", joint.of}, {"matrix", PrintMatrix(joint.matrix)}};
}

}  // namespace turnlight::rig
