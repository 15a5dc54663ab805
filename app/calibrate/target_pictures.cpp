#include "app/calibrate/target_pictures.h"

#include <cmath>
#include <memory>
#include <utility>

#include "base/format.h"
#include "rig/session/image_file.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace placement = calib::calibrate::placement;

constexpr double kSameAngleDeg = 0.5;

Status CheckCount(const std::vector<std::string>& files, const char* option, std::size_t frames) {
  if (files.size() <= 1 || files.size() == frames) return {};
  return InputError(Format("%s: %zu pictures, allowed are one, or one for each of the %zu frames",
                           option, files.size(), frames));
}

Status CheckCompanions(const CompanionFiles& companions, std::size_t frames) {
  const Status status = CheckCount(companions.empty, "--empty", frames);
  return status ? CheckCount(companions.lamp_off, "--lamp-off", frames) : status;
}

Status CheckSize(const rig::RigCalibration& calibration, cv::Size taken, const char* whose) {
  const cv::Size known = calibration.devices.resolution;
  if (taken == known) return {};
  return InputError(Format(
      "%s: identity/camera/resolution: %d x %d, the %s's pictures are %d x %d; allowed is a "
      "calibration of pictures like these",
      calibration.source.c_str(), known.width, known.height, whose, taken.width, taken.height));
}

// The companion of a frame from files, taken with the frame's exposure; empty if there are none.
Result<cv::Mat> FromFiles(const std::vector<std::string>& files, std::size_t frame, cv::Size size,
                          const calib::Radiometry& radiometry, const calib::Exposure& exposure) {
  if (files.empty()) return cv::Mat();
  const auto image = rig::ReadImage(files.size() == 1 ? files[0] : files[frame], size);
  if (!image) return Forward(image);
  return calib::Linearise(*image, radiometry, files.size() == 1 ? calib::Exposure{} : exposure)
      .radiance;
}

Status AddCompanions(const CompanionFiles& files, std::size_t frame, cv::Size size,
                     const calib::Radiometry& radiometry, const calib::Exposure& exposure,
                     placement::Pictures& pictures) {
  const auto empty = FromFiles(files.empty, frame, size, radiometry, exposure);
  if (!empty) return Forward(empty);
  const auto lamp_off = FromFiles(files.lamp_off, frame, size, radiometry, exposure);
  if (!lamp_off) return Forward(lamp_off);
  if (!empty->empty()) pictures.empty = *empty;
  if (!lamp_off->empty()) pictures.lamp_off = *lamp_off;
  return {};
}

template <typename Frame>
std::optional<double> AngleOf(const Frame& frame) {
  return frame.angle_measured_deg ? frame.angle_measured_deg : frame.angle_deg;
}

Status AddFrame(std::optional<double> angle_deg, std::size_t index, const std::string& where,
                TargetPictures& pictures) {
  if (!angle_deg)
    return InputError(Format("%s: frames/%zu/angle_deg: missing, allowed is the table's angle",
                             where.c_str(), index));
  pictures.frames.push_back({*angle_deg, rig::FrameLabel(index, angle_deg)});
  return {};
}

// The frames of a kind at about an angle, or all of that kind if there are none.
std::vector<std::size_t> Beside(const rig::RawCapture& capture, const std::string& kind,
                                double angle_deg) {
  const std::vector<std::size_t> all = rig::FramesOfKind(capture, kind);
  std::vector<std::size_t> near;
  for (const std::size_t i : all) {
    const auto at = AngleOf(capture.frames[i]);
    if (at && std::abs(std::remainder(*at - angle_deg, 360.0)) < kSameAngleDeg) near.push_back(i);
  }
  return near.empty() ? all : near;
}

// Their mean, linear; empty if there are none.
Result<cv::Mat> MeanOf(const rig::RawCapture& capture, const std::vector<std::size_t>& frames,
                       const calib::Radiometry& radiometry) {
  cv::Mat sum;
  for (const std::size_t i : frames) {
    const auto image = rig::ReadRawImage(capture, i);
    if (!image) return Forward(image);
    const cv::Mat linear =
        calib::Linearise(*image, radiometry, capture.frames[i].exposure).radiance;
    sum = sum.empty() ? linear : cv::Mat(sum + linear);
  }
  return sum.empty() ? sum : cv::Mat(sum / static_cast<double>(frames.size()));
}

std::vector<std::size_t> TargetFrames(const rig::RawCapture& capture) {
  std::vector<std::size_t> frames = rig::FramesOfKind(capture, "target");
  if (frames.empty())
    for (std::size_t i = 0; i < capture.frames.size(); ++i)
      if (!capture.frames[i].kind) frames.push_back(i);
  return frames;
}

// Calibrated radiometry has the exposure that radiance is of; else all is of the first frame's.
calib::Radiometry RadiometryFor(const rig::RigCalibration& calibration,
                                const calib::Exposure& first) {
  calib::Radiometry radiometry = calibration.radiometry;
  if (!radiometry.reference_exposure_us) radiometry.reference_exposure_us = first.exposure_us;
  if (!radiometry.reference_gain_db) radiometry.reference_gain_db = first.gain_db;
  return radiometry;
}

}  // namespace

Result<TargetPictures> TargetPicturesOf(const fs::path& path,
                                        const rig::RigCalibration& calibration,
                                        const CompanionFiles& companions) {
  auto read = rig::ReadSession(path);
  if (!read) return Forward(read);
  const auto session = std::make_shared<const rig::Session>(std::move(*read));
  if (session->length_unit != calibration.length_unit)
    return InputError(calibration.source + ": length_unit: \"" + calibration.length_unit +
                      "\", allowed is the session's, \"" + session->length_unit + "\"");
  const cv::Size size(session->camera->width(), session->camera->height());
  Status status = CheckSize(calibration, size, "session");
  if (status) status = CheckCompanions(companions, session->frames.size());
  TargetPictures pictures;
  for (std::size_t i = 0; status && i < session->frames.size(); ++i)
    status = AddFrame(AngleOf(session->frames[i]), i, (session->root / rig::kSessionFile).string(),
                      pictures);
  if (!status) return Forward(status);
  pictures.read = [session, companions, size](std::size_t i) -> Result<placement::Pictures> {
    const rig::FrameRecord& record = session->frames[i];
    const auto images = rig::ReadFrameImages(*session, i);
    if (!images) return Forward(images);
    placement::Pictures read;
    read.lit = calib::Linearise(images->image, session->radiometry, record.exposure).radiance;
    if (record.mask) read.mask = images->mask;
    const Status added =
        AddCompanions(companions, i, size, session->radiometry, record.exposure, read);
    return added ? Result<placement::Pictures>(std::move(read)) : Forward(added);
  };
  return pictures;
}

Result<TargetPictures> TargetPicturesOf(const rig::RawCapture& raw,
                                        const rig::RigCalibration& calibration,
                                        const CompanionFiles& companions) {
  const auto capture = std::make_shared<const rig::RawCapture>(raw);
  const std::string where = (capture->root / rig::kCaptureFile).string();
  const std::vector<std::size_t> frames = TargetFrames(*capture);
  if (frames.empty())
    return InputError(where +
                      ": no frame of the kind \"target\", allowed is a capture with --kind target");
  Status status = CheckSize(calibration, capture->devices.resolution, "capture");
  if (status)
    status = rig::CheckIdentity(calibration, capture->devices.camera, capture->devices.table);
  if (status) status = CheckCompanions(companions, frames.size());
  TargetPictures pictures;
  for (std::size_t i = 0; status && i < frames.size(); ++i)
    status = AddFrame(AngleOf(capture->frames[frames[i]]), frames[i], where, pictures);
  if (!status) return Forward(status);
  const calib::Radiometry radiometry =
      RadiometryFor(calibration, capture->frames[frames.front()].exposure);
  pictures.read = [capture, frames, radiometry, companions,
                   angles = pictures.frames](std::size_t i) -> Result<placement::Pictures> {
    const calib::Exposure& exposure = capture->frames[frames[i]].exposure;
    const auto image = rig::ReadRawImage(*capture, frames[i]);
    if (!image) return Forward(image);
    auto empty = MeanOf(*capture, Beside(*capture, "empty", angles[i].angle_deg), radiometry);
    if (!empty) return Forward(empty);
    auto lamp_off = MeanOf(*capture, Beside(*capture, "lamp-off", angles[i].angle_deg), radiometry);
    if (!lamp_off) return Forward(lamp_off);
    placement::Pictures read;
    read.lit = calib::Linearise(*image, radiometry, exposure).radiance;
    read.empty = *empty;
    read.lamp_off = *lamp_off;
    const Status added =
        AddCompanions(companions, i, capture->devices.resolution, radiometry, exposure, read);
    return added ? Result<placement::Pictures>(std::move(read)) : Forward(added);
  };
  return pictures;
}

}  // namespace turnlight::app
