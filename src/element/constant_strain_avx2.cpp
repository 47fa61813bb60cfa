#include "element/constant_strain_kernel.hpp"

#ifdef __AVX2__
namespace knap {

ConstantStrainForces avx2_kernel(StrainMeasure measure, bool is_viscous) { return kernel_of<4>(measure, is_viscous); }

}  // namespace knap
#endif
