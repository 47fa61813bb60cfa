#pragma once
// The command line (the only file that knows CLI11).

namespace knap {

/// Runs the command that the arguments name and returns the exit code. Exceptions of the layers below pass through.
int run_command_line(int argc, char** argv);

}  // namespace knap
