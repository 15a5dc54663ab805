// What a study says, in words and numbers: the acceptance figures first, then where it is weak.
#pragma once

#include <string>

#include "bench/studies/study_file.h"

namespace turnlight::studies {

struct Summary {
  std::string text;
  bool accepted = true;  // every acceptance figure holds
};

// `worst`: how many of the worst scenes are listed.
Summary Summarise(const StudyFile& file, int worst);

}  // namespace turnlight::studies
