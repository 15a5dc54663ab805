// What a capture will do, decided before anything moves: angles in order, exposures, patience.
//
// Angles are decimal numbers with at most 6 places and are counted in whole microdegrees, so that
// 36 steps of 10 degrees end at 360 and not at 359.99999.
//
// A camera that is carried by hand has no angles: of its plan count, step_deg, exposures, retries
// and the frame's timeout count.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/strict_object.h"

namespace turnlight::rig {

enum class TurnDirection { kCcw, kCw };  // seen from +z; ccw: commanded angles rise

// One-sided: the last leg of every move goes the way that the capture turns and is at least
// backlash_deg long, so that the gears always rest on the same flank.
enum class Approach { kOneSided, kDirect };

struct AngleLimits {
  double min_deg = 0.0;
  double max_deg = 0.0;
};

// A capture that goes on until the lights' directions are known: it may stop before the end of the
// plan, and adds keyframes after it.
struct UntilDirections {
  double direction_deg = 0.05;   // sigma of every light's direction; above 0, at most 45
  std::int64_t most_extra = 12;  // keyframes beyond count, 0..1000
};

struct CapturePlan {
  // No table: step_deg is the least view change from one keyframe to any other, at most 180, and
  // there is one exposure and no closure.
  bool by_hand = false;
  double start_deg = 0.0;   // -36000..36000
  double step_deg = 10.0;   // above 0, at most 360
  std::int64_t count = 36;  // keyframes, 1..100000, without the closure frame
  TurnDirection direction = TurnDirection::kCcw;
  Approach approach = Approach::kOneSided;
  double backlash_deg = 2.0;  // 0..90; unused when the approach is direct
  double settle_ms = 200.0;   // rest between arrival and exposure, 0..60000
  // Microseconds, 0.1..1e8, at most 16, all different. One: the frame is stored as raw DN. More: a
  // bracket, merged to one linear frame relative to the first, which is the reference.
  std::vector<double> exposures_us{8000.0};
  double gain_db = 0.0;          // -40..80
  std::int64_t retries = 3;      // of a keyframe after the first attempt, 0..100
  bool closure = false;          // revisit the start, whole turns later, after the last keyframe
  double tolerance_deg = 0.05;   // |measured - commanded| of an arrival, above 0, at most 5
  double move_timeout_s = 60.0;  // of one leg, above 0, at most 3600
  double frame_timeout_s = 5.0;  // from trigger to frame, besides the exposure; above 0, max 3600
  std::optional<AngleLimits> limits;     // of the table: what may be commanded
  std::optional<UntilDirections> until;  // not with closure, whose frame is the last of the plan
};

// Everything that must hold. Gives the first thing that is wrong: its key, such as "step_deg", and
// the value with what is allowed. Also refused: angles outside limits (approach included), a
// closure that would repeat the last keyframe.
struct PlanProblem {
  std::string key;
  std::string text;
};
std::optional<PlanProblem> Validate(const CapturePlan& plan);

// Reads and validates. Keys, all optional: start_deg, step_deg, count, direction (ccw, cw),
// approach (one-sided, direct), backlash_deg, settle_ms, exposures_us (a list), gain_db, retries,
// closure (true, false), tolerance_deg, move_timeout_s, frame_timeout_s, limits_deg ([min, max]),
// until ({direction_deg, most_extra}; the first is not optional).
// Messages name file, line and key.
Result<CapturePlan> ParseCapturePlan(StrictObject object);
// Of a camera that is carried by hand: step_deg, count, exposures_us (a list of one), gain_db,
// retries, frame_timeout_s.
Result<CapturePlan> ParsePlanByHand(StrictObject object);

// One frame of the plan. index counts in the order of capture and is the frame's number in the
// session; the closure frame comes last, has index == count and is not part of the session's
// frames.
struct PlannedFrame {
  std::size_t index = 0;
  double angle_deg = 0.0;  // commanded; not wrapped: 0, 10, ... 350, closure 360; cw: 0, -10, ...
  bool closure = false;
  bool by_hand = false;  // at no angle
};
// "frame 3 (30.0 deg)", "closure frame (360.0 deg)", or by hand "frame 3".
std::string Label(const PlannedFrame& planned);
// In order of capture. plan must be valid, here and below.
std::vector<PlannedFrame> PlannedFrames(const CapturePlan& plan);

inline constexpr std::size_t kMostExtraAngles = 120;
// Where a further keyframe could be taken: a quarter, half and three quarters of a step after each
// angle of the plan, and on in quarter steps where the plan ends before the turn is whole; within
// the limits, and not where one is already (in whole turns, by tolerance_deg). Of more than
// kMostExtraAngles they are spread evenly.
std::vector<double> ExtraAngles(const CapturePlan& plan, const std::vector<double>& taken_deg);

// The angles to command, one after the other, to arrive at angle_deg from from_deg: one leg if it
// goes the plan's way far enough (or the approach is direct), else first to the point backlash_deg
// before the angle. From an unknown position pass nothing: then always by that point. For a retry
// pass the angle itself as from_deg: the table backs off and comes again.
std::vector<double> MoveLegs(const CapturePlan& plan, std::optional<double> from_deg,
                             double angle_deg);

// How the table moves: constant acceleration, constant speed, constant deceleration.
struct TableKinematics {
  double speed_deg_per_s = 20.0;           // above 0
  double acceleration_deg_per_s2 = 100.0;  // above 0
};
double MoveSeconds(const TableKinematics& kinematics, double distance_deg);

// What the camera delivers.
struct PictureFormat {
  cv::Size size;
  int channels = 1;    // 1 or 3
  int depth = CV_16U;  // CV_8U, CV_16U or CV_32F, as raw frames come
};

// What the plan will take, with no frame taken twice.
struct PlanEstimate {
  std::size_t frames = 0;             // pictures kept, closure included
  std::size_t exposures = 0;          // triggers
  double travel_deg = 0.0;            // all legs, from start_deg's approach on
  double seconds = 0.0;               // moves, settling, exposures; readout_s per exposure
  AngleLimits range;                  // lowest and highest angle commanded, approach included
  std::uint64_t bytes_per_frame = 0;  // at most, on disk, with its share of the small files
  std::uint64_t bytes = 0;            // at most, the whole session folder
};
PlanEstimate EstimatePlan(const CapturePlan& plan, const TableKinematics& kinematics,
                          const PictureFormat& format, double readout_s = 0.05);

}  // namespace turnlight::rig
