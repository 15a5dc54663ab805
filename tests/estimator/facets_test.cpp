// Proves: the turn of normals across facets is that of known meshes, and the note is given where it
// is larger than the highlight. Does not prove how wrong an estimate from coarse facets is.
#include "estimator/facets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <map>

#include "base/angles.h"
#include "estimator/notes.h"

namespace turnlight::estimator {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::IsEmpty;

// A ball of radius 1 from an octahedron whose faces are cut in four again and again; normals
// radial.
calib::MeshShape CutBall(int cuts) {
  calib::MeshShape ball;
  ball.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  ball.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int cut = 0; cut < cuts; ++cut) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [it, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(ball.vertices.size()));
      if (is_new)
        ball.vertices.push_back((ball.vertices[static_cast<std::size_t>(a)] +
                                 ball.vertices[static_cast<std::size_t>(b)])
                                    .normalized());
      return it->second;
    };
    std::vector<Eigen::Vector3i> faces;
    for (const Eigen::Vector3i& f : ball.faces) {
      const int a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      for (const auto& part : {Eigen::Vector3i(f[0], a, c), {a, f[1], b}, {c, b, f[2]}, {a, b, c}})
        faces.push_back(part);
    }
    ball.faces = faces;
  }
  ball.normals = ball.vertices;
  ball.normals_made = true;
  return ball;
}

TEST(Facets, TurnOfKnownMeshes) {
  EXPECT_NEAR(RadToDeg(FacetTurn(CutBall(0))), 90.0, 1e-9);
  EXPECT_NEAR(RadToDeg(FacetTurn(CutBall(1))), 60.0, 1e-9);  // of the middle ones, the largest
  // The middle of a face is cut coarser than its corners.
  EXPECT_GT(RadToDeg(FacetTurn(CutBall(4))), 90.0 / 16.0);
  EXPECT_LT(RadToDeg(FacetTurn(CutBall(4))), 1.5 * 90.0 / 16.0);
  calib::MeshShape flat = CutBall(1);
  flat.normals.assign(flat.vertices.size(), Vector3d::UnitZ());
  EXPECT_EQ(FacetTurn(flat), 0.0);
}

Estimate Shiny(double shininess, model::SpecularModel specular_model) {
  Estimate estimate;
  estimate.reflectance.lobes[0].strength = 0.5;
  estimate.reflectance.lobes[0].shape = shininess;
  estimate.reflectance.lobes[0].model = specular_model;
  return estimate;
}

// A highlight of shininess 100 is above half over 6.7 degrees of normals (Phong), 13.5 (Blinn).
TEST(Facets, NotedWhereLargerThanTheHighlight) {
  Estimate estimate = Shiny(100.0, model::SpecularModel::kPhong);
  AddFacetsNote(CutBall(3), estimate);
  ASSERT_EQ(estimate.notes.size(), 1u);
  EXPECT_EQ(estimate.notes[0].code, "facets-coarse");
  EXPECT_THAT(estimate.notes[0].text, HasSubstr("highlight is wide (6.7 degrees"));
  for (auto [fine, shininess, specular_model] :
       {std::tuple(CutBall(5), 100.0, model::SpecularModel::kPhong),
        {CutBall(3), 1.0, model::SpecularModel::kPhong},
        {CutBall(3), 40.0, model::SpecularModel::kBlinnPhong},
        {CutBall(1), 100.0, model::SpecularModel::kNone}}) {
    Estimate other = Shiny(shininess, specular_model);
    AddFacetsNote(fine, other);
    EXPECT_THAT(other.notes, IsEmpty()) << shininess;
  }
  calib::MeshShape own = CutBall(1);
  own.normals_made = false;
  Estimate other = Shiny(100.0, model::SpecularModel::kPhong);
  AddFacetsNote(own, other);
  AddFacetsNote(calib::SphereShape{1.0}, other);
  EXPECT_THAT(other.notes, IsEmpty());
}

}  // namespace
}  // namespace turnlight::estimator
