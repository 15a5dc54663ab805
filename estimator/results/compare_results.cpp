#include "estimator/results/compare_results.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::estimator::results {
namespace {

constexpr const char* kChannels[] = {"red", "green", "blue"};
// Of the residual's rms, which has no sigma: the share of it that other noise of the same strength
// does not reach by far, and worse pictures or a worse model do.
constexpr double kRmsTolerance = 0.05;
// Of a departure of the diffuse part from its model, which has no sigma either: the size that is
// expected of them (solve/photograph_solve.cpp).
constexpr double kDepartureTolerance = 0.1;
constexpr const char* kOtherGauge =
    "the strongest light or the brightest channel, to which this is relative, is another; the "
    "products judge it";

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return RadToDeg(std::atan2(a.cross(b).norm(), a.dot(b)));
}

// The assignment of rows to columns, no fewer of these, with the least sum of costs: the Hungarian
// method with potentials, row by row along shortest augmenting paths (Kuhn 1955; Jonker and
// Volgenant 1987). Index 0 stands for "none".
std::vector<std::size_t> BestAssignment(const Eigen::MatrixXd& cost) {
  const auto rows = static_cast<std::size_t>(cost.rows());
  const auto columns = static_cast<std::size_t>(cost.cols());
  std::vector<double> row_potential(rows + 1, 0.0), column_potential(columns + 1, 0.0);
  std::vector<std::size_t> row_of(columns + 1, 0), before(columns + 1, 0);
  for (std::size_t row = 1; row <= rows; ++row) {
    std::vector<double> least(columns + 1, std::numeric_limits<double>::infinity());
    std::vector<bool> reached(columns + 1, false);
    std::size_t column = 0;
    row_of[0] = row;
    do {
      reached[column] = true;
      double step = std::numeric_limits<double>::infinity();
      std::size_t next = 0;
      for (std::size_t j = 1; j <= columns; ++j) {
        if (reached[j]) continue;
        const double reduced =
            cost(static_cast<Eigen::Index>(row_of[column] - 1), static_cast<Eigen::Index>(j - 1)) -
            row_potential[row_of[column]] - column_potential[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          before[j] = column;
        }
        if (least[j] < step) {
          step = least[j];
          next = j;
        }
      }
      for (std::size_t j = 0; j <= columns; ++j) {
        if (reached[j]) {
          row_potential[row_of[j]] += step;
          column_potential[j] -= step;
        } else {
          least[j] -= step;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = before[column]) row_of[column] = row_of[before[column]];
  }
  std::vector<std::size_t> column_of(rows);
  for (std::size_t j = 1; j <= columns; ++j)
    if (row_of[j] != 0) column_of[row_of[j] - 1] = j - 1;
  return column_of;
}

class ResultComparer {
 public:
  ResultComparer(const ReportedResult& a, const ReportedResult& b, const Tolerances& tolerances)
      : a_(a), b_(b), tolerances_(tolerances), partners_(PartnersByDirection(a.lights, b.lights)) {
    const bool no_lights = a.lights.empty() || b.lights.empty();
    same_gauge_ = (no_lights || partners_[0] == 0U) && SameBrightestChannel();
  }

  Comparison Compare() {
    comparison_.what = "results";
    CompareModels();
    CompareLights();
    CompareReflectance();
    Add("residual", "rms", "rms", {a_.rms, {}}, {b_.rms, {}});
    return std::move(comparison_);
  }

 private:
  // Whether some channel is the brightest, albedo 1, in both.
  bool SameBrightestChannel() const {
    const auto brightest = [](const MeasuredColour& albedo) {
      double most = 0.0;
      for (const MeasuredValue& channel : albedo)
        most = std::max(most, channel.value.value_or(0.0));
      return most;
    };
    const double of_a = brightest(a_.albedo), of_b = brightest(b_.albedo);
    for (std::size_t c = 0; c < a_.albedo.size(); ++c)
      if (a_.albedo[c].value.value_or(0.0) == of_a && b_.albedo[c].value.value_or(0.0) == of_b)
        return true;
    return false;
  }

  void Add(const std::string& group, const std::string& word, const std::string& name,
           const MeasuredValue& a, const MeasuredValue& b) {
    comparison_.quantities.push_back(
        CompareNumbers({.group = group, .quantity = word, .name = name}, a, b, tolerances_));
  }
  // Of what depends on the gauge.
  void AddRelative(const std::string& group, const std::string& word, const std::string& name,
                   const MeasuredValue& a, const MeasuredValue& b) {
    Add(group, word, name, a, b);
    if (same_gauge_ || !a.value || !b.value) return;
    comparison_.quantities.back().verdict = Verdict::kNotJudged;
    comparison_.quantities.back().why = kOtherGauge;
  }

  void CompareModels() {
    const auto add = [&](const char* name, const nlohmann::json& a, const nlohmann::json& b) {
      comparison_.quantities.push_back(CompareEqual("model", name, a, b));
    };
    add("method", a_.method, b_.method);
    add("lights", a_.lights.size(), b_.lights.size());
    add("diffuse model", a_.diffuse_model, b_.diffuse_model);
    add("specular model", a_.specular_model, b_.specular_model);
    add("albedo model", a_.albedo_model, b_.albedo_model);
  }

  void CompareLights() {
    std::vector<bool> taken(b_.lights.size(), false);
    for (std::size_t i = 0; i < a_.lights.size(); ++i) {
      if (partners_[i]) {
        taken[*partners_[i]] = true;
        ComparePartners(i, *partners_[i]);
      } else {
        AddAlone("light " + std::to_string(i + 1), "A", a_.lights[i]);
      }
    }
    for (std::size_t i = 0; i < b_.lights.size(); ++i)
      if (!taken[i]) AddAlone("light " + std::to_string(i + 1) + " of B", "B", b_.lights[i]);
  }

  static nlohmann::json DirectionToJson(const ReportedLight& light) {
    return {light.direction.x(), light.direction.y(), light.direction.z()};
  }

  void AddAlone(const std::string& group, const std::string& side, const ReportedLight& light) {
    ComparedQuantity quantity{.group = group, .name = "direction"};
    (side == "A" ? quantity.a : quantity.b) = DirectionToJson(light);
    quantity.verdict = Verdict::kDifferent;
    quantity.why = "this light is in " + side + " only";
    comparison_.quantities.push_back(std::move(quantity));
  }

  void CompareDirections(const std::string& group, const ReportedLight& a, const ReportedLight& b) {
    ComparedQuantity quantity{.group = group, .quantity = "direction_deg", .name = "direction"};
    quantity.a = DirectionToJson(a);
    quantity.b = DirectionToJson(b);
    const double angle = AngleDeg(a.direction, b.direction);
    constexpr double kHalfTurn = 180.0;  // a share of a direction is a share of it
    Judge(angle, InSigmas(angle, a.direction_sigma_deg, b.direction_sigma_deg), kHalfTurn,
          tolerances_.Of(quantity.quantity), quantity);
    comparison_.quantities.push_back(std::move(quantity));
  }

  void ComparePartners(std::size_t i, std::size_t j) {
    const ReportedLight& a = a_.lights[i];
    const ReportedLight& b = b_.lights[j];
    const std::string group =
        "light " + std::to_string(i + 1) + (i == j ? "" : " (" + std::to_string(j + 1) + " of B)");
    const auto kind = [](bool near) { return near ? "near" : "distant"; };
    comparison_.quantities.push_back(CompareEqual(group, "kind", kind(a.near), kind(b.near)));
    CompareDirections(group, a, b);
    Add(group, "inverse_distance", "inverse distance", a.inverse_distance, b.inverse_distance);
    Add(group, "distance", "distance", a.distance, b.distance);
    AddRelative(group, "intensity", "intensity", a.intensity, b.intensity);
    CompareFactors(group, a.factors, b.factors);
    CompareColours(group, "light_color", "colour", ColourOf(a), ColourOf(b));
    CompareColours(group, "diffuse_product", "diffuse product", a.diffuse_product,
                   b.diffuse_product);
    Add(group, "specular_product", "specular product", a.specular_product, b.specular_product);
  }

  // Of the same frame; one that only one of them has is different.
  void CompareFactors(const std::string& group, const std::vector<ReportedFactor>& a,
                      const std::vector<ReportedFactor>& b) {
    if (!BothOrNeither(group, "change from frame to frame", !a.empty(), !b.empty())) return;
    std::map<std::size_t, std::pair<MeasuredValue, MeasuredValue>> by_frame;
    for (const ReportedFactor& of_a : a) by_frame[of_a.frame].first = of_a.factor;
    for (const ReportedFactor& of_b : b) by_frame[of_b.frame].second = of_b.factor;
    for (const auto& [frame, factors] : by_frame)
      Add(group, "factor", "factor in frame " + std::to_string(frame), factors.first,
          factors.second);
  }

  // Whether both have something; if only one has, that is a difference.
  bool BothOrNeither(const std::string& group, const std::string& name, bool in_a, bool in_b) {
    if (in_a != in_b)
      comparison_.quantities.push_back(
          CompareEqual(group, name, in_a ? "there" : "none", in_b ? "there" : "none"));
    return in_a && in_b;
  }

  static MeasuredColour ColourOf(const ReportedLight& light) {
    MeasuredColour colour;
    for (std::size_t c = 0; c < colour.size(); ++c)
      colour[c] = {light.colour ? (*light.colour)[c] : 1.0, light.colour_sigma[c]};
    return colour;
  }

  void CompareColours(const std::string& group, const std::string& word, const std::string& name,
                      const MeasuredColour& a, const MeasuredColour& b) {
    for (std::size_t c = 0; c < a.size(); ++c)
      Add(group, word, name + ", " + kChannels[c], a[c], b[c]);
  }

  void CompareReflectance() {
    const std::string group = "reflectance";
    for (std::size_t c = 0; c < a_.albedo.size(); ++c)
      AddRelative(group, "albedo", std::string("albedo, ") + kChannels[c], a_.albedo[c],
                  b_.albedo[c]);
    AddRelative(group, "ambient", "ambient", a_.ambient, b_.ambient);
    AddRelative(group, "diffuse", "diffuse", a_.diffuse, b_.diffuse);
    AddRelative(group, "specular", "specular", a_.specular, b_.specular);
    Add(group, "shininess", "shininess", a_.shininess, b_.shininess);
    if (a_.alpha.value || b_.alpha.value) Add(group, "alpha", "alpha", a_.alpha, b_.alpha);
    if (a_.f0.value || b_.f0.value) Add(group, "f0", "F0", a_.f0, b_.f0);
    Add(group, "roughness_deg", "roughness", a_.roughness_deg, b_.roughness_deg);
    CompareSecondLobes(group);
    CompareHarmonics(group, "ambient_harmonics", "ambient harmonic", a_.ambient_harmonics,
                     b_.ambient_harmonics, true);
    CompareHarmonics(group, "diffuse_harmonics", "diffuse harmonic", a_.diffuse_harmonics,
                     b_.diffuse_harmonics, false);
    CompareOptionalColours(group, "ambient_color", "ambient colour", a_.ambient_colour,
                           b_.ambient_colour);
    CompareOptionalColours(group, "specular_color", "specular colour", a_.specular_colour,
                           b_.specular_colour);
    CompareColours(group, "ambient_product", "ambient product", a_.ambient_product,
                   b_.ambient_product);
  }

  void CompareSecondLobes(const std::string& group) {
    const auto& a = a_.second_lobe;
    const auto& b = b_.second_lobe;
    if (!BothOrNeither(group, "second lobe", a.has_value(), b.has_value())) return;
    comparison_.quantities.push_back(
        CompareEqual(group, "model of the second lobe", a->model, b->model));
    AddRelative(group, "specular", "specular of the second lobe", a->specular, b->specular);
    for (const auto& [word, name, of] :
         {std::tuple("shininess", "shininess", &ReportedLobe::shininess),
          {"alpha", "alpha", &ReportedLobe::alpha},
          {"f0", "F0", &ReportedLobe::f0}})
      if (((*a).*of).value || ((*b).*of).value)
        Add(group, word, std::string(name) + " of the second lobe", (*a).*of, (*b).*of);
  }

  // relative: they depend on the gauge.
  void CompareHarmonics(const std::string& group, const std::string& word, const std::string& name,
                        std::vector<MeasuredValue> a, std::vector<MeasuredValue> b, bool relative) {
    if (!BothOrNeither(group, name + "s", !a.empty(), !b.empty())) return;
    a.resize(std::max(a.size(), b.size()));
    b.resize(a.size());
    for (std::size_t j = 0; j < a.size(); ++j) {
      const std::string numbered = name + " " + std::to_string(j + 1);
      if (relative)
        AddRelative(group, word, numbered, a[j], b[j]);
      else
        Add(group, word, numbered, a[j], b[j]);
    }
  }

  void CompareOptionalColours(const std::string& group, const std::string& word,
                              const std::string& name, const std::optional<MeasuredColour>& a,
                              const std::optional<MeasuredColour>& b) {
    if (BothOrNeither(group, name, a.has_value(), b.has_value()))
      CompareColours(group, word, name, *a, *b);
  }

  const ReportedResult& a_;
  const ReportedResult& b_;
  const Tolerances& tolerances_;
  std::vector<std::optional<std::size_t>> partners_;
  bool same_gauge_ = true;
  Comparison comparison_;
};

}  // namespace

const std::vector<QuantityWord>& ResultQuantities() {
  static const std::vector<QuantityWord> kWords{
      {"direction_deg", {}},
      {"inverse_distance", {}},
      {"distance", {}},
      {"intensity", {}},
      {"factor", {}},
      {"light_color", {}},
      {"diffuse_product", {}},
      {"specular_product", {}},
      {"albedo", {}},
      {"ambient", {}},
      {"diffuse", {}},
      {"specular", {}},
      {"shininess", {}},
      {"alpha", {}},
      {"f0", {}},
      {"roughness_deg", {}},
      {"ambient_harmonics", {}},
      {"diffuse_harmonics", {.absolute = kDepartureTolerance}},
      {"ambient_color", {}},
      {"specular_color", {}},
      {"ambient_product", {}},
      {"rms", {.relative = kRmsTolerance}}};
  return kWords;
}

std::vector<std::optional<std::size_t>> PartnersByDirection(const std::vector<ReportedLight>& a,
                                                            const std::vector<ReportedLight>& b) {
  std::vector<std::optional<std::size_t>> partners(a.size());
  const bool a_is_shorter = a.size() <= b.size();
  const auto& rows = a_is_shorter ? a : b;
  const auto& columns = a_is_shorter ? b : a;
  Eigen::MatrixXd angles(rows.size(), columns.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < columns.size(); ++j)
      angles(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          AngleDeg(rows[i].direction, columns[j].direction);
  const std::vector<std::size_t> column_of = BestAssignment(angles);
  for (std::size_t i = 0; i < column_of.size(); ++i)
    (a_is_shorter ? partners[i] : partners[column_of[i]]) = a_is_shorter ? column_of[i] : i;
  return partners;
}

Comparison CompareResults(const ReportedResult& a, const ReportedResult& b,
                          const Tolerances& tolerances) {
  return ResultComparer(a, b, tolerances).Compare();
}

}  // namespace turnlight::estimator::results
