#include "calib/camera_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/file.h"
#include "base/format.h"
#include "base/parallel.h"
#include "base/printable.h"
#include "calib/camera_model_text.h"

extern "C" {
#include <mrcal/mrcal.h>
}

namespace turnlight::calib {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMaxSide = 65536;
constexpr double kMaxPixels = 268435456.0;  // 2^28
constexpr std::size_t kChunk = 4096;        // points of one parallel task
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// An unprojection counts when it projects back to within this many pixels, rounding aside.
constexpr double kReprojectionTolerance = 1e-7;

// mrcal's view of a lens.
struct Lens {
  mrcal_lensmodel_t model;
  std::vector<double> intrinsics;
  bool sees_behind;  // z <= 0 can be in the picture
  bool never_folds;  // no two directions project to the same point
  double rounding;   // pixels that double precision loses in a projection
};

std::string SupportedLensModels() {
  std::vector<std::string> names;
  for (const char* const* name = mrcal_supported_lensmodel_names(); *name != nullptr; ++name)
    names.emplace_back(*name);
  return Listed(names);
}

// The fewest digits that read back the same bits.
std::string ExactNumber(double value) {
  std::array<char, 40> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

// The full name as this project writes it. mrcal's own rounds CAHVORE's linearity to two digits.
std::string LensModelName(const mrcal_lensmodel_t& model) {
  if (model.type == MRCAL_LENSMODEL_CAHVORE)
    return "LENSMODEL_CAHVORE_linearity=" + ExactNumber(model.LENSMODEL_CAHVORE__config.linearity);
  std::array<char, 256> name{};
  mrcal_lensmodel_name(name.data(), static_cast<int>(name.size()), &model);
  return name.data();
}

// Why mrcal would abort the process on this configuration, or misread it; empty if it would not.
std::string ConfigurationProblem(const mrcal_lensmodel_t& model, const std::string& name) {
  if (model.type == MRCAL_LENSMODEL_CAHVORE)
    return std::isfinite(model.LENSMODEL_CAHVORE__config.linearity)
               ? ""
               : "the linearity must be a finite number";
  if (model.type != MRCAL_LENSMODEL_SPLINED_STEREOGRAPHIC) return "";
  const auto& config = model.LENSMODEL_SPLINED_STEREOGRAPHIC__config;
  if (config.order != 2 && config.order != 3) return "the order must be 2 or 3";
  if (config.Nx <= config.order || config.Ny <= config.order)
    return "Nx and Ny must be larger than the order";
  if (config.fov_x_deg < 1 || config.fov_x_deg > 359) return "fov_x_deg must be 1 to 359";
  // Numbers beyond 16 bits wrap around silently when read.
  return LensModelName(model) == name ? "" : "mrcal writes it as " + LensModelName(model);
}

Result<mrcal_lensmodel_t> ParseLensModel(const std::string& name, const std::string& file) {
  const auto refuse = [&](const std::string& why) {
    return InputError(file + ": 'lensmodel': '" + Printable(name.substr(0, 100)) + "' " + why);
  };
  mrcal_lensmodel_t model{};
  const mrcal_lensmodel_type_t type = mrcal_lensmodel_type_from_name(name.c_str());
  if (!mrcal_lensmodel_type_is_valid(type) || name.size() > 200 ||
      name.find('\0') != std::string::npos)
    return refuse("is an unknown lens model, allowed are " + SupportedLensModels());
  if (!mrcal_lensmodel_from_name(&model, name.c_str())) {
    model.type = type;
    return refuse("lacks its configuration, allowed is " +
                  std::string(mrcal_lensmodel_name_unconfigured(&model)));
  }
  const std::string problem = ConfigurationProblem(model, name);
  if (!problem.empty()) return refuse("has a wrong configuration: " + problem);
  return model;
}

// In 64 bits: mrcal's own count overflows for large splined models.
std::int64_t IntrinsicsCount(const mrcal_lensmodel_t& model) {
  if (model.type != MRCAL_LENSMODEL_SPLINED_STEREOGRAPHIC)
    return mrcal_lensmodel_num_params(&model);
  const auto& config = model.LENSMODEL_SPLINED_STEREOGRAPHIC__config;
  return 4 + std::int64_t{2} * config.Nx * config.Ny;
}

Status CheckImagerSize(const std::vector<double>& size, const std::string& file) {
  for (const double side : size)
    if (side != std::floor(side) || side < 1 || side > kMaxSide)
      return InputError(file + ": 'imagersize': " + NumberText(side) +
                        ", allowed is a whole number from 1 to " + std::to_string(kMaxSide));
  if (size[0] * size[1] > kMaxPixels)
    return InputError(file + ": 'imagersize': " + NumberText(size[0]) + " x " +
                      NumberText(size[1]) + " pixels, allowed are at most " +
                      std::to_string(static_cast<std::int64_t>(kMaxPixels)));
  return {};
}

Lens MakeLens(const std::string& name, const std::vector<double>& intrinsics) {
  Lens lens{{}, intrinsics, false, false, 0.0};
  mrcal_lensmodel_from_name(&lens.model, name.c_str());
  lens.sees_behind = lens.model.type == MRCAL_LENSMODEL_CAHVORE ||
                     mrcal_lensmodel_metadata(&lens.model).can_project_behind_camera;
  lens.never_folds = lens.model.type == MRCAL_LENSMODEL_PINHOLE ||
                     lens.model.type == MRCAL_LENSMODEL_STEREOGRAPHIC ||
                     lens.model.type == MRCAL_LENSMODEL_LONLAT ||
                     lens.model.type == MRCAL_LENSMODEL_LATLON;
  double scale = 0.0;
  for (int i = 0; i < 4; ++i) scale += std::abs(intrinsics[static_cast<std::size_t>(i)]);
  lens.rounding = 16.0 * std::numeric_limits<double>::epsilon() * scale;
  return lens;
}

// mrcal prints a line for each point beyond the reach of a CAHVORE lens: keep those from it where
// they are known without its iteration, that is if the entrance pupil does not move.
bool WithinCahvoreReach(const Lens& lens, const Vector3d& v) {
  for (std::size_t i = 9; i < 12; ++i)
    if (lens.intrinsics[i] != 0.0) return true;
  const double alpha = lens.intrinsics[4], beta = lens.intrinsics[5];
  const Vector3d axis(std::sin(alpha) * std::cos(beta), std::sin(beta),
                      std::cos(alpha) * std::cos(beta));
  const double theta = std::atan2(v.cross(axis).norm(), v.dot(axis));
  return theta * std::abs(lens.model.LENSMODEL_CAHVORE__config.linearity) <= 0.5 * std::numbers::pi;
}

// The image point of a direction or position, and its derivatives if the model has them.
Vector2d ProjectOne(const Lens& lens, const Vector3d& v, Eigen::Matrix<double, 2, 3>* derivatives) {
  const Vector2d failed(kNan, kNan);
  const bool cahvore = lens.model.type == MRCAL_LENSMODEL_CAHVORE;
  const double length = v.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return failed;
  if (!lens.sees_behind && v.z() <= 0.0) return failed;
  if (cahvore && !WithinCahvoreReach(lens, v)) return failed;
  // CAHVORE's moving entrance pupil is taken as it is at distance 1: the model is central.
  const double scale = cahvore ? 1.0 / length : 1.0;
  const mrcal_point3_t p{{scale * v.x(), scale * v.y(), scale * v.z()}};
  mrcal_point2_t q;
  std::array<mrcal_point3_t, 2> gradient;
  if (!mrcal_project(&q, derivatives ? gradient.data() : nullptr, nullptr, &p, 1, &lens.model,
                     lens.intrinsics.data()))
    return failed;
  if (derivatives)
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 3; ++j)
        (*derivatives)(i, j) = gradient[static_cast<std::size_t>(i)].xyz[j];
  return std::isfinite(q.x) && std::isfinite(q.y) ? Vector2d(q.x, q.y) : failed;
}

// Two unit vectors that with the unit vector v make a right-handed frame, by a cross product with
// an axis that is far from v. Where an image point is looked for, any such frame will do.
Eigen::Matrix<double, 3, 2> CrossProductBasis(const Vector3d& v) {
  const Vector3d helper = std::abs(v.z()) > 0.7 ? Vector3d::UnitX() : Vector3d::UnitZ();
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = (helper - helper.dot(v) * v).normalized();
  basis.col(1) = v.cross(basis.col(0));
  return basis;
}

// The derivative of the image point by steps along the tangent basis at v.
Matrix2d TangentDerivative(const Lens& lens, const Vector3d& v,
                           const Eigen::Matrix<double, 3, 2>& basis) {
  if (lens.model.type != MRCAL_LENSMODEL_CAHVORE) {
    Eigen::Matrix<double, 2, 3> derivatives;
    if (ProjectOne(lens, v, &derivatives).hasNaN()) return Matrix2d::Constant(kNan);
    return derivatives * basis;
  }
  constexpr double kStep = 1e-6;
  Matrix2d derivative;
  for (int i = 0; i < 2; ++i)
    derivative.col(i) = (ProjectOne(lens, v + kStep * basis.col(i), nullptr) -
                         ProjectOne(lens, v - kStep * basis.col(i), nullptr)) /
                        (2.0 * kStep);
  return derivative;
}

// Newton's method on the unit sphere, with backtracking, from the guess v until v projects to q.
// NaN if it does not get there, or if the picture is mirrored there (negative determinant).
Vector3d Refine(const Lens& lens, const Vector2d& q, Vector3d v) {
  const Vector3d failed = Vector3d::Constant(kNan);
  const double tolerance = kReprojectionTolerance + lens.rounding;
  Vector2d miss = q - ProjectOne(lens, v, nullptr);
  for (int iteration = 0; iteration < 50; ++iteration) {
    if (!miss.allFinite()) return failed;
    const Eigen::Matrix<double, 3, 2> basis = CrossProductBasis(v);
    const Matrix2d derivative = TangentDerivative(lens, v, basis);
    if (!(derivative.determinant() > 0.0)) return failed;
    // Two orders below the tolerance, as reaching it leaves no room for those who check.
    if (miss.norm() <= 1e-2 * tolerance) return v;
    const Vector2d step = derivative.inverse() * miss;
    bool better = false;
    for (double length = 1.0; !better && length > 1e-3; length *= 0.5) {
      const Vector3d next = (v + basis * (length * step)).normalized();
      const Vector2d next_miss = q - ProjectOne(lens, next, nullptr);
      better = next_miss.norm() < miss.norm();
      if (better) {
        v = next;
        miss = next_miss;
      }
    }
    if (!better) return miss.norm() <= tolerance ? v : failed;
  }
  return failed;
}

// Distortion polynomials fold the picture over beyond the reach of the real lens, and further out
// other directions project into the picture once more. A ray is real if the picture stays
// unmirrored all the way from the axis to it.
bool Connected(const Lens& lens, const Vector3d& v) {
  if (lens.never_folds) return true;
  constexpr int kSamples = 16;
  for (int i = 0; i < kSamples; ++i) {
    const double t = static_cast<double>(i) / kSamples;
    const Vector3d w = ((1.0 - t) * Vector3d::UnitZ() + t * v).normalized();
    if (!(TangentDerivative(lens, w, CrossProductBasis(w)).determinant() > 0.0)) return false;
  }
  return true;
}

// Where to start: mrcal's own answer, or, for the model it has none for, the pinhole's.
Vector3d Guess(const Lens& lens, const Vector2d& point) {
  const mrcal_point2_t q{{point.x(), point.y()}};
  mrcal_point3_t v;
  const double* core = lens.intrinsics.data();
  if (lens.model.type == MRCAL_LENSMODEL_CAHVORE)
    mrcal_unproject_pinhole(&v, nullptr, &q, 1, core);
  else if (!mrcal_unproject(&v, &q, 1, &lens.model, core))
    return Vector3d::Constant(kNan);
  return Vector3d(v.x, v.y, v.z).normalized();
}

Vector3d UnprojectOne(const Lens& lens, const Vector2d& point) {
  const Vector3d failed = Vector3d::Constant(kNan);
  if (!point.allFinite()) return failed;
  const Vector3d guess = Guess(lens, point);
  if (!guess.allFinite()) return failed;
  const Vector3d ray = Refine(lens, point, guess);
  return ray.allFinite() && Connected(lens, ray) ? ray : failed;
}

}  // namespace

Result<CameraModel> CameraModel::FromString(const std::string& text, const std::string& file) {
  auto read = ReadCameraModelText(text, file);
  if (!read) return Forward(read);
  const auto model = ParseLensModel(read->lens_model, file);
  if (!model) return Forward(model);
  const std::int64_t count = IntrinsicsCount(*model);
  if (static_cast<std::int64_t>(read->intrinsics.size()) != count)
    return InputError(file + ": 'intrinsics': " + std::to_string(read->intrinsics.size()) +
                      " numbers, " + read->lens_model + " has " + std::to_string(count));
  for (std::size_t i = 0; i < 2; ++i)
    if (!(read->intrinsics[i] > 1e-6))
      return InputError(file + ": 'intrinsics': the focal length " +
                        NumberText(read->intrinsics[i]) + ", allowed is a number above 1e-6");
  for (const double value : read->intrinsics)
    if (!(std::abs(value) <= 1e12))  // of larger squares mrcal's search for a ray does not end
      return InputError(file + ": 'intrinsics': " + NumberText(value) + ", allowed is up to 1e12");
  if (const Status status = CheckImagerSize(read->imager_size, file); !status)
    return Forward(status);
  CameraModel camera;
  camera.width_ = static_cast<int>(read->imager_size[0]);
  camera.height_ = static_cast<int>(read->imager_size[1]);
  camera.lens_model_ = LensModelName(*model);
  camera.intrinsics_ = std::move(read->intrinsics);
  return camera;
}

Result<CameraModel> CameraModel::FromFile(const std::filesystem::path& path) {
  const auto text = ReadFile(path, kMaxCameraModelBytes);
  if (!text) return Forward(text);
  return FromString(*text, path.string());
}

CameraModel CameraModel::WithIntrinsics(std::vector<double> intrinsics) const {
  CameraModel model = *this;
  model.intrinsics_ = std::move(intrinsics);
  return model;
}

CameraModel CameraModel::InBlocks(int block) const {
  if (block == 1) return *this;
  CameraModel model = *this;
  model.width_ = width_ / block;
  model.height_ = height_ / block;
  // All lens models begin with fx, fy, cx, cy; the rest is in units without pixels.
  for (std::size_t i = 0; i < 4; ++i) {
    const double shift = i < 2 ? 0.0 : 0.5;  // from a corner, not from a pixel's centre
    model.intrinsics_[i] = (intrinsics_[i] + shift) / block - shift;
  }
  return model;
}

CameraModel CameraModel::Pinhole(int width, int height, double fx, double fy, double cx,
                                 double cy) {
  CameraModel camera;
  camera.width_ = width;
  camera.height_ = height;
  camera.lens_model_ = "LENSMODEL_PINHOLE";
  camera.intrinsics_ = {fx, fy, cx, cy};
  return camera;
}

std::vector<Vector3d> CameraModel::Unproject(const std::vector<Vector2d>& points) const {
  const Lens lens = MakeLens(lens_model_, intrinsics_);
  std::vector<Vector3d> rays(points.size());
  ParallelFor((points.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(points.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) rays[i] = UnprojectOne(lens, points[i]);
  });
  return rays;
}

std::vector<Vector2d> CameraModel::Project(const std::vector<Vector3d>& p_C) const {
  const Lens lens = MakeLens(lens_model_, intrinsics_);
  std::vector<Vector2d> points(p_C.size());
  ParallelFor((p_C.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(p_C.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i)
      points[i] = ProjectOne(lens, p_C[i], nullptr);
  });
  return points;
}

std::string CameraModel::ToString() const {
  std::string text = "{\n    'lensmodel':  '" + lens_model_ + "',\n";
  text += "    'extrinsics': [ 0, 0, 0, 0, 0, 0 ],\n    'intrinsics': [ ";
  for (std::size_t i = 0; i < intrinsics_.size(); ++i)
    text += (i == 0 ? "" : ", ") + ExactNumber(intrinsics_[i]);
  return text + " ],\n    'imagersize': [ " + std::to_string(width_) + ", " +
         std::to_string(height_) + " ]\n}\n";
}

// Along a row each ray starts from its neighbours, which is several times faster than mrcal's
// search and ends at the same place; where that does not lead on smoothly, mrcal searches.
RayGrid::RayGrid(const CameraModel& camera) : width_(camera.width()), height_(camera.height()) {
  const Lens lens = MakeLens(camera.lens_model(), camera.intrinsics());
  const auto columns = static_cast<std::size_t>(width_) + 2;
  rays_.resize(columns * (static_cast<std::size_t>(height_) + 2));
  ParallelFor(static_cast<std::size_t>(height_) + 2, [&](std::size_t row) {
    Vector3d* rays = rays_.data() + row * columns;
    for (std::size_t i = 0; i < columns; ++i) {
      const Vector2d point(static_cast<double>(i) - 1.0, static_cast<double>(row) - 1.0);
      bool found = false;
      if (i >= 2 && rays[i - 1].allFinite() && rays[i - 2].allFinite()) {
        const Vector3d step = rays[i - 1] - rays[i - 2];
        const Vector3d guess = (rays[i - 1] + step).normalized();
        rays[i] = Refine(lens, point, guess);
        found = (rays[i] - guess).norm() < step.norm();
      }
      if (!found) rays[i] = UnprojectOne(lens, point);
    }
  });
}

Vector3d RayGrid::Ray(int column, int row, double du, double dv) const {
  // Lagrange's polynomials through -1, 0, 1.
  const std::array<double, 3> a{0.5 * du * (du - 1.0), 1.0 - du * du, 0.5 * du * (du + 1.0)};
  const std::array<double, 3> b{0.5 * dv * (dv - 1.0), 1.0 - dv * dv, 0.5 * dv * (dv + 1.0)};
  if (du == 0.0 && dv == 0.0) return At(column, row);
  Vector3d ray = Vector3d::Zero();
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      ray += a[static_cast<std::size_t>(i)] * b[static_cast<std::size_t>(j)] *
             At(column + i - 1, row + j - 1);
  return ray.normalized();
}

Eigen::Matrix<double, 3, 2> RayGrid::Differential(int column, int row) const {
  Eigen::Matrix<double, 3, 2> differential;
  differential.col(0) = 0.5 * (At(column + 1, row) - At(column - 1, row));
  differential.col(1) = 0.5 * (At(column, row + 1) - At(column, row - 1));
  // Ray() normalises what it interpolates, so its derivative has no part along the ray.
  const Vector3d& ray = At(column, row);
  return differential - ray * (ray.transpose() * differential);
}

}  // namespace turnlight::calib
