// Proves: every sigma that is null is in the list of those that the data do not determine, lobes'
// and colours' too, but for those that are null for another reason; and what is null whatever the
// sigmas are has its note. Does not prove where the list is said (result_json_test).
#include "estimator/results/null_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "estimator/results/result_json.h"
#include "tests/estimator/results/example_estimate.h"

namespace turnlight::estimator::results {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string ListOf(const Estimate& estimate) {
  return NullSigmas(estimate, nlohmann::ordered_json::parse(
                                  ResultToJson(estimate, "n", Method::kLeastSquares, {})));
}

std::vector<std::string> CodesOf(const std::vector<Note>& notes) {
  std::vector<std::string> codes;
  for (const Note& note : notes) codes.push_back(note.code);
  return codes;
}

TEST(NullSigmas, ThoseThatTheDataDoNotDetermine) {
  Estimate e = ExampleEstimate();
  EXPECT_EQ(ListOf(e), "");
  e.lights[1].direction_sigma = e.sigma.ambient = kNaN;
  e.sigma.lobes[0].shape.reset();
  EXPECT_EQ(ListOf(e),
            "lights/1/direction_sigma_deg, reflectance/sigma/ambient, reflectance/sigma/shininess");
  e.reflectance.lobes[0].model = model::SpecularModel::kNone;
  EXPECT_EQ(ListOf(e), "lights/1/direction_sigma_deg, reflectance/sigma/ambient");
}

TEST(NullSigmas, OfLobesAndColours) {
  Estimate e = ExampleEstimate();
  e.reflectance.lobes = {model::Lobe{model::SpecularModel::kGgx, 0.3, 0.2, 1.0},
                         model::Lobe{model::SpecularModel::kPhong, 0.1, 12.0}};
  e.sigma.lobes[0] = {0.01, 0.002, std::nullopt};
  e.sigma.lobes[1] = {0.01, 1.0, std::nullopt};
  // F0 was held.
  EXPECT_EQ(ListOf(e), "");
  e.sigma.lobes[0].shape.reset();
  e.sigma.lobes[1].strength = kNaN;
  e.stat.lobes[0].f0 = kNaN;
  EXPECT_EQ(ListOf(e),
            "reflectance/lobes/0/sigma/alpha, reflectance/lobes/0/sigma/f0, "
            "reflectance/lobes/1/sigma/specular");
  e = ExampleEstimate();
  e.reflectance.ambient_colour = {1.0, 0.8, 0.6};
  e.sigma.ambient_colour[1] = kNaN;
  EXPECT_EQ(ListOf(e), "reflectance/sigma/ambient_color/1");
}

TEST(NotesOnNulls, OfWhatIsNullByItsNature) {
  Estimate e = ExampleEstimate();
  EXPECT_THAT(CodesOf(NotesOnNulls(e)), ElementsAre("null-intensity-sigma"));
  e.lights[1].distance_min.reset();
  e.condition = std::numeric_limits<double>::infinity();
  EXPECT_THAT(CodesOf(NotesOnNulls(e)),
              ElementsAre("null-distance-min", "null-intensity-sigma", "null-condition"));
  e.lights.clear();
  e.condition = 10.0;
  EXPECT_THAT(NotesOnNulls(e), IsEmpty());
}

}  // namespace
}  // namespace turnlight::estimator::results
