#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/angles.h"
#include "base/format.h"
#include "base/random.h"
#include "bench/studies/extreme_cells.h"

namespace turnlight::studies {
namespace {

using rig::sim::SyntheticConfig;
using rig::sim::SyntheticSession;

constexpr std::uint64_t kSpoilStream = std::uint64_t{1} << 53;

// A cell whose session is made from a config and then changed.
void Add(std::vector<ExtremeCell>& cells, const std::string& group, const std::string& setting,
         const SyntheticConfig& config, const std::function<void(SyntheticSession&)>& change) {
  cells.push_back({group, setting, [config, change]() -> Result<SyntheticSession> {
                     auto session = rig::sim::SynthesizeInMemory(config);
                     if (session) change(*session);
                     return session;
                   }});
}

// Moves W's origin by `shift` (in the old W).
void MoveOrigin(SyntheticSession& session, const Eigen::Vector3d& shift) {
  for (rig::sim::SyntheticFrame& frame : session.frames) {
    frame.X_WC.translation -= shift;
    frame.X_WT.translation -= shift;
  }
  for (estimator::model::Light& light : session.scene.lights)
    light = estimator::model::Recentred(light, shift);
}

// Leaves the target's `count` middle pixels of the first view, and nothing of the other views.
void KeepPixels(SyntheticSession& session, int count) {
  session.frames.resize(1);
  cv::Mat1b& mask = session.frames[0].mask;
  const cv::Mat1b before = mask.clone();
  mask.setTo(0);
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  const int top = mask.rows / 2 - side / 2, left = mask.cols / 2 - side / 2;
  for (int i = 0; i < count; ++i)
    mask(top + i / side, left + i % side) = before(top + i / side, left + i % side);
}

// A share of all pixels is anything between dark and white.
void SpoilPixels(SyntheticSession& session, double share) {
  for (std::size_t k = 0; k < session.frames.size(); ++k) {
    cv::Mat& image = session.frames[k].image;
    const RandomStream random(k, kSpoilStream);
    for (int i = 0; i < image.rows * image.cols; ++i) {
      const auto first = 4 * static_cast<std::uint64_t>(i);
      if (random.Uniform(first) >= share) continue;
      auto& pixel = image.at<cv::Vec3w>(i / image.cols, i % image.cols);
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint16_t>(
            random.Uniform(first + 1 + static_cast<std::uint64_t>(c), 0.0, 65534.0));
    }
  }
}

// A share of the pixels of float pictures has a value that is no radiance.
void SpoilFloats(SyntheticSession& session, double share, float value) {
  for (std::size_t k = 0; k < session.frames.size(); ++k) {
    cv::Mat& image = session.frames[k].image;
    const RandomStream random(k, kSpoilStream + 1);
    for (int i = 0; i < image.rows * image.cols; ++i)
      if (random.Uniform(static_cast<std::uint64_t>(i)) < share)
        image.at<cv::Vec3f>(i / image.cols, i % image.cols) = cv::Vec3f::all(value);
  }
}

// Turns the normals that the estimator is given: about one axis (as a badly registered target), or
// each about an axis of its own (as a noisy scan).
void TurnNormals(SyntheticSession& session, double angle, bool each) {
  auto& mesh = std::get<calib::MeshShape>(session.target);
  const RandomStream random(1, kSpoilStream + 2);
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    Eigen::Vector3d& normal = mesh.normals[i];
    const double about = random.Uniform(i, 0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector3d own = Eigen::AngleAxisd(about, normal) * normal.unitOrthogonal();
    const Eigen::Vector3d axis = each ? own : Eigen::Vector3d::UnitX();
    normal = (Eigen::AngleAxisd(angle, axis) * normal).normalized();
  }
}

SyntheticConfig FloatConfig() {
  SyntheticConfig config = PlainConfig();
  config.sensor = {};
  config.sensor.depth = rig::sim::SensorDepth::kFloat;
  config.sensor.noise_relative = 0.002;
  return config;
}

// A dim pattern of veins, unknown to the model: radiance times 1 - depth where a sine is large.
void AddDirt(SyntheticSession& session, double depth) {
  for (rig::sim::SyntheticFrame& frame : session.frames)
    for (int row = 0; row < frame.image.rows; ++row)
      for (int column = 0; column < frame.image.cols; ++column) {
        if (std::sin(0.35 * row + 2.0 * std::sin(0.2 * column)) < 0.7) continue;
        auto& pixel = frame.image.at<cv::Vec3w>(row, column);
        for (int c = 0; c < 3; ++c)
          pixel[c] = static_cast<std::uint16_t>(4096.0 + (1.0 - depth) * (pixel[c] - 4096.0));
      }
}

void AddFloatCells(std::vector<ExtremeCell>& cells) {
  using Limits = std::numeric_limits<float>;
  const std::pair<const char*, float> values[] = {{"NaN", Limits::quiet_NaN()},
                                                  {"infinity", Limits::infinity()},
                                                  {"-infinity", -Limits::infinity()},
                                                  {"denormal", Limits::denorm_min()},
                                                  {"1e30", 1e30f},
                                                  {"-1e30", -1e30f}};
  for (const auto& [name, value] : values)
    for (const double share : {0.01, 1.0})
      Add(cells, "float pictures", Format("%g", 100.0 * share) + " % " + name, FloatConfig(),
          [share = share, value = value](SyntheticSession& s) { SpoilFloats(s, share, value); });
}

}  // namespace

void AddPictureCells(std::vector<ExtremeCell>& cells) {
  SyntheticConfig table = PlainConfig();
  table.motion = {rig::sim::MotionKind::kTable, 36, 10.0, 420.0, 30.0, 0.0};
  Add(cells, "views, all the same picture", "36 identical", table, [](SyntheticSession& s) {
    for (rig::sim::SyntheticFrame& frame : s.frames) frame.image = s.frames[0].image;
  });
  for (const double radii : {1.0, 10.0, 100.0, 1e4})
    Add(cells, "W's origin away", Format("%g", radii) + " radii", PlainConfig(),
        [radii](SyntheticSession& s) {
          MoveOrigin(s, 50.0 * radii * Eigen::Vector3d(1.0, -2.0, -2.0) / 3.0);
        });
  for (const int count : {1, 10, 50, 200, 1000})
    Add(cells, "usable pixels", std::to_string(count), PlainConfig(),
        [count](SyntheticSession& s) { KeepPixels(s, count); });
  for (const double share : {0.001, 0.01, 0.05, 0.1, 0.2, 0.4, 0.6})
    Add(cells, "outliers", Format("%g", 100.0 * share) + " %", PlainConfig(),
        [share](SyntheticSession& s) { SpoilPixels(s, share); });
  SyntheticConfig lump = PlainConfig();
  lump.target = rig::sim::Blob{40.0, 0.15, 96};
  for (const bool each : {false, true})
    for (const double angle : {0.0, 1.0, 3.0, 10.0})
      Add(cells, each ? "normals wrong, each" : "normals wrong, one tilt",
          Format("%g", angle) + " deg", lump,
          [angle, each](SyntheticSession& s) { TurnNormals(s, DegToRad(angle), each); });
  for (const double depth : {0.05, 0.2, 0.5})
    Add(cells, "dirt, a third darker by", Format("%g", 100.0 * depth) + " %", PlainConfig(),
        [depth](SyntheticSession& s) { AddDirt(s, depth); });
  AddFloatCells(cells);
}

std::vector<ExtremeCell> ExtremeCells() {
  std::vector<ExtremeCell> cells;
  AddSceneCells(cells);
  AddPictureCells(cells);
  return cells;
}

}  // namespace turnlight::studies
