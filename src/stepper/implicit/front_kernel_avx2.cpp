#include "stepper/implicit/front_kernel_lanes.hpp"

#ifdef __AVX2__
namespace knap {

FrontKernel avx2_front_kernel() { return front_kernel_of<4>(); }

}  // namespace knap
#endif
