// Proves: a session's folder gives the estimate that its frames give in memory, bit for bit;
// progress is told in order; a stop flag ends the call in every stage, soon and with an error of
// its own; and options that do not go together are refused. Does not prove that estimates are
// right, or that nothing is written on the way: it is given no place to write to.
#include "estimator/from_session/session_estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "base/file.h"
#include "estimator/results/result_json.h"
#include "rig/session/mesh_file.h"
#include "rig/sim/blob.h"
#include "rig/sim/synthetic_session.h"
#include "tests/temporary_folder.h"

namespace turnlight::estimator::from_session {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 6;

struct Told {
  Stage stage;
  std::size_t done, total;
  bool operator==(const Told&) const = default;
};

class FromSession : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    rig::sim::SyntheticConfig config;
    config.motion.frames = kFrames;
    config.camera = {160, 120, 280.0, {}};
    const auto written = rig::sim::WriteSynthetic(config, session());
    ASSERT_TRUE(written) << written.error().text;
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::filesystem::path session() { return folder_->path() / "s"; }

  static std::string Refusal(const Options& options) {
    const auto estimate = EstimateSession(session(), options);
    if (estimate) return "accepted";
    EXPECT_EQ(estimate.error().kind, ErrorKind::kInput);
    return estimate.error().text;
  }

  static std::string Json(const Estimate& estimate) {
    Estimate timeless = estimate;
    timeless.initial_s = timeless.solve_s = 0.0;
    return results::ResultToJson(timeless, "s", results::Method::kLeastSquares, {});
  }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(FromSession, GivesWhatItsFramesGive) {
  const auto estimate = EstimateSession(session());
  ASSERT_TRUE(estimate) << estimate.error().text;
  EXPECT_EQ(estimate->keyframes.size(), static_cast<std::size_t>(kFrames));
  EXPECT_FALSE(estimate->closure);
  const auto same = EstimateScene(estimate->keyframes, estimate->geometry,
                                  calib::RayGrid(*estimate->session.camera), {});
  ASSERT_TRUE(same) << same.error().text;
  EXPECT_EQ(Json(estimate->output.estimate), Json(same->estimate));
  EXPECT_FALSE(estimate->output.estimate.lights.empty());
}

// A lump whose mesh was turned inside out, and then cut open as well.
TEST_F(FromSession, AMeshWoundInwardsIsMendedOrTheCause) {
  const TemporaryFolder folder;
  const std::filesystem::path root = folder.path() / "s", file = root / "target.ply";
  rig::sim::SyntheticConfig config;
  config.motion.frames = 3;
  config.camera = {96, 72, 168.0, {}};
  config.target = rig::sim::Blob{.segments = 24};
  ASSERT_TRUE(rig::sim::WriteSynthetic(config, root));
  auto mesh = rig::ReadMesh(file);
  ASSERT_TRUE(mesh) << mesh.error().text;
  const auto clean = EstimateSession(root);
  ASSERT_TRUE(clean) << clean.error().text;
  for (Eigen::Vector3i& face : mesh->faces) std::swap(face[1], face[2]);
  ASSERT_TRUE(WriteFileAtomic(file, rig::sim::MeshToPly(*mesh)));
  const auto mended = EstimateSession(root);
  ASSERT_TRUE(mended) << mended.error().text;
  EXPECT_EQ(mended->output.estimate.rms, clean->output.estimate.rms);
  ASSERT_FALSE(mended->output.estimate.notes.empty());
  EXPECT_EQ(mended->output.estimate.notes.back().code, "mesh-repaired");
  EXPECT_THAT(mended->output.estimate.notes.back().text, HasSubstr("were wound inwards"));

  for (Eigen::Vector3d& normal : mesh->normals) normal = -normal;
  mesh->faces.resize(mesh->faces.size() * 3 / 4);
  ASSERT_TRUE(WriteFileAtomic(file, rig::sim::MeshToPly(*mesh)));
  const auto refused = EstimateSession(root);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, testing::AllOf(HasSubstr("the mesh is wound inwards"),
                                                   testing::Not(HasSubstr("check the poses"))));
}

TEST_F(FromSession, ViewsAreSpreadOverTheFrames) {
  Options options;
  options.views = 3;
  const auto estimate = EstimateSession(session(), options);
  ASSERT_TRUE(estimate) << estimate.error().text;
  ASSERT_EQ(estimate->keyframes.size(), 3u);
  EXPECT_EQ(estimate->keyframes.poses[1].X_WC.rotation, estimate->session.frames[2].X_WC.rotation);
}

TEST_F(FromSession, ProgressIsToldInOrder) {
  for (const results::Method method : {results::Method::kLeastSquares, results::Method::kPaper}) {
    std::vector<Told> told;
    Options options;
    options.method = method;
    options.progress = [&](Stage stage, std::size_t done, std::size_t total) {
      told.push_back({stage, done, total});
    };
    const auto estimate = EstimateSession(session(), options);
    ASSERT_TRUE(estimate) << estimate.error().text;
    std::vector<Told> expected;
    for (std::size_t i = 0; i <= kFrames; ++i) expected.push_back({Stage::kReading, i, kFrames});
    for (const Stage stage : {Stage::kStarting, Stage::kRefining})
      for (const std::size_t done : {0u, 1u}) expected.push_back({stage, done, 1});
    EXPECT_EQ(told, expected);
  }
}

// The flag is set as the stage begins, as Ctrl-C or another thread could.
TEST_F(FromSession, AStopFlagEndsEveryStageSoon) {
  for (const results::Method method : {results::Method::kLeastSquares, results::Method::kPaper})
    for (const Stage last : {Stage::kReading, Stage::kStarting, Stage::kRefining}) {
      StopFlag stop{false};
      std::vector<Stage> begun;
      std::chrono::steady_clock::time_point set;
      Options options;
      options.method = method;
      options.stop = &stop;
      options.progress = [&](Stage stage, std::size_t done, std::size_t) {
        if (done == 0) begun.push_back(stage);
        if (stage == last && !stop.exchange(true)) set = std::chrono::steady_clock::now();
      };
      const auto estimate = EstimateSession(session(), options);
      ASSERT_FALSE(estimate);
      EXPECT_EQ(estimate.error().kind, ErrorKind::kInterrupted);
      EXPECT_EQ(begun.back(), last);
      EXPECT_LT(std::chrono::steady_clock::now() - set, std::chrono::seconds(2));
    }
}

TEST_F(FromSession, AFlagThatIsNeverSetChangesNothing) {
  StopFlag stop{false};
  Options options;
  options.stop = &stop;
  const auto watched = EstimateSession(session(), options);
  const auto alone = EstimateSession(session());
  ASSERT_TRUE(watched && alone);
  EXPECT_EQ(Json(watched->output.estimate), Json(alone->output.estimate));
}

TEST_F(FromSession, OptionsThatDoNotGoTogetherAreRefused) {
  Options options;
  options.views = kFrames + 1;
  EXPECT_THAT(Refusal(options), HasSubstr("--views: 7, allowed are at most the session's 6"));
  options.views = 0;
  EXPECT_THAT(Refusal(options), HasSubstr("--views: 0"));
  options = {};
  options.most_pixels = kFewestPixels - 1;
  EXPECT_THAT(Refusal(options), HasSubstr("--pixels: 9999, allowed are 10000 to 1000000000"));
  options = {};
  options.ceiling_distance_m = 3.0;
  EXPECT_THAT(Refusal(options), HasSubstr("--ceiling-distance: with --method paper only"));
  options = {};
  options.initial = model::InitialGuess{};
  options.model.lights = 2;
  EXPECT_THAT(Refusal(options), HasSubstr("not with --initial"));
  options.method = results::Method::kPaper;
  EXPECT_THAT(Refusal(options), HasSubstr("--initial: not with --method paper"));
  options.initial.reset();
  EXPECT_THAT(Refusal(options), HasSubstr("--model: not with --method paper"));
}

TEST_F(FromSession, AFolderThatIsNoSessionIsNamed) {
  const auto estimate = EstimateSession(session() / "nothing");
  ASSERT_FALSE(estimate);
  EXPECT_THAT(estimate.error().text, HasSubstr("nothing"));
}

}  // namespace
}  // namespace turnlight::estimator::from_session
