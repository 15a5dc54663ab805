// The file that a study writes: one JSON object with a record per scene, kept sorted by id.
//
//   {"format": "turnlight-study", "version": 1, "study": "random", "records": [{...}, ...]}
//
// Every record has "id", "commit" (of the tree when it was made, "-dirty" with changes in it),
// "build" (the first 12 hex digits of the program's SHA-256), "time_s", "peak_mb", and either
// "failed" (in words) or what the study measured.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "base/result.h"

namespace turnlight::studies {

using Json = nlohmann::ordered_json;

struct StudyFile {
  std::string study;
  std::map<std::string, Json> records;  // by id
};

Result<StudyFile> ReadStudyFile(const std::filesystem::path& path);
// Atomic; one record a line.
Status WriteStudyFile(const StudyFile& file, const std::filesystem::path& path);

// What records are marked with.
std::string TreeCommit();
std::string ProgramHash();

// The number rounded to `digits` significant ones, null if it is not finite: files stay small.
Json Rounded(double value, int digits = 5);

}  // namespace turnlight::studies
