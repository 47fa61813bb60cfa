#include "model/mass_scaling.hpp"

#include "element/triangle_matrices.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace knap {
namespace {

constexpr double most_given = 0.25;  // [-] of the mass of a triangle: waves of many edges do not see it
constexpr int reach = 6;             // [edges]
constexpr double largest_gain = 16;  // [-]

/// Per interior edge: no mass moves over it.
std::vector<std::uint8_t> borders_of(const Model& model, const std::vector<std::vector<Vec2>>& cuts) {
    const Mesh& mesh = model.mesh;
    std::vector<std::uint8_t> is_border;
    for (std::size_t i = 0; i < mesh.interior_edges.size(); ++i) {
        const auto [a, b] = mesh.interior_edges[i].triangle;
        const Interface& interface = model.interfaces[i];
        is_border.push_back(mesh.region[a] != mesh.region[b] || interface.cracked ||
                            !(model.laws[interface.law].sigma_c > 0));
    }
    for (const std::vector<Vec2>& outline : cuts) {
        std::vector<std::uint8_t> is_in(mesh.n_triangles(), 0);
        for (const Index t : triangles_in(mesh, outline)) is_in[t] = 1;
        for (std::size_t i = 0; i < is_border.size(); ++i) {
            const auto [a, b] = mesh.interior_edges[i].triangle;
            is_border[i] |= is_in[a] ^ is_in[b];
        }
    }
    return is_border;
}

class Masses {
public:
    Masses(const Model& model, const std::vector<double>& steps, const std::vector<std::vector<Vec2>>& cuts)
        : materials_(model.materials), plane_(model.plane), mesh_(model.mesh), step_(steps) {
        const Mesh& mesh = model.mesh;
        neighbours_.assign(mesh.n_triangles(), {-1, -1, -1});
        const std::vector<std::uint8_t> is_border = borders_of(model, cuts);
        for (std::size_t i = 0; i < is_border.size(); ++i) {
            const InteriorEdge& edge = mesh.interior_edges[i];
            const auto [a, b] = edge.triangle;
            if (!is_border[i]) neighbours_[a][edge.side[0]] = b, neighbours_[b][edge.side[1]] = a;
        }
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            mass_.push_back(materials_[mesh.region[t]].density * mesh.area(t));
        by_step_.resize(mesh.n_triangles());
        std::iota(by_step_.begin(), by_step_.end(), 0);
        std::ranges::stable_sort(by_step_, {}, [&](Index t) { return step_[t]; });
        visited_in_.assign(mesh.n_triangles(), -1);
    }

    double smallest_step() const { return step_[by_step_.front()]; }

    /// Masses with which no triangle has a smaller step than `step`; none where that takes more than `most` of all.
    MassScaling for_step(double step, double most) {
        const double all = std::accumulate(mass_.begin(), mass_.end(), 0.);
        given_.assign(mass_.size(), 0);
        MassScaling found;
        std::ranges::fill(visited_in_, -1);
        for (const Index t : by_step_) {
            if (step_[t] >= step) break;
            const double need = mass_[t] * (step / step_[t] * (step / step_[t]) - 1);
            found.moved += need / all;
            if (found.moved > most || !collect(t, need, step)) return {};
            given_[t] = -need;
        }
        const StableStep stable_step(materials_, plane_);
        double smallest = infinity;
        for (Index t = 0; t < mesh_.n_triangles(); ++t) {
            found.factor.push_back(1 - given_[t] / mass_[t]);
            smallest = std::min(smallest, given_[t] == 0 ? step_[t] : stable_step(mesh_, t, found.factor[t]));
        }
        found.gain = smallest / smallest_step();
        return found;
    }

private:
    /// [kg/m] What a triangle may still give.
    double rest(Index t, double step) const {
        const double least = std::max(1 - most_given, step / step_[t] * (step / step_[t]));
        return step_[t] < step ? 0 : std::max(0., mass_[t] * (1 - least) - given_[t]);
    }

    /// Takes `need` from the triangles round t, ring by ring, in equal parts of what each of a ring has to give.
    bool collect(Index t, double need, double step) {
        ring_ = {t}, visited_in_[t] = t;
        for (int i = 0; i < reach; ++i) {
            next_.clear();
            double available = 0;
            for (const Index from : ring_)
                for (const Index to : neighbours_[from]) {
                    if (to < 0 || visited_in_[to] == t) continue;
                    visited_in_[to] = t;
                    next_.push_back(to), available += rest(to, step);
                }
            const double part = available > need ? need / available : 1;
            for (const Index from : next_) given_[from] += part * rest(from, step);
            if (available >= need) return true;
            need -= available;
            std::swap(ring_, next_);
        }
        return false;
    }

    const std::vector<Elastic>& materials_;
    PlaneModel plane_;
    const Mesh& mesh_;
    const std::vector<double>& step_;   // [s]
    std::vector<double> mass_, given_;  // [kg/m]
    std::vector<std::array<Index, 3>> neighbours_;
    std::vector<Index> by_step_, visited_in_, ring_, next_;
};

}  // namespace

MassScaling scale_masses(const Model& model, const std::vector<double>& steps,
                         const std::vector<std::vector<Vec2>>& cuts, double most, double least_gain) {
    Masses masses(model, steps, cuts);
    MassScaling best = masses.for_step(least_gain * masses.smallest_step(), most);
    if (best.factor.empty()) return {};
    double low = std::log(least_gain), high = std::log(largest_gain);  // of the gain
    for (int i = 0; i < 20; ++i) {
        const double middle = 0.5 * (low + high);
        MassScaling found = masses.for_step(std::exp(middle) * masses.smallest_step(), most);
        const bool is_possible = !found.factor.empty();
        if (is_possible && found.gain > best.gain) best = std::move(found);
        (is_possible ? low : high) = middle;
    }
    return best;
}

std::optional<MovedMass> moved_mass(const Model& model) {
    const std::vector<double>& factor = model.mass_factor;
    if (factor.empty()) return std::nullopt;
    MovedMass found{};
    double all = 0;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const double mass = model.material_mass(t);
        all += mass;
        found.n_lighter += factor[t] < 1;
        if (factor[t] <= 1) continue;
        found.moved += (factor[t] - 1) * mass;
        found.heaviest.push_back({model.mesh.centroid(t), factor[t]});
    }
    found.moved /= all;
    found.n_heavier = static_cast<Index>(found.heaviest.size());
    std::ranges::stable_sort(found.heaviest, std::greater(), &MovedMass::Place::factor);
    found.heaviest.resize(std::min<std::size_t>(found.heaviest.size(), 10));
    found.gain = std::ranges::min(stable_steps(model)) /
                 std::ranges::min(stable_steps(model.mesh, model.materials, model.plane));
    return found;
}

std::vector<double> stable_steps(const Model& model) {
    return stable_steps(model.mesh, model.materials, model.plane, model.mass_factor);
}

}  // namespace knap
