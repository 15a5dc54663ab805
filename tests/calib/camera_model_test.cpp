// Proves: projections of closed form and of OpenCV are reproduced; for every lens model of mrcal,
// unprojecting and projecting again is the identity to 1e-6 pixels; a lens refuses what it does not
// reach; the text form keeps every bit and mrcal reads it; the ray grid is as exact as its header
// says. Does not prove: that the coefficients of a real lens are right (that is calibration).
#include "calib/camera_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "lenses.h"

extern "C" {
#include <mrcal/mrcal.h>
}

namespace turnlight::calib {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

CameraModel Model(const LensExample& lens, int width = 640, int height = 480) {
  auto camera = CameraModel::FromString(ModelText(lens, width, height), "test.cameramodel");
  if (!camera) ADD_FAILURE() << camera.error().text;
  return *camera;
}

LensExample Lens(const std::string& name) {
  for (const LensExample& lens : LensExamples())
    if (lens.name == name) return lens;
  ADD_FAILURE() << name;
  return {};
}

// Image points all over the picture and one pixel beyond its edges.
std::vector<Vector2d> PointsOver(int width, int height, int count) {
  const RandomStream random(7, 11);
  std::vector<Vector2d> points{{-1.0, -1.0},
                               {static_cast<double>(width), -1.0},
                               {-1.0, static_cast<double>(height)},
                               {static_cast<double>(width), static_cast<double>(height)}};
  for (int i = 0; i < count; ++i) {
    const auto index = static_cast<std::uint64_t>(2 * i);
    points.emplace_back(random.Uniform(index, -1.0, width),
                        random.Uniform(index + 1, -1.0, height));
  }
  return points;
}

TEST(CameraModel, PinholeIsClosedForm) {
  const auto camera = CameraModel::Pinhole(320, 240, 520.0, 500.0, 159.5, 119.5);
  const auto rays = camera.Unproject({{159.5, 119.5}, {159.5 + 520.0, 119.5 - 250.0}});
  EXPECT_LT((rays[0] - Vector3d(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT((rays[1] - Vector3d(1, -0.5, 1).normalized()).norm(), 1e-15);
  const auto points = camera.Project({{2.0, 4.0, 8.0}, {0, 0, -1}, {0, 0, 0}, {1, NAN, 1}});
  EXPECT_LT((points[0] - Vector2d(159.5 + 130.0, 119.5 + 250.0)).norm(), 1e-12);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_TRUE(points[i].hasNaN()) << i;
}

TEST(CameraModel, WideModelsAreClosedForm) {
  const double angle = 1.1;  // radians off the axis, to the right
  const Vector3d p(3.0 * std::sin(angle), 0.0, 3.0 * std::cos(angle));
  const auto stereographic = Lens("LENSMODEL_STEREOGRAPHIC");
  const double fx = stereographic.intrinsics[0], cx = stereographic.intrinsics[2];
  EXPECT_NEAR(Model(stereographic).Project({p})[0].x(), cx + fx * 2.0 * std::tan(angle / 2), 1e-9);
  EXPECT_NEAR(Model(Lens("LENSMODEL_LONLAT")).Project({p})[0].x(), cx + fx * angle, 1e-9);
  // These see behind themselves.
  const auto behind = Model(Lens("LENSMODEL_LONLAT")).Project({{1.0, 0.0, -1.0}});
  EXPECT_NEAR(behind[0].x(), cx + fx * 0.75 * std::numbers::pi, 1e-9);
}

TEST(CameraModel, AgreesWithOpenCv) {
  for (const char* name :
       {"LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5", "LENSMODEL_OPENCV8", "LENSMODEL_OPENCV12"}) {
    const auto lens = Lens(name);
    const auto& k = lens.intrinsics;
    const cv::Mat core = (cv::Mat_<double>(3, 3) << k[0], 0, k[2], 0, k[1], k[3], 0, 0, 1);
    const std::vector<double> distortion(k.begin() + 4, k.end());
    const std::vector<cv::Point3d> cv_points{{0.1, 0.2, 1.0}, {-0.8, 0.6, 2.0}, {0.5, -0.38, 1.0}};
    std::vector<cv::Point2d> expected;
    cv::projectPoints(cv_points, cv::Vec3d(), cv::Vec3d(), core, distortion, expected);
    std::vector<Vector3d> points;
    for (const auto& p : cv_points) points.emplace_back(p.x, p.y, p.z);
    const auto got = Model(lens).Project(points);
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_NEAR(got[i].x(), expected[i].x, 1e-9) << name;
      EXPECT_NEAR(got[i].y(), expected[i].y, 1e-9) << name;
    }
  }
}

// With linearity 1 and a fixed pupil, CAHVORE's equations reduce to CAHVOR's.
TEST(CameraModel, CahvoreReducesToCahvor) {
  auto cahvor = Lens("LENSMODEL_CAHVOR");
  LensExample cahvore{"LENSMODEL_CAHVORE_linearity=1", cahvor.intrinsics};
  cahvore.intrinsics.insert(cahvore.intrinsics.end(), {0.0, 0.0, 0.0});
  const std::vector<Vector3d> points{{0.1, 0.2, 1.0}, {-0.8, 0.6, 2.0}, {0.5, -0.38, 1.0}};
  const auto a = Model(cahvor).Project(points);
  const auto b = Model(cahvore).Project(points);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((a[i] - b[i]).norm(), 1e-9);
}

TEST(CameraModel, CahvoreIsCentral) {
  const auto lens = Lens("LENSMODEL_CAHVORE_linearity=0.37");
  ASSERT_NE(lens.intrinsics.back(), 0.0);
  const auto points = Model(lens).Project({{-0.45, -0.3, 0.8}, {-450.0, -300.0, 800.0}});
  EXPECT_LT((points[0] - points[1]).norm(), 1e-9);
}

class EveryLens : public testing::TestWithParam<LensExample> {};

TEST_P(EveryLens, ProjectInvertsUnproject) {
  const auto camera = Model(GetParam());
  const auto points = PointsOver(640, 480, 2000);
  const auto rays = camera.Unproject(points);
  const auto back = camera.Project(rays);
  mrcal_lensmodel_t mrcal_lens;
  ASSERT_TRUE(mrcal_lensmodel_from_name(&mrcal_lens, GetParam().name.c_str()));
  double worst = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(rays[i].allFinite()) << points[i].transpose();
    ASSERT_NEAR(rays[i].norm(), 1.0, 1e-14);
    worst = std::max(worst, (back[i] - points[i]).norm());
    const mrcal_point3_t p{{rays[i].x(), rays[i].y(), rays[i].z()}};
    mrcal_point2_t q;
    ASSERT_TRUE(
        mrcal_project(&q, nullptr, nullptr, &p, 1, &mrcal_lens, GetParam().intrinsics.data()));
    worst = std::max(worst, (Vector2d(q.x, q.y) - points[i]).norm());
  }
  EXPECT_LT(worst, 1e-6);
}

TEST_P(EveryLens, TextKeepsEveryBitAndMrcalReadsIt) {
  const auto camera = Model(GetParam());
  const std::string text = camera.ToString();
  const auto again = CameraModel::FromString(text, "again");
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(again->intrinsics(), camera.intrinsics());
  EXPECT_EQ(again->lens_model(), GetParam().name);
  EXPECT_EQ(again->width(), 640);
  EXPECT_EQ(again->height(), 480);
  EXPECT_EQ(again->ToString(), text);

  mrcal_cameramodel_t* read =
      mrcal_read_cameramodel_string(text.data(), static_cast<int>(text.size()));
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(std::vector<double>(read->intrinsics, read->intrinsics + camera.intrinsics().size()),
            camera.intrinsics());
  mrcal_free_cameramodel(&read);
}

TEST_P(EveryLens, DoesNotDependOnThreads) {
  const auto camera = Model(GetParam());
  const auto points = PointsOver(640, 480, 9000);
  SetThreads(1);
  const auto one = camera.Unproject(points);
  SetThreads(7);
  const auto seven = camera.Unproject(points);
  SetThreads(0);
  EXPECT_EQ(one, seven);
}

INSTANTIATE_TEST_SUITE_P(Lenses, EveryLens, testing::ValuesIn(LensExamples()),
                         [](const auto& info) {
                           std::string name = info.param.name.substr(10);
                           for (char& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

// Strong barrel distortion folds the picture over: radius (1 - 0.5 r^2) r has its maximum at
// r = 0.8165, 0.5443 in the picture. Points beyond have no ray: neither the mirrored branch behind
// the fold nor the one further out, turned by half a turn, may answer.
const LensExample kFolding{"LENSMODEL_OPENCV4", {400.0, 400.0, 320.0, 240.0, -0.5, 0.0, 0.0, 0.0}};
constexpr double kReach = 400.0 * 0.5443;

double TangentOf(const Vector3d& ray) { return ray.head<2>().norm() / ray.z(); }

TEST(CameraModel, CoefficientsWhoseSquaresOverflowAreRefused) {
  for (const char* huge : {"4.1e306", "-1e13"}) {
    const auto camera = CameraModel::FromString(
        std::string("{'lensmodel': 'LENSMODEL_CAHVOR', 'extrinsics': [0,0,0,0,0,0], 'imagersize': "
                    "[4, 4], 'intrinsics': [2.5, 6.25, 1.5, 1, 0.01, -0.01, 0.002, -0.8, ") +
            huge + "]}",
        "huge.cameramodel");
    ASSERT_FALSE(camera);
    EXPECT_NE(camera.error().text.find("huge.cameramodel: 'intrinsics': "), std::string::npos);
    EXPECT_NE(camera.error().text.find("allowed is up to 1e12"), std::string::npos);
  }
}

TEST(CameraModel, BeyondReachIsNan) {
  std::vector<Vector2d> points;
  for (int row = 0; row < 480; row += 3)
    for (int column = 0; column < 640; column += 3) points.emplace_back(column, row);
  const auto rays = Model(kFolding).Unproject(points);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double radius = (points[i] - Vector2d(320, 240)).norm();
    if (radius < 0.999 * kReach) {
      ASSERT_LT(TangentOf(rays[i]), 0.8165) << points[i].transpose();
    } else if (radius > 1.001 * kReach) {
      ASSERT_TRUE(rays[i].hasNaN()) << points[i].transpose();
    }
  }
}

TEST(CameraModel, NotFinitePointsGiveNan) {
  const auto rays = Model(kFolding).Unproject({{NAN, 240.0}, {320.0, INFINITY}, {-1e300, 1e300}});
  for (const Vector3d& ray : rays) EXPECT_TRUE(ray.hasNaN());
}

// Behind the fold a direction projects into the picture, upside down.
TEST(CameraModel, ProjectedDirectionsBehindTheFoldDoNotComeBack) {
  const auto camera = Model(kFolding);
  const Vector3d behind(1.6, 0.0, 1.0);
  const auto point = camera.Project({behind});
  ASSERT_LT(point[0].x(), 320.0);
  ASSERT_GT(point[0].x(), 320.0 - kReach);
  EXPECT_LT(TangentOf(camera.Unproject(point)[0]), 0.8165);
}

TEST(CameraModel, NoPointsNoRays) {
  const auto camera = CameraModel::Pinhole(4, 4, 10, 10, 2, 2);
  EXPECT_TRUE(camera.Unproject({}).empty());
  EXPECT_TRUE(camera.Project({}).empty());
}

// The largest angle in radians between the grid's rays and exact ones, at random points within
// pixels.
double WorstRayError(const CameraModel& camera) {
  const RayGrid grid(camera);
  const RandomStream random(3, 5);
  std::vector<Vector2d> points;
  std::vector<Vector3d> rays;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const int column = static_cast<int>(random.Uniform(4 * i, 0, camera.width()));
    const int row = static_cast<int>(random.Uniform(4 * i + 1, 0, camera.height()));
    const double du = random.Uniform(4 * i + 2, -1, 1), dv = random.Uniform(4 * i + 3, -1, 1);
    points.emplace_back(column + du, row + dv);
    rays.push_back(grid.Ray(column, row, du, dv));
  }
  const auto exact = camera.Unproject(points);
  double worst = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    worst = std::max(worst, (rays[i] - exact[i]).norm());
  return worst;
}

TEST(RayGrid, MatchesExactRays) {
  EXPECT_LT(WorstRayError(Model(Lens("LENSMODEL_OPENCV8"))), 2e-9);
  for (const double f : {100.0, 500.0})
    EXPECT_LT(WorstRayError(CameraModel::Pinhole(300, 200, f, f, 149.5, 99.5)), 0.3 / (f * f * f));
}

TEST_P(EveryLens, RayGridAgreesWithUnproject) {
  const auto lens = GetParam();
  const auto camera = Model(lens, 64, 48);
  const RayGrid grid(camera);
  std::vector<Vector2d> points;
  std::vector<Vector3d> rays;
  for (int row = 0; row < 48; ++row) {
    for (int column = 0; column < 64; ++column) {
      points.emplace_back(column, row);
      rays.push_back(grid.Ray(column, row));
    }
  }
  const auto exact = camera.Unproject(points);
  for (std::size_t i = 0; i < rays.size(); ++i)
    ASSERT_LT((rays[i] - exact[i]).norm(), 1e-11) << points[i].transpose();
}

TEST(RayGrid, DifferentialMatchesFiniteDifferences) {
  const auto camera = Model(Lens("LENSMODEL_OPENCV8"));
  const RayGrid grid(camera);
  constexpr double kStep = 1e-3;
  for (const auto& [column, row] : {std::pair{0, 0}, {639, 479}, {639, 0}, {320, 240}, {50, 400}}) {
    const double u = column, v = row;
    const auto rays =
        camera.Unproject({{u - kStep, v}, {u + kStep, v}, {u, v - kStep}, {u, v + kStep}});
    const auto differential = grid.Differential(column, row);
    const double scale = differential.norm();
    EXPECT_LT((differential.col(0) - (rays[1] - rays[0]) / (2 * kStep)).norm(), 1e-5 * scale);
    EXPECT_LT((differential.col(1) - (rays[3] - rays[2]) / (2 * kStep)).norm(), 1e-5 * scale);
    const Vector3d by_grid =
        (grid.Ray(column, row, 1e-4, 0) - grid.Ray(column, row, -1e-4, 0)) / 2e-4;
    EXPECT_LT((differential.col(0) - by_grid).norm(), 1e-9 * scale);
  }
}

TEST(RayGrid, BeyondReachIsNan) {
  const RayGrid grid(Model(kFolding));
  EXPECT_TRUE(grid.Ray(0, 0, 0.3, 0.3).hasNaN());
  EXPECT_TRUE(grid.Differential(0, 0).hasNaN());
  EXPECT_TRUE(grid.Ray(320, 240, 0.5, -0.5).allFinite());
  for (int row = 0; row < 480; ++row) {
    for (int column = 0; column < 640; ++column) {
      const double radius = Vector2d(column - 320, row - 240).norm();
      const Vector3d ray = grid.Ray(column, row);
      if (radius < 0.999 * kReach) {
        ASSERT_LT(TangentOf(ray), 0.8165) << column << " " << row;
      } else if (radius > 1.001 * kReach) {
        ASSERT_TRUE(ray.hasNaN()) << column << " " << row;
      }
    }
  }
}

TEST(RayGrid, OnePixel) {
  const RayGrid grid(CameraModel::Pinhole(1, 1, 10, 10, 0, 0));
  EXPECT_LT((grid.Ray(0, 0) - Vector3d(0, 0, 1)).norm(), 1e-15);
}

}  // namespace
}  // namespace turnlight::calib
