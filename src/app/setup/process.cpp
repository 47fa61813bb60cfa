#include "app/setup/process.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <omp.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

namespace knap {
namespace {

std::atomic<int> noted = 0;  // any thread may receive the signal
static_assert(std::atomic<int>::is_always_lock_free);

void end_at_once(int) {
    constexpr std::string_view line = "interrupted\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, line.data(), line.size());  // signal-safe
    _exit(exit_interrupted);
}

void note(int signal) {
    noted = 1;
    if (signal == SIGINT) std::signal(SIGINT, SIG_DFL);
}

void handle_by(void (*handler)(int)) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        if (!is_ignored(signal)) std::signal(signal, handler);
}

}  // namespace

int use_threads(int n_requested) {
    const char* const of_slurm = std::getenv("SLURM_CPUS_PER_TASK");
    const int slurm = of_slurm != nullptr ? std::atoi(of_slurm) : 0;
    const int n = n_requested > 0                             ? n_requested
                  : std::getenv("OMP_NUM_THREADS") != nullptr ? omp_get_max_threads()
                  : slurm > 0                                 ? slurm
                                                              : omp_get_num_procs();
    omp_set_num_threads(n);
    return n;
}

void let_waiting_threads_sleep(char** argv) {
    setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 0);
    // binding too: a thread bound to a processor when this program starts leaves the second start no other
    for (const char* set_by_user :
         {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "OMP_PROC_BIND", "OMP_PLACES", "GOMP_CPU_AFFINITY"})
        if (std::getenv(set_by_user) != nullptr) return;
    setenv("GOMP_SPINCOUNT", "1000", 0);
    execv("/proc/self/exe", argv);  // returns only where it fails, which costs speed alone
}

void end_when_interrupted() { handle_by(end_at_once); }

InterruptGuard::InterruptGuard() {
    noted = 0;
    handle_by(note);
}

InterruptGuard::~InterruptGuard() { handle_by(end_at_once); }

InterruptGuard::Lifted::Lifted() {
    handle_by(end_at_once);
    if (noted != 0) end_at_once(0);
}

InterruptGuard::Lifted::~Lifted() { handle_by(note); }

bool InterruptGuard::interrupted() { return noted != 0; }

bool is_ignored(int signal) {
    struct sigaction now {};
    return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

double free_memory() {
    const auto number_in = [](const char* file, const std::string& key, double unit) {
        std::ifstream in(file);
        for (std::string line; std::getline(in, line);)
            if (line.starts_with(key)) {
                const char* const text = line.c_str() + key.size();
                char* end = nullptr;
                const double value = std::strtod(text, &end);
                return end == text ? INFINITY : unit * value;  // "max"
            }
        return static_cast<double>(INFINITY);
    };
    const double used = number_in("/proc/self/status", "VmSize:", 1024);
    double least = number_in("/proc/meminfo", "MemAvailable:", 1024);
    if (rlimit limit{}; getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && std::isfinite(used))
        least = std::min(least, static_cast<double>(limit.rlim_cur) - used);
    const double of_group = number_in("/sys/fs/cgroup/memory.max", "", 1),
                 group_has = number_in("/sys/fs/cgroup/memory.current", "", 1);
    if (std::isfinite(of_group) && std::isfinite(group_has)) least = std::min(least, of_group - group_has);
    return least;
}

void keep_freed_memory() {
#ifdef __GLIBC__
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    mallopt(M_MMAP_THRESHOLD, 1 << 25);  // the maximum that is accepted
#endif
}

void return_freed_memory() {
#ifdef __GLIBC__
    if (mallinfo2().fordblks > std::size_t(1) << 27) malloc_trim(0);
#endif
}

}  // namespace knap
