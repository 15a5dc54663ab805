// lights.json: what the ball says, with result.json's names for what both know. README.md of this
// folder has the format.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/calibrate/probe/lights.h"
#include "calib/calibrate/probe/probe_session.h"

namespace turnlight::calib::calibrate::probe {

inline constexpr char kLightsFile[] = "lights.json";
inline constexpr char kLightsFormat[] = "turnlight-lights";

// Of the sessions, in order, as they were joined.
std::string LightsJson(const ProbeLights& found, const std::vector<ProbeSession>& sessions,
                       double radius_sigma);

// Which frame of which session a view of the joined ones is.
struct FrameOfView {
  std::size_t session = 0;
  std::size_t frame = 0;
};
FrameOfView FindFrame(const std::vector<ProbeSession>& sessions, std::size_t view);

// "1: azimuth 30.00 deg, zenith 40.00 deg, +- 0.02 deg, 812 +- 5 mm away, ..." for people.
std::string LightText(const ProbeLight& light, std::size_t number, const std::string& length_unit);
std::string CandidateText(const ProbeCandidate& candidate);

}  // namespace turnlight::calib::calibrate::probe
