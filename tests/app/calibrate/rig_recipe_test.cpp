// Proves: the config of `calibrate rig` is read with all its keys, what a step needs and lacks is
// named, and a run's config comes out of it that names the calibration and finds its files from
// anywhere. Does not prove: that a rig is calibrated by it; calibrate_rig_study does.
#include "app/calibrate/rig_recipe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/calibrate/prop_stage.h"
#include "app/calibrate/rig_summary.h"
#include "app/run_config.h"
#include "base/file.h"
#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using testing::HasSubstr;

const std::filesystem::path kConfigs = std::filesystem::path(TURNLIGHT_SOURCE_DIR) / "configs";

class RigRecipeTest : public testing::Test {
 protected:
  RigRecipeTest() {
    std::filesystem::create_directories(folder_ / "hil");
    std::filesystem::copy(kConfigs / "sim_calibrate.yaml", folder_ / "sim_calibrate.yaml");
    std::filesystem::copy(kConfigs / "hil/target.ply", folder_ / "hil/target.ply");
  }
  // What is said of the config with one text for another.
  std::string Refusal(const std::string& what, const std::string& by) const {
    std::string changed = text_;
    Replace(changed, what, by);
    WriteText(folder_ / "changed.yaml", changed);
    const auto recipe = ReadRigRecipe(folder_ / "changed.yaml");
    return recipe ? "accepted" : recipe.error().text;
  }

  const TemporaryFolder folder_;
  const std::string text_ = ReadText(kConfigs / "calibrate_hil.yaml");
};

TEST_F(RigRecipeTest, TheConfigThatShipsIsRead) {
  const auto recipe = ReadRigRecipe(kConfigs / "calibrate_hil.yaml");
  ASSERT_TRUE(recipe) << recipe.error().text;
  EXPECT_EQ(recipe->board.columns, 10);
  EXPECT_EQ(recipe->lens_model, "LENSMODEL_OPENCV8");
  EXPECT_EQ(recipe->axis.count, 18);
  EXPECT_EQ(recipe->board_height, 2.0);
  EXPECT_EQ(recipe->response->pairs, 2);
  EXPECT_TRUE(recipe->simulator);
  EXPECT_EQ(*recipe->simulator->camera->camera.noise_seed, 1u);
  EXPECT_EQ(recipe->props.size(), 5u);
  EXPECT_TRUE(std::holds_alternative<calib::MeshShape>(recipe->shape));
}

TEST_F(RigRecipeTest, ARunsConfigComesOutOfIt) {
  const auto recipe = ReadRigRecipe(kConfigs / "calibrate_hil.yaml");
  ASSERT_TRUE(recipe);
  auto truth = TruthOf(*recipe->simulator);
  ASSERT_TRUE(truth) << truth.error().text;
  const std::filesystem::path calibration = folder_ / "rig-calibration.json";
  ASSERT_TRUE(rig::WriteRigCalibration(truth->calibration, calibration));
  const auto text = RunTextWith(*recipe, calibration);
  ASSERT_TRUE(text) << text.error().text;
  EXPECT_THAT(*text, testing::Not(HasSubstr("simulator:")));
  WriteText(folder_ / "rig.yaml", *text);
  const auto run = ReadRunConfig(folder_ / "rig.yaml");
  ASSERT_TRUE(run) << run.error().text;
  EXPECT_EQ(run->name, "calibrate_hil");
  EXPECT_TRUE(run->calibration);
  EXPECT_EQ(run->graph.nodes.front().name, "keyframes");
}

TEST_F(RigRecipeTest, WhatIsWrongIsNamed) {
  EXPECT_THAT(Refusal("lens_model: OPENCV8", "lens_model: OPENCV9"), HasSubstr("lens_model"));
  EXPECT_THAT(Refusal("exposures_us: [500, 1000, 2000, 3000, 4000, 6000, 8000, 10000, 12000]",
                      "exposures_us: [500, 1000]"),
              HasSubstr("a list of 3 to 64 exposures"));
  EXPECT_THAT(Refusal("    empty: {kind: empty}\n", ""), HasSubstr("props/empty"));
  EXPECT_THAT(Refusal("config: sim_calibrate.yaml", "config: none.yaml"), HasSubstr("none.yaml"));
  EXPECT_THAT(Refusal("  length_unit: mm\n", "  length_unit: mm\n  calibration: a.json\n"),
              HasSubstr("it is what this command finds"));
  EXPECT_THAT(Refusal("  axis: {count: 18", "  axis: {counts: 18"), HasSubstr("counts"));
  EXPECT_EQ(Refusal("noise_seed: 1", "noise_seed: 2"), "accepted");
}

TEST_F(RigRecipeTest, TheTruthIsInTheFrameThatACalibrationChooses) {
  const auto recipe = ReadRigRecipe(kConfigs / "calibrate_hil.yaml");
  ASSERT_TRUE(recipe);
  const auto truth = TruthOf(*recipe->simulator);
  ASSERT_TRUE(truth);
  const auto plain = CalibrationOf(*recipe->simulator);
  ASSERT_TRUE(plain) << plain.error().text;
  const calib::TurntableGeometry &chosen = truth->calibration.geometry, &as_is = plain->geometry;
  EXPECT_NEAR(chosen.X_WC.translation.y(), 0.0, 1e-9);
  EXPECT_GT(chosen.X_WC.translation.x(), 0.0);
  for (const double angle_deg : {0.0, 77.0}) {
    const auto a = calib::PosesAt(chosen, angle_deg), b = calib::PosesAt(as_is, angle_deg);
    const calib::Pose X_CT = a.X_WC.Inverse() * a.X_WT, other = b.X_WC.Inverse() * b.X_WT;
    EXPECT_LT((X_CT.translation - other.translation).norm(), 1e-9);
    EXPECT_LT((X_CT.rotation - other.rotation).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace turnlight::app
