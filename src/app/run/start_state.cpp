#include "app/run/start_state.hpp"

#include "app/run/continuation.hpp"
#include "app/setup/process.hpp"
#include "base/checksum.hpp"
#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/stopwatch.hpp"
#include "element/shape_functions.hpp"
#include "mesh/overlap.hpp"
#include "model/body_in_obstacles.hpp"
#include "scenario/keys.hpp"
#include "stepper/common/elastic_energy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace knap {
namespace {

constexpr const char* large = "\"large\"";  // of domain.rotation
constexpr double negligible_jump = 1e-6;    // [-] of the displacement
constexpr double touches = 1e-6;            // [-] depth of an edge in an obstacle over its length, of rounding
constexpr double overlaps = 1e-3;           // [-] of the area of a triangle
constexpr double small_gain = 0.01;         // [-] of the least strength, of a stress by turns
constexpr int max_refinements = 20;         // of the mesh on which an equilibrium is found
constexpr std::size_t max_differences = 3;  // in a message

using Lines = std::map<std::string, std::string>;

/// Every key of a resolved scenario with its value.
void add_lines(const Node& node, const std::string& path, Lines& lines) {
    const bool is_list = node.type == Node::Type::array;
    const bool is_list_of_tables = is_list && !node.children.empty() && node.children[0].type == Node::Type::table;
    if (node.type != Node::Type::table && !is_list_of_tables) {
        lines[path] = toml_text(node);
        return;
    }
    if (node.children.empty()) lines[path + "."] = "given";  // a key in the table, which has no name
    for (std::size_t i = 0; i < node.children.size(); ++i)
        add_lines(node.children[i], is_list ? item(path, i) : joined_path(path, node.children[i].name), lines);
}

Lines lines_of(const std::string& scenario) {
    Node root;
    parse_toml(scenario, root);
    Lines lines;
    add_lines(root, "", lines);
    return lines;
}

/// A key that may differ between a run and the one from which it starts.
bool is_free(const std::string& path) {
    constexpr std::array tables{"load[",          "probe[",           "collector[", "specimen.",  "figure[",
                                "output.",        "limits.",          "expect.",    "study.",     "sweep.",
                                "absorb[",        "pressure[",        "time.",      "name",       "title",
                                "heat.exchange[", "heat.temperature", "heat.ramp",  "heat.table", "heat.conduction",
                                "heat.every",     "heat.time_factor"};
    constexpr std::array motions{"velocity", "displacement", "spin", "force", "ramp", "table"};
    if (path == "time.mass" || path == "time.mass_scaling") return false;
    if (path.starts_with("material.") && path.ends_with("_viscosity")) return true;  // of the scheme
    if (path.starts_with("obstacle[")) {
        const std::string key = path.substr(path.find("].") + 2);
        return std::ranges::any_of(motions, [&](const char* motion) { return key == motion; });
    }
    return std::ranges::any_of(tables, [&](const char* table) { return path.starts_with(table); });
}

const std::string& or_nothing(const Lines& lines, const std::string& key) {
    static const std::string nothing = "nothing";
    const auto found = lines.find(key);
    return found == lines.end() ? nothing : found->second;
}

/// Whether a path is that of a table, or of a key in it.
bool is_in(const std::string& path, std::string_view table) {
    return path.starts_with(table) && (path.size() == table.size() || path[table.size()] == '.');
}
bool has_table(const Lines& lines, std::string_view table) {
    const auto next = lines.lower_bound(std::string(table));
    return next != lines.end() && is_in(next->first, table);
}

/// A key of a material or law that only heat asks for.
bool is_thermal(const std::string& path) {
    constexpr std::array keys{".expansion",     ".expansion_table",     ".conductivity", ".conductivity_table",
                              ".heat_capacity", ".heat_capacity_table", ".latent_heat",  ".freezing_range"};
    return path.starts_with("material.") &&
           std::ranges::any_of(keys, [&](const char* key) { return path.ends_with(key); });
}

/// What a run assumes or has that the one from which it starts did not: it goes on with it from the same state.
struct NewAssumptions {
    bool rotation, contact, rigid;  // they are large; free faces meet; pieces may be rigid
    bool no_heat;                   // thermal strains vanish
    bool no_measured_strength;      // no sigma_c follows from that of a test, which may be any
    std::vector<bool> is_later;   // per excavation: it was after the end of the other run, and its times may be others
    std::size_t n_obstacles = 0;  // of the other run
    bool obstacles;               // more of them

    NewAssumptions(const Lines& there, const Lines& here)
        : rotation(or_nothing(there, "domain.rotation") != large && or_nothing(here, "domain.rotation") == large),
          contact(is_new(there, here, "contact")),
          rigid(is_new(there, here, "rigid")),
          no_heat(is_new(here, there, "heat")),
          no_measured_strength(or_nothing(here, "strength.meaning") == "\"of interfaces\"") {
        for (std::size_t i = 0; has_table(there, item("excavation", i)); ++i)
            is_later.push_back(std::stod(or_nothing(there, item("excavation", i) + ".at")) >=
                               std::stod(or_nothing(there, "time.end")));
        while (has_table(there, item("obstacle", n_obstacles))) ++n_obstacles;
        obstacles = has_table(here, item("obstacle", n_obstacles));
    }

    bool change_energy() const { return rotation || no_heat || obstacles; }
    bool concern(const std::string& key) const {
        return (rotation && key == "domain.rotation") || (contact && is_in(key, "contact")) ||
               (rigid && is_in(key, "rigid")) || (no_heat && (is_in(key, "heat") || is_thermal(key))) ||
               (no_measured_strength && (key == "strength.test" || key == "strength.size")) ||
               is_time_of_later_excavation(key) || (obstacles && concerns_new_obstacle(key));
    }

private:
    static bool is_new(const Lines& there, const Lines& here, std::string_view table) {
        return !has_table(there, table) && has_table(here, table);
    }
    bool is_time_of_later_excavation(const std::string& key) const {
        constexpr std::string_view list = "excavation[";
        if (!key.starts_with(list) || !(key.ends_with(".at") || key.ends_with(".ramp"))) return false;
        const std::size_t i = std::stoul(key.substr(list.size()));
        return i < is_later.size() && is_later[i];
    }
    /// The files of terrains, too.
    bool concerns_new_obstacle(const std::string& key) const {
        constexpr std::string_view list = "obstacle[";
        return is_in(key, "files") || key == "obstacle" ||
               (key.starts_with(list) && std::stoul(key.substr(list.size())) >= n_obstacles);
    }
};

/// "`mesh.size` is 0.002 there, 0.001 here"; empty where the bodies are the same.
std::string difference(const Lines& there, const Lines& here) {
    const NewAssumptions assumed(there, here);
    Lines all = there;
    all.insert(here.begin(), here.end());
    std::vector<std::string> found;
    for (const auto& [key, value] : all) {
        const std::string &was = or_nothing(there, key), &is = or_nothing(here, key);
        if (is_free(key) || assumed.concern(key) || was == is) continue;
        found.push_back("`" + (key.ends_with('.') ? key.substr(0, key.size() - 1) : key) + "` is " + was + " there, " +
                        is + " here");
    }
    const std::size_t n = found.size(), shown = std::min(n, max_differences);
    found.resize(shown);
    return joined(found, "; ") + (n > shown ? "; and " + std::to_string(n - shown) + " more" : "");
}

UserError refusal(const ReadResult& read, const std::string& text, const std::string& note) {
    return UserError({read.at("time.start", {.code = "another-body",
                                             .message = "`time.start`: the run cannot start from `" +
                                                        read.scenario.time.start_run + "`: " + text,
                                             .note = note})});
}

/// Few triangles of a refined mesh are new: those that could not be refined with the others before.
bool is_nearly_the_same(const std::vector<Index>& triangle_before) {
    return 50 * static_cast<std::size_t>(std::ranges::count(triangle_before, Index(-1))) < triangle_before.size();
}

/// Free faces that meet from now on would not find each other there.
void refuse_overlaps(const Model& model, const State& now) {
    const Mesh& mesh = model.mesh;
    std::vector<Vec2> corner;
    std::vector<Index> vertex;
    double area = 0;
    Index n = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        if (model.has_vanished(t)) continue;
        ++n, area += mesh.area(t);
        for (Index k = 0; k < 3; ++k) {
            vertex.push_back(mesh.triangles[t][k]);
            corner.push_back(place_of(model, now, mesh.corners_per_triangle() * t + k));
        }
    }
    const CoveredTwice found = find_covered_twice(corner, vertex);
    if (found.largest <= overlaps * area / static_cast<double>(n)) return;
    throw UserError(
        "overlapping-faces",
        "[contact] is new, and pieces of the other run, which passed through each other, overlap: most at " +
            place_text(found.place) + ", by " + readable(found.largest, "m2", 3),
        "[contact] in the other run, too, or a start from a moment before they met");
}

/// In the clock that begins at 0; heat keeps its place among the steps.
void set_back(State& state, double time, std::int64_t steps) {
    state.time = 0;
    state.n_steps -= steps;
    for (Incubation& incubation : state.incubation) incubation.time -= time;
    for (RigidPiece& piece : state.rigid_pieces) piece.slow_since -= time, piece.struck -= time;
    const bool same = state.temperature == state.temperature_before;
    for (SharedTemperatures* shared : {&state.temperature, &state.temperature_before}) {
        if (!*shared) continue;
        const auto moved = std::make_shared<Temperatures>(**shared);
        moved->time -= time;
        *shared = moved;
    }
    if (same) state.temperature_before = state.temperature;
}

}  // namespace

RunOrigin origin_of(const ReadResult& read) {
    RunOrigin origin{.scenario = resolved_for_run(read), .works = read.scenario.works()};
    origin.scenario += "\n[files]\n";
    for (const NamedFile& file : read.scenario.files)
        if (file.key != "time.start" && file.key != "heat.temperature")
            origin.scenario += toml_quoted(file.name) + " = " + std::to_string(checksum(file.bytes)) + "\n";
    const NamedFile* const file = read.scenario.start_file();
    if (file == nullptr) return origin;
    const RunOrigin other = MemoryReader(unpacked_checkpoint(file->bytes)).origin();
    const Lines there = lines_of(other.scenario), here = lines_of(origin.scenario);
    if (const std::string text = difference(there, here); !text.empty())
        throw refusal(
            read, text,
            "the body must be the same: only loads, motions of obstacles, [time] without mass, outputs, probes, "
            "collectors, limits and expectations may be others. Large rotations, [contact], [rigid], and obstacles "
            "behind those that were there may be added, [heat] left out where no law follows the temperature, or "
            "frozen (temperature = \"frozen\", which keeps the strengths, too); not the reverse: what has turned "
            "would be strained, what rests on free faces or obstacles would fall through them, and what is "
            "rigid has no strains. An [[excavation]] must be in both, since the mesh follows its outline: "
            "with an `at` after the end of the first run");
    origin.works.include(other.works);
    origin.works.new_assumptions |= NewAssumptions(there, here).change_energy();
    return origin;
}

StartState::StartState(const std::string& file, const RunOrigin& origin, const Scenario& scenario, Model& model,
                       Excavations& excavations, Adaptation& adaptation)
    : reader(unpacked_checkpoint(file)), control({}) {
    reader.read_motion(now, control, excavations, adaptation);
    time = now.time, n_steps = now.n_steps;
    set_back = now.n_steps - (model.heat ? now.n_steps % model.heat->every : 0);
    knap::set_back(now, time, set_back);
    excavations.set_back(time);
    adaptation.set_back(set_back);
    excavations.repeat(model);
    adaptation.repeat(model);
    now.reaction.assign(model.prescribed.size(), Vec2::Zero());  // of other loads
    const NewAssumptions assumed(lines_of(reader.origin().scenario), lines_of(origin.scenario));
    add_obstacles(model);
    if (assumed.contact) refuse_overlaps(model, now);
    if (assumed.rotation) find_gained_stress(model);
    if (model.faces_meet()) now.retired.resize(model.n_points(), Retirement::none);
    if (!model.heat) drop_heat(model);
    fit_laws(model, now);
    begin_bulk(scenario, model);
    if (scenario.time.scheme.rigid.active() && now.motion == Motion::deformable) now.motion = Motion::thawed;
    assumes_anew_ = assumed.change_energy();
    if (assumes_anew_ && model.large_rotation) {
        const LeapfrogEnergies energies = leapfrog_energies(model, now);
        now.elastic_energy = energies.elastic, now.elastic_work = energies.work;
    }
}

void StartState::add_obstacles(const Model& model) {
    n_obstacles_ = now.obstacles.size();
    for (std::size_t o = n_obstacles_; o < model.obstacles.size(); ++o)
        now.obstacles.push_back(initial_state(model.obstacles[o]));
    std::optional<EdgeInObstacle> deepest;
    for_edges_in_obstacles(model, &now, [&](const EdgeInObstacle& at) {
        const bool is_new = static_cast<std::size_t>(at.obstacle) >= n_obstacles_;
        if (is_new && at.depth > touches * at.length && (!deepest || at.depth > deepest->depth)) deepest = at;
    });
    if (!deepest) return;
    const std::string& name = model.obstacles[deepest->obstacle].name;
    throw UserError("obstacle-in-body",
                    "`" + item("obstacle", deepest->obstacle) + "`" + (name.empty() ? "" : " (" + name + ")") +
                        " overlaps the body as the other run left it, by " + readable(deepest->depth, "m") + " at " +
                        place_text(deepest->place),
                    "place it beside the body of that moment: `knap render` of the other run shows it");
}

namespace {

constexpr const char* turned_less =
    "`domain.rotation = \"large\"` in the other run, too, or a start from a moment at which it had turned less";

std::string gain_text(const StartState::StressAt& gained) {
    return "large rotations take the turns of the other run, whose rotations were small, for strains: with stresses of "
           "up to " +
           readable(gained.largest, "Pa", 3) + " at " + place_text(gained.place);
}

}  // namespace

/// G' G/2 of the displacement gradient G, of which small rotations know nothing.
void StartState::find_gained_stress(const Model& model) {
    double weakest = infinity;
    for (const CohesiveLaw& law : model.laws)
        if (law.breakable()) weakest = std::min(weakest, law.sigma_c);
    gained_stress.emplace();
    const Mesh& mesh = model.mesh;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        Eigen::Matrix2d G = Eigen::Matrix2d::Zero();
        const auto shape = shape_gradients(mesh, t);
        for (Index k = 0; k < 3; ++k)
            G += now.displacement_of(mesh.corners_per_triangle() * t + k) * shape[k].transpose();
        const double strain = 0.5 * (G.transpose() * G).diagonal().maxCoeff(),
                     stress = strain * model.elastic(t).stress_of_expansion(model.plane).cwiseAbs().maxCoeff();
        if (!model.has_vanished(t) && stress > gained_stress->largest) *gained_stress = {stress, mesh.centroid(t)};
    }
    if (gained_stress->largest > weakest)
        throw UserError("turned-body",
                        gain_text(*gained_stress) + ", where interfaces hold " + readable(weakest, "Pa", 3),
                        turned_less);
    if (!(gained_stress->largest > small_gain * std::min(weakest, model.elastic(0).E))) gained_stress.reset();
}

void StartState::drop_heat(const Model& model) {
    if (!now.temperature) return;
    lost_stress.emplace();
    const std::vector<double>& strain = now.temperature->strain;
    const auto per_triangle = static_cast<Index>(strain.size()) / model.mesh.n_triangles();
    for (std::size_t i = 0; i < strain.size(); ++i) {
        const Index t = static_cast<Index>(i) / per_triangle;
        const double prevented =
            model.elastic(t).stress_of_expansion(model.plane).cwiseAbs().maxCoeff() * std::abs(strain[i]);
        if (prevented > lost_stress->largest) *lost_stress = {prevented, model.mesh.centroid(t)};
    }
    now.temperature = now.temperature_before = nullptr;
}

/// Velocities at the end of a step, or in its middle.
void StartState::begin_bulk(const Scenario& scenario, const Model& model) {
    const SchemeOptions& scheme = scenario.time.scheme;
    if (!scheme.takes_implicit_steps()) {
        if (now.has_end_velocities()) begin_leapfrog(now);
        return;
    }
    if (scheme.takes_explicit_steps() || now.has_end_velocities() || now.last_step == 0) return;
    SchemeOptions leapfrog = scheme;
    leapfrog.bulk = BulkScheme::explicit_lumped, leapfrog.cohesion = CohesionScheme::explicit_beta;
    State closed = now;
    closing_ = MoreauJean(model, leapfrog).close_leapfrog(now, closed);
    if (closing_->rejection != Rejection::none)
        throw SimulationError("the last explicit step of `" + scenario.time.start_run +
                              "` cannot be closed, as implicit steps need it; start from a moment at which it moves "
                              "less, or with time.bulk = \"auto\"");
    closed.time = now.time, closed.n_steps = now.n_steps;
    now = std::move(closed);
}

void StartState::complete(Recorder& recorder) const {
    if (closing_) recorder.close_leapfrog(now, *closing_);
    if (assumes_anew_) recorder.assume(now, n_obstacles_);
}

State start_of(Model& model, std::optional<MoreauJean>& stepper, bool in_equilibrium, Adaptation& adaptation,
               const std::function<void()>& renew, const TellSearch& tell, RunRecord& record) {
    State start = initial_state(model);
    if (in_equilibrium) {
        const Stopwatch watch;
        const InterruptGuard::Lifted lifted;  // the search may take minutes
        try {
            State loaded = start;
            stepper->start_in_equilibrium(loaded, tell);
            for (int n = 0; n < max_refinements && adaptation.follows(); ++n) {
                std::optional<RefinedMesh> finer = adaptation.look_at_equilibrium(model, loaded);
                if (!finer ||
                    (is_nearly_the_same(finer->triangle_before) && adaptation.counts(model, loaded).coarse_breaks == 0))
                    break;
                stepper.reset();
                AdaptedModel refined = adaptation.refine(model, start, std::move(*finer));
                model = std::move(refined.model), start = std::move(refined.state);
                renew();
                stepper->start_in_equilibrium(loaded = start, tell);
            }
            start = std::move(loaded);
            const std::string damage = start_damage_text(model, start);
            if (!damage.empty()) record.warnings.push_back(damage.substr(0, damage.size() - 1));
        } catch (const SimulationError& error) {
            record.status = "failed";
            record.reason = error.what();
        }
        record.spent.preload = watch.cpu();
    }
    stepper->begin(start);
    return start;
}

std::string start_damage_text(const Model& model, const State& start) {
    int n = 0;
    double least = 1;
    Vec2 where = Vec2::Zero();
    for (std::size_t rank = 0; rank < start.split_fans.size(); ++rank) {
        const auto points = model.points(model.fans[start.split_fans[rank]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const double beta = start.points[start.first_point[rank] + j].cohesion;
            if (points[j].cracked || law_of(model, start, points[j]).sigma_c <= 0 || beta == 1) continue;
            ++n;
            if (beta < least) least = beta, where = model.mesh.corner(points[j].corner());
        }
    }
    if (n == 0) return "";
    return formatted(
               "warning[start-damage]: in the equilibrium at t = %s the forces exceed the strength of %d interface "
               "points, which have softened until it held: the cohesion beta falls by %.3g to %.3g at ",
               readable(start.time, "s", 6).c_str(), n, 1 - least, least) +
           place_text(where) + "\n";
}

std::string jumps_text(const ReadResult& read, const Model& model, const StartState& other, double step) {
    const State& start = other.now;
    std::string text;
    const auto jumps = [&](const std::string& path, const std::string& message, const std::string& note) {
        return format(read.at(
            path, {.severity = Diagnostic::Severity::warning, .code = "jump", .message = message, .note = note}));
    };
    if (other.lost_stress && other.lost_stress->largest > 0)
        text +=
            jumps("time.start",
                  formatted("without heat the thermal strains of the other run vanish, and with them up to %s at %s",
                            readable(other.lost_stress->largest, "Pa", 3).c_str(),
                            place_text(other.lost_stress->place).c_str()),
                  "[heat] with temperature = \"frozen\" keeps them");
    if (other.gained_stress) text += jumps("domain.rotation", gain_text(*other.gained_stress), turned_less);
    const auto warn = [&](const std::string& path, double is, double begins) {
        const double jump = std::abs(begins - is);
        if (jump <= negligible_jump * (std::abs(is) + std::abs(begins))) return;
        const std::string warning = jumps(
            path,
            formatted(
                "`%s` begins with %s, where the other run is at %s: in the first step of %s this is a velocity of %s",
                path.c_str(), readable(begins, "m", 9).c_str(), readable(is, "m", 9).c_str(),
                readable(step, "s").c_str(), readable(jump / step, "m/s").c_str()),
            "a table that begins there; or a velocity, which goes on from where the other run is");
        if (text.find(warning) == std::string::npos) text += warning;
    };
    std::vector<std::uint8_t> seen(2 * model.histories.size(), 0);
    for (const PrescribedMotion& motion : model.prescribed)
        for (int k = 0; k < 2; ++k) {
            const Index history = motion.history[k];
            if (!motion.component[k] || !motion.is_displacement[k] || seen[2 * history + k]++) continue;
            warn(item("load", history) + ".displacement", start.displacement[motion.fan][k],
                 motion.value[k] * model.histories[history](0));
        }
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        for (int k = 0; k < 2; ++k)
            if (const Drive& drive = model.obstacles[o].drive[k]; drive.kind == Drive::Kind::displacement)
                warn(item("obstacle", o) + ".displacement", start.obstacles[o].moved[k],
                     drive.value * drive.history(0));
    if (!start.temperature || model.heat->conduction || model.heat->field.frozen) return text;
    const SharedTemperatures begins = field_at(model, start.time);
    double jump = 0;
    for (std::size_t c = 0; c < begins->of_corner.size(); ++c)
        jump = std::max(jump, std::abs(begins->of_corner[c] - start.temperature->of_corner[c]));
    if (jump > 1e-6)
        text += jumps("heat.temperature",
                      formatted("the prescribed temperature begins up to %.3g K away from that of the other run: a "
                                "thermal shock within the first step",
                                jump),
                      "time counts from 0 again: shift the times of heat.table or of the formula");
    return text;
}

}  // namespace knap
