// Proves that the summary gives each value of an estimate the digits that its sigma allows, and
// says model, lights, decisions and notes. Does not prove that the values are right.
#include "app/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "tests/estimator/results/example_estimate.h"

namespace turnlight::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Summary, RoundsToTheSigma) {
  EXPECT_EQ(Measure(700.1234, 1.24), "700.1 \u00b1 1.2");
  EXPECT_EQ(Measure(0.123456, 0.00045), "0.12346 \u00b1 0.00045");
  EXPECT_EQ(Measure(1234.5, 56.0), "1234 \u00b1 56");
  EXPECT_EQ(Measure(0.5, 0.0), "0.5");
  EXPECT_EQ(Measure(0.5, std::numeric_limits<double>::infinity()), "0.5");
}

TEST(Summary, SaysWhatWasFound) {
  const std::string text = Summary(estimator::results::ExampleEstimate(), "ball", "mm");
  EXPECT_THAT(text, HasSubstr("ball: 36 views, 4321 pixels"));
  EXPECT_THAT(text, HasSubstr("2 lights (1 near, 1 distant), Lambert + Phong"));
  EXPECT_THAT(text, HasSubstr("distance 700.0 \u00b1 1.2 mm"));
  EXPECT_THAT(text, HasSubstr("beyond 9e+03 mm, 95 %"));
  EXPECT_THAT(text, HasSubstr("shininess 40.00 \u00b1 0.40"));
  EXPECT_THAT(text, HasSubstr("one more light: it explains"));
  EXPECT_THAT(text, HasSubstr("views-add-nothing"));
}

TEST(Summary, SaysWhatChangesAndWhatIsUneven) {
  estimator::Estimate estimate = estimator::results::ExampleEstimate();
  EXPECT_THAT(Summary(estimate, "ball", "mm"), Not(HasSubstr("changes from frame")));
  estimate.lights[0].light.factors = {0.95, 1.02, 1.03};
  estimate.reflectance.harmonics[2] = 0.03;
  const std::string text = Summary(estimate, "ball", "mm");
  EXPECT_THAT(text, HasSubstr("changes from frame to frame, 0.95 to 1.03"));
  EXPECT_THAT(text, HasSubstr("0.03 rms that depends on the side"));
}

TEST(Summary, WhatIsNotKnownHasNoNumber) {
  estimator::Estimate estimate = estimator::results::ExampleEstimate();
  estimate.sigma.diffuse = 0.083;
  estimate.sigma.lobes[0].shape = std::nullopt;
  estimate.undetermined = {"reflectance/diffuse", "reflectance/shininess", "lights/0/distance"};
  const std::string text = Summary(estimate, "ball", "mm");
  EXPECT_THAT(text, HasSubstr("diffuse     not known (sigma 0.083)"));
  EXPECT_THAT(text, HasSubstr("shininess not known\n"));
  EXPECT_THAT(text, HasSubstr("near, distance not known"));
}

}  // namespace
}  // namespace turnlight::app
