// Proves that blocks are read by the rules and error numbers of GRBL 1.1, as far as a turntable
// needs them. Does not prove that what is left out (arcs, offsets, probing) behaves as there: it is
// refused.
#include "rig/sim/stage/gcode.h"

#include <gtest/gtest.h>

namespace turnlight::rig::sim::stage {
namespace {

GcodeBlock Read(const std::string& text, const GcodeModes& modes = {}, double position = 0.0) {
  const auto read = ReadGcode(text, modes, 'X', "XYZ", position);
  EXPECT_TRUE(std::holds_alternative<GcodeBlock>(read)) << text;
  return std::holds_alternative<GcodeBlock>(read) ? std::get<GcodeBlock>(read) : GcodeBlock{};
}

int ErrorOf(const std::string& text, const GcodeModes& modes = {}) {
  const auto read = ReadGcode(text, modes, 'X', "XYZ", 0.0);
  const auto* error = std::get_if<GrblError>(&read);
  return error ? static_cast<int>(*error) : 0;
}

TEST(Gcode, ReadsMovesWithTheirModes) {
  const GcodeBlock rapid = Read("G0X-12.5");
  EXPECT_EQ(rapid.target, -12.5);
  EXPECT_FALSE(rapid.feed);
  const GcodeBlock feed = Read("G21G90G94G1X120F1800");
  EXPECT_EQ(feed.target, 120.0);
  EXPECT_EQ(feed.feed, 1800.0);
  EXPECT_EQ(feed.modes.feed, 1800.0);
  EXPECT_EQ(Read("X3", feed.modes).feed, 1800.0);  // both are modal
  EXPECT_EQ(Read("G91X3", feed.modes, 10.0).target, 13.0);
  GcodeModes relative;
  relative.relative = true;
  EXPECT_EQ(Read("G53G0X3", relative, 10.0).target, 3.0);  // machine coordinates are absolute
  EXPECT_EQ(Read("G20G0X1").target, 25.4);
  EXPECT_EQ(Read("G0Y1").target, 0.0);  // another axis: this one stands
}

TEST(Gcode, InverseTimeFeedIsAShareOfAMinute) {
  // 90 degrees in 1/2 minute are 180 degrees a minute.
  const GcodeBlock block = Read("G93G1X100F2", {}, 10.0);
  EXPECT_EQ(block.feed, 180.0);
  EXPECT_EQ(ErrorOf("X20", block.modes), 22);  // F is needed in each
}

TEST(Gcode, ReadsDwellsAndTheSpindle) {
  EXPECT_EQ(Read("G4P0.25").dwell_s, 0.25);
  const GcodeBlock on = Read("M3S1000");
  EXPECT_TRUE(on.spindle_changes);
  EXPECT_EQ(on.modes.spindle, 3);
  EXPECT_EQ(on.modes.spindle_speed, 1000.0);
  EXPECT_FALSE(Read("M3S1000", on.modes).spindle_changes);
  EXPECT_FALSE(Read("G1F100").target);  // no axis word: no move
}

TEST(Gcode, RefusesByTheNumbersOfGrbl) {
  EXPECT_EQ(ErrorOf("10X"), 1);
  EXPECT_EQ(ErrorOf("G"), 2);
  EXPECT_EQ(ErrorOf("G0X1.2.3"), 2);
  EXPECT_EQ(ErrorOf("G1X1F-5"), 4);
  EXPECT_EQ(ErrorOf("G2X1"), 20);
  EXPECT_EQ(ErrorOf("G0B1"), 20);
  EXPECT_EQ(ErrorOf("M7"), 20);
  EXPECT_EQ(ErrorOf("G0G1X1F1"), 21);
  EXPECT_EQ(ErrorOf("M3M5"), 21);
  EXPECT_EQ(ErrorOf("G1X1"), 22);
  EXPECT_EQ(ErrorOf("M3.5"), 23);
  EXPECT_EQ(ErrorOf("G0X1X2"), 25);
  EXPECT_EQ(ErrorOf("G4"), 28);
  EXPECT_EQ(ErrorOf("G80X1"), 36);
  EXPECT_EQ(ErrorOf("G0X1P3"), 36);
}

}  // namespace
}  // namespace turnlight::rig::sim::stage
