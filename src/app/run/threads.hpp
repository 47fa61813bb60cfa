#pragma once
// Threads of the loops (OpenMP).

namespace knap {

/// Sets the number of threads of all loops; 0 = one for each processor. Returns it.
int use_threads(int wanted);

/// Lets threads that wait for others sleep after some 25 microseconds, and VTK start none. The OpenMP runtime takes this only from the environment, before
/// main; so the program starts itself once more with it, unless the user has set a policy. Without it a run on a busy machine loses a
/// factor of ten to threads that spin while the one they wait for has no processor.
void let_waiting_threads_sleep(char** argv);

}  // namespace knap
