#pragma once
// A Gaussian random field of mean 0, variance 1 and correlation exp(-(r/L)^2), the same at a place for every mesh: a sum of waves
//     z(x) = sqrt(2/n) sum cos(k_i . x + phi_i),   k_i normal with deviation sqrt(2)/L a component, phi_i uniform.
// Source: M. Shinozuka, G. Deodatis, "Simulation of multi-dimensional Gaussian stochastic fields by spectral representation", Appl. Mech.
// Rev. 49 (1996) 29; random wave vectors as in R. H. Kraichnan, Phys. Fluids 13 (1970) 22 (both from memory).
#include "base/random.hpp"
#include "base/vec.hpp"

#include <vector>

namespace knap {

class RandomField {
public:
    /// `correlation_length` L [m]
    RandomField(double correlation_length, Random& random);

    double operator()(const Vec2& x) const;

private:
    struct Wave {
        Vec2 k;        // [1/m]
        double phase;  // [rad]
    };
    std::vector<Wave> waves_;
};

}  // namespace knap
