// A person at the terminal, asked to do something with their hands.
#pragma once

#include <string>

#include "base/result.h"
#include "base/stop_flag.h"

namespace turnlight::app {

// Says the text on standard error and waits for a line on standard input. Fails (kInterrupted) on
// stop, (kInput) at the end of the input: there is nobody to ask.
Status WaitForEnter(const std::string& text, const StopFlag* stop);

}  // namespace turnlight::app
