// Proves: whatever bytes a text has, nothing in it steers a terminal, forges a line or turns the
// direction of writing once it is printable, all else stays, and JSON keeps its meaning. Does not
// prove: that the program uses it; tests/app/printable_output_test.cpp does.
#include "base/printable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

namespace turnlight {
namespace {

TEST(Printable, PlainTextStays) {
  for (const std::string text :
       {"", "frames/000.png", "Größe ± 0.1°\t→ 三脚 \xf0\x9f\x92\xa1", "a\\b"})
    EXPECT_EQ(Printable(text), text);
}

TEST(Printable, ControlCharactersAreShown) {
  EXPECT_EQ(Printable("a\x1b[31mb\x07"), "a\\u001b[31mb\\u0007");
  EXPECT_EQ(Printable(std::string("a\0b", 3)), "a\\u0000b");
  EXPECT_EQ(Printable("a\x7f"), "a\\u007f");
  EXPECT_EQ(Printable("a\xc2\x9b"
                      "31m"),
            "a\\u009b31m");
  EXPECT_EQ(Printable("a\xe2\x80\xae"
                      "b\xe2\x81\xa6\xe2\x80\xa8"),
            "a\\u202eb\\u2066\\u2028");
  EXPECT_EQ(Printable("a\r\nturnlight: good"), "a\\r\\nturnlight: good");
  EXPECT_EQ(Printable("a\r\nb\n", Newlines::kKept), "a\\r\nb\n");
}

TEST(Printable, BytesThatAreNoUtf8AreShown) {
  EXPECT_EQ(Printable("\x9b\xff"), "\\x9b\\xff");
  EXPECT_EQ(Printable("a\xe2\x82"), "a\\xe2\\x82");                           // cut short
  EXPECT_EQ(Printable("\xc0\x9b\xe0\x80\x9b"), "\\xc0\\x9b\\xe0\\x80\\x9b");  // overlong
  EXPECT_EQ(Printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");                    // surrogate
  EXPECT_EQ(Printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");           // beyond Unicode
}

TEST(Printable, AnyBytes) {
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    std::string text(random() % 12, '\0');
    for (char& c : text) c = static_cast<char>(random() % 4 == 0 ? 0xe2 : random());
    const std::string shown = Printable(text);
    EXPECT_EQ(Printable(shown), shown);
    for (const char c : shown) EXPECT_FALSE(static_cast<unsigned char>(c) < 0x20 && c != '\t');
    EXPECT_NO_THROW(nlohmann::json(shown).dump());  // is UTF-8
  }
}

TEST(Printable, JsonKeepsItsMeaning) {
  const nlohmann::json json = {{"name", "a\x1b[2J\x7f\xc2\x9b\xe2\x80\xae\n\"b\""}};
  const std::string shown = Printable(json.dump(1), Newlines::kKept);
  EXPECT_EQ(nlohmann::json::parse(shown), json);
  for (const char* bad : {"\x1b", "\x7f", "\xc2\x9b", "\xe2\x80\xae"})
    EXPECT_EQ(shown.find(bad), std::string::npos);
}

TEST(Printable, BegunCharacters) {
  const std::string four = "\xf0\x9f\x92\xa1";
  for (std::size_t i = 0; i <= 4; ++i) EXPECT_EQ(IncompleteBytes("ab" + four.substr(0, i)), i % 4);
  EXPECT_EQ(IncompleteBytes("\x9b\x9b\x9b\x9b"), 0u);
  EXPECT_EQ(IncompleteBytes("\xff"), 0u);
  EXPECT_EQ(IncompleteBytes(""), 0u);
}

}  // namespace
}  // namespace turnlight
