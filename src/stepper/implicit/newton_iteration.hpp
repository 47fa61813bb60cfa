#pragma once
// What the methods of an implicit step (augmented_lagrangian.hpp, active_set.hpp) work on: the iterate, Newton's linear
// system there, and the scales of the impulses and of the springs.
#include "stepper/common/step_scheme.hpp"
#include "stepper/implicit/condensed_system.hpp"
#include "stepper/implicit/newton_matrix.hpp"

#include <algorithm>

namespace knap {

/// Preliminary: tells which bonded fans open, at a part of the price. Problems of few points are solved to the end.
enum class Precision { preliminary, full };

struct SolverCounts {
    int factorisations = 0, linear_solves = 0;
    void add_to(StepReport& report) const {
        report.factorisations += factorisations, report.linear_solves += linear_solves;
    }
};

/// Unknowns of a step: rates of the nodes [m/s], and the points with their multipliers.
struct Iterate {
    std::vector<Vec2> rate;
    std::vector<ActivePoint> points;  // those of a fan in succession
};

class NewtonIteration {
public:
    /// [-] Of the scale: natural residual of the laws, and where rounding prevents more; of the laws and of the balance
    /// of a preliminary solution.
    static constexpr double law_goal = 1e-13, law_tolerance = 5e-11, preliminary_goal = 1e-4;
    static constexpr double same_move = 0.7;   // of a move of multipliers to the one before: it marches on
    static constexpr double slow_ratio = 0.3;  // of a residual to the one before

    NewtonIteration(const Model& model, const ImplicitBulk& bulk, ThetaMatrix& matrix, Iterate& iterate)
        : x(iterate), system(model, bulk, matrix, iterate.rate), newton_matrix(model, matrix), bulk_(bulk) {}

    Iterate& x;
    CondensedSystem system;
    NewtonMatrix newton_matrix;
    SolverCounts counts;
    GiveUp given_up = nullptr;
    Precision precision = Precision::full;
    double unit = 1, largest_unit = 1;  // [N s] scale of the impulses, and what contact impulses may raise it to
    double coarse_goal = 0;             // [N s] of the balance: more is in vain, since its equations change
    double final_augmentation = 0;      // [-] of the attempt: stiffness of the springs over that of the body

    void restart_from(const Iterate& iterate) {
        x = iterate;
        system.forget();
    }
    /// The springs of all points become this stiff; the multipliers stay.
    void set_augmentation(double augmentation) {
        for (ActivePoint& point : x.points) point.multipliers = point.augmented(augmentation);
        if (augmentation == augmentation_) return;
        augmentation_ = augmentation;
        newton_matrix.forget();
    }
    bool find_direction() {
        if (!newton_matrix.factorise(x.points, counts.factorisations) || !system.find_direction(x.points)) return false;
        ++counts.linear_solves;
        return true;
    }
    double residual() const {  // [N s] the largest one of free components
        const Index worst = system.worst_node();
        return worst < 0 ? 0 : system.residual(worst);
    }
    /// [N s] of the balance, for a scale of the impulses.
    double balance_goal(double of_unit) const {
        return std::max({1e-12 * of_unit, 4e-18 * final_augmentation * bulk_.largest_impulse(), coarse_goal});
    }
    bool is_preliminary() const { return precision == Precision::preliminary; }
    void give_up_if_asked() const {
        if (given_up && given_up()) throw StepGivenUp{};
    }

private:
    const ImplicitBulk& bulk_;
    double augmentation_ = 0;  // with which the matrix is factorised
};

}  // namespace knap
