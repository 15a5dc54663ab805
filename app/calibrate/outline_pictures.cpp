#include "app/calibrate/outline_pictures.h"

#include <utility>

#include "app/interrupt.h"
#include "app/progress.h"
#include "base/file.h"
#include "base/format.h"
#include "calib/calibrate/placement/view_of_picture.h"
#include "rig/session/image_file.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace placement = calib::calibrate::placement;

constexpr std::size_t kShown = 6;  // photographs in the report

// Pictures beside the frames: none, one for all, or one each.
class Companions {
 public:
  static Result<Companions> Read(const std::vector<std::string>& files, const char* option,
                                 const rig::Session& session) {
    if (files.size() > 1 && files.size() != session.frames.size())
      return InputError(
          Format("%s: %zu pictures, allowed are one, or one for each of the %zu frames", option,
                 files.size(), session.frames.size()));
    Companions companions(files, session);
    if (files.size() != 1) return companions;
    auto picture = companions.Load(0, {});
    if (!picture) return Forward(picture);
    companions.common_ = *picture;
    return companions;
  }

  // As linear radiance, taken with the frame's exposure.
  Result<cv::Mat> Of(std::size_t frame) const {
    if (files_.empty() || files_.size() == 1) return common_;
    return Load(frame, session_->frames[frame].exposure);
  }

 private:
  Companions(const std::vector<std::string>& files, const rig::Session& session)
      : files_(files), session_(&session) {}

  Result<cv::Mat> Load(std::size_t at, const calib::Exposure& exposure) const {
    const auto image =
        rig::ReadImage(files_[at], {session_->camera->width(), session_->camera->height()});
    if (!image) return Forward(image);
    return calib::Linearise(*image, session_->radiometry, exposure).radiance;
  }

  std::vector<std::string> files_;
  const rig::Session* session_;
  cv::Mat common_;
};

Result<placement::PictureView> ObserveFrame(const rig::Session& session, std::size_t frame,
                                            const Companions& empty, const Companions& lamp_off,
                                            cv::Mat& picture) {
  const rig::FrameRecord& record = session.frames[frame];
  const auto images = rig::ReadFrameImages(session, frame);
  if (!images) return Forward(images);
  placement::Pictures pictures;
  pictures.lit = calib::Linearise(images->image, session.radiometry, record.exposure).radiance;
  picture = pictures.lit;
  const auto bare = empty.Of(frame), dark = lamp_off.Of(frame);
  if (!bare) return Forward(bare);
  if (!dark) return Forward(dark);
  pictures.empty = *bare;
  pictures.lamp_off = *dark;
  if (record.mask) pictures.mask = images->mask;
  const double angle_deg = record.angle_measured_deg.value_or(record.angle_deg.value_or(0.0));
  return placement::ViewOfPicture(pictures, angle_deg, rig::FrameLabel(frame, angle_deg));
}

}  // namespace

Status CheckOutlineSession(const rig::Session& session, const rig::RigCalibration& calibration) {
  if (session.length_unit != calibration.length_unit)
    return InputError(calibration.source + ": length_unit: \"" + calibration.length_unit +
                      "\", allowed is the session's, \"" + session.length_unit + "\"");
  const cv::Size taken(session.camera->width(), session.camera->height());
  if (taken != calibration.devices.resolution)
    return InputError(
        Format("%s: identity/camera/resolution: %d x %d, the session's pictures are "
               "%d x %d; allowed is a calibration of pictures like these",
               calibration.source.c_str(), calibration.devices.resolution.width,
               calibration.devices.resolution.height, taken.width, taken.height));
  for (std::size_t i = 0; i < session.frames.size(); ++i)
    if (!session.frames[i].angle_deg && !session.frames[i].angle_measured_deg)
      return InputError(Format("%s: frames/%zu/angle_deg: missing, allowed is the table's angle",
                               (session.root / rig::kSessionFile).c_str(), i));
  return {};
}

Result<OutlinePictures> FindOutlines(const rig::Session& session, const PicturesBeside& beside,
                                     const fs::path& masks) {
  const auto empty = Companions::Read(beside.empty, "--empty", session);
  if (!empty) return Forward(empty);
  const auto lamp_off = Companions::Read(beside.lamp_off, "--lamp-off", session);
  if (!lamp_off) return Forward(lamp_off);
  if (!masks.empty())
    if (Status status = MakeDirectory(masks); !status) return Forward(status);
  OutlinePictures observed;
  const std::size_t count = session.frames.size();
  const std::size_t every = (count + kShown - 1) / kShown;
  Progress progress("finding outlines", count);
  for (std::size_t i = 0; i < count; ++i) {
    if (Interrupted()) return InterruptedError();
    cv::Mat picture;
    auto seen = ObserveFrame(session, i, *empty, *lamp_off, picture);
    if (!seen) return Forward(seen);
    if (!seen->mask.empty() && !masks.empty())
      if (Status status = rig::WriteImage(masks / Format("%03zu.png", i), seen->mask); !status)
        return Forward(status);
    observed.from_masks |= seen->from_mask;
    observed.remarks.insert(observed.remarks.end(), seen->remarks.begin(), seen->remarks.end());
    observed.views.push_back(std::move(seen->view));
    observed.shown.push_back(i % every == 0 ? picture : cv::Mat());
    progress.Step();
  }
  if (observed.from_masks)
    observed.remarks.push_back(
        "some outlines are those of the session's masks, as the pictures "
        "show no clear edges there");
  return observed;
}

void AddBesideOptions(CLI::App& command, PicturesBeside& beside) {
  command
      .add_option("--empty", beside.empty, "Picture of the empty table: one, or one for each frame")
      ->type_name("IMAGE");
  command
      .add_option("--lamp-off", beside.lamp_off,
                  "Picture with the lamps off, subtracted: one, or one for each frame")
      ->type_name("IMAGE");
}

}  // namespace turnlight::app
