#include "estimator/consistency/picture_order.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "base/parallel.h"

namespace turnlight::estimator::consistency {
namespace {

constexpr int kMostRounds = 50;
constexpr double kFurthest = 1e100;  // two of them have a sum
constexpr double kLess = 1e-9;       // of what is compared: less by rounding is not less

// What is no number is as far as can be: all that is compared has an order.
Eigen::MatrixXd Differences(const SmallViews& views) {
  std::vector<cv::Mat1f> pictures;
  for (const SmallView& view : views.views) pictures.push_back(Masked(view));
  const auto count = static_cast<Eigen::Index>(views.views.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(count, count);
  ParallelFor(pictures.size(), [&](std::size_t i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double apart = cv::norm(pictures[i], pictures[j], cv::NORM_L2);
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          std::isfinite(apart) ? apart : kFurthest;
    }
  });
  return out + out.transpose().eval();
}

std::vector<std::size_t> NearestNeighbours(const Eigen::MatrixXd& apart) {
  const auto count = static_cast<std::size_t>(apart.rows());
  std::vector<std::size_t> tour{0};
  std::vector<bool> taken(count, false);
  taken[0] = true;
  while (tour.size() < count) {
    std::size_t nearest = count;
    for (std::size_t j = 0; j < count; ++j)
      if (!taken[j] &&
          (nearest == count ||
           apart(static_cast<Eigen::Index>(tour.back()), static_cast<Eigen::Index>(j)) <
               apart(static_cast<Eigen::Index>(tour.back()), static_cast<Eigen::Index>(nearest))))
        nearest = j;
    taken[nearest] = true;
    tour.push_back(nearest);
  }
  return tour;
}

// Croes' exchange: a part of the tour is reversed if that makes it shorter.
bool Shorten(const Eigen::MatrixXd& apart, std::vector<std::size_t>& tour) {
  const std::size_t count = tour.size();
  const auto between = [&](std::size_t a, std::size_t b) {
    return apart(static_cast<Eigen::Index>(tour[a % count]),
                 static_cast<Eigen::Index>(tour[b % count]));
  };
  bool shorter = false;
  for (std::size_t i = 0; i + 2 < count; ++i)
    for (std::size_t j = i + 2; j < count; ++j) {
      const double now = between(i, i + 1) + between(j, j + 1);
      const double then = between(i, j) + between(i + 1, j + 1);
      if (!(then < now * (1.0 - kLess))) continue;
      std::reverse(tour.begin() + static_cast<std::ptrdiff_t>(i + 1),
                   tour.begin() + static_cast<std::ptrdiff_t>(j + 1));
      shorter = true;
    }
  return shorter;
}

}  // namespace

std::vector<std::size_t> TourOfPictures(const SmallViews& views) {
  if (views.views.size() < 3 || views.views.size() > kMostOrdered) return {};
  const Eigen::MatrixXd apart = Differences(views);
  std::vector<std::size_t> tour = NearestNeighbours(apart);
  for (int round = 0; round < kMostRounds && Shorten(apart, tour); ++round) {
  }
  return tour;
}

std::vector<std::size_t> Exchanged(const Eigen::MatrixXd& cost, std::vector<std::size_t> picture) {
  const auto of = [&](std::size_t pose, std::size_t view) {
    return cost(static_cast<Eigen::Index>(pose), static_cast<Eigen::Index>(view));
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t k = 1; k < picture.size(); ++k)
      for (std::size_t l = 0; l < k; ++l) {
        const double of_k = of(k, picture[k]), of_l = of(l, picture[l]);
        const double then = of(k, picture[l]) + of(l, picture[k]);
        const double size = std::abs(of_k) + std::abs(of_l);
        // Without an end if what is not less counted: costs that are no numbers are not.
        if (!(then < of_k + of_l - kLess * size)) continue;
        std::swap(picture[k], picture[l]);
        changed = true;
      }
  }
  return picture;
}

}  // namespace turnlight::estimator::consistency
