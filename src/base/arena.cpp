#include "base/arena.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace knap {
namespace {

constexpr std::size_t smallest_room = 32, smallest_piece = 1 << 16;  // [bytes]

/// Sizes of rooms [bytes]: 2^k and 3/4 of it, numbered 2k and 2k - 1.
int number_of_size(std::size_t n_bytes) {
    const int k = std::bit_width(n_bytes - 1);
    return n_bytes <= (std::size_t(3) << k) / 4 ? 2 * k - 1 : 2 * k;
}
std::size_t size_of_number(int number) { return number % 2 == 0 ? std::size_t(1) << number / 2 : (std::size_t(3) << (number + 1) / 2) / 4; }

}  // namespace

void Arena::enlarge(Room& room, std::size_t n_bytes) {
    if (n_bytes <= room.n_bytes) return;
    if (room.n_bytes > 0) {
        void*& last = unused_[number_of_size(room.n_bytes)];
        std::memcpy(room.first, &last, sizeof last);
        last = room.first;
    }
    const int number = number_of_size(std::max(n_bytes, smallest_room));
    room.n_bytes = size_of_number(number);
    room.first = unused_[number];
    if (room.first) std::memcpy(&unused_[number], room.first, sizeof room.first);
    else room.first = take_from_piece(room.n_bytes);
}

void* Arena::take_from_piece(std::size_t n_bytes) {
    if (n_bytes > left_) {
        left_ = std::max({n_bytes, all_ / 2, smallest_piece});
        pieces_.push_back(std::make_unique_for_overwrite<std::byte[]>(left_));
        next_ = pieces_.back().get();
        all_ += left_;
    }
    void* first = next_;
    next_ += n_bytes, left_ -= n_bytes;
    return first;
}

}  // namespace knap
