#pragma once
// The surplus of a mesh: the work of the interfaces per advance of a crack along the edges of a random mesh, over G_c
// of these interfaces. `knap calibrate` measures it on strips and writes a table; with toughness = "as measured" a
// scenario gives the fracture energy of a specimen, and its interfaces get that over the surplus.
#include "base/formatted.hpp"
#include "base/text.hpp"
#include "base/vec.hpp"
#include "material/cohesive_law.hpp"
#include "scenario/surplus.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace knap {

struct Node;
struct Scenario;
class Values;

/// A law on a mesh, as far as its surplus depends on them.
struct MeshedLaw {
    std::string softening, unloading;  // "trapezoid 0.5", "constant"
    Index order = 1;                   // of the triangles
    double gamma = 1;
    double edges = 0;  // in the steep part of the process zone of a crack at rest

    /// The same law with another coupling.
    MeshedLaw with(Coupling coupling) const;
};

/// [-] The difference of two numbers >= 0 over their sum.
double apart(double a, double b);
/// [-] How far a row is from a law, those of the same kind first; nothing where their couplings differ.
std::optional<double> distance(const MeshedLaw& row, const MeshedLaw& law);
/// Edges, and process zones in a specimen, whose ratio is nearer to 1 count as the same in what a message says of them.
constexpr double same_size = 1.1;
/// What a row has in another way than a law, "softening linear", "gamma 2"; edges where they are more or fewer by a
/// factor.
std::vector<std::string> differences(const MeshedLaw& row, const MeshedLaw& law, double factor = same_size);

/// A law with cohesion that acts within a material: there cracks run along any edge.
struct LawWithin {
    Index law, material;  // of several materials the one with the shortest process zone
    double edge;          // [m] the finest that the scenario requests
    MeshedLaw meshed;
};
std::vector<LawWithin> laws_within(const Scenario& scenario, const Values& values);

/// The softening of [interface.NAME] in the words of its keys: "linear", "trapezoid 0.5".
std::string softening_words(const Node& law);

/// Keys of [interface.NAME] that `knap calibrate` leaves out of its strips and specimens: they say what the law is at a
/// place, a temperature or a direction.
inline constexpr std::array not_calibrated{"scatter", "strength_over_bedding", "energy_over_bedding", "strength_table",
                                           "friction_table"};
/// Those that it takes over, and that no row of the tables of the program has. Friction and restitution change no
/// toughness.
inline constexpr std::array without_toughness{"G_II", "relaxation_time", "incubation_time"},
    without_strength{"G_II", "relaxation_time", "slip_distance"};
/// "G_II and relaxation_time": those of them that a law is given, and are not 0.
std::string given_keys(const Node& law, std::span<const char* const> keys);

/// What a message says of a law, and the keys of [interface.NAME] that it follows from; none: it is always said.
struct ToldOfLaw {
    std::string words;
    std::vector<const char*> keys;
};
std::vector<ToldOfLaw> told_of(const MeshedLaw& law);
/// "order 1, gamma 2; by default softening linear".
std::string told_text(const Node& law, const std::vector<ToldOfLaw>& told);

/// Friction up to which the cost of a crack was measured: 0.7 changes it by 0.01 (BENCHMARKS.md, Toughness of the
/// mesh), so that the rows have none.
constexpr double most_friction_of_toughness = 0.7;

/// Strips of one law on one mesh under one load, with several seeds.
struct ToughnessRow {
    MeshedLaw law;
    double load = 0;                    // [-] energy release rate of the strip over G_c of its interfaces
    double through = 0;                 // [-] part of the strips whose crack ran through
    int seeds = 0;                      // strips
    double speed = 0;                   // [-] mean over the Rayleigh speed
    double surplus = 0, deviation = 0;  // [-] mean and standard deviation over the strips

    /// Whether four of five cracks ran through.
    bool breaks() const { return through >= least_part_through; }
};

/// Lines of a table, with its header.
std::string toughness_csv(const std::vector<ToughnessRow>& rows);

/// The row of the smallest distance, of those that have one; null: none has.
template <class Row, class Law>
const Row* nearest_row(const std::vector<Row>& rows, const Law& law) {
    const Row* nearest = nullptr;
    double least = 0;
    for (const Row& row : rows)
        if (const std::optional<double> found = distance(row.law, law); found && (!nearest || *found < least))
            nearest = &row, least = *found;
    return nearest;
}

/// "nearest row: gamma 2, 1.10 +- 0.01; rows of its coupling: 1.06 to 1.29", which tells how wrong it may be.
template <class Row, class Law>
std::string nearest_text(const std::vector<Row>& rows, const Law& law) {
    const Row* nearest = nearest_row(rows, law);
    if (!nearest) return "it has no row of its coupling whose specimens broke";
    double least = nearest->surplus, most = least;
    for (const Row& row : rows)
        if (distance(row.law, law)) least = std::min(least, row.surplus), most = std::max(most, row.surplus);
    return "nearest row: " + joined(differences(nearest->law, law)) +
           formatted(", %.2f +- %.2f; all rows of its coupling: %.2f to %.2f", nearest->surplus, nearest->deviation,
                     least, most);
}

class ToughnessTable {
public:
    /// Throws UserError for a text that is no such table. Of the rows that differ only in the load it keeps the one
    /// with the smallest load that breaks its strips: a crack as slow as the mesh allows.
    explicit ToughnessTable(const std::string& csv);

    /// Interpolated over ln(edges) and gamma; beyond the fewest and most edges of the table, up to twice, those.
    /// None where the table has no rows for the law.
    std::optional<Surplus> find(const MeshedLaw& law) const;
    /// The row whose law has most in common with one of the same coupling, or null.
    const ToughnessRow* nearest(const MeshedLaw& law) const { return nearest_row(rows_, law); }
    std::span<const ToughnessRow> rows() const { return rows_; }
    /// That of a crack at a speed over the Rayleigh speed, between the loads of the table; none beyond its speeds.
    std::optional<Surplus> at_speed(const MeshedLaw& law, double speed) const;
    /// The surplus S of interfaces for which G_c S is the measured fracture energy. `law.edges` are those of the
    /// measured energy, and S is that of edges/S.
    std::optional<Surplus> of_measured(MeshedLaw law) const;
    std::string nearest_text(const MeshedLaw& law) const { return knap::nearest_text(rows_, law); }

private:
    std::vector<ToughnessRow> rows_, all_;  // all_: of every load at which a crack ran through
};

}  // namespace knap
