#include "element/constant_strain_kernel.hpp"

#ifdef __AVX2__
namespace knap {

template double constant_strain_forces<4, StrainMeasure::small, false>(std::int32_t, std::int32_t,
                                                                       const ConstantStrainBody&, const double*,
                                                                       const std::int32_t*, double*, std::uint8_t*,
                                                                       ViscousTriangles*);
template double constant_strain_forces<4, StrainMeasure::small, true>(std::int32_t, std::int32_t,
                                                                      const ConstantStrainBody&, const double*,
                                                                      const std::int32_t*, double*, std::uint8_t*,
                                                                      ViscousTriangles*);
template double constant_strain_forces<4, StrainMeasure::green, false>(std::int32_t, std::int32_t,
                                                                       const ConstantStrainBody&, const double*,
                                                                       const std::int32_t*, double*, std::uint8_t*,
                                                                       ViscousTriangles*);
template double constant_strain_forces<4, StrainMeasure::green, true>(std::int32_t, std::int32_t,
                                                                      const ConstantStrainBody&, const double*,
                                                                      const std::int32_t*, double*, std::uint8_t*,
                                                                      ViscousTriangles*);

}  // namespace knap
#endif
