// Proves, through the whole program, that a damaged or senseless session makes `estimate` stop with
// the right exit code and a message that names what is wrong, without a crash and without a result.
// Does not try damage at random; the fuzz targets do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "rig/session/image_file.h"
#include "tests/app/png_header.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using nlohmann::ordered_json;
using ::testing::HasSubstr;

using Folder = std::filesystem::path;

struct BadInput {
  std::string name;
  std::function<void(const Folder&)> damage;
  std::vector<std::string> words;  // all in the message
  int exit_code = 2;
  bool mesh = false;
};

void EditSession(const Folder& session, const std::function<void(ordered_json&)>& edit) {
  ordered_json json = ordered_json::parse(ReadText(session / "session.json"));
  edit(json);
  WriteText(session / "session.json", json.dump(1));
}

// Replaces the picture of frame 1 by whatever is written, its checksum taken away.
void EditImage(const Folder& session, const std::function<void(const Folder&)>& write) {
  EditSession(session, [](ordered_json& json) { json["frames"][1].erase("sha256"); });
  write(session / "frames/001.png");
}

void ReplaceText(const Folder& file, const std::string& from, const std::string& to) {
  std::string text = ReadText(file);
  Replace(text, from, to);
  WriteText(file, text);
}

void FillAllImages(const Folder& session, const cv::Scalar& value) {
  EditSession(session, [](ordered_json& json) {
    for (auto& frame : json["frames"]) frame.erase("sha256");
  });
  for (const std::string name : {"000", "001", "002"})
    ASSERT_TRUE(
        rig::WriteImage(session / ("frames/" + name + ".png"), cv::Mat(60, 80, CV_16UC3, value)));
}

std::vector<BadInput> DamagedImages() {
  return {
      {"MissingImage",
       [](const Folder& s) { std::filesystem::remove(s / "frames/001.png"); },
       {"frames/1/image", "frames/001.png"}},
      {"ChangedImage",
       [](const Folder& s) {
         ASSERT_TRUE(rig::WriteImage(s / "frames/001.png", cv::Mat(60, 80, CV_16UC3, {1, 2, 3})));
       },
       {"001.png", "SHA-256"}},
      {"WrongSize",
       [](const Folder& s) {
         EditImage(s, [](const Folder& file) {
           ASSERT_TRUE(rig::WriteImage(file, cv::Mat(60, 81, CV_16UC3, {1, 2, 3})));
         });
       },
       {"001.png", "81 x 60", "80 x 60"}},
      {"TruncatedPng",
       [](const Folder& s) {
         EditImage(s, [](const Folder& file) {
           const std::string bytes = ReadText(file);
           WriteText(file, bytes.substr(0, bytes.size() / 2));
         });
       },
       {"001.png", "truncated"}},
      {"FourChannels",
       [](const Folder& s) {
         EditImage(s, [](const Folder& file) { WriteText(file, RgbaPng(80, 60)); });
       },
       {"001.png", "channels"}},
      {"HugeHeader",
       [](const Folder& s) {
         EditImage(s, [](const Folder& file) {
           WriteText(file, WithPngSize(ReadText(file), 100000, 100000));
         });
       },
       {"001.png", "100000 x 100000"}},
  };
}

std::vector<BadInput> ImagesThatShowNothing() {
  return {
      {"EmptyMask",
       [](const Folder& s) {
         ASSERT_TRUE(
             rig::WriteImage(s / "frames/001.mask.png", cv::Mat(60, 80, CV_8UC1, cv::Scalar(0))));
         EditSession(s,
                     [](ordered_json& json) { json["frames"][1]["mask"] = "frames/001.mask.png"; });
       },
       {"001.mask.png", "at least one non-zero pixel"}},
      {"AllBlack",
       [](const Folder& s) {
         FillAllImages(s, {0, 0, 0});
       },
       {"black"},
       5},
      {"AllSaturated",
       [](const Folder& s) {
         FillAllImages(s, {65535, 65535, 65535});
       },
       {"clipped"},
       5},
  };
}

std::vector<BadInput> DamagedDescriptions() {
  const auto edit = [](const std::function<void(ordered_json&)>& change) {
    return [change](const Folder& s) { EditSession(s, change); };
  };
  return {
      {"NanPose",
       [edit](const Folder& s) {
         edit([](ordered_json& json) { json["frames"][1]["X_WC"][0][3] = "here"; })(s);
         ReplaceText(s / "session.json", "\"here\"", "NaN");
       },
       {"session.json", "JSON"}},
      {"InfinitePose",
       [edit](const Folder& s) {
         edit([](ordered_json& json) { json["frames"][1]["X_WC"][0][3] = "here"; })(s);
         ReplaceText(s / "session.json", "\"here\"", "1e999");
       },
       {"session.json"}},
      {"ReflectedPose",
       edit([](ordered_json& json) {
         for (auto& row : json["frames"][1]["X_WC"]) row[0] = -row[0].get<double>();
       }),
       {"frames/1/X_WC", "determinant is -1"}},
      {"ParentPath",
       edit([](ordered_json& json) { json["frames"][1]["image"] = "../001.png"; }),
       {"frames/1/image", "\"..\""}},
      {"AbsolutePath",
       edit([](ordered_json& json) { json["frames"][1]["image"] = "/etc/passwd"; }),
       {"frames/1/image", "absolute"}},
      {"LinkOut",
       [](const Folder& s) {
         std::filesystem::rename(s / "frames/001.png", s.parent_path() / "outside.png");
         std::filesystem::create_symlink("../../outside.png", s / "frames/001.png");
       },
       {"frames/1/image", "link", "out of its folder"}},
      {"UnknownKey",
       edit([](ordered_json& json) { json["frames"][1]["angel_deg"] = 3; }),
       {"frames/1/angel_deg", "unknown key"}},
      {"VersionTwo", edit([](ordered_json& json) { json["version"] = 2; }), {"version"}},
      {"NoFrames",
       edit([](ordered_json& json) { json["frames"] = ordered_json::array(); }),
       {"frames"}},
      {"ExposureOnSomeFrames",
       edit([](ordered_json& json) { json["frames"][1]["exposure_us"] = 8000; }),
       {"exposure_us"}},
  };
}

std::vector<BadInput> DamagedLensesAndMeshes() {
  return {
      {"UnknownLens",
       [](const Folder& s) {
         ReplaceText(s / "camera.cameramodel", "LENSMODEL_PINHOLE", "LENSMODEL_TEAPOT");
       },
       {"camera.cameramodel", "LENSMODEL_TEAPOT"}},
      {"MeshWithoutFaces",
       [](const Folder& s) {
         WriteText(s / "target.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                   "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
                   "end_header\n0 0 0\n1 0 0\n0 1 0\n");
       },
       {"target.ply", "faces"},
       2,
       true},
      {"NormalsAgainstTheWinding",
       [](const Folder& s) {
         WriteText(s / "target.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                   "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                   "0 0 0 0 0 -1\n1 0 0 0 0 -1\n0 1 0 0 0 -1\n3 0 1 2\n");
       },
       {"target.ply", "winding"},
       2,
       true},
  };
}

std::vector<BadInput> AllBadInputs() {
  std::vector<BadInput> all = DamagedImages();
  for (const auto& more :
       {ImagesThatShowNothing(), DamagedDescriptions(), DamagedLensesAndMeshes()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

void PrintTo(const BadInput& input, std::ostream* out) { *out << input.name; }

class BadInputs : public ::testing::TestWithParam<BadInput> {};

TEST_P(BadInputs, StopTheProgramWithAMessage) {
  const TemporaryFolder folder;
  rig::sim::SyntheticConfig config = SmallConfig();
  if (GetParam().mesh) config.target = rig::sim::Blob{40.0, 0.3, 16};
  WriteSession(config, folder / "s");
  GetParam().damage(folder / "s");
  const Outcome outcome = RunProgram({"estimate", folder / "s", "--out", folder / "r", "--json"});
  EXPECT_EQ(outcome.exit_code, GetParam().exit_code) << outcome.err;
  for (const std::string& word : GetParam().words) EXPECT_THAT(outcome.err, HasSubstr(word));
  EXPECT_EQ(outcome.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder / "r/result.json"));
}

INSTANTIATE_TEST_SUITE_P(All, BadInputs, ::testing::ValuesIn(AllBadInputs()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace turnlight::app
