#pragma once
// Whether a body has come to rest: its kinetic energy has stayed below a small part of the largest one so far, and of
// the strain energy, for as long as waves need to cross the body several times, and no load or prescribed motion has
// changed since.
#include "analysis/energy_ledger.hpp"
#include "model/model.hpp"

#include <limits>
#include <optional>

namespace knap {

struct RestOptions {
    bool ends_run = false;
    double below = 1e-3;            // [-] kinetic energy over the largest so far, and over the strain energy
    double duration = 0;            // [s] for which it must be; 0: ten passages of a shear wave across the body
    double not_before = -infinity;  // [s] the end of the last excavation
    bool sleeps = false;            // rigid pieces fall asleep where they rest
};

class RestWatch {
public:
    RestWatch(const Model& model, const RestOptions& options);

    /// `lies`: of rigid pieces, whether all are asleep, which is rest at once. Others are at rest in no other way
    /// (`RestOptions::sleeps`): the strain energy that is frozen in them tells nothing of their motion.
    void after_step(const EnergyRow& row, std::optional<bool> lies = {});

    bool at_rest() const { return at_rest_; }
    double since() const { return since_; }        // [s] the end of the first step at rest; NaN while the body moves
    double duration() const { return duration_; }  // [s]

    template <class Archive>
    void serialize(Archive& archive) {
        archive(largest_kinetic_, since_, at_rest_);
    }

private:
    double below_, duration_, settled_;
    bool sleeps_;
    double largest_kinetic_ = 0;  // [J]
    double since_ = std::numeric_limits<double>::quiet_NaN();
    bool at_rest_ = false;
};

/// [s] In which the slowest shear wave passes through all of the body.
double shear_passage(const Model& model);

/// [s] From when on no load, prescribed motion or force on an obstacle changes; infinite where something is driven at a
/// velocity for ever.
double settling_time(const Model& model);

}  // namespace knap
