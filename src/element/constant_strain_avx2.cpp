#include "element/constant_strain_kernel.hpp"

#ifdef __AVX2__
namespace knap {

ConstantStrainForces avx2_kernel(const KernelKind& kind) { return kernel_of<4>(kind); }

}  // namespace knap
#endif
