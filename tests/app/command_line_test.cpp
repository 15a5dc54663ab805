// Proves that the program explains itself, that wrong usage is refused with exit code 2 and the
// nearest word, and that files which are not there are named. Does not prove that the commands
// work; the other tests of this folder do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

using Words = std::vector<std::string>;

TEST(CommandLine, EveryCommandHasHelpWithAnExample) {
  for (const Words& command :
       {Words{}, Words{"run"}, Words{"capture"}, Words{"resume"}, Words{"replay"}, Words{"plan"},
        Words{"graph"}, Words{"estimate"}, Words{"render"}, Words{"synthesize"}, Words{"verify"},
        Words{"config"}, Words{"config", "check"}, Words{"config", "show"}}) {
    Words words = command;
    words.push_back("--help");
    const Outcome outcome = RunProgram(words);
    EXPECT_EQ(outcome.exit_code, 0);
    std::string example = "Example:\n  turnlight";
    for (const std::string& word : command) example += " " + word;
    EXPECT_THAT(outcome.out, HasSubstr(example));
    EXPECT_EQ(outcome.err, "");
  }
}

TEST(CommandLine, VersionTellsTheCommit) {
  const Outcome outcome = RunProgram({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out,
              MatchesRegex("turnlight [0-9]+\\.[0-9]+\\.[0-9]+ \\(commit [0-9a-z]+\\)\n"));
}

struct Misuse {
  Words words;
  std::string message;
};

TEST(CommandLine, WrongUsageIsRefusedWithTheNearestWord) {
  for (const Misuse& misuse : {
           Misuse{{}, "a command is missing, allowed are run, plan"},
           Misuse{{"estimte"}, "unknown command estimte, did you mean estimate?"},
           Misuse{{"config", "shw"}, "unknown command shw, did you mean show?"},
           Misuse{{"estimate", "s", "--metod", "lm", "--out", "o"}, "did you mean --method?"},
           Misuse{{"estimate", "s", "--ouy=o"}, "unknown option --ouy, did you mean --out?"},
           Misuse{{"render", "s", "--param", "p", "--out", "o"}, "did you mean --params?"},
           Misuse{{"verify", "s", "--xyzzyplugh"}, "unknown option --xyzzyplugh\n"},
           Misuse{{"run", "c", "--port", "/dev/ttyUSB0", "--out", "o"}, "unknown option --port\n"},
           Misuse{{"help", "run"}, "unknown command help\n"},
           Misuse{{"estimate"}, "SESSION is required"},
           Misuse{{"estimate", "s"}, "--out is required"},
           Misuse{{"estimate", "s", "--out", "o", "--views", "0"}, "--views"},
           Misuse{{"estimate", "s", "--out", ""}, "--out: \"\" is no folder's name"},
           Misuse{{"synthesize", "c", "--out="}, "--out: 1 required DIR missing"},
           Misuse{{"capture", "c", "--out", ""}, "--out: \"\" is no folder's name"},
           Misuse{{"estimate", "s", "--out", "o", "--method", "magic"}, "--method"},
           Misuse{{"verify", "s", "--threads", "-1"}, "--threads"},
           Misuse{{"render", "s", "--params", "p", "--out", "o", "--samples", "33"}, "--samples"},
       }) {
    const Outcome outcome = RunProgram(misuse.words);
    EXPECT_EQ(outcome.exit_code, 2) << misuse.message;
    EXPECT_THAT(outcome.err, HasSubstr(misuse.message));
    EXPECT_THAT(outcome.err, StartsWith("turnlight: "));
    EXPECT_THAT(outcome.err, HasSubstr("--help"));
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(CommandLine, MissingFilesAreNamed) {
  for (const Words& words :
       {Words{"verify", "/nowhere/s"}, Words{"estimate", "/nowhere/s", "--out", "/nowhere/o"},
        Words{"render", "/nowhere/s", "--params", "p", "--out", "/nowhere/o"},
        Words{"synthesize", "/nowhere/s", "--out", "/nowhere/o"},
        Words{"config", "check", "/nowhere/s"}, Words{"config", "show", "/nowhere/s"},
        Words{"run", "/nowhere/s", "--out", "/nowhere/o"},
        Words{"capture", "/nowhere/s", "--out", "/nowhere/o"}, Words{"resume", "/nowhere/s"},
        Words{"replay", "/nowhere/s/log", "--out", "/nowhere/o"}, Words{"plan", "/nowhere/s"},
        Words{"graph", "/nowhere/s"}}) {
    const Outcome outcome = RunProgram(words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("/nowhere/s"));
  }
}

}  // namespace
}  // namespace turnlight::app
