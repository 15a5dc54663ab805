#include "rig/capture/closure_check.h"

#include <algorithm>
#include <cstring>
#include <system_error>

#include "base/format.h"
#include "rig/session/image_file.h"
#include "rig/session/journal.h"
#include "rig/session/session.h"

namespace turnlight::rig {
namespace {

std::string Describe(const ClosureCheck& check) {
  if (check.difference.blocks == 0) return "the pictures are too dark to be compared";
  const std::string text = Format(
      "the picture at %.10g\u00b0 differs from the one at %.10g\u00b0 by %.2g %%, %.2g "
      "times what noise explains; ",
      check.closure_deg, check.first_deg, 100.0 * check.difference.block_share,
      check.difference.block_sigmas);
  if (check.closed) return text + "the table kept its place";
  return text +
         Format(
             "allowed is %.2g %% or %.2g times: the table lost its place, the target moved or "
             "the light changed, and the angles of this capture are not to be trusted",
             100.0 * kClosureShare, kClosureSigmas);
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
  check.text = Describe(check);
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
