// provenance.jsonl: who captured with what, when, and how often it had to be tried. The only file
// of a session with times in it: outside every hash. One JSON object a line; a torn line, after a
// crash, is to be skipped.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "rig/device.h"
#include "rig/session/journal.h"

namespace turnlight::rig {

inline constexpr char kProvenanceFile[] = "provenance.jsonl";

// Who records now, for the provenance.
struct RunProvenance {
  std::string program_version, program_commit;
  std::string utc;                 // when the run began, a label
  CameraSettings camera_settings;  // asked for; a frame that has others is refused
  std::vector<std::pair<std::string, std::string>> notes;  // further device settings, as key, value
};

// How a keyframe came to be, for the provenance: never hashed, never compared.
struct KeyframeProvenance {
  std::string utc;                              // a label
  DeviceTime exposure_begin{}, exposure_end{};  // first and last, since the run's start
  int attempts = 1;
  std::vector<std::string> rejected;  // why, one text per attempt that failed
  // Of the devices, for each exposure: frame ids, drops.
  std::vector<std::vector<std::pair<std::string, std::int64_t>>> counters;
  std::vector<DeviceReading> readings;  // of the camera, after the last exposure
};

// The line of a run: program, config, devices, hashes. kept and dropped: of a resume, else 0 and
// nothing.
std::string PrintRunLine(const RunProvenance& run, const JournalHeader& header, std::size_t kept,
                         const std::vector<std::string>& dropped);
std::string PrintKeyframeLine(const KeyframeProvenance& provenance, const JournalEntry& entry);

}  // namespace turnlight::rig
