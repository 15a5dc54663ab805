#include "nodes/messages.h"

#include <span>

namespace turnlight::nodes::graph {
namespace {

using nodes::Bracket;
using nodes::Frame;
using nodes::Keyframe;

void PutTime(rig::DeviceTime time, WireWriter& out) { out.I64(time.count()); }
rig::DeviceTime GetTime(WireReader& in) { return rig::DeviceTime(in.I64()); }

void PutSettings(const rig::CameraSettings& settings, WireWriter& out) {
  out.F64(settings.exposure_us);
  out.F64(settings.gain_db);
}
rig::CameraSettings GetSettings(WireReader& in) {
  const double exposure_us = in.F64();
  return {exposure_us, in.F64()};
}

// Type, rows, columns, then the pixels row by row without gaps.
void PutImage(const cv::Mat& image, WireWriter& out) {
  const cv::Mat dense = image.isContinuous() ? image : image.clone();
  out.I64(dense.empty() ? -1 : dense.type());
  if (dense.empty()) return;
  out.U32(static_cast<std::uint32_t>(dense.rows));
  out.U32(static_cast<std::uint32_t>(dense.cols));
  out.Numbers(std::span<const std::uint8_t>(dense.data, dense.total() * dense.elemSize()));
}

cv::Mat GetImage(WireReader& in) {
  const std::int64_t type = in.I64();
  if (type == -1) return {};
  const bool known = type == CV_8UC1 || type == CV_8UC3 || type == CV_16UC1 || type == CV_16UC3 ||
                     type == CV_32FC1 || type == CV_32FC3;
  const std::uint32_t rows = in.U32();
  const std::uint32_t columns = in.U32();
  const auto bytes = in.Numbers<std::uint8_t>();
  const std::uint64_t pixel = known ? CV_ELEM_SIZE(static_cast<int>(type)) : 1;
  if (!known || rows == 0 || columns == 0 || rows > 65536 || columns > 65536 ||
      std::uint64_t{rows} * columns * pixel != bytes.size()) {
    in.Fail("a picture of type " + std::to_string(type) + ", " + std::to_string(columns) + " x " +
            std::to_string(rows) + " in " + std::to_string(bytes.size()) + " bytes");
    return {};
  }
  return cv::Mat(static_cast<int>(rows), static_cast<int>(columns), static_cast<int>(type),
                 const_cast<std::uint8_t*>(bytes.data()))
      .clone();
}

cv::Mat1b GetMask(WireReader& in) {
  const cv::Mat image = GetImage(in);
  if (image.empty()) return {};
  if (image.type() != CV_8UC1) {
    in.Fail("a mask of type " + std::to_string(image.type()));
    return {};
  }
  return image;
}

template <typename T, typename Put>
void PutList(const std::vector<T>& list, WireWriter& out, Put&& put) {
  out.U64(list.size());
  for (const T& element : list) put(element);
}

// Every element takes at least a byte: a count beyond what is left is refused before it is
// believed.
template <typename T, typename Get>
std::vector<T> GetList(WireReader& in, Get&& get) {
  const std::uint64_t count = in.U64();
  if (count > in.Left()) {
    in.Fail("a list of " + std::to_string(count));
    return {};
  }
  std::vector<T> list;
  for (std::uint64_t i = 0; i < count; ++i) list.push_back(get());
  return list;
}

void PutPose(const calib::Pose& pose, WireWriter& out) {
  out.Numbers(std::span<const double>(calib::RowsFromPose(pose)));
}
calib::Pose GetPose(WireReader& in) {
  const auto rows = in.Numbers<double>();
  if (rows.size() != 12) {
    in.Fail("a pose of " + std::to_string(rows.size()) + " numbers");
    return {};
  }
  const auto pose = calib::PoseFromRows(rows, "pose");
  if (pose) return *pose;
  in.Fail(pose.error().text);
  return {};
}

}  // namespace

void Wire<rig::TableState>::Encode(const rig::TableState& state, WireWriter& out) {
  PutTime(state.time, out);
  out.U8(static_cast<std::uint8_t>(state.motion));
  out.F64(state.angle_deg);
  out.Text(state.fault);
}
rig::TableState Wire<rig::TableState>::Decode(WireReader& in) {
  rig::TableState state;
  state.time = GetTime(in);
  const std::uint8_t motion = in.U8();
  if (motion > static_cast<std::uint8_t>(rig::TableMotion::kFault))
    in.Fail("a motion of " + std::to_string(motion));
  else
    state.motion = static_cast<rig::TableMotion>(motion);
  state.angle_deg = in.F64();
  state.fault = in.Text();
  return state;
}

void Wire<nodes::MoveGoal>::Encode(const nodes::MoveGoal& goal, WireWriter& out) {
  out.Numbers(std::span<const double>(goal.legs_deg));
  PutTime(goal.timeout, out);
}
nodes::MoveGoal Wire<nodes::MoveGoal>::Decode(WireReader& in) {
  nodes::MoveGoal goal;
  goal.legs_deg = in.Numbers<double>();
  goal.timeout = GetTime(in);
  return goal;
}

void Wire<nodes::MoveResult>::Encode(const nodes::MoveResult& result, WireWriter& out) {
  out.Bool(result.arrived);
  out.F64(result.angle_deg);
  out.Text(result.text);
}
nodes::MoveResult Wire<nodes::MoveResult>::Decode(WireReader& in) {
  nodes::MoveResult result;
  result.arrived = in.Bool();
  result.angle_deg = in.F64();
  result.text = in.Text();
  return result;
}

void Wire<Frame>::Encode(const Frame& frame, WireWriter& out) {
  PutImage(frame.image, out);
  out.U64(frame.frame_id);
  out.U64(frame.trigger);
  out.U64(frame.asked_trigger);
  PutTime(frame.triggered_at, out);
  PutTime(frame.exposure_begin, out);
  PutTime(frame.exposure_end, out);
  PutSettings(frame.actual, out);
  out.Bool(frame.complete);
  out.I64(frame.drained);
  PutList(frame.readings, out, [&](const rig::DeviceReading& reading) {
    out.Text(reading.name);
    out.F64(reading.value);
  });
}
Frame Wire<Frame>::Decode(WireReader& in) {
  Frame frame;
  frame.image = GetImage(in);
  frame.frame_id = in.U64();
  frame.trigger = in.U64();
  frame.asked_trigger = in.U64();
  frame.triggered_at = GetTime(in);
  frame.exposure_begin = GetTime(in);
  frame.exposure_end = GetTime(in);
  frame.actual = GetSettings(in);
  frame.complete = in.Bool();
  frame.drained = in.I64();
  frame.readings = GetList<rig::DeviceReading>(in, [&] {
    std::string name = in.Text();
    return rig::DeviceReading{std::move(name), in.F64()};
  });
  return frame;
}

void Wire<nodes::ExposeGoal>::Encode(const nodes::ExposeGoal& goal, WireWriter& out) {
  PutSettings(goal.settings, out);
  PutTime(goal.timeout, out);
}
nodes::ExposeGoal Wire<nodes::ExposeGoal>::Decode(WireReader& in) {
  const rig::CameraSettings settings = GetSettings(in);
  return {settings, GetTime(in)};
}

void Wire<nodes::ExposureBegun>::Encode(const nodes::ExposureBegun& begun, WireWriter& out) {
  out.U64(begun.trigger);
  PutTime(begun.at, out);
}
nodes::ExposureBegun Wire<nodes::ExposureBegun>::Decode(WireReader& in) {
  const std::uint64_t trigger = in.U64();
  return {trigger, GetTime(in)};
}

void Wire<nodes::ExposeResult>::Encode(const nodes::ExposeResult& result, WireWriter& out) {
  out.Bool(result.frame.has_value());
  if (result.frame) Wire<Frame>::Encode(*result.frame, out);
  out.Text(result.text);
}
nodes::ExposeResult Wire<nodes::ExposeResult>::Decode(WireReader& in) {
  nodes::ExposeResult result;
  if (in.Bool()) result.frame = Wire<Frame>::Decode(in);
  result.text = in.Text();
  return result;
}

void Wire<Bracket>::Encode(const Bracket& bracket, WireWriter& out) {
  out.U64(bracket.index);
  out.Bool(bracket.closure);
  out.F64(bracket.angle_deg);
  out.F64(bracket.angle_measured_deg);
  PutList(bracket.exposures, out, [&](const Frame& frame) { Wire<Frame>::Encode(frame, out); });
  out.Text(bracket.utc);
  out.I64(bracket.attempts);
  PutList(bracket.rejected, out, [&](const std::string& text) { out.Text(text); });
  out.Bool(bracket.placed.has_value());
  if (!bracket.placed) return;
  PutPose(bracket.placed->X_WC, out);
  PutPose(bracket.placed->X_WT, out);
}
Bracket Wire<Bracket>::Decode(WireReader& in) {
  Bracket bracket;
  bracket.index = in.U64();
  bracket.closure = in.Bool();
  bracket.angle_deg = in.F64();
  bracket.angle_measured_deg = in.F64();
  bracket.exposures = GetList<Frame>(in, [&] { return Wire<Frame>::Decode(in); });
  bracket.utc = in.Text();
  bracket.attempts = static_cast<std::int32_t>(in.I64());
  bracket.rejected = GetList<std::string>(in, [&] { return in.Text(); });
  if (!in.Bool()) return bracket;
  const calib::Pose X_WC = GetPose(in);
  bracket.placed = calib::RigPoses{X_WC, GetPose(in)};
  return bracket;
}

void Wire<nodes::Guidance>::Encode(const nodes::Guidance& guidance, WireWriter& out) {
  out.Text(guidance.text);
  out.U64(guidance.done);
  out.U64(guidance.total);
}
nodes::Guidance Wire<nodes::Guidance>::Decode(WireReader& in) {
  nodes::Guidance guidance;
  guidance.text = in.Text();
  guidance.done = in.U64();
  guidance.total = in.U64();
  return guidance;
}

void Wire<nodes::CameraModel>::Encode(const nodes::CameraModel& model, WireWriter& out) {
  out.Text(model.text);
  out.Text(model.sha256);
}
nodes::CameraModel Wire<nodes::CameraModel>::Decode(WireReader& in) {
  nodes::CameraModel model;
  model.text = in.Text();
  model.sha256 = in.Text();
  return model;
}

void Wire<Keyframe>::Encode(const Keyframe& keyframe, WireWriter& out) {
  Wire<Bracket>::Encode(keyframe.bracket, out);
  out.Text(keyframe.camera_sha256);
  PutImage(keyframe.image, out);
  PutImage(keyframe.validity, out);
  out.Bool(keyframe.exposure.exposure_us.has_value());
  out.F64(keyframe.exposure.exposure_us.value_or(0.0));
  out.F64(keyframe.exposure.gain_db);
  PutImage(keyframe.linear.radiance, out);
  PutImage(keyframe.linear.saturated, out);
  PutPose(keyframe.X_WC, out);
  PutPose(keyframe.X_WT, out);
  if (!keyframe.linear.variance.empty()) PutImage(keyframe.linear.variance, out);
}
Keyframe Wire<Keyframe>::Decode(WireReader& in) {
  Keyframe keyframe;
  keyframe.bracket = Wire<Bracket>::Decode(in);
  keyframe.camera_sha256 = in.Text();
  keyframe.image = GetImage(in);
  keyframe.validity = GetMask(in);
  const bool has_exposure = in.Bool();
  const double exposure_us = in.F64();
  if (has_exposure) keyframe.exposure.exposure_us = exposure_us;
  keyframe.exposure.gain_db = in.F64();
  keyframe.linear.radiance = GetImage(in);
  keyframe.linear.saturated = GetMask(in);
  keyframe.X_WC = GetPose(in);
  keyframe.X_WT = GetPose(in);
  if (in.Left() > 0) {  // a rig whose noise is known
    const cv::Mat variance = GetImage(in);
    if (variance.type() == CV_32FC1)
      keyframe.linear.variance = variance;
    else
      in.Fail("a variance that is no picture of floats");
  }
  return keyframe;
}

void Wire<nodes::Pace>::Encode(const nodes::Pace& pace, WireWriter& out) {
  for (const double part : {pace.stage, pace.settling, pace.camera, pace.storing, pace.resting})
    out.F64(part);
}
nodes::Pace Wire<nodes::Pace>::Decode(WireReader& in) {
  nodes::Pace pace;
  for (double* part : {&pace.stage, &pace.settling, &pace.camera, &pace.storing, &pace.resting})
    *part = in.F64();
  return pace;
}

void Wire<nodes::Stored>::Encode(const nodes::Stored& stored, WireWriter& out) {
  out.U64(stored.index);
  out.U64(stored.missing);
}
nodes::Stored Wire<nodes::Stored>::Decode(WireReader& in) {
  const std::uint64_t index = in.U64();
  return {index, in.U64()};
}

void Wire<nodes::Verdict>::Encode(const nodes::Verdict& verdict, WireWriter& out) {
  out.U8(static_cast<std::uint8_t>(verdict.kind));
  out.U64(verdict.keyframes);
  out.F64(verdict.angle_deg);
  out.Text(verdict.code);
  out.Text(verdict.words);
}
nodes::Verdict Wire<nodes::Verdict>::Decode(WireReader& in) {
  nodes::Verdict verdict;
  const std::uint8_t kind = in.U8();
  if (kind > static_cast<std::uint8_t>(nodes::Verdict::Kind::kEnd))
    in.Fail("a verdict of kind " + std::to_string(kind));
  verdict.kind = static_cast<nodes::Verdict::Kind>(kind);
  verdict.keyframes = in.U64();
  verdict.angle_deg = in.F64();
  verdict.code = in.Text();
  verdict.words = in.Text();
  return verdict;
}

void Wire<nodes::Estimate>::Encode(const nodes::Estimate& estimate, WireWriter& out) {
  out.U64(estimate.version);
  out.U64(estimate.keyframes);
  PutList(estimate.lights, out, [&](const nodes::LightNow& light) {
    for (int i = 0; i < 3; ++i) out.F64(light.direction[i]);
    out.F64(light.direction_sigma_deg);
    out.F64(light.inverse_distance);
    out.F64(light.inverse_distance_sigma);
    out.F64(light.intensity);
    out.F64(light.intensity_sigma);
  });
  out.F64(estimate.rms);
}
nodes::Estimate Wire<nodes::Estimate>::Decode(WireReader& in) {
  nodes::Estimate estimate;
  estimate.version = in.U64();
  estimate.keyframes = in.U64();
  estimate.lights = GetList<nodes::LightNow>(in, [&] {
    nodes::LightNow light;
    for (int i = 0; i < 3; ++i) light.direction[i] = in.F64();
    light.direction_sigma_deg = in.F64();
    light.inverse_distance = in.F64();
    light.inverse_distance_sigma = in.F64();
    light.intensity = in.F64();
    light.intensity_sigma = in.F64();
    return light;
  });
  estimate.rms = in.F64();
  return estimate;
}

}  // namespace turnlight::nodes::graph
