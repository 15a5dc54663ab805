// Proves, in closed form: when a quantity is the same, with sigmas, tolerances, both or neither;
// what a tolerance file may say; what chance does to the largest of many. Does not prove that
// sigmas are right; the coverage studies do.
#include "base/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace turnlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;

ComparedQuantity Compared(const MeasuredValue& a, const MeasuredValue& b,
                          const Tolerance& tolerance = {}) {
  Tolerances tolerances;
  tolerances.quantities["x"] = tolerance;
  return CompareNumbers({.group = "g", .quantity = "x", .name = "x"}, a, b, tolerances);
}

TEST(Comparison, InSigmasOfBothSides) {
  // |10 - 22| / hypot(3, 4) = 2.4.
  const auto same = Compared({10.0, 3.0}, {22.0, 4.0});
  EXPECT_EQ(same.verdict, Verdict::kSame);
  EXPECT_DOUBLE_EQ(*same.difference, 12.0);
  EXPECT_DOUBLE_EQ(*same.sigmas, 2.4);
  EXPECT_DOUBLE_EQ(*same.sigmas_limit, 3.0);
  EXPECT_FALSE(same.allowed);
  const auto different = Compared({10.0, 3.0}, {26.0, 4.0});
  EXPECT_EQ(different.verdict, Verdict::kDifferent);
  EXPECT_THAT(different.why,
              AllOf(HasSubstr("differ by 16, 3.2 sigmas"), HasSubstr("allowed is 3 sigmas")));
}

TEST(Comparison, EitherOrBoth) {
  const MeasuredValue a{100.0, 1.0}, near{101.0, 1.0}, far{105.0, 1.0}, tight{100.5, 0.1};
  EXPECT_EQ(Compared(a, far, {.absolute = 6.0}).verdict, Verdict::kSame);
  EXPECT_EQ(Compared(a, far, {.absolute = 6.0, .both = true}).verdict, Verdict::kDifferent);
  EXPECT_EQ(Compared(a, near, {.absolute = 0.5}).verdict, Verdict::kSame);
  EXPECT_EQ(Compared(a, near, {.absolute = 0.5, .both = true}).verdict, Verdict::kDifferent);
  EXPECT_EQ(Compared(a, tight, {.absolute = 0.5, .both = true}).verdict, Verdict::kSame);
  EXPECT_EQ(Compared(a, far, {.sigmas = 4.0}).verdict, Verdict::kSame);
  const auto worded = Compared(a, far, {.absolute = 1.0, .both = true});
  EXPECT_THAT(worded.why, HasSubstr("allowed is 3 sigmas and 1"));
  EXPECT_THAT(Compared(a, far, {.absolute = 1.0}).why, HasSubstr("allowed is 3 sigmas or 1"));
}

TEST(Comparison, TheLargerOfAbsoluteAndRelative) {
  const Tolerance tolerance{.absolute = 2.0, .relative = 0.1};
  EXPECT_DOUBLE_EQ(*Compared({-100.0, {}}, {50.0, {}}, tolerance).allowed, 10.0);
  EXPECT_DOUBLE_EQ(*Compared({1.0, {}}, {2.0, {}}, tolerance).allowed, 2.0);
}

TEST(Comparison, WithoutASigmaAndAToleranceOnlyTheSameIsTheSame) {
  EXPECT_EQ(Compared({1.0, {}}, {1.0, 0.1}).verdict, Verdict::kSame);
  const auto different = Compared({1.0, {}}, {1.0 + 1e-12, 0.1});
  EXPECT_EQ(different.verdict, Verdict::kDifferent);
  EXPECT_FALSE(different.sigmas);
  EXPECT_THAT(different.why, HasSubstr("no sigma and no tolerance"));
  EXPECT_EQ(Compared({1.0, 0.0}, {2.0, 0.0}).verdict, Verdict::kDifferent);  // sigmas of a gauge
}

TEST(Comparison, NotKnown) {
  EXPECT_EQ(Compared({}, {}).verdict, Verdict::kSame);
  EXPECT_EQ(Compared({5.0, 1.0}, {}).why, "not known in B, known in A");
  EXPECT_EQ(Compared({}, {5.0, 1.0}).why, "not known in A, known in B");
  EXPECT_EQ(Compared({}, {5.0, 1.0}, {.absolute = 1e9}).verdict, Verdict::kDifferent);
}

TEST(Comparison, NotANumberIsNeverTheSame) {
  for (const bool both : {false, true})
    EXPECT_EQ(Compared({NAN, 1.0}, {1.0, 1.0}, {.absolute = 1e9, .both = both}).verdict,
              Verdict::kDifferent);
}

TEST(Comparison, TheLargestOfMany) {
  EXPECT_NEAR(ChanceOfLargest(3.0, 1), 0.0026998, 1e-7);
  EXPECT_NEAR(ChanceOfLargest(3.0, 40), 1.0 - std::pow(1.0 - 0.0026998, 40.0), 1e-6);
  EXPECT_NEAR(LimitOfLargest(3.0, 1), 3.0, 1e-9);
  for (const std::size_t count : {2U, 36U, 100000U})
    EXPECT_NEAR(ChanceOfLargest(LimitOfLargest(3.0, count), count), 0.0026998, 1e-6);
  EXPECT_NEAR(LimitOfLargest(3.0, 36), 3.96, 0.01);
  EXPECT_GE(LimitOfLargest(1e6, 10), 1e6);  // chance is 0 in numbers
}

const std::vector<QuantityWord> kWords{{"distance", {.relative = 0.5}}, {"albedo", {}}};

Result<Tolerances> Parsed(const std::string& text) {
  const auto document = ParseYaml(text, "t.yaml");
  if (!document) return Forward(document);
  return ReadTolerances(StrictObject(*document), kWords);
}

TEST(Tolerances, Defaults) {
  const auto tolerances = Parsed("{}");
  ASSERT_TRUE(tolerances);
  EXPECT_EQ(tolerances->Of("albedo").sigmas, 3.0);
  EXPECT_EQ(tolerances->Of("albedo").both, false);
  EXPECT_EQ(tolerances->Of("distance").relative, 0.5);
}

TEST(Tolerances, AWordStatesAllOfItsTolerance) {
  const auto tolerances = Parsed(
      "sigmas: 4\nrequire: both\ndistance: {absolute: 2}\nalbedo: {sigmas: 5, require: either}\n");
  ASSERT_TRUE(tolerances) << tolerances.error().text;
  EXPECT_EQ(tolerances->Of("distance").absolute, 2.0);
  EXPECT_FALSE(tolerances->Of("distance").relative);
  EXPECT_EQ(tolerances->Of("distance").sigmas, 4.0);
  EXPECT_EQ(tolerances->Of("distance").both, true);
  EXPECT_EQ(tolerances->Of("albedo").sigmas, 5.0);
  EXPECT_EQ(tolerances->Of("albedo").both, false);
}

TEST(Tolerances, Refusals) {
  const std::vector<std::pair<std::string, std::string>> bad{
      {"distanc: {absolute: 1}", "did you mean \"distance\"?"},
      {"distance: {absolut: 1}", "did you mean \"absolute\"?"},
      {"distance: {absolute: -1}", "distance/absolute: -1"},
      {"distance: 3", "distance"},
      {"distance: {}", "none of absolute, relative and sigmas is given"},
      {"distance: {require: both}", "none of absolute, relative and sigmas is given"},
      {"require: all", "either, both"},
      {"sigmas: .nan", "sigmas"}};
  for (const auto& [text, message] : bad) {
    const auto tolerances = Parsed(text);
    ASSERT_FALSE(tolerances) << text;
    EXPECT_THAT(tolerances.error().text, AllOf(HasSubstr("t.yaml"), HasSubstr(message)));
    EXPECT_EQ(tolerances.error().kind, ErrorKind::kInput);
  }
}

}  // namespace
}  // namespace turnlight
