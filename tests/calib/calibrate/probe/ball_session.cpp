#include "tests/calib/calibrate/probe/ball_session.h"

#include <gtest/gtest.h>

#include "base/format.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"

namespace turnlight::calib::calibrate::probe {

void WriteBallSession(const BallPictures& pictures, bool masks, const Eigen::Vector3d& off,
                      const std::filesystem::path& folder) {
  const BallStudio studio(pictures);
  rig::Session session;
  session.name = "ball";
  session.length_unit = "mm";
  session.camera_path = "camera.cameramodel";
  session.radiometry.white = 65535.0;
  session.target = SphereShape{pictures.ball.radius};
  session.camera = studio.camera;
  std::filesystem::create_directories(folder / "frames");
  for (std::size_t i = 0; i < studio.views.size(); ++i) {
    const BallView& view = studio.views[i];
    rig::FrameRecord frame;
    frame.image = Format("frames/%03zu.png", i);
    frame.angle_deg = pictures.arc_deg * static_cast<double>(i) / pictures.views;
    frame.X_WC = view.X_WC;
    frame.X_WT.translation = pictures.ball.center + off;
    const LinearImage picture = TakePicture(pictures, studio, i);
    const cv::Mat image = Encode(picture.radiance, session.radiometry, {}, CV_16U);
    ASSERT_TRUE(rig::WriteImage(folder / frame.image, image));
    if (masks) {
      cv::Mat1b mask(image.size(), uchar{0});
      for (int row = 0; row < mask.rows; ++row)
        for (int column = 0; column < mask.cols; ++column)
          if (MirrorAt(view, Eigen::Vector2d(column, row))) mask(row, column) = 255;
      frame.mask = Format("frames/%03zu.mask.png", i);
      ASSERT_TRUE(rig::WriteImage(folder / *frame.mask, mask));
    }
    session.frames.push_back(frame);
  }
  const auto written = rig::WriteSession(session, folder);
  ASSERT_TRUE(written) << written.error().text;
}

}  // namespace turnlight::calib::calibrate::probe
