// Proves: every prop is read with its keys and wrong ones are refused by file, line, key and range;
// a board on the table lies where it is said, printed side up, and turns with the table; boards
// held by hand are whole in the picture and differ from picture to picture; a field is even but for
// the vignetting; pictures of a prop have noise of their own each, those of the target have not.
// Does not prove: how a board is rendered (board_picture_test).
#include "rig/sim/prop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/calibrate/board/board_print.h"
#include "rig/sim/board_picture.h"
#include "rig/sim/mock_camera.h"
#include "rig/sim/simulation.h"

namespace turnlight::rig::sim {
namespace {

using ::testing::HasSubstr;

constexpr char kBoardOf6[] = "board: {columns: 6, rows: 4, spacing: 20}";
const std::string kSmall =
    "motion: {kind: table, distance: 400, elevation_deg: 40}\n"
    "camera: {size: [160, 120], focal_px: 200, vignetting: 0.5}\n"
    "lights: [{direction: [0, 0, 1]}]\n"
    "reflectance: {model: none, albedo: [0.5, 0.5, 0.5], ambient: 0.1, diffuse: 0.5}\n";

Result<Prop> Read(const std::string& yaml) {
  const auto document = ParseYaml(yaml, "t.yaml");
  if (!document) return Forward(document);
  return ReadProp(StrictObject(*document));
}

SimulationConfig WorldOf(const std::string& more) {
  const auto document = ParseYaml(kSmall + more, "t.yaml");
  EXPECT_TRUE(document);
  auto config = ReadSimulation(StrictObject(*document), {});
  EXPECT_TRUE(config) << config.error().text;
  return *config;
}

Studio StudioWith(const std::string& more) {
  auto studio = BuildStudio(WorldOf(more).camera);
  EXPECT_TRUE(studio);
  return std::move(*studio);
}

TEST(Prop, EveryKindIsRead) {
  const auto board = Read(std::string("kind: board\n") + kBoardOf6 +
                          "\noffset: [1, 2, 3]\nturn_deg: [0, 0, 30]\nbright: 0.9\ndark: 0.1\n"
                          "background: 0.3\nquiet_border: 5\nblur_px: 0");
  ASSERT_TRUE(board) << board.error().text;
  const auto& table = std::get<TableBoard>(*board);
  EXPECT_EQ(table.board.columns, 6);
  EXPECT_EQ(table.board.spacing, 20.0);
  EXPECT_EQ(table.offset, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(table.look.quiet_border, 5.0);

  const auto held = Read(
      "kind: handheld\nseed: 3\ndistance: [200, 300]\ntilt_max_deg: 10\nroll_max_deg: 5\n"
      "board: {kind: charuco, columns: 5, rows: 4, spacing: 20, marker: 14, dictionary: 4X4_50}");
  ASSERT_TRUE(held) << held.error().text;
  EXPECT_EQ(std::get<HandheldBoard>(*held).seed, 3u);
  EXPECT_EQ(std::get<HandheldBoard>(*held).board.dictionary, "4X4_50");

  const auto ball = Read("kind: ball\nradius: 20\noffset: [1, 2, 20]\nlamp_radius_deg: 2");
  ASSERT_TRUE(ball) << ball.error().text;
  EXPECT_EQ(std::get<BallOnTable>(*ball).radius, 20.0);
  EXPECT_EQ(std::get<BallOnTable>(*ball).offset, Eigen::Vector3d(1, 2, 20));

  const auto grey = Read("kind: grey\nradiance: 0.4\ncolour: [1, 0.5, 2]");
  ASSERT_TRUE(grey);
  EXPECT_EQ(std::get<EvenField>(*grey).radiance, Eigen::Vector3d(0.4, 0.2, 0.8));
  EXPECT_EQ(std::get<EvenField>(*Read("kind: flat")).radiance.x(), 0.8);
  EXPECT_EQ(std::get<EvenField>(*Read("kind: dark")).radiance.x(), 0.0);
  EXPECT_EQ(std::get<EvenField>(*Read("kind: empty")).radiance.x(), 0.0);
  EXPECT_TRUE(std::holds_alternative<LampOff>(*Read("kind: lamp-off")));
}

TEST(Prop, WrongValuesAreNamed) {
  const std::string held = std::string("kind: handheld\n") + kBoardOf6;
  for (const auto& [yaml, says] :
       {std::pair<std::string, const char*>("kind: cube", "handheld"),
        {"kind: flat\nradiance: -1", "t.yaml:2: radiance: -1"},
        {"kind: dark\nradiance: 1", "unknown key"},
        {"kind: board", "board"},
        {"kind: board\nboard: {columns: 1, rows: 4, spacing: 20}", "columns: 1"},
        {"kind: board\nboard: {kind: charuco, columns: 5, rows: 4, spacing: 20}", "marker"},
        {held + "\ndistance: [300, 200]", "the smaller one first"},
        {held + "\noffset: [0, 0, 0]", "unknown key"},
        {held + "\ntilt_max_deg: 90", "tilt_max_deg: 90"}}) {
    const auto read = Read(yaml);
    ASSERT_FALSE(read) << yaml;
    EXPECT_THAT(read.error().text, HasSubstr(says));
  }
}

TEST(Prop, ABoardLiesOnTheTableAndTurnsWithIt) {
  const std::string text =
      std::string("prop: {kind: board, ") + kBoardOf6 + ", offset: [10, 0, 5], blur_px: 0}";
  const Studio studio = StudioWith(text);
  const auto& prop = std::get<TableBoard>(*studio.prop);
  const calib::Pose X_AB = PoseOf(prop);
  EXPECT_NEAR(X_AB.rotation(2, 2), -1.0, 1e-12);  // printed side up
  EXPECT_NEAR(X_AB.rotation(0, 0), 1.0, 1e-12);
  const Eigen::Vector2d middle = calib::calibrate::board::BoardPrint(prop.board).extent().center();
  EXPECT_LT((X_AB * Eigen::Vector3d(middle.x(), middle.y(), 0) - prop.offset).norm(), 1e-9);
  // Turned by 90 degrees its middle is at (0, 10, 5): what is seen is what that pose gives.
  TableBoard turned = prop;
  turned.offset = {0, 10, 5};
  turned.turn_deg = {0, 0, 90};
  const calib::Pose X_CW = calib::PosesAt(studio.rig, 0.0).X_WC.Inverse();
  cv::Mat3f expected = RenderBoard(prop.board, prop.look, X_CW * PoseOf(turned), studio.camera);
  for (int i = 0; i < static_cast<int>(expected.total()); ++i) expected(i) *= studio.shading(i);
  EXPECT_LT(cv::norm(RenderView(studio, {90.0}).radiance, expected, cv::NORM_INF), 0.05);
  EXPECT_GT(cv::norm(RenderView(studio, {0.0}).radiance, expected, cv::NORM_INF), 0.3);
}

TEST(Prop, ABoardHeldByHandIsWholeAndMoves) {
  HandheldBoard prop;
  prop.board.columns = 6;
  prop.board.rows = 4;
  prop.board.spacing = 20.0;
  prop.distance = {250.0, 400.0};
  const auto camera = calib::CameraModel::Pinhole(160, 120, 200, 200, 79.5, 59.5);
  std::vector<Eigen::Vector3d> places;
  for (std::uint64_t picture = 0; picture < 30; ++picture) {
    const calib::Pose X_CB = PoseOf(prop, camera, picture);
    for (const Eigen::Vector2d& pixel : BoardPixels({prop.board, X_CB}, camera))
      EXPECT_TRUE(pixel.x() > 0 && pixel.x() < 159 && pixel.y() > 0 && pixel.y() < 119) << picture;
    EXPECT_EQ(calib::RowsFromPose(X_CB), calib::RowsFromPose(PoseOf(prop, camera, picture)));
    for (const Eigen::Vector3d& other : places) EXPECT_GT((other - X_CB.translation).norm(), 1e-3);
    places.push_back(X_CB.translation);
  }
}

TEST(Prop, AFieldIsEvenButForTheVignetting) {
  const Studio studio = StudioWith("prop: {kind: grey, radiance: 0.4, colour: [1, 0.5, 2]}");
  const cv::Mat3f picture = RenderView(studio, {}).radiance;
  EXPECT_NEAR(picture(60, 80)[0], 0.4, 1e-3);
  EXPECT_NEAR(picture(60, 80)[1], 0.2, 1e-3);
  EXPECT_NEAR(picture(0, 0)[2], 0.8 * 0.5, 1e-6);
}

TEST(Prop, AMirrorBallShowsTheLightsAndTurnsWithTheTable) {
  const Studio studio =
      StudioWith("prop: {kind: ball, radius: 25, offset: [20, 0, 25], lamp_radius_deg: 5}");
  const cv::Mat3f first = RenderView(studio, {0.0}).radiance;
  double brightest = 0.0;
  cv::minMaxLoc(first.reshape(1), nullptr, &brightest);
  EXPECT_GT(brightest, 1.0);  // the light's image
  EXPECT_GT(cv::norm(first, RenderView(studio, {90.0}).radiance, cv::NORM_INF), 0.1);
  EXPECT_EQ(cv::norm(first, RenderView(studio, {0.0, false}).radiance, cv::NORM_INF), 0.0);
}

TEST(Prop, LampsOffLeaveTheAmbientTerm) {
  const Studio studio = StudioWith("prop: {kind: lamp-off}");
  const Studio lit = StudioWith("");
  EXPECT_EQ(cv::norm(RenderView(studio, {30.0}).radiance, RenderView(lit, {30.0, false}).radiance,
                     cv::NORM_INF),
            0.0);
}

// The next picture of a camera, a second later each.
cv::Mat TakeNext(MockCamera& camera, int second) {
  const DeviceTime now = std::chrono::seconds(second);
  EXPECT_TRUE(camera.Trigger(now));
  auto frame = camera.Poll(now + std::chrono::milliseconds(900));
  EXPECT_TRUE(frame && *frame);
  return (**frame).image;
}

TEST(Prop, PicturesOfAPropHaveNoiseOfTheirOwn) {
  for (const bool prop : {true, false}) {
    const SimulationConfig config =
        WorldOf(std::string("sensor: {bits: 16, noise_relative: 0.01}\n") +
                (prop ? "prop: {kind: flat}" : ""));
    const auto table = std::make_shared<MockTurntable>(config.table);
    auto camera = MockCamera::Create(config.camera, table);
    ASSERT_TRUE(camera);
    ASSERT_TRUE((*camera)->Open(DeviceTime{}));
    const cv::Mat first = TakeNext(**camera, 1), second = TakeNext(**camera, 2);
    EXPECT_EQ(cv::norm(first, second, cv::NORM_INF) > 0.0, prop);
  }
}

TEST(Prop, StandsInASimulationsConfig) {
  const auto document = ParseYaml("motion: {kind: orbit}\ngeometry: {angle_scale: 1.1}", "t.yaml");
  const auto refused = ReadSimulation(StrictObject(*document), {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, HasSubstr("geometry: motion/kind is orbit"));
}

}  // namespace
}  // namespace turnlight::rig::sim
