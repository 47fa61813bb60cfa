#pragma once
// Starts a program as a process of its own.
#include <unistd.h>

#include <string>
#include <vector>

namespace knap {

/// `words`: its command line, the name first; `in`, `out`: the descriptors of its standard input (-1: that of this
/// process) and of both its outputs. prepare() runs in the new process, which ends where it returns false. Returns the
/// number of the process; -1 with errno where there is none.
template <class Prepare>
pid_t start_process(const char* program, std::vector<std::string> words, int in, int out, const Prepare& prepare) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t child = fork();
    if (child != 0) return child;
    const bool is_ready = prepare() && (in < 0 || dup2(in, STDIN_FILENO) >= 0) && dup2(out, STDOUT_FILENO) >= 0 &&
                          dup2(out, STDERR_FILENO) >= 0;
    if (is_ready) execv(program, arguments.data());
    _exit(127);
}

}  // namespace knap
