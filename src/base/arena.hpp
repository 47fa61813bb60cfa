#pragma once
// Memory for many lists of which now and then one grows, like the fronts of a factor round a crack that runs. A list that outgrows its room leaves it to
// the next list of that size; what is missing comes from the system in pieces of half of all memory so far. So the system is asked as often as the
// logarithm of the memory says, not as often as lists grow. What lies in the lists is never moved for the sake of others.
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace knap {

class Arena {
public:
    struct Room {
        void* first = nullptr;
        std::size_t n_bytes = 0;
    };
    /// Until it has n_bytes; what lies in it is lost if it had not.
    void enlarge(Room& room, std::size_t n_bytes);

    std::size_t n_pieces() const { return pieces_.size(); }

private:
    void* take_from_piece(std::size_t n_bytes);

    std::vector<std::unique_ptr<std::byte[]>> pieces_;
    std::byte* next_ = nullptr;         // in the last piece
    std::size_t left_ = 0, all_ = 0;    // [bytes] of it from there on, of all pieces
    std::array<void*, 128> unused_{};   // per size of room: the last one that was left, whose first bytes say which came before it
};

/// Numbers in an arena, which must outlive them.
template <class T>
class ArenaList {
public:
    /// They may have any value then.
    void resize(Arena& arena, std::size_t n) {
        arena.enlarge(room_, n * sizeof(T));
        n_ = n;
    }
    std::size_t size() const { return n_; }
    T* first() { return static_cast<T*>(room_.first); }
    const T* first() const { return static_cast<const T*>(room_.first); }
    std::span<T> entries() { return {first(), n_}; }
    std::span<const T> entries() const { return {first(), n_}; }

private:
    Arena::Room room_;
    std::size_t n_ = 0;
};

}  // namespace knap
