#include "rig/sim/blob.h"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <numbers>

#include "base/random.h"

namespace turnlight::rig::sim {
namespace {

constexpr double kFrequency = 4.0;
constexpr std::uint64_t kPhaseStream = std::uint64_t{3} << 40;  // clear of the frames' streams

Eigen::Vector3d Phases(std::uint64_t seed) {
  const RandomStream random(seed, kPhaseStream);
  const double turn = 2.0 * std::numbers::pi;
  return {random.Uniform(0, 0.0, turn), random.Uniform(1, 0.0, turn), random.Uniform(2, 0.0, turn)};
}

double RadiusFrom(const Blob& blob, const Eigen::Vector3d& phases, const Eigen::Vector3d& d) {
  double g = 0.0;
  for (int i = 0; i < 3; ++i) g += std::sin(kFrequency * d[i] + phases[i]) / 3.0;
  return blob.radius * (1.0 + blob.depth * g);
}

Eigen::Vector3d NormalFrom(const Blob& blob, const Eigen::Vector3d& phases,
                           const Eigen::Vector3d& d) {
  Eigen::Vector3d slope;
  for (int i = 0; i < 3; ++i) slope[i] = kFrequency * std::cos(kFrequency * d[i] + phases[i]) / 3.0;
  const Eigen::Vector3d tangential = slope - d * d.dot(slope);
  return (d - tangential * (blob.radius * blob.depth / RadiusFrom(blob, phases, d))).normalized();
}

// A call of its own: from -O2 on, the vectoriser of g++ 12 drops the rounding of (double)(float)x.
[[gnu::noinline]] float ToFloat(double value) { return static_cast<float>(value); }

Eigen::Vector3d RoundedToFloat(const Eigen::Vector3d& v) {
  return {ToFloat(v.x()), ToFloat(v.y()), ToFloat(v.z())};
}

void Append(std::string& bytes, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) {
    const auto word = std::bit_cast<std::uint32_t>(static_cast<float>(v[i]));
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(word >> shift));
  }
}

void Append(std::string& bytes, const Eigen::Vector3i& face) {
  bytes.push_back(3);
  for (int i = 0; i < 3; ++i) {
    const auto word = static_cast<std::uint32_t>(face[i]);
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(word >> shift));
  }
}

}  // namespace

double BlobRadius(const Blob& blob, std::uint64_t seed, const Eigen::Vector3d& direction) {
  return RadiusFrom(blob, Phases(seed), direction);
}

Eigen::Vector3d BlobNormal(const Blob& blob, std::uint64_t seed, const Eigen::Vector3d& direction) {
  return NormalFrom(blob, Phases(seed), direction);
}

calib::MeshShape MakeBlob(const Blob& blob, std::uint64_t seed) {
  const Eigen::Vector3d phases = Phases(seed);
  const int columns = blob.segments;
  const int rows = blob.segments / 2;
  calib::MeshShape mesh;
  const auto add_vertex = [&](const Eigen::Vector3d& d) {
    mesh.vertices.push_back(RoundedToFloat(d * RadiusFrom(blob, phases, d)));
    mesh.normals.push_back(RoundedToFloat(NormalFrom(blob, phases, d)).normalized());
  };
  add_vertex(Eigen::Vector3d::UnitZ());
  for (int row = 1; row < rows; ++row) {
    const double zenith = std::numbers::pi * row / rows;
    for (int column = 0; column < columns; ++column) {
      const double azimuth = 2.0 * std::numbers::pi * column / columns;
      add_vertex({std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                  std::cos(zenith)});
    }
  }
  add_vertex(-Eigen::Vector3d::UnitZ());

  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  const auto at = [&](int row, int column) {
    if (row == 0) return 0;
    return row == rows ? last : 1 + (row - 1) * columns + column % columns;
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (row > 0)
        mesh.faces.emplace_back(at(row, column), at(row + 1, column), at(row, column + 1));
      if (row + 1 < rows)
        mesh.faces.emplace_back(at(row, column + 1), at(row + 1, column), at(row + 1, column + 1));
    }
  }
  return mesh;
}

std::string MeshToPly(const calib::MeshShape& mesh) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(mesh.vertices.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
                      "property float ny\nproperty float nz\nelement face " +
                      std::to_string(mesh.faces.size()) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Append(bytes, mesh.vertices[i]);
    Append(bytes, mesh.normals[i]);
  }
  for (const Eigen::Vector3i& face : mesh.faces) Append(bytes, face);
  return bytes;
}

}  // namespace turnlight::rig::sim
