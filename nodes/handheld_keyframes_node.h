// Leads a capture by a camera that a person carries round a still target: takes one picture after
// the other, finds the board in it, and keeps those that are sharp, well fitted and from a view
// that is new. W is the frame in the middle of the board's points
// (calib/calibrate/handheld/board_plane.h).
//   action   expose   Expose, by the camera
//   out      bracket  Bracket of one picture, with the poses of camera and target
//   out      guide    Guidance for the person: after each keyframe, else at most once a second
//   params   board: {columns, rows, spacing, ...}, one that looks the same from no two sides;
//            at ([0, 0, 0]): the target's origin in W; turn_deg (0): the target about W's z;
//            blur_max_px (1.5): of the board's edges, in a keyframe;
//            pause_ms (0): from one picture to the next;
//            retry_wait_ms (500): rest after a picture that failed;
//            idle_timeout_s (120): without a new keyframe for so long the capture ends
// A picture that fails, or does not answer its trigger, is a fault of code "retry"; as many in a
// row as the plan has retries, and one more, end the capture. Whatever ends it, what was kept is
// safe.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "calib/calibrate/board/board.h"
#include "calib/calibrate/handheld/board_plane.h"
#include "calib/calibrate/handheld/registration.h"
#include "calib/camera_model.h"
#include "calib/radiometry.h"
#include "nodes/capture_work.h"
#include "nodes/graph/action.h"
#include "nodes/messages.h"
#include "rig/capture/capture_plan.h"
#include "rig/capture/frame_check.h"
#include "rig/rig_setup.h"

namespace turnlight::nodes {

class HandheldKeyframesNode : public graph::Node {
 public:
  // plan: of a camera that is carried by hand. Of the rig lens, radiometry of raw DN and mosaic are
  // used.
  HandheldKeyframesNode(rig::CapturePlan plan, rig::FrameGate gate, const rig::RigSetup& rig,
                        std::shared_ptr<const CaptureWork> work);
  Status Configure(StrictObject& params) override;
  Status Start() override;
  Status WindDown() override;

 private:
  Status Expose();
  Status OnTimer(graph::Time) { return Expose(); }
  Status OnExposed(const graph::ActionOutcome<nodes::Expose>& outcome);
  Status Retry(ErrorKind kind, const std::string& why);
  Status Look(const Frame& frame);
  Result<std::string> Judge(const Frame& frame);
  void Keep(const Frame& frame, const calib::calibrate::handheld::RegisteredView& view);
  void Guide(const std::string& text);
  bool done() const { return next_ == work_->frames.size(); }

  graph::Clock clock_{this};
  graph::Timer timer_{this, "timer", &HandheldKeyframesNode::OnTimer};
  graph::ActionClient<nodes::Expose> expose_{this, "expose", &HandheldKeyframesNode::OnExposed};
  graph::Output<Bracket> bracket_out_{this, "bracket"};
  graph::Output<Guidance> guide_{this, "guide"};

  const rig::CapturePlan plan_;
  const rig::FrameGate gate_;
  const calib::CameraModel camera_;
  const calib::Radiometry radiometry_;
  const bool mosaic_;
  const std::shared_ptr<const CaptureWork> work_;
  calib::calibrate::board::Board board_;
  calib::calibrate::handheld::BoardPlane plane_;
  calib::Pose X_WT_;
  double blur_max_px_ = 0.0;
  graph::Duration pause_{}, retry_wait_{}, idle_timeout_{};
  std::optional<calib::calibrate::handheld::Registration> registration_;
  std::size_t next_ = 0;  // into work_->frames
  bool stopping_ = false;
  graph::Time kept_at_{};  // the last keyframe, or the start
  std::optional<std::uint64_t> last_id_;
  std::vector<std::string> failed_;  // why, of the pictures since the last keyframe
  std::int64_t failures_ = 0;        // in a row
  std::string guidance_;             // as it was given last,
  graph::Time guided_at_{};          // and when
};

}  // namespace turnlight::nodes
