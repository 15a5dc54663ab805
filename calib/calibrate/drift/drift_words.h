// A check of a calibration for people: words and a picture.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calib/calibrate/drift/drift.h"

namespace turnlight::calib::calibrate::drift {

// "still true", "drifted", "cannot tell"
std::string VerdictWord(Verdict verdict);

// Lines, each ended: what was seen, pixels, what each cause alone would be, the verdict, what to
// do.
std::string DriftText(const DriftReport& report);
// One sentence or two: what drifted, by how much, in how many sigmas.
std::string DriftVerdict(const DriftReport& report);
// Which commands find anew what is no longer true; none if nothing is to be done.
std::vector<std::string> Remedies(const DriftReport& report);

// Where each point is against where it should be, as arrows over the picture's area: with the
// stored calibration, and with what was found.
cv::Mat3b DrawDrift(const DriftReport& report, const cv::Size& picture);

}  // namespace turnlight::calib::calibrate::drift
