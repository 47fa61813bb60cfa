#include "stepper/implicit/front_kernel_lanes.hpp"

namespace knap {

FrontKernel baseline_front_kernel() { return front_kernel_of<2>(); }

}  // namespace knap
