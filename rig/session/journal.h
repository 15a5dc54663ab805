// journal.jsonl: what a capture has safely on disk, line by line, while session.json is not there
// yet. The first line says what was begun, each further line names a keyframe. A line is
//   {"crc32": "<8 hexadecimal digits>", "record": {...}}
// with the CRC-32 (zlib's) of the record's bytes, so that a torn or damaged line is seen and the
// others still count. No times: resumed or not, a capture ends with the same journal.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rig/session/session.h"

namespace turnlight::rig {

inline constexpr char kJournalFile[] = "journal.jsonl";

// What must be the same on every run of a capture.
struct JournalHeader {
  std::string config_text;
  std::string camera_path, camera_sha256;  // relative; of the copy
  std::optional<std::string> mesh_path, mesh_sha256;
  std::string camera_identity, table_identity;  // "vendor, model, serial"
  std::vector<double> angles_deg;               // commanded, in order of capture
  bool by_hand = false;  // the camera was carried: the angles are as many as frames, and all 0
  std::optional<double> closure_deg;
  std::size_t most_extra = 0;  // frames that may come beyond those; not with a closure frame
};

struct JournalEntry {
  std::size_t index =
      0;  // into angles_deg; from angles_deg.size() on: the closure frame, or extra ones
  FrameRecord frame;  // as session.json will have it; sha256 is always there
  std::optional<std::string> validity_sha256;
};

struct Journal {
  JournalHeader header;
  std::vector<JournalEntry> entries;  // by index; of two for one index the later
  std::vector<std::string> problems;  // lines that do not count, one text each
  std::string text;                   // of the file
};

std::string PrintJournalLine(const JournalHeader& header);
std::string PrintJournalLine(const JournalEntry& entry);

// Fails (kInput): no file, or a first line that does not count.
Result<Journal> ReadJournal(const std::filesystem::path& root);

// What is wrong with the files of an entry: missing, changed, out of the folder. Empty: nothing.
// kValidity: the picture is known to be the one.
enum class EntryFiles { kAll, kValidity };
std::vector<std::string> EntryProblems(const std::filesystem::path& root, const JournalEntry& entry,
                                       EntryFiles which = EntryFiles::kAll);

// "frame 3 (30.0 deg)", "closure frame (360.0 deg)", or by hand "frame 3".
std::string EntryLabel(const JournalHeader& header, std::size_t index);

}  // namespace turnlight::rig
