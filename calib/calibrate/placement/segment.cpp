#include "calib/calibrate/placement/segment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/format.h"
#include "base/statistics.h"

namespace turnlight::calib::calibrate::placement {
namespace {

constexpr double kSignificant = 6.0;        // sigma of the noise
constexpr double kLeastOfStrongest = 0.03;  // of what differs most: below, it is stray light
constexpr double kBackgroundSigma = 8.0;    // above a dark background
constexpr double kDarkBorder = 0.9;         // share of the border that has to be background
constexpr double kLeastArea = 30.0;         // pixels
// A shadow leaves between these shares of the light, the same in all channels within this.
constexpr double kDeepestShadow = 0.05, kLightestShadow = 0.97, kSameColour = 0.05;
// Shares of shadow that are removed: less does not matter, with more the target itself looks so.
constexpr double kSomeShadow = 0.01, kMostlyShadow = 0.6;

// The largest connected piece, its holes filled; empty if there is none of some size.
cv::Mat1b LargestPiece(const cv::Mat1b& pixels) {
  cv::Mat1b cleaned;
  cv::morphologyEx(pixels, cleaned, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  cv::morphologyEx(cleaned, cleaned, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(cleaned, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto largest = std::max_element(
      contours.begin(), contours.end(),
      [](const auto& a, const auto& b) { return cv::contourArea(a) < cv::contourArea(b); });
  if (largest == contours.end() || cv::contourArea(*largest) < kLeastArea) return {};
  cv::Mat1b mask(pixels.size(), uchar{0});
  cv::drawContours(mask, contours, static_cast<int>(largest - contours.begin()), cv::Scalar(255),
                   cv::FILLED);
  return mask;
}

bool TouchesBorder(const cv::Mat1b& mask) {
  return cv::countNonZero(mask.row(0)) + cv::countNonZero(mask.row(mask.rows - 1)) +
             cv::countNonZero(mask.col(0)) + cv::countNonZero(mask.col(mask.cols - 1)) >
         0;
}

std::vector<cv::Mat1f> Channels(const cv::Mat& picture) {
  std::vector<cv::Mat> parts;
  cv::split(picture, parts);
  return {parts.begin(), parts.end()};
}

double RobustSigma(const cv::Mat1f& values, double& middle) {
  std::vector<float> all(values.begin(), values.end());
  middle = Median(all);
  for (float& value : all) value = std::abs(value - static_cast<float>(middle));
  return Median(all) / kMedianOfNormal;
}

// 255 where all channels are darker than the empty table by the same factor.
cv::Mat1b LooksLikeShadow(const std::vector<cv::Mat1f>& picture,
                          const std::vector<cv::Mat1f>& empty, double noise) {
  cv::Mat1b shadow(picture[0].size(), uchar{0});
  for (int row = 0; row < shadow.rows; ++row)
    for (int column = 0; column < shadow.cols; ++column) {
      double least = INFINITY, most = 0.0, unsure = 0.0;
      for (std::size_t c = 0; c < picture.size(); ++c) {
        const double light = std::max(1e-12, double(empty[c](row, column)));
        const double left = picture[c](row, column) / light;
        least = std::min(least, left);
        most = std::max(most, left);
        unsure = std::max(unsure, noise / light);
      }
      if (least > kDeepestShadow && most < kLightestShadow &&
          most - least < kSameColour * most + 3.0 * unsure)
        shadow(row, column) = 255;
    }
  return shadow;
}

void RemoveShadow(const cv::Mat1b& differs, const std::vector<cv::Mat1f>& picture,
                  const std::vector<cv::Mat1f>& empty, Segmentation& found) {
  const cv::Mat1b shadow = LooksLikeShadow(picture, empty, found.noise) & differs & found.mask;
  const double area = cv::countNonZero(found.mask);
  found.shadow_share = cv::countNonZero(shadow) / area;
  if (picture.size() < 3 || found.shadow_share < kSomeShadow || found.shadow_share > kMostlyShadow)
    return;
  const cv::Mat1b rest = LargestPiece(differs & ~shadow);
  if (rest.empty()) return;
  found.mask = rest;
  found.shadow_removed = true;
}

}  // namespace

Result<Segmentation> SegmentAgainstEmpty(const cv::Mat& picture, const cv::Mat& empty) {
  if (picture.size() != empty.size() || picture.type() != empty.type())
    return InputError(Format(
        "the picture of the empty table is %d x %d with %d channels, allowed "
        "is the pictures' %d x %d with %d",
        empty.cols, empty.rows, empty.channels(), picture.cols, picture.rows, picture.channels()));
  const std::vector<cv::Mat1f> lit = Channels(picture), bare = Channels(empty);
  Segmentation found;
  cv::Mat1f strongest(picture.size(), 0.0f);
  for (std::size_t c = 0; c < lit.size(); ++c) {
    cv::Mat1f difference = lit[c] - bare[c];
    double middle = 0.0;
    found.noise = std::max(found.noise, RobustSigma(difference, middle));
    strongest = cv::max(strongest, cv::abs(difference));
  }
  std::vector<float> sizes(strongest.begin(), strongest.end());
  const double most = LowerQuantile(sizes, 0.995);
  found.threshold = std::max(kSignificant * found.noise, kLeastOfStrongest * most);
  if (!(most > found.threshold))
    return InputError("nothing in it differs from the picture of the empty table");
  const cv::Mat1b differs = strongest > found.threshold;
  found.mask = LargestPiece(differs);
  if (found.mask.empty())
    return InputError("nothing in it differs from the picture of the empty table");
  RemoveShadow(differs, lit, bare, found);
  found.touches_border = TouchesBorder(found.mask);
  return found;
}

Result<Segmentation> SegmentBright(const cv::Mat& picture) {
  cv::Mat1f light(picture.size(), 0.0f);
  for (const cv::Mat1f& channel : Channels(picture)) light = cv::max(light, channel);
  std::vector<float> values(light.begin(), light.end());
  const double top = LowerQuantile(values, 0.999);
  if (!(top > 0.0)) return InputError("it is all dark");
  cv::Mat1f roots;
  cv::sqrt(cv::min(cv::max(light / top, 0.0), 1.0), roots);
  cv::Mat1b bytes, bright;
  roots.convertTo(bytes, CV_8U, 255.0);
  const double split = cv::threshold(bytes, bright, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
  std::vector<float> dark;
  for (int i = 0; i < static_cast<int>(light.total()); ++i)
    if (!bright(i)) dark.push_back(light(i));
  const float background = Median(dark);
  float step = std::numeric_limits<float>::max();  // of the picture's values
  for (float& value : dark) {
    value = std::abs(value - background);
    if (value > 0.0f) step = std::min(step, value);
  }
  // Where most of the background has one value, its noise is about half of the step to the next.
  Segmentation found;
  found.noise = Median(dark) / kMedianOfNormal;
  if (found.noise == 0.0 && step < std::numeric_limits<float>::max()) found.noise = 0.5 * step;
  const double level = top * (split / 255.0) * (split / 255.0);
  found.threshold = background + std::max(kBackgroundSigma * found.noise,
                                          kLeastOfStrongest * (level - background));
  const cv::Mat1b target = light > found.threshold;
  const double border = 2.0 * (target.rows + target.cols);
  const double lit_border =
      cv::countNonZero(target.row(0)) + cv::countNonZero(target.row(target.rows - 1)) +
      cv::countNonZero(target.col(0)) + cv::countNonZero(target.col(target.cols - 1));
  if (lit_border > (1.0 - kDarkBorder) * border)
    return InputError(
        Format("its background is not dark (%.0f %% of the border is as bright as the "
               "target): give masks, or a picture of the empty table",
               100.0 * lit_border / border));
  found.mask = LargestPiece(target);
  if (found.mask.empty()) return InputError("it shows no bright target");
  found.touches_border = TouchesBorder(found.mask);
  return found;
}

}  // namespace turnlight::calib::calibrate::placement
