#include "element/constant_strain_kernel.hpp"

namespace knap {

template double constant_strain_forces<2, StrainMeasure::small, false>(std::int32_t, std::int32_t,
                                                                       const ConstantStrainBody&, const double*,
                                                                       const std::int32_t*, double*, std::uint8_t*,
                                                                       ViscousTriangles*);
template double constant_strain_forces<2, StrainMeasure::small, true>(std::int32_t, std::int32_t,
                                                                      const ConstantStrainBody&, const double*,
                                                                      const std::int32_t*, double*, std::uint8_t*,
                                                                      ViscousTriangles*);
template double constant_strain_forces<2, StrainMeasure::green, false>(std::int32_t, std::int32_t,
                                                                       const ConstantStrainBody&, const double*,
                                                                       const std::int32_t*, double*, std::uint8_t*,
                                                                       ViscousTriangles*);
template double constant_strain_forces<2, StrainMeasure::green, true>(std::int32_t, std::int32_t,
                                                                      const ConstantStrainBody&, const double*,
                                                                      const std::int32_t*, double*, std::uint8_t*,
                                                                      ViscousTriangles*);

}  // namespace knap
