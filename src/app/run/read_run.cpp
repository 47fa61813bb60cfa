#include "app/run/read_run.hpp"

#include "base/error.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <utility>

namespace knap {
namespace {

using Json = nlohmann::ordered_json;
using Test = bool (*)(const Json&);

bool is_text(const Json& value) { return value.is_string(); }
bool is_count(const Json& value) { return value.is_number_unsigned(); }
bool is_number(const Json& value) { return value.is_number(); }
bool is_result(const Json& value) { return value.is_number() || value.is_null(); }  // null: what never happened
bool are_texts(const Json& value) { return value.is_array() && std::all_of(value.begin(), value.end(), is_text); }
bool are_results(const Json& value) { return value.is_object() && std::all_of(value.begin(), value.end(), is_result); }

bool are_judged(const Json& value, Test limit) {
    return value.is_array() && std::all_of(value.begin(), value.end(), [limit](const Json& one) {
        return one.is_object() && one.contains("name") && is_text(one["name"]) && one.contains("value") && is_result(one["value"]) && one.contains("limit") &&
               limit(one["limit"]) && one.contains("pass") && one["pass"].is_boolean();
    });
}
bool are_gates(const Json& value) { return are_judged(value, is_result); }
bool are_expectations(const Json& value) { return are_judged(value, is_text); }

/// What the commands take from run.json, all there since the first version.
constexpr std::pair<const char*, Test> wanted[] = {{"/status", is_text},
                                                   {"/name", is_text},
                                                   {"/title", is_text},
                                                   {"/version", is_text},
                                                   {"/seed", is_count},
                                                   {"/cpu_s", is_number},
                                                   {"/cpu_parts_s/output", is_number},
                                                   {"/triangles", is_count},
                                                   {"/steps", is_count},
                                                   {"/step_s", is_result},
                                                   {"/cuts", are_results},
                                                   {"/scheme/bulk", is_text},
                                                   {"/scheme/cohesion", is_text},
                                                   {"/linear_solves", is_number},
                                                   {"/factorisations", is_number},
                                                   {"/rayleigh_speed_m_per_s", is_number},
                                                   {"/materials", are_texts},
                                                   {"/summary", are_results},
                                                   {"/gates", are_gates},
                                                   {"/expect", are_expectations}};

}  // namespace

nlohmann::ordered_json read_run_json(const std::filesystem::path& run) {
    std::ifstream file(run / "run.json");
    if (!file) throw UserError("no-run", "`" + run.string() + "` is no run directory: it has no run.json that can be read");
    const auto damaged = [&](const std::string& why) {
        return UserError("bad-run", "`" + (run / "run.json").string() + "` " + why, "the run can be made again, with --force in the same place");
    };
    Json record;
    try {
        record = Json::parse(file);
    } catch (const Json::exception& error) {
        throw damaged(std::string("cannot be read: ") + error.what());
    }
    for (const auto& [path, test] : wanted) {
        const Json::json_pointer key(path);
        if (!record.is_object() || !record.contains(key)) throw damaged(std::string("is no record of a run: it has no ") + (path + 1));
        if (!test(record[key])) throw damaged(std::string("is damaged: ") + (path + 1) + " is " + record[key].dump(-1, ' ', true, Json::error_handler_t::replace));
    }
    return record;
}

}  // namespace knap
