#include "app/run/interrupt.hpp"

#include "app/run/run.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <string_view>

namespace knap {
namespace {

std::atomic<int> noted = 0;  // the system gives a signal to any thread of the program
static_assert(std::atomic<int>::is_always_lock_free);

void end_at_once(int) {
    constexpr std::string_view line = "interrupted\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line.data(), line.size());  // of all that prints, a handler may call this only
    _exit(exit_interrupted);
}

void note(int which) {
    noted = 1;
    if (which == SIGINT) std::signal(SIGINT, SIG_DFL);
}

void handle_by(void (*handler)(int)) {
    std::signal(SIGINT, handler);
    std::signal(SIGTERM, handler);
    if (!ignores_hangup()) std::signal(SIGHUP, handler);
}

}  // namespace

void end_when_interrupted() { handle_by(end_at_once); }

InterruptGuard::InterruptGuard() {
    noted = 0;
    handle_by(note);
}

InterruptGuard::~InterruptGuard() { handle_by(end_at_once); }

bool InterruptGuard::interrupted() { return noted != 0; }

bool ignores_hangup() {
    struct sigaction now {};
    return sigaction(SIGHUP, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace knap
