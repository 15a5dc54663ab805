// Meshes of polygons for tests, and their files.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace turnlight::rig {

struct Polygons {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<int>> faces;
  std::vector<Eigen::Vector3d> normals;  // one per vertex, or none
};

inline std::string TextPly(const Polygons& mesh) {
  std::ostringstream out;
  out.precision(17);
  out << "ply\nformat ascii 1.0\ncomment by hand\nelement vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (!mesh.normals.empty()) out << "property float nx\nproperty float ny\nproperty float nz\n";
  out << "element face " << mesh.faces.size() << "\nproperty list uchar int vertex_indices\n"
      << "end_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    out << mesh.vertices[i].transpose();
    if (!mesh.normals.empty()) out << " " << mesh.normals[i].transpose();
    out << "\n";
  }
  for (const auto& face : mesh.faces) {
    out << face.size();
    for (const int index : face) out << " " << index;
    out << "\n";
  }
  return out.str();
}

inline std::string Obj(const Polygons& mesh) {
  std::ostringstream out;
  out.precision(17);
  out << "# by hand\nmtllib missing.mtl\no thing\n";
  for (const Eigen::Vector3d& v : mesh.vertices) out << "v " << v.transpose() << "\n";
  for (const Eigen::Vector3d& n : mesh.normals) out << "vn " << n.transpose() << "\n";
  for (const auto& face : mesh.faces) {
    out << "f";
    for (const int index : face) {
      out << " " << index + 1;
      if (!mesh.normals.empty()) out << "//" << index + 1;
    }
    out << "\n";
  }
  return out.str();
}

// Of edge 20 about a place, wound outwards.
inline Polygons Cube(const Eigen::Vector3d& middle = Eigen::Vector3d::Zero(), double half = 10.0) {
  Polygons cube;
  for (int i = 0; i < 8; ++i)
    cube.vertices.emplace_back(
        middle + half * Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  cube.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return cube;
}

// Rings of latitude of a sphere of radius 50, with quadrilaterals and two poles, wound outwards.
inline Polygons Sphere(int rings, int sectors) {
  Polygons sphere;
  sphere.vertices = {{0, 0, 50}, {0, 0, -50}};
  const auto at = [&](int ring, int sector) { return 2 + ring * sectors + sector % sectors; };
  for (int r = 0; r < rings; ++r) {
    const double polar = std::numbers::pi * (r + 1) / (rings + 1);
    for (int s = 0; s < sectors; ++s) {
      const double azimuth = 2.0 * std::numbers::pi * s / sectors;
      sphere.vertices.push_back(50.0 * Eigen::Vector3d(std::sin(polar) * std::cos(azimuth),
                                                       std::sin(polar) * std::sin(azimuth),
                                                       std::cos(polar)));
    }
  }
  for (int s = 0; s < sectors; ++s) {
    sphere.faces.push_back({0, at(0, s), at(0, s + 1)});
    sphere.faces.push_back({1, at(rings - 1, s + 1), at(rings - 1, s)});
    for (int r = 0; r + 1 < rings; ++r)
      sphere.faces.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s + 1)});
  }
  return sphere;
}

// Faces turned round.
inline void Turn(std::vector<int>& face) { std::reverse(face.begin(), face.end()); }
inline Polygons Turned(Polygons mesh) {
  for (auto& face : mesh.faces) Turn(face);
  return mesh;
}

// Both in one mesh, without normals.
inline Polygons Both(Polygons a, const Polygons& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (auto face : b.faces) {
    for (int& index : face) index += first;
    a.faces.push_back(face);
  }
  return a;
}

}  // namespace turnlight::rig
