#include "app/run/threads.hpp"

#include <omp.h>
#include <unistd.h>

#include <cstdlib>
#include <initializer_list>

namespace knap {

int use_threads(int wanted) {
    const int n = wanted > 0 ? wanted : omp_get_num_procs();
    omp_set_num_threads(n);
    return n;
}

void let_waiting_threads_sleep(char** argv) {
    setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 0);  // VTK's own threads come on top of those that were asked for, and cost more than they save
    // A thread that is bound to a processor when this program starts would leave the second one no other
    for (const char* set_by_user : {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "OMP_PROC_BIND", "OMP_PLACES", "GOMP_CPU_AFFINITY"})
        if (std::getenv(set_by_user) != nullptr) return;
    setenv("GOMP_SPINCOUNT", "1000", 0);
    execv("/proc/self/exe", argv);  // comes back only where that is not possible, and then nothing is lost but speed
}

}  // namespace knap
