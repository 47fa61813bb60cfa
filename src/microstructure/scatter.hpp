#pragma once
// Random strength of a piece of interface, such that the strength of a body does not depend on its mesh.
//
// A piece of length l_0 has a strength of mean 1 with the survival function S_0(x). It is a chain of l_0/l pieces of
// length l whose weakest fails first, so these have S_l(x) = S_0(x)^(l/l_0). A uniform number U is the survival of the
// piece: x = S_0^-1(U^(l_0/l)). For Weibull's distribution that is x_0 (-ln U)^(1/m) (l_0/l)^(1/m). Source: W. Weibull,
// "A statistical theory of the strength of materials", Ingeniorsvetenskapsakademiens handlingar 151 (1939), from
// memory. Areas likewise.
#include "base/random.hpp"
#include "base/vec.hpp"

#include <vector>

namespace knap {

struct Scatter {
    enum class Kind { none, weibull, normal, lognormal, uniform };
    Kind kind = Kind::none;
    double modulus = 10;     // [-] m of Weibull's distribution
    double deviation = 0.1;  // [-] standard deviation over the mean, of the others
    double length = 0;       // [m] l_0 that the mean belongs to; 0 = pieces of every length alike
    double area = 0;         // [m2] likewise, of the part of the body that an interface stands for
    double lowest = 0;       // [-] of the mean: the distribution is truncated below and above
    double highest = infinity;
    double correlation = 0;                      // [m] correlation length of the field; 0 = every interface by itself
    bool of_strength = true, of_energy = false;  // the factor multiplies sigma_c, G_c

    bool any() const { return kind != Kind::none; }
};

/// S_0(x), before the truncation.
double survival(const Scatter& scatter, double x);

/// The factor with the survival exp(-hazard), after the truncation; its mean is 1 without truncation.
double strength_factor(const Scatter& scatter, double hazard);

/// z with Q(z) = exp(-hazard), Q the survival function of the standard normal distribution, and its inverse.
double normal_quantile(double hazard);
double normal_hazard(double z);

/// A Gaussian random field of mean 0, variance 1 and correlation exp(-(r/L)^2), the same at a point for every mesh: a
/// sum of waves
///     z(x) = sqrt(2/n) sum cos(k_i . x + phi_i),   k_i normal with deviation sqrt(2)/L per component, phi_i uniform.
/// Source: M. Shinozuka, G. Deodatis, "Simulation of multi-dimensional Gaussian stochastic fields by spectral
/// representation", Appl. Mech. Rev. 49 (1996) 29; random wave vectors as in R. H. Kraichnan, Phys. Fluids 13 (1970) 22
/// (both from memory).
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
