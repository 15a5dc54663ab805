#include "estimator/from_session/candidate_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::estimator::from_session {
namespace {

using calib::Pose;
using calib::RigPoses;

constexpr double kMostTurnDeg = 120.0;  // beyond, the way from one frame to the next is a guess
constexpr double kSameDeg = 0.05;       // as a turntable arrives

// Part of a motion that is a screw: share 1 is all of it, 2 is twice.
Pose PartOf(const Pose& motion, double share) {
  const Eigen::AngleAxisd turn(motion.rotation);
  Pose out;
  out.rotation = Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
  if (std::abs(turn.angle()) < 1e-12) {
    out.translation = share * motion.translation;
    return out;
  }
  // Along the axis, and about a point of it: (1 - R) point is what of the translation is across.
  const Eigen::Vector3d along = motion.translation.dot(turn.axis()) * turn.axis();
  const Eigen::Vector3d across = motion.translation - along;
  const double cotangent = 1.0 / std::tan(0.5 * turn.angle());
  const Eigen::Vector3d point = 0.5 * (across + cotangent * turn.axis().cross(across));
  out.translation = share * along + point - out.rotation * point;
  return out;
}

double TurnDeg(const Pose& motion) {
  return RadToDeg(std::abs(Eigen::AngleAxisd(motion.rotation).angle()));
}

// The step from one frame to the next, in W.
struct ViewStep {
  RigPoses from, motion;
  RigPoses At(double share) const {
    return {PartOf(motion.X_WC, share) * from.X_WC, PartOf(motion.X_WT, share) * from.X_WT};
  }
  double turn_deg() const { return std::max(TurnDeg(motion.X_WC), TurnDeg(motion.X_WT)); }
};

RigPoses PosesOf(const rig::FrameRecord& frame) { return {frame.X_WC, frame.X_WT}; }

ViewStep StepOf(const rig::FrameRecord& from, const rig::FrameRecord& to) {
  return {PosesOf(from), {to.X_WC * from.X_WC.Inverse(), to.X_WT * from.X_WT.Inverse()}};
}

// Where the camera is for the target, which is all that a picture of it depends on but for lights.
bool IsThere(const RigPoses& poses, const std::vector<RigPoses>& taken) {
  return std::any_of(taken.begin(), taken.end(), [&](const RigPoses& other) {
    return TurnDeg(poses.X_WC.Inverse() * other.X_WC) < kSameDeg &&
           TurnDeg(poses.X_WT.Inverse() * other.X_WT) < kSameDeg;
  });
}

class Candidates {
 public:
  Candidates(const rig::Session& session, const std::vector<std::size_t>& frames)
      : session_(session), frames_(frames) {
    for (const std::size_t frame : frames) taken_.push_back(PosesOf(session.frames[frame]));
    all_angles_ = std::all_of(frames.begin(), frames.end(), [&](std::size_t frame) {
      return session.frames[frame].angle_deg.has_value();
    });
  }

  // Between frame k and the next, or as far beyond the next as share says.
  void Add(std::size_t k, double share, const std::vector<double>& times) {
    const rig::FrameRecord& from = session_.frames[frames_[k]];
    const rig::FrameRecord& to = session_.frames[frames_[k + 1]];
    const RigPoses poses = StepOf(from, to).At(share);
    if (IsThere(poses, taken_)) return;
    CandidateView view{poses, from.exposure, {}, {}};
    if (all_angles_) view.angle_deg = *from.angle_deg + share * (*to.angle_deg - *from.angle_deg);
    const std::string where = view.angle_deg
                                  ? Format("at %.10g\u00b0", *view.angle_deg)
                                  : Format("%.0f %% of the way from frame %zu to frame %zu",
                                           100.0 * share, frames_[k], frames_[k + 1]);
    for (const double factor : times) {
      view.label = where;
      if (from.exposure.exposure_us)
        view.exposure.exposure_us = factor * *from.exposure.exposure_us;
      if (factor != 1.0) view.label += Format(" with %.10g times the exposure", factor);
      views.push_back(view);
    }
  }
  bool all_angles() const { return all_angles_; }

  std::vector<CandidateView> views;

 private:
  const rig::Session& session_;
  const std::vector<std::size_t>& frames_;
  std::vector<RigPoses> taken_;
  bool all_angles_ = false;
};

// A gap between frames, or beyond them in steps as the last.
struct Gap {
  std::size_t step = 0;  // of frame `step` to the next
  double begin = 0.0;    // shares of the way
};

std::vector<Gap> GapsOf(const rig::Session& session, const std::vector<std::size_t>& frames,
                        bool beyond) {
  std::vector<Gap> out;
  double turned = 0.0, last = 0.0;
  for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
    last = StepOf(session.frames[frames[k]], session.frames[frames[k + 1]]).turn_deg();
    turned += last;
    if (last >= kSameDeg && last < kMostTurnDeg) out.push_back({k, 0.0});
  }
  if (!beyond || out.empty() || out.back().step + 2 != frames.size()) return out;
  for (double begin = 1.0; turned + (begin - 0.5) * last < 360.0; begin += 1.0)
    out.push_back({frames.size() - 2, begin});
  return out;
}

}  // namespace

std::vector<CandidateView> CandidatesOf(const rig::Session& session,
                                        const std::vector<std::size_t>& frames) {
  Candidates out(session, frames);
  const std::vector<Gap> gaps = GapsOf(session, frames, out.all_angles());
  std::vector<double> halfway{1.0};
  if (session.radiometry.noise && !frames.empty() &&
      session.frames[frames.front()].exposure.exposure_us)
    halfway = {1.0, 2.0, 0.5};
  const std::size_t most_gaps = kMostCandidates / (3 + halfway.size());
  const std::size_t count = std::min(gaps.size(), most_gaps);
  for (std::size_t i = 0; i < count; ++i) {
    const Gap& gap = gaps[i * gaps.size() / count];
    out.Add(gap.step, gap.begin + 0.25, {1.0});
    out.Add(gap.step, gap.begin + 0.5, halfway);
    out.Add(gap.step, gap.begin + 0.75, {1.0});
    if (gap.begin >= 1.0) out.Add(gap.step, gap.begin + 1.0, {1.0});
  }
  return std::move(out.views);
}

}  // namespace turnlight::estimator::from_session
