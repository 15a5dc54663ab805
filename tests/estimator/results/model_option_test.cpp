// Proves: --model takes each key and value that its header names, changes nothing else, and refuses
// the rest with the key, the value and what is allowed. Does not prove that the estimator does what
// it is told: tests/estimator/model_choice_test does.
#include "estimator/results/model_option.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight::estimator::results {
namespace {

using model::DiffuseModel;
using model::ModelChoice;
using model::SpecularModel;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

ModelChoice Chosen(const std::string& option) {
  ModelChoice choice;
  const Status status = ApplyModelOption(option, choice);
  EXPECT_TRUE(status) << status.error().text;
  return choice;
}

std::string Refusal(const std::string& option) {
  ModelChoice choice;
  const Status status = ApplyModelOption(option, choice);
  EXPECT_FALSE(choice.lights || choice.diffuse || choice.specular || choice.near) << option;
  if (status) return "accepted";
  EXPECT_EQ(status.error().kind, ErrorKind::kInput) << option;
  return status.error().text;
}

TEST(ModelOption, EachValueIsTaken) {
  EXPECT_EQ(Chosen("lights=1").lights, 1);
  EXPECT_EQ(Chosen("lights=2").lights, 2);
  EXPECT_EQ(Chosen("lights=32").lights, 32);
  EXPECT_EQ(Chosen("diffuse=lambert").diffuse, DiffuseModel::kLambert);
  EXPECT_EQ(Chosen("diffuse=oren-nayar").diffuse, DiffuseModel::kOrenNayar);
  EXPECT_EQ(Chosen("specular=none").specular, SpecularModel::kNone);
  EXPECT_EQ(Chosen("specular=phong").specular, SpecularModel::kPhong);
  EXPECT_EQ(Chosen("specular=blinn-phong").specular, SpecularModel::kBlinnPhong);
  EXPECT_EQ(Chosen("diffuse=coated").diffuse, DiffuseModel::kCoated);
  EXPECT_EQ(Chosen("specular=beckmann").specular, SpecularModel::kBeckmann);
  EXPECT_EQ(Chosen("specular=ggx").specular, SpecularModel::kGgx);
  EXPECT_EQ(Chosen("color=free").coloured, true);
  EXPECT_EQ(Chosen("color=white").coloured, false);
  EXPECT_EQ(Chosen("lobes=2").lobes, 2);
  EXPECT_EQ(Chosen("white=2").white, 2);
  EXPECT_EQ(Chosen("intensity=per-frame").changing, true);
  EXPECT_EQ(Chosen("intensity=constant").changing, false);
  EXPECT_EQ(Chosen("ambient=harmonics").harmonics, true);
  EXPECT_EQ(Chosen("ambient=constant").harmonics, false);
  EXPECT_EQ(Chosen("lights-are=near").near, true);
  EXPECT_EQ(Chosen("lights-are=distant").near, false);
}

TEST(ModelOption, ADistanceIsARangeOrKnownToAThousandth) {
  const ModelChoice range = Chosen("distance=1300..1500.5");
  ASSERT_TRUE(range.distance.known());
  EXPECT_EQ(range.distance.least, 1300.0);
  EXPECT_EQ(range.distance.most, 1500.5);
  EXPECT_EQ(range.near, true);
  const ModelChoice one = Chosen("distance=2e3");
  ASSERT_TRUE(one.distance.known());
  EXPECT_NEAR(one.distance.least, 1998.0, 1e-9);
  EXPECT_NEAR(one.distance.most, 2002.0, 1e-9);
  for (const char* const word :
       {"", "0", "-5", "1500..1300", "1300..1300", "1300..", "..1500", "far", "1300-1500",
        "1..2..3", "nan", "1..inf", "0..5", "13 .. 15"})
    EXPECT_THAT(Refusal(std::string("distance=") + word),
                AllOf(HasSubstr(std::string("\"") + word + "\""), HasSubstr("as 1300..1500")));
}

TEST(ModelOption, AKnownDistanceIsNotDistant) {
  ModelChoice choice = Chosen("distance=5");
  EXPECT_FALSE(ApplyModelOption("lights-are=distant", choice));
  EXPECT_EQ(choice.near, true);
  EXPECT_TRUE(ApplyModelOption("lights-are=near", choice));
  choice = Chosen("lights-are=distant");
  const Status status = ApplyModelOption("distance=5", choice);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, HasSubstr("lights-are=distant"));
  EXPECT_FALSE(choice.distance.known());
}

TEST(ModelOption, TheRestIsLeftToTheData) {
  const ModelChoice lights = Chosen("lights=3");
  EXPECT_FALSE(lights.diffuse || lights.specular || lights.near);
  const ModelChoice near = Chosen("lights-are=distant");
  EXPECT_TRUE(near.near.has_value());
  EXPECT_FALSE(near.lights || near.diffuse || near.specular);
}

TEST(ModelOption, SeveralAddUpAndTheLastOfAKeyCounts) {
  ModelChoice choice;
  for (const char* option : {"lights=2", "specular=none", "lights=4"})
    ASSERT_TRUE(ApplyModelOption(option, choice));
  EXPECT_EQ(choice.lights, 4);
  EXPECT_EQ(choice.specular, SpecularModel::kNone);
  ASSERT_FALSE(ApplyModelOption("lights=40", choice));
  EXPECT_EQ(choice.lights, 4);
}

TEST(ModelOption, ARefusedValueNamesKeyValueAndWhatIsAllowed) {
  for (const char* word : {"0", "33", "-1", "two", "2.5", "2x", " 2", "+2", "", "99999999999999"})
    EXPECT_THAT(Refusal("lights=" + std::string(word)),
                AllOf(HasSubstr("--model lights=" + std::string(word)),
                      HasSubstr("\"" + std::string(word) + "\""), HasSubstr("1 to 32")));
  EXPECT_THAT(Refusal("diffuse=lambertian"),
              AllOf(HasSubstr("--model diffuse=lambertian"), HasSubstr("\"lambertian\""),
                    HasSubstr("allowed are lambert, oren-nayar, coated")));
  EXPECT_THAT(Refusal("specular=blinn"),
              AllOf(HasSubstr("--model specular=blinn"), HasSubstr("\"blinn\""),
                    HasSubstr("allowed are none, phong, blinn-phong, beckmann, ggx")));
  EXPECT_THAT(Refusal("lights-are=close"),
              AllOf(HasSubstr("--model lights-are=close"), HasSubstr("\"close\""),
                    HasSubstr("allowed are near, distant")));
  EXPECT_THAT(Refusal("specular"), HasSubstr("allowed are none, phong, blinn-phong"));
  EXPECT_THAT(Refusal("specular=Phong"), HasSubstr("\"Phong\""));
}

TEST(ModelOption, ARefusedKeyNamesTheNearestAndWhatIsAllowed) {
  EXPECT_THAT(Refusal("light=2"),
              AllOf(HasSubstr("--model light=2"), HasSubstr("unknown key \"light\""),
                    HasSubstr("did you mean \"lights\"?"),
                    HasSubstr("allowed are lights, diffuse, specular, lobes, lights-are")));
  EXPECT_THAT(Refusal("difuse=lambert"), HasSubstr("did you mean \"diffuse\"?"));
  EXPECT_THAT(Refusal("speculer=none"), HasSubstr("did you mean \"specular\"?"));
  EXPECT_THAT(Refusal("lights_are=near"), HasSubstr("did you mean \"lights-are\"?"));
  EXPECT_THAT(Refusal("colour=free"), HasSubstr("did you mean \"color\"?"));
  EXPECT_THAT(Refusal("color=red"), HasSubstr("allowed are free, white"));
  EXPECT_THAT(
      Refusal("weight=2"),
      AllOf(
          HasSubstr("unknown key \"weight\""), Not(HasSubstr("did you mean")),
          HasSubstr("allowed are lights, diffuse, specular, lobes, lights-are, distance, color")));
  EXPECT_THAT(Refusal(""), HasSubstr("unknown key \"\""));
}

}  // namespace
}  // namespace turnlight::estimator::results
