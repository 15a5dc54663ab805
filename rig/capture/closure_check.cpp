#include "rig/capture/closure_check.h"

#include <algorithm>
#include <cstring>
#include <system_error>

#include "base/format.h"
#include "base/messages/messages.h"
#include "rig/session/image_file.h"
#include "rig/session/journal.h"
#include "rig/session/session.h"

namespace turnlight::rig {
namespace {

constexpr double kMuchClipped = 0.25;  // of a picture's pixels

// Why no part of the two pictures could be compared.
std::string WhyNothing(const cv::Mat& first, const cv::Mat& closure,
                       const calib::Radiometry& radiometry) {
  const FrameStatistics a = MeasureFrame(first, radiometry), b = MeasureFrame(closure, radiometry);
  const double clipped = std::max(a.saturated_share, b.saturated_share);
  if (clipped > kMuchClipped)
    return messages::Text("closure-clipped", {{"share", Format("%.0f", 100.0 * clipped)}});
  return messages::Text("closure-dark",
                        {{"bright", Format("%.2g", std::min(a.bright_level, b.bright_level))}});
}

std::string Describe(const ClosureCheck& check) {
  return messages::Text(check.closed ? "closure-closed" : "closure-open",
                        {{"closure", Format("%.10g", check.closure_deg)},
                         {"first", Format("%.10g", check.first_deg)},
                         {"share", Format("%.2g", 100.0 * check.difference.block_share)},
                         {"sigmas", Format("%.2g", check.difference.block_sigmas)},
                         {"most_share", Format("%.2g", 100.0 * kClosureShare)},
                         {"most_sigmas", Format("%.2g", kClosureSigmas)}});
}

}  // namespace

ClosureCheck CompareClosure(double first_deg, const cv::Mat& first, double closure_deg,
                            const cv::Mat& closure, const calib::Radiometry& radiometry) {
  ClosureCheck check;
  check.first_deg = first_deg;
  check.closure_deg = closure_deg;
  check.difference = CompareFrames(first, closure, radiometry);
  check.closed = check.difference.blocks > 0 && (check.difference.block_sigmas <= kClosureSigmas ||
                                                 check.difference.block_share <= kClosureShare);
  check.text =
      check.difference.blocks > 0 ? Describe(check) : WhyNothing(first, closure, radiometry);
  return check;
}

Result<std::optional<ClosureCheck>> CheckClosure(const std::filesystem::path& session) {
  std::error_code code;
  if (!std::filesystem::exists(session / kJournalFile, code)) return std::optional<ClosureCheck>();
  const auto journal = ReadJournal(session);
  if (!journal) return Forward(journal);
  if (!journal->header.closure_deg) return std::optional<ClosureCheck>();
  const auto read = ReadSession(session);
  if (!read) return Forward(read);
  const std::size_t last = journal->header.angles_deg.size();
  const auto closure =
      std::find_if(journal->entries.begin(), journal->entries.end(),
                   [last](const JournalEntry& entry) { return entry.index == last; });
  if (closure == journal->entries.end())
    return InputError((session / kJournalFile).string() + ": the closure frame is missing");
  const auto first_image = ReadImage(session / read->frames.front().image);
  if (!first_image) return Forward(first_image);
  const auto closure_image = ReadImage(session / closure->frame.image);
  if (!closure_image) return Forward(closure_image);
  if (first_image->size() != closure_image->size() || first_image->type() != closure_image->type())
    return InputError((session / closure->frame.image).string() +
                      ": another size or kind than the first frame, allowed is the same");
  return CompareClosure(journal->header.angles_deg.front(), *first_image,
                        *journal->header.closure_deg, *closure_image, read->radiometry);
}

}  // namespace turnlight::rig
