#include <algorithm>
#include <cmath>
#include <limits>

#include "base/angles.h"
#include "estimator/pictures/sphere.h"

namespace turnlight::estimator::pictures {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A ball's picture, as a disc.
struct Disc {
  Vector2d center = Vector2d::Zero();
  double radius = 0.0;
};

std::optional<Disc> Picture(const PictureView& view, const Vector3d& center_W, double radius) {
  const Vector3d center = view.X_WC.Inverse() * center_W;
  if (center.z() <= radius) return std::nullopt;
  const auto points = view.camera.Project(
      {center, center + radius * Vector3d::UnitX(), center + radius * Vector3d::UnitY()});
  if (!points[0].allFinite() || !points[1].allFinite() || !points[2].allFinite())
    return std::nullopt;
  return Disc{points[0], std::max((points[1] - points[0]).norm(), (points[2] - points[0]).norm())};
}

// Pixels between the disc and the picture's border, relative to the picture's smaller side;
// negative when it sticks out or is not seen at all.
double Room(const PictureView& view, const std::optional<Disc>& disc) {
  if (!disc) return -10.0;
  const double width = view.camera.width(), height = view.camera.height();
  const double room = std::min({disc->center.x(), width - 1.0 - disc->center.x(), disc->center.y(),
                                height - 1.0 - disc->center.y()}) -
                      disc->radius;
  return std::max(room / std::min(width, height), -10.0);
}

constexpr double kMinRoom = 0.03;

// ---- On a board.

Vector3d BoardNormal(const PictureView& view, const calib::PlaneShape& board) {
  const bool from_above = (view.X_WT.Inverse() * view.X_WC.translation).z() >= 0.0;
  return board.sides == 2 && !from_above ? Vector3d(-Vector3d::UnitZ()) : Vector3d::UnitZ();
}

bool OnBoard(const calib::PlaneShape& board, const Vector3d& p_T, double margin) {
  return std::abs(p_T.x()) <= 0.5 * board.width - margin &&
         std::abs(p_T.y()) <= 0.5 * board.height - margin;
}

// Share of the light, 0..1, whose shadow of the sphere falls on the board and into the picture and
// is not behind the sphere itself.
double ShadowShare(const PictureView& view, const calib::PlaneShape& board,
                   const Vector3d& normal_W, const VirtualSphere& sphere, const Disc& disc) {
  double all = 0.0, shown = 0.0;
  for (const model::Light& light : view.scene.lights) {
    const Vector3d to_light = light.Toward(sphere.center);
    const double cosine = normal_W.dot(to_light) / to_light.norm();
    if (cosine <= 0.0) continue;
    const double irradiance = light.intensity * cosine / to_light.squaredNorm();
    all += irradiance;
    const Vector3d shadow = sphere.center - sphere.radius / cosine * to_light.normalized();
    const auto picture = Picture(view, shadow, 0.5 * sphere.radius);
    if (Room(view, picture) > 0.0 && OnBoard(board, view.X_WT.Inverse() * shadow, 0.0))
      shown += irradiance * std::min(1.0, (picture->center - disc.center).norm() / disc.radius);
  }
  return all > 0.0 ? shown / all : 0.0;
}

// How little, 0..1, is lost of the photograph behind the sphere's centre: 1 for board without a
// highlight, 0 for nothing but highlight, or for no board.
double Spared(const PictureView& view, const calib::PlaneShape& board, const Vector3d& normal_W,
              const VirtualSphere& sphere) {
  const Vector3d eye = view.X_WC.translation;
  const Vector3d direction = (sphere.center - eye).normalized();
  const double t = (normal_W.dot(sphere.center - eye) - sphere.radius) / normal_W.dot(direction);
  const Vector3d behind = eye + t * direction;
  if (!std::isfinite(t) || !OnBoard(board, view.X_WT.Inverse() * behind, 0.0)) return 0.0;
  model::Scene matte = view.scene;
  matte.reflectance.lobes[0].strength = 0.0;
  const double all = model::Shade(view.scene, behind, normal_W, -direction).sum();
  return all > 0.0 ? model::Shade(matte, behind, normal_W, -direction).sum() / all : 1.0;
}

VirtualSphere OnBoardAt(const PictureView& view, const calib::PlaneShape& board,
                        const Vector2d& place, double radius) {
  const Vector3d p(place.x(), place.y(), 0.0);
  return {view.X_WT * Vector3d(p + radius * BoardNormal(view, board)), radius, std::nullopt};
}

double BoardScore(const std::vector<PictureView>& views, const calib::PlaneShape& board,
                  const Vector2d& place, double radius) {
  double score = 0.0;
  for (const PictureView& view : views) {
    const VirtualSphere sphere = OnBoardAt(view, board, place, radius);
    const Vector3d normal_W = view.X_WT.rotation * BoardNormal(view, board);
    const auto disc = Picture(view, sphere.center, radius);
    const double room = Room(view, disc);
    // Sticking out counts by how much, so that the least bad place wins when none is good.
    if (room < kMinRoom) score += 2.0 * std::max(room - kMinRoom, -1.0) - 1.0;
    if (disc) score += ShadowShare(view, board, normal_W, sphere, *disc);
    score += Spared(view, board, normal_W, sphere);
  }
  return score;
}

// Points of the board, in T, that the view shows, on a coarse grid of pixels.
std::vector<Vector2d> SeenOfBoard(const PictureView& view) {
  constexpr int kColumns = 32, kRows = 24;
  const calib::Pose X_TC = view.X_WT.Inverse() * view.X_WC;
  std::vector<Vector2d> seen;
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const Vector3d ray = view.rays.Ray((2 * i + 1) * view.camera.width() / (2 * kColumns),
                                         (2 * j + 1) * view.camera.height() / (2 * kRows));
      if (!ray.allFinite()) continue;
      const auto point = view.geometry.Intersect(X_TC.translation, X_TC.rotation * ray);
      if (point) seen.push_back(point->position.head<2>());
    }
  }
  return seen;
}

std::vector<VirtualSphere> PlaceOnBoard(const std::vector<PictureView>& views,
                                        const calib::PlaneShape& board) {
  // A board larger than the picture is as large as what the picture shows of it.
  const std::vector<Vector2d> seen = SeenOfBoard(views.front());
  Vector2d low(-0.5 * board.width, -0.5 * board.height), high = -low;
  if (!seen.empty()) {
    low = high = seen.front();
    for (const Vector2d& point : seen) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  const double size = std::max((high - low).minCoeff(), 0.05 * std::min(board.width, board.height));
  const double radius = 0.14 * size;
  const Vector2d middle = 0.5 * (low + high);
  Vector2d best = middle;
  double best_score = -std::numeric_limits<double>::infinity();
  for (const Vector2d& point : seen) {
    const bool inside = OnBoard(board, {point.x(), point.y(), 0.0}, 1.05 * radius);
    if (!inside || (point - middle).norm() < 1.5 * radius) continue;
    // Rather near the middle than at a corner, where the sphere would stick out over the board.
    const double score = BoardScore(views, board, point, radius) -
                         0.5 * static_cast<double>(views.size()) * (point - middle).norm() / size;
    if (score > best_score) {
      best_score = score;
      best = point;
    }
  }
  std::vector<VirtualSphere> spheres;
  spheres.reserve(views.size());
  for (const PictureView& view : views) spheres.push_back(OnBoardAt(view, board, best, radius));
  return spheres;
}

// ---- Beside a sphere or mesh.

// How far the target reaches from `center` along a unit direction, both in W.
double Reach(const target::Geometry& geometry, const calib::Pose& X_WT, const Vector3d& center,
             const Vector3d& direction) {
  const auto* mesh = std::get_if<calib::MeshShape>(&geometry.shape());
  if (mesh == nullptr) return geometry.radius();
  const Vector3d direction_T = X_WT.rotation.transpose() * direction;
  const double start = direction_T.dot(X_WT.Inverse() * center);
  double reach = -std::numeric_limits<double>::infinity();
  for (const Vector3d& vertex : mesh->vertices)
    reach = std::max(reach, direction_T.dot(vertex) - start);
  return reach;
}

// Irradiance at the centre from the lights that the target's ball does not hide.
double LightAt(const PictureView& view, const Vector3d& center_W) {
  const Vector3d to_target = view.X_WT * view.geometry.center() - center_W;
  const double radius = view.geometry.radius();
  double sum = 0.0;
  for (const model::Light& light : view.scene.lights) {
    const Vector3d to_light = light.Toward(center_W);
    const Vector3d unit = to_light.normalized();
    const double along = to_target.dot(unit);
    const bool hidden = along > 0.0 && (to_target - along * unit).norm() < radius;
    if (!hidden) sum += light.intensity / to_light.squaredNorm();
  }
  return sum;
}

// A sphere of the given radius on the ground, `azimuth` from the direction to the picture's right.
VirtualSphere Beside(const PictureView& view, const GroundPlane& ground, double azimuth,
                     double radius) {
  const Vector3d center = view.X_WT * view.geometry.center();
  const Vector3d right_C = view.X_WC.rotation.col(0);
  const Vector3d right = (right_C - right_C.dot(ground.normal) * ground.normal).normalized();
  const Vector3d away = ground.normal.cross(right);  // from the camera
  const Vector3d direction = std::cos(azimuth) * right + std::sin(azimuth) * away;
  const Vector3d side = std::cos(azimuth) > 0.0 ? right : Vector3d(-right);
  const double aside =
      Reach(view.geometry, view.X_WT, center, side) + 0.1 * view.geometry.radius() + radius;
  Vector3d p = center + aside / std::abs(std::cos(azimuth)) * direction;
  p += (ground.offset + radius - ground.normal.dot(p)) * ground.normal;
  return {p, radius, ground};
}

// The largest sphere beside the target that the picture has room for, at the side with more light.
std::optional<VirtualSphere> FindBeside(const PictureView& view, const GroundPlane& ground) {
  for (const double share : {0.5, 0.44, 0.38, 0.32, 0.26, 0.2, 0.15}) {
    std::optional<VirtualSphere> best;
    double best_score = 0.0;
    for (const double azimuth_deg : {0.0, 180.0, -25.0, 205.0}) {
      const VirtualSphere sphere =
          Beside(view, ground, DegToRad(azimuth_deg), share * view.geometry.radius());
      const double room = Room(view, Picture(view, sphere.center, sphere.radius));
      if (room < kMinRoom) continue;
      // Room decides between sides with the same light.
      const double score = LightAt(view, sphere.center) + 1e-3 * room;
      if (best && score <= best_score) continue;
      best_score = score;
      best = sphere;
    }
    if (best) return best;
  }
  return std::nullopt;
}

// For a target that fills the picture: before it, in the lower left corner, on no ground.
VirtualSphere InFront(const PictureView& view) {
  const Vector3d eye = view.X_WC.translation;
  const Vector3d center = view.X_WT * view.geometry.center();
  const double distance = (center - eye).norm();
  const double depth = std::max(distance - 1.4 * view.geometry.radius(), 0.3 * distance);
  const int side = std::min(view.camera.width(), view.camera.height());
  const int column = side / 5, row = view.camera.height() - 1 - side / 5;
  const Vector3d ray = view.rays.Ray(column, row);
  if (!ray.allFinite()) return {center, 0.1 * view.geometry.radius(), std::nullopt};
  const double pixel = view.rays.Differential(column, row).norm() / std::sqrt(2.0);
  return {eye + depth * (view.X_WC.rotation * ray), 0.12 * side * pixel * depth, std::nullopt};
}

}  // namespace

GroundPlane ChooseGround(const target::Geometry& geometry, const calib::Pose& X_WC,
                         const calib::Pose& X_WT) {
  const Vector3d center = X_WT * geometry.center();
  const Vector3d to_camera = (X_WC.translation - center).normalized();
  Vector3d up = Vector3d::UnitZ();
  const double elevation_deg = RadToDeg(std::asin(std::clamp(to_camera.z(), -1.0, 1.0)));
  if (elevation_deg < 5.0 || elevation_deg > 75.0) {
    const double tilt = DegToRad(20.0);
    up = -std::cos(tilt) * X_WC.rotation.col(1) - std::sin(tilt) * X_WC.rotation.col(2);
  }
  return {up, up.dot(center) - Reach(geometry, X_WT, center, -up)};
}

std::vector<VirtualSphere> PlaceSpheres(const std::vector<PictureView>& views) {
  if (views.empty()) return {};
  if (const auto* board = std::get_if<calib::PlaneShape>(&views.front().geometry.shape()))
    return PlaceOnBoard(views, *board);
  std::vector<VirtualSphere> spheres;
  spheres.reserve(views.size());
  for (const PictureView& view : views) {
    const GroundPlane ground = ChooseGround(view.geometry, view.X_WC, view.X_WT);
    spheres.push_back(FindBeside(view, ground).value_or(InFront(view)));
  }
  return spheres;
}

}  // namespace turnlight::estimator::pictures
