#include "calib/calibrate/lens/agreeing_numbering.h"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "calib/calibrate/board/number_lattice.h"

namespace turnlight::calib::calibrate::lens {
namespace {

constexpr double kPrior = 0.01;   // of the shape's information: a shape's square over the noise's
constexpr double kWorthIt = 0.8;  // of the residuals' size, that one shape must at most leave
constexpr std::size_t kSolveOften = 10;  // views; beyond, one view more changes little
constexpr int kMaxSweeps = 10;

// What a turn of the numbering does to a shape: the offset of point i was, in the axes of before,
// turn^T times that of point to[i].
struct Way {
  std::vector<Eigen::Index> to;
  Eigen::Matrix3d turn;
};

std::vector<Way> WaysOf(const board::Board& board) {
  const auto p_B = board::BoardPoints(board);
  std::vector<Way> ways;
  for (const auto& numbering : board::SameLookingNumberings(board)) {
    Way way;
    for (const std::size_t to : numbering) way.to.push_back(static_cast<Eigen::Index>(to));
    const Eigen::Vector3d x = (p_B[numbering[1]] - p_B[numbering[0]]).normalized();
    way.turn.col(0) = x;
    way.turn.col(1) = Eigen::Vector3d::UnitZ().cross(x);
    way.turn.col(2) = Eigen::Vector3d::UnitZ();
    ways.push_back(std::move(way));
  }
  return ways;
}

// A view's residuals and how the shape moves them, without what its pose can take up.
struct View {
  Eigen::VectorXd residuals;                           // 2 a point
  std::vector<Eigen::Matrix<double, 2, 3>> by_offset;  // of each point
  Eigen::MatrixXd pose;                                // orthonormal columns: what the pose does

  Eigen::VectorXd Left(const Eigen::VectorXd& moved) const {
    return moved - pose * (pose.transpose() * moved);
  }
  Eigen::VectorXd MovedBy(const Eigen::VectorXd& shape, const Way& way) const {
    Eigen::VectorXd moved(residuals.size());
    for (std::size_t i = 0; i < by_offset.size(); ++i)
      moved.segment<2>(2 * static_cast<Eigen::Index>(i)) =
          by_offset[i] * (way.turn.transpose() * shape.segment<3>(3 * way.to[i]));
    return moved;
  }
  double Misfit(const Eigen::VectorXd& shape, const Way& way) const {
    return Left(residuals + MovedBy(shape, way)).squaredNorm();
  }
};

std::vector<View> ViewsOf(const Problem& problem, const Pass& pass) {
  Problem shaped = problem;
  const std::size_t points = problem.points_per_view();
  shaped.shape.assign(points, Eigen::Vector3d::Zero());
  const Linearization linear = Linearize(shaped, pass);
  std::vector<View> views;
  for (std::size_t v = 0; v < problem.poses.size(); ++v) {
    View view;
    const auto rows = static_cast<Eigen::Index>(2 * points);
    const Eigen::Index first = static_cast<Eigen::Index>(v) * rows;
    view.residuals = linear.residuals.segment(first, rows);
    view.by_offset.assign(points, Eigen::Matrix<double, 2, 3>::Zero());
    Eigen::MatrixXd by_pose = Eigen::MatrixXd::Zero(rows, 6);
    const Eigen::Index pose = linear.poses_index + 6 * static_cast<Eigen::Index>(v);
    for (Eigen::Index row = 0; row < rows; ++row)
      for (decltype(linear.jacobian)::InnerIterator it(linear.jacobian, first + row); it; ++it) {
        if (it.col() >= pose && it.col() < pose + 6) by_pose(row, it.col() - pose) = it.value();
        const Eigen::Index offset = it.col() - linear.shape_index - 3 * (row / 2);
        if (offset >= 0 && offset < 3)
          view.by_offset[static_cast<std::size_t>(row / 2)](row % 2, offset) = it.value();
      }
    const Eigen::HouseholderQR<Eigen::MatrixXd> factor(by_pose);
    view.pose = factor.householderQ() * Eigen::MatrixXd::Identity(rows, 6);
    views.push_back(std::move(view));
  }
  return views;
}

// The normal equations of one shape from several views.
class ShapeSum {
 public:
  explicit ShapeSum(std::size_t points)
      : information_(Eigen::MatrixXd::Zero(Size(points), Size(points))),
        gradient_(Eigen::VectorXd::Zero(Size(points))) {}

  void Add(const View& view, const Way& way) {
    Eigen::MatrixXd of_pose = Eigen::MatrixXd::Zero(information_.rows(), view.pose.cols());
    const Eigen::VectorXd left = view.Left(view.residuals);
    for (std::size_t i = 0; i < view.by_offset.size(); ++i) {
      const Eigen::Matrix<double, 3, 2> back =
          (view.by_offset[i] * way.turn.transpose()).transpose();
      const Eigen::Index at = 3 * way.to[i], row = 2 * static_cast<Eigen::Index>(i);
      information_.block<3, 3>(at, at) += back * back.transpose();
      gradient_.segment<3>(at) += back * left.segment<2>(row);
      of_pose.middleRows<3>(at) = back * view.pose.middleRows<2>(row);
    }
    information_ -= of_pose * of_pose.transpose();
  }

  Eigen::VectorXd Shape() const {
    Eigen::MatrixXd held = information_;
    held.diagonal().array() += kPrior * information_.trace() / static_cast<double>(held.rows());
    return -held.ldlt().solve(gradient_);
  }

 private:
  static Eigen::Index Size(std::size_t points) { return static_cast<Eigen::Index>(3 * points); }
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
};

std::size_t BestWay(const View& view, const Eigen::VectorXd& shape, const std::vector<Way>& ways) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t w = 0; w < ways.size(); ++w) {
    const double misfit = view.Misfit(shape, ways[w]);
    if (!(misfit < least)) continue;
    least = misfit;
    best = w;
  }
  return best;
}

Eigen::VectorXd ShapeOf(const std::vector<View>& views, const std::vector<Way>& ways,
                        const std::vector<std::size_t>& chosen) {
  ShapeSum sum(views.front().by_offset.size());
  for (std::size_t v = 0; v < views.size(); ++v) sum.Add(views[v], ways[chosen[v]]);
  return sum.Shape();
}

}  // namespace

std::optional<std::vector<std::size_t>> AgreeingNumberings(const board::Board& board,
                                                           const Problem& problem,
                                                           const Pass& pass) {
  const std::vector<Way> ways = WaysOf(board);
  if (ways.size() < 2 || problem.grid.cells.size() != problem.points_per_view() ||
      problem.poses.empty())
    return std::nullopt;
  const std::vector<View> views = ViewsOf(problem, pass);
  std::vector<std::size_t> chosen{0};
  ShapeSum sum(problem.points_per_view());
  sum.Add(views[0], ways[0]);
  Eigen::VectorXd shape = sum.Shape();
  for (std::size_t v = 1; v < views.size(); ++v) {
    chosen.push_back(BestWay(views[v], shape, ways));
    sum.Add(views[v], ways[chosen[v]]);
    if (v < kSolveOften || v % kSolveOften == 0) shape = sum.Shape();
  }
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const std::vector<std::size_t> before = chosen;
    shape = ShapeOf(views, ways, chosen);
    for (std::size_t v = 0; v < views.size(); ++v) chosen[v] = BestWay(views[v], shape, ways);
    if (chosen == before) break;
  }
  if (std::all_of(chosen.begin(), chosen.end(), [&](auto way) { return way == chosen.front(); }))
    return std::nullopt;
  double before = 0.0, after = 0.0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    before += views[v].Left(views[v].residuals).squaredNorm();
    after += views[v].Misfit(shape, ways[chosen[v]]);
  }
  if (after > kWorthIt * kWorthIt * before) return std::nullopt;
  return chosen;
}

}  // namespace turnlight::calib::calibrate::lens
