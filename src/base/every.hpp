#pragma once
// Multiples of an interval of time.
#include "base/vec.hpp"

#include <cmath>

namespace knap {

/// Times after the start, at the multiples of an interval [s]; never, where that is 0.
class Every {
public:
    explicit Every(double interval) : interval_(interval) {}
    void start(double time) { next_ = interval_ > 0 ? time + interval_ : infinity; }
    /// Whether one has been reached; if so, the next multiple counts from then on.
    bool advance_if_due(double time) {
        if (!(reached(time) >= next_)) return false;
        next_ = interval_ * (std::floor(reached(time) / interval_) + 1);
        return true;
    }
    void serialize(auto& archive) { archive(next_); }

private:
    static double reached(double time) { return time * (1 + 1e-12); }
    double interval_, next_ = infinity;
};

}  // namespace knap
