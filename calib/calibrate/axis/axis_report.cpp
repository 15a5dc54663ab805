#include "calib/calibrate/axis/axis_report.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace turnlight::calib::calibrate::axis {
namespace {

// What a good rig reaches: light directions are asked for to 0.2 degrees.
constexpr double kGoodDirectionDeg = 0.02;
constexpr double kGoodOffset = 2e-4;  // of the camera's distance: 0.1 mm of 500
constexpr double kGoodTurnDeg = 0.1;  // a turn, by the scale
constexpr double kPoorCornersPx = 1.0;
constexpr double kPoorAnglesDeg = 0.2;
constexpr double kScaleOfNote = 0.01;

std::string ScaleText(const AxisCalibration& axis) {
  std::string text =
      Format("angle scale   %.6f +- %.6f: a reported turn is %.3f +- %.3f deg\n", axis.angle_scale,
             axis.scale_sigma, 360.0 * axis.angle_scale, 360.0 * axis.scale_sigma);
  if (axis.angle_scale < 0.0)
    text +=
        "              negative: the table counts clockwise seen from above (from +z). It is "
        "written so, and a capture takes it into account\n";
  if (std::abs(std::abs(axis.angle_scale) - 1.0) > kScaleOfNote)
    text += "              far from 1: are the table's steps per degree set right?\n";
  return text;
}

std::string BacklashText(const AxisCalibration& axis) {
  if (!axis.backlash)
    return "backlash      not determined: all views were reached from one side, as far as is "
           "known\n";
  return Format("backlash      %.4f +- %.4f deg between rising and falling angles%s\n",
                axis.backlash->deg, axis.backlash->sigma_deg,
                std::abs(axis.backlash->deg) < 3.0 * axis.backlash->sigma_deg
                    ? ": none that shows"
                    : "; come to each angle from one side");
}

std::string ClosureText(const AxisCalibration& axis, const std::vector<AxisView>& views,
                        const std::string& unit) {
  std::string text;
  for (const Closure& closure : axis.closures)
    text += Format("closure       %s against %s: turned %.4f +- %.4f deg, middle moved %.3f %s\n",
                   ViewLabel(closure.last, views[closure.last].angle_deg).c_str(),
                   ViewLabel(closure.first, views[closure.first].angle_deg).c_str(),
                   closure.turned_deg, closure.turned_sigma_deg, closure.shift, unit.c_str());
  return text.empty() ? "closure       no view is a whole turn away from the first\n" : text;
}

std::string ViewsText(const AxisCalibration& axis, const std::vector<AxisView>& views) {
  std::size_t points = 0, outliers = 0;
  std::string left_out;
  for (const FittedView& view : axis.views) {
    if (view.used) {
      points += view.points;
      outliers += view.outliers;
    } else {
      left_out += "  left out    " + ViewLabel(view.view, views[view.view].angle_deg) + ": " +
                  view.why_not + "\n";
    }
  }
  return Format("views         %zu of %zu used, over %.0f deg; %zu points, %zu of them left out\n",
                axis.used, axis.views.size(), axis.arc_deg, points, outliers) +
         left_out;
}

std::string NumberingText(const AxisCalibration& axis) {
  const bool several = std::any_of(axis.views.begin(), axis.views.end(), [](const auto& view) {
    return view.used && view.numbering != 0;
  });
  return several ? "              the board looks the same from several sides: its corners were "
                   "numbered by the angles\n"
                 : "";
}

}  // namespace

std::string AxisVerdict(const AxisCalibration& axis, const std::string& length_unit) {
  const double distance = axis.origin_C.norm();
  std::vector<std::string> weak;
  if (axis.direction_sigma_deg > kGoodDirectionDeg) weak.push_back("its direction");
  if (axis.offset_sigma > kGoodOffset * distance) weak.push_back("where it is");
  if (360.0 * axis.scale_sigma > kGoodTurnDeg) weak.push_back("the angle scale");
  std::string verdict = Format("the axis is known to %.2g deg and %.2g %s",
                               axis.direction_sigma_deg, axis.offset_sigma, length_unit.c_str());
  if (weak.empty())
    verdict += ": good";
  else
    verdict += "; weak is " + Listed(weak) +
               (axis.arc_deg < 180.0 ? ": take views over more of a turn"
                                     : ": take more views, or a larger board");
  if (axis.corner_sigma_px > kPoorCornersPx)
    verdict += "; the corners are " + NumberText(axis.corner_sigma_px, 2) +
               " px off: is it this lens and this board, did anything move?";
  if (axis.angle_sigma_deg > kPoorAnglesDeg)
    verdict += "; the table stands " + NumberText(axis.angle_sigma_deg, 2) +
               " deg away from the angles that it reports";
  return verdict;
}

std::string AxisText(const AxisCalibration& axis, const std::vector<AxisView>& views,
                     const std::string& length_unit) {
  const char* unit = length_unit.c_str();
  const Eigen::Vector3d p_WC = axis.X_WC.translation;
  return ViewsText(axis, views) + NumberingText(axis) +
         Format("axis          direction +- %.4f deg, offset +- %.4f %s, as the camera sees it\n",
                axis.direction_sigma_deg, axis.offset_sigma, unit) +
         Format("camera        %.3f %s from the axis, %.3f %s above W's origin, which is %s\n",
                std::hypot(p_WC.x(), p_WC.y()), unit, p_WC.z(), unit,
                axis.board_lies
                    ? "where the axis meets the board's plane, or as far above as asked"
                    : "on the axis beside the board's middle, or as far above as asked") +
         ScaleText(axis) + BacklashText(axis) + ClosureText(axis, views, length_unit) +
         Format("noise         corners %.3f px, angles %.4f deg\n", axis.corner_sigma_px,
                axis.angle_sigma_deg) +
         "verdict       " + AxisVerdict(axis, length_unit) + "\n";
}

}  // namespace turnlight::calib::calibrate::axis
