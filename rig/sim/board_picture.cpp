#include "rig/sim/board_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "calib/calibrate/board/board_print.h"

namespace turnlight::rig::sim {
namespace {

namespace board = calib::calibrate::board;

// Rays are unprojected this many pixels apart and interpolated by cubics in between: the error is
// about (step / f)^4 / 40 radians of a smooth lens, 1e-4 pixels at a focal length of 100 pixels.
constexpr int kStep = 4;

// Cubic interpolation at place t of nodes at 0, 1, 2, 3.
std::array<double, 4> CubicWeights(double t) {
  return {-(t - 1) * (t - 2) * (t - 3) / 6.0, t * (t - 2) * (t - 3) / 2.0,
          -t * (t - 1) * (t - 3) / 2.0, t * (t - 1) * (t - 2) / 6.0};
}

// Unit rays of the corners of all pixels; corner (i, j) is image point (i - 0.5, j - 0.5).
class CornerRays {
 public:
  explicit CornerRays(const calib::CameraModel& camera)
      : columns_(NodesFor(camera.width())), rows_(NodesFor(camera.height())) {
    std::vector<std::vector<Eigen::Vector3d>> rows(static_cast<std::size_t>(rows_));
    ParallelFor(rows.size(), [&](std::size_t row) {
      std::vector<Eigen::Vector2d> points;
      for (int column = 0; column < columns_; ++column)
        points.emplace_back(column * kStep - 0.5, static_cast<double>(row) * kStep - 0.5);
      rows[row] = camera.Unproject(points);
    });
    nodes_.swap(rows);
  }

  // The rays of one line of corners.
  std::vector<Eigen::Vector3d> Line(int line, int width) const {
    const int first = std::clamp(line / kStep - 1, 0, rows_ - 4);
    const auto down = CubicWeights(static_cast<double>(line) / kStep - first);
    std::vector<Eigen::Vector3d> nodes(static_cast<std::size_t>(columns_), Eigen::Vector3d::Zero());
    for (int k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < nodes.size(); ++i)
        nodes[i] +=
            down[static_cast<std::size_t>(k)] * nodes_[static_cast<std::size_t>(first + k)][i];
    std::vector<Eigen::Vector3d> rays(static_cast<std::size_t>(width) + 1);
    for (int i = 0; i <= width; ++i) {
      const int start = std::clamp(i / kStep - 1, 0, columns_ - 4);
      const auto across = CubicWeights(static_cast<double>(i) / kStep - start);
      rays[static_cast<std::size_t>(i)].setZero();
      for (int k = 0; k < 4; ++k)
        rays[static_cast<std::size_t>(i)] +=
            across[static_cast<std::size_t>(k)] * nodes[static_cast<std::size_t>(start + k)];
    }
    return rays;
  }

 private:
  // The last node may lie up to a step outside; a lens that does not reach it loses that edge.
  static int NodesFor(int pixels) { return std::max(4, (pixels + kStep - 1) / kStep + 1); }

  int columns_;
  int rows_;
  std::vector<std::vector<Eigen::Vector3d>> nodes_;
};

// A board ready to be sampled: where rays meet its plane, and what is there.
class BoardSurface {
 public:
  explicit BoardSurface(const PlacedBoard& placed)
      : print_(placed.board), X_BC_(placed.X_CB.Inverse()), paper_(print_.extent()) {
    paper_.min().array() -= placed.quiet_border;
    paper_.max().array() += placed.quiet_border;
  }

  // x, y in B; NaN where the ray does not meet the plane.
  Eigen::Vector2d Meet(const Eigen::Vector3d& ray_C) const {
    const Eigen::Vector3d ray = X_BC_.rotation * ray_C;
    const Eigen::Vector3d& eye = X_BC_.translation;
    const double depth = -eye.z() / ray.z();
    if (!(depth > 0.0)) return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    return eye.head<2>() + depth * ray.head<2>();
  }
  bool OnPaper(const Eigen::Vector2d& p) const { return paper_.contains(p); }
  // May a pixel with these corners see the paper?
  bool MayMeet(const std::array<Eigen::Vector2d, 4>& corners) const {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& corner : corners) {
      if (!corner.allFinite()) return false;
      box.extend(corner);
    }
    return box.intersects(paper_);
  }
  bool Dark(const Eigen::Vector2d& p) const {
    return X_BC_.translation.z() < 0.0 && print_.Dark(p.x(), p.y());
  }

 private:
  board::BoardPrint print_;
  calib::Pose X_BC_;
  Eigen::AlignedBox2d paper_;
};

struct Levels {
  double bright, dark;
};

// Lays one board over a pixel that holds `level`: the mean over its sub-samples.
double LayOver(const BoardSurface& surface, const std::array<Eigen::Vector2d, 4>& corners,
               const Levels& levels, int samples, double level) {
  int dark = 0;
  int bright = 0;
  for (int row = 0; row < samples; ++row)
    for (int column = 0; column < samples; ++column) {
      // Sheared, so that no two lie in one row or column: an upright edge is seen in samples^2
      // steps.
      const double u = (column + (row + 0.5) / samples) / samples;
      const double v = (row + (column + 0.5) / samples) / samples;
      const Eigen::Vector2d p = (corners[0] * (1.0 - u) + corners[1] * u) * (1.0 - v) +
                                (corners[2] * (1.0 - u) + corners[3] * u) * v;
      if (!surface.OnPaper(p)) continue;
      ++(surface.Dark(p) ? dark : bright);
    }
  const double all = static_cast<double>(samples) * samples;
  return (dark * levels.dark + bright * levels.bright + (all - dark - bright) * level) / all;
}

void RenderRow(int row, const std::vector<BoardSurface>& surfaces, const CornerRays& rays,
               const BoardPictureOptions& options, cv::Mat& picture) {
  const auto above = rays.Line(row, picture.cols);
  const auto below = rays.Line(row + 1, picture.cols);
  auto* pixels = picture.ptr<float>(row);
  std::fill(pixels, pixels + picture.cols, static_cast<float>(options.background));
  for (const BoardSurface& surface : surfaces) {
    std::array<Eigen::Vector2d, 4> corners;
    corners[1] = surface.Meet(above[0]);
    corners[3] = surface.Meet(below[0]);
    for (int column = 0; column < picture.cols; ++column) {
      corners[0] = corners[1];
      corners[2] = corners[3];
      corners[1] = surface.Meet(above[static_cast<std::size_t>(column) + 1]);
      corners[3] = surface.Meet(below[static_cast<std::size_t>(column) + 1]);
      if (!surface.MayMeet(corners)) continue;
      pixels[column] = static_cast<float>(LayOver(surface, corners, {options.bright, options.dark},
                                                  options.samples, pixels[column]));
    }
  }
}

void AddNoise(const BoardPictureOptions& options, cv::Mat& picture) {
  const RandomStream random(options.seed, options.stream);
  ParallelFor(static_cast<std::size_t>(picture.rows), [&](std::size_t row) {
    auto* pixels = picture.ptr<float>(static_cast<int>(row));
    for (int column = 0; column < picture.cols; ++column) {
      const auto index =
          row * static_cast<std::size_t>(picture.cols) + static_cast<std::size_t>(column);
      pixels[column] += static_cast<float>(options.noise_sigma * random.Normal(index));
    }
  });
}

}  // namespace

cv::Mat RenderBoards(const std::vector<PlacedBoard>& boards, const calib::CameraModel& camera,
                     const BoardPictureOptions& options) {
  const std::vector<BoardSurface> surfaces(boards.begin(), boards.end());
  const CornerRays rays(camera);
  cv::Mat picture(camera.height(), camera.width(), CV_32F);
  ParallelFor(static_cast<std::size_t>(picture.rows), [&](std::size_t row) {
    RenderRow(static_cast<int>(row), surfaces, rays, options, picture);
  });
  if (options.blur_sigma > 0.0)
    cv::GaussianBlur(picture, picture, cv::Size(), options.blur_sigma, options.blur_sigma,
                     cv::BORDER_REPLICATE);
  if (options.noise_sigma > 0.0) AddNoise(options, picture);
  cv::Mat encoded;
  picture.convertTo(encoded, options.depth, options.depth == CV_8U ? 255.0 : 65535.0);
  return encoded;
}

std::vector<Eigen::Vector2d> BoardPixels(const PlacedBoard& placed,
                                         const calib::CameraModel& camera) {
  std::vector<Eigen::Vector3d> p_C;
  for (const Eigen::Vector3d& p_B : board::BoardPoints(placed.board))
    p_C.push_back(placed.X_CB * p_B);
  return camera.Project(p_C);
}

}  // namespace turnlight::rig::sim
