// Which view to take next: the one that shrinks the error of the least known light most.
//
// The fit's information and that which the model predicts for each candidate give the sigmas that
// an estimate with it would state (uncertainty/direction_forecast.h). What the model or the
// calibration may have wrong does not shrink with views; where that is most of a sigma the advice
// says so.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/stop_flag.h"
#include "estimator/estimate.h"
#include "estimator/view_information.h"

namespace turnlight::estimator {

// A view that makes the sigma smaller by less than this share of it is not advised: of such views
// 350 would not halve it.
inline constexpr double kLeastGain = 0.002;

// A sigma of which more than this share stays whatever is taken is mostly that: half of its square.
inline constexpr double kMostlyFloor = 0.7;

struct NextViewOptions {
  std::optional<double> wanted;  // sigma of every light's direction, radians
  std::size_t most_views = 32;   // that are looked ahead for it
  const StopFlag* stop = nullptr;
};

struct NextView {
  std::size_t light = 0;  // the least known one, as the estimate counts them
  double sigma = 0.0;     // of its direction, radians; now
  // What stays of it however many views come, and the largest item of the budget in that.
  double floor = 0.0;
  std::string floor_item, floor_words, floor_advice;  // empty: nothing stays
  // The largest sigma of a direction with one of the candidates more, for each of them.
  std::vector<double> with;
  // Candidates one after the other, each the best beside those before it, and the largest sigma
  // then. Empty: none makes it smaller. More than one only for options.wanted: to the first that
  // reaches it, or as far as candidates help.
  struct Step {
    std::size_t candidate = 0;
    double sigma = 0.0;
  };
  std::vector<Step> steps;
  std::optional<double> wanted;

  // Whether what stays is most of a sigma.
  bool IsMostlyFloor(double of) const { return !floor_item.empty() && floor > kMostlyFloor * of; }
  bool reached() const { return wanted && sigma <= *wanted; }
  // Whether the steps do.
  bool reachable() const {
    return reached() || (wanted && !steps.empty() && steps.back().sigma <= *wanted);
  }
};

// Why an estimate has no forecast, in words; none: it has one. Photographs of real surfaces and
// lights that change from frame to frame have none, and what has no sigma.
std::optional<std::string> WhyNoForecast(const Estimate& estimate);

// estimate: must have a forecast. Ties go to the first candidate. Deterministic for any number of
// threads. Fails with kInterrupted when options.stop was set.
Result<NextView> AdviseNextView(const Estimate& estimate,
                                const std::vector<CandidateView>& candidates,
                                const target::Geometry& geometry, const calib::RayGrid& rays,
                                const Sensor& sensor, const NextViewOptions& options = {});

// An angle as messages have it: degrees, two digits.
std::string DegreesText(double radians);

// The advice in a sentence or two (docs/messages.md, `next-view`).
std::string WordsOf(const NextView& advice, const std::vector<CandidateView>& candidates);

// What a person who asked is told.
struct ViewAdvice {
  std::vector<CandidateView> candidates;
  std::optional<NextView> found;  // none: the estimate has no forecast
  std::string words;
};
// The same of any estimate.
Result<ViewAdvice> AdviseOrSayWhy(const Estimate& estimate, std::vector<CandidateView> candidates,
                                  const target::Geometry& geometry, const calib::RayGrid& rays,
                                  const Sensor& sensor, const NextViewOptions& options);

}  // namespace turnlight::estimator
