#include "app/command_line.h"

int main(int argc, char** argv) { return turnlight::app::RunCommandLine(argc, argv); }
