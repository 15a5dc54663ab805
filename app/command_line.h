// The program's command line.
#pragma once

namespace turnlight::app {

// Parses and runs; gives the exit code. Never throws.
int RunCommandLine(int argc, char** argv);

}  // namespace turnlight::app
