#include "analysis/rest_watch.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double passages = 10;
constexpr double rest_rounding = 1e-12;  // [-] kinetic energy over strain energy: that of a body which never moved
constexpr double for_ever = infinity;

/// [s] The last change of a history.
double last_change(const TimeFunction& history) {
    for (std::size_t i = history.time.size(); i > 1; --i)
        if (history.value[i - 1] != history.value[i - 2]) return history.time[i - 1];
    return -for_ever;
}

/// [s] From when on a component with this prescribed velocity stands still.
double stands_still(double velocity, const TimeFunction& history) {
    return velocity * history(for_ever) == 0 ? last_change(history) : for_ever;
}

}  // namespace

double shear_passage(const Model& model) {
    double slowest = for_ever;
    for (const Elastic& material : model.materials) slowest = std::min(slowest, material.shear_speed(model.plane));
    return bounding_box(model.mesh.vertices).diagonal() / slowest;
}

double settling_time(const Model& model) {
    double time = -for_ever;
    for (const TimeFunction& history : model.histories) time = std::max(time, last_change(history));
    for (const PrescribedMotion& motion : model.prescribed)
        for (int k = 0; k < 2; ++k)
            if (motion.component[k] && !motion.is_displacement[k])
                time = std::max(time, stands_still(motion.value[k], model.histories[motion.history[k]]));
    for (const Obstacle& obstacle : model.obstacles) {
        for (const ObstacleForce& force : obstacle.forces) time = std::max(time, last_change(force.history));
        for (const Drive& drive : obstacle.drive) {
            time = std::max(time, last_change(drive.history));
            if (drive.kind == Drive::Kind::velocity) time = std::max(time, stands_still(drive.value, drive.history));
        }
    }
    return time;
}

RestWatch::RestWatch(const Model& model, const RestOptions& options)
    : below_(options.below),
      duration_(options.duration > 0 ? options.duration : passages * shear_passage(model)),
      settled_(std::max(settling_time(model), options.not_before)),
      sleeps_(options.sleeps) {}

void RestWatch::after_step(const EnergyRow& row, std::optional<bool> lies) {
    largest_kinetic_ = std::max(largest_kinetic_, row.kinetic);
    const double strain = std::abs(row.strain),  // of a body that was only shifted it is rounding, of either sign
        small = std::max(below_ * std::min(largest_kinetic_, strain), rest_rounding * strain);
    const bool lies_still = lies.value_or(false) && row.kinetic <= below_ * largest_kinetic_,  // of free obstacles
        is_slow = row.kinetic <= small && !(sleeps_ && lies.has_value());
    const bool quiet = row.time > settled_ && (is_slow || lies_still);
    if (!quiet) since_ = std::numeric_limits<double>::quiet_NaN();
    else if (std::isnan(since_)) since_ = row.time;
    at_rest_ = quiet && (lies_still || row.time - since_ >= duration_);
}

}  // namespace knap
