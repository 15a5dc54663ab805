#include <gtest/gtest.h>

#include <cstdio>

#include "rig/sim/blob.h"
#include "tests/loop/stage_loop.h"
#include "tests/nodes/static_render.h"
using namespace turnlight;
TEST(D, D) {
  rig::sim::MockCameraConfig config;
  config.scene.target = rig::sim::Blob{};
  config.scene.motion.kind = rig::sim::MotionKind::kTable;
  config.scene.camera = {64, 48, 200.0, std::nullopt};
  config.scene.sensor.noise_relative = 0.0003;
  config.scene.samples_per_side = 2;
  auto run = loop::RunStageLoop(loop::SmallStageLoop("grbl"));
  for (auto& b : run.brackets) {
    std::printf("%g measured %g:", b.angle_deg, b.angle_measured_deg);
    for (double d : {-0.1, -0.05, -0.02, 0.0, 0.02, 0.05, 0.1}) {
      auto c = b;
      c.angle_deg += d;
      std::printf(" %g:%.1f", d, nodes::WorstSigmas({c}, config));
    }
    std::printf("\n");
  }
}
