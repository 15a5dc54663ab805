#include "estimator/memory_need.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "base/format.h"
#include "base/parallel.h"
#include "estimator/estimate.h"
#include "estimator/observe/keyframe_tracer.h"

namespace turnlight::estimator {
namespace {

// Bytes. Measured with colour pictures of 0.1 to 24 megapixels, spheres and meshes; each with some
// room, for 16 bits among other things.
constexpr double kProgram = 100e6;
constexpr double kOfRays = 24.0;        // each pixel of the camera
constexpr double kOfPicture = 26.0;     // each pixel of a picture that is read, traced and checked
constexpr double kOfNoise = 12.0;       // and its noise
constexpr double kOfTraced = 230.0;     // each pixel of the target in a small picture
constexpr double kOfPixel = 94.0;       // each pixel that is held
constexpr double kOfShadows = 17.0;     // each of a target that can shadow itself
constexpr double kOfWeight = 8.0;       // each with a weight of its own
constexpr double kOfSolver = 56.0;      // each, while the solver and the error bars are at work
constexpr double kOfPrediction = 16.0;  // each, while residual maps are made
constexpr double kOfSignature = 12.0;   // each pixel of a view's signature
constexpr double kMostOfSignature = 1e5;
constexpr double kOfSmallView = 20e6 / 36.0;  // each keyframe's, and what it is checked with
constexpr double kOfResidual = 4.0;           // each pixel of a residual map
constexpr double kResidualMaps = 6.0 + kMostLeftOutMaps;
constexpr double kOfFace = 400.0;  // of a mesh

constexpr int kGrid = 96;  // rays across and down a picture

double Held(const MemoryInputs& in) {
  return static_cast<double>(std::min(in.target_pixels, in.most_pixels));
}

std::string Gigabytes(double bytes) {
  return bytes < 1e9 ? Format("%.0f MB", bytes / 1e6) : Format("%.1f GB", bytes / 1e9);
}

// The most pixels that fit, in two digits; 0 if not even the fewest do.
std::size_t PixelsThatFit(MemoryInputs in, double most_bytes) {
  std::size_t best = 0;
  for (std::size_t unit = 1000; unit <= 10'000'000; unit *= 10)
    for (std::size_t digits = 10; digits < 100; ++digits) {
      in.most_pixels = digits * unit;
      if (MemoryNeed(in) <= most_bytes) best = in.most_pixels;
    }
  return best;
}

// The most keyframes that fit; 0 if not even one does.
std::size_t ViewsThatFit(MemoryInputs in, double most_bytes) {
  const double each = static_cast<double>(in.target_pixels) / static_cast<double>(in.keyframes);
  for (std::size_t views = in.keyframes; views > 0; --views) {
    in.keyframes = views;
    in.target_pixels = static_cast<std::size_t>(each * static_cast<double>(views));
    if (MemoryNeed(in) <= most_bytes) return views;
  }
  return 0;
}

}  // namespace

double MemoryNeed(const MemoryInputs& in) {
  const auto picture = static_cast<double>(in.picture_pixels);
  const auto keyframes = static_cast<double>(in.keyframes);
  const double in_flight =
      std::min(static_cast<double>(observe::KeyframesInFlight(in.picture_pixels)), keyframes);
  const double on_target =
      keyframes > 0.0 ? static_cast<double>(in.target_pixels) / keyframes : 0.0;
  const double traced = observe::IsTracedWhole(in.picture_pixels) ? kOfTraced * on_target : 0.0;
  const double pixel =
      kOfPixel + (in.casts_shadows ? kOfShadows : 0.0) + (in.noise_known ? kOfWeight : 0.0);
  const double signature = kOfSignature * std::min(picture / 9.0, kMostOfSignature);
  const double always = kProgram + kOfRays * picture +
                        kOfFace * static_cast<double>(in.mesh_faces) +
                        (signature + kOfSmallView) * keyframes;
  const double observing =
      in_flight * (picture * (kOfPicture + (in.noise_known ? kOfNoise : 0.0)) + traced) +
      pixel * Held(in);
  const double solving = (pixel + kOfSolver) * Held(in);
  const double maps = std::min(kResidualMaps, keyframes) * kOfResidual * picture;
  const double drawing = in.pictures ? (pixel + kOfPrediction) * Held(in) + maps : 0.0;
  return always + std::max({observing, solving, drawing});
}

std::size_t TargetPixels(const model::KeyframeSource& keyframes, const target::Geometry& geometry,
                         const calib::CameraModel& camera) {
  std::vector<Eigen::Vector2d> points;
  for (int row = 0; row < kGrid; ++row)
    for (int column = 0; column < kGrid; ++column)
      points.emplace_back((column + 0.5) * camera.width() / kGrid - 0.5,
                          (row + 0.5) * camera.height() / kGrid - 0.5);
  const std::vector<Eigen::Vector3d> rays = camera.Unproject(points);
  std::vector<std::size_t> hits(keyframes.size(), 0);
  ParallelFor(keyframes.size(), [&](std::size_t k) {
    const calib::RigPoses& poses = keyframes.poses[k];
    const calib::Pose X_TC = poses.X_WT.Inverse() * poses.X_WC;
    for (const Eigen::Vector3d& ray : rays)
      if (ray.allFinite() && geometry.Intersect(X_TC.translation, X_TC.rotation * ray)) ++hits[k];
  });
  double sum = 0.0;
  for (const std::size_t count : hits) sum += static_cast<double>(count);
  const double picture = static_cast<double>(camera.width()) * camera.height();
  return static_cast<std::size_t>(std::ceil(1.1 * sum / (kGrid * kGrid) * picture));
}

Status CheckMemory(const MemoryInputs& in, double most_bytes) {
  const double need = MemoryNeed(in);
  if (need <= most_bytes) return {};
  const std::size_t pixels = PixelsThatFit(in, most_bytes), views = ViewsThatFit(in, most_bytes);
  std::string fits;
  if (pixels > 0) fits = Format("--pixels %zu", pixels);
  if (views > 0) fits += Format("%s--views %zu", fits.empty() ? "" : " or ", views);
  return InputError(Format("--max-memory: the estimate would need up to %s, allowed are %s; ",
                           Gigabytes(need).c_str(), Gigabytes(most_bytes).c_str()) +
                    (fits.empty() ? "no number of pixels or views would fit, for pictures of this "
                                    "size take " +
                                        Gigabytes(need - kOfPixel * Held(in)) + " alone"
                                  : fits + " would fit"));
}

Result<double> BytesOf(const std::string& size) {
  constexpr std::array<std::pair<const char*, double>, 7> kUnits{{{"MB", 1e6},
                                                                  {"GB", 1e9},
                                                                  {"TB", 1e12},
                                                                  {"MiB", 1048576.0},
                                                                  {"GiB", 1073741824.0},
                                                                  {"M", 1e6},
                                                                  {"G", 1e9}}};
  char* end = nullptr;
  const double number = std::strtod(size.c_str(), &end);
  std::string unit = end;
  if (!unit.empty() && unit.front() == ' ') unit.erase(0, 1);
  for (const auto& [word, bytes] : kUnits)
    if (unit == word && end != size.c_str() && std::isfinite(number) && number > 0.0)
      return number * bytes;
  return InputError("--max-memory: \"" + size +
                    "\", allowed is a number above 0 with MB, GB, TB, MiB or GiB, such as 4GB");
}

}  // namespace turnlight::estimator
