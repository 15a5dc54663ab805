#include "estimator/consistency/oddness.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "base/format.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "estimator/consistency/odd_frames.h"

namespace turnlight::estimator::consistency {
namespace {

constexpr double kExplained = 2.5;    // times the usual that may be left by what explains a frame
constexpr double kEmpty = 0.03;       // of the model's level
constexpr double kLeastEmpty = 0.08;  // of the target's rows or columns
constexpr int kMostShift = 12;        // small pixels
constexpr double kRough = 0.3;        // of the level, what shading never shows

double Level(const cv::Mat1f& model) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const float value : model)
    if (std::isfinite(value)) sum += static_cast<double>(value), ++count;
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

// What a line of pixels shows where the model says that the target is.
struct Line {
  double shown = 0.0, expected = 0.0;
  std::size_t pixels = 0;
};

// The median second difference along rows on the target: small where shading is smooth.
double Roughness(const cv::Mat1f& picture, const cv::Mat1f& model) {
  std::vector<float> differences;
  for (int row = 0; row < model.rows; ++row)
    for (int column = 1; column + 1 < model.cols; ++column)
      if (std::isfinite(model(row, column)))
        differences.push_back(std::abs(picture(row, column - 1) - 2.0f * picture(row, column) +
                                       picture(row, column + 1)));
  return static_cast<double>(Median(differences));
}

std::vector<Line> LinesOf(const cv::Mat1f& picture, const cv::Mat1f& model, bool rows) {
  std::vector<Line> lines(static_cast<std::size_t>(rows ? model.rows : model.cols));
  for (int row = 0; row < model.rows; ++row)
    for (int column = 0; column < model.cols; ++column) {
      if (!std::isfinite(model(row, column))) continue;
      Line& line = lines[static_cast<std::size_t>(rows ? row : column)];
      line.shown += std::abs(static_cast<double>(picture(row, column)));
      line.expected += static_cast<double>(model(row, column));
      ++line.pixels;
    }
  return lines;
}

// The first and one past the last of a run of lines that show nothing and should.
std::pair<std::size_t, std::size_t> EmptyRun(const std::vector<Line>& lines, double level) {
  std::pair<std::size_t, std::size_t> longest{0, 0};
  std::size_t first = lines.size();
  for (std::size_t i = 0; i <= lines.size(); ++i) {
    const bool empty = i < lines.size() && lines[i].pixels > 0 &&
                       lines[i].expected > 0.1 * level * static_cast<double>(lines[i].pixels) &&
                       lines[i].shown < kEmpty * lines[i].expected;
    if (empty && first == lines.size()) first = i;
    if (!empty && first != lines.size()) {
      if (i - first > longest.second - longest.first) longest = {first, i};
      first = lines.size();
    }
  }
  return longest;
}

cv::Mat1f Flipped(const cv::Mat1f& picture, int code) {
  cv::Mat1f out;
  cv::flip(picture, out, code);
  return out;
}

// The picture moved by whole pixels; NaN-free: what comes in from outside is the border's value.
cv::Mat1f Moved(const cv::Mat1f& picture, int dx, int dy) {
  cv::Mat1f out(picture.size());
  for (int row = 0; row < out.rows; ++row)
    for (int column = 0; column < out.cols; ++column)
      out(row, column) =
          picture(std::clamp(row + dy, 0, out.rows - 1), std::clamp(column + dx, 0, out.cols - 1));
  return out;
}

}  // namespace

std::vector<double> MasksOnTarget(const SmallViews& views, const target::Geometry& geometry,
                                  const calib::RayGrid& rays) {
  std::vector<double> out(views.views.size(), 1.0);
  ParallelFor(out.size(), [&](std::size_t k) {
    const SmallView& view = views.views[k];
    if (cv::countNonZero(view.mask) == static_cast<int>(view.mask.total())) return;
    const calib::Pose X_TC = view.poses.X_WT.Inverse() * view.poses.X_WC;
    std::size_t hits = 0, inside = 0;
    for (int row = 0; row < view.mask.rows; ++row)
      for (int column = 0; column < view.mask.cols; ++column) {
        const Eigen::Vector3d ray = rays.Ray(column, row);
        if (!ray.allFinite() || !geometry.Intersect(X_TC.translation, X_TC.rotation * ray))
          continue;
        ++hits;
        inside += view.mask(row, column) != 0 ? 1 : 0;
      }
    if (hits > 0) out[k] = static_cast<double>(inside) / static_cast<double>(hits);
  });
  return out;
}

Oddness::Oddness(const SmallViews& views, std::vector<cv::Mat1f> models, std::vector<bool> odd,
                 double usual)
    : views_(views), models_(std::move(models)), odd_(std::move(odd)), usual_(usual) {}

double Oddness::LeftAs(std::size_t picture, std::size_t pose) const {
  const FrameResidual residual = Compare(views_.views[picture].radiance, models_[pose]);
  return residual.pixels > 0 ? residual.left : 1e30;
}

std::string Oddness::Emptiness(std::size_t k) const {
  const cv::Mat1f& picture = views_.views[k].radiance;
  const double level = Level(models_[k]);
  const FrameResidual residual = Compare(picture, models_[k]);
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(picture, &low, &high);
  if (std::abs(high) < kEmpty * level && std::abs(low) < kEmpty * level) return "is black";
  if (high - low < 1e-6 * std::max(std::abs(high), 1e-30)) return "has one value everywhere";
  if (std::abs(residual.gain) < kEmpty) return "is black where the target is";
  for (const bool rows : {true, false}) {
    const std::vector<Line> lines = LinesOf(picture, models_[k], rows);
    const auto [first, end] = EmptyRun(lines, level);
    const auto seen =
        std::count_if(lines.begin(), lines.end(), [](const Line& line) { return line.pixels > 0; });
    if (static_cast<double>(end - first) < kLeastEmpty * static_cast<double>(seen)) continue;
    const auto block = static_cast<std::size_t>(views_.block);
    return Format("is empty in %s %zu to %zu", rows ? "rows" : "columns", first * block,
                  end * block - 1);
  }
  return {};
}

std::string Oddness::Copy(std::size_t k) const {
  for (std::size_t j = 0; j < views_.views.size(); ++j) {
    if (j == k || (odd_[j] && j > k)) continue;
    const cv::Mat1f& a = views_.views[k].radiance;
    const cv::Mat1f& b = views_.views[j].radiance;
    if (cv::norm(a, b, cv::NORM_INF) == 0.0)
      return Format("has the same picture as frame %zu", views_.views[j].number);
  }
  return {};
}

std::string Oddness::OtherFrame(std::size_t k) const {
  std::size_t best = k;
  double least = 0.5 * LeftAs(k, k);
  for (std::size_t j = 0; j < models_.size(); ++j) {
    const double left = LeftAs(k, j);
    if (left >= least) continue;
    least = left;
    best = j;
  }
  if (best == k || least > kExplained * usual_) return {};
  return Format("shows what frame %zu should show: check the angle it was taken at",
                views_.views[best].number);
}

std::string Oddness::Turn(std::size_t k) const {
  struct Way {
    int code;
    const char* words;
  };
  const double now = LeftAs(k, k);
  for (const Way& way :
       {Way{-1, "is upside down (turned by 180 degrees)"}, Way{1, "is mirrored left to right"},
        Way{0, "is mirrored top to bottom"}}) {
    const FrameResidual turned = Compare(Flipped(views_.views[k].radiance, way.code), models_[k]);
    if (turned.left < 0.5 * now && turned.left < kExplained * usual_) return way.words;
  }
  return {};
}

std::string Oddness::Shift(std::size_t k) const {
  double least = 0.5 * LeftAs(k, k);
  int best_x = 0, best_y = 0;
  for (int dy = -kMostShift; dy <= kMostShift; ++dy)
    for (int dx = -kMostShift; dx <= kMostShift; ++dx) {
      const double left = Compare(Moved(views_.views[k].radiance, dx, dy), models_[k]).left;
      if (left >= least) continue;
      least = left;
      best_x = dx;
      best_y = dy;
    }
  if (best_x == 0 && best_y == 0) return {};
  return Format("is shifted by about (%d, %d) pixels: check whether the camera or the target moved",
                best_x * views_.block, best_y * views_.block);
}

std::string Oddness::Of(std::size_t k, const FrameJudgement& judged) const {
  const FrameResidual& residual = judged.residual;
  if (judged.odd_mask)
    return Format(
        "has a mask that lets through %.0f %% of the target: check whether it is another frame's",
        100.0 * judged.mask_on_target);
  if (std::string empty = Emptiness(k); !empty.empty()) return empty;
  if (std::string copy = Copy(k); !copy.empty()) return copy;
  if (residual.left_free <= kExplained * usual_)
    return Format(
        "is %s than the others tell, %.3g times, and else like them: check the lamp and the "
        "exposure",
        residual.gain < 1.0 ? "dimmer" : "brighter", residual.gain);
  for (const auto find : {&Oddness::Turn, &Oddness::OtherFrame, &Oddness::Shift})
    if (std::string words = (this->*find)(k); !words.empty()) return words;
  if (Roughness(views_.views[k].radiance, models_[k]) > kRough * residual.level)
    return "looks like noise: check the order of its bytes and its format";
  return Format(
      "differs from what the others tell by %.2g of white, where %.2g is usual: look at it",
      residual.left, usual_);
}

}  // namespace turnlight::estimator::consistency
