#include "element/constant_strain_kernel.hpp"

namespace knap {

template double constant_strain_forces<2, StrainMeasure::small>(std::int32_t, std::int32_t, const ConstantStrainBody&,
                                                                const double*, const std::int32_t*, double*,
                                                                std::uint8_t*);
template double constant_strain_forces<2, StrainMeasure::green>(std::int32_t, std::int32_t, const ConstantStrainBody&,
                                                                const double*, const std::int32_t*, double*,
                                                                std::uint8_t*);

}  // namespace knap
