#pragma once
// Quantities from a stress-strain curve: peak, modulus, Poisson's ratio, and the stresses at which cracks start and
// become unstable.
//
//     strength          the largest stress, if the specimen failed: after it the stress fell by a twentieth while
//                       interfaces broke. While it still rises, or where nothing broke, the largest stress is none
//     tangent modulus   least-squares slope of stress over axial strain between two parts of the peak stress, where the
//                       curve first passes them (40 and 60 %: the tangent at half of the strength of the ISRM's
//                       suggested methods, Bieniawski and Bernede 1979)
//     strain ratio      least-squares slope of -lateral over axial strain there
//     crack initiation  stress at which 1 % of the interfaces are broken that are broken at the peak (Potyondy and
//                       Cundall 2004)
//     dilatancy         compression: stress at which cracks start to increase the volume. The crack volumetric strain,
//                       i.e. the volumetric strain minus its regression line over the stress before the first break,
//                       leaves zero for good, by 1 % of its elastic range (Martin and Chandler 1994, crack initiation)
//     crack damage      compression: stress at which the volumetric strain reverses from contraction to expansion
//                       (Martin and Chandler 1994)
//
// D.O. Potyondy, P.A. Cundall, A bonded-particle model for rock, Int. J. Rock Mech. Min. Sci. 41 (2004); C.D. Martin,
// N.A. Chandler, The progressive fracture of Lac du Bonnet granite, Int. J. Rock Mech. Min. Sci. 31 (1994); Z.T.
// Bieniawski, M.J. Bernede, Suggested methods for determining the uniaxial compressive strength and deformability of
// rock materials, Int. J. Rock Mech. Min. Sci. 16 (1979).
#include "material/elastic.hpp"
#include "output/history_csv.hpp"

#include <array>
#include <limits>

namespace knap {

/// NaN where the curve does not define a value.
struct Strength {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double peak_stress = unknown, peak_strain = unknown;  // [Pa], [-] the largest stress, and the strain there
    double strength = unknown;                            // [Pa]
    double tangent_modulus = unknown, strain_ratio = unknown;
    double crack_initiation = unknown, dilatancy = unknown, crack_damage = unknown;  // [Pa]
};

/// From the columns of stress_strain.csv; `modulus_between` are parts of the peak.
Strength strength_of(const History& curve, const std::array<double, 2>& modulus_between);

/// E and nu of the material from their plane values: E = E' (1 - nu^2) and nu = nu'/(1 + nu') in plane strain, the same
/// in plane stress.
struct MaterialConstants {
    double E, nu;
};
MaterialConstants material_constants(const Strength& strength, PlaneModel plane);

}  // namespace knap
