// Leads the capture: for each planned angle move, arrive, settle, check, trigger, check again,
// publish. What cannot be proven is rejected and done again, a bounded number of times; then the
// capture ends with a clear fault and every good frame kept.
//   in       state    TableState, from the turntable
//   in       verdict  Verdict, if the plan has `until`: before the first keyframe and after each
//   one
//                     is waited for, and the capture goes on, or ends, as it says
//   action   move     Move, by the turntable
//   action   expose   Expose, by the camera
//   out      bracket  Bracket, with its proof
//   out      pace     Pace, after each bracket
//   params   still_deg (0.01): two readings of a table that stands differ by no more;
//            retry_wait_ms (500): rest before the first repetition, twice as long before the next;
//            state_timeout_ms (2000): a table that tells nothing for so long counts as lost;
//            home_timeout_s (130): added to every move, as it may begin with a homing;
//            lost_timeout_s (none): a device that fails is tried again for so long in one keyframe,
//            however often that is; none: as often as all else
// Every rejection is a fault of code "retry". A stop in order waits for the keyframe that was
// begun.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/radiometry.h"
#include "nodes/capture_work.h"
#include "nodes/graph/action.h"
#include "nodes/messages.h"
#include "rig/capture/capture_plan.h"
#include "rig/capture/frame_check.h"

namespace turnlight::nodes {

struct KeyframesJob {
  rig::CapturePlan plan;
  rig::FrameGate gate;
  // For the test that shows what they are good for; everything else leaves them on.
  bool check_arrival = true;
  bool settle = true;
};

class KeyframesNode : public graph::Node {
 public:
  // radiometry: of raw DN.
  KeyframesNode(KeyframesJob job, const calib::Radiometry& radiometry,
                std::shared_ptr<const CaptureWork> work)
      : job_(std::move(job)), radiometry_(radiometry), work_(std::move(work)) {}
  Status Configure(StrictObject& params) override;
  Status Start() override;
  Status WindDown() override;

 private:
  // kBefore and kAfter wait until the table was read twice; the first reading before an exposure
  // may be the last of the rest.
  enum class Phase { kIdle, kMoving, kSettling, kBefore, kExposing, kAfter, kResting };

  Status BeginKeyframe();
  Status BeginAttempt();
  Status OnMoved(const graph::ActionOutcome<Move>& outcome);
  Status OnVerdict(const graph::Message<Verdict>& verdict);
  Status OnState(const graph::Message<rig::TableState>& state);
  Status OnTimer(graph::Time now);
  Status Await(Phase phase, graph::Time from);
  Status Expose();
  Status OnExposed(const graph::ActionOutcome<nodes::Expose>& outcome);
  Status Judge(const Frame& frame);
  Status Accept();
  Status Reject(ErrorKind kind, const std::string& why);
  bool TryAgain(ErrorKind kind);
  graph::Duration Rest() const;
  void Enter(Phase phase);
  const rig::PlannedFrame& Frame() const { return frames_[next_]; }

  graph::Clock clock_{this};
  graph::Timer timer_{this, "timer", &KeyframesNode::OnTimer};
  graph::Input<rig::TableState> state_{this, "state", &KeyframesNode::OnState};
  graph::Input<Verdict> verdict_{this, "verdict", &KeyframesNode::OnVerdict,
                                 graph::Need::kOptional};
  graph::ActionClient<Move> move_{this, "move", &KeyframesNode::OnMoved};
  graph::ActionClient<nodes::Expose> expose_{this, "expose", &KeyframesNode::OnExposed};
  graph::Output<Bracket> bracket_out_{this, "bracket"};
  graph::Output<Pace> pace_out_{this, "pace"};

  KeyframesJob job_;
  calib::Radiometry radiometry_;
  std::shared_ptr<const CaptureWork> work_;
  double still_deg_ = 0.0;
  graph::Duration retry_wait_{}, state_timeout_{}, home_timeout_{};
  std::optional<graph::Duration> lost_timeout_;
  std::vector<rig::PlannedFrame> frames_;  // those of work_, and what verdicts add
  std::size_t next_ = 0;                   // into frames_
  bool waiting_ = false;                   // for a verdict
  std::optional<double> from_deg_;         // where the table stands after a good keyframe
  bool stopping_ = false;
  Phase phase_ = Phase::kIdle;
  graph::Time entered_{};                     // the phase
  Pace pace_;                                 // of this keyframe
  std::optional<graph::Time> failing_since_;  // of a device, in this keyframe
  std::optional<double> rest_deg_;            // the last reading of the rest, if it stood
  graph::Time readings_from_{};               // older readings of the table say nothing
  std::vector<double> readings_deg_;          // in this wait
  Bracket bracket_;                           // of the attempt that runs
  std::optional<std::uint64_t> last_id_;
  std::map<std::size_t, std::vector<double>> levels_;  // of good frames, by exposure
  std::vector<double> levels_now_;                     // of this attempt
};

}  // namespace turnlight::nodes
