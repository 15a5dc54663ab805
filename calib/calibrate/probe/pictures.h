// What a probe is judged by with the eye. Pages, R, G, B.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/calibrate/probe/lights.h"
#include "calib/calibrate/probe/probe_session.h"

namespace turnlight::calib::calibrate::probe {

// The ball in a view of the joined sessions, with each light's spot as a numbered ring and a cross
// where the light is predicted; candidates have a ring without a number. Below: how far spots and
// predictions are apart.
cv::Mat3b SpotsPicture(const std::vector<ProbeSession>& sessions, std::size_t view,
                       const ProbeLights& found);

// What the balls reflect, by direction, over all views: the mean, as the root of the share of
// white; with the lights.
cv::Mat3b SkyPicture(const std::vector<ProbeSession>& sessions, const ProbeLights& found,
                     const std::string& length_unit);

// Views that are drawn: up to `most`, evenly spread.
std::vector<std::size_t> ViewsToDraw(std::size_t views, std::size_t most);

}  // namespace turnlight::calib::calibrate::probe
