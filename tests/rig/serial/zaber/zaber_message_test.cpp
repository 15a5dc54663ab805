// Proves: lines of the manual are read whatever their spaces, ids and checksums; a line with a
// wrong checksum or a missing part is none; commands carry the manual's checksum; what fails a
// frame does.
#include "rig/serial/zaber/zaber_message.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace turnlight::rig::serial::zaber {
namespace {

TEST(ZaberMessage, ChecksumIsTheManuals) {
  EXPECT_EQ(Checksum("1 cont 1 gggggggggg"), 0x84);
  EXPECT_EQ(FormatCommand(1, 1, 5, "get pos"), "/1 1 5 get pos:57\n");
  for (const int id : {0, 9, 99}) {
    const std::string line = FormatCommand(2, 0, id, "");
    const std::size_t colon = line.find(':');
    const int sent = std::stoi(line.substr(colon + 1), nullptr, 16);
    EXPECT_EQ((Checksum(line.substr(1, colon - 1)) - sent) % 256, 0) << line;
  }
}

TEST(ZaberMessage, ReadsRepliesWithAndWithoutIdAndChecksum) {
  const auto plain = ParseMessage("@01 1 OK IDLE -- 1234");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->kind, MessageKind::kReply);
  EXPECT_EQ(plain->device, 1);
  EXPECT_EQ(plain->axis, 1);
  EXPECT_FALSE(plain->id);
  EXPECT_FALSE(plain->rejected || plain->busy || plain->continues);
  EXPECT_EQ(plain->flag, "--");
  EXPECT_EQ(plain->data, "1234");

  const auto full = ParseMessage("@ 02  3 07 RJ  BUSY FS BADDATA ");
  ASSERT_TRUE(full);
  EXPECT_EQ(full->device, 2);
  EXPECT_EQ(full->axis, 3);
  EXPECT_EQ(full->id, 7);
  EXPECT_TRUE(full->rejected && full->busy);
  EXPECT_EQ(full->flag, "FS");
  EXPECT_EQ(full->data, "BADDATA");

  for (const char* ending : {":F2", ":f2 "})
    EXPECT_TRUE(ParseMessage(std::string("@01 1 OK IDLE -- 1234") + ending)) << ending;
  EXPECT_EQ(ParseMessage("@01 0 05 OK IDLE WR")->data, "");
}

TEST(ZaberMessage, TakesChecksumsOfEitherCase) {
  for (int id = 0; id < 100; ++id) {
    const std::string content =
        "01 1 " + std::string(id < 10 ? "0" : "") + std::to_string(id) + " OK IDLE -- 0";
    char upper[4], lower[4];
    std::snprintf(upper, sizeof upper, ":%02X", Checksum(content));
    std::snprintf(lower, sizeof lower, ":%02x", Checksum(content));
    EXPECT_TRUE(ParseMessage("@" + content + upper));
    EXPECT_TRUE(ParseMessage("@" + content + lower));
    EXPECT_EQ(ParseMessage("@" + content + upper)->data, "0");
  }
}

TEST(ZaberMessage, AnAlteredByteOfACheckedLineIsNoticed) {
  const std::string good = "@01 1 05 OK IDLE -- 1234:6D";
  ASSERT_TRUE(ParseMessage(good));
  for (std::size_t at = 1; at < good.size(); ++at)
    for (int bit = 0; bit < 7; ++bit) {
      std::string bad = good;
      bad[at] = static_cast<char>(bad[at] ^ (1 << bit));
      const auto message = ParseMessage(bad);
      // The other case of a digit is the same checksum; a colon that is gone leaves a line without
      // one, which says something else.
      if (message && message->data == "1234") {
        EXPECT_EQ(bad, "@01 1 05 OK IDLE -- 1234:6d");
      }
    }
}

TEST(ZaberMessage, ReadsAlertsAndInfo) {
  const auto alert = ParseMessage("!01 1 IDLE --");
  ASSERT_TRUE(alert);
  EXPECT_EQ(alert->kind, MessageKind::kAlert);
  EXPECT_EQ(alert->flag, "--");
  const auto info = ParseMessage("#01 0 cont of the rest\\");
  ASSERT_TRUE(info);
  EXPECT_EQ(info->kind, MessageKind::kInfo);
  EXPECT_EQ(info->data, "cont of the rest");
  EXPECT_TRUE(info->continues);
}

TEST(ZaberMessage, RefusesWhatIsNoLineOfTheProtocol) {
  for (const char* line : {"", "@", "ok", "@01", "@01 1", "@01 1 OK", "@01 1 OK IDLE",
                           "@01 1 OK STILL -- 0", "@01 1 YES IDLE -- 0", "@001 1 OK IDLE -- 0",
                           "@01 1 05 06 OK IDLE -- 0", "@01 1 OK IDLE --- 0",
                           "@01 1 OK IDLE -- 0:", "@01 1 OK IDLE -- 0:0", "@01 1 OK IDLE -- 0:00",
                           "@01 1 OK IDLE -- 0:G0", "!01 1 --", "@xx 1 OK IDLE -- 0", "1TS000032"})
    EXPECT_FALSE(ParseMessage(line)) << line;
}

TEST(ZaberMessage, FlagsMeanWhatTheManualSays) {
  EXPECT_EQ(MeaningOf("--"), FlagMeaning::kNone);
  for (const char* flag : {"FF", "FN", "FZ", "FH", "FV", "FO", "FC", "FM", "FD", "FQ", "FI", "FA",
                           "FR", "FS", "FB", "FP", "FE", "FT", "WL", "WS", "WM", "F?", "WX", "ZZ"})
    EXPECT_EQ(MeaningOf(flag), FlagMeaning::kFault) << flag;
  for (const char* flag : {"WR", "WH"}) EXPECT_EQ(MeaningOf(flag), FlagMeaning::kUnhomed);
  for (const char* flag : {"NC", "NI"}) EXPECT_EQ(MeaningOf(flag), FlagMeaning::kDisturbed);
  for (const char* flag : {"WV", "WT", "WP", "ND", "NR", "NT", "NU", "NJ", "NB"})
    EXPECT_EQ(MeaningOf(flag), FlagMeaning::kNotice) << flag;
  EXPECT_EQ(FlagInWords("FS"), "FS: stalled and stopped");
  EXPECT_EQ(FlagInWords("QQ"), "QQ");
  EXPECT_EQ(RejectionInWords("BADDATA"), "BADDATA: a value is missing or out of range");
}

}  // namespace
}  // namespace turnlight::rig::serial::zaber
