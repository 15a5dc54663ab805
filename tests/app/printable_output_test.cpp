// Proves: text of a session that would steer a terminal (its name, names of files, what stands in
// its camera model and mesh) comes out of the program escaped, on both outputs, as text and as
// JSON. Does not prove: this of every command; all print through the same two streams.
#include "app/printable_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using nlohmann::ordered_json;
using ::testing::HasSubstr;

// What does harm: ESC, CSI as one character, DEL, a turn of the direction of writing.
const std::string kEvil =
    "e\x1b[2J\xc2\x9b"
    "1m\x7f\xe2\x80\xae";
const std::string kShown = "e\\u001b[2J\\u009b1m\\u007f\\u202e";

void ExpectHarmless(const std::string& text) {
  for (const char* bad : {"\x1b", "\xc2\x9b", "\x7f", "\xe2\x80\xae", "\r", "\x07"})
    EXPECT_EQ(text.find(bad), std::string::npos) << text;
}

Outcome RunHarmless(const std::vector<std::string>& arguments) {
  Outcome outcome = RunProgram(arguments);
  ExpectHarmless(outcome.out);
  ExpectHarmless(outcome.err);
  return outcome;
}

void Edit(const std::string& session, const std::function<void(ordered_json&)>& edit) {
  ordered_json json = ordered_json::parse(ReadText(session + "/session.json"));
  edit(json);
  WriteText(session + "/session.json", json.dump(1));
}

TEST(PrintableOutput, EscapesWhatGoesToTheStreams) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  {
    const PrintableOutput printable;
    std::cout << "a" << kEvil << "\n" << 7 << '\xc2' << '\xb0' << std::flush;
    std::cerr << kEvil << '\xe2' << std::endl;
  }
  std::cout << "\x1b" << std::flush;  // as before
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "a" + kShown + "\n7\xc2\xb0\x1b");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), kShown + "\\xe2\n");
}

TEST(PrintableOutput, NamesOfASession) {
  const TemporaryFolder folder;
  const std::string session = folder / "s";
  WriteSession(SmallConfig(), session);
  Edit(session, [](ordered_json& json) { json["name"] = kEvil + "\nlight 9  good"; });
  const Outcome text = RunHarmless({"estimate", session, "--out", folder / "r"});
  EXPECT_THAT(text.out, HasSubstr(kShown + "\\nlight 9  good: 3 views"));
  const Outcome json = RunHarmless({"estimate", session, "--out", folder / "r", "--json"});
  EXPECT_EQ(ordered_json::parse(json.out)["session"], kEvil + "\nlight 9  good");
  Edit(session, [](ordered_json& j) { j["length_unit"] = kEvil + "\n"; });
  EXPECT_THAT(RunHarmless({"verify", session}).out, HasSubstr(kShown));
  // A folder of that name.
  std::filesystem::rename(session, folder / kEvil);
  EXPECT_THAT(RunHarmless({"verify", folder / kEvil}).out, HasSubstr(kShown));
}

TEST(PrintableOutput, NamesOfFiles) {
  const TemporaryFolder folder;
  const std::string session = folder / "s", name = "frames/\xc2\x9b\xe2\x80\xae.png";
  WriteSession(SmallConfig(), session);
  std::filesystem::rename(session + "/frames/001.png", session + "/" + name);
  WriteText(session + "/" + name, "\x1b no picture");
  Edit(session, [&](ordered_json& json) {
    json["frames"][1]["image"] = name;
    json["frames"][1].erase("sha256");
  });
  EXPECT_THAT(RunHarmless({"verify", session}).out,
              HasSubstr("frames/\\u009b\\u202e.png: not a PNG file"));
  EXPECT_THAT(RunHarmless({"estimate", session, "--out", folder / "r"}).err,
              HasSubstr("frames/\\u009b\\u202e.png: not a PNG file"));
}

TEST(PrintableOutput, TextInOtherFiles) {
  const TemporaryFolder folder;
  const std::string session = folder / "s";
  WriteSession(SmallConfig(), session);
  const std::string camera =
      session + "/" +
      ordered_json::parse(ReadText(session + "/session.json"))["camera"].get<std::string>();
  const std::string good = ReadText(camera);
  WriteText(camera,
            "{'lensmodel': 'LENS" + kEvil + "', 'intrinsics': [1,2,3,4], 'imagersize': [80,60]}");
  EXPECT_NE(RunHarmless({"verify", session}).exit_code, 0);
  WriteText(camera, kEvil + good);
  EXPECT_NE(RunHarmless({"verify", session}).exit_code, 0);
  WriteText(camera, good);
  Edit(session, [](ordered_json& json) {
    json["target"] = {{"shape", "mesh"}, {"path", "evil.ply"}};
  });
  WriteText(session + "/evil.ply", "ply\nformat ascii 1.0\nelement " + kEvil + " 3\nproperty " +
                                       kEvil + " x\nend_header\n");
  EXPECT_NE(RunHarmless({"verify", session}).exit_code, 0);
  WriteText(session + "/session.json", "{\"format\": \"" + kEvil + "\", \"" + kEvil + "\": 1}");
  EXPECT_NE(RunHarmless({"verify", session}).exit_code, 0);
  EXPECT_NE(RunHarmless({"estimate", session, "--out", folder / "r"}).exit_code, 0);
}

}  // namespace
}  // namespace turnlight::app
