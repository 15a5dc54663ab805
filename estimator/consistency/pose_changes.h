// Ways in which the poses of a session are wrong as a whole, as people get them wrong.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/stop_flag.h"
#include "calib/rig_geometry.h"
#include "estimator/consistency/explanation.h"
#include "estimator/consistency/small_views.h"
#include "estimator/consistency/turning.h"

namespace turnlight::estimator::consistency {

struct PoseChange {
  std::string code;                    // stable, such as "angles-reversed"
  std::string words;                   // "with the angles reversed"
  std::string question;                // "does the table turn the other way round?"
  std::vector<calib::RigPoses> poses;  // after the change, of each keyframe
  std::vector<std::size_t> picture;    // the view whose picture keyframe k's is, after the change
  double left = 0.0;      // rms that some lights leave of the pictures (Explainer), radiance
  std::size_t place = 0;  // among those that were tried: simple ones first
  double factor = 1.0;    // of angle-factor
};

// The pictures in another order, in words; left as above.
PoseChange ChangeOfOrder(const SmallViews& views, std::vector<calib::RigPoses> poses,
                         std::vector<std::size_t> picture, double left);

// All angles times a factor, about the axis that they turn about; left as above.
PoseChange ChangeOfFactor(const SmallViews& views, const std::vector<calib::RigPoses>& poses,
                          const Turning& turning, double factor, double left);

// One change after another: each is tried by the explainer, and of those with a number the number
// that explains the pictures best; they come back best first. as_given: the explainer's design of
// the poses as they are. turning: what they follow, if they do. With stop set soon, with those that
// were tried.
//
// Tried: angles reversed, times a factor from 1/3 to 3, with an offset; the pictures in another
// order: reversed, shifted, sorted as text, shuffled; camera or target poses inverted or with their
// rotations transposed; other camera axes; lengths in another unit, a radius that is a diameter;
// the target elsewhere on the table.
std::vector<PoseChange> RankChanges(const SmallViews& views, const target::Geometry& geometry,
                                    const Explainer& explainer, const Design& as_given,
                                    const std::optional<Turning>& turning, const StopFlag* stop);

}  // namespace turnlight::estimator::consistency
