#pragma once
// Random strength: how the strength of a piece of interface scatters, so that the strength of a body does not depend on its mesh.
//
// A piece of length l_0 has a strength of mean 1 with the survival function S_0(x). It is a chain of l_0/l pieces of length l, whose
// weakest decides, so these have S_l(x) = S_0(x)^(l/l_0). A uniform number U is the survival of the piece: x = S_0^-1(U^(l_0/l)). For
// Weibull's distribution that is x_0 (-ln U)^(1/m) (l_0/l)^(1/m). Source: W. Weibull, "A statistical theory of the strength of
// materials", Ingeniorsvetenskapsakademiens handlingar 151 (1939), from memory. Areas likewise.
#include <limits>

namespace knap {

struct Scatter {
    enum class Kind { none, weibull, normal, lognormal, uniform };
    Kind kind = Kind::none;
    double modulus = 10;     // [-] m of Weibull's distribution
    double deviation = 0.1;  // [-] standard deviation over the mean, of the others
    double length = 0;       // [m] l_0 that the mean belongs to; 0 = pieces of every length alike
    double area = 0;         // [m2] likewise, of the part of the body that an interface stands for
    double lowest = 0, highest = std::numeric_limits<double>::infinity();  // [-] of the mean: what lies outside is drawn again
    double correlation = 0;  // [m] correlation length of the field; 0 = every interface by itself
    bool of_strength = true, of_energy = false;  // what is multiplied: sigma_c, G_c

    bool any() const { return kind != Kind::none; }
};

/// S_0(x), before lowest and highest cut it.
double survival(const Scatter& scatter, double x);

/// The factor whose survival is exp(-hazard), within lowest and highest; mean 1 but for these.
double strength_factor(const Scatter& scatter, double hazard);

/// z with Q(z) = exp(-hazard), Q the survival function of the standard normal distribution, and the other way round.
double normal_quantile(double hazard);
double normal_hazard(double z);

}  // namespace knap
