#include "tests/estimator/consistency/mangled.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "base/angles.h"
#include "base/random.h"
#include "calib/rig_geometry.h"
#include "estimator/target/renderer.h"
#include "rig/session/vertex_normals.h"
#include "rig/sim/blob.h"

namespace turnlight::estimator::consistency {
namespace {

using rig::sim::SyntheticFrame;

std::uint16_t Swapped(std::uint16_t value) {
  return static_cast<std::uint16_t>(value << 8 | value >> 8);
}

void ForEachValue(cv::Mat& image, const std::function<double(double)>& change) {
  for (int row = 0; row < image.rows; ++row) {
    auto* value = image.ptr<std::uint16_t>(row);
    for (int i = 0; i < image.cols * image.channels(); ++i)
      value[i] = static_cast<std::uint16_t>(std::clamp(std::round(change(value[i])), 0.0, 65535.0));
  }
}

cv::Mat Shifted(const cv::Mat& image, int dx, int dy) {
  cv::Mat out = cv::Mat::zeros(image.size(), image.type());
  const cv::Rect whole(0, 0, image.cols, image.rows);
  const cv::Rect to = whole & cv::Rect(dx, dy, image.cols, image.rows);
  image(to - cv::Point(dx, dy)).copyTo(out(to));
  return out;
}

std::vector<std::size_t> Shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const RandomStream random(seed, 77);
  for (std::size_t i = count - 1; i > 0; --i)
    std::swap(order[i],
              order[static_cast<std::size_t>(random.Uniform(i) * static_cast<double>(i + 1))]);
  return order;
}

}  // namespace

rig::sim::SyntheticConfig RandomCapture(std::uint64_t seed, Shape shape, int frames) {
  rig::sim::SyntheticConfig config;
  config.seed = seed;
  if (shape == Shape::kLump)
    config.target = rig::sim::Blob{40.0, 0.25, 64};
  else
    config.target = calib::SphereShape{40.0};
  config.motion = {rig::sim::MotionKind::kTable, frames, 360.0 / frames, 480.0, 25.0, 0.0};
  config.camera.width = 200;
  config.camera.height = 150;
  config.camera.focal_px = 500.0;
  config.samples_per_side = 2;
  config.sensor.noise_relative = 0.002;
  config.sensor.noise_shot = 0.004;
  rig::sim::RandomLights lights;
  lights.count = 1 + static_cast<int>(seed % 3);
  config.lights = lights;
  return config;
}

Capture Captured(const rig::sim::SyntheticConfig& config) {
  auto session = rig::sim::SynthesizeInMemory(config);
  Capture out{std::move(*session), {}};
  for (const SyntheticFrame& frame : out.session.frames) out.angles_deg.push_back(frame.angle_deg);
  for (SyntheticFrame& frame : out.session.frames) frame.mask.setTo(255);
  return out;
}

rig::sim::SyntheticConfig SmallCapture(std::uint64_t seed, Shape shape, int frames) {
  rig::sim::SyntheticConfig config = RandomCapture(seed, shape, frames);
  config.camera.width = 120;
  config.camera.height = 90;
  config.camera.focal_px = 360.0;
  return config;
}

Capture CapturedSymmetric(std::uint64_t seed, int fold, int frames) {
  Capture out = Captured(RandomCapture(seed, Shape::kSphere, frames));
  calib::MeshShape mesh = rig::sim::MakeBlob({40.0, 0.0, 144}, seed);
  for (Eigen::Vector3d& p : mesh.vertices) {
    const double around = std::atan2(p.y(), p.x());
    const double across = p.head<2>().norm() / p.norm();
    p *= 1.0 + 0.15 * across * std::cos(fold * around) + 0.1 * p.z() / 40.0 * p.z() / 40.0;
  }
  out.session.target = rig::WithVertexNormals(std::move(mesh.vertices), std::move(mesh.faces));
  const target::Geometry geometry(out.session.target);
  const calib::RayGrid rays(out.session.camera);
  for (SyntheticFrame& frame : out.session.frames) {
    const target::Rendering view =
        target::Render(out.session.scene, geometry, rays, frame.X_WC, frame.X_WT, {2, true});
    view.radiance.convertTo(frame.image, CV_16UC3, 65535.0);
  }
  return out;
}

Capture CopyOf(const Capture& capture) {
  Capture out = capture;
  for (SyntheticFrame& frame : out.session.frames) {
    frame.image = frame.image.clone();
    frame.mask = frame.mask.clone();
  }
  return out;
}

void GiveMasks(Capture& capture) {
  for (SyntheticFrame& frame : capture.session.frames) {
    cv::Mat grey;
    cv::extractChannel(frame.image, grey, 0);
    cv::compare(grey, 400, frame.mask, cv::CMP_GT);
  }
}

void GiveOutlines(Capture& capture) {
  const target::Geometry geometry(capture.session.target);
  const calib::RayGrid rays(capture.session.camera);
  for (SyntheticFrame& frame : capture.session.frames) {
    const target::Rendering view =
        target::Render(capture.session.scene, geometry, rays, frame.X_WC, frame.X_WT, {2, true});
    cv::compare(view.coverage, 0.99, frame.mask, cv::CMP_GT);
  }
}

void ClutterBackground(Capture& capture, std::uint64_t seed) {
  const target::Geometry geometry(capture.session.target);
  const calib::RayGrid rays(capture.session.camera);
  const RandomStream random(seed, 79);
  std::uint64_t draw = 0;
  for (SyntheticFrame& frame : capture.session.frames) {
    cv::Mat background = cv::Mat::zeros(frame.image.size(), frame.image.type());
    for (int thing = 0; thing < 12; ++thing) {
      const double x = random.Uniform(draw++), y = random.Uniform(draw++);
      const double radius = random.Uniform(draw++, 0.05, 0.2), level = random.Uniform(draw++);
      cv::circle(background,
                 {static_cast<int>(x * background.cols), static_cast<int>(y * background.rows)},
                 static_cast<int>(radius * background.rows), cv::Scalar::all(60000.0 * level),
                 cv::FILLED);
    }
    const target::Rendering view =
        target::Render(capture.session.scene, geometry, rays, frame.X_WC, frame.X_WT, {2, true});
    background.copyTo(frame.image, view.coverage == 0.0f);
  }
}

void MakeOdd(Capture& capture, const std::string& kind, std::size_t frame) {
  std::vector<SyntheticFrame>& frames = capture.session.frames;
  cv::Mat& image = frames[frame].image;
  if (kind == "black") {
    image.setTo(0);
  } else if (kind == "dimmed") {
    ForEachValue(image, [](double value) { return 0.6 * value; });
  } else if (kind == "turned") {
    cv::rotate(image.clone(), image, cv::ROTATE_180);
  } else if (kind == "mirrored") {
    cv::flip(image.clone(), image, 1);
  } else if (kind == "byte-swapped") {
    ForEachValue(image, [](double value) { return Swapped(static_cast<std::uint16_t>(value)); });
  } else if (kind == "stale") {
    image = frames[(frame + frames.size() - 1) % frames.size()].image.clone();
  } else if (kind == "half") {
    image.rowRange(image.rows / 2, image.rows).setTo(0);
  } else if (kind == "moved") {
    image = Shifted(image, 7, -4);
  } else if (kind == "wrong-mask") {
    if (cv::countNonZero(frames[frame].mask) == static_cast<int>(frames[frame].mask.total()))
      GiveMasks(capture);
    frames[frame].mask.colRange(0, image.cols / 2).setTo(0);
  }
}

void MisplacePoses(Capture& capture, const std::string& mistake, std::uint64_t seed) {
  std::vector<SyntheticFrame>& frames = capture.session.frames;
  const auto turn = [&](double factor) {
    for (SyntheticFrame& frame : frames)
      frame.X_WT = calib::Turn(Eigen::Vector3d::UnitZ(), DegToRad(factor * frame.angle_deg));
  };
  const auto pictures = [&](const std::vector<std::size_t>& order) {
    std::vector<cv::Mat> images, masks;
    for (const std::size_t k : order) images.push_back(frames[k].image);
    for (const std::size_t k : order) masks.push_back(frames[k].mask);
    for (std::size_t k = 0; k < frames.size(); ++k) frames[k].image = images[k];
    for (std::size_t k = 0; k < frames.size(); ++k) frames[k].mask = masks[k];
  };
  if (mistake == "angles-reversed") turn(-1.0);
  if (mistake == "factor 2") turn(2.0);
  if (mistake == "factor 0.98") turn(0.98);
  if (mistake == "order-reversed") {
    std::vector<std::size_t> order(frames.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = order.size() - 1 - k;
    pictures(order);
  }
  if (mistake == "order-shuffled") pictures(Shuffled(frames.size(), seed));
  for (SyntheticFrame& frame : frames) {
    if (mistake == "camera-inverted") frame.X_WC = frame.X_WC.Inverse();
    if (mistake == "target-inverted") frame.X_WT = frame.X_WT.Inverse();
    if (mistake == "camera-axes")
      frame.X_WC.rotation = frame.X_WC.rotation * Eigen::Vector3d(1, -1, -1).asDiagonal();
    if (mistake == "length-unit") frame.X_WC.translation /= 1000.0;
    if (mistake == "target-place")
      frame.X_WT = frame.X_WT * calib::Pose{Eigen::Matrix3d::Identity(), {6.0, -9.0, 4.0}};
  }
}

bool NamesMistake(const Consistency& found, const std::string& mistake) {
  if (!found.change) return false;
  const std::string& code = found.change->code;
  if (mistake.starts_with("factor")) return code == "angle-factor";
  // About an axis through the origin an inverted target pose is a reversed angle, and an order
  // that a table's angles can be given in is that of reversed angles.
  if (mistake == "target-inverted") return code == mistake || code == "angles-reversed";
  return code == mistake;
}

void LetLampDrift(Capture& capture, double share, bool at_random, std::uint64_t seed) {
  const RandomStream random(seed, 78);
  std::vector<SyntheticFrame>& frames = capture.session.frames;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const double at = at_random ? random.Uniform(k, -1.0, 1.0)
                                : static_cast<double>(k) / static_cast<double>(frames.size());
    ForEachValue(frames[k].image, [&](double value) { return (1.0 + share * at) * value; });
  }
}

SmallViews SmallViewsOf(const Capture& capture, const target::Geometry& geometry) {
  const auto keyframes = rig::sim::ToKeyframes(capture.session);
  std::vector<calib::RigPoses> poses;
  for (const model::Keyframe& keyframe : keyframes) poses.push_back({keyframe.X_WC, keyframe.X_WT});
  const int block = BlockFor(capture.session.camera, geometry, poses);
  SmallViews out{capture.session.camera.InBlocks(block), block, {}};
  for (const model::Keyframe& keyframe : keyframes)
    out.views.push_back(MakeSmallView(keyframe, block, out.views.size()));
  return out;
}

}  // namespace turnlight::estimator::consistency
