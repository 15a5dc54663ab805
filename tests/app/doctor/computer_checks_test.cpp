// Proves: a disk that is too slow or too full for the plan is told, against what the plan needs;
// the trial leaves nothing behind; a time of day that is not synchronised is a warning. Does not
// prove: how fast this disk is.
#include "app/doctor/computer_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/doctor/patient_of.h"

namespace turnlight::app {
namespace {

using testing::HasSubstr;

constexpr DiskNeed kNeed{10e6, 2.0, 1e9};

TEST(ComputerChecks, DiskSpeed) {
  EXPECT_EQ(JudgeDiskSpeed(1e6, std::nullopt).verdict, Verdict::kOk);
  EXPECT_EQ(JudgeDiskSpeed(100e6, kNeed).verdict, Verdict::kOk);
  EXPECT_EQ(JudgeDiskSpeed(7e6, kNeed).verdict, Verdict::kWarning);
  const auto slow = JudgeDiskSpeed(2e6, kNeed);
  EXPECT_EQ(slow.verdict, Verdict::kWarning);
  EXPECT_THAT(slow.figure, HasSubstr("2 MB/s, synced: 5 s for a frame of at most 10 MB, of which "
                                     "one comes in 2 s: the table will wait"));
}

TEST(ComputerChecks, FreeSpace) {
  EXPECT_EQ(JudgeFreeSpace(5e9, kNeed).verdict, Verdict::kOk);
  EXPECT_EQ(JudgeFreeSpace(1.5e9, kNeed).verdict, Verdict::kWarning);
  EXPECT_EQ(JudgeFreeSpace(0.5e9, kNeed).verdict, Verdict::kFailed);
}

TEST(ComputerChecks, Clocks) {
  PatientOf rig(kFakeRig);
  EXPECT_NE(CheckSteadyClock(rig.patient).verdict, Verdict::kFailed);
  EXPECT_EQ(JudgeTimeOfDay(true, 0.01).verdict, Verdict::kOk);
  EXPECT_EQ(JudgeTimeOfDay(false, 16.0).verdict, Verdict::kWarning);
  EXPECT_NE(CheckTimeOfDay(rig.patient).verdict, Verdict::kFailed);
}

TEST(ComputerChecks, TheTrialLeavesNothing) {
  PatientOf rig(kFakeRig);
  rig.patient.options.out = rig.folder.path() / "runs/today";  // not there yet
  EXPECT_THAT(CheckDiskSpeed(rig.patient).figure, HasSubstr("MB/s, synced"));
  EXPECT_THAT(CheckFreeSpace(rig.patient).figure, HasSubstr("GB free, the plan needs at most"));
  for (const auto& file : std::filesystem::directory_iterator(rig.folder.path()))
    EXPECT_EQ(file.path().filename(), "c.yaml");
}

}  // namespace
}  // namespace turnlight::app
