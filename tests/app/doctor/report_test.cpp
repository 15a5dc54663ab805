// Proves: the table is aligned and says what to do, JSON and JUnit say the same of every check,
// whatever bytes a device speaks. Does not prove: the verdicts.
#include "app/doctor/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace turnlight::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<Check> SomeChecks() {
  std::vector<Check> checks{Fine("all well"), Warning("half\nwell", "look"),
                            Failed("bad <\xff>", "mend"), Skipped("none")};
  for (std::size_t i = 0; i < checks.size(); ++i) checks[i].name = "check " + std::to_string(i);
  return checks;
}

TEST(DoctorReport, ForAPerson) {
  const auto checks = SomeChecks();
  EXPECT_EQ(CheckText(checks[0]), "ok       check 0                 all well\n");
  EXPECT_EQ(CheckText(checks[1]),
            "warning  check 1                 half\n"
            "                                 well\n"
            "                                 -> look\n");
  EXPECT_EQ(CountText(checks), "4 checks: 1 ok, 1 warnings, 1 failed, 1 skipped\n");
  EXPECT_TRUE(AnyFailed(checks));
  EXPECT_FALSE(AnyFailed({Warning("", "")}));
}

TEST(DoctorReport, ForPrograms) {
  const auto json = nlohmann::json::parse(ChecksJson("rig.yaml", SomeChecks()));
  EXPECT_EQ(json["config"], "rig.yaml");
  EXPECT_EQ(json["failed"], 1);
  EXPECT_EQ(json["checks"][1]["verdict"], "warning");
  EXPECT_EQ(json["checks"][1]["advice"], "look");
  EXPECT_THAT(ChecksJunit(SomeChecks()),
              AllOf(HasSubstr("tests=\"4\" failures=\"1\""), HasSubstr("skipped=\"1\""),
                    HasSubstr("warning: half"), HasSubstr("bad &lt;")));
}

}  // namespace
}  // namespace turnlight::app
