#include "app/run/run_json.hpp"

#include "app/run/version.hpp"
#include "record/outputs.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

namespace knap {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value + 0.0) : Json(nullptr); }  // no minus zero

std::string host() {
    char name[256] = {};
    return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

Json scheme(const SchemeOptions& options) {
    return {{"bulk", options.bulk == BulkScheme::explicit_lumped ? "explicit" : "implicit"},
            {"cohesion", options.cohesion == CohesionScheme::explicit_beta ? "explicit" : "implicit"},
            {"theta", options.theta},
            {"mass", name_of(options.mass)},
            {"assumption_1", options.respect_assumption_1 ? "respect" : "ignore"}};
}

Json gate_json(const Gate& gate) {
    Json json{{"name", gate.name}, {"value", number(gate.value)}, {"unit", gate.unit}, {"limit", number(gate.limit)}, {"pass", gate.pass()}};
    json["level"] = name_of(gate.level);
    if (gate.warning < gate.limit) json["warning"] = number(gate.warning);
    if (gate.place) json["place_m"] = {number(gate.place->x()), number(gate.place->y())};
    json["meaning"] = gate.meaning;
    if (gate.level != GateLevel::ok) json["cure"] = gate.cure;
    return json;
}

}  // namespace

std::int64_t peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

EarlierRecord earlier_record(const std::filesystem::path& directory) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(directory / "run.json", none)) return {};
    std::ifstream file(directory / "run.json");
    const Json json = Json::parse(file, nullptr, false);
    if (json.is_discarded()) return {.is_of_a_run = true};
    const auto recorded = [&](const char* key) { return json.is_object() && json.contains(key) ? json[key] : Json(); };
    const Json status = recorded("status");
    return {.is_of_a_run = !status.is_null() && !recorded("version").is_null(),
            .status = status.is_string() ? status.get<std::string>() : "",
            .output_failed = recorded("output_failed") == true};
}

std::string run_json(const RunRecord& record) {
    Json json;
    json["status"] = record.status;
    if (!record.reason.empty()) json["reason"] = record.reason;
    if (record.output_failed) json["output_failed"] = true;
    json["name"] = record.name;
    json["title"] = record.title;
    json["version"] = version();
    json["git"] = {{"hash", git_hash()}, {"dirty", git_dirty()}};
    json["compiler"] = compiler();
    for (const auto& [name, number] : libraries()) json["libraries"][name] = number;
    json["host"] = host();
    json["command"] = record.command;
    json["seed"] = record.seed;
    json["threads"] = record.threads;
    json["wall_s"] = record.wall;
    json["cpu_s"] = record.cpu;
    json["cpu_parts_s"] = {{"mesh_and_model", record.cpu_model},
                           {"preload", record.cpu_preload},
                           {"steps", record.cpu_steps},
                           {"output", record.cpu_output},
                           {"other", record.cpu_other()}};
    json["cpu_output_parts_s"] = {{"frames", record.cpu_frames}, {"figures", record.cpu_figures}, {"other", record.cpu_output - record.cpu_frames - record.cpu_figures}};
    json["frame_wait_s"] = record.frame_wait;
    json["peak_memory_bytes"] = peak_memory();
    json["triangles"] = record.triangles;
    json["interfaces"] = record.interfaces;
    json["thickness_m"] = record.thickness;
    json["steps"] = record.steps;
    json["step_s"] = record.step;
    json["smallest_step_s"] = record.smallest_step;
    json["largest_step_s"] = record.largest_step;
    for (const CutbackReason reason : cutback_reasons) json["cuts"][std::string(name_of(reason))] = record.n_cutbacks[static_cast<std::size_t>(reason)];
    json["scheme"] = scheme(record.scheme);
    json["linear_solves"] = record.counts.linear_solves;
    json["factorisations"] = record.counts.factorisations;
    json["factor"] = {{"unknowns", record.factor.unknowns}, {"entries", record.factor.entries}};
    json["time_s"] = record.time;
    json["mean_edge_m"] = record.mean_edge;
    json["rayleigh_speed_m_per_s"] = record.rayleigh_speed;
    json["materials"] = record.materials;
    json["triangle_steps_per_core_second"] =
        record.cpu_steps > 0 ? number(static_cast<double>(record.steps) * record.triangles / record.cpu_steps) : Json(nullptr);
    json["fan_problems"] = {{"solved", record.counts.fan_solves},
                            {"linear_solves", record.counts.fan_iterations},
                            {"fallbacks", record.counts.fan_fallbacks},
                            {"bond_checks", record.counts.bond_checks},
                            {"released", record.counts.released}};
    json["summary"] = Json::object();
    json["summary_units"] = Json::object();
    for (const auto& [name, value] : record.summary.values) json["summary"][name] = number(value), json["summary_units"][name] = unit_of("summary", name);
    if (!record.summary.reaction_of.empty()) json["reaction_of"] = record.summary.reaction_of;
    json["gates"] = Json::array();
    for (const Gate& gate : record.gates) json["gates"].push_back(gate_json(gate));
    json["expect"] = Json::array();
    for (const ExpectResult& result : record.expect)
        json["expect"].push_back(
            {{"name", result.name}, {"value", number(result.value)}, {"limit", result.limit}, {"unit", unit_of("summary", result.name)}, {"pass", result.pass}});
    json["figures"] = Json::array();
    for (const auto& figure : record.figures) json["figures"].push_back("figures/" + figure.filename().string());
    json["warnings"] = record.warnings;
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace knap
