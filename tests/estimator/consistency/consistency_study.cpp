// What the checks find and whom they accuse, over random scenes: every kind of odd frame, every
// kind of wrong poses, right captures, lamps that drift, and lumps with a symmetry. Long; a study.
//   ctest --preset release -L study -R Consistency -V
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/estimator/consistency/mangled.h"

namespace turnlight::estimator::consistency {
namespace {

Consistency Checked(const Capture& capture, bool all_changes = false) {
  const target::Geometry geometry(capture.session.target);
  return CheckConsistency(SmallViewsOf(capture, geometry), capture.angles_deg, geometry, {},
                          all_changes, nullptr);
}

bool NamesJust(const Consistency& found, const std::vector<std::size_t>& frames) {
  if (found.change || found.frames.odd != frames.size()) return false;
  for (const std::size_t k : frames)
    if (!found.frames.frames[k].odd) return false;
  return true;
}

TEST(ConsistencyStudy, OneOddFrameOf36AndTwoOf12) {
  for (const Shape shape : {Shape::kLump, Shape::kSphere})
    for (const char* kind : kOddKinds) {
      int named = 0, tried = 0, pairs_named = 0, pairs = 0;
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const Capture capture = Captured(RandomCapture(seed, shape, 36));
        Capture odd = CopyOf(capture);
        const std::size_t frame = 10 * (seed - 1);
        MakeOdd(odd, kind, frame);
        named += NamesJust(Checked(odd), {frame}) ? 1 : 0;
        ++tried;
        Capture few = Captured(RandomCapture(seed, shape, 12));
        MakeOdd(few, kind, seed);
        MakeOdd(few, kind, seed + 6);
        pairs_named += NamesJust(Checked(few), {seed, seed + 6}) ? 1 : 0;
        ++pairs;
      }
      std::printf("%-7s %-13s one of 36: %d of %d, two of 12: %d of %d\n",
                  shape == Shape::kLump ? "lump" : "sphere", kind, named, tried, pairs_named,
                  pairs);
      // All frames of a turning ball are the same.
      const int expected = shape == Shape::kSphere && std::string(kind) == "stale" ? 0 : tried;
      EXPECT_EQ(named, expected) << kind;
      EXPECT_EQ(pairs_named, expected) << kind;
    }
}

TEST(ConsistencyStudy, WrongPosesOfLumps) {
  for (const char* mistake : kPoseMistakes) {
    int named = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Capture capture = Captured(RandomCapture(seed, Shape::kLump, 36));
      MisplacePoses(capture, mistake, seed);
      const Consistency found = Checked(capture);
      if (NamesMistake(found, mistake))
        ++named;
      else
        std::printf("  seed %llu: %s\n", static_cast<unsigned long long>(seed),
                    found.change ? found.change->words.c_str() : "nothing was told");
    }
    std::printf("%-18s %d of 20\n", mistake, named);
    EXPECT_EQ(named, 20) << mistake;
  }
}

TEST(ConsistencyStudy, RightCapturesAccuseNobody) {
  int accused = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Capture capture =
        Captured(RandomCapture(seed, seed % 4 == 0 ? Shape::kSphere : Shape::kLump, 36));
    if (seed % 3 != 0) LetLampDrift(capture, 0.05, seed % 3 == 1, seed);
    const Consistency found = Checked(capture, true);
    if (!found.change && found.frames.odd == 0) continue;
    ++accused;
    std::printf("  seed %llu: %zu odd frames, %s\n", static_cast<unsigned long long>(seed),
                found.frames.odd, found.change ? found.change->words.c_str() : "no change");
  }
  std::printf("accused falsely: %d of 100\n", accused);
  EXPECT_EQ(accused, 0);
}

TEST(ConsistencyStudy, LumpsWithASymmetry) {
  int accused = 0, claimed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Capture capture = CapturedSymmetric(seed, 2 + static_cast<int>(seed % 5), 36);
    const Consistency right = Checked(capture, true);
    if (right.change || right.frames.odd > 0) {
      ++accused;
      std::printf("  seed %llu: %zu odd frames, %s\n", static_cast<unsigned long long>(seed),
                  right.frames.odd, right.change ? right.change->words.c_str() : "no change");
      for (const FrameJudgement& frame : right.frames.frames)
        if (frame.odd) std::printf("    %s\n", frame.what.c_str());
    }
    // One that looks the same after every step: no mistake of angles shows.
    Capture same = CapturedSymmetric(seed, 18, 18);
    MisplacePoses(same, "angles-reversed", seed);
    claimed += Checked(same, true).change ? 1 : 0;
  }
  std::printf("accused falsely: %d of 20, claimed: %d of 20\n", accused, claimed);
  EXPECT_EQ(accused, 0);
  EXPECT_EQ(claimed, 0);
}

}  // namespace
}  // namespace turnlight::estimator::consistency
