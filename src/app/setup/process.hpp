#pragma once
// This process: its threads, and the signals that end it. Ctrl-C, SIGTERM and SIGHUP (a lost terminal or connection)
// end the program with exit code 130. Those that are ignored when it starts, as under nohup,
// stay ignored.

namespace knap {

/// Exit codes of every command.
enum ExitCode {
    exit_done = 0,
    exit_internal = 1,
    exit_bad_input = 2,
    exit_failed = 3,
    exit_expectation = 4,
    exit_interrupted = 130
};

/// Sets the number of OpenMP threads of all loops and returns it. 0: that of OMP_NUM_THREADS, else of
/// SLURM_CPUS_PER_TASK, else one per processor.
int use_threads(int n_requested);

/// Makes waiting OpenMP threads sleep after some 25 microseconds, and keeps VTK from starting threads of its own. The
/// OpenMP runtime reads this from the environment before main, so the program executes itself once more, unless the
/// user has set a policy. Without it a run on a busy machine is ten times slower: threads spin while the thread that
/// they wait for has no processor.
void let_waiting_threads_sleep(char** argv);

/// From now on each of these signals ends the program at once with a message.
void end_when_interrupted();

/// During its life the signals are only recorded: a run ends after the current step, or gives up a step of the implicit
/// bulk, with its outputs complete. A second Ctrl-C kills as usual. SIGTERM and SIGHUP may repeat: a scheduler sends
/// them to a sweep and to its runs, and the sweep passes them to its runs as well.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    static bool interrupted();

    /// During its life, within that of a guard, the signals end the program at once again: no step is there to keep.
    struct Lifted {
        Lifted();
        ~Lifted();
    };
};

bool is_ignored(int signal);

/// [byte] Memory that this process can have besides what it has, by the machine, its limits and its control group;
/// infinity where none of them is known.
double free_memory();

/// Frames and figures allocate and free the same memory some thirty times in a run. Memory returned to the system in
/// between comes back zeroed, page by page, which took a third of the time of a frame.
void keep_freed_memory();
/// Returns it to the system where it is more than 128 MB.
void return_freed_memory();

}  // namespace knap
