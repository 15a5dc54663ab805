// Proves: the need that is said grows with what it should grow with; a refusal names a number of
// pixels and of views that do fit; sizes are read as people write them. Does not prove that the
// need is right: large_pictures_test does for small ones, and docs/estimation.md has what was
// measured at 24 megapixels.
#include "estimator/memory_need.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "estimator/observe/observed_scene.h"

namespace turnlight::estimator {
namespace {

using ::testing::HasSubstr;

// The session that the program was measured with.
MemoryInputs LargeSession() {
  MemoryInputs inputs;
  inputs.picture_pixels = 24'000'000;
  inputs.keyframes = 36;
  inputs.target_pixels = 36 * 4'000'000;
  inputs.most_pixels = observe::kMostPixels;
  inputs.casts_shadows = true;
  return inputs;
}

TEST(MemoryNeed, GrowsWithWhatIsHeld) {
  const MemoryInputs large = LargeSession();
  const double need = MemoryNeed(large);
  MemoryInputs other = large;
  other.keyframes = 72;
  other.target_pixels *= 2;
  EXPECT_LT(MemoryNeed(other), 1.05 * need) << "pictures are not held";
  other = large;
  other.most_pixels = 2'000'000;
  EXPECT_LT(MemoryNeed(other), 0.7 * need);
  other = large;
  other.noise_known = true;
  EXPECT_GT(MemoryNeed(other), need);
  other = large;
  other.casts_shadows = false;
  EXPECT_LT(MemoryNeed(other), need);
}

TEST(CheckMemory, SaysWhatWouldFit) {
  const MemoryInputs large = LargeSession();
  EXPECT_TRUE(CheckMemory(large, 1e11));
  const Status refused = CheckMemory(large, 2.5e9);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  const std::string& text = refused.error().text;
  EXPECT_THAT(text, HasSubstr("--max-memory: the estimate would need up to "));
  EXPECT_THAT(text, HasSubstr("allowed are 2.5 GB"));
  const std::size_t at = text.find("--pixels "), or_at = text.find(" or --views ");
  ASSERT_NE(at, std::string::npos) << text;
  ASSERT_NE(or_at, std::string::npos) << text;
  MemoryInputs fewer = large;
  fewer.most_pixels = std::stoul(text.substr(at + 9));
  EXPECT_TRUE(CheckMemory(fewer, 2.5e9));
  fewer = large;
  fewer.keyframes = std::stoul(text.substr(or_at + 12));
  fewer.target_pixels = fewer.keyframes * 4'000'000;
  EXPECT_TRUE(CheckMemory(fewer, 2.5e9));
  const Status nothing_fits = CheckMemory(large, 1e9);
  ASSERT_FALSE(nothing_fits);
  EXPECT_THAT(nothing_fits.error().text, HasSubstr("no number of pixels or views would fit"));
}

TEST(BytesOf, ReadsSizesAsPeopleWriteThem) {
  EXPECT_EQ(BytesOf("4GB").value(), 4e9);
  EXPECT_EQ(BytesOf("800 MB").value(), 8e8);
  EXPECT_EQ(BytesOf("1.5GiB").value(), 1.5 * 1073741824.0);
  EXPECT_EQ(BytesOf("2G").value(), 2e9);
  for (const char* bad : {"", "GB", "4", "4 apples", "-1GB", "0GB", "nanGB", "4GBs"}) {
    const auto bytes = BytesOf(bad);
    ASSERT_FALSE(bytes) << bad;
    EXPECT_THAT(bytes.error().text, HasSubstr("such as 4GB"));
  }
}

}  // namespace
}  // namespace turnlight::estimator
