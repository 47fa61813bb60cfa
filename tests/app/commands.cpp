// The other commands.
#include "app/program.hpp"

#include "app/run/run_text.hpp"
#include "app/setup/step_plan.hpp"
#include "base/text.hpp"
#include "scenario/read_scenario.hpp"
#include "support/relative.hpp"

#include <sys/stat.h>

#include <regex>

namespace commands_test {

using namespace program;
using knap::tests::relative;

TEST_CASE("check says what would happen") {
    const Answer check = command("check edge_cracked_block -s 'mesh.size=1 mm'");
    CHECK(check.code == 0);
    for (const char* words : {"triangles", "c_R 2125.2", "process zone", "stable step", "MB of memory", "friction no"})
        CHECK_MESSAGE(check.has(words), words);
    const Answer coarse = command("check edge_cracked_block -s 'mesh.size=2.5 mm'");
    CHECK(coarse.code == 0);
    CHECK(coarse.has("warning[resolution]"));
    CHECK(coarse.has("--set"));
    CHECK(command("check edge_cracked_block --strict -s 'mesh.size=2.5 mm'").code == 2);
    const Answer full = command("check edge_cracked_block --full -s 'mesh.size=2 mm'");
    for (const char* key : {"mesh.size", "interface.default.friction", "time.theta"}) CHECK_MESSAGE(full.has(key), key);
    // every law with all that it can do, those of joints too
    const std::string law =
        "check jointed_slope -s 'interface.default={ sigma_c=5e6, G_c=80, softening=\"trapezoid\", "
        "plateau=0.3, unloading=\"secant\", relaxation_time=\"1 us\", friction=0.6 }'";
    const Answer laws = command(law);
    CHECK_MESSAGE(laws.code == 0, laws.text);
    for (const char* words : {"laws", "act on", "trapezoid 0.3", "unloading secant", "relaxation_time 1 µs"})
        CHECK_MESSAGE(laws.has(words), words, laws.text);
    CHECK(std::regex_search(laws.text, std::regex("[0-9]+ of joints +")));
    const Answer frost = command("check thawing_joint");
    CHECK_MESSAGE(frost.has("strength_table 0.2908 to 1 over -10 to -0.5 K"), frost.text);
    const std::string surplus = "a crack along the edges of a random mesh costs 1.1 to 1.3 G_c per length";
    CHECK(command("check edge_cracked_block -s 'mesh.size=4 mm'").has(surplus));
    CHECK_FALSE(command("check bar_pulled_apart").has(surplus));  // it breaks along one line only
    // a slow structure whose size and law were measured; gamma below 1 makes the norm too weak
    const std::string beam =
        "check three_point_bending -s 'mesh.refine[0].size=8 mm' -s domain.region=[] -s material.right= "
        "-s interface.left-right= -s 'interface.default={ sigma_c=3.33e6, G_c=124, gamma=";
    const Answer slow = command(beam + "1 }'");
    for (const char* words :
         {"a notched beam bears                         1.18 +- 0.06  1.04 +- 0.02\n",
          "a notched panel bears                        1.10 +- 0.05  1.03 +- 0.02  (no row; that of order 1",
          "coupling = \"norm\" fits this slow run", "structures bear 1.10 to 1.18 with the sum, 1.03 to 1.05 with",
          "not all of that was measured (no row)", "notched ones with a ligament of 100 mm"})
        CHECK_MESSAGE(slow.has(words), words, slow.text);
    CHECK(command(beam + "1, coupling=\"norm\" }'").has("coupling = \"norm\", which it has, fits this slow run"));
    CHECK(command(beam + "0.5, coupling=\"norm\" }'").has("coupling = \"sum\" fits this slow run"));
    // a load of a few passages of a wave, on bodies with and without a crack, which is slow with a slow load only
    for (const char* cracked : {"check mesh_toughness", "check mesh_toughness -s 'time.end=350 us'",
                                "check edge_cracked_block_implicit -s 'mesh.size=2 mm'"}) {
        const Answer checked = command(cracked);
        for (const char* words : {"coupling = \"norm\" fits a crack slower than 0.6 c_R (max_tip_speed_over_cR): the "
                                  "slowest that run cost 1.1",
                                  "coupling = \"sum\", which it has, fits a faster one: those at 0.66 c_R cost 1.2"})
            CHECK_MESSAGE(checked.has(words), words, checked.text);
    }
    const Answer bar = command("check spall_bar -s 'mesh.size=0.25 mm' -s interface.default.G_c=80");
    CHECK_MESSAGE(bar.has("bars that expand bear 1.09 with the sum, 1.04 with the norm, but the shear"), bar.text);
    // what the tables do not have is said, with the nearest row
    const Answer other = command(
        "check mesh_toughness -s interface.free-free.unloading=secant -s interface.free-free.softening=petersson "
        "-s interface.free-free.gamma=5");
    for (const char* words : {"(no row; that of softening linear and unloading constant and gamma 2",
                              "without a row it was not measured", "`knap calibrate` measures the cost"})
        CHECK_MESSAGE(other.has(words), words, other.text);
    CHECK(command("check mesh_toughness").has("runs costs, over G_c  1.14 +- 0.01  1.11 +- 0.01\n"));
    const Answer between = command("check edge_cracked_block -s interface.default.gamma=1.5 -s mesh.size=0.5mm");
    CHECK_MESSAGE(
        between.has("sum: measured with 3 to 12 edges; between rows; gamma 2: 1.19; norm: no row; that of gamma 2 and "
                    "6 edges"),
        between.text);
    const Answer edges = command("check mesh_toughness -s 'mesh.size=1.4 mm' -s 'mesh.refine[0].size=0.35 mm'");
    CHECK_MESSAGE(edges.has("(sum: between rows; 6 edges: 1.1"), edges.text);
    const Answer finer = command("check uniaxial_compression");
    CHECK_MESSAGE(finer.has("  (sum: measured with 12.5 edges alone; norm: measured with 6.25 to 25 edges)"),
                  finer.text);
    const Answer sliding = command("check mesh_toughness -s interface.free-free.G_II='6 J/m2'");
    CHECK_MESSAGE(sliding.has("(no row; that without G_II)"), sliding.text);
    const Answer plate = command("check uniaxial_compression -s interface.default.coupling=norm -s 'mesh.size=2 mm'");
    CHECK_MESSAGE(plate.has("a plate under compression bears              1.02 +- 0.00  1.04 +- 0.02\n"), plate.text);
    const std::string sum = "check uniaxial_compression -s 'mesh.size=2 mm' -s interface.default.";
    const std::pair<const char*, const char*> measured[] = {{"G_c='16 J/m2'", "1.08 +- 0.03  1.13 +- 0.03\n"},
                                                            {"G_c='6.8 J/m2'", "1.03 +- 0.01  1.07 +- 0.02"},
                                                            {"gamma=2", "1.01 +- 0.00  1.01 +- 0.01\n"},
                                                            {"friction=0", "0.99 +- 0.00  1.00 +- 0.00\n"}};
    for (const auto& [key, words] : measured) {
        const Answer bears = command(sum + key);
        CHECK_MESSAGE(bears.has(std::string("a plate under compression bears              ") + words), bears.text);
    }
    // a slow specimen has the coupling whose specimens miss less, not that of notched structures
    CHECK(command("check slow_crush").has("coupling = \"sum\", which it has, fits this run under compression"));
    const Answer crush = command("check slow_crush -s interface.default.coupling=norm");
    CHECK_MESSAGE(crush.has("coupling = \"sum\" fits this run under compression"), crush.text);
    const std::string slow_disc =
        "check brazilian_disc -s 'mesh.size=2 mm' -s time.bulk=implicit -s 'time.end=1 s' -s interface.default.";
    const Answer of_disc = command(slow_disc + "coupling=norm");
    CHECK_MESSAGE(of_disc.has("coupling = \"sum\" fits this run of a disc"), of_disc.text);
    CHECK_MESSAGE(of_disc.has("a Brazilian disc bears                       0.88 +- 0.06  0.57 +- 0.03\n"),
                  of_disc.text);
    // a gamma below those of the table: 2 gamma of the sum, 2 gamma sqrt(1 - gamma^2) of the norm
    const Answer weak = command("check edge_cracked_block -s 'mesh.size=2 mm' -s interface.default.gamma=0.3");
    for (const char* words : {"a plate in tension bears                     0.60          0.57  (no row; a facet",
                              "may err by all that it differs from 1"})
        CHECK_MESSAGE(weak.has(words), words, weak.text);
    // large steps that the strength is met in
    CHECK(command("check edge_cracked_block -s 'mesh.size=4 mm' -s time.bulk=auto")
              .has("warning[few-steps]: `time.bulk`"));
    CHECK_FALSE(command("check slow_crush").has("few-steps"));
    // a disc whose law is weak under compression is crushed
    const Answer disc = command("check brazilian_disc -s interface.default.coupling=norm -s 'mesh.size=2 mm'");
    for (const char* words :
         {"warning[crushed-disc]: `interface.default.gamma`", "compressive strength of 3.8 sigma_c",
          "bear 0.57 +- 0.03 of their splitting load", "gamma = 1.7, which gives 6.5 sigma_c, or coupling = \"sum\""})
        CHECK_MESSAGE(disc.has(words), words, disc.text);
    CHECK_FALSE(command("check brazilian_disc -s 'mesh.size=2 mm'").has("crushed-disc"));
    CHECK_FALSE(command("check brazilian_disc -s interface.default.coupling=norm -s interface.default.gamma=1.7 "
                        "-s 'mesh.size=2 mm'")
                    .has("crushed-disc"));
    CHECK(command("check edge_cracked_block --time -s 'mesh.size=2 mm'").has("now (measured)"));
    const Answer contact = command("check block_toppling -s 'contact.friction=0.7'");
    CHECK_MESSAGE(contact.has("contact of free faces, rock on rock: friction 0.7, restitution 0"), contact.text);
}

TEST_CASE("check says what the implicit path would do") {
    const std::string bar = "check bar_pulled_apart -s time.bulk=implicit -s time.cohesion=implicit ";
    const Answer check =
        command(bar + "-s 'time.step=100 CFL' -s 'time.step_cracking=5 CFL' -s time.theta=0.7 -s time.mass=consistent");
    CAPTURE(check.text);
    CHECK(check.code == 0);
    for (const char* words :
         {"implicit bulk (theta 0.7, consistent mass)", "implicit beta",
          "Assumption 1 certainly holds for h <= ", "margin 0.97", "such steps are repeated with a smaller size",
          "after the first loss of cohesion", "(5 CFL)", "a step takes"})
        CHECK_MESSAGE(check.has(words), words);
    CHECK(command(bar + "-s 'time.step=2 CFL'").has("holds for every step"));
    CHECK(command(bar + "-s time.assumption_1=ignore").has("one of several solutions is used"));
    CHECK_FALSE(command(bar + "-s time.cohesion=explicit").has("Assumption 1"));

    const Answer order = command(bar + "-s 'time.step=5 CFL' -s 'time.step_cracking=6 CFL'");
    CHECK(order.code == 2);
    CHECK(order.has("step-order"));
    CHECK(order.has("--set time.step_cracking=6 CFL"));
}

TEST_CASE("new writes a scenario that checks and is not overwritten") {
    const Folder folder("new");
    CHECK(command("new " + folder.in_shell("plate")).code == 0);
    CHECK(command("new " + folder.in_shell("plate")).code == 2);
    const Answer nowhere = command("new " + folder.in_shell("nowhere/plate"));
    CHECK(nowhere.code == 2);
    CHECK(nowhere.has("cannot-write"));
    const Answer check = command("check " + folder.in_shell("plate.toml"));
    CAPTURE(check.text);
    CHECK(check.code == 0);
}

TEST_CASE("new --from copies a built-in scenario with its comments and the mesh that it names") {
    const Folder folder("new_from");
    REQUIRE(command("new --from brazilian " + folder.in_shell("my_disc.toml")).code == 0);
    const std::string text = text_of(folder.path / "my_disc.toml"),
                      original = text_of(KNAP_SOURCE_DIR "/scenarios/brazilian_disc.toml");
    CHECK(text.find("name  = \"my_disc\"\n") != text.npos);
    const std::string for_editors = "#:schema knap.schema.json\n";
    CHECK(text.size() ==
          for_editors.size() + original.size() - std::string("brazilian_disc").size() + std::string("my_disc").size());
    CHECK(text.starts_with(for_editors + original.substr(0, original.find("name"))));
    CHECK(text_of(folder.path / "knap.schema.json") == command("schema --json").text);
    std::ofstream(folder.path / "knap.schema.json") << "{}";  // of someone else
    CHECK(command("new " + folder.in_shell("plate")).has("the schema of its keys"));
    CHECK_FALSE(fs::exists(folder.path / "plate.toml"));
    std::ofstream(folder.path / "knap.schema.json") << "{\n  \"title\": \"knap scenario\"\n}\n";  // of another version
    CHECK(command("new " + folder.in_shell("plate")).has("renewed "));
    CHECK(text_of(folder.path / "knap.schema.json") == command("schema --json").text);
    CHECK_FALSE(command("new " + folder.in_shell("again")).has("renewed "));
    fs::remove(folder.path / "knap.schema.json");
    CHECK(command("new --from bar_pulled_apart " + folder.in_shell("my_disc.toml")).has("file-exists"));
    CHECK(command("new --from bar_puled_apart " + folder.in_shell("bar")).has("did you mean `bar_pulled_apart`"));
    REQUIRE(command("new --from hopkinson_time_piece " + folder.in_shell("bar")).code == 0);
    CHECK(text_of(folder.path / "hopkinson_time_piece.msh") ==
          text_of(KNAP_SOURCE_DIR "/scenarios/hopkinson_time_piece.msh"));
    const Answer check = command("check " + folder.in_shell("bar.toml"));
    CAPTURE(check.text);
    CHECK(check.code == 0);
}

TEST_CASE("list has a line with the question of every built-in scenario") {
    std::istringstream list(command("list").text);
    std::size_t n = 0;
    for (std::string line; std::getline(list, line); ++n) {
        CAPTURE(line);
        REQUIRE(n < knap::built_ins().size());
        CHECK(line.starts_with(knap::built_ins()[n].name + " "));
        CHECK(line.ends_with("?"));
    }
    CHECK(n == knap::built_ins().size());
}

TEST_CASE("bench does not overwrite a file") {
    const Folder folder("bench");
    std::ofstream(folder.path / "mine.csv") << "mine";
    CHECK(command("bench --csv " + folder.in_shell("mine.csv")).code == 2);
    CHECK(text_of(folder.path / "mine.csv") == "mine");
}

TEST_CASE("bench measures to its end" * doctest::test_suite("slow")) {
    const Answer answer = command("bench");
    CHECK(answer.code == 0);
    for (const char* words : {"same bits with 1 and 2 threads:                     yes", "a step with [contact]",
                              "dust: detection", "ground: detection with 40 000 edges"})
        CHECK_MESSAGE(answer.has(words), words);
    static const std::regex bound("([0-9]+) % of the bound");
    int n = 0;
    for (std::sregex_iterator found(answer.text.begin(), answer.text.end(), bound), end; found != end; ++found, ++n)
        CHECK(std::stoi((*found)[1]) < 100);
    CHECK(n == 3);
}

TEST_CASE("mesh reports and writes") {
    const Folder folder("mesh");
    const std::string scenario = "mesh edge_cracked_block -s 'mesh.size=1 mm' ";
    const Answer report = command(scenario);
    for (const char* words : {"triangles", "smallest angle", "stable step", "edges per process zone", "path excess"})
        CHECK_MESSAGE(report.has(words), words);
    for (const char* file : {"m.msh", "m.vtu", "m.svg"}) {
        CHECK(command(scenario + "-o " + folder.in_shell(file)).code == 0);
        CHECK(fs::file_size(folder.path / file) > 1000);
        CHECK(command(scenario + "-o " + folder.in_shell(file)).code == 2);
    }
    CHECK(text_of(folder.path / "m.msh").find("1 1 \"bottom\"") != std::string::npos);
    CHECK(command(scenario + "-o " + folder.in_shell("m.stl")).code == 2);
}

TEST_CASE("the picture of a mesh has a legend of the classes of a map and of minerals") {
    const Folder folder("mesh_picture");
    for (const auto& [scenario, names] :
         {std::pair{"mapped_fractures", std::vector<std::string>{">fault<", ">joint<", ">bedding<"}},
          std::pair{"micrograph", std::vector<std::string>{">quartz<", ">feldspar<", ">mica<", ">borders of grains<",
                                                           ">cracked<"}}}) {
        const std::string file = std::string(scenario) + ".svg";
        CHECK(command("mesh " + std::string(scenario) + " -o " + folder.in_shell(file)).code == 0);
        const std::string picture = text_of(folder.path / file);
        for (const std::string& name : names) CHECK_MESSAGE(picture.find(name) != std::string::npos, name);
    }
}

TEST_CASE("help and version answer") {
    for (const char* name : {"run", "check", "mesh", "render", "info", "new", "schema", "bench", "calibrate"})
        CHECK_MESSAGE(command("--help").has(name), name);
    CHECK(command("--help").code == 0);
    CHECK(command("--version").has("CGAL 5.5"));
    CHECK(command("list").has("kalthoff_winkler"));
    CHECK(command("schema").has("sigma_c"));
    CHECK(command("").code == 2);
}

TEST_CASE("what cannot be written to standard output is an error") {
    CHECK(command("schema >/dev/full").code == 3);
    CHECK(command("schema >/dev/null").code == 0);
}

TEST_CASE("a pipe instead of a file is refused and not waited for") {
    const Folder folder("pipe");
    REQUIRE(mkfifo((folder.path / "pipe").c_str(), 0600) == 0);
    for (const char* names : {"-s load[0].ramp= -s 'load[0].csv=pipe'",
                              "-s 'map=[{file=\"pipe\",colour=[{rgb=\"#000000\",material=\"glass\"}]}]'"}) {
        std::ofstream(folder.path / "block.toml") << text_of(KNAP_SOURCE_DIR "/scenarios/edge_cracked_block.toml");
        const Answer check = command("check " + folder.in_shell("block.toml") + " " + names);
        CAPTURE(check.text);
        CHECK(check.code == 2);
        CHECK(check.has("missing-file"));
    }
}

TEST_CASE("the step plan covers the time and keeps within the stable step") {
    knap::Scenario scenario;
    scenario.time.end = 1;
    scenario.time.safety = 0.8;
    const double forever = 1e300;
    const knap::StepPlan plan = knap::plan_steps(scenario.time, 0.013, forever);
    CHECK(plan.limits.largest <= 0.8 * 0.013 * (1 + 1e-12));
    CHECK(plan.limits.largest * static_cast<double>(plan.n_steps) == relative(1, 1e-12));
    CHECK(plan.limits.cracking == plan.limits.largest);
    CHECK(knap::plan_steps(scenario.time, 0.013, 0.5).limits.largest == plan.limits.largest);
    CHECK(knap::plan_steps(scenario.time, 0.013, 0.5).n_steps == (plan.n_steps + 1) / 2);
    scenario.time.step = {.value = 0.5, .of_stable_step = true};
    CHECK(knap::plan_steps(scenario.time, 0.01, forever).limits.largest == relative(0.005));
    scenario.time.step = {.value = 0.02};
    CHECK_THROWS_AS(knap::plan_steps(scenario.time, 0.013, forever), knap::BadStep);
}

TEST_CASE("steps that nobody can count are refused") {
    const auto refused = [](const std::string& overrides) {
        const Answer check = command("check bar_ramp_wave " + overrides);
        CAPTURE(check.text);
        CHECK(check.code == 2);
        return check.text;
    };
    for (const char* overrides : {"-s 'time.end=1e13 s'", "-s time.safety=1e-20", "-s material.left.E=1e60"}) {
        const std::string message = refused(overrides);
        CHECK(message.find("error[too-many-steps]: time.end = ") != std::string::npos);
        CHECK(message.find("time.safety") != std::string::npos);
    }
    CHECK(refused("-s 'time.step=1e-24 s'").find("--> --set time.step=1e-24 s") != std::string::npos);
    CHECK(refused("-s time.bulk=implicit -s 'time.step=1e-30 s'").find("error[too-many-steps]") != std::string::npos);
    CHECK(
        refused("-s time.bulk=implicit -s 'time.step_cracking=1e-30 s'").find("--> --set time.step_cracking=1e-30 s") !=
        std::string::npos);
    CHECK(refused("-s material.left.E=1e308").find("error[no-stable-step]") != std::string::npos);
    CHECK(command("run bar_ramp_wave -s 'time.step=1e-24 s'").code == 2);
}

TEST_CASE("the step plan of the implicit bulk is not bound by the stable step") {
    knap::Scenario scenario;
    scenario.time.end = 1;
    scenario.time.scheme.bulk = knap::BulkScheme::implicit_theta;
    const double forever = 1e300;
    CHECK(knap::plan_steps(scenario.time, 1e-3, forever).limits.largest == relative(20e-3));
    CHECK(knap::plan_steps(scenario.time, 10, forever).limits.largest == 1);  // no longer than the run
    scenario.time.step = {.value = 0.02};
    scenario.time.step_cracking = {.value = 5, .of_stable_step = true};
    const knap::StepLimits limits = knap::plan_steps(scenario.time, 1e-3, forever).limits;
    CHECK(limits.largest == 0.02);
    CHECK(limits.cracking == 0.005);
    CHECK(limits.smallest == 0.005 / (1 << 20));
    CHECK(limits.end == 1);
    const auto key_of = [&](knap::StepLength step, knap::StepLength cracking,
                            knap::StepLength smallest) -> std::string {
        scenario.time.step = step, scenario.time.step_cracking = cracking, scenario.time.step_min = smallest;
        try {
            knap::plan_steps(scenario.time, 1e-3, forever);
        } catch (const knap::BadStep& error) {
            return error.key;
        }
        return "";
    };
    CHECK(key_of({0.02}, {0.03}, {}) == "time.step_cracking");
    CHECK(key_of({0.02}, {0.01}, {0.011}) == "time.step_min");
    CHECK(key_of({0.02}, {}, {0.03}) == "time.step_min");
    CHECK(key_of({0.02}, {0.02}, {0.02}) == "");
}

TEST_CASE("mesh and check agree on edges per process zone") {
    for (const char* scene : {"edge_cracked_block -s 'mesh.size=2 mm'",
                              "edge_cracked_block -s 'mesh.size=2 mm' -s mesh.order=2 -s time.bulk=implicit",
                              "edge_cracked_block -s 'mesh.size=4 mm' -s 'mesh.refine=[{inside=[\"40 mm\",\"10 "
                              "mm\",\"100 mm\",\"30 mm\"],size=\"1 mm\"}]'",
                              "edge_cracked_block -s 'mesh.size=4 mm' -s 'mesh.refine=[{along=[[\"45 mm\",\"20 mm\"],"
                              "[\"100 mm\",\"20 mm\"]],width=\"6 mm\",size=\"1 mm\"}]'"}) {
        const std::string mesh = command(std::string("mesh ") + scene).text,
                          check = command(std::string("check ") + scene).text;
        CAPTURE(mesh);
        CAPTURE(check);
        std::smatch by_mesh, by_check;
        REQUIRE(std::regex_search(mesh, by_mesh, std::regex("edges per process zone +([0-9.]+)")));
        REQUIRE(std::regex_search(check, by_check, std::regex("process zone [^:;]*, ([0-9.]+) edges")));
        CHECK(by_mesh[1] == by_check[1]);
        std::smatch by_warning;
        if (std::regex_search(check, by_warning, std::regex("covered by ([0-9.]+) edges")))
            CHECK(by_warning[1] == by_mesh[1]);
    }
}

TEST_CASE("the process zone of a softening is that of its steepest piece") {
    const auto zone = [](const std::string& softening) {  // [mm]
        const std::string check =
            command("check three_point_bending -s interface.left-right.softening=" + softening).text;
        std::smatch found;
        CAPTURE(check);
        REQUIRE(std::regex_search(check, found, std::regex("process zone ([0-9.]+) mm")));
        return std::stod(found[1]);
    };
    const double linear = zone("linear");  // slope 1/2; printed to a millimetre in 300
    CHECK(zone("petersson") / linear == relative(0.5 * 1.2, 0.01));
    CHECK(zone("mc2010") / linear == relative(0.5 / 0.8, 0.01));
}

TEST_CASE("a run that violates several gates names them all") {
    knap::Gates gates(7, {{.name = "impact_work", .meaning = "holds"}, 0, 1, 1, knap::GateLevel::ok, std::nullopt});
    const auto violated = [](const char* name, double value, double limit) {
        for (const knap::GateRule& rule : knap::gate_rules())
            if (rule.name == name)
                return knap::Gate{rule, value, limit, limit, knap::GateLevel::violated, std::nullopt};
        throw std::invalid_argument(name);
    };
    const auto text = [&] { return knap::violated_text(gates, {}, {0, 0}); };
    gates[0] = violated("energy_residual", 2e-3, 1e-10);
    CHECK(text().find("above the stable one") != std::string::npos);
    gates[4] = violated("interface_residual", 1.1, 1e-10);
    gates[6] = violated("penetration", 1, 0.1);
    for (const char* words :
         {"energy_residual violated", "0.002, limit 1e-10", "interface_residual violated", "1.1, limit 1e-10",
          "penetration violated", "1 m, limit 0.1 m", "solver of the interfaces"})
        CHECK_MESSAGE(text().find(words) != std::string::npos, words);
    CHECK(text().find("impact_work") == std::string::npos);
    CHECK(text().find("stable one") == std::string::npos);
}

TEST_CASE("a selection of nothing of the mesh is reported with its line") {
    const auto answer = [](const std::string& more) {
        const Folder folder("empty_selection");
        std::ofstream(folder.path / "plate.toml")
            << "knap = 1\n[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.04]\n[mesh]\nsize = 0.01\n"
               "[material.glass]\ndensity = 2450\nE = 32e9\nnu = 0.2\n[interface.default]\nsigma_c = 3e6\nG_c = "
               "3\n[time]\nend = 1e-6\n"
            << more;
        return command("check " + folder.in_shell("plate.toml"));
    };
    const std::string nowhere = "{ box = [1, 1, 2, 2] }\n";
    for (const std::string& more : {"[[load]]\non = " + nowhere + "velocity = [0, 1]\n",
                                    std::string("[[support]]\non = { boundary = \"left\", box = [1, 1, 2, 2] }\n"),
                                    std::string("[[initial]]\nbox = [1, 1, 2, 2]\nvelocity = [0, 1]\n")}) {
        const Answer found = answer(more);
        CAPTURE(found.text);
        CHECK(found.code == 2);
        CHECK(found.has("error[empty-selection]"));
        CHECK(found.has("plate.toml:17:"));
    }
}

TEST_CASE("check judges the process zone of a support") {
    const Answer found = command("check dcb_displacement");
    CAPTURE(found.text);
    CHECK(found.code == 0);
    // 9 pi/32 of twice E' G_c/sigma_c^2 = 2 * 2700 * 0.14/45^2 mm: the body and its mirror
    CHECK(found.has("process zone 330 µm"));
}

TEST_CASE("no message steers the terminal") {
    const Folder folder("escapes");
    const std::string escape = "\033[31m";
    std::ofstream(folder.path / "bad.toml") << "[" << escape << "foo]\n";
    std::ofstream(folder.path / "title.toml") << "knap = 1\n\t# \xc2\x9b"
                                              << "31m \xc3\xa9\n\"\\u001B[31mfoo\" = 2\n";
    for (const std::string& arguments :
         {"check " + folder.in_shell("bad.toml"), "check " + folder.in_shell("title.toml"), "info '" + escape + "'",
          "sweep bar_pulled_apart -j '" + escape + "'", "new '/proc/" + escape + "/a'", "'" + escape + "'"}) {
        const Answer answer = command(arguments);
        CAPTURE(arguments);
        CHECK(answer.code == 2);
        CHECK(answer.has("?[31m"));
        CHECK_FALSE(answer.has("\033"));
    }
    CHECK(knap::printable("a\xc2\x9b"
                          "b\x7f\r\a\tc\n\xc3\xa9\xc2") == "a?b???\tc\n\xc3\xa9\xc2");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which take more than there is
TEST_CASE("what has no room in memory is no internal error") {
    const Folder folder("memory");
    const Answer large = command("--version >/dev/null; ulimit -v 200000; '" KNAP_PROGRAM
                                 "' run edge_cracked_block -q -j 1 -s 'mesh.size=0.2 mm' -o " +
                                 folder.in_shell("run"));
    CAPTURE(large.text);
    CHECK(large.code == 3);
    CHECK(large.has("error[out-of-memory]"));
    CHECK(large.has("larger mesh.size"));
}

TEST_CASE("a run whose memory runs out on the way is a failed one") {
    const Folder folder("memory_of_run");
    const std::filesystem::path record = folder.path / "run" / "run.json";
    int kilobytes = 96'000;  // more and more, until the model fits and the run does not
    for (; kilobytes < 400'000 && !std::filesystem::exists(record); kilobytes += 4'000)
        command("--version >/dev/null; ulimit -v " + std::to_string(kilobytes) +
                "; '" KNAP_PROGRAM "' run edge_cracked_block -q -j 1 --until 1us -s 'mesh.size=0.4 mm' -o " +
                folder.in_shell("run"));
    CAPTURE(kilobytes);
    REQUIRE(std::filesystem::exists(record));
    const std::string json = text_of(record);
    CHECK(json.find("\"status\": \"failed\"") != json.npos);
    CHECK(json.find("out of memory") != json.npos);
}
#endif

}  // namespace commands_test
