#include "estimator/from_session/session_keyframe.h"

#include "calib/radiometry.h"

namespace turnlight::estimator::from_session {

Result<model::Keyframe> ReadKeyframe(const rig::Session& session, std::size_t frame,
                                     rig::PictureFacts* facts) {
  const auto images = rig::ReadFrameImages(session, frame);
  if (!images) return Forward(images);
  if (facts != nullptr) *facts = images->facts;
  const rig::FrameRecord& record = session.frames[frame];
  return model::Keyframe{calib::Linearise(images->image, session.radiometry, record.exposure),
                         images->mask, record.X_WC, record.X_WT};
}

}  // namespace turnlight::estimator::from_session
