#pragma once
// What the machine does: the two bounds of a kernel, measured on one thread by the compiler and flags of the program.

namespace knap {

struct Machine {
    double bytes;  // [1/s] of memory, by a = b + s c over three arrays that no cache holds; 24 bytes an entry
    double flops;  // [1/s] of independent multiplications and additions in registers
};

Machine measure_machine();

/// [s] Until one processor sees what another wrote: some 30 ns where they share a cache, more than 100 ns where not. NaN where there is only one.
double handover_time();

}  // namespace knap
