// Proves of the node that leads a capture by hand, with a simulated camera that is carried: poses
// as they truly were, views as far apart as asked, guidance that says what is wrong; bounded
// patience with a camera that fails and with a person who shows nothing new; views that were kept
// before are not taken again. Does not test the session (tests/app) nor real cameras.
#include "nodes/handheld_keyframes_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/angles.h"
#include "calib/calibrate/handheld/view_change.h"
#include "nodes/capture_nodes.h"
#include "nodes/graph/graph.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/mock_drivers.h"

namespace turnlight::nodes {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kWorld[] =
    "target: {shape: sphere, radius: 15}\n"
    "motion: {kind: orbit, distance: 420, elevation_deg: 40}\n"
    "camera: {size: [320, 240], focal_px: 520}\n"
    "lights: [{direction: [0.5, -0.3, 0.8], distance: 800}]\n"
    "sensor: {bits: 16, noise_relative: 0.002}\n"
    "samples_per_side: 2\n"
    "walk:\n"
    "  board: {columns: 7, rows: 4, spacing: 20}\n"
    "  quiet_border: 20\n"
    "  at: [0, 75, 15]\n"
    "  speed_deg_s: 9\n";

constexpr char kGraph[] =
    "graph:\n"
    "  executor: virtual\n"
    "  seed: 1\n"
    "  nodes:\n"
    "    keyframes:\n"
    "      type: handheld_keyframes\n"
    "      params: {board: {columns: 7, rows: 4, spacing: 20}, at: [0, 75, 15], pause_ms: 300,\n"
    "               idle_timeout_s: 4}\n"
    "    camera: {type: camera}\n"
    "  connections:\n"
    "    - {from: keyframes.expose, to: camera.expose}\n"
    "  record: []\n";

struct Options {
  std::string world = kWorld, graph = kGraph;
  std::vector<rig::sim::FaultEntry> faults{};
  std::vector<calib::RigPoses> kept{};
};

struct Walked {
  std::vector<Bracket> brackets;
  std::vector<std::string> guidance, faults;
  graph::RunReport report;
  rig::sim::Walk walk;
  calib::OrbitGeometry orbit;

  std::string failure() const { return report.failure ? report.failure->text : ""; }
};

template <typename T>
T Expect(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text);
  return std::move(*result);
}

std::string With(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

Walked CarryIt(const Options& options, std::int64_t count = 3) {
  const auto document = Expect(ParseYaml(options.world, "world.yaml"));
  auto config = Expect(rig::sim::ReadSimulation(StrictObject(document), {}));
  config.faults = options.faults;
  auto world = Expect(rig::sim::BuildWorld(config));
  const auto driver = Expect(ParseYaml("driver: mock", "driver.yaml"));
  StrictObject keys(driver);
  keys.Ignore("driver");
  rig::RigSetup setup{.table = {},
                      .camera = Expect(rig::sim::MakeMockCamera(keys, world)),
                      .known = rig::sim::KnowledgeOf(world),
                      .target = rig::sim::TargetOf(world),
                      .calibration = {},
                      .truth = {},
                      .identity = {}};
  if (!rig::OpenRig(setup)) throw std::runtime_error("not open");
  KeyframesJob job;
  job.plan.by_hand = true;
  job.plan.count = count;
  job.plan.frame_timeout_s = 1.0;
  auto work = std::make_shared<CaptureWork>();
  work->frames = rig::PlannedFrames(job.plan);
  work->kept = options.kept;
  auto graph =
      Expect(graph::Graph::Build(Expect(graph::ParseGraphConfig(options.graph, "by_hand.yaml")),
                                 CaptureNodes({setup, job, work})));
  Walked walked;
  walked.walk = *world.config.camera.walk;
  walked.orbit = std::get<calib::OrbitGeometry>(world.studio->rig);
  Status tapped = graph.Tap<Bracket>("keyframes.bracket", [&](const graph::Message<Bracket>& m) {
    walked.brackets.push_back(*m);
  });
  if (tapped)
    tapped = graph.Tap<Guidance>("keyframes.guide", [&](const graph::Message<Guidance>& m) {
      walked.guidance.push_back(m->text);
    });
  if (tapped)
    tapped = graph.Tap<graph::Fault>("keyframes.fault", [&](const graph::Message<graph::Fault>& m) {
      walked.faults.push_back(m->text);
    });
  if (!tapped) throw std::runtime_error(tapped.error().text);
  walked.report = Expect(graph.Run());
  return walked;
}

Eigen::Vector3d Direction(const calib::RigPoses& poses) {
  return calib::calibrate::handheld::ViewDirection(poses.X_WT.Inverse() * poses.X_WC);
}

TEST(HandheldKeyframes, AreWhereTheCameraTrulyWas) {
  const Walked walked = CarryIt({});
  ASSERT_EQ(walked.failure(), "");
  ASSERT_EQ(walked.brackets.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Bracket& bracket = walked.brackets[i];
    ASSERT_TRUE(bracket.placed);
    EXPECT_EQ(bracket.index, i);
    const Frame& frame = bracket.exposures.front();
    const calib::RigPoses truth =
        PosesOf(walked.walk, walked.orbit,
                WalkedDeg(walked.walk, (frame.exposure_begin + frame.exposure_end) / 2));
    EXPECT_LT((bracket.placed->X_WC.translation - truth.X_WC.translation).norm(), 2.0) << i;
    EXPECT_LT((bracket.placed->X_WC.rotation - truth.X_WC.rotation).norm(), 0.01) << i;
    EXPECT_LT((bracket.placed->X_WT.translation - truth.X_WT.translation).norm(), 1e-12);
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_LT(Direction(*bracket.placed).dot(Direction(*walked.brackets[j].placed)),
                std::cos(DegToRad(10.0)) + 1e-12);
  }
  EXPECT_THAT(walked.guidance, Contains("move on to the right"));
  EXPECT_EQ(walked.guidance.back(), "done");
}

TEST(HandheldKeyframes, ViewsKeptBeforeAreNotTakenAgain) {
  const Walked first = CarryIt({});
  Options options;
  options.graph = With(kGraph, "idle_timeout_s: 4", "idle_timeout_s: 20");
  for (const Bracket& bracket : first.brackets) options.kept.push_back(*bracket.placed);
  const Walked second = CarryIt(options, 1);
  ASSERT_EQ(second.brackets.size(), 1u);
  for (const calib::RigPoses& kept : options.kept)
    EXPECT_LT(Direction(*second.brackets[0].placed).dot(Direction(kept)),
              std::cos(DegToRad(10.0)) + 1e-12);
}

TEST(HandheldKeyframes, APersonWhoShowsNothingNewIsToldWhyUntilTheTimeIsUp) {
  const Walked blank = CarryIt({.world = With(kWorld, "  quiet_border: 20\n", "  dark: 0.8\n")});
  EXPECT_TRUE(blank.brackets.empty());
  EXPECT_THAT(blank.guidance, Contains(HasSubstr("no board in view")));
  EXPECT_THAT(blank.failure(), HasSubstr("no new keyframe for 4 s, the last picture: no board"));
  EXPECT_EQ(blank.report.failure->code, "incomplete");
  const Walked blurred =
      CarryIt({.graph = With(kGraph, "pause_ms: 300", "pause_ms: 300, blur_max_px: 0.1")});
  EXPECT_THAT(blurred.guidance, Contains(HasSubstr("too blurred: edges of ")));
  EXPECT_TRUE(blurred.brackets.empty());
  const Walked still = CarryIt({.world = With(kWorld, "speed_deg_s: 9", "speed_deg_s: 0.01")});
  EXPECT_EQ(still.brackets.size(), 1u);
  EXPECT_THAT(still.guidance, Contains(HasSubstr("move on ")));
  const Walked dark = CarryIt({.world = With(kWorld, "sensor: {bits: 16, noise_relative: 0.002}",
                                             "shutter: {reference_exposure_us: 9000000}")});
  EXPECT_THAT(dark.guidance.front(), HasSubstr("black"));
}

TEST(HandheldKeyframes, ACameraThatFailsIsTriedAgainAsOftenAsThePlanSays) {
  const auto dropped = [](int times) {
    rig::sim::FaultEntry fault = rig::sim::MakeFault(rig::sim::FaultKind::kDroppedFrame);
    fault.times = times;
    return Options{.faults = {fault}};
  };
  const Walked once = CarryIt(dropped(2));
  EXPECT_EQ(once.failure(), "");
  ASSERT_EQ(once.brackets.size(), 3u);
  EXPECT_EQ(once.brackets[0].attempts, 3);
  EXPECT_THAT(once.faults, ElementsAre(HasSubstr("picture 1 of 4: no picture came"),
                                       HasSubstr("picture 2 of 4")));
  const Walked ever = CarryIt(dropped(100));
  EXPECT_THAT(ever.failure(), HasSubstr("picture 4 of 4: no picture came in answer"));
  EXPECT_EQ(ever.report.failure->code, "device");
}

TEST(HandheldKeyframes, ABoardThatLooksTheSameFromTwoSidesIsRefused) {
  try {
    CarryIt({.graph = With(kGraph, "columns: 7", "columns: 8")});
    ADD_FAILURE() << "it ran";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("looks the same from several sides"));
  }
}

}  // namespace
}  // namespace turnlight::nodes
