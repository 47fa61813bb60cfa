#pragma once
// Values sorted into numbered groups by counting; within a group they keep their order.
#include "base/vec.hpp"

#include <span>
#include <vector>

namespace knap {

template <class Value>
class Grouped {
public:
    Grouped() = default;

    /// for_each(visit) calls visit(group, value) for every value. It is called twice and must visit the same values
    /// both times.
    template <class ForEach>
    Grouped(std::size_t n_groups, const ForEach& for_each) : begin_(n_groups + 1, 0) {
        for_each([&](std::size_t group, const Value&) { ++begin_[group + 1]; });
        for (std::size_t g = 1; g < begin_.size(); ++g) begin_[g] += begin_[g - 1];
        values_.resize(begin_.back());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        for_each([&](std::size_t group, const Value& value) { values_[next[group]++] = value; });
    }

    std::size_t n_groups() const { return begin_.size() - 1; }
    std::span<const Value> operator[](std::size_t group) const {
        return {values_.data() + begin_[group], values_.data() + begin_[group + 1]};
    }
    std::span<Value> operator[](std::size_t group) {
        return {values_.data() + begin_[group], values_.data() + begin_[group + 1]};
    }

private:
    std::vector<std::size_t> begin_{0};  // of each group, and the end of the last
    std::vector<Value> values_;
};

}  // namespace knap
