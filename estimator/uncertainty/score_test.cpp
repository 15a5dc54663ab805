#include "estimator/uncertainty/score_test.h"

#include <cmath>

namespace turnlight::estimator::uncertainty {

void AddTimes(double factor, const solve::Prediction& what, solve::Prediction& to) {
  for (std::size_t c = 0; c < to.size(); ++c)
    for (std::size_t i = 0; i < to[c].size(); ++i)
      to[c][i] += static_cast<float>(factor) * what[c][i];
}

ScoreProbe::ScoreProbe(const observe::Observations& pixels, const model::Scene& scene,
                       const solve::EvaluateOptions& options)
    : pixels_(pixels),
      scene_(scene),
      squares_(options),
      model_(solve::Predict(pixels, scene, options)),
      weight_(pixels.size(), 0.0f) {
  squares_.huber = 0.0;
  squares_.gradient_only = true;
  gradient_ = solve::Evaluate(pixels, scene, squares_).gradient;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels.pixel[i] == observe::Observations::kNoPixel) continue;
    double square = 0.0, above = 0.0;
    for (std::size_t c = 0; c < model_.size(); ++c) {
      const double more =
          static_cast<double>(model_[c][i]) - static_cast<double>(pixels.radiance[c][i]);
      square += more * more;
      above += more;
    }
    if (pixels.IsAtWhite(i) && above > 0.0) continue;
    const double rms = pixels.WeightOf(i) * std::sqrt(square / static_cast<double>(model_.size()));
    const bool far = options.huber > 0.0 && rms > options.huber;
    weight_[i] = far ? static_cast<float>(options.huber / rms) : 1.0f;
  }
}

Score ScoreProbe::Of(const solve::Prediction& change, double times) const {
  Score out;
  observe::Observations other = pixels_;  // whose residuals are larger by the change
  for (std::size_t c = 0; c < model_.size(); ++c)
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const double by = static_cast<double>(change[c][i]), loss = static_cast<double>(weight_[i]);
      const double own = pixels_.WeightOf(i), weight = loss * own * own;
      out.slope +=
          weight * by *
          (static_cast<double>(model_[c][i]) - static_cast<double>(pixels_.radiance[c][i]));
      out.curvature += weight * by * by;
      other.radiance[c][i] -= static_cast<float>(loss * by);  // the fit weighs it by its noise
    }
  out.cross_hessian = times * (solve::Evaluate(other, scene_, squares_).gradient - gradient_);
  out.slope *= times;
  out.curvature *= times * times;
  return out;
}

}  // namespace turnlight::estimator::uncertainty
