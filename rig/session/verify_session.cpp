#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include "base/file.h"
#include "base/format.h"
#include "base/parallel.h"
#include "base/sha256.h"
#include "rig/session/journal.h"
#include "rig/session/session_files.h"
#include "rig/session_calibration.h"

namespace turnlight::rig {
namespace {

namespace fs = std::filesystem;

// Everything that is wrong with the files of one frame; without problems, what its picture says.
std::vector<std::string> FrameProblems(const Session& session, std::size_t index,
                                       std::optional<PictureFacts>& facts) {
  std::vector<std::string> problems;
  for (const NamedPath& named : PathsOfFrame(session.frames[index], index))
    if (const auto path = Locate(session.root, named); !path) problems.push_back(path.error().text);
  if (!problems.empty()) return problems;
  auto images = ReadFrameImages(session, index);
  if (images)
    facts = std::move(images->facts);
  else
    problems.push_back(images.error().text);
  return problems;
}

void AddPictureRemarks(const Session& session,
                       const std::vector<std::optional<PictureFacts>>& facts,
                       std::vector<std::string>& remarks) {
  std::vector<PictureFacts> read;
  for (const auto& fact : facts)
    if (fact) read.push_back(*fact);
  for (PictureNote& note : PictureNotes(session.radiometry, read))
    remarks.push_back(std::move(note.text));
}

// What `sha256sum` prints for all files of a good session, sorted by path.
Result<std::string> ContentLines(const Session& session) {
  std::map<std::string, std::string> checked;  // pictures that were found to have their checksum
  for (const FrameRecord& frame : session.frames)
    if (frame.sha256) checked.emplace(frame.image, *frame.sha256);
  std::set<std::string> paths{kSessionFile};
  for (const NamedPath& named : PathsOf(session)) paths.insert(named.path);
  std::string lines;
  for (const std::string& path : paths) {
    std::string& sha256 = checked[path];
    if (sha256.empty()) {
      const auto bytes = ReadFile(session.root / path);
      if (!bytes) return Forward(bytes);
      sha256 = Sha256Hex(*bytes);
    }
    lines += sha256 + "  " + path + "\n";
  }
  return lines;
}

// What only the journal of a finished capture knows: the checksums of the validity maps, and the
// closure frame, which belongs to the capture and not to the session.
void CheckAgainstJournal(const Session& session, std::vector<std::vector<std::string>>& problems,
                         std::vector<std::string>& remarks) {
  std::error_code code;
  if (!fs::exists(session.root / kJournalFile, code)) return;
  const auto journal = ReadJournal(session.root);
  if (!journal) {
    remarks.push_back(journal.error().text);
    return;
  }
  for (const JournalEntry& entry : journal->entries) {
    const FrameRecord* frame =
        entry.index < problems.size() ? &session.frames[entry.index] : nullptr;
    if (frame && !problems[entry.index].empty()) continue;
    const bool checked =
        frame && frame->image == entry.frame.image && frame->sha256 == entry.frame.sha256;
    for (const std::string& problem :
         EntryProblems(session.root, entry, checked ? EntryFiles::kValidity : EntryFiles::kAll)) {
      if (frame)
        problems[entry.index].push_back(problem);
      else
        remarks.push_back(EntryLabel(journal->header, entry.index) + ": " + problem);
    }
  }
}

// A file of the capture's start, against its checksum in the journal.
void CheckCopy(const fs::path& root, const std::string& key, const std::string& path,
               const std::string& sha256, std::vector<std::string>& problems) {
  const auto file = Locate(root, {key, path, kJournalFile});
  const auto bytes = file ? ReadFile(*file) : Result<std::string>(Forward(file));
  if (!bytes)
    problems.push_back(bytes.error().text);
  else if (Sha256Hex(*bytes) != sha256)
    problems.push_back(file->string() + ": the file changed since the capture began");
}

// A capture that did not come to its end: what is lost is what its journal does not have.
Result<VerifyReport> VerifyUnfinished(const fs::path& root) {
  const auto journal = ReadJournal(root);
  if (!journal) return Forward(journal);
  const JournalHeader& header = journal->header;
  VerifyReport report;
  CheckCopy(root, "camera", header.camera_path, header.camera_sha256, report.problems);
  if (header.mesh_path)
    CheckCopy(root, "mesh", *header.mesh_path, *header.mesh_sha256, report.problems);
  report.session_good = report.problems.empty();
  for (const std::string& problem : journal->problems) report.problems.push_back(problem);

  std::vector<std::vector<std::string>> problems(journal->entries.size());
  ParallelFor(problems.size(),
              [&](std::size_t i) { problems[i] = EntryProblems(root, journal->entries[i]); });
  std::set<std::size_t> good;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const std::size_t index = journal->entries[i].index;
    if (problems[i].empty()) good.insert(index);
    for (const std::string& problem : problems[i])
      report.problems.push_back(EntryLabel(header, index) + ": " + problem);
  }
  const std::size_t count = header.angles_deg.size();
  std::vector<std::string> angles;
  for (std::size_t i = 0; i < count + (header.closure_deg ? 1 : 0); ++i) {
    if (good.contains(i)) {
      report.frames += i < count ? 1 : 0;
      continue;
    }
    report.lost_angles_deg.push_back(i < count ? header.angles_deg[i] : *header.closure_deg);
    angles.push_back(EntryLabel(header, i));
  }
  report.problems.push_back(
      root.string() + ": the capture was not finished: " + std::to_string(report.frames) + " of " +
      std::to_string(count) + " frames are good" +
      (angles.empty() ? ", only session.json is missing" : "; not there: " + Listed(angles)) +
      ". `turnlight resume` completes it");
  return report;
}

}  // namespace

Result<VerifyReport> VerifySession(const fs::path& root) {
  std::error_code code;
  if (!fs::exists(root / kSessionFile, code) && fs::exists(root / kJournalFile, code))
    return VerifyUnfinished(root);
  auto parsed = LoadSession(root);
  if (!parsed) return Forward(parsed);
  const Session& session = parsed->session;
  VerifyReport report;
  report.problems = std::move(parsed->problems);
  if (!session.camera) return report;  // its size is what every frame is checked against
  const auto target = ReadTarget(session, &report.remarks);
  if (!target) report.problems.push_back(target.error().text);
  if (const auto calibration = ReadSessionCalibration(session); !calibration)
    report.problems.push_back(calibration.error().text);
  report.session_good = report.problems.empty();

  std::vector<std::vector<std::string>> problems(session.frames.size());
  std::vector<std::optional<PictureFacts>> facts(session.frames.size());
  ParallelFor(problems.size(),
              [&](std::size_t i) { problems[i] = FrameProblems(session, i, facts[i]); });
  AddPictureRemarks(session, facts, report.remarks);
  CheckAgainstJournal(session, problems, report.remarks);
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const bool good = problems[i].empty();
    if (good) ++report.frames;
    if (!good && session.frames[i].angle_deg)
      report.lost_angles_deg.push_back(*session.frames[i].angle_deg);
    for (const std::string& problem : problems[i])
      report.problems.push_back(FrameLabel(i, session.frames[i].angle_deg) + ": " + problem);
  }
  const auto without_checksum =
      std::count_if(session.frames.begin(), session.frames.end(),
                    [](const FrameRecord& frame) { return !frame.sha256; });
  if (without_checksum > 0)
    report.remarks.push_back(std::to_string(without_checksum) + " of " +
                             std::to_string(session.frames.size()) +
                             " frames have no sha256: a change of their pictures goes unseen");
  if (!report.problems.empty()) return report;
  const auto lines = ContentLines(session);
  if (!lines) return Forward(lines);
  report.content_sha256 = Sha256Hex(*lines);
  return report;
}

}  // namespace turnlight::rig
