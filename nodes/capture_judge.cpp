#include "nodes/capture_judge.h"

#include <utility>

#include "base/angles.h"
#include "base/format.h"

namespace turnlight::nodes {
namespace {

estimator::UntilAsked AskedOf(const rig::CapturePlan& plan) {
  return {DegToRad(plan.until->direction_deg), static_cast<std::size_t>(plan.count),
          static_cast<std::size_t>(plan.until->most_extra)};
}

Verdict::Kind KindOf(estimator::UntilDecision::Kind kind) {
  switch (kind) {
    case estimator::UntilDecision::Kind::kGoOn:
      return Verdict::Kind::kGoOn;
    case estimator::UntilDecision::Kind::kOneMore:
      return Verdict::Kind::kOneMore;
    case estimator::UntilDecision::Kind::kEnd:
      return Verdict::Kind::kEnd;
  }
  return Verdict::Kind::kGoOn;
}

}  // namespace

CaptureJudge::CaptureJudge(JudgeParts parts)
    : parts_(std::move(parts)), known_(AskedOf(parts_.plan)) {}

void CaptureJudge::Took(double angle_deg, const calib::Exposure& exposure, bool looked,
                        const estimator::Estimate* estimate) {
  angles_deg_.push_back(angle_deg);
  exposure_ = exposure;
  known_.Took(angle_deg, looked, estimate);
}

bool CaptureJudge::NeedsEstimate() const {
  return taken() + 1 >= static_cast<std::size_t>(parts_.plan.count);
}

const rig::JournalEntry* CaptureJudge::NextKept() const {
  const auto entry = parts_.work->kept_entries.find(taken());
  return entry == parts_.work->kept_entries.end() ? nullptr : &entry->second;
}

std::vector<estimator::CandidateView> CaptureJudge::Candidates() const {
  std::vector<estimator::CandidateView> out;
  for (const double angle_deg : rig::ExtraAngles(parts_.plan, angles_deg_))
    out.push_back({calib::PosesAt(parts_.geometry, angle_deg), exposure_, angle_deg,
                   Format("at %.10g\u00b0", angle_deg)});
  return out;
}

Verdict CaptureJudge::Decide(const estimator::Estimate* estimate,
                             const estimator::target::Geometry& target,
                             const calib::RayGrid& rays) const {
  const estimator::UntilDecision decision =
      known_.plan_is_done() ? known_.After(estimate, Candidates(), target, rays, parts_.sensor)
                            : known_.Early();
  Verdict verdict;
  verdict.kind = KindOf(decision.kind);
  verdict.keyframes = taken();
  verdict.angle_deg = decision.view.angle_deg.value_or(0.0);
  verdict.code = decision.code;
  verdict.words = decision.words;
  return verdict;
}

}  // namespace turnlight::nodes
