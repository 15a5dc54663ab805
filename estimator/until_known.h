// A capture that goes on until the lights' directions are known well enough: when it may stop
// early, when it takes more keyframes than were planned, which ones, and when it gives up.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/messages/messages.h"
#include "estimator/next_view.h"

namespace turnlight::estimator {

// A sigma that is reached may be chance, or that of a light that is two. So before its end a
// capture stops only where it held in all estimates over so much of a turn and at least so many of
// them in a row, with the same number of lights and none further than twice that sigma from where
// it is at the end.
inline constexpr double kHeldDeg = 90.0;
inline constexpr std::size_t kFewestHeld = 3;

struct UntilAsked {
  double direction_sigma = 0.0;  // radians, of every light's direction
  std::size_t planned = 0;       // keyframes
  std::size_t most_extra = 0;    // beyond them
};

struct UntilDecision {
  enum class Kind { kGoOn, kOneMore, kEnd } kind = Kind::kGoOn;
  CandidateView view;  // of kOneMore
  std::string code;    // of kEnd, stable: "early", "reached", "most-extra", "floor", "no-view",
                       // "no-forecast", "no-estimate"
  std::string words;   // of kOneMore and kEnd (docs/messages.md, `until`)
};

class UntilKnown {
 public:
  explicit UntilKnown(const UntilAsked& asked) : asked_(asked) {}

  // After every keyframe, in order, extra ones included: at which angle of the table it was taken.
  // looked: an estimate of all so far was asked for, and estimate is what came of it (null: none).
  // Decisions follow from these calls alone.
  void Took(double angle_deg, bool looked, const Estimate* estimate);
  std::size_t taken() const { return taken_; }
  bool plan_is_done() const { return taken_ >= asked_.planned; }

  // Before the plan is done: kGoOn or kEnd.
  UntilDecision Early() const;
  // Once it is: kOneMore, of the candidates, or kEnd. estimate: of all keyframes.
  UntilDecision After(const Estimate* estimate, const std::vector<CandidateView>& candidates,
                      const target::Geometry& geometry, const calib::RayGrid& rays,
                      const Sensor& sensor) const;

 private:
  struct Held {
    double angle_deg = 0.0;
    std::vector<Eigen::Vector3d> directions;
  };
  bool Reached(const Estimate& estimate) const;
  UntilDecision End(const std::string& id, const Estimate* estimate,
                    const messages::Values& more = {}) const;

  UntilAsked asked_;
  std::size_t taken_ = 0;
  std::vector<Held> held_;  // the last estimates in a row that reached what is asked
};

}  // namespace turnlight::estimator
