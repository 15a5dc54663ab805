#include "rig/session/picture_notes.h"

#include <map>

#include "base/format.h"

namespace turnlight::rig {
namespace {

std::string SessionEncoding(const calib::Radiometry& radiometry) {
  switch (radiometry.encoding) {
    case calib::Encoding::kLinear:
      return "linear";
    case calib::Encoding::kSrgb:
      return "srgb";
    case calib::Encoding::kGamma:
      return "gamma " + NumberText(radiometry.gamma);
    case calib::Encoding::kCurve:
      break;
  }
  return "a curve";
}

// "frames/000.png" or "12 of 36 pictures, the first is frames/000.png".
std::string Which(const std::string& first, std::size_t count, std::size_t all) {
  if (all == 1) return first;
  return std::to_string(count) + " of " + std::to_string(all) + " pictures, the first is " + first;
}

void AddContradictions(const calib::Radiometry& radiometry, const std::vector<PictureFacts>& frames,
                       std::vector<PictureNote>& notes) {
  const PictureFacts* first = nullptr;
  std::size_t count = 0;
  for (const PictureFacts& frame : frames) {
    if (!frame.claims.transfer || !Contradicts(*frame.claims.transfer, radiometry)) continue;
    if (!first) first = &frame;
    ++count;
  }
  if (!first) return;
  const TransferClaim& claim = *first->claims.transfer;
  notes.push_back(
      {"encoding-contradicted",
       Which(first->file, count, frames.size()) + ": " + claim.said_by +
           " says that the values are " + ClaimWords(claim) +
           ", radiometry/encoding in session.json says " + SessionEncoding(radiometry) +
           ". If the file is right, set \"encoding\": " + EncodingOf(claim) +
           "; if the session is right, have the pictures written without that statement"});
}

void AddRemarks(const std::vector<PictureFacts>& frames, std::vector<PictureNote>& notes) {
  std::map<std::string, std::pair<std::string, std::size_t>> remarks;  // to first file, count
  for (const PictureFacts& frame : frames)
    for (const std::string& remark : frame.claims.remarks)
      ++remarks.emplace(remark, std::pair(frame.file, 0)).first->second.second;
  for (const auto& [remark, where] : remarks)
    notes.push_back(
        {"pictures-read-as", Which(where.first, where.second, frames.size()) + ": " + remark});
}

}  // namespace

std::vector<PictureNote> PictureNotes(const calib::Radiometry& radiometry,
                                      const std::vector<PictureFacts>& frames) {
  std::vector<PictureNote> notes;
  AddContradictions(radiometry, frames, notes);
  std::vector<PictureLevels> levels;
  levels.reserve(frames.size());
  for (const PictureFacts& frame : frames) levels.push_back(frame.levels);
  if (const std::string text = LevelsText(radiometry, levels); !text.empty())
    notes.push_back({"levels-doubtful", text});
  AddRemarks(frames, notes);
  return notes;
}

}  // namespace turnlight::rig
