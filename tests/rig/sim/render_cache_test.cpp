// Proves that what the cache gives is the render, that it is given again without a copy, that old
// renders go when there are too many bytes, and that several threads may ask. Does not prove what a
// render looks like.
#include "rig/sim/render_cache.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace turnlight::rig::sim {
namespace {

SyntheticConfig Tiny() {
  SyntheticConfig config;
  config.target = Blob{40.0, 0.3, 16};
  config.motion.kind = MotionKind::kTable;
  config.camera = {.width = 16, .height = 12, .focal_px = 30.0, .distortion = {}};
  config.samples_per_side = 1;
  return config;
}
constexpr std::size_t kBytes = sizeof(cv::Vec3f) * 16 * 12;  // of one render

std::shared_ptr<const Studio> TinyStudio() {
  return std::make_shared<const Studio>(*BuildStudio(Tiny()));
}

TEST(RenderCache, GivesTheRenderAndGivesItAgain) {
  const auto studio = TinyStudio();
  RenderCache cache(studio, 100 * kBytes);
  const cv::Mat3f radiance = cache.Radiance({30.0});
  const cv::Mat3f expected = RenderPlacement(*studio, PlaceAt(Tiny().motion, 30.0)).radiance;
  EXPECT_EQ(cv::norm(radiance, expected, cv::NORM_INF), 0.0);
  EXPECT_EQ(cache.Radiance({30.0}).data, radiance.data);
  EXPECT_NE(cache.Radiance({30.0, false}).data, radiance.data);
  EXPECT_NE(cache.Radiance({40.0}).data, radiance.data);
  EXPECT_EQ(cache.bytes(), 3 * kBytes);
}

TEST(RenderCache, ForgetsWhatWasAskedForLongestAgo) {
  RenderCache cache(TinyStudio(), 2 * kBytes);
  const cv::Mat3f first = cache.Radiance({0.0});
  const cv::Mat3f second = cache.Radiance({10.0});
  EXPECT_EQ(cache.Radiance({0.0}).data, first.data);  // the newest now
  cache.Radiance({20.0});
  EXPECT_EQ(cache.bytes(), 2 * kBytes);
  EXPECT_EQ(cache.Radiance({0.0}).data, first.data);
  EXPECT_NE(cache.Radiance({10.0}).data, second.data);
}

TEST(RenderCache, KeepsOneWhateverItsSize) {
  RenderCache cache(TinyStudio(), 0);
  cache.Radiance({0.0});
  const cv::Mat3f radiance = cache.Radiance({10.0});
  EXPECT_EQ(cache.Radiance({10.0}).data, radiance.data);
  EXPECT_EQ(cache.bytes(), kBytes);
}

TEST(RenderCache, SeveralThreadsGetTheSame) {
  RenderCache cache(TinyStudio(), 3 * kBytes);
  std::vector<cv::Mat3f> got(8);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < got.size(); ++i)
    threads.emplace_back([&, i] { got[i] = cache.Radiance({10.0 * static_cast<double>(i % 2)}); });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < got.size(); ++i)
    EXPECT_EQ(cv::norm(got[i], got[i % 2], cv::NORM_INF), 0.0);
  EXPECT_LE(cache.bytes(), 3 * kBytes);
}

}  // namespace
}  // namespace turnlight::rig::sim
