// Proves that the table of messages and docs/messages.md are the same, row by row, that ids are
// unique, that values come where their names stand, and that every row is said somewhere. Does not
// prove that a row is said when its condition holds: the tests of whoever says it make scenes for
// it, and docs/messages.md names them.
#include "base/messages/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/file.h"

namespace turnlight::messages {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string& Sources() {
  static const std::string all = [] {
    std::string text;
    for (const char* folder : {"app", "estimator", "rig"})
      for (const auto& entry :
           fs::recursive_directory_iterator(fs::path(TURNLIGHT_SOURCE_DIR) / folder))
        if (entry.path().extension() == ".cpp") text += ReadFile(entry.path()).value_or("");
    return text;
  }();
  return all;
}

std::string RowOfPage(const Row& row) {
  return std::string("| `") + row.id + "` | " + row.condition + " | " + row.words + " | " +
         row.todo + (*row.todo == '\0' ? "|\n" : " |\n");
}

TEST(Messages, ThePageIsTheTable) {
  const std::string page =
      ReadFile(fs::path(TURNLIGHT_SOURCE_DIR) / "docs/messages.md").value_or("");
  std::size_t rows = 0;
  for (std::size_t at = page.find("\n| `"); at != std::string::npos;
       at = page.find("\n| `", at + 1))
    ++rows;
  EXPECT_EQ(rows, Table().size());
  std::size_t from = 0;
  for (const Row& row : Table()) {
    const std::size_t at = page.find(RowOfPage(row));
    ASSERT_NE(at, std::string::npos) << "docs/messages.md lacks this row:\n" << RowOfPage(row);
    EXPECT_GE(at, from) << row.id << ": another order";
    from = at;
  }
}

TEST(Messages, IdsAreUniqueAndEachIsSaidSomewhere) {
  std::set<std::string> ids;
  for (const Row& row : Table()) {
    EXPECT_TRUE(ids.insert(row.id).second) << row.id;
    EXPECT_THAT(Sources(), HasSubstr("\"" + std::string(row.id) + "\""));
  }
}

TEST(Messages, ValuesComeWhereTheirNamesStand) {
  EXPECT_EQ(Text("count-uncertain/few-pixels", {{"pixels", "12"}, {"other", "x"}}),
            "Only 12 pixels are usable: they may not show every light; take more "
            "pictures, or move the camera closer.");
  EXPECT_EQ(CodeOf("count-uncertain/few-pixels"), "count-uncertain");
  EXPECT_EQ(CodeOf("grey"), "grey");
  const auto refused = Refuse("black", {{"bright", "0"}});
  EXPECT_EQ(refused.value().kind, ErrorKind::kNoEstimate);
  EXPECT_THAT(refused.value().text,
              HasSubstr("no usable estimate: every usable pixel is black (99.9 % at or below 0 of "
                        "white): check the lamp"));
}

}  // namespace
}  // namespace turnlight::messages
