// What the study of photographs says: its figures, and what a chart needs of them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/studies/study_file.h"
#include "bench/studies/summary.h"

namespace turnlight::studies {

// A record's id is SET/SCENE/METHOD: "ball-2/003_067/turnlight"; a set's name ends with the number
// of lights that are on.
inline constexpr const char* kPhotographMethods[] = {"turnlight", "paper", "script"};
std::string WordsOfMethod(const std::string& method);

Summary SummarisePhotographs(const StudyFile& file);

// The angles in degrees between the true lights of the sets that begin so and those that a method
// found, of its records; infinite where it gave no result or the number of lights is wrong: of many
// lights too many some are near by chance.
std::vector<double> PhotographErrors(const StudyFile& file, const std::string& sets,
                                     const std::string& method);

}  // namespace turnlight::studies
