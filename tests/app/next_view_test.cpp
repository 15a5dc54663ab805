// Proves of `estimate --next-view`: it says which view to take and what to expect, on standard
// output and in result.json; with --wanted-deg how many; nothing else in the result changes, and
// without it nothing at all; where there is no forecast it says why. Does not prove that the
// predictions hold (tests/estimator/next_view_test.cpp).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

class NextView : public testing::Test {
 protected:
  void SetUp() override {
    rig::sim::SyntheticConfig config = SmallConfig();
    config.sensor.noise_relative = 0.003;
    WriteSession(config, folder_ / "s");
  }
  Outcome Estimate(const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words{"estimate", folder_ / "s", "--no-pictures", "--out",
                                   folder_ / out};
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(words);
  }
  ordered_json Result(const std::string& out) {
    return ordered_json::parse(ReadText(folder_ / (out + "/result.json")));
  }
  TemporaryFolder folder_;
};

TEST_F(NextView, IsToldAndChangesNothingElse) {
  ASSERT_EQ(Estimate("plain", {}).exit_code, 0);
  const Outcome outcome = Estimate("asked", {"--next-view"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ordered_json plain = Result("plain"), asked = Result("asked");
  EXPECT_FALSE(plain.contains("next_view"));
  const ordered_json next = asked["next_view"];
  EXPECT_EQ(next["light"], 0);
  EXPECT_NEAR(next["direction_sigma_deg"].get<double>(),
              asked["lights"][0]["direction_sigma_deg"].get<double>(), 1e-9);
  EXPECT_LT(next["view"]["direction_sigma_deg"], next["direction_sigma_deg"]);
  EXPECT_GE(next["view"]["direction_sigma_deg"], next["floor_sigma_deg"]);
  EXPECT_TRUE(next["view"]["angle_deg"].is_number());
  EXPECT_TRUE(next["wanted_deg"].is_null());
  EXPECT_TRUE(next["further_views"].is_null());
  EXPECT_THAT(outcome.out, HasSubstr("next view\n  " + next["words"].get<std::string>()));
  asked.erase("next_view");
  for (ordered_json* json : {&plain, &asked}) json->erase("time_s");
  EXPECT_EQ(plain.dump(), asked.dump());
}

TEST_F(NextView, SaysHowManyViewsItTakes) {
  ASSERT_EQ(Estimate("plain", {"--next-view"}).exit_code, 0);
  const ordered_json plain = Result("plain")["next_view"];
  const double now = plain["direction_sigma_deg"], one = plain["view"]["direction_sigma_deg"];
  ASSERT_EQ(
      Estimate("one", {"--next-view", "--wanted-deg", std::to_string(0.5 * (now + one))}).exit_code,
      0);
  EXPECT_EQ(Result("one")["next_view"]["further_views"], 1);
  ASSERT_EQ(Estimate("none", {"--next-view", "--wanted-deg", std::to_string(2.0 * now)}).exit_code,
            0);
  EXPECT_EQ(Result("none")["next_view"]["further_views"], 0);
  const Outcome never = Estimate("never", {"--next-view", "--wanted-deg", "1e-5"});
  EXPECT_TRUE(Result("never")["next_view"]["further_views"].is_null());
  EXPECT_THAT(never.out, HasSubstr("out of reach"));
}

TEST_F(NextView, SaysWhyThereIsNone) {
  const Outcome outcome = Estimate("paper", {"--method", "paper", "--next-view"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("cannot be predicted: the method states no sigmas"));
  EXPECT_TRUE(Result("paper")["next_view"]["view"].is_null());
  const Outcome alone = Estimate("alone", {"--wanted-deg", "0.1"});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.err, HasSubstr("--next-view"));
}

}  // namespace
}  // namespace turnlight::app
