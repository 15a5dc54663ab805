#include "app/pictures_out.h"

#include "estimator/pictures/pictures.h"
#include "rig/session/image_file.h"

namespace turnlight::app {

Result<std::size_t> WritePictures(const estimator::model::KeyframeSource& keyframes,
                                  const estimator::target::Geometry& geometry,
                                  const calib::CameraModel& camera,
                                  const estimator::EstimateOutput& output,
                                  const std::filesystem::path& out) {
  const auto pictures = estimator::pictures::MakePictures(keyframes, geometry, camera, output);
  if (!pictures) return Forward(pictures);
  for (const estimator::pictures::NamedPicture& picture : *pictures)
    if (const Status status = rig::WriteImage(out / picture.name, picture.image); !status)
      return Forward(status);
  return pictures->size();
}

}  // namespace turnlight::app
