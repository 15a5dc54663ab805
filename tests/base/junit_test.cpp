// Proves: an XML reader that is not ours finds in the file what was put in, whatever the text, and
// the counts are those of the cases. Does not prove that every CI system shows it well.
#include "base/junit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/file.h"
#include "tests/temporary_folder.h"

namespace turnlight {
namespace {

using testing::HasSubstr;
using testing::Not;

// What python3's XML reader finds: a line for each case, and one for the suite's counts.
std::string ReadByPython(const std::string& xml) {
  const TemporaryFolder folder;
  EXPECT_TRUE(WriteFileAtomic(folder.path() / "junit.xml", xml));
  const std::string script =
      "import sys, xml.etree.ElementTree as tree\n"
      "suite = tree.parse(sys.argv[1]).getroot().find('testsuite')\n"
      "print(*(suite.get(key) for key in ('name', 'tests', 'failures', 'errors', 'skipped')), "
      "sep='|')\n"
      "for case in suite.findall('testcase'):\n"
      "    inner = list(case)\n"
      "    print(ascii(case.get('classname')), ascii(case.get('name')), *(element.tag + ' ' + "
      "ascii(element.text or element.get('message')) for element in inner), sep='|')\n";
  EXPECT_TRUE(WriteFileAtomic(folder.path() / "read.py", script));
  const std::string command = "python3 '" + (folder / "read.py") + "' '" + (folder / "junit.xml") +
                              "' > '" + (folder / "out") + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << xml;
  return ReadFile(folder.path() / "out").value_or("");
}

TEST(Junit, OutcomesAndCounts) {
  const std::string found = ReadByPython(
      JunitXml("all of it", {{"results.light 1", "distance", JunitOutcome::kFailed, "5 of 3"},
                             {"results.light 1", "direction", JunitOutcome::kPassed, ""},
                             {"serial", "firmware", JunitOutcome::kPassed, "1.1h"},
                             {"results", "intensity", JunitOutcome::kSkipped, "not judged"}}));
  EXPECT_EQ(found,
            "all of it|4|1|0|1\n"
            "'results.light 1'|'distance'|failure '5 of 3'\n"
            "'results.light 1'|'direction'\n"
            "'serial'|'firmware'|system-out '1.1h'\n"
            "'results'|'intensity'|skipped 'not judged'\n");
}

TEST(Junit, NoCases) { EXPECT_EQ(ReadByPython(JunitXml("none", {})), "none|0|0|0|0\n"); }

TEST(Junit, AnyTextComesThrough) {
  const std::string xml =
      JunitXml("a \"b\" & <c>", {{"<&>", "quote \" and ' and ]]>", JunitOutcome::kFailed,
                                  "two\nlines, 30\xC2\xB0, \xF0\x9F\x92\xA1"}});
  const std::string found = ReadByPython(xml);
  EXPECT_THAT(found, HasSubstr("a \"b\" & <c>|1|1"));
  EXPECT_THAT(found, HasSubstr("'<&>'|'quote \" and \\' and ]]>'"));
  EXPECT_THAT(found, HasSubstr("'two\\nlines, 30\\xb0, \\U0001f4a1'"));
}

TEST(Junit, WhatXmlCannotHoldIsReplaced) {
  const std::vector<std::string> bad{std::string("\0", 1),
                                     "\x1B",
                                     "\xFF",
                                     "\xC2",
                                     "\xC0\x80",
                                     "\xED\xA0\x80",  // half of a surrogate pair
                                     "\xEF\xBF\xBE",
                                     "\xF4\x90\x80\x80"};
  for (const std::string& text : bad) {
    const std::string found =
        ReadByPython(JunitXml("s", {{"g", "a" + text + "b", JunitOutcome::kPassed, ""}}));
    EXPECT_THAT(found, HasSubstr("'a\\ufffd")) << found;
    EXPECT_THAT(found, HasSubstr("b'"));
  }
}

}  // namespace
}  // namespace turnlight
