// JUnit XML, as CI systems read it: one <testsuite> with its <testcase>s.
#pragma once

#include <string>
#include <vector>

namespace turnlight {

enum class JunitOutcome { kPassed, kFailed, kSkipped };

struct JunitCase {
  std::string group;  // CI systems list the cases of a group ("classname") together
  std::string name;
  JunitOutcome outcome = JunitOutcome::kPassed;
  std::string
      text;  // of a failed case: what was measured against what is allowed; of others: words
};

// The text of the file. Any text is fine: what XML reserves is escaped, and what it cannot hold
// (control characters, bytes that are no UTF-8) becomes U+FFFD.
std::string JunitXml(const std::string& suite, const std::vector<JunitCase>& cases);

}  // namespace turnlight
