#include "estimator/consistency/pose_changes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <numeric>

#include "base/angles.h"
#include "base/format.h"
#include "base/parallel.h"
#include "estimator/consistency/picture_order.h"

namespace turnlight::estimator::consistency {
namespace {

using calib::Pose;
using calib::RigPoses;
using Eigen::Vector3d;

using Poses = std::vector<RigPoses>;
using Order = std::vector<std::size_t>;

struct Trial {
  const SmallViews& views;
  const target::Geometry& geometry;
  const Explainer& explainer;
  const Design& as_given;
  Poses given;
  Order in_order;
  const StopFlag* stop = nullptr;
  std::vector<PoseChange> found;
};

Poses Map(const Poses& poses, const std::function<RigPoses(const RigPoses&)>& change) {
  Poses out;
  for (const RigPoses& pose : poses) out.push_back(change(pose));
  return out;
}

// With the stop flag set nothing is worth its time.
double LeftBy(const Trial& trial, const Poses& poses) {
  if (StopRequested(trial.stop)) return HUGE_VAL;
  return trial.explainer.Residual(trial.explainer.DesignOf(poses), trial.in_order);
}

void Try(Trial& trial, const char* code, const std::string& words, const char* question,
         Poses poses) {
  const double left = LeftBy(trial, poses);
  if (StopRequested(trial.stop)) return;
  trial.found.push_back(
      {code, words, question, std::move(poses), trial.in_order, left, trial.found.size(), 1.0});
}

Poses Scaled(const Poses& given, const Turning& turning, double factor) {
  Poses out;
  for (std::size_t k = 0; k < given.size(); ++k)
    out.push_back(Turned(turning, given[k], (factor - 1.0) * turning.angle[k]));
  return out;
}

struct Best {
  double at = 0.0;
  double left = 0.0;
};

// The best of these values of a number that the poses depend on, tried in parallel.
Best BestOf(const std::vector<double>& values, const std::function<double(double)>& left) {
  std::vector<double> results(values.size());
  ParallelFor(values.size(), [&](std::size_t i) { results[i] = left(values[i]); });
  const auto best = std::min_element(results.begin(), results.end());
  return {values[static_cast<std::size_t>(best - results.begin())], *best};
}

// Closer about the best, in steps of a third of the one before, down to `finest`.
Best Refined(Best best, double step, double finest, const std::function<double(double)>& left) {
  for (; step > finest; step /= 3.0) {
    const double third = step / 3.0;
    const Best next = BestOf(
        {best.at - 2.0 * third, best.at - third, best.at + third, best.at + 2.0 * third}, left);
    if (next.left < best.left) best = next;
  }
  return best;
}

// A coarse grid, and a fine one about 1 and about the best.
void TryFactors(Trial& trial, const Turning& turning) {
  const auto left = [&](double factor) {
    return LeftBy(trial, Scaled(trial.given, turning, factor));
  };
  std::vector<double> coarse, fine;
  for (const double factor : {1.0 / 3.0, 0.5, 2.0 / 3.0, 0.75, 0.8, 1.25, 4.0 / 3.0, 1.5, 2.0, 3.0})
    coarse.push_back(factor);
  for (int i = -12; i <= 12; ++i)
    if (i != 0) fine.push_back(1.0 + 0.01 * i);
  Best best = BestOf(coarse, left);
  const Best near = BestOf(fine, left);
  if (near.left < best.left) best = near;
  best = Refined(best, near.at == best.at ? 0.01 : 0.03, 5e-4, left);
  if (StopRequested(trial.stop)) return;
  trial.found.push_back(ChangeOfFactor(trial.views, trial.given, turning, best.at, best.left));
  trial.found.back().place = trial.found.size() - 1;
}

void TryAngles(Trial& trial, const Turning& turning) {
  Try(trial, "angles-reversed", "with the angles reversed", "is the table's direction wrong?",
      Scaled(trial.given, turning, -1.0));
  TryFactors(trial, turning);
}

// The target turned on the table, or the camera begun from another side.
void TryOffset(Trial& trial, const Turning& turning) {
  const auto offset = [&](double angle_deg) {
    return Map(trial.given,
               [&](const RigPoses& pose) { return Turned(turning, pose, DegToRad(angle_deg)); });
  };
  const auto left = [&](double angle_deg) { return LeftBy(trial, offset(angle_deg)); };
  std::vector<double> coarse;
  for (int i = 1; i < 24; ++i) coarse.push_back(15.0 * i);
  Best best = Refined(BestOf(coarse, left), 15.0, 0.3, left);
  best.at = std::remainder(best.at, 360.0);
  Try(trial, "angle-offset", Format("with %.3g degrees added to every angle", best.at),
      "check where the target stood at the angle 0.", offset(best.at));
}

// The order in which numbers from `first` on sort as text: 0, 1, 10, 11, 2 or 1, 10, 11, 2.
Order TextOrder(std::size_t count, std::size_t first) {
  Order order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [first](std::size_t a, std::size_t b) {
    return std::to_string(a + first) < std::to_string(b + first);
  });
  return order;
}

Order Inverse(const Order& order) {
  Order out(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) out[order[k]] = k;
  return out;
}

// Orders that come from sorting numbers as text, or from undoing that where it was not done.
std::vector<Order> TextOrders(std::size_t count) {
  std::vector<Order> out;
  for (const std::size_t first : {std::size_t{0}, std::size_t{1}}) {
    out.push_back(TextOrder(count, first));
    out.push_back(Inverse(out.back()));
  }
  return out;
}

struct OrderWords {
  const char* code;
  std::string words;
  const char* question;
};

OrderWords WordsOf(const SmallViews& views, const Order& picture) {
  const std::size_t count = picture.size();
  bool reversed = true, shifted = true;
  const std::size_t shift = picture[0];
  for (std::size_t k = 0; k < count; ++k) {
    reversed = reversed && picture[k] == count - 1 - k;
    shifted = shifted && picture[k] == (k + shift) % count;
  }
  if (reversed)
    return {"order-reversed", "with the pictures in reversed order",
            "check whether the pictures are listed from last to first."};
  if (shifted) {
    const auto by = 2 * shift > count ? static_cast<long>(shift) - static_cast<long>(count)
                                      : static_cast<long>(shift);
    return {"order-shifted",
            Format("with each frame's picture taken from the frame %ld %s it in the list",
                   std::labs(by), by < 0 ? "before" : "after"),
            "check whether the list of pictures begins too early or too late."};
  }
  const std::vector<Order> as_text = TextOrders(count);
  if (std::find(as_text.begin(), as_text.end(), picture) != as_text.end())
    return {"order-as-text", "with the pictures in the order of their numbers",
            "check whether they were sorted as text, 1, 10, 11, 2."};
  std::string list;
  for (std::size_t k = 0; k < std::min<std::size_t>(count, 8); ++k)
    list += (k == 0 ? "" : ", ") + std::to_string(views.views[picture[k]].number);
  return {"order-shuffled",
          "with the pictures in another order (" + list + (count > 8 ? ", ..." : "") + ")",
          "check which picture belongs to which angle."};
}

void AddOrder(Trial& trial, Order picture) {
  if (picture == trial.in_order ||
      std::any_of(trial.found.begin(), trial.found.end(),
                  [&](const PoseChange& change) { return change.picture == picture; }))
    return;
  const double left = trial.explainer.Residual(trial.as_given, picture);
  if (StopRequested(trial.stop)) return;
  trial.found.push_back(ChangeOfOrder(trial.views, trial.given, std::move(picture), left));
  trial.found.back().place = trial.found.size() - 1;
}

// Every way in which a tour of the pictures can lie on the angles.
std::vector<Order> OrdersOf(const Turning& turning, const Order& tour) {
  const std::size_t count = tour.size();
  Order by_angle(count);
  std::iota(by_angle.begin(), by_angle.end(), std::size_t{0});
  std::sort(by_angle.begin(), by_angle.end(),
            [&](std::size_t a, std::size_t b) { return turning.angle[a] < turning.angle[b]; });
  std::vector<Order> out;
  for (std::size_t shift = 0; shift < count; ++shift)
    for (const bool back : {false, true}) {
      Order& picture = out.emplace_back(count);
      for (std::size_t i = 0; i < count; ++i)
        picture[by_angle[i]] = tour[(back ? 2 * count - i + shift : i + shift) % count];
    }
  return out;
}

// Pictures and poses in another order: only the pictures change, so that one design serves all.
void TryOrders(Trial& trial, const std::optional<Turning>& turning) {
  const std::size_t count = trial.given.size();
  Order reversed(trial.in_order.rbegin(), trial.in_order.rend());
  AddOrder(trial, reversed);
  for (const std::size_t shift : {std::size_t{1}, std::size_t{2}, count - 2, count - 1}) {
    Order shifted(count);
    for (std::size_t k = 0; k < count; ++k) shifted[k] = (k + shift) % count;
    AddOrder(trial, shifted);
  }
  for (const Order& order : TextOrders(count)) AddOrder(trial, order);
  if (!turning || StopRequested(trial.stop)) return;
  const Order tour = TourOfPictures(trial.views);
  if (tour.empty()) return;
  const std::vector<Order> orders = OrdersOf(*turning, tour);
  std::vector<double> left(orders.size());
  ParallelFor(orders.size(), [&](std::size_t i) {
    left[i] = trial.explainer.Residual(trial.as_given, orders[i]);
  });
  const auto best = std::min_element(left.begin(), left.end());
  AddOrder(trial, trial.explainer.Reassigned(
                      trial.as_given, orders[static_cast<std::size_t>(best - left.begin())]));
}

Pose Transposed(const Pose& pose) { return {pose.rotation.transpose(), pose.translation}; }

void TryConventions(Trial& trial) {
  const Poses& given = trial.given;
  const char* which = "check that X_WC goes from the camera to the world.";
  Try(trial, "camera-inverted", "with the camera's poses inverted", which,
      Map(given, [](const RigPoses& p) {
        return RigPoses{p.X_WC.Inverse(), p.X_WT};
      }));
  Try(trial, "target-inverted", "with the target's poses inverted",
      "check that X_WT goes from the target to the world.", Map(given, [](const RigPoses& p) {
        return RigPoses{p.X_WC, p.X_WT.Inverse()};
      }));
  Try(trial, "poses-inverted", "with the poses of camera and target inverted",
      "check that X_WC and X_WT go to the world.", Map(given, [](const RigPoses& p) {
        return RigPoses{p.X_WC.Inverse(), p.X_WT.Inverse()};
      }));
  Try(trial, "camera-rotation-transposed", "with the camera's rotations transposed", which,
      Map(given, [](const RigPoses& p) {
        return RigPoses{Transposed(p.X_WC), p.X_WT};
      }));
  Try(trial, "target-rotation-transposed", "with the target's rotations transposed",
      "check that the rows of X_WT are rows and not columns.", Map(given, [](const RigPoses& p) {
        return RigPoses{p.X_WC, Transposed(p.X_WT)};
      }));
  struct Axes {
    const char* code;
    const char* words;
    Vector3d x, y;  // of the camera's frame here, in the other convention's
  };
  const std::array<Axes, 4> axes{{
      {"camera-axes", "with the camera's y up and z backward, as OpenGL has them",
       Vector3d::UnitX(), -Vector3d::UnitY()},
      {"camera-axes", "with the camera's x forward and z up, as robots' bodies have them",
       -Vector3d::UnitY(), -Vector3d::UnitZ()},
      {"camera-axes", "with the camera's x to the left and y up", -Vector3d::UnitX(),
       -Vector3d::UnitY()},
      {"camera-axes", "with the camera's x to the left and z backward", -Vector3d::UnitX(),
       Vector3d::UnitY()},
  }};
  for (const Axes& one : axes) {
    Pose turn;
    turn.rotation << one.x, one.y, one.x.cross(one.y);
    Try(trial, one.code, one.words, "check that the camera's x is right, y down and z forward.",
        Map(given, [&](const RigPoses& p) {
          return RigPoses{p.X_WC * turn, p.X_WT};
        }));
  }
}

void TryUnits(Trial& trial) {
  for (const double factor : {1000.0, 0.001, 100.0, 0.01, 10.0, 0.1, 25.4, 1.0 / 25.4, 2.0, 0.5}) {
    const bool diameter = factor == 2.0 || factor == 0.5;
    Try(trial, diameter ? "target-size" : "length-unit",
        diameter ? Format("with a target of %.2g times the size", 1.0 / factor)
                 : Format("with the poses' lengths times %.3g", factor),
        diameter ? "check the target's size, whether it is a diameter or a radius."
                 : "check that poses and target have the same unit of length.",
        Map(trial.given, [&](RigPoses p) {
          p.X_WC.translation *= factor;
          p.X_WT.translation *= factor;
          return p;
        }));
  }
}

// The target elsewhere on its table: coordinate by coordinate, in steps from half its radius down.
void TryPlace(Trial& trial) {
  const double radius = trial.geometry.radius();
  const auto moved = [&](const Vector3d& by) {
    return Map(trial.given, [&](const RigPoses& p) {
      return RigPoses{p.X_WC, p.X_WT * Pose{Eigen::Matrix3d::Identity(), by}};
    });
  };
  Vector3d at = Vector3d::Zero();
  double left = trial.explainer.Residual(trial.as_given, trial.in_order);
  for (double step = 0.5; step > 0.01; step /= 2.0)
    for (int axis = 0; axis < 3; ++axis) {
      const auto along = [&](double by) {
        return LeftBy(trial, moved(at + by * radius * Vector3d::Unit(axis)));
      };
      const Best best = BestOf({-step, step}, along);
      if (best.left >= left) continue;
      left = best.left;
      at += best.at * radius * Vector3d::Unit(axis);
    }
  Try(trial, "target-place",
      Format("with the target moved by (%.3g, %.3g, %.3g) in its own frame", at.x(), at.y(),
             at.z()),
      "check where the target stands on the table.", moved(at));
}

}  // namespace

PoseChange ChangeOfFactor(const SmallViews& views, const std::vector<RigPoses>& poses,
                          const Turning& turning, double factor, double left) {
  return {"angle-factor",
          Format("with the angles times %.4g", factor),
          "check the angle that the table turns per step.",
          Scaled(poses, turning, factor),
          InOrder(views),
          left,
          0,
          factor};
}

PoseChange ChangeOfOrder(const SmallViews& views, std::vector<RigPoses> poses, Order picture,
                         double left) {
  const OrderWords words = WordsOf(views, picture);
  return {words.code, words.words, words.question, std::move(poses), std::move(picture), left,
          0,          1.0};
}

std::vector<PoseChange> RankChanges(const SmallViews& views, const target::Geometry& geometry,
                                    const Explainer& explainer, const Design& as_given,
                                    const std::optional<Turning>& turning, const StopFlag* stop) {
  Trial trial{views, geometry, explainer, as_given, PosesOf(views), InOrder(views), stop, {}};
  if (turning) {
    TryAngles(trial, *turning);
    TryOffset(trial, *turning);
  }
  if (views.views.size() > 2 && !StopRequested(stop)) TryOrders(trial, turning);
  TryConventions(trial);
  TryUnits(trial);
  TryPlace(trial);
  std::stable_sort(trial.found.begin(), trial.found.end(),
                   [](const PoseChange& a, const PoseChange& b) { return a.left < b.left; });
  return std::move(trial.found);
}

}  // namespace turnlight::estimator::consistency
