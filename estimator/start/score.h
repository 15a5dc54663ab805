// One score for all that a search compares, the lower the better: Mallows's C_p, with what no model
// explains in the place of the noise.
//
//   score = e / e_least + sum of prices
//
// e is a candidate's excess variance, e_least the least of those compared: what nothing at hand
// explains, and so the unit in which whatever is added must pay. Being one number, it is an order;
// and several lights, whose shares of the variance add up, pay together what each pays alone.
// C. L. Mallows, "Some comments on C_p", Technometrics 15 (1973).
#pragma once

#include <cstddef>
#include <vector>

#include "estimator/model/model_choice.h"
#include "estimator/model/scene.h"

namespace turnlight::estimator::start {

// What each part of a model must explain, in e_least (docs/estimation.md, "Thresholds"). Without a
// true light of a rendering the excess was 40 times as large and more.
inline constexpr double kLightPrice = 2.0, kColourPrice = 2.0;
// One parameter more, or another formula.
inline constexpr double kRoughPrice = 0.25, kCoatPrice = 0.25, kLobePrice = 0.25;
inline constexpr double kSecondLobePrice = 1.0;  // two parameters that can stand for others

// What must fall so many times for a part alone to be worth its price.
constexpr double RatioFor(double price) { return 1.0 + price; }

// What a light is worth, in its price, without which the excess variance is so many times as large.
constexpr double WorthOfRatio(double ratio) { return (ratio - 1.0) / kLightPrice; }

// Of all parts beside Lambert's diffuse part, Phong's lobe and ambient light. What the user chose
// is in all that are compared, and cancels.
double PriceOf(const model::Scene& scene);

struct Compared {
  const model::Scene* scene;
  double excess;  // variance, > 0
};

// Which is the best: with choice.lights those whose number is nearest to it, and of them the lowest
// score; of equals the first. There must be one.
std::size_t BestOf(const model::ModelChoice& choice, const std::vector<Compared>& compared);

}  // namespace turnlight::estimator::start
