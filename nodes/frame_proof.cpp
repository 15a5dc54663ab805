#include "nodes/frame_proof.h"

#include <cmath>

#include "base/format.h"

namespace turnlight::nodes {
namespace {

// Whether id comes after last by at most half the ids, counting 65535 -> 1.
bool Advances(std::uint64_t id, std::uint64_t last) {
  if (id > last) return true;
  constexpr std::uint64_t kIds = 65535;
  return last <= kIds && id >= 1 && id + kIds - last < kIds / 2;
}

}  // namespace

std::optional<std::string> StandsAt(const rig::TableState& state, double angle_deg,
                                    double tolerance_deg) {
  switch (state.motion) {
    case rig::TableMotion::kMoving:
      return Format("the table moves, at %.6g deg", state.angle_deg);
    case rig::TableMotion::kUnhomed:
      return "the table does not know its position: " + state.fault;
    case rig::TableMotion::kFault:
      return "the table reports a fault: " + state.fault;
    case rig::TableMotion::kIdle:
      break;
  }
  if (std::abs(state.angle_deg - angle_deg) <= tolerance_deg) return std::nullopt;
  return Format("the table stands at %.6g deg, allowed is %.6g deg to within %.6g", state.angle_deg,
                angle_deg, tolerance_deg);
}

std::optional<std::string> Answers(const Frame& frame, const rig::CameraSettings& asked,
                                   std::optional<std::uint64_t> last_id) {
  if (!frame.complete) return "the picture is not complete, data were lost on the way";
  if (frame.image.empty()) return "the picture is empty";
  if (frame.trigger != 0 && frame.trigger != frame.asked_trigger)
    return Format("the picture answers trigger %llu, asked was %llu",
                  static_cast<unsigned long long>(frame.trigger),
                  static_cast<unsigned long long>(frame.asked_trigger));
  if (frame.exposure_begin < frame.triggered_at)
    return Format("stale picture: its exposure began %.6g ms before the trigger",
                  graph::ToMs(frame.triggered_at - frame.exposure_begin));
  if (frame.exposure_end <= frame.exposure_begin) return "the exposure ends before it begins";
  if (last_id && !Advances(frame.frame_id, *last_id))
    return Format("the picture's id is %llu, the one before had %llu",
                  static_cast<unsigned long long>(frame.frame_id),
                  static_cast<unsigned long long>(*last_id));
  if (!(std::abs(frame.actual.exposure_us - asked.exposure_us) <= 1e-3 * asked.exposure_us))
    return Format("exposed for %.6g us, asked were %.6g us", frame.actual.exposure_us,
                  asked.exposure_us);
  if (!(std::abs(frame.actual.gain_db - asked.gain_db) <= 0.05))
    return Format("taken with a gain of %.6g dB, asked were %.6g dB", frame.actual.gain_db,
                  asked.gain_db);
  return std::nullopt;
}

}  // namespace turnlight::nodes
