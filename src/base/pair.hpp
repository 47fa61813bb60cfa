#pragma once
// x and y of a vector in one register, with arithmetic on both at once (vector extension of GCC and Clang). In long
// loops Eigen's small vectors pass through memory instead.
#include "base/vec.hpp"

#include <cstring>

namespace knap {

using Pair = double __attribute__((vector_size(16)));

inline Pair load(const Vec2& vector) {
    Pair pair;
    std::memcpy(&pair, vector.data(), sizeof pair);
    return pair;
}
inline void store(const Pair& pair, Vec2& vector) { std::memcpy(vector.data(), &pair, sizeof pair); }

inline double dot(const Pair& a, const Pair& b) {
    const Pair products = a * b;
    return products[0] + products[1];
}

}  // namespace knap
