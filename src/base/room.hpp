#pragma once
// Lists that grow a little in many steps rarely move if they get room for half as many again.
#include <cstddef>
#include <vector>

namespace knap {

template <class T>
void make_room(std::vector<T>& list, std::size_t n) {
    if (list.capacity() < n) list.reserve(n + n / 2);
}

template <class T>
void resize(std::vector<T>& list, std::size_t n) {
    make_room(list, n);
    list.resize(n);
}

/// n times `value`.
template <class T>
void fill(std::vector<T>& list, std::size_t n, const T& value) {
    make_room(list, n);
    list.assign(n, value);
}

template <class T>
void copy(const std::vector<T>& from, std::vector<T>& to) {
    make_room(to, from.size());
    to = from;
}

}  // namespace knap
