#include "element/constant_strain_kernel.hpp"

namespace knap {

ConstantStrainForces baseline_kernel(StrainMeasure measure, bool is_viscous) {
    return kernel_of<2>(measure, is_viscous);
}

}  // namespace knap
