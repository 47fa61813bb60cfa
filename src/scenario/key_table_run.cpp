// The rows of the key table for [time], what a run writes, and studies of many runs.
#include "figures/figures.hpp"
#include "record/outputs.hpp"
#include "scenario/key_table.hpp"
#include "scenario/scenario.hpp"

namespace knap {
namespace {

std::vector<std::string> summary_names() {
    std::vector<std::string> names;
    for (const Output& output : output_table("summary").rows) names.emplace_back(output.name);
    return names;
}

}  // namespace

// clang-format off
void add_keys_of_run(KeyTable& t) {
    t.table("time", "time and the stepper").required();
    t.number("end", "s", "time simulated").above(0).required().to(&TimeOptions::end);
    t.word("bulk", {"explicit", "implicit"},
        "explicit: lumped mass, steps up to the stable one; implicit: theta scheme, steps of any size")
        .otherwise("explicit");
    t.word("cohesion", {"explicit", "implicit"},
        "explicit: cohesion frozen over a step; implicit: part of the complementarity problem").otherwise("explicit");
    t.number("step", "s",
        "step, also as a multiple of the stable step of the explicit bulk, \"20 CFL\"; auto: safety x stable step, "
        "with the implicit bulk 20 CFL").above(0).or_word("auto").otherwise("\"auto\"");
    t.number("step_cracking", "s", "the largest step from the first loss of cohesion on; CFL as in time.step")
        .above(0).computed("time.step");
    t.number("step_min", "s", "a run that needs a smaller step stops; CFL as in time.step")
        .above(0).computed("2^-20 time.step_cracking");
    t.number("safety", "", "fraction of the stable step that auto takes")
        .above(0).at_most(1).otherwise("0.8").to(&TimeOptions::safety);
    t.number("theta", "",
        "of the implicit bulk and the implicit cohesion: 0.5 keeps the energy, more damps; at most 1/(1 + "
        "restitution)").at_least(0.5).at_most(1).otherwise("0.5").to(&SchemeOptions::theta);
    t.word("mass", {"lumped", "consistent", "one point"},
        "mass matrix of a triangle; consistent: the exact integral; one point: from its centroid alone; both with "
        "the implicit bulk only").otherwise("lumped");
    t.word("start", {"rest", "equilibrium"}, "rest: undeformed; equilibrium: deformed by the loads at t = 0")
        .otherwise("rest");
    t.word("assumption_1", {"respect", "ignore"},
        "implicit cohesion: where a step has several solutions, cut it (respect) or take one of them (ignore)")
        .otherwise("respect");

    t.table("output", "what is written");
    t.number("every", "s", "between two field frames").above(0).computed("time.end/40").to(&OutputOptions::every);
    t.number("history_every", "s", "between two lines of energy.csv and cracks.csv")
        .above(0).computed("time.end/400").to(&OutputOptions::history_every);
    t.number("checkpoint_every", "s",
        "wall time between two checkpoints; an unfinished run goes on from the last one when it is started again")
        .at_least(0).otherwise("60").to(&OutputOptions::checkpoint_every);
    t.flag("fields", "write .vtu frames").otherwise("true").to(&OutputOptions::fields);
    t.flag("breaks",
        "write breaks.csv: a line for every interface that breaks, with time, place, direction, length, mode (part "
        "of sliding in it) and energy")
        .computed("true with a specimen or a figure that needs them").to(&OutputOptions::breaks);

    t.table("specimen",
        "the body is the specimen of a rock test: stress_strain.csv, strength, moduli, crack initiation and damage");
    t.word("test", {"compression", "tension", "brazilian", "bending"},
        "what the stress is: force over width x thickness, of a disc 2 P/(pi height thickness), of a beam 3 P "
        "span/(2 height^2 thickness); compression and shortening are positive but in tension").required();
    t.text("force", "whose reaction is the force: name of an obstacle, or of a load that prescribes a motion")
        .required();
    t.word("axis", {"x", "y"}, "direction of the test").otherwise("y");
    t.number("height", "m", "along the axis: diameter of a disc, height of a beam (of the ligament above a notch)")
        .above(0).computed("that of the body").to(&SpecimenOptions::height);
    t.number("width", "m", "across").above(0).computed("that of the body").to(&SpecimenOptions::width);
    t.number("span", "m", "between the supports")
        .above(0).required().only_with("test", {"bending"}).to(&SpecimenOptions::span);
    t.text("axial", "the two ends of the axial gauge, each a boundary (mean along it), a probe, an obstacle or a load")
        .list().computed("the travel of what gives the force, over the height (the other end stands still)");
    t.text("lateral", "the two ends of the lateral gauge, likewise; none: no Poisson's ratio, no volumetric strain")
        .list().only_with("test", {"compression", "tension"});
    t.number("modulus_between", "", "parts of the peak between which modulus and Poisson's ratio are fitted")
        .pair().at_least(0).at_most(1).otherwise("[0.4, 0.6]");

    t.list("probe[]", "a place that is watched; goes to probes.csv");
    t.number("at", "m", "where; outside of the body the nearest vertex").pair().required().to(&ProbeOptions::at);
    t.word("watch", {"place", "interface"},
        "place: displacement and velocity; interface: opening, slip and cohesion of the nearest one that can break, "
        "mean of its points").otherwise("place");
    t.text("name", "name of its columns").computed("probe1, probe2, ...").to(&ProbeOptions::name);

    t.list("figure[]", "a picture that the run draws");
    t.text("file", "file name, .png, .svg or .pdf; with several times the time is put into it")
        .required().to(&FigureOptions::file);
    t.word("show", figure_subjects(), "what it shows").otherwise("cracks").to(&FigureOptions::show);
    t.number("at", "s",
        "times; with several the pictures share their colour range and are drawn at the end, from frames that are "
        "kept").one_or_list().at_least(0).computed("time.end").to(&FigureOptions::at);
    t.word("colour", figure_colours(),
        "what colours the cracks; mode (0 opened, 1 slid) and break_time need output.breaks")
        .otherwise("opening").to(&FigureOptions::colour);
    t.word("over", figure_abscissas(), "what reactions are drawn over")
        .otherwise("displacement").to(&FigureOptions::over);
    t.number("deform", "", "exaggeration of the displacement").at_least(0).otherwise("1").to(&FigureOptions::deform);
    t.number("box", "m", "the part that is shown; a colour range from the data is that of what lies inside")
        .box().computed("the whole body").to(&FigureOptions::box);
    t.number("aspect", "", "of a slender body: how much larger the short side is drawn than the long one")
        .at_least(1).at_most(1000).otherwise("1").to(&FigureOptions::aspect);
    t.number("range", "*", "colour range, in the unit of what is shown").pair().computed("from the data");
    t.integer("width", "width in pixels").at_least(200).at_most(20000).otherwise("1600").to(&FigureOptions::width);
    t.text("title", "title above the picture").otherwise("").to(&FigureOptions::title);
    t.flag("panel",
        "bare: without title, legend and axes of a body, and its frame is kept; knap sweep draws those of all runs "
        "with one colour range").otherwise("false").to(&FigureOptions::panel);

    t.table("limits",
        "how far a run may go beyond what knap computes (README, Limits) before it ends; a warning comes as early as "
        "without");
    t.number("penetration", "m", "how deep two sides in contact may be in each other")
        .above(0).or_word("none").computed("the critical opening, or a thousandth of the body");
    t.number("law_lag", "",
        "largest part of the dissipated energy by which the work of the interfaces misses their law (law lag)")
        .above(0).or_word("none").otherwise("0.2");
    t.number("rotation", "deg", "of a triangle").above(0).or_word("none").computed("30 deg, warned of from 5 deg");
    t.number("area_change", "", "of a triangle over its area; one that turns by an angle a grows by tan a squared")
        .above(0).or_word("none").computed("1/3, warned of from 5 %");
    t.number("slip", "",
        "of a point under pressure, in lengths of its edge; what slides along a straight support or an obstacle "
        "has none").above(0).or_word("none").computed("1, warned of from 0.5");
    t.number("overlap", "m2", "area that the deformed body covers twice").above(0).or_word("none")
        .computed("ten of the triangles that lie there, or a thousandth of the body; warned of from a tenth of one");

    t.names("expect", "what the run must find, by number of its summary: a bound, or value and within");
    t.table("expect.*", "bounds on one number").words = summary_names();
    t.number("below", "*", "less than this; a speed may be a multiple of the Rayleigh speed, \"0.65 cR\"")
        .to(&Expectation::below);
    t.number("above", "*", "more than this").to(&Expectation::above);
    t.number("at_least", "*", "this or more").to(&Expectation::at_least);
    t.number("at_most", "*", "this or less").to(&Expectation::at_most);
    t.number("value", "*", "this, up to `within`").to(&Expectation::value);
    t.number("within", "*", "allowed deviation from `value`, or relative: \"2 %\"")
        .at_least(0).to(&Expectation::within);
}

void add_keys_of_ensembles(KeyTable& t) {
    t.table("sweep", "what `knap sweep` varies: all combinations");
    t.text("set", "KEY=VALUE,VALUE,... as with its --set; commas in quotes and brackets are part of a value").list();
    t.integer("seeds", "every combination is run with this many seeds, from `seed` on").at_least(1).at_most(100000);
    t.word("quantities", summary_names(), "numbers of the summary in the table")
        .list().computed("with a specimen peak_stress and tangent_modulus, broken_length, dissipated, fragments");
    t.word("show", figure_subjects(), "what the contact sheet shows of every run").otherwise("cracks");

    t.table("study", "what `knap study` varies and compares");
    t.word("refine", {"step", "mesh", "both"},
        "what a level divides: time.step, the sizes of [mesh], or both; a step in CFL or auto follows the mesh by "
        "itself").computed("step");
    t.number("levels", "", "the divisors: 4 is a quarter of the step, 0.5 twice the step")
        .list().above(0).computed("[1, 2, 4, 8], with seeds [1]");
    t.integer("seeds", "statistics: every level is run with this many seeds, from `seed` on")
        .at_least(2).at_most(10000);
    t.word("schemes", {"all", "explicit/explicit", "explicit/implicit", "implicit/explicit", "implicit/implicit"},
        "pairs bulk/cohesion, a line of the diagram each; or line").list().computed("the scenario's own");
    t.word("reference", {"auto", "finest"},
        "what errors are taken from; auto: exact, else the value in [expect], else the finest run of the first line")
        .computed("auto");
    t.text("set", "KEY=VALUE in all runs, as with --set; \"KEY=\" leaves a key out").list();
    t.list("study.line[]", "a line of the diagram: a variant of the scenario");
    t.text("name", "what the key says").computed("its scheme");
    t.text("set", "KEY=VALUE in its runs").list();
    t.number("levels", "", "its divisors").list().above(0).computed("study.levels");
    t.list("study.quantity[]",
        "a number that is compared; without one those with a value in [expect], or external_work, dissipated, "
        "strain_energy and kinetic_energy");
    t.text("of",
        "a number of the summary, or a column of energy.csv, cracks.csv, reactions.csv, probes.csv or "
        "stress_strain.csv: its value at the end").required();
    t.number("at", "s", "the column's value at this time").at_least(0);
    t.number("reaches", "*", "the time when the column first reaches this");
    t.text("since",
        "another column: the time since that one reached the same; between two probes it is the speed of what runs by");
    t.flag("largest", "the column's largest value").computed("false");
    t.number("slope", "s",
        "between these two times: slope of the line of least squares through the column; of surface it is the "
        "crack's speed times G_c, free of the edges it jumps").pair().at_least(0);
    t.number("exact", "*", "what it should be");
    t.number("scale", "*", "errors are parts of this").above(0).computed("the reference, absolute if that is 0");
    t.text("name", "title of its table and figures").computed("from the rest");
}
// clang-format on

}  // namespace knap
