#include "app/cli.hpp"

#include "app/commands.hpp"
#include "app/ensemble/ensemble.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "lcp/solvers.hpp"
#include "record/outputs.hpp"
#include "record/version.hpp"
#include "scenario/keys.hpp"
#include "scenario/schema.hpp"
#include "scenario/units.hpp"
#include "scenario/write_scenario.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>

namespace knap {
namespace {

std::string version_text() {
    std::string text = "knap " + version() + " (" + git_hash() + (git_dirty() ? ", with uncommitted changes" : "") +
                       "), " + compiler() + "\n";
    for (const auto& [name, number] : libraries()) text += "  " + name + " " + number + "\n";
    return text;
}

/// A number with a unit of this kind, or a plain one in SI.
double quantity(const std::string& text, std::string_view unit) {
    const Quantity read = parse_quantity(text);
    if (!read.problem.empty()) throw UserError("bad-value", "`" + text + "`: " + read.problem);
    if (!std::isfinite(read.value)) throw UserError("bad-value", "`" + text + "` is not finite");
    if (!read.unit.empty() && read.dimension != dimension_of(unit))
        throw UserError("wrong-unit", "`" + text + "` is " + kind_name(read.dimension) + ", but " +
                                          kind_name(dimension_of(unit)) + " is required");
    return read.value;
}

/// "a,b" -> ["a", "b"]
std::string list_of_texts(const std::string& text) {
    std::string list;
    for (const char c : text) list += c == ',' ? std::string("\", \"") : std::string(1, c);
    return list.empty() ? "" : "[\"" + list + "\"]";
}

/// The help on an option that sets a key whose values are words; completion reads it, the scenario checks the value.
std::string words_of(const char* key) { return "TEXT:{" + CLI::detail::join(find_key(key)->words, ",") + "}"; }

/// One of these words; the message names those that were meant.
struct OneOf : CLI::IsMember {
    explicit OneOf(const std::vector<std::string>& words) : IsMember(words) {
        func_ = [words, check = func_](std::string& word) {
            const std::string fault = check(word), meant = fault.empty() ? "" : did_you_mean(word, words);
            return meant.empty() ? fault : "`" + word + "` is none of the words here, " + meant;
        };
    }
};

/// Whether a name ends as that of a picture, of a format that knap writes or not.
bool is_picture(const std::filesystem::path& name) {
    static constexpr std::string_view endings[] = {".png", ".svg", ".pdf",  ".webp", ".gif",  ".mp4", ".eps",
                                                   ".ps",  ".jpg", ".jpeg", ".tif",  ".tiff", ".bmp"};
    std::string ending = name.extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::ranges::count(endings, ending) > 0;
}

/// For options that name a directory of runs.
const CLI::Validator is_directory_name(
    [](const std::string& name) {
        return is_picture(name) ? "`" + name +
                                      "` is a picture by its name, and this is the directory of a run; "
                                      "`knap render RUN -o " +
                                      name + "` draws a picture"
                                : std::string();
    },
    "");

const char* const path = "PATH";  // completion offers files for such values only

/// The commands with their options, and the variables that the options set.
class CommandLine {
public:
    CommandLine(int argc, char** argv)
        : run_{.command = {argv, argv + argc}},
          study_{.program = argv[0], .command = run_.command},
          sweep_{.program = argv[0], .command = run_.command} {
        app.set_version_flag("--version", version_text);
        app.require_subcommand(1);
        app.fallthrough(false);
        add_run(), add_study(), add_sweep(), add_calibrate(), add_check(), add_mesh(), add_render(), add_info(),
            add_new();
        add_schema();
        add("list", "list the built-in scenarios, each with its question", [] {
            for (const BuiltIn& scenario : built_ins())
                std::printf("%-29s %s\n", scenario.name.c_str(), question(scenario).c_str());
            return exit_done;
        });
        add_lcp(), add_bench();
        app.footer(  // after the commands, which would have it as well
            "Exit codes: 0 success, 1 internal error, 2 bad scenario or option, 3 the simulation failed, ran out of "
            "memory or violated a gate, or no solver solved the problem,\n"
            "4 an [expect] value failed, 130 interrupted.");
    }

    CLI::App app{"knap: 2D dynamic fracture with nonsmooth cohesive interfaces on every edge of the mesh", "knap"};
    std::function<int()> chosen;

private:
    CLI::App* add(const char* name, const char* help, std::function<int()> action) {
        CLI::App* command = app.add_subcommand(name, help);
        command->callback([this, action] { chosen = action; });
        return command;
    }

    void add_scenario(CLI::App* command, const char* set_help) {
        command->add_option("scenario", scenario_, "scenario file, or name of a built-in scenario")->required();
        command->add_option("-s,--set", overrides_, set_help)->allow_extra_args(false);
    }
    static constexpr const char* set_key =
        "KEY=VALUE replaces a value of the file, as in mesh.size=\"2 mm\"; may be repeated";

    ReadResult read() const { return open_scenario(scenario_, overrides_); }

    void add_batch(CLI::App* command, BatchOptions& options, const std::string& kind, const std::string& directories) {
        command
            ->add_option("-o,--output", options.output,
                         "directory of the " + kind + "; default " + directories + "/<name>")
            ->check(is_directory_name)
            ->type_name(path);
        command->add_option("-j,--jobs", options.n_at_once, "runs at the same time, with one thread each")
            ->check(CLI::Range(1, 1024));
        command->add_flag("--force", options.force, "repeat finished runs, replace those of another " + kind);
        command->add_flag("-q,--quiet", options.quiet, "no line for every run");
        command->add_flag("--print-commands", options.print_commands,
                          "run nothing, print a command line for each run that remains to be done");
        command
            ->add_option("--emit", options.emit,
                         "run nothing, print a script that submits these runs, at most --jobs at a time")
            ->check(CLI::IsMember({"slurm"}));
    }

    void add_run() {
        CLI::App* command = add("run", "simulate a scenario and draw its figures", [this] {
            if (!until_.empty()) run_.until = quantity(until_, "s");
            if (!dump_lcp_.empty()) run_.dump_lcp = StepSelection::parse(dump_lcp_);
            return run_scenario(read(), run_);
        });
        add_scenario(command, set_key);
        command->add_option("-o,--output", run_.output, "directory of the run; default runs/<name>")
            ->check(is_directory_name)
            ->type_name(path);
        command
            ->add_option("-j,--threads", run_.threads,
                         "threads; default OMP_NUM_THREADS, SLURM_CPUS_PER_TASK or all. Results do not depend on it")
            ->check(CLI::Range(1, 1024));
        command->add_option("--until", until_, "end earlier, as in 20us");
        command->add_flag("--force", run_.force, "replace an earlier run");
        command->add_option(
            "--dump-lcp", dump_lcp_,
            "store the complementarity problems of these steps in <run>/lcp: 10,20 or 10:5:40 (every fifth)");
        command->add_flag("-q,--quiet", run_.quiet, "no progress line");
    }

    void add_study() {
        CLI::App* command = add("study", "refine step or mesh, vary scheme or seed; errors, orders, cost", [this] {
            const auto set = [&](const char* key, const std::string& value) {
                if (!value.empty()) overrides_.push_back(std::string("study.") + key + "=" + value);
            };
            set("refine", refine_);
            set("levels", levels_.empty() ? "" : "[" + levels_ + "]");
            set("seeds", n_seeds_ > 0 ? std::to_string(n_seeds_) : "");
            set("schemes", list_of_texts(schemes_));
            set("reference", reference_);
            for (std::string& of : quantities_) of = "{ of = \"" + of + "\" }";
            set("quantity", quantities_.empty() ? "" : "[" + joined(quantities_) + "]");
            if (!laws_.empty()) set("safety.laws", list_of_texts(laws_));
            return run_ensemble((safety_ ? plan_safety : plan_study)(scenario_, overrides_), scenario_, study_);
        });
        add_scenario(command, set_key);
        CLI::Option* safety = command->add_flag(
            "--safety", safety_, "the factor of safety: c and tan phi divided by it until nothing stands");
        command->add_option("--laws", laws_, "of --safety: names of interface laws, as in joint,fault; default all")
            ->needs(safety);
        command->add_option("--refine", refine_, "refined by the levels")->option_text(words_of("study.refine"));
        command->add_option("--levels", levels_, "divisors, as in 1,2,4,8");
        command->add_option("--seeds", n_seeds_, "statistics over this number of seeds")->check(CLI::Range(2, 10000));
        command
            ->add_option("--schemes", schemes_,
                         "pairs bulk/cohesion, as in explicit/explicit,implicit/implicit, or all")
            ->option_text(words_of("study.schemes"));
        command->add_option("--reference", reference_, "reference for errors; finest: the finest run")
            ->option_text(words_of("study.reference"));
        command->add_option("--quantity", quantities_, "number of the summary that is compared; may be repeated")
            ->allow_extra_args(false);
        add_batch(command, study_, "study", "studies");
    }

    void add_sweep() {
        CLI::App* command =
            add("sweep", "all combinations of values of keys and seeds: table, statistics, contact sheet", [this] {
                for (const std::string& set : seed_overrides(seeds_)) overrides_.push_back(set);
                return run_ensemble(plan_sweep(scenario_, overrides_), scenario_, sweep_);
            });
        add_scenario(command,
                     "KEY=VALUE,VALUE,...: each value, combined with all values of other keys; may be repeated");
        command->add_option("--seeds", seeds_, "20: this number, from the scenario's seed on; or 1..20");
        add_batch(command, sweep_, "sweep", "sweeps");
    }

    void add_calibrate() {
        CLI::App* command =
            add("calibrate",
                "measure what a crack along the edges of this mesh costs, or what a specimen bears, for "
                "toughness or strength = \"as measured\"",
                [this] { return calibrate(scenario_, overrides_, calibrate_); });
        add_scenario(command, set_key);
        const std::map<std::string, CalibrateOptions::Of> of{{"toughness", CalibrateOptions::Of::toughness},
                                                             {"strength", CalibrateOptions::Of::strength}};
        command->add_option("--of", calibrate_.of, "toughness (strips, the default) or strength (specimens)")
            ->transform(CLI::CheckedTransformer(of))
            ->option_text("toughness|strength");
        command
            ->add_option("--table", calibrate_.table, "file of the table; default <name>_toughness.csv, _strength.csv")
            ->type_name(path);
        command
            ->add_option(
                "--loads", calibrate_.loads,
                "energy release rates of the strips over G_c, as in 1.4,1.6; the smallest one under which four "
                "of five cracks run through counts")
            ->delimiter(',')
            ->check(CLI::Range(1.0, 100.0));
        command->add_option("--seeds", calibrate_.seeds, "strips under each load, or specimens")
            ->check(CLI::Range(1, 1000));
        command->add_option("-o,--output", calibrate_.batch.output, "directory of the runs; default calibrations")
            ->check(is_directory_name)
            ->type_name(path);
        command->add_option("-j,--jobs", calibrate_.batch.n_at_once, "runs at the same time")
            ->check(CLI::Range(1, 1024));
        command->add_flag("--force", calibrate_.batch.force, "repeat finished runs, replace the table");
        command->add_flag("-q,--quiet", calibrate_.batch.quiet, "no line for every run");
    }

    void add_check() {
        CLI::App* command = add("check", "check a scenario: mesh, resolution, methods, steps, estimated cost",
                                [this] { return check_scenario(read(), full_, strict_, time_); });
        add_scenario(command, set_key);
        command->add_flag("--full", full_, "print every key with its value and origin");
        command->add_flag("--strict", strict_, "warnings are errors");
        command->add_flag("--time", time_, "measure the first steps longer");
    }

    void add_mesh() {
        CLI::App* command = add("mesh", "make the mesh and report its quality",
                                [this] { return mesh_scenario(read(), output_, force_); });
        add_scenario(command, set_key);
        command->add_option("-o,--output", output_, "write it: .msh, .vtu or .svg")->type_name(path);
        command->add_flag("--force", force_, "replace an existing file");
    }

    /// Ends the command: it needs no run.
    static void list_subjects() {
        for (const auto& [name, doc] : described_subjects()) std::printf("%-17s %s\n", name.c_str(), doc.c_str());
        throw CLI::Success();
    }

    /// Throws UserError for an option of `knap render` that would have no effect on the figure.
    void refuse_idle_options() const {
        const CLI::App* const render = app.get_subcommand("render");
        if (figure_.show.empty()) {
            for (const CLI::Option* option : render->get_options())
                if (option->count() > 0 && option->get_name() != "run" && option->get_name() != "--output")
                    throw UserError(
                        "no-effect",
                        "`" + option->get_name() +
                            "` belongs to one figure, and without a subject those of the scenario are drawn",
                        "add --show SUBJECT");
            return;
        }
        for (const IdleKey& idle : idle_keys(figure_)) {
            const bool is_width = idle.key == "width" || idle.key == "paper_width";
            const std::string option = "--" + (is_width ? "width" : idle.key);
            const bool given = is_width ? !width_.empty() && (figure_.paper_width != 0) == (idle.key == "paper_width")
                                        : render->get_option_no_throw(option) && render->count(option) > 0;
            if (given)
                throw UserError("no-effect",
                                "`" + option + "` " + (is_width ? width_ + " " : "") + "belongs to " + idle.owner +
                                    ", and `" + figure_.file + "` shows `" + figure_.show + "`",
                                idle.cure);
        }
    }

    void add_render() {
        CLI::App* command = add("render", "draw figures of a finished run", [this] {
            std::filesystem::path directory = output_;
            if (is_picture(output_)) {
                if (!figure_.file.empty())
                    throw UserError("two-names", "`--output` and `--file` are two names of one picture",
                                    "leave --file out, or name a directory");
                directory = output_.has_parent_path() ? output_.parent_path() : ".";
                figure_.file = output_.filename();
            }
            const bool animates = animate_ || figure_.is_animation();
            if ((animates || !figure_.file.empty()) && figure_.show.empty()) {
                figure_.show = "cracks";
                print_messages("note: `" + figure_.file + "` shows cracks; `--show list` lists the other subjects\n");
            }
            if (figure_.file.empty()) figure_.file = figure_.show + (animates ? ".webp" : ".png");
            if (animates && !figure_.is_animation())
                throw UserError("no-effect",
                                "`--animate` draws an animation, and `" + figure_.file + "` is a picture by its name",
                                "a name that ends in .webp, .gif or .mp4");
            if (const auto picture = directory / figure_.file; std::filesystem::is_directory(picture))
                throw UserError("not-a-file", "`" + picture.string() + "` is a directory, and a picture by its name",
                                "another name");
            if (animates) figure_.width = animation_width;
            if (const Quantity width = parse_quantity(width_); !width_.empty() && width.unit.empty())
                figure_.width = static_cast<int>(std::clamp(quantity(width_, ""), -1e9, 1e9));
            else if (!width_.empty()) figure_.paper_width = quantity(width_, "m");
            if (!every_.empty()) figure_.every = quantity(every_, "s");
            for (const std::string& text : at_) figure_.at.push_back(quantity(text, "s"));
            for (const std::string& text : range_)
                figure_.range.push_back(quantity(text, unit_of_figure(figure_.show, figure_.colour)));
            const auto metres = [&](int i) { return quantity(box_[i], "m"); };
            if (!box_.empty()) figure_.box = Box{{metres(0), metres(1)}, {metres(2), metres(3)}};
            refuse_idle_options();
            return render_run(directory_, figure_, directory);
        });
        command->add_option("run", directory_, "run directory")->required();
        std::vector<std::string> subjects = figure_subjects();
        subjects.insert(subjects.end(), {"list", ""});
        command
            ->add_option_function<std::string>(
                "--show",
                [this](const std::string& show) {
                    const bool took_subject = std::ranges::count(figure_subjects(), directory_.string()) > 0;
                    if (show.empty() && took_subject) throw CLI::RequiredError("run");  // `--show energy` alone
                    if (show.empty() || show == "list") list_subjects();
                    figure_.show = show;
                },
                "subject; `list` or none: the subjects with a line each; without it the figures of the scenario, in a "
                "named picture cracks")
            ->expected(0, 1)
            ->check(OneOf(subjects));
        command->add_option("--file", figure_.file,
                            "name of the picture: .png, .svg, .pdf, of an animation .webp, .gif, .mp4");
        command->add_option("--at", at_, "times, as in 40us");
        command->add_option("--colour", figure_.colour, "of cracks")->check(OneOf(figure_colours()));
        command->add_option("--over", figure_.over, "abscissa of reactions or probes")
            ->check(OneOf(figure_abscissas()));
        command->add_option("--aspect", figure_.aspect, "magnification of the short side relative to the long one");
        command->add_option("--deform", figure_.deform, "magnification of the displacement");
        command->add_option("--range", range_, "colour range, two values with units")->expected(2);
        command->add_option("--mark", figure_.mark, "isolines of a temperature, or places of an abscissa");
        command->add_option("--box", box_, "part of the body: xmin ymin xmax ymax")->expected(4);
        command->add_flag("--animate", animate_, "an animation of the frames: .webp, with ffmpeg also .gif and .mp4");
        command->add_option("--every", every_, "simulated time between its pictures, as in 2us; default all frames");
        command
            ->add_option("--speed", figure_.speed,
                         "simulated time over its time: 1e-5 shows 10 us in a second; default all in 8 s")
            ->check(CLI::PositiveNumber);
        command->add_option("--curves", figure_.curves, "curves that grow below the body")
            ->check(OneOf(growing_subjects()));
        command->add_option("--width", width_, "pixels, or on paper (.svg, .pdf), as in 84mm");
        command->add_option("--font-size", figure_.font_size, "of labels on paper, in points; default with a width 8")
            ->check(CLI::Range(4., 40.));
        command
            ->add_option("-o,--output", output_,
                         "directory for the pictures, default <run>/rendered; or a picture, as in cracks.pdf")
            ->type_name(path);
    }

    void add_info() {
        CLI::App* command = add("info", "settings and results of runs", [this] {
            return show_runs(runs_, csv_ ? RunFormat::csv : json_ ? RunFormat::json : RunFormat::text);
        });
        command->add_option("runs", runs_, "run directories, or studies and sweeps: the runs in them")->required();
        command->add_flag("--json", json_, "as JSON")
            ->excludes(command->add_flag("--csv", csv_, "as a table, one line per run"));
    }

    void add_new() {
        CLI::App* command =
            add("new", "write a scenario to start from", [this] { return write_new_scenario(name_, from_, force_); });
        command->add_option("name", name_, "name of the scenario")->required();
        command->add_option("--from", from_, "copy this built-in scenario, with its comments");
        command->add_flag("--force", force_, "replace an existing file");
    }

    void add_schema() {
        CLI::App* command = add("schema", "list every key of a scenario", [this] {
            const std::string text = outputs_    ? outputs_markdown()
                                     : json_     ? json_schema()
                                     : markdown_ ? schema_markdown()
                                                 : schema_text();
            std::fputs(text.c_str(), stdout);
            return exit_done;
        });
        command->add_flag("--json", json_, "as JSON Schema, for an editor");
        command->add_flag("--markdown", markdown_, "as Markdown, a section per block");
        command->add_flag("--outputs", outputs_, "instead every number, column and array of the output, as Markdown");
    }

    void add_lcp() {
        std::vector<std::string> names{"all"};
        std::string table = "Solvers:\n";
        for (const LcpSolver& known : lcp_solvers()) {
            names.emplace_back(known.name);
            table += formatted("  %-16s", names.back().c_str()) + std::string(known.description) + "\n";
        }
        solver_ = names[1];
        CLI::App* command = add("lcp", "solve stored complementarity problems",
                                [this] { return solve_stored_lcp(problems_, solver_, json_); });
        command->add_option("files", problems_, "NAME.L.mtx, NAME.q.mtx (Matrix Market) or NAME alone")->required();
        command->footer(table);
        command->add_option("--solver", solver_, "one of the solvers below, or all; default " + solver_)
            ->check(OneOf(names));
        command->add_flag("--json", json_, "as JSON");
    }

    void add_bench() {
        CLI::App* command = add("bench", "fixed work: triangle-steps per core-second, ratios within one run",
                                [this] { return bench(bench_); });
        command->add_flag(
            "--full", bench_.full,
            "all 80 us of the block, 151 000 and a million triangles, meshes, frames, figures, implicit steps");
        command->add_option("--csv", bench_.csv, "write the measurements to this file")->type_name(path);
    }

    std::string scenario_, until_, dump_lcp_, refine_, levels_, schemes_, reference_, seeds_, laws_, name_, from_,
        solver_, every_, width_;
    std::vector<std::string> overrides_, quantities_, at_, box_, range_;
    std::filesystem::path output_, directory_;
    std::vector<std::filesystem::path> runs_, problems_;
    bool force_ = false, full_ = false, strict_ = false, time_ = false, json_ = false, csv_ = false, markdown_ = false,
         outputs_ = false, animate_ = false, safety_ = false;
    int n_seeds_ = 0;
    RunOptions run_;
    BatchOptions study_, sweep_;
    CalibrateOptions calibrate_;
    FigureOptions figure_{.show = ""};
    BenchOptions bench_;
};

}  // namespace

int run_command_line(int argc, char** argv) {
    CommandLine line(argc, argv);
    std::vector<std::string> commands;
    for (const CLI::App* command : line.app.get_subcommands({})) commands.push_back(command->get_name());
    if (argc > 1 && argv[1][0] != '-' && std::ranges::find(commands, argv[1]) == commands.end()) {
        const std::string hint = did_you_mean(argv[1], commands);
        throw UserError("unknown-command",
                        "`" + std::string(argv[1]) + "` is not a command of knap" + (hint.empty() ? "" : ": " + hint),
                        "known: " + joined(commands));
    }
    try {
        line.app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::ostringstream text;
        const int code = line.app.exit(error, std::cout, text);
        std::fputs(printable(text.str()).c_str(), stderr);
        return code == 0 ? exit_done : exit_bad_input;
    }
    return line.chosen();
}

}  // namespace knap
