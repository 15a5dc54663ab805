#include "calib/calibrate/placement/view_of_picture.h"

#include <opencv2/imgproc.hpp>

#include "base/format.h"
#include "calib/calibrate/placement/outline.h"
#include "calib/calibrate/placement/segment.h"

namespace turnlight::calib::calibrate::placement {
namespace {

// Of a given mask's outline, the share that the picture has to show as edges.
constexpr double kClearShare = 0.5;
constexpr double kShadowWorthSaying = 0.02;

Status CheckSame(const cv::Mat& picture, const cv::Mat& other, const char* what,
                 const std::string& label) {
  if (other.empty() || (other.size() == picture.size() && other.type() == picture.type()))
    return {};
  return InputError(
      Format("%s: its picture is %d x %d with %d channels, %s is %d x %d with %d; "
             "allowed are pictures of one kind",
             label.c_str(), picture.cols, picture.rows, picture.channels(), what, other.cols,
             other.rows, other.channels()));
}

std::size_t ContourLength(const cv::Mat1b& mask) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::size_t length = 0;
  for (const auto& contour : contours) length += contour.size();
  return length;
}

void RemarkOnShadow(const Segmentation& found, bool colour, PictureView& seen) {
  if (found.shadow_share < kShadowWorthSaying) return;
  const double percent = 100.0 * found.shadow_share;
  if (found.shadow_removed)
    seen.remarks.push_back(
        Format("%s: %.0f %% of what differs from the empty table looks like a "
               "shadow and is left out",
               seen.view.label.c_str(), percent));
  else
    seen.remarks.push_back(Format(
        "%s: %.0f %% of what differs from the empty table is only darker%s; it may be a shadow and "
        "counts as target: a backlight, or masks, would tell",
        seen.view.label.c_str(), percent,
        colour ? "" : ", which a grey picture cannot tell apart"));
}

void FindTarget(const cv::Mat& picture, const cv::Mat& empty, PictureView& seen) {
  const auto found = empty.empty() ? SegmentBright(picture) : SegmentAgainstEmpty(picture, empty);
  if (!found) {
    seen.remarks.push_back(seen.view.label + ": left out, " + found.error().text);
    return;
  }
  seen.mask = found->mask;
  if (!empty.empty()) RemarkOnShadow(*found, picture.channels() == 3, seen);
  if (found->touches_border)
    seen.remarks.push_back(seen.view.label +
                           ": the target leaves the picture; what is inside of it "
                           "is used");
}

}  // namespace

Result<PictureView> ViewOfPicture(const Pictures& pictures, double angle_deg,
                                  const std::string& label) {
  Status status = CheckSame(pictures.lit, pictures.empty, "that of the empty table", label);
  if (status) status = CheckSame(pictures.lit, pictures.lamp_off, "the lamp-off one", label);
  if (!status) return Forward(status);
  cv::Mat picture = pictures.lit, empty = pictures.empty;
  if (!pictures.lamp_off.empty()) {
    picture = picture - pictures.lamp_off;
    if (!empty.empty()) empty = empty - pictures.lamp_off;
  }
  PictureView seen;
  seen.view.angle_deg = angle_deg;
  seen.view.label = label;
  if (pictures.mask.empty())
    FindTarget(picture, empty, seen);
  else
    seen.mask = pictures.mask;
  if (seen.mask.empty()) return seen;
  seen.view.outline = FindOutline(picture, empty, seen.mask);
  if (pictures.mask.empty()) return seen;
  const auto clear = static_cast<double>(seen.view.outline.size());
  seen.from_mask = clear < kClearShare * static_cast<double>(ContourLength(seen.mask));
  if (seen.from_mask) seen.view.outline = OutlineOfMask(seen.mask);
  return seen;
}

}  // namespace turnlight::calib::calibrate::placement
