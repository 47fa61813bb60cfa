#pragma once
// The lists of split corners and points grow while a body breaks. They reserve the capacity for the completely broken
// body once: address space, which becomes memory where it is used. So a time step allocates nothing.
#include <cstddef>

namespace knap {

template <class... Lists>
void reserve_capacity(std::size_t n, Lists&... lists) {
    (lists.reserve(n), ...);
}

}  // namespace knap
