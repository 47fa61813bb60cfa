#pragma once
// Probes: displacement and velocity of chosen places, opening and cohesion of chosen interfaces, mean stress in chosen
// boxes, stress intensity factors of chosen tips, over time. And means of the displacement at a place or along a
// boundary, which gauges of specimens use too.
#include "analysis/nearest.hpp"
#include "analysis/tip_integral.hpp"
#include "output/outputs.hpp"
#include "stepper/adapt/adaptation.hpp"

namespace knap {

/// A mean over corners: at a place, or along a boundary.
class CornerMean {
public:
    CornerMean() = default;
    /// At a place [m], with the shape functions of its triangle (mean of all of them on an edge or at a vertex), so
    /// that it is the same place on every mesh. Outside the body the nearest point of its boundary. Without the
    /// triangles that have `vanished` [0/1]; empty where all at the place have.
    CornerMean(const Mesh& mesh, const Vec2& place, std::span<const std::uint8_t> vanished = {});
    /// Along the length of a boundary; empty where the mesh has none of this name.
    CornerMean(const Mesh& mesh, const std::string& boundary);

    bool empty() const { return weights_.empty(); }
    Vec2 place(const Mesh& mesh) const;            // [m] reference
    Vec2 displacement(const State& state) const;   // [m]
    Vec2 velocity(const State& state) const;       // [m/s]
    double temperature(const State& state) const;  // [K] with heat

private:
    struct Weight {
        Index corner;
        double part;  // their sum is 1
    };
    template <class Value>
    auto mean(Value value) const;

    std::vector<Weight> weights_;
};

struct ProbeOptions {
    std::string name;
    Vec2 at = Vec2::Zero();  // [m] place, or the nearest interface that can open, or the nearest tip of a pre-crack
    enum class Watch { place, interface, stress, tip } watch = Watch::place;
    double radius = 0;       // [m] of the domain round a tip
    std::optional<Box> box;  // of the mean stress; without it of all triangles
    bool heat = false;       // with the temperature of the place
};

/// Motion of a place, and mean of an interface over its points.
struct PlaceMotion {
    Vec2 displacement, velocity;  // [m], [m/s]
    double temperature = 0;       // [K]
};
struct InterfaceMean {
    double opening = 0, slip = 0, cohesion = 0;  // [m], [m], [-]
};
/// [Pa] xx, yy, xy: mean over the initial area of triangles.
using MeanStress = Eigen::Vector3d;
/// Columns of probes.csv; the name of the probe comes first.
std::span<const Measure<PlaceMotion>> place_columns();
std::span<const Measure<InterfaceMean>> interface_columns();
std::span<const Measure<MeanStress>> stress_columns();
std::span<const Measure<TipFactors>> tip_columns();

/// The columns of one probe.
std::vector<std::string> probe_columns(const ProbeOptions& probe);

/// What a probe took.
struct ProbeSubject {
    std::string probe, watch;  // name; place, interface, stress or tip
    std::string kind;          // of an interface as in kind_of; else "place", "triangles", "tip"
    std::vector<Vec2> place;   // [m] the place, the tip, the ends of the interface; of a mean stress none
    double distance = 0;       // [m] of it from `at` of the probe
    Index n_triangles = 0;     // of a mean stress
};
/// "pre-crack from (0, 0) m to (0.1, 0) m, 0.002 m from its place"; without the distance where it is 0
std::string text_of(const ProbeSubject& subject);

class Probes {
public:
    /// Throws SimulationError where a probe watches an interface and none can open, or a box without triangles, and as
    /// TipIntegral.
    Probes(const Model& model, const std::vector<ProbeOptions>& probes);

    bool empty() const { return probes_.empty(); }
    /// The first one whose place or interface was excavated; null where none was.
    const ProbeOptions* first_lost() const;
    /// After an excavation, when only what remains at a place moves with it. Interfaces and tips stay.
    void renew();
    /// After a refinement of the mesh, to which `now` belongs. An interface that was refined, or is intact while
    /// another one is nearer now, is replaced; one that has begun to open stays. Returns what else the probes watch.
    std::vector<ProbeSubject> renumber(const State& now, const Renumbering& numbers);
    std::vector<ProbeSubject> subjects() const;

    /// At the start and at the end of every step.
    void after_step(const State& state);
    /// Columns and line of probes.csv: time, then the columns of each probe.
    std::vector<std::string> columns() const;
    std::vector<double> line(const State& state) const;

    /// What cannot be found again from the mesh.
    void serialize(auto& archive) {
        for (Probe& probe : probes_) {
            archive(probe.interface);
            if (probe.tip) archive(*probe.tip);
        }
    }

private:
    MeanStress mean_stress(const State& state, std::span<const Index> triangles) const;

    struct Probe {
        ProbeOptions options;
        CornerMean place;
        Index interface = -1;
        std::vector<Index> triangles = {};  // of a mean stress
        std::unique_ptr<TipIntegral> tip = {};
    };
    Probe placed(const ProbeOptions& probe) const;
    ProbeSubject subject(const Probe& probe) const;

    const Model& model_;
    std::vector<Probe> probes_;
};

}  // namespace knap
