// Proves: every check of the list is run and named, in order, and told at once; a raised flag ends
// the examination; a device section that its driver refuses is refused. Does not prove: the checks;
// the tests beside this one do.
#include "app/doctor/doctor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/app/doctor/patient_of.h"

namespace turnlight::app {
namespace {

TEST(Doctor, RunsEveryCheckOnce) {
  PatientOf rig("capture: {settle_ms: 1}\n" + std::string(kFakeRig));
  std::vector<std::string> told;
  const auto checks =
      Examine(rig.patient, [&told](const Check& check) { told.push_back(check.name); });
  ASSERT_TRUE(checks) << checks.error().text;
  ASSERT_EQ(told.size(), checks->size());
  EXPECT_EQ(std::set<std::string>(told.begin(), told.end()).size(), told.size());
  for (const Check& check : *checks) {
    EXPECT_NE(check.verdict, Verdict::kFailed) << check.name << ": " << check.figure;
    EXPECT_FALSE(check.figure.empty()) << check.name;
  }
  EXPECT_EQ(told.front(), "config");
  EXPECT_EQ(told.back(), "once around");
}

TEST(Doctor, EndsWhenAskedTo) {
  PatientOf rig(kFakeRig);
  StopFlag stop{false};
  rig.patient.stop = &stop;
  const auto checks =
      Examine(rig.patient, [&stop](const Check& check) { stop = check.name == "controller"; });
  ASSERT_FALSE(checks);
  EXPECT_EQ(checks.error().kind, ErrorKind::kInterrupted);
  EXPECT_TRUE(rig.fakes.table->moves.empty());
}

TEST(Doctor, AConfigThatADriverRefuses) {
  PatientOf rig("rig: {table: {driver: fake, speed: 3}}\n");
  const auto checks = Examine(rig.patient, [](const Check&) {});
  ASSERT_FALSE(checks);
  EXPECT_EQ(checks.error().kind, ErrorKind::kInput);
}

}  // namespace
}  // namespace turnlight::app
