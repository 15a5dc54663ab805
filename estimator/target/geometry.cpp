#include "estimator/target/geometry.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

namespace turnlight::estimator::target {
namespace {

using Eigen::Vector3d;

// A shadow ray starts this share of the target's radius above the surface: enough to clear the
// rounding of single-precision tracing, small against any feature of a mesh.
constexpr double kLift = 2e-5;

std::optional<SurfacePoint> IntersectSphere(double radius, const Vector3d& origin,
                                            const Vector3d& direction) {
  const double a = direction.squaredNorm();
  const double b = origin.dot(direction);
  // The discriminant from the perpendicular distance: b^2 - a c cancels for a distant viewer.
  const Vector3d foot = origin - (b / a) * direction;
  const double inside = radius * radius - foot.squaredNorm();
  if (inside <= 0.0) return std::nullopt;
  const double t = -b / a - std::sqrt(inside / a);
  if (t <= 0.0) return std::nullopt;
  SurfacePoint point;
  point.normal = (foot - std::sqrt(inside / a) * direction).normalized();
  point.position = radius * point.normal;
  point.geometric_normal = point.normal;
  point.distance = t;
  return point;
}

std::optional<SurfacePoint> IntersectPlane(const calib::PlaneShape& plane, const Vector3d& origin,
                                           const Vector3d& direction) {
  const bool from_above = direction.z() < 0.0;
  if (direction.z() == 0.0 || (!from_above && plane.sides == 1)) return std::nullopt;
  const double t = -origin.z() / direction.z();
  if (t <= 0.0) return std::nullopt;
  SurfacePoint point;
  point.position = origin + t * direction;
  point.position.z() = 0.0;
  if (std::abs(point.position.x()) > 0.5 * plane.width ||
      std::abs(point.position.y()) > 0.5 * plane.height)
    return std::nullopt;
  point.normal = from_above ? Vector3d::UnitZ() : Vector3d(-Vector3d::UnitZ());
  point.geometric_normal = point.normal;
  point.distance = t;
  return point;
}

struct Ball {
  Vector3d center = Vector3d::Zero();
  double radius = 1.0;
};

Ball BoundingBall(const calib::TargetShape& shape) {
  if (const auto* sphere = std::get_if<calib::SphereShape>(&shape))
    return {Vector3d::Zero(), sphere->radius};
  if (const auto* plane = std::get_if<calib::PlaneShape>(&shape))
    return {Vector3d::Zero(), 0.5 * std::hypot(plane->width, plane->height)};
  const auto& mesh = std::get<calib::MeshShape>(shape);
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
  for (const Vector3d& vertex : mesh.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  Ball ball{0.5 * (low + high), 0.0};
  for (const Vector3d& vertex : mesh.vertices)
    ball.radius = std::max(ball.radius, (vertex - ball.center).norm());
  return ball;
}

}  // namespace

// The mesh in Embree, moved to its centre and scaled to radius 1 so that single precision is used
// well wherever T's origin is.
struct Geometry::MeshTracer {
  MeshTracer(const calib::MeshShape& mesh, const Vector3d& center, double radius)
      : mesh(mesh), center(center), radius(radius) {
    // One builder thread: the tree, and with it every tie, is the same on any number of cores.
    device = rtcNewDevice("threads=1");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.vertices.size()));
    for (const Vector3d& vertex : mesh.vertices) {
      const Eigen::Vector3f p = ((vertex - center) / radius).cast<float>();
      for (int i = 0; i < 3; ++i) *vertices++ = p[i];
    }
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.faces.size()));
    for (const Eigen::Vector3i& face : mesh.faces)
      for (int i = 0; i < 3; ++i) *indices++ = static_cast<unsigned>(face[i]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  ~MeshTracer() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  MeshTracer(const MeshTracer&) = delete;
  MeshTracer& operator=(const MeshTracer&) = delete;

  // Fills origin and direction in scaled coordinates; the start is moved up to the bounding ball,
  // for single precision would lose it from far away. Returns the distance moved, in T's units.
  double SetRay(RTCRay& ray, const Vector3d& origin, const Vector3d& unit) const {
    const Vector3d from_center = origin - center;
    const double skip = std::max(0.0, -from_center.dot(unit) - 1.01 * radius);
    const Vector3d start = (from_center + skip * unit) / radius;
    ray.org_x = static_cast<float>(start.x());
    ray.org_y = static_cast<float>(start.y());
    ray.org_z = static_cast<float>(start.z());
    ray.dir_x = static_cast<float>(unit.x());
    ray.dir_y = static_cast<float>(unit.y());
    ray.dir_z = static_cast<float>(unit.z());
    ray.tnear = 0.0f;
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = 0xFFFFFFFFu;
    ray.flags = 0;
    ray.time = 0.0f;
    ray.id = 0;
    return skip;
  }

  // The first face along a ray; RTC_INVALID_GEOMETRY_ID if there is none.
  unsigned FirstFace(const Vector3d& origin, const Vector3d& direction) const {
    RTCRayHit query;
    SetRay(query.ray, origin, direction.normalized());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &query);
    return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? RTC_INVALID_GEOMETRY_ID : query.hit.primID;
  }

  std::optional<SurfacePoint> Intersect(const Vector3d& origin, const Vector3d& direction) const {
    const unsigned primitive = FirstFace(origin, direction);
    if (primitive == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Recompute(primitive, origin, direction);
  }

  bool SeesBack(const Vector3d& origin, const Vector3d& direction) const {
    const unsigned primitive = FirstFace(origin, direction);
    return primitive != RTC_INVALID_GEOMETRY_ID && !Recompute(primitive, origin, direction);
  }

  // The hit with a known face in double precision: Moeller and Trumbore, "Fast, Minimum Storage
  // Ray/Triangle Intersection" (1997).
  std::optional<SurfacePoint> Recompute(unsigned primitive, const Vector3d& origin,
                                        const Vector3d& direction) const {
    const Eigen::Vector3i& face = mesh.faces[primitive];
    const Vector3d& a = mesh.vertices[face[0]];
    const Vector3d ab = mesh.vertices[face[1]] - a;
    const Vector3d ac = mesh.vertices[face[2]] - a;
    const Vector3d face_normal = ab.cross(ac);
    const Vector3d p = direction.cross(ac);
    const double determinant = ab.dot(p);
    if (!(determinant > 0.0)) return std::nullopt;  // edge-on or seen from the back
    const Vector3d s = origin - a;
    const double u = s.dot(p) / determinant;
    const Vector3d q = s.cross(ab);
    const double v = direction.dot(q) / determinant;
    SurfacePoint point;
    point.distance = ac.dot(q) / determinant;
    point.position = a + u * ab + v * ac;
    point.geometric_normal = face_normal.normalized();
    point.normal = ((1.0 - u - v) * mesh.normals[face[0]] + u * mesh.normals[face[1]] +
                    v * mesh.normals[face[2]])
                       .normalized();
    point.primitive = primitive;
    if (!point.normal.allFinite()) point.normal = point.geometric_normal;
    return point;
  }

  bool Occluded(const Vector3d& origin, const Vector3d& normal, const Vector3d& direction,
                double max_distance) const {
    RTCRay ray;
    const double skip = SetRay(ray, origin + kLift * radius * normal, direction);
    ray.tfar = static_cast<float>((max_distance - skip) / radius);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
    return ray.tfar < 0.0f;
  }

  const calib::MeshShape& mesh;
  Vector3d center;
  double radius;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

Geometry::Geometry(calib::TargetShape shape)
    : shape_(std::make_unique<const calib::TargetShape>(std::move(shape))) {
  const Ball ball = BoundingBall(*shape_);
  center_ = ball.center;
  radius_ = ball.radius;
  if (const auto* mesh = std::get_if<calib::MeshShape>(shape_.get()))
    mesh_ = std::make_unique<MeshTracer>(*mesh, center_, radius_);
}

Geometry::~Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;
Geometry& Geometry::operator=(Geometry&&) noexcept = default;

std::optional<SurfacePoint> Geometry::Intersect(const Vector3d& origin,
                                                const Vector3d& direction) const {
  if (const auto* sphere = std::get_if<calib::SphereShape>(shape_.get()))
    return IntersectSphere(sphere->radius, origin, direction);
  if (const auto* plane = std::get_if<calib::PlaneShape>(shape_.get()))
    return IntersectPlane(*plane, origin, direction);
  return mesh_->Intersect(origin, direction);
}

bool Geometry::SeesBack(const Vector3d& origin, const Vector3d& direction) const {
  if (const auto* plane = std::get_if<calib::PlaneShape>(shape_.get()))
    return plane->sides == 1 && direction.z() > 0.0 &&
           IntersectPlane({plane->width, plane->height, 2}, origin, direction).has_value();
  return mesh_ && mesh_->SeesBack(origin, direction);
}

bool Geometry::CanShadowItself() const { return mesh_ != nullptr; }

bool Geometry::Occluded(const Vector3d& origin, const Vector3d& geometric_normal,
                        const Vector3d& direction, double max_distance) const {
  return mesh_ && mesh_->Occluded(origin, geometric_normal, direction, max_distance);
}

}  // namespace turnlight::estimator::target
