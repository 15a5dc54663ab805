// Proves: of views that tell nothing new the note names the cause that was put there: the same
// pose, copies, a table that stood still, a body of revolution; and copies are not claimed where
// nothing could show them. Does not prove anything of views that differ.
#include "estimator/view_evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/random.h"
#include "tests/estimator/small_scene.h"

namespace turnlight::estimator {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Six views of a target that turns.
rig::sim::SyntheticConfig Turning(const rig::sim::SyntheticTarget& target, double noise) {
  rig::sim::SyntheticConfig config = TwoLightBall(5, noise, 0.1);
  LightsOf(config).resize(1);
  config.target = target;
  config.motion.kind = rig::sim::MotionKind::kTable;
  config.camera = {.width = 60, .height = 45, .focal_px = 150.0, .distortion = {}};
  return config;
}
const rig::sim::SyntheticTarget kLump =
    rig::sim::Blob{.radius = 40.0, .depth = 0.3, .segments = 48};
const rig::sim::SyntheticTarget kBall = calib::SphereShape{40.0};

// The note's text, or the refusal's.
std::string Said(const std::vector<model::Keyframe>& keyframes,
                 const rig::sim::SyntheticSession& session, EstimateOptions options = {}) {
  const auto output = EstimateScene(keyframes, target::Geometry(session.target),
                                    calib::RayGrid(session.camera), options);
  if (!output) return output.error().text;
  for (const Note& note : output->estimate.notes)
    if (note.code == "views-add-nothing") return note.text;
  return "";
}

TEST(ViewEvidence, ViewsThatDifferHaveNoNote) {
  const auto session = *rig::sim::SynthesizeInMemory(Turning(kLump, 0.003));
  EXPECT_EQ(Said(rig::sim::ToKeyframes(session), session), "");
}

TEST(ViewEvidence, ABodyOfRevolutionIsNoCopy) {
  for (const double noise : {0.0, 0.003}) {
    const auto session = *rig::sim::SynthesizeInMemory(Turning(kBall, noise));
    const std::string said = Said(rig::sim::ToKeyframes(session), session);
    EXPECT_THAT(said, AllOf(HasSubstr("1 of 6 views differ"), HasSubstr("body of revolution"),
                            Not(HasSubstr("copies"))))
        << noise;
  }
  // Copies of it look like what they should.
  const auto session = *rig::sim::SynthesizeInMemory(Turning(kBall, 0.003));
  auto keyframes = rig::sim::ToKeyframes(session);
  keyframes[4].image = keyframes[3].image;
  EXPECT_THAT(Said(keyframes, session), Not(HasSubstr("copies")));
}

TEST(ViewEvidence, CopiesAreNamed) {
  const auto session = *rig::sim::SynthesizeInMemory(Turning(kLump, 0.003));
  auto keyframes = rig::sim::ToKeyframes(session);
  keyframes[4].image = keyframes[3].image;
  EstimateOptions options;
  options.frame_numbers = {0, 5, 10, 15, 20, 25};
  EXPECT_THAT(Said(keyframes, session, options),
              AllOf(HasSubstr("1 are copies of others, value for value"),
                    HasSubstr("frame 20 and frame 15"), Not(HasSubstr("body of revolution"))));
  keyframes.resize(3);
  for (auto& keyframe : keyframes) keyframe.image = keyframes[0].image;
  EXPECT_THAT(Said(keyframes, session), AllOf(HasSubstr("2 "), HasSubstr("are copies of others"),
                                              Not(HasSubstr("body of revolution"))));
}

// The same view again, with noise of its own.
TEST(ViewEvidence, ATableThatStoodStillIsNoBodyOfRevolution) {
  const double noise = 0.003;
  const auto session = *rig::sim::SynthesizeInMemory(Turning(kLump, noise));
  auto keyframes = rig::sim::ToKeyframes(session);
  const RandomStream random(9, 1);
  std::uint64_t draw = 0;
  keyframes[4].image.radiance = keyframes[3].image.radiance.clone();
  for (cv::Vec3f& value : cv::Mat3f(keyframes[4].image.radiance))
    for (int c = 0; c < 3; ++c) value[c] += static_cast<float>(noise * random.Normal(draw++));
  EXPECT_THAT(
      Said(keyframes, session),
      AllOf(HasSubstr("frame 4 and frame 3"), HasSubstr("the model predicts differences"),
            HasSubstr("Check that the table turned"), Not(HasSubstr("body of revolution"))));
}

TEST(ViewEvidence, TheSamePoseAgainIsARepetition) {
  const auto session = *rig::sim::SynthesizeInMemory(Turning(kLump, 0.003));
  auto keyframes = rig::sim::ToKeyframes(session);
  keyframes.push_back(keyframes[2]);
  EXPECT_THAT(Said(keyframes, session),
              AllOf(HasSubstr("6 of 7 views differ"), HasSubstr("repeat a pose"),
                    Not(HasSubstr("copies")), Not(HasSubstr("body of revolution"))));
}

}  // namespace
}  // namespace turnlight::estimator
