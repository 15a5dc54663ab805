// Proves, with the real program and a simulated rig on its real protocols: one command takes a rig
// whose lens, axis, response and target are unknown to a calibrated one, and its capture gives
// lights within 0.2 degrees of the truth and within 3 of their sigmas; so are axis and target; a
// second, independent calibration of the same rig agrees with the first; a finished command has
// nothing left to do. Does not prove: that sigmas are right over many draws; the parts' own studies
// do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/program.h"

namespace turnlight::app {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double kLightLimitDeg = 0.2;
constexpr double kSigmas = 3.0;

const std::filesystem::path kShipped = std::filesystem::path(TURNLIGHT_SOURCE_DIR) / "configs";

class CalibrateRigStudy : public testing::Test {
 protected:
  CalibrateRigStudy() {
    std::filesystem::create_directories(folder_ / "hil");
    for (const char* file : {"sim_calibrate.yaml", "hil/target.ply"})
      std::filesystem::copy(kShipped / file, folder_ / file);
  }

  // Another seed is another calibration of the same rig.
  json Calibrate(int seed) {
    std::string text = ReadText(kShipped / "calibrate_hil.yaml");
    Replace(text, "noise_seed: 1", "noise_seed: " + std::to_string(seed));
    Replace(text, "kind: handheld\n", "kind: handheld\n      seed: " + std::to_string(seed) + "\n");
    const std::string config = folder_ / ("rig" + std::to_string(seed) + ".yaml");
    WriteText(config, text);
    const Outcome outcome = RunProgram({"calibrate", "rig", config, "--out", Out(seed)});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    std::cout << outcome.out;
    return json::parse(ReadText(Out(seed) + "/summary.json"));
  }
  std::string Out(int seed) const { return folder_ / ("out" + std::to_string(seed)); }

  const TemporaryFolder folder_;
};

double DegBetween(const json& a, const json& b) {
  double dot = 0.0;
  for (std::size_t i = 0; i < 3; ++i) dot += a[i].get<double>() * b[i].get<double>();
  return std::acos(std::min(1.0, dot)) * 180.0 / M_PI;
}

void ExpectNearTruth(const json& summary) {
  const json& axis = summary["axis"];
  EXPECT_LT(axis["error"]["direction_deg"].get<double>(),
            kSigmas * axis["direction_sigma_deg"].get<double>());
  EXPECT_LT(axis["error"]["offset"].get<double>(), kSigmas * axis["offset_sigma"].get<double>());
  const json& target = summary["target"];
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LT(std::abs(target["error"]["position"][i].get<double>()),
              kSigmas * target["position_sigma"][i].get<double>());
  ASSERT_EQ(summary["lights"].size(), 2u);
  for (const json& light : summary["lights"]) {
    EXPECT_LT(light["error_deg"].get<double>(), kLightLimitDeg);
    EXPECT_LT(light["error_deg"].get<double>(),
              kSigmas * light["direction_sigma_deg"].get<double>());
    EXPECT_FALSE(light["budget"].empty());
  }
}

TEST_F(CalibrateRigStudy, TwoCalibrationsOfOneRigAreNearTheTruthAndAgree) {
  const json first = Calibrate(1), second = Calibrate(2);
  ExpectNearTruth(first);
  ExpectNearTruth(second);
  for (std::size_t i = 0; i < 2; ++i) {
    const json &a = first["lights"][i], &b = second["lights"][i];
    EXPECT_LT(DegBetween(a["direction"], b["direction"]),
              kSigmas * std::hypot(a["direction_sigma_deg"].get<double>(),
                                   b["direction_sigma_deg"].get<double>()));
  }
  const Outcome compared =
      RunProgram({"compare", Out(1) + "/capture/result", Out(2) + "/capture/result"});
  std::cout << compared.out;
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  const std::string before = ReadText(Out(1) + "/summary.json");
  Calibrate(1);
  EXPECT_EQ(ReadText(Out(1) + "/summary.json"), before);
}

}  // namespace
}  // namespace turnlight::app
