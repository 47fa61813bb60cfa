#pragma once
// Lists of what is loose grow as a body breaks. Their room is taken once, for the day when all of it is loose: of address space, which becomes memory where
// it is used.
#include <cstddef>

namespace knap {

template <class... Lists>
void make_room(std::size_t n, Lists&... lists) {
    (lists.reserve(n), ...);
}

}  // namespace knap
