// A closed-form target with hollows: a sphere whose radius is modulated smoothly by direction.
//
//   r(d) = radius * (1 + depth * g(d)),  g(d) = mean of sin(4 d_i + phase_i),  i = x, y, z
//
// for unit directions d. The surface is a level set of |p| - r(p / |p|), whose gradient gives exact
// normals. Depths from about 0.1 on make parts of it concave, so that it shadows itself.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "calib/target_shape.h"

namespace turnlight::rig::sim {

struct Blob {
  double radius = 40.0;  // above 0
  double depth = 0.3;    // 0..0.5
  int segments = 96;     // around +z, 8..1024, even; half as many from pole to pole
};

// The radius and the unit normal in a unit direction.
double BlobRadius(const Blob& blob, std::uint64_t seed, const Eigen::Vector3d& direction);
Eigen::Vector3d BlobNormal(const Blob& blob, std::uint64_t seed, const Eigen::Vector3d& direction);

// The triangles, coordinates and normals rounded to 32-bit floats as a file holds them. The seed
// gives the phases.
calib::MeshShape MakeBlob(const Blob& blob, std::uint64_t seed);

// The bytes of a binary PLY file with normals.
std::string MeshToPly(const calib::MeshShape& mesh);

}  // namespace turnlight::rig::sim
