#include "nodes/handheld_keyframes_node.h"

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/angles.h"
#include "base/format.h"
#include "calib/calibrate/board/board_words.h"
#include "calib/calibrate/board/detect_boards.h"
#include "calib/calibrate/handheld/way_on.h"
#include "calib/rig_geometry.h"
#include "nodes/frame_proof.h"

namespace turnlight::nodes {
namespace {

namespace board = calib::calibrate::board;
namespace handheld = calib::calibrate::handheld;

// A person reads no faster.
constexpr graph::Duration kGuideEvery = std::chrono::seconds(1);

// What boards are looked for in. The kernel weighs a mosaic's colours alike at every pixel, and
// moves nothing.
cv::Mat GreyOf(const cv::Mat& image, bool mosaic) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_RGB2GRAY);
  const cv::Mat1f kernel = (cv::Mat1f(3, 1) << 0.25f, 0.5f, 0.25f);
  if (mosaic) cv::sepFilter2D(image, grey, -1, kernel, kernel);
  return grey;
}

}  // namespace

HandheldKeyframesNode::HandheldKeyframesNode(rig::CapturePlan plan, rig::FrameGate gate,
                                             const rig::RigSetup& rig,
                                             std::shared_ptr<const CaptureWork> work)
    : plan_(std::move(plan)),
      gate_(gate),
      camera_(rig.known.lens),
      radiometry_(rig.known.radiometry),
      mosaic_(rig.camera.bayer.has_value()),
      work_(std::move(work)) {}

Status HandheldKeyframesNode::Configure(StrictObject& params) {
  const StrictObject keys = params.Object("board");
  const auto at = params.OptionalNumbers("at", 3, {.min = -1e6, .max = 1e6});
  const double turn_deg =
      params.OptionalNumber("turn_deg", {.min = -360.0, .max = 360.0}).value_or(0.0);
  blur_max_px_ = params.OptionalNumber("blur_max_px", {.max = 50.0, .above = 0.0}).value_or(1.5);
  const auto ms = [&](const char* key, double otherwise, Range range) {
    return graph::FromMs(params.OptionalNumber(key, range).value_or(otherwise));
  };
  pause_ = ms("pause_ms", 0.0, {.min = 0.0, .max = 6e4});
  retry_wait_ = ms("retry_wait_ms", 500.0, {.min = 0.0, .max = 6e4});
  idle_timeout_ = graph::FromMs(
      1e3 * params.OptionalNumber("idle_timeout_s", {.max = 86400.0, .above = 0.0}).value_or(120));
  if (!params.ok()) return {};  // the graph says why
  auto read = board::ReadBoard(keys);
  if (!read) return Forward(read);
  board_ = std::move(*read);
  plane_ = handheld::PlaneOf(board_);
  if (!plane_.options.same_looking.empty())
    params.RefuseText("board", BoardText(board_) +
                                   " looks the same from several sides; allowed is one that does "
                                   "not: odd by even corners, ChArUco, tags");
  X_WT_ = calib::Turn(Eigen::Vector3d::UnitZ(), DegToRad(turn_deg));
  if (at) X_WT_.translation = {(*at)[0], (*at)[1], (*at)[2]};
  return {};
}

Status HandheldKeyframesNode::Start() {
  plane_.options.step_deg = plan_.step_deg;
  registration_.emplace(camera_, plane_.X_WB.Inverse() * X_WT_, plane_.options);
  for (const calib::RigPoses& kept : work_->kept)
    registration_->Keep(handheld::ViewDirection(kept.X_WT.Inverse() * kept.X_WC));
  kept_at_ = guided_at_ = clock_.Now();
  return Expose();
}

Status HandheldKeyframesNode::WindDown() {
  stopping_ = true;
  timer_.Cancel();
  return {};
}

Status HandheldKeyframesNode::Expose() {
  if (done()) RequestStop();
  if (done() || stopping_) return {};
  const ExposeGoal goal{{plan_.exposures_us.front(), plan_.gain_db},
                        graph::FromMs(plan_.frame_timeout_s * 1e3)};
  // The camera's own deadline fires first; this one is for a camera node that hangs.
  const auto sent = expose_.Send(
      goal, clock_.Now(), graph::FromMs(goal.settings.exposure_us * 1e-3 + 1e3) + 2 * goal.timeout);
  return sent ? Status() : Forward(sent);
}

Status HandheldKeyframesNode::OnExposed(const graph::ActionOutcome<nodes::Expose>& outcome) {
  if (stopping_) return {};
  if (outcome.deadline_passed())
    return Retry(ErrorKind::kDevice, "the camera did not answer a trigger");
  if (!outcome.result().frame) return Retry(ErrorKind::kDevice, outcome.result().text);
  const Frame& frame = *outcome.result().frame;
  const auto why = Answers(frame, {plan_.exposures_us.front(), plan_.gain_db}, last_id_);
  if (frame.exposure_begin >= frame.triggered_at) last_id_ = frame.frame_id;
  if (why) return Retry(ErrorKind::kIncomplete, *why);
  failures_ = 0;
  return Look(frame);
}

Status HandheldKeyframesNode::Retry(ErrorKind kind, const std::string& why) {
  failed_.push_back(why);
  const std::string text = Format("picture %lld of %lld: ", static_cast<long long>(++failures_),
                                  static_cast<long long>(plan_.retries + 1)) +
                           why;
  if (failures_ > plan_.retries)
    return tl::unexpected<Error>(
        Error{kind, text + "; the capture pauses here, all good frames are kept"});
  ReportFault("retry", text);
  timer_.After(retry_wait_);
  return {};
}

Status HandheldKeyframesNode::Look(const Frame& frame) {
  const auto guidance = Judge(frame);
  if (!guidance) return Forward(guidance);
  Guide(*guidance);
  if (!done() && clock_.Now() - kept_at_ >= idle_timeout_)
    return tl::unexpected<Error>(Error{
        ErrorKind::kIncomplete,
        Format("no new keyframe for %g s, the last picture: ", graph::ToMs(idle_timeout_) * 1e-3) +
            *guidance + "; the capture pauses here, all good frames are kept"});
  timer_.After(done() ? graph::Duration(0) : pause_);
  return {};
}

// What to tell of a picture. It is kept if there is nothing against it.
Result<std::string> HandheldKeyframesNode::Judge(const Frame& frame) {
  const rig::FrameCheck check = rig::CheckFrame(frame.image, radiometry_, gate_, {});
  if (check.verdict != rig::FrameVerdict::kGood) return check.text;
  const auto seen = board::DetectBoards(GreyOf(frame.image, mosaic_), board_);
  if (!seen) return Forward(seen);
  if (seen->boards.empty())
    return "no board in view" + (seen->remarks.empty() ? "" : ": " + seen->remarks.front());
  const handheld::RegisteredView view =
      registration_->Register(handheld::ViewOf("", *seen, plane_));
  if (!view.pose) return view.why_left_out;
  if (view.keyframe) {
    const double edge_sigma = seen->boards.front().edge_sigma;
    if (edge_sigma > blur_max_px_)
      return Format("too blurred: edges of %.1f px, allowed are %g; hold the camera still",
                    edge_sigma, blur_max_px_);
    Keep(frame, view);
    if (done()) return std::string("done");
  }
  return "move on " + handheld::WayOn(registration_->keyframes(), registration_->CameraOf(view),
                                      X_WT_.rotation.transpose() * Eigen::Vector3d::UnitZ());
}

void HandheldKeyframesNode::Keep(const Frame& frame, const handheld::RegisteredView& view) {
  registration_->Keep(view);
  Bracket bracket;
  bracket.index = work_->frames[next_].index;
  bracket.exposures = {frame};
  bracket.utc = clock_.UtcLabel();
  bracket.attempts = static_cast<std::int32_t>(failed_.size()) + 1;
  bracket.rejected = std::exchange(failed_, {});
  bracket.placed = calib::RigPoses{plane_.X_WB * view.pose->X_CB.Inverse(), X_WT_};
  bracket_out_.Publish(std::move(bracket), frame.exposure_begin);
  ++next_;
  kept_at_ = clock_.Now();
  guidance_.clear();
}

void HandheldKeyframesNode::Guide(const std::string& text) {
  const graph::Time now = clock_.Now();
  if (!guidance_.empty() && (text == guidance_ || now - guided_at_ < kGuideEvery)) return;
  guidance_ = text;
  guided_at_ = now;
  guide_.Publish({text, work_->kept.size() + next_, work_->kept.size() + work_->frames.size()},
                 now);
}

}  // namespace turnlight::nodes
