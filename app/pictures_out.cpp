#include "app/pictures_out.h"

#include "estimator/pictures.h"
#include "rig/session/image_file.h"

namespace turnlight::app {

Result<std::size_t> WritePictures(const std::vector<estimator::Keyframe>& keyframes,
                                  const estimator::Geometry& geometry,
                                  const calib::CameraModel& camera,
                                  const estimator::EstimateOutput& output,
                                  const std::filesystem::path& out) {
  const auto pictures = estimator::MakePictures(keyframes, geometry, camera, output);
  for (const estimator::NamedPicture& picture : pictures)
    if (const Status status = rig::WriteImage(out / picture.name, picture.image); !status)
      return Forward(status);
  return pictures.size();
}

}  // namespace turnlight::app
