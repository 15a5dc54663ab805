// The proofs without which no frame is published: each says what is wrong, or nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "nodes/messages.h"

namespace turnlight::nodes {

// The table stands at the commanded angle: idle, and no further off than the tolerance.
std::optional<std::string> StandsAt(const rig::TableState& state, double angle_deg,
                                    double tolerance_deg);

// The picture answers this trigger and no other, with the settings that were asked for. last_id: of
// the picture before, if one is known; ids may wrap, 65535 -> 1. Exposures may differ by a
// thousandth (devices round), gains by 0.05 dB.
std::optional<std::string> Answers(const Frame& frame, const rig::CameraSettings& asked,
                                   std::optional<std::uint64_t> last_id);

}  // namespace turnlight::nodes
