// What travels between the nodes of a capture. Times are nanoseconds since the graph started,
// angles degrees counter-clockwise seen from +z and not wrapped, lengths the session's unit.
//
// Pictures are shared, never copied, and never written to once they were published. The fault of
// nodes/graph/fault.h is the message for what goes wrong.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/pose.h"
#include "calib/radiometry.h"
#include "calib/rig_geometry.h"
#include "nodes/graph/action.h"
#include "nodes/graph/wire.h"
#include "rig/device.h"

namespace turnlight::nodes {

// An action: go to the last of these angles by way of the others, each within timeout. A table that
// does not know where it stands homes first.
struct MoveGoal {
  std::vector<double> legs_deg;
  rig::DeviceTime timeout{};
};
struct MoveResult {
  bool arrived = false;
  double angle_deg = 0.0;  // as the controller reports it
  std::string text;        // why not
};
struct Move {
  using Goal = MoveGoal;
  using Feedback = rig::TableState;
  using Result = MoveResult;
};

// One exposure as the camera gave it: not yet judged.
struct Frame {
  cv::Mat image;               // DN: CV_8U, CV_16U or CV_32F, grey or R, G, B
  std::uint64_t frame_id = 0;  // of the device
  std::uint64_t trigger = 0;   // that the device says it answers; 0: it does not say
  std::uint64_t asked_trigger = 0;
  rig::DeviceTime triggered_at{}, exposure_begin{}, exposure_end{};
  rig::CameraSettings actual;  // read back for this frame
  bool complete = true;
  std::int64_t drained = 0;                  // older pictures thrown away before the trigger
  std::vector<rig::DeviceReading> readings;  // what the camera measured of itself after it
};

// An action: one triggered exposure; fails if no picture comes within timeout of its end.
struct ExposeGoal {
  rig::CameraSettings settings;
  rig::DeviceTime timeout{};
};
struct ExposureBegun {
  std::uint64_t trigger = 0;
  rig::DeviceTime at{};
};
struct ExposeResult {
  std::optional<Frame> frame;
  std::string text;  // why there is none
};
struct Expose {
  using Goal = ExposeGoal;
  using Feedback = ExposureBegun;
  using Result = ExposeResult;
};

// All exposures of one planned angle, with the proof that they belong to it: the table stood there,
// idle and read twice, before the first and after the last of them. Or one picture of a camera that
// is carried by hand, with its own poses; angles mean nothing then.
struct Bracket {
  std::uint64_t index = 0;  // of rig::PlannedFrames
  bool closure = false;
  double angle_deg = 0.0;           // commanded
  double angle_measured_deg = 0.0;  // read before the first exposure
  std::vector<Frame> exposures;     // in the plan's order
  std::string utc;                  // a label
  std::int32_t attempts = 1;
  std::vector<std::string> rejected;      // why, of each attempt that failed
  std::optional<calib::RigPoses> placed;  // if the rig's geometry does not say where
};

// What a person who carries the camera should know now.
struct Guidance {
  std::string text;        // "no board in view"
  std::uint64_t done = 0;  // keyframes, those before a resume included
  std::uint64_t total = 0;
};

// The lens, once, for whoever comes late as well.
struct CameraModel {
  std::string text;  // of a .cameramodel
  std::string sha256;
};

// A bracket as one linear picture with its pose.
struct Keyframe {
  Bracket bracket;
  std::string camera_sha256;  // of the CameraModel that the poses and pixels go with
  cv::Mat image;              // as it is stored: raw DN, or the merged bracket
  cv::Mat1b validity;         // may be empty
  calib::Exposure exposure;   // of image
  calib::LinearImage linear;  // radiance; what the estimator takes
  calib::Pose X_WC, X_WT;
};

// A keyframe is safe on disk.
struct Stored {
  std::uint64_t index = 0;
  std::uint64_t missing = 0;  // frames of the plan that are not there yet
};

// Where the time of one keyframe went, its failed attempts included, in seconds.
struct Pace {
  double stage = 0.0;     // moves and homings, and readings of where the table stands
  double settling = 0.0;  // the rest between arrival and exposure
  double camera = 0.0;    // from trigger to picture
  double storing = 0.0;   // waiting for who takes the pictures: the disk, if it is slow
  double resting = 0.0;   // before repetitions
};

// What follows from the keyframes so far in a capture that goes on until the lights are known.
struct Verdict {
  enum class Kind : std::uint8_t {
    kGoOn,     // with what is planned
    kOneMore,  // at angle_deg, as keyframe number `keyframes`
    kEnd       // of the capture
  };
  Kind kind = Kind::kGoOn;
  std::uint64_t keyframes = 0;  // that it follows from: all those of a smaller index
  double angle_deg = 0.0;       // commanded
  std::string code, words;      // why; of kGoOn empty
};

struct LightNow {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit, in W
  double direction_sigma_deg = 0.0;
  double inverse_distance = 0.0;  // per length unit
  double inverse_distance_sigma = 0.0;
  double intensity = 1.0;  // the strongest light has 1
  double intensity_sigma = 0.0;
};

// The best so far.
struct Estimate {
  std::uint64_t version = 0;    // 1, 2, 3, ...
  std::uint64_t keyframes = 0;  // that went into it
  std::vector<LightNow> lights;
  double rms = 0.0;  // of white
};

}  // namespace turnlight::nodes

namespace turnlight::nodes::graph {

#define TURNLIGHT_WIRE(Type, Word, Version)               \
  template <>                                             \
  struct Wire<Type> {                                     \
    static constexpr std::string_view kName = Word;       \
    static constexpr std::uint32_t kVersion = Version;    \
    static void Encode(const Type& value, WireWriter& o); \
    static Type Decode(WireReader& in);                   \
  }

TURNLIGHT_WIRE(rig::TableState, "TableState", 1);
TURNLIGHT_WIRE(nodes::MoveGoal, "Move", 1);
TURNLIGHT_WIRE(nodes::MoveResult, "MoveResult", 1);
TURNLIGHT_WIRE(nodes::Frame, "Frame", 2);
TURNLIGHT_WIRE(nodes::ExposeGoal, "Expose", 1);
TURNLIGHT_WIRE(nodes::ExposureBegun, "ExposureBegun", 1);
TURNLIGHT_WIRE(nodes::ExposeResult, "ExposeResult", 2);
TURNLIGHT_WIRE(nodes::Bracket, "Bracket", 3);
TURNLIGHT_WIRE(nodes::Guidance, "Guidance", 1);
TURNLIGHT_WIRE(nodes::CameraModel, "CameraModel", 1);
TURNLIGHT_WIRE(nodes::Keyframe, "Keyframe", 3);
TURNLIGHT_WIRE(nodes::Stored, "Stored", 1);
TURNLIGHT_WIRE(nodes::Pace, "Pace", 1);
TURNLIGHT_WIRE(nodes::Verdict, "Verdict", 1);
TURNLIGHT_WIRE(nodes::Estimate, "Estimate", 1);
#undef TURNLIGHT_WIRE

}  // namespace turnlight::nodes::graph
