#include "app/calibrate/turning_pictures.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "rig/session/raw_capture.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;

// Green of a colour picture; floats as 16 bits from 0 to white.
cv::Mat GreyOf(const cv::Mat& picture, double white) {
  cv::Mat grey = picture;
  if (picture.channels() == 3) cv::extractChannel(picture, grey, 1);
  if (grey.depth() == CV_32F) grey.convertTo(grey, CV_16U, 65535.0 / white);
  return grey;
}

template <typename Frame>
Status AddAngle(const Frame& frame, const std::string& where, TurningPictures& pictures) {
  if (!frame.angle_deg && !frame.angle_measured_deg)
    return InputError(where +
                      ": neither angle_measured_deg nor angle_deg, allowed are frames "
                      "with the angle of the table");
  pictures.angles_deg.push_back(frame.angle_measured_deg ? *frame.angle_measured_deg
                                                         : *frame.angle_deg);
  return {};
}

Result<TurningPictures> OfCapture(const fs::path& path, const std::string& kind) {
  auto read = rig::ReadRawCapture(path);
  if (!read) return Forward(read);
  const auto capture = std::make_shared<const rig::RawCapture>(std::move(*read));
  std::vector<std::size_t> frames = rig::FramesOfKind(*capture, kind);
  if (frames.empty())
    for (std::size_t i = 0; i < capture->frames.size(); ++i)
      if (!capture->frames[i].kind) frames.push_back(i);
  if (frames.empty())
    return InputError(path.string() + ": no frame of the kind \"" + kind +
                      "\", allowed is a capture with --kind " + kind);
  TurningPictures pictures;
  for (const std::size_t i : frames)
    if (const Status status =
            AddAngle(capture->frames[i], path.string() + ": frames/" + std::to_string(i), pictures);
        !status)
      return Forward(status);
  pictures.size = capture->devices.resolution;
  pictures.radiometry = capture->radiometry;
  pictures.devices = capture->devices;
  pictures.picture = [capture, frames](std::size_t i) -> Result<cv::Mat> {
    auto image = rig::ReadRawImage(*capture, frames[i]);
    if (!image) return Forward(image);
    return GreyOf(*image, capture->radiometry.white);
  };
  return pictures;
}

Result<TurningPictures> OfSession(const fs::path& path) {
  auto read = rig::ReadSession(path);
  if (!read) return Forward(read);
  const auto session = std::make_shared<const rig::Session>(std::move(*read));
  TurningPictures pictures;
  for (std::size_t i = 0; i < session->frames.size(); ++i)
    if (const Status status =
            AddAngle(session->frames[i], path.string() + ": frames/" + std::to_string(i), pictures);
        !status)
      return Forward(status);
  pictures.size = {session->camera->width(), session->camera->height()};
  pictures.radiometry = session->radiometry;
  pictures.picture = [session](std::size_t i) -> Result<cv::Mat> {
    auto images = rig::ReadFrameImages(*session, i);
    if (!images) return Forward(images);
    return GreyOf(images->image, session->radiometry.white);
  };
  return pictures;
}

}  // namespace

Result<TurningPictures> ReadTurningPictures(const fs::path& path, const std::string& kind) {
  return rig::IsRawCapture(path) ? OfCapture(path, kind) : OfSession(path);
}

}  // namespace turnlight::app
