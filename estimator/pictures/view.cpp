#include "estimator/pictures/view.h"

#include <opencv2/imgproc.hpp>

namespace turnlight::estimator::pictures {

namespace {

// Where the photograph shows nothing of the target.
cv::Mat1b PureBackground(const cv::Mat1f& coverage, const cv::Mat1b& mask) {
  cv::Mat1b pure = coverage == 0.0f;
  if (mask.empty() || cv::countNonZero(mask) == static_cast<int>(mask.total())) return pure;
  cv::Mat1b outline, marked;
  cv::dilate(coverage > 0.0f, outline, cv::Mat1b(7, 7, uchar{1}));
  // The pixel beyond the mask still holds some of the target.
  cv::dilate(mask != 0, marked, cv::Mat1b(3, 3, uchar{1}));
  pure.setTo(0, outline & marked);
  return pure;
}

}  // namespace

Matte TakeApart(const cv::Mat3f& picture, const cv::Mat1f& coverage, const cv::Mat1b& mask) {
  Matte matte{cv::Mat3f(picture.size(), cv::Vec3f()), cv::Mat3f(picture.size(), cv::Vec3f()),
              coverage};
  const cv::Mat1b pure = PureBackground(coverage, mask);
  cv::Mat1f weight(picture.size(), 0.0f);
  cv::Mat3f weighted(picture.size(), cv::Vec3f());
  weight.setTo(1.0f, pure);
  picture.copyTo(weighted, pure);
  cv::GaussianBlur(weight, weight, {9, 9}, 1.5, 1.5, cv::BORDER_CONSTANT);
  cv::GaussianBlur(weighted, weighted, {9, 9}, 1.5, 1.5, cv::BORDER_CONSTANT);
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const cv::Vec3f& pixel = picture(row, column);
      const float share = coverage(row, column);
      const float nearby = weight(row, column);
      if (share < 1.0f)
        matte.background(row, column) =
            pure(row, column) != 0 || nearby == 0.0f ? pixel : weighted(row, column) / nearby;
      if (share > 0.0f)
        matte.target(row, column) =
            (pixel - (1.0f - share) * matte.background(row, column)) / share;
    }
  }
  return matte;
}

cv::Mat3f Relit(const Matte& matte, const cv::Mat3f& modelled) {
  cv::Mat3f relit(modelled.size());
  for (int row = 0; row < relit.rows; ++row)
    for (int column = 0; column < relit.cols; ++column)
      relit(row, column) = modelled(row, column) +
                           (1.0f - matte.coverage(row, column)) * matte.background(row, column);
  return relit;
}

}  // namespace turnlight::estimator::pictures
