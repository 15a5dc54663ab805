// How likely a misfit is by chance.
#pragma once

namespace turnlight::calib::calibrate::drift {

// The probability that a chi-squared variable with so many degrees of freedom (at least 1) exceeds
// `value`. 1 if value is not positive.
double ChiSquareTail(double value, int freedom);

}  // namespace turnlight::calib::calibrate::drift
