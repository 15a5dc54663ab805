#include "app/calibrate/outline_pictures.h"

#include <utility>

#include "app/interrupt.h"
#include "app/progress.h"
#include "base/file.h"
#include "base/format.h"
#include "calib/calibrate/placement/view_of_picture.h"
#include "rig/session/image_file.h"
#include "rig/session/raw_capture.h"
#include "rig/session/session.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace placement = calib::calibrate::placement;

constexpr std::size_t kShown = 6;  // photographs in the report

Result<TargetInput> Together(Result<TargetPictures> pictures, Result<calib::TargetShape> shape) {
  if (!pictures) return Forward(pictures);
  if (!shape) return Forward(shape);
  return TargetInput{std::move(*pictures), std::move(*shape)};
}

}  // namespace

void AddTargetOptions(CLI::App& command, TargetArguments& arguments) {
  AddTargetShapeOptions(command, arguments.shape);
  command
      .add_option("--empty", arguments.companions.empty,
                  "Picture of the empty table: one, or one for each frame")
      ->type_name("IMAGE");
  command
      .add_option("--lamp-off", arguments.companions.lamp_off,
                  "Picture with the lamps off, subtracted: one, or one for each frame")
      ->type_name("IMAGE");
}

Result<TargetInput> ReadTargetInput(const TargetArguments& arguments,
                                    const rig::RigCalibration& calibration) {
  if (rig::IsRawCapture(arguments.pictures)) {
    const auto capture = rig::ReadRawCapture(arguments.pictures);
    if (!capture) return Forward(capture);
    return Together(TargetPicturesOf(*capture, calibration, arguments.companions),
                    ReadTargetShape(arguments.shape));
  }
  if (arguments.shape.given())
    return InputError("--sphere, --plane and --mesh are for a raw capture; the session " +
                      arguments.pictures + " says itself what its target is");
  const auto session = rig::ReadSession(arguments.pictures);
  if (!session) return Forward(session);
  return Together(TargetPicturesOf(arguments.pictures, calibration, arguments.companions),
                  rig::ReadTarget(*session));
}

Result<OutlinePictures> FindOutlines(const TargetPictures& pictures, const fs::path& masks) {
  if (!masks.empty())
    if (Status status = MakeDirectory(masks); !status) return Forward(status);
  OutlinePictures observed;
  const std::size_t count = pictures.frames.size();
  const std::size_t every = (count + kShown - 1) / kShown;
  Progress progress("finding outlines", count);
  for (std::size_t i = 0; i < count; ++i) {
    if (Interrupted()) return InterruptedError();
    const auto read = pictures.read(i);
    if (!read) return Forward(read);
    const TargetPicture& frame = pictures.frames[i];
    auto seen = placement::ViewOfPicture(*read, frame.angle_deg, frame.label);
    if (!seen) return Forward(seen);
    if (!seen->mask.empty() && !masks.empty())
      if (Status status = rig::WriteImage(masks / Format("%03zu.png", i), seen->mask); !status)
        return Forward(status);
    observed.from_masks |= seen->from_mask;
    observed.remarks.insert(observed.remarks.end(), seen->remarks.begin(), seen->remarks.end());
    observed.views.push_back(std::move(seen->view));
    observed.shown.push_back(i % every == 0 ? read->lit : cv::Mat());
    progress.Step();
  }
  if (observed.from_masks)
    observed.remarks.push_back(
        "some outlines are those of the session's masks, as the pictures "
        "show no clear edges there");
  return observed;
}

}  // namespace turnlight::app
