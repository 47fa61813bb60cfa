#pragma once
// Ctrl-C, SIGTERM and SIGHUP (a terminal or connection that is lost) end this program with exit code 130. SIGHUP that is ignored, as under nohup, stays so.

namespace knap {

/// From now on each of them ends the program at once, and says so.
void end_when_interrupted();

/// While it lives they are only noted: a run ends after the step under way, or gives up one of the
/// implicit bulk and ends at its begin, with its outputs complete. A second Ctrl-C kills as usual; SIGTERM and SIGHUP
/// may come again: schedulers send them to a sweep and to its runs, and the sweep to its runs as well.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    static bool interrupted();
};

/// Whether a lost terminal is of no interest.
bool ignores_hangup();

}  // namespace knap
