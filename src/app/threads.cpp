#include "app/threads.hpp"

#include <omp.h>
#include <unistd.h>

#include <cstdlib>

namespace knap {

int use_threads(int wanted) {
    const int n = wanted > 0 ? wanted : omp_get_num_procs();
    omp_set_num_threads(n);
    return n;
}

void let_waiting_threads_sleep(char** argv) {
    setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 0);  // VTK's own threads come on top of those that were asked for, and cost more than they save
    if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
    setenv("GOMP_SPINCOUNT", "1000", 0);
    execv("/proc/self/exe", argv);  // comes back only where that is not possible, and then nothing is lost but speed
}

}  // namespace knap
