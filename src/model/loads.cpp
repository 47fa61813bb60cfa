#include "model/loads.hpp"

#include <algorithm>

namespace knap {

double TimeFunction::operator()(double t) const {
    if (time.empty()) return 1;
    if (t <= time.front()) return value.front();
    if (t >= time.back()) return value.back();
    const std::size_t after = std::upper_bound(time.begin(), time.end(), t) - time.begin();
    const double part = (t - time[after - 1]) / (time[after] - time[after - 1]);
    return value[after - 1] + part * (value[after] - value[after - 1]);
}

double TimeFunction::slope_before(double t) const {
    if (time.empty() || t <= time.front() || t > time.back()) return 0;
    const std::size_t after = std::lower_bound(time.begin(), time.end(), t) - time.begin();
    return (value[after] - value[after - 1]) / (time[after] - time[after - 1]);
}

PrescribedRate prescribed_rate(bool is_displacement, double value, const TimeFunction& history, double displacement,
                               const StepTimes& step) {
    const double end = step.begin + step.h;
    if (is_displacement) {
        const double rate = (value * history(end) - displacement) / step.h;
        return {rate, step.central_differences ? rate : value * history.slope_before(end)};
    }
    if (step.central_differences) {
        const double velocity = value * history(step.begin + 0.5 * step.h);
        return {velocity, velocity};
    }
    return {value * (step.theta * history(end) + (1 - step.theta) * history(step.begin)), value * history(end)};
}

}  // namespace knap
