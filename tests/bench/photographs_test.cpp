// Proves that the study of photographs measures what it says: sums of photographs are sums of light
// that stay clipped, scenes are chosen as they are promised, the script of bench/peers finds
// highlights where closed forms have them, and the summary judges its figures and tells who is
// right. Where ../shared/data is: a sum made here is the one that was made elsewhere, and single
// photographs are estimated by all methods. Does not prove: that the estimates are good
// (docs/accuracy.md).
#include "bench/studies/photographs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <set>

#include "base/angles.h"
#include "base/file.h"
#include "base/format.h"
#include "bench/studies/job_runner.h"
#include "bench/studies/photograph_summary.h"
#include "bench/studies/report.h"
#include "bench/studies/studies.h"
#include "bench/studies/summary.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"
#include "tests/temporary_folder.h"

namespace turnlight::studies {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr int kSize = 120;  // pixels
constexpr double kFocal = 1000.0, kCentre = 59.5, kDistance = 1000.0, kRadius = 50.0;
constexpr char kPlain[] = R"("encoding": "linear", "black": 0, "white": 65535)";

// A session of a ball in front of a camera that looks along -z, with a grey picture.
void WriteBall(const fs::path& folder, const cv::Mat& image, const Vector3d& light,
               const std::string& radiometry = kPlain) {
  fs::create_directories(folder / "frames");
  ASSERT_TRUE(rig::WriteImage(folder / "frames/000.png", image));
  ASSERT_TRUE(WriteFileAtomic(
      folder / "camera.cameramodel",
      Format("{'lensmodel': 'LENSMODEL_PINHOLE', 'extrinsics': [0, 0, 0, 0, 0, 0], 'intrinsics': "
             "[%g, %g, %g, %g], 'imagersize': [%d, %d]}",
             kFocal, kFocal, kCentre, kCentre, kSize, kSize)));
  ASSERT_TRUE(WriteFileAtomic(
      folder / "session.json",
      Format(R"({"format": "turnlight-session", "version": 1, "name": "ball", "length_unit": "mm",
 "camera": "camera.cameramodel", "radiometry": {%s}, "target": {"shape": "sphere", "radius": %g},
 "frames": [{"image": "frames/000.png", "X_WC": [[1,0,0,0],[0,-1,0,0],[0,0,-1,%g]],
  "X_WT": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]})",
             radiometry.c_str(), kRadius, kDistance)));
  ASSERT_TRUE(WriteFileAtomic(folder / "truth.json",
                              Format(R"({"lights": [{"direction": [%.17g, %.17g, %.17g]}]})",
                                     light.x(), light.y(), light.z())));
}

cv::Mat Picture(const std::function<double(double x, double y)>& radiance) {
  cv::Mat1w image(kSize, kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      image(y, x) = cv::saturate_cast<std::uint16_t>(65535.0 * radiance(x, y));
  return image;
}

// A dim ball with a highlight at the point with this normal; and the light that makes it.
struct Ball {
  cv::Mat image;
  Vector3d light;
};
Ball BallWithHighlight(const Vector3d& normal) {
  const Vector3d point = kRadius * normal;
  const Vector3d view = (Vector3d(0.0, 0.0, kDistance) - point).normalized();
  const double depth = kDistance - point.z();
  const double u = kCentre + kFocal * point.x() / depth, v = kCentre - kFocal * point.y() / depth;
  return {Picture([&](double x, double y) {
            return 0.1 + 1.5 * std::exp(-0.25 * (std::pow(x - u, 2) + std::pow(y - v, 2)));
          }),
          2.0 * normal.dot(view) * normal - view};
}

Vector3d Tilted(double x_deg, double y_deg) {
  return Vector3d(std::tan(DegToRad(x_deg)), std::tan(DegToRad(y_deg)), 1.0).normalized();
}

TEST(Sums, AreMeansThatStayClipped) {
  const TemporaryFolder folder;
  const auto at = [](double x, double y, double there, double elsewhere) {
    return x == 60 && y == 60 ? there : elsewhere;
  };
  WriteBall(folder.path() / "a", Picture([&](double x, double y) { return at(x, y, 1.0, 0.2); }),
            Vector3d::UnitZ());
  WriteBall(folder.path() / "b", Picture([&](double x, double y) { return at(x, y, 0.1, 0.4); }),
            Vector3d::UnitX());
  ASSERT_TRUE(WriteSum({folder.path() / "a", folder.path() / "b"}, folder.path() / "sum"));
  const auto session = rig::ReadSession(folder.path() / "sum");
  ASSERT_TRUE(session) << session.error().text;
  const auto images = rig::ReadFrameImages(*session, 0);
  ASSERT_TRUE(images) << images.error().text;
  EXPECT_EQ(images->image.at<std::uint16_t>(60, 60), 65535);
  EXPECT_NEAR(images->image.at<std::uint16_t>(60, 61), 0.3 * 65535, 1.0);
  const auto truth = ReadFile(folder.path() / "sum" / "truth.json");
  ASSERT_TRUE(truth);
  EXPECT_EQ(Json::parse(*truth)["lights"].size(), 2u);
  EXPECT_EQ(Json::parse(*truth)["lights"][1]["direction"], Json::array({1.0, 0.0, 0.0}));
}

TEST(Sums, KeepEachOnesLevels) {
  const TemporaryFolder folder;
  const cv::Mat image = Picture([](double, double) { return 0.5; });
  WriteBall(folder.path() / "a", image, Vector3d::UnitZ());
  WriteBall(folder.path() / "b", image, Vector3d::UnitX(),
            R"("encoding": "linear", "black": 13107, "white": 65535)");
  ASSERT_TRUE(WriteSum({folder.path() / "a", folder.path() / "b"}, folder.path() / "sum"));
  const auto sum = rig::ReadImage(folder.path() / "sum" / "frames/000.png");
  ASSERT_TRUE(sum);
  EXPECT_NEAR(sum->at<std::uint16_t>(5, 5), 65535 * (0.5 + 0.375) / 2.0, 2.0);
  WriteBall(folder.path() / "c", image, Vector3d::UnitX(),
            R"("encoding": "srgb", "black": 0, "white": 65535)");
  const Status refused = WriteSum({folder.path() / "a", folder.path() / "c"}, folder.path() / "no");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, testing::HasSubstr("c/session.json: allowed in a sum"));
}

TEST(Choice, IsApartAndTheSameEachTime) {
  std::vector<Vector3d> directions;
  for (const double x_deg : {-15.0, -5.0, 5.0, 15.0})
    for (const double y_deg : {0.0, 12.0, 24.0}) directions.push_back(Tilted(x_deg, y_deg));
  const auto chosen = ChooseApart(directions, 3, 20.0, 5);
  ASSERT_EQ(chosen.size(), 5u);
  EXPECT_EQ(chosen, ChooseApart(directions, 3, 20.0, 5));
  for (const auto& three : chosen) {
    ASSERT_EQ(three.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_LT(three[j], three[i]);
        EXPECT_GE(RadToDeg(std::acos(directions[three[i]].dot(directions[three[j]]))), 20.0);
      }
  }
  // All there are: of four in a row 15 degrees apart three pairs are 25 degrees apart.
  const std::vector<Vector3d> row = {Tilted(-22.5, 0.0), Tilted(-7.5, 0.0), Tilted(7.5, 0.0),
                                     Tilted(22.5, 0.0)};
  EXPECT_THAT(ChooseApart(row, 2, 25.0, 100),
              testing::ElementsAre(testing::ElementsAre(0u, 2u), testing::ElementsAre(0u, 3u),
                                   testing::ElementsAre(1u, 3u)));
  EXPECT_TRUE(ChooseApart({}, 2, 25.0, 100).empty());
}

// Two photographs of a ball and the sum of them, all by one method.
Result<StudyFile> MeasuredBy(const std::string& method, const fs::path& data,
                             const fs::path& scratch, Range scenes) {
  auto jobs = PhotographJobs(data, scenes, scratch);
  if (!jobs) return Forward(jobs);
  std::erase_if(*jobs, [&](const Job& job) { return !job.id.ends_with("/" + method); });
  return RunJobs("photographs", *jobs, {});
}

TEST(Script, FindsHighlightsWhereClosedFormsHaveThem) {
  const TemporaryFolder folder;
  const Ball a = BallWithHighlight(Tilted(20.0, 5.0)), b = BallWithHighlight(Tilted(-10.0, -15.0));
  WriteBall(folder.path() / "diligent_ball" / "single_a", a.image, a.light);
  WriteBall(folder.path() / "diligent_ball" / "single_b", b.image, b.light);
  fs::create_directory(folder.path() / "scratch");
  const auto file = MeasuredBy("script", folder.path(), folder.path() / "scratch", {0, 10});
  ASSERT_TRUE(file) << file.error().text;
  ASSERT_EQ(file->records.size(), 3u);
  for (const char* id : {"ball-1/a/script", "ball-1/b/script", "ball-2/a_b/script"}) {
    ASSERT_TRUE(file->records.contains(id)) << id;
    const Json& record = file->records.at(id);
    ASSERT_FALSE(record.contains("failed")) << record["failed"];
    EXPECT_TRUE(record["right"].get<bool>()) << record.dump();
    // A tenth of a pixel; the mirrored view turns by two radians in a radius.
    for (const Json& angle : record["angles_deg"])
      EXPECT_LT(angle.get<double>(), RadToDeg(0.1 * 2.0 / (kRadius * kFocal / kDistance)));
    EXPECT_GT(record["cpu_s"].get<double>(), 0.0);
  }
  EXPECT_TRUE(fs::is_empty(folder.path() / "scratch"));
}

TEST(Scenes, AreRefusedWhereThereAreNone) {
  const TemporaryFolder folder;
  const auto none = PhotographJobs(folder.path(), {0, 10}, folder.path());
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text, testing::HasSubstr("neither sessions diligent_ball/single_*"));
}

// A light with its error and sigma, in a record with as many as the set says.
Json Record(const std::string& id, const std::vector<double>& errors, double sigma, bool right,
            const std::string& note = "") {
  Json record{{"id", id}, {"right", right}, {"say", "said"}, {"cpu_s", 1.0}};
  record["angles_deg"] = errors;
  record["quantities"] = Json::array();
  for (const double error : errors)
    record["quantities"].push_back({"direction", 0, 0.0, error, sigma, sigma});
  record["notes"] = Json::array();
  if (!note.empty()) record["notes"].push_back(note);
  return record;
}

StudyFile SmallStudy() {
  StudyFile file{"photographs", {}};
  for (const Json& record :
       {Record("ball-1/a/turnlight", {0.2}, 0.3, true),
        Record("ball-1/b/turnlight", {0.58}, 0.3, true),
        Record("ball-2/a_b/turnlight", {0.4, 0.8}, 0.3, true, "count-uncertain"),
        Record("ball-2/a_c/turnlight", {2.0}, 0.3, false),
        Record("ball-1/a/script", {0.5}, 0.3, true),
        Json{{"id", "ball-1/a/paper"}, {"failed", "no light"}},
        Record("gray-2/a_b/turnlight", {1.0, 9.0}, 0.5, true)})
    file.records[record["id"]] = record;
  return file;
}

TEST(Figures, JudgeWhatTheyName) {
  const Summary summary = Summarise(SmallStudy(), 5);
  EXPECT_FALSE(summary.accepted);
  for (const char* line :
       {"holds  glossy ball, 1 light: count +2 of 2",
        "holds  glossy ball, 1 light: mean direction +0.39 deg, at most 0.4",
        "FAILS  glossy ball, sums: count +1 of 2 = 50.0 %, wanted 97 %",
        "FAILS  glossy ball, sums: worst direction +2 deg, at most 1.3",
        "holds  glossy ball: not refused +4 of 4",
        // 0.5 degrees with the truth's own error.
        "FAILS  glossy ball: within 1 sigma +2 of 5 = 40.0 %, wanted 60 %",
        "holds  glossy ball: within 1 sigma, not too many +40 %, at most 85",
        "FAILS  glossy ball: within 2 sigma +4 of 5 = 80.0 %, wanted 90 %",
        "FAILS  gray ball, 2 lights: within 3 sigma +1 of 2 = 50.0 %, wanted 100 %",
        "holds  gray ball, 2 lights: two, or a note +1 of 1",
        "FAILS  count-uncertain in right answers +25 %, at most 20",
        "FAILS  count-uncertain in wrong answers +0 of 1",
        "none   gray ball, 1 light: within 2 sigma +nothing to judge",
        "ball-2/a_c/turnlight: said\n"})
    EXPECT_THAT(summary.text, testing::ContainsRegex(line));
  EXPECT_THAT(summary.text,
              testing::ContainsRegex("glossy ball, 1 light +the paper's method +0 of 1"));
  EXPECT_THAT(summary.text,
              testing::ContainsRegex("glossy ball, 1 light +highlight script +1 of 1 +0.50 +0.50 "
                                     "+0.50 +- +- +-"));
}

TEST(Errors, AreInfiniteWhereTheCountIsWrong) {
  const StudyFile file{
      "photographs",
      {{"ball-2/a_b/turnlight", Record("ball-2/a_b/turnlight", {0.25, 0.5}, 0.3, true)},
       {"ball-2/a_c/turnlight", Record("ball-2/a_c/turnlight", {0.25, 0.5}, 0.3, false)},
       {"ball-1/a/turnlight", Json{{"failed", "no light"}}},
       {"ball-1/a/script", Record("ball-1/a/script", {1.0}, 0.3, true)},
       {"gray-1/a/turnlight", Record("gray-1/a/turnlight", {1.0}, 0.3, true)}}};
  EXPECT_THAT(PhotographErrors(file, "ball-", "turnlight"),
              testing::UnorderedElementsAre(0.25, 0.5, INFINITY, INFINITY, INFINITY));
}

TEST(Page, BeginsWithThePhotographs) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteReport(folder.path(), folder.path() / "docs"));
  EXPECT_THAT(*ReadFile(folder.path() / "docs" / "accuracy.md"),
              testing::HasSubstr("## Real photographs\n\nNot measured"));
  ASSERT_TRUE(WriteStudyFile(SmallStudy(), folder.path() / "photographs.json"));
  ASSERT_TRUE(WriteReport(folder.path(), folder.path() / "docs"));
  const auto page = ReadFile(folder.path() / "docs" / "accuracy.md");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->find("\n## "), page->find("\n## Real photographs"));
  EXPECT_THAT(*page, testing::HasSubstr("glossy ball, sums: count"));
  EXPECT_TRUE(fs::exists(folder.path() / "docs" / "accuracy" / "photographs.svg"));
}

class RealPhotographs : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(data / "diligent_ball")) GTEST_SKIP() << data << " is not there";
  }
  fs::path data = TURNLIGHT_SHARED_DATA;
  TemporaryFolder folder;
};

TEST_F(RealPhotographs, AreSummedAsElsewhere) {
  const fs::path balls = data / "diligent_ball";
  ASSERT_TRUE(WriteSum({balls / "single_003", balls / "single_067"}, folder.path() / "sum"));
  const auto ours = rig::ReadImage(folder.path() / "sum" / "frames/000.png");
  const auto theirs = rig::ReadImage(balls / "sum2_003_067" / "frames/000.png");
  ASSERT_TRUE(ours && theirs);
  EXPECT_LE(cv::norm(*ours, *theirs, cv::NORM_INF), 1.0);
}

TEST_F(RealPhotographs, AreThereOnceEach) {
  const auto scenes = PhotographScenes(data);
  ASSERT_TRUE(scenes) << scenes.error().text;
  std::map<std::string, int> sets;
  std::set<std::string> ids;
  for (const PhotographScene& scene : *scenes) {
    ++sets[scene.id.substr(0, scene.id.find('/'))];
    EXPECT_TRUE(ids.insert(scene.id).second) << scene.id;
  }
  EXPECT_EQ(sets["ball-1"], 24);
  EXPECT_GE(sets["ball-2"], 30);
  EXPECT_GE(sets["ball-3"], 20);
  EXPECT_GE(sets["ball-4"], 14);
  EXPECT_EQ(sets["gray-1"], 6);
  EXPECT_EQ(sets["gray-2"], 9);  // all pairs that are 20 degrees apart
}

TEST_F(RealPhotographs, AreMeasuredByAllMethods) {
  const auto jobs = PhotographJobs(data, {0, 1}, folder.path());
  ASSERT_TRUE(jobs) << jobs.error().text;
  const auto file = RunJobs("photographs", *jobs, {});
  ASSERT_TRUE(file) << file.error().text;
  ASSERT_EQ(file->records.size(), 3u);
  for (const auto& [id, record] : file->records) {
    ASSERT_FALSE(record.contains("failed")) << id << ": " << record["failed"];
    if (!id.ends_with("/paper")) {
      EXPECT_LT(record["angles_deg"][0].get<double>(), 1.1) << id;
    }
  }
  EXPECT_TRUE(file->records.at("ball-1/003/script")["right"].get<bool>());
}

}  // namespace
}  // namespace turnlight::studies
