#pragma once
// Memory for many lists of which some grow now and then, like the fronts of a factor around a running crack. The block
// that a list outgrows serves the next list of that size; new memory comes from the system in pieces of growing size.
// So the number of allocations grows with the logarithm of the memory, and no list is moved for another one. Several
// threads may use it at once.
#include <algorithm>
#include <memory_resource>
#include <mutex>
#include <span>

namespace knap {

class Arena {
public:
    void* allocate(std::size_t bytes) {
        const std::scoped_lock lock(busy_);
        return blocks_.allocate(bytes);
    }
    void deallocate(void* first, std::size_t bytes) {
        const std::scoped_lock lock(busy_);
        blocks_.deallocate(first, bytes);
    }

private:
    std::mutex busy_;
    std::pmr::monotonic_buffer_resource pieces_{1 << 16};
    std::pmr::unsynchronized_pool_resource blocks_{&pieces_};
};

/// Numbers in an arena, which must outlive them.
template <class T>
class ArenaList {
public:
    /// The values are undefined afterwards. Memory is not given back.
    void resize(Arena& arena, std::size_t n) {
        if (n > capacity_) {
            if (first_) arena.deallocate(first_, capacity_ * sizeof(T));
            capacity_ = std::max(n, capacity_ + capacity_ / 4);
            first_ = static_cast<T*>(arena.allocate(capacity_ * sizeof(T)));
        }
        n_ = n;
    }
    std::size_t size() const { return n_; }
    T* first() { return first_; }
    const T* first() const { return first_; }
    std::span<T> entries() { return {first_, n_}; }
    std::span<const T> entries() const { return {first_, n_}; }

private:
    T* first_ = nullptr;
    std::size_t n_ = 0, capacity_ = 0;
};

}  // namespace knap
