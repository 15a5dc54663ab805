// Proves: an estimate of pictures that are traced in steps takes less memory than what is said
// beforehand, and few pixels of them give the same bits on any number of threads; it is refused
// when it does not fit. Does not prove how near the prediction is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <string>
#include <variant>

#include "base/parallel.h"
#include "estimator/from_session/session_estimate.h"
#include "estimator/memory_need.h"
#include "estimator/results/result_json.h"
#include "rig/sim/synthetic_session.h"
#include "tests/temporary_folder.h"

namespace turnlight::estimator::from_session {
namespace {

using ::testing::HasSubstr;

// Three pictures that are traced in steps, of a lump that shadows itself.
class LargePictures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    rig::sim::SyntheticConfig config;
    config.target = rig::sim::Blob{};
    config.motion.frames = 3;
    config.motion.step_deg = 40.0;
    config.camera = {1280, 900, 2600.0, {}};
    config.samples_per_side = 1;
    const auto written = rig::sim::WriteSynthetic(config, Folder());
    ASSERT_TRUE(written) << written.error().text;
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::filesystem::path Folder() { return folder_->path() / "s"; }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
};

// The most that the process has held since the last call, in bytes; none where that is not told.
std::optional<double> TakePeak() {
  std::ifstream status("/proc/self/status");
  std::optional<double> peak;
  for (std::string word; status >> word;)
    if (double kilobytes = 0.0; word == "VmHWM:" && status >> kilobytes) peak = 1024.0 * kilobytes;
  std::ofstream reset("/proc/self/clear_refs");
  reset << "5" << std::flush;
  return reset ? peak : std::nullopt;
}

TEST_F(LargePictures, TakeLessThanIsSaidAndGiveTheSameBitsOnAnyNumberOfThreads) {
  Options options;
  options.most_pixels = 60'000;
  std::optional<std::string> before;
  for (const int threads : {1, 3}) {
    SetThreads(threads);
    TakePeak();
    const auto done = EstimateSession(Folder(), options);
    const auto peak = TakePeak();
    ASSERT_TRUE(done) << done.error().text;
    EXPECT_LE(done->output.estimate.pixels, options.most_pixels);
    EXPECT_THAT(done->output.estimate.notes,
                testing::Contains(testing::Field(&Note::code, "pixels-thinned")));
    Estimate timeless = done->output.estimate;
    timeless.initial_s = timeless.solve_s = 0.0;
    const std::string json =
        results::ResultToJson(timeless, "s", results::Method::kLeastSquares, {});
    EXPECT_EQ(before.value_or(json), json) << threads;
    before = json;
    MemoryInputs inputs;
    inputs.picture_pixels = 1280 * 900;
    inputs.keyframes = 3;
    inputs.target_pixels = TargetPixels(done->keyframes, done->geometry, *done->session.camera);
    EXPECT_GT(inputs.target_pixels, 3u * 60'000u);
    inputs.most_pixels = options.most_pixels;
    inputs.casts_shadows = true;
    inputs.mesh_faces = std::get<calib::MeshShape>(done->geometry.shape()).faces.size();
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    if (peak) {
      EXPECT_LT(*peak, MemoryNeed(inputs)) << threads;
    }
#endif
  }
  SetThreads(0);
}

TEST_F(LargePictures, AreRefusedWhenTheyDoNotFit) {
  Options options;
  options.max_memory = 1e8;
  const auto refused = EstimateSession(Folder(), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  EXPECT_THAT(refused.error().text, HasSubstr("allowed are 100 MB"));
}

}  // namespace
}  // namespace turnlight::estimator::from_session
