// Proves: replies of the manual are read whatever their case and spaces; a state is six hexadecimal
// digits and nothing else; codes are told in the manual's words.
#include "rig/serial/smc100/smc100_message.h"

#include <gtest/gtest.h>

#include <clocale>

namespace turnlight::rig::serial::smc100 {
namespace {

TEST(Smc100Message, ReadsReplies) {
  const auto position = ParseReply("1TP-0.123");
  ASSERT_TRUE(position);
  EXPECT_EQ(position->address, 1);
  EXPECT_EQ(position->command, "TP");
  EXPECT_EQ(position->value, "-0.123");
  const auto version = ParseReply(" 31 ve  SMC100PP 1.0 ");
  ASSERT_TRUE(version);
  EXPECT_EQ(version->address, 31);
  EXPECT_EQ(version->command, "VE");
  EXPECT_EQ(version->value, "SMC100PP 1.0");
  EXPECT_EQ(ParseReply("01TS000032")->value, "000032");
  EXPECT_EQ(ParseReply("1TE@")->value, "@");
  for (const char* line : {"", "1", "1T", "TS000032", "0TS000032", "32TS000032", "1 2TS", "ok",
                           "99999999999TS000032", "-1TS000032", "1?S"})
    EXPECT_FALSE(ParseReply(line)) << line;
}

TEST(Smc100Message, ReadsNumbersStrictly) {
  EXPECT_EQ(ParseValue("12.5"), 12.5);
  EXPECT_EQ(ParseValue("+ 1 2.5"), 12.5);
  EXPECT_EQ(ParseValue("-1.5E-1"), -0.15);
  for (const char* text : {"", "x", "12.5x", "1,5", "nan", "inf", "1e999", "--1"})
    EXPECT_FALSE(ParseValue(text)) << text;
}

TEST(Smc100Message, WritesAnglesAsTheControllerReadsThem) {
  EXPECT_EQ(FormatAngle(12.5), "12.50000");
  EXPECT_EQ(FormatAngle(-0.000001), "0.00000");
  EXPECT_EQ(FormatAngle(-370.123456), "-370.12346");
  EXPECT_EQ(FormatAngle(1e300).size(), 307u);
}

TEST(Smc100Message, ReadsStatesOfSixDigits) {
  const auto state = ParseState("002A3e");
  ASSERT_TRUE(state);
  EXPECT_EQ(state->errors, 0x2au);
  EXPECT_EQ(state->state, 0x3eu);
  for (const char* text : {"", "00032", "0000320", "00 032", "00003G", "+00032", "0x0032"})
    EXPECT_FALSE(ParseState(text)) << text;
}

TEST(Smc100Message, OnlyFourStatesAreReady) {
  int ready = 0;
  for (unsigned state = 0; state < 256; ++state) ready += KindOf(state) == StateKind::kReady;
  EXPECT_EQ(ready, 4);
  for (unsigned state = 0x32; state <= 0x35; ++state) EXPECT_EQ(KindOf(state), StateKind::kReady);
  for (unsigned state = 0x0a; state <= 0x11; ++state)
    EXPECT_EQ(KindOf(state), StateKind::kUnreferenced);
  EXPECT_EQ(KindOf(0x14), StateKind::kConfiguration);
  EXPECT_EQ(KindOf(0x1e), StateKind::kHoming);
  EXPECT_EQ(KindOf(0x1f), StateKind::kHoming);
  EXPECT_EQ(KindOf(0x28), StateKind::kMoving);
  for (unsigned state = 0x3c; state <= 0x3e; ++state)
    EXPECT_EQ(KindOf(state), StateKind::kDisabled);
  for (const unsigned state :
       {0x00u, 0x09u, 0x12u, 0x27u, 0x29u, 0x31u, 0x36u, 0x46u, 0x47u, 0xffu})
    EXPECT_EQ(KindOf(state), StateKind::kOther) << state;
}

TEST(Smc100Message, TellsCodesInWords) {
  EXPECT_EQ(StateInWords(0x33), "33, READY from MOVING");
  EXPECT_EQ(StateInWords(0x99), "99, not in the manual");
  EXPECT_EQ(ErrorsInWords(0x0060), "following error, homing time-out");
  EXPECT_EQ(ErrorsInWords(0x8001), "negative end of run, error bit 15");
  EXPECT_EQ(ErrorsInWords(0), "");
  EXPECT_EQ(CommandErrorInWords('G'), "G, displacement out of limits");
  EXPECT_EQ(CommandErrorInWords('q'), "q, not in the manual");
  EXPECT_TRUE(IsLinearStage("tra25cc"));
  for (const char* name : {"URS100BCC", "PR50PP", "AG-PR100P", "SR50CC", "RGV100BL", ""})
    EXPECT_FALSE(IsLinearStage(name)) << name;
}

}  // namespace
}  // namespace turnlight::rig::serial::smc100
