// Which pixels show the target.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace turnlight::calib::calibrate::placement {

struct Segmentation {
  cv::Mat1b mask;          // 255 = target; one connected piece without holes
  double noise = 0.0;      // standard deviation of a pixel, in the picture's unit
  double threshold = 0.0;  // likewise
  // Of the pixels that differ from the empty table: those that are only darker, all channels alike,
  // as a shadow on the table is. Of grey pictures all that are darker.
  double shadow_share = 0.0;
  bool shadow_removed = false;  // from the mask; never of grey pictures
  bool touches_border = false;  // the target leaves the picture
};

// Pictures are linear radiance, CV_32FC1 or CV_32FC3, all of one size.
//
// What differs from a picture of the empty table by more than 6 sigma of the noise, which is that
// of the difference itself. A shadow of the target on the table is removed if the pictures have
// colour and most of what differs is no shadow. Fails (kInput): sizes differ, nothing differs.
Result<Segmentation> SegmentAgainstEmpty(const cv::Mat& picture, const cv::Mat& empty);

// A bright target before a dark background: Otsu's threshold finds the two, the background's own
// noise the limit. Fails (kInput) if the picture's border is not dark, or nothing is bright.
Result<Segmentation> SegmentBright(const cv::Mat& picture);

}  // namespace turnlight::calib::calibrate::placement
