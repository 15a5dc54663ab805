#include "tests/calib/calibrate/probe/ball_pictures.h"

#include <algorithm>
#include <cmath>

#include "base/angles.h"
#include "base/random.h"
#include "calib/rig_geometry.h"

namespace turnlight::calib::calibrate::probe {

BallStudio::BallStudio(const BallPictures& pictures)
    : camera(CameraModel::Pinhole(pictures.width, pictures.height, pictures.focal, pictures.focal,
                                  0.5 * (pictures.width - 1), 0.5 * (pictures.height - 1))),
      rays(camera) {
  for (int i = 0; i < pictures.views; ++i)
    views.push_back({&camera,
                     &rays,
                     LookAtOrigin(DegToRad(pictures.arc_deg * i / pictures.views),
                                  DegToRad(pictures.elevation_deg), pictures.camera_distance),
                     {pictures.ball.center, pictures.ball.radius}});
}

std::vector<cv::Mat1f> RenderAll(const BallPictures& pictures, const BallStudio& studio) {
  std::vector<cv::Mat1f> all;
  for (const BallView& view : studio.views)
    all.push_back(rig::sim::RenderMirrorBall(pictures.ball, pictures.room, studio.rays, view.X_WC,
                                             pictures.blur_px));
  return all;
}

LinearImage WithNoise(const BallPictures& pictures, const cv::Mat1f& radiance, std::size_t view) {
  const RandomStream random(pictures.seed, view);
  cv::Mat1f noisy = radiance.clone();
  cv::Mat1b clipped(noisy.size(), uchar{0});
  std::uint64_t index = 0;
  for (int row = 0; row < noisy.rows; ++row) {
    for (int column = 0; column < noisy.cols; ++column) {
      float& value = noisy(row, column);
      value += static_cast<float>(pictures.noise * random.Normal(index++));
      if (value < pictures.white) continue;
      value = static_cast<float>(pictures.white);
      clipped(row, column) = 255;
    }
  }
  return {noisy, clipped, {}};
}

LinearImage TakePicture(const BallPictures& pictures, const BallStudio& studio, std::size_t view) {
  return WithNoise(pictures,
                   rig::sim::RenderMirrorBall(pictures.ball, pictures.room, studio.rays,
                                              studio.views[view].X_WC, pictures.blur_px),
                   view);
}

}  // namespace turnlight::calib::calibrate::probe
