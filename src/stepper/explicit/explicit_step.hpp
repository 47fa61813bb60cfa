#pragma once
// One step of the explicit scheme, and the motion of a node over it (central differences: velocities are those of
// mid-step):
//
//     M (v+ - v) = k (F - K u - alpha M (v + v+)/2) + H' P,     u+ = u + h v+,     k = (previous h + h)/2
//
// Damping alpha [1/s] acts at the mean velocity: it is of second order, leaves the stable step as it is, and changes
// no reaction of a fan that moves as one. With d = k alpha/2,
//
//     v+ = decay v + mobility M^-1 (k (F - K u) + H' P),     decay = (1 - d)/(1 + d),     mobility = 1/(1 + d)
//
// In a piece that nothing holds it acts on the mean velocity minus the rigid motion W of the piece (free_pieces.hpp),
// which adds (1 - decay) W to v+.
#include "base/vec.hpp"
#include "model/state.hpp"
#include "stepper/common/point_work.hpp"

#include <algorithm>
#include <cstring>
#include <span>

namespace knap {

/// x and y of a vector in one register, with arithmetic on both at once (vector extension of GCC and Clang). In long
/// loops Eigen's small vectors pass through memory instead.
using Pair = double __attribute__((vector_size(16)));

inline Pair load(const Vec2& vector) {
    Pair pair;
    std::memcpy(&pair, vector.data(), sizeof pair);
    return pair;
}
inline void store(const Pair& pair, Vec2& vector) { std::memcpy(vector.data(), &pair, sizeof pair); }

inline double dot(const Pair& a, const Pair& b) {
    const Pair products = a * b;
    return products[0] + products[1];
}

/// Position of a corner in a list of corners.
inline Index place_among(std::span<const Index> corners, Index corner) {
    return static_cast<Index>(std::ranges::find(corners, corner) - corners.begin());
}

/// As force_of; forces that do not depend on the state (a weight has one per corner) without a function call.
inline Pair force_inlined(const Model& model, const CornerLoad& corner_load, const State& state) {
    return corner_load.depends_on_state() ? load(force_of(model, corner_load, state)) : load(corner_load.force);
}

/// Impulse [N s] that changes the velocity of a mass [kg] from `before` to `after` [m/s], with the damping d [-].
inline Vec2 damped_impulse(double mass, const Vec2& before, const Vec2& after, double damping) {
    return mass * ((1 + damping) * after - (1 - damping) * before);
}

struct ExplicitStep {
    const State& begin;
    State& end;
    double drift_time, kick_time;     // [s] h, k
    const std::vector<double>& mass;  // [kg] per corner, in the order of Model::fan_corners
    const std::vector<Vec2>&
        corner_force;    // [N] F - K u per corner, where more than the block of its triangle reads it
    double damping = 0;  // [-] d
    double decay = (1 - damping) / (1 + damping);  // [-]
    double mobility = 1 / (1 + damping);           // [-]
    double obstacle_damping = 0;                   // [-] d of free obstacles
    bool large_rotation = false;                   // K u are the forces -f = grad U of Green's strain

    const std::vector<Vec2>& corner_impulse;  // [N s] per corner, of contacts between free faces; empty: there are none
    const std::vector<double>& velocity_factor;  // [-] per history: mean over the step, of a prescribed velocity
    std::span<const Rotation> frames;            // per point of split fans, none of a retired one; empty: nothing turns
    const Vec2* carried = nullptr;  // [m/s] per node: (1 - decay) W, zero where a piece is held; null: everywhere

    /// [m/s] What damping leaves of the velocity of a node, without forces.
    Vec2 damped(Index node) const {
        const Vec2 left = decay * begin.velocity[node];
        return carried == nullptr ? left : Vec2(left + carried[node]);
    }

    /// Of point i of a fan, at the start of the step.
    Rotation frame(const Model& model, Index fan, Index i) const {
        const Index rank = begin.split_rank[fan];
        if (frames.empty() || rank < 0) return point_frame(model, begin, model.points(model.fans[fan])[i]);
        return frames[begin.first_point[rank] + i];
    }

    static StepTimes times_of(const State& begin, double h) {
        return {.begin = begin.time, .h = h, .central_differences = true};
    }
    /// [m/s] v+ in the prescribed components, zero in the others; `displacement` [m] u.
    Vec2 prescribed_velocity(const Model& model, const PrescribedMotion& motion, const Vec2& displacement) const {
        Vec2 velocity = Vec2::Zero();
        for (int k = 0; k < 2; ++k)
            if (motion.component[k] && motion.is_displacement[k])
                velocity[k] = motion.rate(k, model.histories, displacement[k], times_of(begin, drift_time)).rate;
            else if (motion.component[k]) velocity[k] = motion.value[k] * velocity_factor[motion.history[k]];
        return velocity;
    }
    /// Impulse [N s] that changes the velocity of a mass [kg] from `before` to `after` [m/s], with the body's damping.
    Vec2 impulse(double mass, const Vec2& before, const Vec2& after) const {
        return damped_impulse(mass, before, after, damping);
    }
    /// The drive of component k of a prescribed motion gives to its node an impulse [N s], at the mean velocity [m/s].
    void drive(Index motion, int k, double impulse, double velocity, StepReport& report) const {
        account_drive(impulse, velocity, report);
        end.reaction[motion][k] += impulse / kick_time;
    }
    /// [s] Times a change of velocity and a force: the work of a change of the step size in the leapfrog energy.
    double change_time() const { return 0.25 * (drift_time - begin.last_step); }
};

/// Moves nodes and sums up their energies. The largest speed of the report is squared here. With large rotations U is
/// not quadratic, and the energy of the leapfrog and its defect are
///
///     E_n+1/2 = 1/2 v' M v + U_n - 1/2 f_n . Delta_n+1/2,     f = -grad U,     Delta = h v
///     rotation work = U_n - U_n-1 + 1/2 (f_n-1 + f_n) . Delta_n-1/2
///
/// of which the terms with f_n are summed here (without rotations E is the same, and the defect is zero).
class NodeMotion {
public:
    explicit NodeMotion(const ExplicitStep& step) : step_(step) {}

    /// From node `from` to node `to` with the end velocity v+ [m/s]; `force` [N] F - K u.
    void move(Index from, Index to, double mass, const Vec2& force, const Vec2& velocity) {
        with_options([&]<bool large_rotation, Damped damped, bool steady>() {
            move_to<large_rotation, damped, steady>(from, to, mass, load(force), load(velocity), sums_);
        });
    }
    /// Nodes that nothing but a force [N] acts on; a Fan has its mass and its node `fan`.
    template <class Fan>
    void move_freely(std::span<const Fan> fans, const Vec2* force) {
        with_options([&]<bool large_rotation, Damped damped, bool steady>() {
            Sums sums = sums_;
            const double response = step_.mobility * step_.kick_time, decay = step_.decay;  // [s], [-]
            const Vec2* velocity = step_.begin.velocity.data();
            for (const Fan& fan : fans) {
                const Pair f = load(*force++), v = load(velocity[fan.fan]);
                Pair left = damped == Damped::nothing ? v : decay * v;
                if constexpr (damped == Damped::vibration) left += load(step_.carried[fan.fan]);
                move_to<large_rotation, damped, steady>(fan.fan, fan.fan, fan.mass, f, left + response / fan.mass * f,
                                                        sums);
            }
            sums_ = sums;
        });
    }
    void add_to(StepReport& report) const {
        report.kinetic += sums_.kinetic;
        report.strain += sums_.strain;
        report.step_change_work += sums_.step_change_work;
        report.damping_work += sums_.damping_work;
        report.rotation_work += sums_.rotation_work;
        report.largest_speed = std::max(report.largest_speed, std::sqrt(sums_.largest_speed2));
    }

private:
    struct Sums {
        double kinetic = 0, strain = 0, step_change_work = 0, damping_work = 0, rotation_work = 0, largest_speed2 = 0;
    };
    enum class Damped { nothing, motion, vibration };  // the last one in the pieces that nothing holds
    /// Calls body<large_rotation, damped, steady>(); steady: the step has not changed.
    template <class Body>
    void with_options(const Body& body) {
        const auto with_change = [&]<bool large_rotation, Damped damped>() {
            step_.change_time() == 0 ? body.template operator()<large_rotation, damped, true>()
                                     : body.template operator()<large_rotation, damped, false>();
        };
        const auto with_damping = [&]<bool large_rotation>() {
            if (step_.damping == 0) with_change.template operator()<large_rotation, Damped::nothing>();
            else if (step_.carried == nullptr) with_change.template operator()<large_rotation, Damped::motion>();
            else with_change.template operator()<large_rotation, Damped::vibration>();
        };
        step_.large_rotation ? with_damping.template operator()<true>() : with_damping.template operator()<false>();
    }
    template <bool large_rotation, Damped damped, bool steady>
    [[gnu::always_inline]] void move_to(Index from, Index to, double mass, const Pair& force, const Pair& velocity,
                                        Sums& sums) const {
        const double h = step_.drift_time;
        const Pair before = load(step_.begin.velocity[from]), u = load(step_.begin.displacement[from]) + h * velocity;
        const double speed2 = dot(velocity, velocity);
        sums.kinetic += 0.5 * mass * speed2;
        if constexpr (large_rotation) {
            sums.strain -= 0.5 * h * dot(force, velocity);
            sums.rotation_work += 0.5 * step_.begin.last_step * dot(force, before);
        } else {
            sums.strain -= 0.5 * dot(force, u);
        }
        if constexpr (!steady) sums.step_change_work -= step_.change_time() * dot(force, velocity - before);
        if constexpr (damped == Damped::motion)
            sums.damping_work -= 0.5 * step_.damping * mass * dot(before + velocity, before + velocity);
        if constexpr (damped == Damped::vibration)  // 2 d (v + v+)/2 . ((v + v+)/2 - W)
            sums.damping_work -= 0.5 * mass *
                                 dot(before + velocity, step_.damping * (before + velocity) -
                                                            (1 + step_.damping) * load(step_.carried[from]));
        sums.largest_speed2 = std::max(sums.largest_speed2, speed2);
        store(velocity, step_.end.velocity[to]);
        store(u, step_.end.displacement[to]);
    }

    const ExplicitStep& step_;
    Sums sums_;
};

}  // namespace knap
