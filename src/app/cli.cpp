#include "app/cli.hpp"

#include "app/commands.hpp"
#include "app/ensemble/ensemble.hpp"
#include "app/run/version.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "lcp/solvers.hpp"
#include "record/outputs.hpp"
#include "scenario/findings.hpp"
#include "scenario/keys.hpp"
#include "scenario/schema.hpp"
#include "scenario/units.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <sstream>

namespace knap {
namespace {

std::string version_text() {
    std::string text = "knap " + version() + " (" + git_hash() + (git_dirty() ? ", with uncommitted changes" : "") + "), " + compiler() + "\n";
    for (const auto& [name, number] : libraries()) text += "  " + name + " " + number + "\n";
    return text;
}

/// A number with a unit of this kind, or a plain one in SI.
double quantity(const std::string& text, std::string_view unit) {
    const Quantity read = parse_quantity(text);
    if (!read.problem.empty()) throw UserError("bad-value", "`" + text + "`: " + read.problem);
    if (!std::isfinite(read.value)) throw UserError("bad-value", "`" + text + "` is not finite");
    if (!read.unit.empty() && read.dimension != dimension_of(unit))
        throw UserError("wrong-unit", "`" + text + "` is " + kind_name(read.dimension) + ", wanted is " + kind_name(dimension_of(unit)));
    return read.value;
}

/// "a,b" -> ["a", "b"]
std::string list_of_texts(const std::string& text) {
    if (text.empty()) return "";
    std::string list = "[\"";
    for (const char c : text) list += c == ',' ? std::string("\", \"") : std::string(1, c);
    return list + "\"]";
}

std::vector<std::string> words(int argc, char** argv) { return {argv, argv + argc}; }

/// What the help says of the value of an option that sets a key; the scenario checks it. Completion reads it there.
std::string words_of(const char* key) { return "TEXT:{" + CLI::detail::join(find_key(key)->words, ",") + "}"; }

const char* const path = "PATH";  // completion offers files for such values only

}  // namespace

int run_command_line(int argc, char** argv) {
    CLI::App app{"knap: 2D dynamic fracture with nonsmooth cohesive interfaces on every edge of the mesh", "knap"};
    app.set_version_flag("--version", version_text);
    app.require_subcommand(1);
    app.fallthrough(false);

    std::string scenario;
    std::vector<std::string> overrides;
    std::function<int()> chosen;
    const auto add = [&](const char* name, const char* help, auto&& action) {
        CLI::App* command = app.add_subcommand(name, help);
        command->callback([&chosen, action] { chosen = action; });
        return command;
    };
    const auto takes_scenario = [&](CLI::App* command) {
        command->add_option("scenario", scenario, "a scenario file, or the name of a built-in one")->required();
        command->add_option("-s,--set", overrides, "KEY=VALUE instead of what the file says, as in mesh.size=\"2 mm\"; may be repeated")->allow_extra_args(false);
    };
    const auto read = [&] { return open_scenario(scenario, overrides); };

    RunOptions run{.command = words(argc, argv)};
    std::string until, dump_lcp;
    CLI::App* run_command = add("run", "simulate a scenario, figures included", [&] {
        if (!until.empty()) run.until = quantity(until, "s");
        if (!dump_lcp.empty()) run.dump_lcp = StepSelection::parse(dump_lcp);
        return run_scenario(read(), run);
    });
    takes_scenario(run_command);
    run_command->add_option("-o,--output", run.output, "directory of the run; default runs/<name>")->type_name(path);
    run_command->add_option("-j,--threads", run.threads, "threads; default all. Results do not depend on it")->check(CLI::Range(1, 1024));
    run_command->add_option("--until", until, "end earlier, as in 20us");
    run_command->add_flag("--force", run.force, "replace an earlier run");
    run_command->add_option("--dump-lcp", dump_lcp, "store the complementarity problems of these steps in <run>/lcp: 10,20 or 10:5:40 (every fifth)");
    run_command->add_flag("-q,--quiet", run.quiet, "no progress line");

    BatchOptions study{.program = argv[0]}, sweep = study;
    std::string refine, levels, schemes, reference;
    int n_seeds = 0;
    std::vector<std::string> quantities;
    CLI::App* study_command = add("study", "refine step or mesh, change the scheme or the seed; errors, orders, cost", [&] {
        const auto set = [&](const char* key, const std::string& value) {
            if (!value.empty()) overrides.push_back(std::string("study.") + key + "=" + value);
        };
        set("refine", refine);
        set("levels", levels.empty() ? "" : "[" + levels + "]");
        set("seeds", n_seeds > 0 ? std::to_string(n_seeds) : "");
        set("schemes", list_of_texts(schemes));
        set("reference", reference);
        std::string list;
        for (const std::string& of : quantities) list += (list.empty() ? "{ of = \"" : ", { of = \"") + of + "\" }";
        set("quantity", list.empty() ? "" : "[" + list + "]");
        return run_ensemble(plan_study(scenario, overrides), scenario, study);
    });
    takes_scenario(study_command);
    study_command->add_option("--refine", refine, "what a level divides")->option_text(words_of("study.refine"));
    study_command->add_option("--levels", levels, "the divisors, as in 1,2,4,8");
    study_command->add_option("--seeds", n_seeds, "statistics over so many seeds")->check(CLI::Range(2, 10000));
    study_command->add_option("--schemes", schemes, "pairs bulk/cohesion, as in explicit/explicit,implicit/implicit, or all")->option_text(words_of("study.schemes"));
    study_command->add_option("--reference", reference, "what errors are taken from; finest: the finest run")->option_text(words_of("study.reference"));
    study_command->add_option("--quantity", quantities, "number of the summary that is compared; may be repeated")->allow_extra_args(false);
    study_command->add_option("-o,--output", study.output, "directory of the study; default studies/<name>")->type_name(path);
    study_command->add_option("-j,--jobs", study.n_at_once, "runs at the same time, of one thread each")->check(CLI::Range(1, 1024));
    study_command->add_flag("--force", study.force, "repeat finished runs, replace those of another study");
    study_command->add_flag("-q,--quiet", study.quiet, "no line for every run");

    std::string seeds;
    CLI::App* sweep_command = add("sweep", "all combinations of values of keys and seeds: table, statistics, contact sheet", [&] {
        for (const std::string& set : seed_overrides(seeds)) overrides.push_back(set);
        return run_ensemble(plan_sweep(scenario, overrides), scenario, sweep);
    });
    sweep_command->add_option("scenario", scenario, "a scenario file, or the name of a built-in one")->required();
    sweep_command->add_option("-s,--set", overrides, "KEY=VALUE,VALUE,...: every value, with all values of the others; may be repeated")->allow_extra_args(false);
    sweep_command->add_option("--seeds", seeds, "20: so many, from the scenario's seed on; or 1..20");
    sweep_command->add_option("-o,--output", sweep.output, "directory of the sweep; default sweeps/<name>")->type_name(path);
    sweep_command->add_option("-j,--jobs", sweep.n_at_once, "runs at the same time, of one thread each")->check(CLI::Range(1, 1024));
    sweep_command->add_flag("--force", sweep.force, "repeat finished runs, replace those of another sweep");
    sweep_command->add_flag("-q,--quiet", sweep.quiet, "no line for every run");
    for (const auto& [command, options] : {std::pair{study_command, &study}, std::pair{sweep_command, &sweep}})
        command->add_flag("--print-commands", options->print_commands, "run nothing, print a command line for each run that is to be done");

    bool full = false, strict = false, time = false;
    CLI::App* check_command = add("check", "read and mesh a scenario, say what would happen", [&] { return check_scenario(read(), full, strict, time); });
    takes_scenario(check_command);
    check_command->add_flag("--full", full, "print every key with its value and where it came from");
    check_command->add_flag("--strict", strict, "warnings are errors");
    check_command->add_flag("--time", time, "measure the first steps longer");

    std::filesystem::path output;
    bool force = false;
    CLI::App* mesh_command = add("mesh", "only make and judge the mesh", [&] { return mesh_scenario(read(), output, force); });
    takes_scenario(mesh_command);
    mesh_command->add_option("-o,--output", output, "write it: .msh, .vtu or .svg")->type_name(path);
    mesh_command->add_flag("--force", force, "replace an existing file");

    std::filesystem::path directory;
    FigureOptions figure{.show = ""};
    std::vector<std::string> at, box, range;
    CLI::App* render_command = add("render", "draw figures from a finished run", [&] {
        if (figure.file.empty()) figure.file = figure.show + ".png";
        for (const std::string& text : at) figure.at.push_back(quantity(text, "s"));
        for (const std::string& text : range) figure.range.push_back(quantity(text, unit_of_figure(figure.show, figure.colour)));
        if (!box.empty())
            figure.box = Box{{quantity(box[0], "m"), quantity(box[1], "m")}, {quantity(box[2], "m"), quantity(box[3], "m")}};
        return render_run(directory, figure, output);
    });
    render_command->add_option("run", directory, "run directory")->required();
    render_command->add_option("--show", figure.show, "what to draw; without it the figures of the scenario")->check(CLI::IsMember(figure_subjects()));
    render_command->add_option("--file", figure.file, "name of the picture: .png, .svg or .pdf");
    render_command->add_option("--at", at, "times, as in 40us");
    render_command->add_option("--colour", figure.colour, "of cracks")->check(CLI::IsMember(figure_colours()));
    render_command->add_option("--over", figure.over, "what reactions are drawn over")->check(CLI::IsMember(figure_abscissas()));
    render_command->add_option("--aspect", figure.aspect, "how much larger the short side is drawn than the long one");
    render_command->add_option("--deform", figure.deform, "exaggeration of the displacement");
    render_command->add_option("--range", range, "colour range, two values with units")->expected(2);
    render_command->add_option("--box", box, "part of the body: xmin ymin xmax ymax")->expected(4);
    render_command->add_option("--width", figure.width, "pixels")->check(CLI::Range(200, 20000));
    render_command->add_option("-o,--output", output, "directory for the pictures; default <run>/rendered")->type_name(path);

    std::vector<std::filesystem::path> runs;
    bool json = false, csv = false;
    CLI::App* info_command = add("info", "what runs were and what they found", [&] {
        return show_runs(runs, csv ? RunFormat::csv : json ? RunFormat::json : RunFormat::text);
    });
    info_command->add_option("runs", runs, "run directories")->required();
    info_command->add_flag("--json", json, "as JSON");
    info_command->add_flag("--csv", csv, "as a table, one line a run");

    std::string name;
    CLI::App* new_command = add("new", "write a scenario to start from", [&] { return write_new_scenario(name, force); });
    new_command->add_option("name", name, "name of the scenario")->required();
    new_command->add_flag("--force", force, "replace an existing file");

    bool markdown = false, outputs = false;
    CLI::App* schema_command = add("schema", "every key of a scenario", [&] {
        std::fputs((outputs ? outputs_markdown() : json ? json_schema() : markdown ? schema_markdown() : schema_text()).c_str(), stdout);
        return exit_done;
    });
    schema_command->add_flag("--json", json, "as JSON Schema, for an editor");
    schema_command->add_flag("--markdown", markdown, "as Markdown, a section for each block");
    schema_command->add_flag("--outputs", outputs, "instead every number, column and array that a run writes, as Markdown");

    add("list", "names of the built-in scenarios", [&] {
        for (const std::string& built_in : built_in_scenarios()) std::printf("%s\n", built_in.c_str());
        return exit_done;
    });

    std::vector<std::filesystem::path> problems;
    std::string solver = std::string(lcp_solvers().front().name);
    std::vector<std::string> solver_names{"all"};
    for (const LcpSolver& known : lcp_solvers()) solver_names.emplace_back(known.name);
    std::string solver_table = "Solvers:\n";
    for (const LcpSolver& known : lcp_solvers())
        solver_table += "  " + std::string(known.name) + std::string(16 - known.name.size(), ' ') + std::string(known.description) + "\n";
    CLI::App* lcp_command = add("lcp", "solve stored complementarity problems", [&] { return solve_stored_lcp(problems, solver, json); });
    lcp_command->add_option("files", problems, "NAME.L.mtx, NAME.q.mtx (Matrix Market) or NAME alone")->required();
    lcp_command->footer(solver_table);
    lcp_command->add_option("--solver", solver, "one of the solvers below, or all of them; default " + solver)->check(CLI::IsMember(solver_names));
    lcp_command->add_flag("--json", json, "as JSON");

    BenchOptions bench_options;
    CLI::App* bench_command = add("bench", "fixed work: triangle-steps per core-second and ratios of one run", [&] { return bench(bench_options); });
    bench_command->add_flag("--full", bench_options.full, "all 80 us of the block, 151 000 and a million triangles, meshes, frames, figures, implicit steps");
    bench_command->add_option("--csv", bench_options.csv, "write what was measured to this file")->type_name(path);

    app.footer("Exit codes: 0 done, 1 internal error, 2 bad scenario or option, 3 the simulation failed, ran out of memory or violated a gate, or no solver solved the problem,\n"
               "4 an [expect] value failed, 130 interrupted.");  // after the commands, which would have it as well
    std::vector<std::string> commands;
    for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
    if (argc > 1 && argv[1][0] != '-' && std::find(commands.begin(), commands.end(), argv[1]) == commands.end()) {
        const std::string hint = did_you_mean(argv[1], commands);
        throw UserError("unknown-command", "`" + std::string(argv[1]) + "` is not a command of knap" + (hint.empty() ? "" : ": " + hint),
                        "known: " + joined(commands));
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::ostringstream said;
        const int code = app.exit(error, std::cout, said);
        std::fputs(printable(said.str()).c_str(), stderr);
        return code == 0 ? exit_done : exit_bad_input;
    }
    return chosen();
}

}  // namespace knap
