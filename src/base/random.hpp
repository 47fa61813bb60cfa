#pragma once
// The only source of randomness: a counter-based stream (splitmix64; Steele, Lea, Flood 2014), the same bits on every
// machine and for every number of threads. Streams of one seed are told apart by a name.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

namespace knap {

class Random {
public:
    Random(std::uint64_t seed, std::string_view stream) : state_(seed * 0x9E3779B97F4A7C15ull + 0x632BE59BD9B4E019ull) {
        for (const char c : stream) state_ = mixed(state_ ^ static_cast<unsigned char>(c));
    }

    std::uint64_t bits() { return mixed(state_ += 0x9E3779B97F4A7C15ull); }

    /// Uniform in [0, 1), 53 bits.
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }

    /// Standard normal (Box and Muller).
    double normal() {
        const double radius = std::sqrt(-2 * std::log(1 - uniform()));  // 1 - uniform() is never zero
        return radius * std::cos(2 * std::numbers::pi * uniform());
    }

    /// Lognormal of mean 1 with this standard deviation.
    double lognormal(double deviation) {
        const double variance = std::log(1 + deviation * deviation);
        return std::exp(std::sqrt(variance) * normal() - 0.5 * variance);
    }

private:
    static std::uint64_t mixed(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

}  // namespace knap
