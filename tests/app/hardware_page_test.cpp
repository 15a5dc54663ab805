// Proves that docs/hardware.md tells the truth: its commands in the loop run to their end as they
// stand there, in one shell, the CI job included; of those that need hardware, commands and options
// exist; its code is that of the worked example; the messages that it explains are in the program;
// and what the examples of CI name is there. Does not prove: anything of real hardware, or that a
// CI takes the jobs. In the loop it has a link and an address of its own, six keyframes, and a
// fast table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "base/document.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kTree = TURNLIGHT_SOURCE_DIR;

std::string Page() { return ReadText(kTree / "docs/hardware.md"); }

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// A block of code, with the remark in the line before it, "in the loop".
struct CodeBlock {
  std::string language, remark, text;
};

std::vector<CodeBlock> BlocksOf(const std::string& page) {
  std::vector<CodeBlock> blocks;
  std::string before;
  bool inside = false;
  for (const std::string& line : LinesOf(page)) {
    if (!line.starts_with("```")) {
      if (inside) blocks.back().text += line + "\n";
    } else if (std::exchange(inside, !inside) == false) {
      const bool remarked = before.starts_with("<!-- ") && before.ends_with(" -->");
      blocks.push_back(
          {line.substr(3), remarked ? before.substr(5, before.size() - 9) : std::string(), ""});
    }
    before = line;
  }
  return blocks;
}

void ReplaceAll(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

// The tree as a newcomer sees it, but for link, address, number of keyframes and speed.
void LayOutTree(const fs::path& folder) {
  fs::copy(kTree / "configs", folder / "configs", fs::copy_options::recursive);
  fs::create_directory(folder / "docs");
  fs::copy(kTree / "docs/examples", folder / "docs/examples", fs::copy_options::recursive);
  fs::create_directory(folder / "build");
  fs::create_directory_symlink(fs::path(TURNLIGHT_PROGRAM).parent_path(), folder / "build/release");
  for (const char* name : {"sim_grbl.yaml", "hil_grbl.yaml"}) {
    const fs::path file = folder / "configs" / name;
    std::string text = ReadText(file);
    ReplaceAll(text, "/tmp/turnlight_hil_grbl", (folder / "table").string());
    ReplaceAll(text, "127.0.0.1", OwnAddress());
    ReplaceAll(text, "step_deg: 10", "step_deg: 60");
    ReplaceAll(text, "count: 36", "count: 6");
    ReplaceAll(text, "speed_deg_s: 60", "speed_deg_s: 600");
    ReplaceAll(text, "acceleration_deg_s2: 400", "acceleration_deg_s2: 4000");
    WriteText(file, text);
  }
}

TEST(HardwarePage, EveryShellBlockSaysWhereItRuns) {
  int loop = 0;
  for (const CodeBlock& block : BlocksOf(Page())) {
    if (block.language != "sh") continue;
    EXPECT_TRUE(block.remark == "in the loop" || block.remark == "with hardware") << block.text;
    loop += block.remark == "in the loop" ? 1 : 0;
  }
  EXPECT_GE(loop, 6);
}

TEST(HardwarePage, EveryCommandInTheLoopRuns) {
  const TemporaryFolder folder;
  LayOutTree(folder.path());
  // What a command leaves running ends with the shell.
  std::string script = "set -ex\ntrap 'kill $(jobs -p) 2>/dev/null || true' EXIT\n";
  for (const CodeBlock& block : BlocksOf(Page()))
    if (block.language == "sh" && block.remark == "in the loop") script += block.text;
  WriteText(folder / "page.sh", script + "echo done >end\n");
  const std::string command =
      "cd " + folder.path().string() + " && timeout 400 bash page.sh >out 2>err";
  EXPECT_EQ(std::system(command.c_str()), 0)
      << ReadText(folder / "out") << ReadText(folder / "err");
  EXPECT_EQ(ReadText(folder / "end"), "done\n");
  const std::string out = ReadText(folder / "out");
  EXPECT_THAT(out, HasSubstr(", at " + OwnAddress() + " by GigEVision"));
  EXPECT_THAT(out, HasSubstr("the table stands at 30.000 degrees"));
  EXPECT_THAT(out, HasSubstr("my_run/session: good, 6 frames"));
  EXPECT_THAT(out, HasSubstr("my_rig/rig.yaml: good"));
  // The job's capture is that of the first section once more.
  EXPECT_THAT(out, HasSubstr("sessions: identical"));
  EXPECT_THAT(ReadText(folder / "loop/doctor.xml"), HasSubstr("<testsuite"));
  EXPECT_THAT(ReadText(folder / "loop/compare.xml"), HasSubstr("<testsuite"));
}

TEST(HardwarePage, CommandsWithHardwareHaveTheirOptions) {
  int commands = 0;
  for (const CodeBlock& block : BlocksOf(Page())) {
    if (block.language != "sh" || block.remark != "with hardware") continue;
    for (const std::string& line : LinesOf(block.text)) {
      std::istringstream words(line.substr(0, line.find('#')));
      std::string word, command;
      if (!(words >> word >> command) || word != "turnlight") continue;
      ++commands;
      const Outcome help = RunProgram({command, "--help"});
      EXPECT_EQ(help.exit_code, 0) << line;
      while (words >> word)
        EXPECT_TRUE(!word.starts_with("--") || help.out.find(word) != std::string::npos) << line;
    }
  }
  EXPECT_GE(commands, 10);
}

TEST(HardwarePage, ItsCodeIsThatOfTheExample) {
  int parts = 0;
  for (const CodeBlock& block : BlocksOf(Page())) {
    if (block.language != "cpp") continue;
    ++parts;
    std::string text = block.text;
    text.pop_back();
    EXPECT_NE(ReadText(kTree / block.remark).find(text), std::string::npos)
        << block.remark << " has no longer\n"
        << text;
  }
  EXPECT_EQ(parts, 3);
}

// All sources as one text, strings that go on in the next line joined.
std::string Sources() {
  std::string text;
  for (const char* top : {"app", "base", "nodes", "rig"})
    for (const auto& entry : fs::recursive_directory_iterator(kTree / top))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
        text += ReadText(entry.path());
  std::string joined;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::size_t next = text[at] == '"' ? text.find_first_not_of(" \n", at + 1) : at;
    if (text[at] == '"' && next > at + 1 && next != std::string::npos && text[next] == '"') {
      at = next;
    } else {
      joined += text[at];
    }
  }
  ReplaceAll(joined, "%%", "%");
  return joined;
}

TEST(HardwarePage, TheMessagesThatItExplainsAreTheProgramsOwn) {
  const std::string sources = Sources();
  const std::string page = Page();
  const std::size_t begin = page.find("\n## 10. "), end = page.find("\n## 11. ");
  ASSERT_LT(begin, end);
  int messages = 0;
  for (const std::string& line : LinesOf(page.substr(begin, end - begin))) {
    if (!line.starts_with("| `")) continue;
    ++messages;
    std::string message = line.substr(3, line.find("` |") - 3);
    ReplaceAll(message, "...", "\n");  // where something varies
    for (std::string part : LinesOf(message)) {
      while (part.ends_with(' ')) part.pop_back();
      EXPECT_NE(sources.find(part), std::string::npos) << "'" << part << "', of\n" << message;
    }
  }
  EXPECT_GE(messages, 30);
}

TEST(HardwarePage, TheExamplesOfCiNameWhatIsThere) {
  for (const char* name : {"github-actions.yml", "gitlab-ci.yml"}) {
    const std::string text = ReadText(kTree / "docs/examples" / name);
    const auto parsed = ParseYaml(text, name);
    EXPECT_TRUE(parsed) << parsed.error().text;
    const std::regex path("turnlight/((scripts|docs)/[a-z_/.-]+)");
    int paths = 0;
    for (std::sregex_iterator at(text.begin(), text.end(), path), end; at != end; ++at, ++paths)
      EXPECT_TRUE(fs::exists(kTree / (*at)[1].str())) << (*at)[1];
    EXPECT_EQ(paths, 2) << name;
    EXPECT_THAT(text, HasSubstr(": debian:12\n"));
    EXPECT_THAT(text, HasSubstr("cmake --preset release -DTURNLIGHT_TESTS=OFF"));
    EXPECT_THAT(text, HasSubstr("out/*.xml"));
  }
}

}  // namespace
}  // namespace turnlight::app
