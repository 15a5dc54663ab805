#include "nodes/kept_keyframes.h"

#include "rig/session/image_file.h"

namespace turnlight::nodes {

Result<estimator::model::Keyframe> ReadKept(const std::filesystem::path& root,
                                            const rig::JournalEntry& entry,
                                            const calib::Radiometry& session) {
  const auto image = rig::ReadImage(root / entry.frame.image);
  if (!image) return Forward(image);
  estimator::model::Keyframe out;
  out.image = calib::Linearise(*image, session, entry.frame.exposure);
  out.mask = cv::Mat1b(image->size(), std::uint8_t{255});
  if (entry.frame.validity) {
    auto mask = rig::ReadMask(root / *entry.frame.validity, image->size());
    if (!mask) return Forward(mask);
    out.mask = std::move(*mask);
  }
  out.X_WC = entry.frame.X_WC;
  out.X_WT = entry.frame.X_WT;
  return out;
}

}  // namespace turnlight::nodes
