#include "estimator/view_evidence.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

#include "base/angles.h"
#include "base/format.h"
#include "base/messages/messages.h"
#include "estimator/notes.h"
#include "estimator/observe/radiance_statistics.h"
#include "estimator/observe/views.h"
#include "estimator/solve/prediction.h"

namespace turnlight::estimator {
namespace {

using observe::Observations;
using solve::Prediction;
using Pair = std::pair<int, int>;  // a view, and the earlier one that it is compared with

constexpr double kSamePoseDeg = 0.01;
constexpr double kSamePlace = 1e-4;      // of R
constexpr double kSameSurfaceDeg = 0.5;  // rms between what two views' pixels see
constexpr std::size_t kFewPixels = 30;
// Differences count as one that the model predicts from so many times what noise explains.
constexpr double kPredicted = 3.0;

bool IsSame(const calib::Pose& a, const calib::Pose& b, double radius) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(a.rotation.transpose() * b.rotation));
  return std::abs(RadToDeg(turn.angle())) < kSamePoseDeg &&
         (a.translation - b.translation).norm() < kSamePlace * radius;
}
bool IsSame(const calib::RigPoses& a, const calib::RigPoses& b, double radius) {
  return IsSame(a.X_WC, b.X_WC, radius) && IsSame(a.X_WT, b.X_WT, radius);
}

bool AreCopies(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type() || a.empty()) return false;
  const std::size_t bytes = a.total() * a.elemSize();
  if (std::memcmp(a.data, b.data, bytes) != 0) return false;
  // One value everywhere, as of a black picture, is no sign of a copy.
  return std::memcmp(a.data, a.data + a.elemSize1(), bytes - a.elemSize1()) != 0;
}

// What two views show at the pixels that both use.
struct Common {
  std::size_t pixels = 0;
  double surface_deg = 0.0;                // rms angle between the normals, and mirrored directions
  double observed = 0.0, predicted = 0.0;  // rms difference of the radiances
};

class Comparison {
 public:
  Comparison(const Observations& all, const Prediction* model) : all_(all), model_(model) {}

  Common Of(const Pair& views) const {
    Common common;
    double angle = 0.0, observed = 0.0, predicted = 0.0;
    ForCommon(views, [&](std::size_t a, std::size_t b) {
      ++common.pixels;
      angle += std::max(Angle2(all_.normal, a, b), Angle2(all_.mirrored, a, b));
      for (int c = 0; c < all_.channels; ++c) {
        observed += Square(all_.radiance[c][a] - all_.radiance[c][b]);
        if (model_ != nullptr)
          predicted += Square((*model_)[static_cast<std::size_t>(c)][a] -
                              (*model_)[static_cast<std::size_t>(c)][b]);
      }
    });
    if (common.pixels == 0) return common;
    const auto pixels = static_cast<double>(common.pixels);
    common.surface_deg = RadToDeg(std::sqrt(angle / pixels));
    common.observed = std::sqrt(observed / (pixels * all_.channels));
    common.predicted = std::sqrt(predicted / (pixels * all_.channels));
    return common;
  }

 private:
  static double Square(float value) {
    return static_cast<double>(value) * static_cast<double>(value);
  }
  static double Angle2(const std::array<std::vector<float>, 3>& vectors, std::size_t a,
                       std::size_t b) {
    double sum = 0.0;
    for (const std::vector<float>& component : vectors) sum += Square(component[a] - component[b]);
    return sum;
  }
  // Pixels of a keyframe stand in the picture's order, with filling between them and at the end.
  template <typename Visit>
  void ForCommon(const Pair& views, const Visit& visit) const {
    const auto begin = [&](int k) { return all_.tile_begin[k] * observe::kTile; };
    std::size_t a = begin(views.first), b = begin(views.second);
    while (a < begin(views.first + 1) && b < begin(views.second + 1)) {
      const auto tells = [&](std::size_t i) {
        return all_.pixel[i] != Observations::kNoPixel && !all_.IsAtWhite(i);
      };
      if (!tells(a))
        ++a;
      else if (!tells(b))
        ++b;
      else if (all_.pixel[a] == all_.pixel[b])
        visit(a++, b++);
      else
        ++(all_.pixel[a] < all_.pixel[b] ? a : b);
    }
  }

  const Observations& all_;
  const Prediction* model_;
};

// Whether two views see the target differently: other pixels, or another surface at the same ones.
bool SeesOther(const Common& common) {
  return common.pixels < kFewPixels || common.surface_deg > kSameSurfaceDeg;
}

std::string Named(const Pair& views, const std::vector<std::size_t>& numbers) {
  const auto of = [&](int view) {
    return "frame " + std::to_string(numbers.empty() ? static_cast<std::size_t>(view)
                                                     : numbers[static_cast<std::size_t>(view)]);
  };
  return of(views.first) + " and " + of(views.second);
}

struct Causes {
  int repeated = 0, unmoved = 0;
  Pair first_unmoved;
  double predicted = 0.0;
};

}  // namespace

std::vector<Pair> FindCopies(const Observations& all, const std::vector<cv::Mat>& signatures,
                             const std::vector<calib::RigPoses>& poses) {
  std::vector<Pair> copies;
  const Comparison comparison(all, nullptr);
  for (int k = 1; k < static_cast<int>(signatures.size()); ++k)
    for (int earlier = 0; earlier < k; ++earlier) {
      if (!AreCopies(signatures[k], signatures[earlier])) continue;
      if (!IsSame(poses[k], poses[earlier], all.radius) && SeesOther(comparison.Of({k, earlier})))
        copies.emplace_back(k, earlier);
      break;
    }
  return copies;
}

void ExplainViews(const Observations& all, const std::vector<cv::Mat>& signatures,
                  const std::vector<calib::RigPoses>& poses, const model::Scene& scene,
                  const solve::EvaluateOptions& options,
                  const std::vector<std::size_t>& frame_numbers, Estimate& out) {
  const auto note = std::find_if(out.notes.begin(), out.notes.end(), [](const Note& candidate) {
    return candidate.code == "views-add-nothing";
  });
  if (note == out.notes.end()) return;
  const double noise = observe::EstimateNoise(all);
  const Prediction model = solve::Predict(all, scene, options);
  const Comparison comparison(all, &model);
  const double limit = observe::LikeLimit(noise);
  std::vector<Pair> copies = FindCopies(all, signatures, poses);
  // Noiseless pictures of what does not change are the same bit for bit, and no copies.
  if (!Unexplained(out.rms, noise * all.radiance_unit))
    std::erase_if(copies, [&](const Pair& views) {
      return comparison.Of(views).predicted <= kPredicted * limit;
    });
  const auto like = observe::LikeViews(signatures, limit * all.radiance_unit);
  Causes causes;
  for (const Pair& views : like) {
    if (IsSame(poses[views.first], poses[views.second], all.radius)) {
      ++causes.repeated;
      continue;
    }
    const Common common = comparison.Of(views);
    if (common.pixels < kFewPixels || !SeesOther(common) || common.observed > limit ||
        !(common.predicted > kPredicted * limit))
      continue;
    if (causes.unmoved++ > 0) continue;
    causes.first_unmoved = views;
    causes.predicted = common.predicted;
  }
  messages::Values values{{"distinct", std::to_string(out.distinct_views)},
                          {"views", std::to_string(out.views)}};
  if (!copies.empty()) {
    values["copies"] = std::to_string(copies.size());
    values["pair"] = Named(copies.front(), frame_numbers);
    note->text = messages::Text("views-add-nothing/copies", values);
  } else if (causes.unmoved > 0) {
    values["pair"] = Named(causes.first_unmoved, frame_numbers);
    values["predicted"] = Format("%.2g", causes.predicted * all.radiance_unit);
    values["times"] = Format("%.0f", causes.predicted / std::max(noise, 1e-12));
    note->text = messages::Text("views-add-nothing/unmoved", values);
  } else if (!like.empty() && causes.repeated == static_cast<int>(like.size())) {
    note->text = messages::Text("views-add-nothing/repeated", values);
  }
}

}  // namespace turnlight::estimator
