// Vertex normals of triangle meshes. Internal to this folder.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/target_shape.h"

namespace turnlight::rig {

// Gives every vertex the mean normal of the faces around it, weighted by their angle there. Two
// faces count as around the same vertex if a chain of faces leads from one to the other, each
// sharing an edge at the vertex with the next and bent against it by no more than 30 degrees; a
// vertex with several such groups is split: the first keeps its index, copies for the others are
// appended. Vertices at the same place count as one here, so that seams of texture do not show; an
// edge of three or more faces separates them. Faces without area are passed over; a vertex without
// other faces gets (0, 0, 1).
calib::MeshShape WithVertexNormals(std::vector<Eigen::Vector3d> vertices,
                                   std::vector<Eigen::Vector3i> faces);

// The unit vector along v, however small or large v is: also of numbers that are not normal, which
// have fewer digits. Zero of zero.
Eigen::Vector3d UnitAlong(const Eigen::Vector3d& v);

// The unnormalised normal of a face: twice its area, counter-clockwise seen from its tip.
Eigen::Vector3d FaceAreaVector(const std::vector<Eigen::Vector3d>& vertices,
                               const Eigen::Vector3i& face);

}  // namespace turnlight::rig
