// One decision about the model.
#pragma once

#include <string>

namespace turnlight::estimator::model {

struct Rung {  // in the order they were taken
  std::string rung;
  bool accepted = false;
  std::string why;  // in words, with the numbers
};

}  // namespace turnlight::estimator::model
