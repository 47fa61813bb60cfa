// [material.NAME], [interface.NAME] and [[support]]: which law acts between which materials and under which support.
#include "scenario/reading.hpp"
#include "scenario/specimen_strength.hpp"

#include "base/formatted.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace knap {
namespace {

std::shared_ptr<const SofteningShape> read_softening(const Table& table) {
    SofteningOptions options;
    table.fill(options);
    if (options.shape != SofteningOptions::Shape::table) return make_softening(options);
    const auto form = table.one_of({"table", "csv"}, true);
    if (form == "csv" && table.has("csv"))
        options.table = read_pairs(table, {.line = "opening, traction", .first = "openings"});
    if (!form || options.table.empty()) return nullptr;  // reported
    if (const std::string fault = fault_of_softening(options.table); !fault.empty()) {
        const std::string source = form == "csv" ? ", as read from the file of `csv`" : "";
        table.error(
            "out-of-range", "table", fault + source,
            "pairs [opening, traction] from the strength at opening 0 down to traction 0, as [[0, 3], [0.1, 1], "
            "[0.5, 0]]; interfaces are rigid up to the strength: leave out what rises to it, and points on "
            "nearly straight parts");
        return nullptr;
    }
    return make_softening(options);
}

/// [-] A law without any strength has no opening at which it is gone; a millionth breaks under a millionth of the load.
constexpr double no_strength = 1e-6;

/// friction_over_pressure, by its own key or a file; null without it.
std::shared_ptr<const FrictionOverPressure> read_over_pressure(const Table& table) {
    const auto form =
        table.one_of({"friction", "friction_table", "friction_over_pressure", "friction_csv"}, false).value_or("");
    if (form == "friction_table" || form == "friction_over_pressure" || form == "friction_csv")
        table.leave_out("friction");
    std::vector<Vec2> points;
    if (form == "friction_csv")
        points =
            read_pairs(table, {.line = "pressure, shear",
                               .first = "pressures",
                               .note = "a line of names with units, as `pressure [MPa], shear [MPa]`, then numbers",
                               .key = "friction_over_pressure",
                               .unit = "Pa",
                               .source = "friction_csv"});
    else if (form == "friction_over_pressure")
        points = table.get<std::vector<Vec2>>("friction_over_pressure").value_or(points);
    if (points.empty()) return nullptr;  // reported
    if (const std::string fault = fault_of_friction(points); !fault.empty()) {
        table.error(
            "out-of-range", "friction_over_pressure",
            fault + (form == "friction_csv" ? ", as read from the file of `friction_csv`" : ""),
            "pairs [pressure, shear] from [0, 0] on, whose slope does not grow and is not negative, as "
            "[[0, 0], [\"1 MPa\", \"1.5 MPa\"], [\"10 MPa\", \"8 MPa\"]]; shear that needs no pressure is that of "
            "the cohesion, gamma sigma_c");
        return nullptr;
    }
    return std::make_shared<FrictionOverPressure>(points);
}

/// strength_table and friction_table; null without them.
std::shared_ptr<const StrengthOfTemperature> read_of_temperature(const Table& table, bool has_cohesion) {
    StrengthOfTemperature read{.strength = read_over_temperature(table, "strength_table"),
                               .friction = read_over_temperature(table, "friction_table")};
    for (const char* key : {"strength_table", "friction_table"})
        if (table.given(key) && !table.reading().table("heat").given())
            table.error("no-heat", key, "has no effect without temperatures", cure_without_heat(table.reading()));
    if (table.given("strength_table") && !has_cohesion)
        table.error("exclusive-keys", "strength_table", "belongs to a law with cohesion, and this one has none");
    if (std::ranges::any_of(read.strength.value, [](double phi) { return !(phi >= 0 && phi <= 1); }))
        table.error("out-of-range", "strength_table", "has a factor that is not from 0 to 1",
                    "sigma_c and G_c are those of the strongest state; 0: no strength");
    for (double& phi : read.strength.value) phi = std::max(phi, no_strength);
    if (std::ranges::any_of(read.friction.value, [](double mu) { return !(mu >= 0); }))
        table.error("out-of-range", "friction_table", "has a negative friction coefficient");
    if (read.strength.empty() && read.friction.empty()) return nullptr;
    return std::make_shared<StrengthOfTemperature>(std::move(read));
}

CohesiveLaw read_law(const Table& table) {
    CohesiveLaw law;
    table.fill(law);
    if (!table.get<bool>("breakable").value_or(true)) {
        if (table.given("softening") && table.text("softening") != "linear")
            table.error("exclusive-keys", "softening", "belongs to a law that never breaks");
        if (table.given("coupling") && table.text("coupling") == "norm")
            table.error("exclusive-keys", "coupling", "belongs to a law that never breaks");
        if (table.given("unloading") && table.text("unloading") != "constant")
            table.error("exclusive-keys", "unloading", "belongs to a law that never breaks");
        for (const char* key : {"G_II", "kinetic_friction", "slip_distance", "friction_over_pressure", "friction_csv"})
            if (table.given(key)) table.error("exclusive-keys", key, "belongs to a law that never breaks");
        law.sigma_c = CohesiveLaw::unbreakable().sigma_c;
        law.over_pressure = read_over_pressure(table);
        law.of_temperature = read_of_temperature(table, false);
        return law;
    }
    const bool given = table.given("sigma_c");
    if (!given)
        table.error("missing-key", "sigma_c", "is missing",
                    "0 for contact and friction only; breakable = false for an unbreakable interface");
    law.sigma_c = table.number("sigma_c").value_or(0);
    const bool has_cohesion = !table.has("sigma_c") || law.sigma_c > 0;
    const auto energy = table.one_of({"G_c", "delta_c"}, has_cohesion && given);
    if (energy && !has_cohesion)
        table.error("exclusive-keys", *energy, "belongs to a law with cohesion, and this one has no strength");
    if ((law.over_pressure = read_over_pressure(table))) law.friction = law.over_pressure->chord(law.sigma_c);
    law.of_temperature = read_of_temperature(table, has_cohesion);
    law.softening = read_softening(table);
    if (law.softening && !has_cohesion)
        table.error("exclusive-keys", "softening", "belongs to a law with cohesion, and this one has no strength");
    if (law.relaxation_time > 0 && law.softening && std::isinf(law.softening->slope(law.softening->n_pieces() - 1)))
        table.exclude("relaxation_time", "relaxation_time", "plateau = 1",
                      "a slope at the end of the softening, for example plateau = 0.9");
    if (law.coupling == Coupling::norm) {
        const std::string cure = "gamma = 0.71 or more, or coupling = \"sum\"";
        if (!has_cohesion)
            table.error("exclusive-keys", "coupling", "belongs to a law with cohesion, and this one has no strength");
        if (law.gamma == 0) table.exclude("coupling", "coupling = \"norm\"", "gamma = 0", cure);
        if (law.softening && std::isinf(law.softening->steepest()))
            table.exclude("coupling", "coupling = \"norm\"", "plateau = 1", "plateau = 0.9, or coupling = \"sum\"");
        if (law.unloading == Unloading::vertical)
            table.exclude("coupling", "coupling = \"norm\"", "unloading = \"vertical\"",
                          "unloading = \"secant\", or coupling = \"sum\"");
        if (law.incubation_time > 0)
            table.exclude("coupling", "coupling = \"norm\"", "incubation_time",
                          "relaxation_time, or coupling = \"sum\"");
    }
    const auto needs = [&](const char* key, const char* other) {
        if (table.given(key) && !table.given(other))
            table.error("missing-key", key, std::string("has no effect without `") + other + "`", other);
    };
    needs("mode_mix", "G_II"), needs("mix_exponent", "G_II");
    needs("kinetic_friction", "slip_distance"), needs("slip_distance", "kinetic_friction");
    if (!table.given("friction_table") && !law.over_pressure) needs("kinetic_friction", "friction");
    if (table.given("G_II") && !has_cohesion)
        table.error("exclusive-keys", "G_II", "belongs to a law with cohesion, and this one has no strength");
    else if (law.has_mode_mix() && law.gamma == 0)
        table.error("out-of-range", "G_II", "is the work of slip, and with gamma = 0 slip does none", "gamma above 0");
    if (law.slip_distance > 0 && table.given("friction_table"))
        table.exclude("slip_distance", "slip_distance", "friction_table", "one of them");
    if (law.slip_distance > 0 && law.over_pressure)
        table.exclude("slip_distance", "slip_distance", "friction_over_pressure", "one of them");
    for (const char* key : {"relaxation_time", "incubation_time"})
        if (table.number(key).value_or(0) > 0 && !has_cohesion)
            table.error("exclusive-keys", key, "belongs to a law with cohesion, and this one has no strength");
    const double mean = law.softening ? 1 / law.softening->final_opening() : 0.5;  // [-] traction, up to delta_c
    law.G_c = energy == "delta_c" ? mean * law.sigma_c * table.number("delta_c").value_or(0)
                                  : table.number("G_c").value_or(0);
    return law;
}

Scatter read_scatter(const Table& law) {
    const Table table = law.table("scatter");
    Scatter scatter;
    if (!table.has("kind")) return scatter;
    table.fill(scatter);
    table.one_of({"length", "area", "correlation"}, false);
    const std::vector<std::string> of = table.texts("of");
    scatter.of_strength = std::ranges::count(of, "sigma_c") > 0;
    scatter.of_energy = std::ranges::count(of, "G_c") > 0;
    if (!law.get<bool>("breakable").value_or(true))
        table.error("exclusive-keys", "", "belongs to a law that never breaks");
    else if (law.number("sigma_c") == 0.) table.error("exclusive-keys", "", "belongs to a law without strength");
    return scatter;
}

AngleTable read_over_angle(const Table& table, const char* key) {
    AngleTable read;
    for (const Vec2& point : table.get<std::vector<Vec2>>(key).value_or(std::vector<Vec2>()))
        read.angle.push_back(point.x() * degree), read.factor.push_back(point.y());
    if (read.empty()) return read;
    const char* example = "[[0, 0.3], [30, 0.5], [90, 1]]";
    if (read.angle.size() < 2 || read.angle.front() < 0 || read.angle.back() > 90 * degree ||
        std::ranges::adjacent_find(read.angle, std::greater_equal()) != read.angle.end())
        table.error("out-of-range", key,
                    "needs at least two pairs [angle, factor] with angles that ascend, from 0 to 90 degrees",
                    std::string(key) + " = " + example);
    if (std::ranges::any_of(read.factor, [](double factor) { return !(factor > 0 && factor <= 1); }))
        table.error("out-of-range", key, "has a factor that is not above 0 and at most 1",
                    "sigma_c and G_c are those of the strongest facet");
    return read;
}

StrengthOverBedding read_over_bedding(const Table& table) {
    StrengthOverBedding over{.strength = read_over_angle(table, "strength_over_bedding"),
                             .energy = read_over_angle(table, "energy_over_bedding")};
    const char* key = over.strength.empty() ? "energy_over_bedding" : "strength_over_bedding";
    if (over.any() && !(table.number("sigma_c").value_or(0) > 0))
        table.error("exclusive-keys", key, "belongs to a law with cohesion, and this one has none");
    if (over.any() && std::ranges::none_of(table.scenario().materials, [](const NamedMaterial& material) {
            return material.elastic.bedding.has_value();
        }))
        table.error("missing-key", key, "has no effect where no material has layers", "[material.NAME.bedding]");
    if (over.energy.empty()) over.energy = over.strength;
    return over;
}

/// Places each law according to its name: the default, a pair of materials, a grain, or a free name that supports and
/// joints use.
class LawTable {
public:
    explicit LawTable(Reading& reading)
        : reading_(reading),
          laws_(reading.scenario.laws),
          of_pair_(reading.scenario.law_of_pair),
          within_(reading.scenario.law_within) {
        const std::vector<std::string> materials = reading.scenario.material_names();
        n_ = static_cast<Index>(materials.size());
        of_pair_.assign(n_, std::vector<Index>(n_, -1));
        within_.assign(n_, -1);
        const std::vector<Table> maps = reading.list("map");
        const bool with_grains =
            !reading.list("grains").empty() || reading.table("mesh").get<bool>("grains").value_or(false) ||
            std::ranges::any_of(maps, [](const Table& map) { return map.get<bool>("grains").value_or(false); });
        for (Index a = 0; a < n_; ++a) {
            for (Index b = 0; b < n_; ++b) pair_[materials[a] + "-" + materials[b]] = {a, b};
            for (Index b = a; b < n_; ++b) known_.push_back(materials[a] + "-" + materials[b]);
            if (with_grains) grain_[materials[a]] = a, known_.push_back(materials[a]);
        }
        if (with_grains) known_.emplace_back("within");
        std::vector<std::string> lists{"support", "mesh.joint", "joints", "traces", "domain.crack"};
        for (std::size_t i = 0; i < reading.list("body").size(); ++i) lists.push_back(item("body", i) + ".crack");
        for (const std::string& list : lists)
            for (const Table& table : reading.list(list)) free_names_.insert(table.text("interface"));
        for (const std::string& name : free_names_)
            if (!name.empty() && !reading.values.has("interface." + name)) missing_.push_back(name);
    }

    void read() {
        for (const Table& table : reading_.list("interface")) {
            laws_.push_back({table.name(), read_law(table), read_scatter(table), read_over_bedding(table)});
            place(table, static_cast<Index>(laws_.size()) - 1);
        }
        if (reading_.values.has("interface")) fill_pairs();  // otherwise reported as missing, or as without a name
        for (Index i = 0; i < n_; ++i)
            if (Index& law = within_[i]; law < 0) law = all_within_ >= 0 ? all_within_ : of_pair_[i][i];
    }

private:
    void place(const Table& table, Index law) {
        const std::string& name = table.name();
        if (name == "default") {
            default_ = law;
        } else if (grain_.contains(name)) {
            within_[grain_.at(name)] = law;
        } else if (!grain_.empty() && name == "within") {
            all_within_ = law;
        } else if (pair_.contains(name)) {
            const auto [a, b] = pair_.at(name);
            Index &one = of_pair_[a][b], &other = of_pair_[b][a];
            if (one >= 0) table.error("duplicate-name", "", "is the second law of this pair of materials");
            one = other = law;
        } else if (!free_names_.contains(name) &&
                   did_you_mean(name, missing_).empty()) {  // else reported where it is meant
            const std::string inside = name + "-" + name;   // of a material, whose laws have two names
            table.error("unknown-name", "", "belongs to no pair of materials and no support or joint set",
                        "known: " + first_of(known_),
                        pair_.contains(inside) ? "did you mean `" + inside + "`?" : did_you_mean(name, known_));
        }
    }

    /// Pairs without a law have the default.
    void fill_pairs() {
        std::vector<std::string> without;
        for (const auto& [names, numbers] : pair_) {
            Index& law = of_pair_[numbers.first][numbers.second];
            if (law < 0 && default_ < 0 && numbers.first <= numbers.second) without.push_back(names);
            if (law < 0) law = default_;
        }
        if (!without.empty())
            reading_.findings.error("missing-key", "no law for interfaces " + joined(without),
                                    reading_.values.place_of("interface"),
                                    "add [interface.default], with breakable = false if nothing shall break");
    }

    Reading& reading_;
    std::vector<NamedLaw>& laws_;
    std::vector<std::vector<Index>>& of_pair_;
    std::vector<Index>& within_;                    // per material
    Index n_ = 0, default_ = -1, all_within_ = -1;  // number of materials, number of these laws
    std::map<std::string, std::pair<Index, Index>> pair_;
    std::map<std::string, Index> grain_;  // material by name, if there are grains
    std::set<std::string> free_names_;
    std::vector<std::string> missing_;  // of them, those of no law
    std::vector<std::string> known_{"default"};
};

/// The number of the law that `interface` names; none, and an error, if there is no such law.
std::optional<Index> named_law(const Table& table) {
    if (!table.has("interface") || !table.reading().values.has("interface")) return std::nullopt;
    std::vector<std::string> names;
    for (const NamedLaw& named : table.scenario().laws) names.push_back(named.name);
    return table.reading().find(table.path("interface"), "interface law", table.text("interface"), names);
}

}  // namespace

/// G' of Saint-Venant's rule where none is given: 1/G' = 1/E + (1 + 2 nu')/E'.
static Bedding read_bedding(const Table& table, const Elastic& along) {
    Bedding across;
    table.fill(across);                                    // its angle where that is a number
    if (!(across.E > 0) || !(along.E > 0)) return across;  // reported
    if (!table.given("G")) across.G = 1 / (1 / along.E + (1 + 2 * across.nu) / across.E);
    // every stress must do positive work: the compliance in space is positive definite
    if (!(2 * across.nu * across.nu * along.E / across.E < 1 - along.nu))
        table.error(
            "out-of-range", "nu",
            "= " + shortest(across.nu) +
                " gives layers that do work when they are compressed: 2 nu^2 E_along/E must be below 1 - nu_along = " +
                shortest(1 - along.nu),
            "below " + shortest(std::sqrt((1 - along.nu) * across.E / along.E / 2)));
    return across;
}

void read_materials(Reading& reading) {
    std::vector<NamedMaterial>& materials = reading.scenario.materials;
    for (const Table& table : reading.list("material")) {
        if (table.name().find('-') != std::string::npos)
            table.error("bad-name", "", "has a `-` in the name of the material",
                        "- joins two materials in [interface.A-B]; use _");
        NamedMaterial& material = materials.emplace_back(NamedMaterial{.name = table.name(), .elastic = {}});
        table.fill(material.elastic);
        const Table layers = table.table("bedding");
        if (!layers.given()) continue;
        material.elastic.bedding = read_bedding(layers, material.elastic);
        material.layer_angle = read_place_field(layers, "angle", {"angle"});
        if (material.layer_angle && material.layer_angle->depends_on_time())
            layers.error("bad-formula", "angle", "depends on t, and layers do not turn", "a formula of x and y");
    }
    if (reading.values.has("material") && materials.empty())
        reading.table("material").error("missing-key", "", "has no material", "write [material.NAME]");
}

/// The key that makes the traction of a softening drop at once.
static const char* key_of_shape(const Table& table) {
    return table.given("plateau") ? "plateau" : table.given("table") ? "table" : "csv";
}

/// Laws with cohesion must have one coupling, and the scheme must know it.
static void check_coupling(Reading& reading) {
    const auto& laws = reading.scenario.laws;
    const auto is_sum = [](const NamedLaw& named) {
        return named.law.breakable() && named.law.sigma_c > 0 && named.law.coupling == Coupling::sum;
    };
    std::size_t i = 0;
    for (const Table& table : reading.list("interface")) {
        const CohesiveLaw& law = laws[i++].law;
        if (law.coupling != Coupling::norm || !law.breakable()) continue;
        if (std::ranges::any_of(laws, is_sum))
            table.exclude("coupling", "coupling = \"norm\"", "coupling = \"sum\"",
                          "the same coupling in all laws with cohesion");
        if (const double weakest = weakest_facet(law, Coupling::norm); law.gamma > 0 && weakest < 1)
            table.warning("weak", "gamma",
                          formatted("below 0.71 makes random meshes too weak with coupling = \"norm\": a facet in the "
                                    "worst direction is damaged by a tension of %.2g sigma_c",
                                    weakest),
                          "gamma = 0.71 or more");
    }
}

void check_laws(Reading& reading) {
    check_coupling(reading);
    if (!reading.scenario.time.scheme.takes_explicit_steps())
        for (const Table& table : reading.list("interface"))
            if (table.number("incubation_time").value_or(0) > 0)
                table.exclude("incubation_time", "incubation_time", "bulk = \"implicit\"",
                              "bulk = \"explicit\" or \"auto\" in [time]");
    if (reading.scenario.time.scheme.cohesion != CohesionScheme::implicit_beta) return;
    for (std::size_t k = 0; const Table& table : reading.list("interface"))
        if (const CohesiveLaw& law = reading.scenario.laws[k++].law;
            law.has_mode_mix() && law.coupling == Coupling::norm &&
            reading.scenario.time.scheme.bulk != BulkScheme::explicit_lumped)
            table.exclude("G_II", "G_II in steps of implicit bulk and cohesion", "coupling = \"norm\"",
                          "coupling = \"sum\", or bulk = \"explicit\" in [time]");
    std::size_t i = 0;
    for (const Table& table : reading.list("interface")) {
        const auto& softening = reading.scenario.laws[i++].law.softening;
        if (softening && std::isinf(softening->steepest()))
            table.exclude(key_of_shape(table), "plateau = 1",
                          reading.scenario.time.scheme.bulk == BulkScheme::automatic ? "bulk = \"auto\""
                                                                                     : "cohesion = \"implicit\"",
                          "plateau = 0.9 or a point farther on in the table, or cohesion = \"explicit\" in [time]");
    }
}

void read_laws(Reading& reading) {
    LawTable(reading).read();
    for (std::size_t joint = 0; joint < reading.joint_tables.size(); ++joint)
        reading.scenario.law_of_joint[joint] = named_law(reading.table(reading.joint_tables[joint])).value_or(-1);
    std::vector<Support>& supports = reading.scenario.supports;
    for (std::size_t i = 0; i < supports.size(); ++i) {
        const Table table = reading.table(item("support", i));
        Support& support = supports[i];
        const auto law = named_law(table);
        if (!law) continue;
        support.law = *law;
        const NamedLaw& named = reading.scenario.laws[*law];
        if (support.glued && reading.values.has("interface." + named.name + ".sigma_c") && named.law.sigma_c == 0)
            table.error("exclusive-keys", "glued", "needs cohesion, but the law `" + named.name + "` has no strength");
    }
}

}  // namespace knap
