#pragma once
// The surplus of specimens: the strength of a rock specimen with a random mesh over that by the law of its interfaces
// (strength_by_law). `knap calibrate --of strength` measures it and writes a table; with strength = "as measured"
// sigma_c of a scenario is that for which the law gives the strength of a specimen, and interfaces get sigma_c over the
// surplus.
#include "scenario/strength_options.hpp"
#include "scenario/surplus.hpp"
#include "scenario/toughness.hpp"

namespace knap {

/// "compression", "brazilian".
const char* test_word(SpecimenOptions::Test test);

/// A law on a mesh in a specimen, as far as the surplus depends on them.
struct TestedLaw {
    std::string test, softening, unloading;
    Index order = 1;  // of the triangles
    double gamma = 1, friction = 0;
    double zones = 0;  // size of the specimen over the process zone of a crack at rest
    double edges = 0;  // and over the finest edges that the scenario requests

    MeshedLaw meshed() const { return {softening, unloading, order, gamma, edges}; }
};
/// In a test of the table, of a specimen of `size` [m]; in tension and notched ones friction takes no part.
TestedLaw tested_law(const Scenario& scenario, const LawWithin& within, const std::string& test, double size);
/// In that of [strength].
TestedLaw tested_law(const Scenario& scenario, const LawWithin& within);

/// [-] Over sigma_c, at most 1: the least uniaxial tension that damages a facet, of all its angles.
double weakest_facet(const CohesiveLaw& law, Coupling coupling);

/// [-] How far a row is from a law in a specimen; nothing where their tests or couplings differ.
std::optional<double> distance(const TestedLaw& row, const TestedLaw& law);
/// What a row has in another way than a law, and than its specimen; sizes that differ by a factor.
std::vector<std::string> differences(const TestedLaw& row, const TestedLaw& law, double factor = same_size);

/// Why no specimen can be calibrated for a law: random or rate-dependent strength, friction over temperature. Empty: it
/// can.
std::string not_tested(const Scenario& scenario, Index law);

/// Specimens of one law on one mesh with several seeds; through: those whose load fell before the end.
struct StrengthRow {
    TestedLaw law;
    double through = 0;                 // [-] part of the specimens
    int seeds = 0;                      // specimens
    double surplus = 0, deviation = 0;  // [-] mean and standard deviation over the specimens
};

/// Lines of a table, with its header.
std::string strength_csv(const std::vector<StrengthRow>& rows);

class StrengthTable {
public:
    /// Throws UserError for a text that is no such table.
    explicit StrengthTable(const std::string& csv);

    /// Interpolated over gamma, friction and the logarithms of zones and edges; a little beyond the zones and edges of
    /// the table those. None where the table has no rows for the law.
    std::optional<Surplus> find(const TestedLaw& law) const;
    /// The row of the same test and coupling whose law and size have most in common with it, or null.
    const StrengthRow* nearest(const TestedLaw& law) const { return nearest_row(rows_, law); }
    std::span<const StrengthRow> rows() const { return rows_; }
    /// The surplus S of interfaces whose specimen has the strength that the law gives with S sigma_c. `law.zones` are
    /// those of the measured strength, and S is that of zones/S^2.
    std::optional<Surplus> of_measured(TestedLaw law) const;
    std::string nearest_text(const TestedLaw& law) const { return knap::nearest_text(rows_, law); }

private:
    std::vector<StrengthRow> rows_;
};

}  // namespace knap
