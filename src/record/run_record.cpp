#include "record/run_record.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "record/outputs.hpp"
#include "record/version.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace knap {
namespace {

using Json = nlohmann::ordered_json;
using R = const RunRecord&;

Json number(double value) { return std::isfinite(value) ? Json(value + 0.0) : Json(nullptr); }  // no minus zero
const Json absent = Json(Json::value_t::discarded);                                             // is left out

std::string host() {
    char name[256] = {};
    return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// [byte] Largest resident memory of this process so far.
std::int64_t peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

Json gate_json(const Gate& gate) {
    Json json{{"name", gate.name},           {"value", number(gate.value)}, {"unit", gate.unit},
              {"limit", number(gate.limit)}, {"pass", gate.pass()},         {"level", name_of(gate.level)}};
    if (gate.warning < gate.limit) json["warning"] = number(gate.warning);
    if (gate.place) json["place_m"] = {number(gate.place->x()), number(gate.place->y())};
    json["meaning"] = gate.meaning;
    if (gate.level != GateLevel::ok) json["cure"] = gate.cure;
    return json;
}

Json expect_json(const ExpectResult& result) {
    return {{"name", result.name},
            {"value", number(result.value)},
            {"limit", result.limit},
            {"unit", unit_of("summary", result.name)},
            {"pass", result.pass}};
}

Json probe_json(const ProbeSubject& probe) {
    Json places = Json::array();
    for (const Vec2& place : probe.place) places.push_back({number(place.x()), number(place.y())});
    Json json{{"name", probe.probe}, {"watch", probe.watch}, {"took", probe.kind}};
    if (places.empty()) json["triangles"] = probe.n_triangles;
    else json["place_m"] = places, json["distance_m"] = number(probe.distance);
    return json;
}

Json collector_json(const FigureContext::Line& line) {
    if (!std::isfinite(line.from.y())) return {{"name", line.name}, {"x_m", line.from.x()}};
    return {{"name", line.name}, {"from_m", {line.from.x(), line.from.y()}}, {"to_m", {line.to.x(), line.to.y()}}};
}

template <class List, class Function>
Json list_of(const List& list, Function&& item) {
    Json all = Json::array();
    for (const auto& one : list) all.push_back(item(one));
    return all;
}

// ---- tests of what is read

bool is_text(const Json& value) { return value.is_string(); }
bool is_count(const Json& value) { return value.is_number_unsigned(); }
bool is_number(const Json& value) { return value.is_number(); }
bool is_result(const Json& value) { return value.is_number() || value.is_null(); }  // null: never happened
bool are_texts(const Json& value) { return value.is_array() && std::all_of(value.begin(), value.end(), is_text); }
bool are_results(const Json& value) { return value.is_object() && std::all_of(value.begin(), value.end(), is_result); }

template <auto is_limit>
bool are_judged(const Json& value) {
    return value.is_array() && std::all_of(value.begin(), value.end(), [](const Json& one) {
               return one.is_object() && one.contains("name") && is_text(one["name"]) && one.contains("value") &&
                      is_result(one["value"]) && one.contains("limit") && is_limit(one["limit"]) &&
                      one.contains("pass") && one["pass"].is_boolean();
           });
}
bool is_scheme(const Json& value) {
    return value.is_object() && is_text(value.value("bulk", Json())) && is_text(value.value("cohesion", Json()));
}
bool are_collectors(const Json& value) {
    const auto is_place = [](const Json& place) {
        return place.size() == 2 && is_number(place[0]) && is_number(place[1]);
    };
    return value.is_array() && std::ranges::all_of(value, [&](const Json& line) {
               return line.is_object() && is_text(line.value("name", Json())) &&
                      (is_number(line.value("x_m", Json())) ||
                       (is_place(line.value("from_m", Json::array())) && is_place(line.value("to_m", Json::array()))));
           });
}
bool are_parts(const Json& value) { return value.is_object() && is_number(value.value("output", Json())); }

/// A member of run.json: how it is written, and what the commands require of it when they read it.
struct Member {
    const char *name, *unit, *doc;
    std::function<Json(R)> write;
    bool (*test)(const Json&) = nullptr;  // null: no command reads it
    bool may_lack = false;                // not every run has it
};

const std::vector<Member>& members() {
    static const std::vector<Member> all{
        {"status", "", "starting, running, done, failed or interrupted; for `knap info` killed where no process runs",
         &RunRecord::status, is_text},
        {"reason", "", "of a failure", [](R r) { return r.reason.empty() ? absent : Json(r.reason); }},
        {"ended", "", "\"rest\" where the run ended before time.end because the body was at rest (summary.rest_time)",
         [](R r) { return r.ended.empty() ? absent : Json(r.ended); }},
        {"output_failed", "", "true where a file could not be written: the same command goes on",
         [](R r) { return r.output_failed ? Json(true) : absent; }},
        {"name", "", "of the scenario", &RunRecord::name, is_text},
        {"title", "", "of the scenario", &RunRecord::title, is_text},
        {"version", "", "of the program", [](R) { return version(); }, is_text},
        {"git", "", "hash of the source and whether it was changed",
         [](R) {
             return Json{{"hash", git_hash()}, {"dirty", git_dirty()}};
         }},
        {"compiler", "", "that built the program", [](R) { return compiler(); }},
        {"libraries", "", "versions",
         [](R) {
             Json json;
             for (const auto& [name, number] : libraries()) json[name] = number;
             return json;
         }},
        {"host", "", "name of the machine", [](R) { return host(); }},
        {"command", "", "words of the command line", &RunRecord::command},
        {"seed", "", "of all random numbers", &RunRecord::seed, is_count},
        {"threads", "", "number of threads", &RunRecord::threads},
        {"wall_s", "s", "wall-clock time of all commands that had a part in the run", [](R r) { return r.spent.wall; }},
        {"cpu_s", "s", "processor time of all threads", [](R r) { return r.spent.cpu; }, is_number},
        {"cpu_parts_s", "s", "its parts, whose sum it is: mesh_and_model, preload, steps, output, other",
         [](R r) {
             return Json{{"mesh_and_model", r.spent.model},
                         {"preload", r.spent.preload},
                         {"steps", r.spent.steps},
                         {"output", r.output.cpu},
                         {"other", r.cpu_other()}};
         },
         are_parts},
        {"cpu_output_parts_s", "s", "parts of the output: frames, figures, other",
         [](R r) {
             return Json{{"frames", r.output.frames},
                         {"figures", r.output.figures},
                         {"other", r.output.cpu - r.output.frames - r.output.figures}};
         }},
        {"frame_wait_s", "s", "wall-clock time for which steps waited for the thread that writes frames",
         [](R r) { return r.output.waited_for_frames; }},
        {"peak_memory_bytes", "byte", "largest resident memory", [](R) { return peak_memory(); }},
        {"triangles", "", "number of triangles, at the end", &RunRecord::triangles, is_count},
        {"interfaces", "", "number of interfaces, at the end", &RunRecord::interfaces},
        {"thickness_m", "m", "of the body; all energies and forces are those of this thickness", &RunRecord::thickness},
        {"steps", "", "number of accepted steps", &RunRecord::steps, is_count},
        {"step_s", "s", "planned step, the largest", &RunRecord::step, is_result},
        {"smallest_step_s", "s", "smallest accepted step", &RunRecord::smallest_step},
        {"largest_step_s", "s", "largest accepted step", &RunRecord::largest_step},
        {"cuts", "", "numbers of steps that were repeated with a smaller size, by reason",
         [](R r) {
             Json json;
             for (const CutbackReason reason : cutback_reasons)
                 json[std::string(name_of(reason))] = r.n_cutbacks[static_cast<std::size_t>(reason)];
             return json;
         },
         are_results},
        {"scheme", "", "of bulk and cohesion, theta, mass, assumption_1",
         [](R r) {
             return Json{{"bulk", name_of(r.scheme.bulk)},
                         {"cohesion", name_of(r.scheme.cohesion)},
                         {"theta", r.scheme.theta},
                         {"mass", name_of(r.scheme.mass)},
                         {"assumption_1", r.scheme.respect_assumption_1 ? "respect" : "ignore"}};
         },
         is_scheme},
        {"pieces", "",
         "with [rigid]: deformable, rigid and asleep pieces at the end; those below rigid.smallest that have points "
         "which could break, and their mass; time in which some were deformable, how many pieces became so (all at "
         "once with supports, held boundaries or free obstacles), and the number of steps that these took within "
         "steps of rigid ones (where all are deformable, steps of the run)",
         [](R r) {
             if (!r.pieces) return absent;
             Json json;
             for (const PieceState state : {PieceState::deformable, PieceState::rigid, PieceState::asleep})
                 json[name_of(state)] = r.pieces->n[static_cast<std::size_t>(state)];
             json["never_break"] = r.pieces->n_never_break, json["never_break_mass_kg"] = r.pieces->mass_never_break;
             json["deformable_time_s"] = r.pieces->thawed_time;
             json["thaws"] = r.counts.thaws, json["micro_steps"] = r.counts.micro_steps;
             return json;
         }},
        {"scheme_changes", "",
         "with bulk = \"auto\": list of the changes: time_s, to (explicit or implicit) and reason (of a change to "
         "explicit steps, a name in cuts)",
         [](R r) {
             if (r.scheme.bulk != BulkScheme::automatic) return absent;
             return list_of(r.scheme_changes, [](const SchemeChangeEvent& change) {
                 return Json{{"time_s", change.time},
                             {"to", change.to_explicit ? "explicit" : "implicit"},
                             {"reason", change.to_explicit ? name_of(change.reason) : "quiet"}};
             });
         }},
        {"linear_solves", "", "number, of the implicit bulk", [](R r) { return r.counts.linear_solves; }, is_number},
        {"factorisations", "", "number, of the implicit bulk", [](R r) { return r.counts.factorisations; }, is_number},
        {"factor", "", "unknowns and entries of the last factor",
         [](R r) {
             return Json{{"unknowns", r.factor.unknowns}, {"entries", r.factor.entries}};
         }},
        {"time_s", "s", "simulated time that was reached", &RunRecord::time},
        {"mean_edge_m", "m", "mean length of an interface", &RunRecord::mean_edge},
        {"rayleigh_speed_m_per_s", "m/s", "c_R of the first material", &RunRecord::rayleigh_speed, is_number},
        {"materials", "", "names, by region", &RunRecord::materials, are_texts},
        {"temperature_unit", "", "of all temperatures of the run, K or C, as the scenario gives them; with heat",
         [](R r) { return r.temperature_unit.empty() ? absent : Json(r.temperature_unit); }},
        {"triangle_steps_per_core_second", "1/s", "sum of the triangles of all steps over cpu_parts_s.steps",
         [](R r) { return number(r.spent.steps > 0 ? static_cast<double>(r.triangle_steps) / r.spent.steps : NAN); }},
        {"mass_scaling", "",
         "with time.mass_scaling: gain: stable step over that without it; moved: part of the mass that moved; heavier, "
         "lighter: numbers of triangles; heaviest: at most ten of them, x and y [m] and factor of the mass",
         [](R r) {
             if (!r.mass_scaling) return absent;
             Json heaviest = Json::array();
             for (const auto& [at, factor] : r.mass_scaling->heaviest)
                 heaviest.push_back({{"x", at.x()}, {"y", at.y()}, {"factor", factor}});
             return Json{{"gain", r.mass_scaling->gain},
                         {"moved", r.mass_scaling->moved},
                         {"heavier", r.mass_scaling->n_heavier},
                         {"lighter", r.mass_scaling->n_lighter},
                         {"heaviest", heaviest}};
         }},
        {"adaptation", "",
         "with [adapt]: batches: refinements; largest_batch: new triangles of one; coarse_breaks: vertices that came "
         "apart in coarse triangles; angular_momentum: its change by refinements [kg m2/s]; cpu: [s] of refinements, a "
         "part of cpu_parts_s.steps; gain: triangle-steps of a uniform mesh of adapt.size over those of the run, null "
         "where "
         "the mesh reached adapt.limit and stayed coarse",
         [](R r) {
             if (r.adaptation_gain == 0) return absent;
             return Json{{"batches", r.adaptation.batches},
                         {"largest_batch", r.adaptation.largest_batch},
                         {"coarse_breaks", r.adaptation.coarse_breaks},
                         {"angular_momentum", r.adaptation.angular_momentum},
                         {"cpu", r.adaptation.cpu},
                         {"gain", number(r.adaptation_gain)}};
         }},
        {"fan_problems", "",
         "numbers of the problems of vertices: solved, linear_solves, fallbacks, bond_checks, released; face_contacts: "
         "contacts between free faces, summed over the steps",
         [](R r) {
             return Json{{"solved", r.counts.fan_solves},       {"linear_solves", r.counts.fan_iterations},
                         {"fallbacks", r.counts.fan_fallbacks}, {"bond_checks", r.counts.bond_checks},
                         {"released", r.counts.released},       {"face_contacts", r.counts.face_contacts}};
         }},
        {"summary", "", "numbers by name, see above; null: never happened",
         [](R r) {
             Json json = Json::object();
             for (const auto& [name, value] : r.summary.values) json[name] = number(value);
             return json;
         },
         are_results},
        {"summary_units", "", "their units by name",
         [](R r) {
             Json json = Json::object();
             for (const auto& [name, value] : r.summary.values) json[name] = unit_of("summary", name);
             return json;
         }},
        {"reaction_of", "", "name of the load or obstacle of reaction_x, reaction_y and largest_reaction",
         [](R r) { return r.summary.reaction_of.empty() ? absent : Json(r.summary.reaction_of); }},
        {"gates", "", "list, see above", [](R r) { return list_of(r.gates, gate_json); }, are_judged<is_result>},
        {"expect", "", "list of the bounds of [expect]: name, value, limit, unit, pass",
         [](R r) { return list_of(r.expect, expect_json); }, are_judged<is_text>},
        {"probes", "",
         "with probes, list of what each took, at the end: name, watch, took, place_m (the place, the tip, the two "
         "ends "
         "of the interface), distance_m from its `at`",
         [](R r) { return r.probes.empty() ? absent : list_of(r.probes, probe_json); }},
        {"collectors", "", "with collectors, list of their lines: name, and from_m and to_m, or x_m of a vertical",
         [](R r) { return r.collectors.empty() ? absent : list_of(r.collectors, collector_json); }, are_collectors,
         true},
        {"figures", "", "files",
         [](R r) {
             return list_of(r.figures, [](const auto& figure) { return "figures/" + figure.filename().string(); });
         }},
        {"warnings", "", "texts", &RunRecord::warnings}};
    return all;
}

}  // namespace

OutputTable run_json_outputs() {
    OutputTable table{"run.json", "further members of this file", {}};
    for (const Member& member : members()) table.rows.push_back({member.name, member.unit, member.doc});
    return table;
}

void RunRecord::set_counts(const StepReport& counted, const StepControl& control) {
    counts = counted;
    counts.linear_solves += control.rejected_steps().linear_solves;
    counts.factorisations += control.rejected_steps().factorisations;
    smallest_step = control.smallest_taken(), largest_step = control.largest_taken();
    n_cutbacks = control.n_cutbacks();
    scheme_changes = control.changes();
}

std::string run_json(const RunRecord& record) {
    Json json;
    for (const Member& member : members())
        if (Json value = member.write(record); !value.is_discarded()) json[member.name] = std::move(value);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json read_run_json(const std::filesystem::path& run) {
    if (std::error_code none; !std::filesystem::exists(run / "run.json", none)) {
        const std::vector<std::filesystem::path> inside = runs_in(run);
        throw UserError("no-run", "`" + run.string() + "` is not a run directory: it has no run.json",
                        inside.empty()
                            ? ""
                            : "it has " + std::to_string(inside.size()) + " runs; name one, as `" +
                                  inside.front().string() + "`: `knap info " + run.string() + "` lists them");
    }
    const std::string text = read_given_file(run / "run.json", "no-run");
    const auto damaged = [&](const std::string& why) {
        return UserError("bad-run", "`" + (run / "run.json").string() + "` " + why,
                         "repeat the run, with --force in the same directory");
    };
    Json record;
    try {
        record = Json::parse(text);
    } catch (const Json::exception& error) {
        throw damaged(std::string("cannot be read: ") + error.what());
    }
    for (const Member& member : members()) {
        if (member.test == nullptr || (member.may_lack && record.is_object() && !record.contains(member.name)))
            continue;
        if (!record.is_object() || !record.contains(member.name))
            throw damaged(std::string("is not the record of a run: it has no ") + member.name);
        if (!member.test(record[member.name]))
            throw damaged(std::string("is damaged: ") + member.name + " is " +
                          record[member.name].dump(-1, ' ', true, Json::error_handler_t::replace));
    }
    return record;
}

std::vector<std::filesystem::path> runs_in(const std::filesystem::path& directory) {
    std::error_code none;
    std::vector<std::filesystem::path> runs;
    for (const auto& folder : {directory / "runs", directory})
        for (std::filesystem::directory_iterator at(folder, none), end; !none && at != end; at.increment(none))
            if (std::error_code no_file; std::filesystem::exists(at->path() / "run.json", no_file))
                runs.push_back(at->path());
    std::ranges::sort(runs);
    return runs;
}

EarlierRecord earlier_record(const std::filesystem::path& directory) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(directory / "run.json", none)) return {};
    const Json json = Json::parse(read_given_file(directory / "run.json", "unreadable-file"), nullptr, false);
    if (json.is_discarded()) return {.is_of_a_run = true};
    const auto member = [&](const char* key) { return json.is_object() && json.contains(key) ? json[key] : Json(); };
    const Json status = member("status");
    return {.is_of_a_run = !status.is_null() && !member("version").is_null(),
            .status = status.is_string() ? status.get<std::string>() : "",
            .output_failed = member("output_failed") == true};
}

}  // namespace knap
