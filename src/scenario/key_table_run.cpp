// The rows of the key table for [time], outputs, and studies of many runs.
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
    t.table("time", "duration and time integration").required();
    t.number("end", "s", "end of the simulation").above(0).required().to(&TimeOptions::end);
    t.word("until", {"end", "rest"}, "rest: the run ends before time.end once the body is at rest: its kinetic energy "
        "stays below a part of the largest one so far and of the strain energy, and no load changes any more")
        .otherwise("end").to(&RestOptions::ends_run, {false, true});
    t.number("rest_below", "", "kinetic energy of rest, over its maximum and over the strain energy")
        .above(0).below(1).otherwise("1e-3").to(&RestOptions::below);
    t.number("rest_for", "s", "time for which the kinetic energy stays below that part").above(0)
        .computed("ten passages of a shear wave through all of the body").to(&RestOptions::duration);
    t.word("bulk", {"explicit", "implicit", "auto"}, "explicit: central differences with lumped mass, limited to the "
        "stable step; implicit: theta scheme, steps of any size; auto: implicit while nothing moves fast, explicit "
        "where a crack runs until the body is quiet")
        .otherwise("explicit").to(&SchemeOptions::bulk, {BulkScheme::explicit_lumped, BulkScheme::implicit_theta,
                                                         BulkScheme::automatic});
    t.number("quiet_below", "", "kinetic energy over strain energy and energy of broken interfaces, below which the "
        "body counts as quiet, so that implicit steps go on, unless it exceeds this part of the strain energy alone "
        "and still halves within quiet_for; both energies count as at least the fracture energy of the weakest "
        "point. Motion whose kinetic energy would change by no more in the largest step (a slide at one speed) counts "
        "as quiet, too; with bulk = \"auto\"").above(0).below(1).otherwise("1e-4")
        .to(&SchemeChangeOptions::quiet_below);
    t.number("quiet_for", "s", "time for which it must be quiet; with bulk = \"auto\"").above(0)
        .computed("two passages of a shear wave through all of the body").to(&SchemeChangeOptions::quiet_for);
    t.word("cohesion", {"explicit", "implicit"}, "explicit: cohesion beta constant during a step and updated at its "
        "end; implicit: unknown of the step")
        .otherwise("explicit").to(&SchemeOptions::cohesion,
                                  {CohesionScheme::explicit_beta, CohesionScheme::implicit_beta});
    t.number("step", "s", "time step, also as a multiple of the stable step of the explicit bulk, \"20 CFL\"; auto: "
        "safety times the stable step, 20 CFL with the implicit bulk, time.end/400 (at least 200 CFL) with bulk = "
        "\"auto\", whose explicit steps follow from safety")
        .above(0).or_word("auto").or_multiple_of({"CFL"}).otherwise("\"auto\"").to(&TimeOptions::step);
    t.number("step_cracking", "s", "maximum step from the first loss of cohesion on; with bulk = \"auto\" the "
        "smallest implicit step: where it fails, explicit ones go on; CFL as in time.step")
        .above(0).or_multiple_of({"CFL"}).computed("time.step; 200 CFL with bulk = \"auto\"")
        .to(&TimeOptions::step_cracking);
    t.number("step_min", "s", "minimum step; a run that needs a smaller one fails; CFL as in time.step")
        .above(0).or_multiple_of({"CFL"}).computed("2^-20 time.step_cracking").to(&TimeOptions::step_min);
    t.number("safety", "", "step over stable step with step = \"auto\" and the explicit bulk")
        .above(0).at_most(1).otherwise("0.8").to(&TimeOptions::safety);
    t.number("mass_scaling", "", "largest part of the mass of the body that moves to the triangles that limit the "
        "explicit step, slivers at joints, from their neighbours of the same material, so that steps are as long as it "
        "allows; each neighbour gives at most a quarter of its mass. No mass moves over cracks, laws with sigma_c = 0 "
        "and outlines of excavations: what they cut out keeps its mass, weight and momentum. A block that breaks out "
        "later, along joints with cohesion, too, keeps what moved over its edges. run.json says what moved where")
        .at_least(0).at_most(0.05).otherwise("0").to(&TimeOptions::mass_scaling);
    t.number("theta", "", "parameter of the implicit bulk and the implicit cohesion: 0.5 conserves energy, larger "
        "values damp; at most 1/(1 + restitution)").at_least(0.5).at_most(1).otherwise("0.5").to(&SchemeOptions::theta);
    t.word("mass", {"lumped", "consistent", "one point"}, "mass matrix of a triangle: lumped at its nodes, the exact "
        "integral, or one quadrature point at the centroid; the last two with the implicit bulk only")
        .otherwise("lumped").to(&SchemeOptions::mass,
                                {MassMatrix::lumped, MassMatrix::consistent, MassMatrix::one_point});
    t.number("damping", "Hz", "mass-proportional damping alpha, in 1/s: forces -alpha m v; "
        "vibrations decay as exp(-alpha t/2), a drift of a body that is held as exp(-alpha t)")
        .at_least(0).otherwise("0").to(&SchemeOptions::damping);
    t.word("damping_of", {"vibration", "motion"}, "what time.damping acts on in pieces that nothing holds: v minus the "
        "rigid motion of the piece, so that flight, fall, roll and slide are braked by impacts and friction alone "
        "(free obstacles then have none); or v (until 0.1). Cohesion with a support, a prescribed motion or an "
        "absorbing boundary holds a piece, contact does not")
        .otherwise("vibration").to(&SchemeOptions::damping_of, {DampingOf::vibration, DampingOf::motion});
    t.word("start", {"rest", "equilibrium", "run:*"}, "initial state: undeformed; in static equilibrium with the "
        "loads at t = 0, held by supports, contact, friction and cohesion; or \"run:DIR@40us\": the state of the run "
        "in DIR, relative to the scenario file, at that time (of output.states, or of a checkpoint), with its damage "
        "and its energy balance; \"run:DIR\": the last state that it kept. Rotations may be large instead of small; "
        "[contact], [rigid], and obstacles behind those that were there may be added; [heat] may be left out where no "
        "law follows the temperature, or frozen; an [[excavation]] that comes after the end of the other run may have "
        "another time; else the body must be the same. Loads, [time] but its mass, outputs, probes, collectors, "
        "limits and motions of obstacles may be others; the time counts from 0 again, and with it times of results: "
        "what happened before the start has a negative one")
        .otherwise("rest").to(&TimeOptions::start_in_equilibrium, {false, true, false});
    t.word("assumption_1", {"respect", "ignore"}, "steps of the implicit cohesion that may have several solutions "
        "(softening faster than the step resolves): repeat with a smaller step, or accept one of the solutions")
        .otherwise("respect").to(&SchemeOptions::respect_assumption_1, {true, false});

    t.table("output", "output intervals and files");
    t.number("every", "s", "time between two field frames, and between two lines of the tables of fragments and "
        "trajectories").above(0).computed("time.end/40").to(&OutputOptions::every);
    t.number("frame_every", "s", "time between two field frames, where it is another one; the last frame is written "
        "in any case, and runs of a sweep keep it alone").above(0).computed("output.every")
        .to(&OutputOptions::frame_every);
    t.number("history_every", "s", "time between two lines of energy.csv and the other histories")
        .above(0).computed("time.end/400").to(&OutputOptions::history_every);
    t.number("checkpoint_every", "s", "wall time between two checkpoints; the same command continues an interrupted "
        "run from its last checkpoint").at_least(0).otherwise("60").to(&OutputOptions::checkpoint_every);
    t.number("states", "s", "times at which the whole state is kept, for other runs that start from it (time.start)")
        .one_or_list().above(0).computed("none").to(&OutputOptions::states);
    t.flag("fields", "write .vtu frames").otherwise("true").to(&OutputOptions::fields);
    t.word("compression", {"none", "lz4", "zlib"}, "of .vtu frames: lz4 halves them and takes half as long again, "
        "which ParaView, VTK and knap.py read, but meshio does not; zlib leaves 40 % and takes eight times as long")
        .otherwise("none").to(&OutputOptions::compression, {Compression::none, Compression::lz4, Compression::zlib});
    t.flag("report", "write report.html, a page with figures, frames, numbers and warnings; of studies and sweeps, "
        "too; while a run goes on it shows its progress and loads itself again (not with --quiet)")
        .otherwise("true").to(&OutputOptions::report);
    t.flag("trajectories", "write trajectories.csv, a small table of the pieces that move, in place of "
        "fragment_paths.csv: a sweep draws the ways of all its runs from it; in sweeps with random members of pieces "
        "that turn or fly it is on").otherwise("false").to(&OutputOptions::trajectories);
    t.flag("breaks", "write breaks.csv, a line for every broken interface: time, place, direction, length, mode (part "
        "of sliding) and energy")
        .computed("true with a specimen or a figure that needs them").to(&OutputOptions::breaks);

    t.table("specimen", "the body as the specimen of a rock test: writes stress_strain.csv, strength, moduli, stresses "
        "of crack initiation and crack damage");
    t.word("test", {"compression", "tension", "brazilian", "bending"}, "kind of test and its stress for the force P: "
        "P/(width thickness); of a disc 2 P/(pi height thickness); of a beam 3 P span/(2 height^2 thickness); stress "
        "and shortening are positive, in tension stress and elongation")
        .required().to(&SpecimenOptions::test, {SpecimenOptions::Test::compression, SpecimenOptions::Test::tension,
                                                SpecimenOptions::Test::brazilian, SpecimenOptions::Test::bending});
    t.text("force", "name of the obstacle, or of the load with prescribed motion, whose reaction is the force P")
        .required();
    t.word("axis", {"x", "y"}, "direction of the test").otherwise("y").to(&SpecimenOptions::axis, {0, 1});
    t.number("height", "m", "size along the axis: diameter of a disc, height of a beam (of its ligament above a notch)")
        .above(0).computed("that of the body").to(&SpecimenOptions::height);
    t.number("width", "m", "size across the axis").above(0).computed("that of the body").to(&SpecimenOptions::width);
    t.number("span", "m", "distance of the supports of a beam")
        .above(0).required().only_with("test", {"bending"}).to(&SpecimenOptions::span);
    t.text("axial", "ends of the axial gauge: two boundaries (mean displacement), probes, obstacles or loads")
        .pair().computed("the displacement of `force` over the height, the other end fixed");
    t.text("lateral", "ends of the lateral gauge, likewise; without it no Poisson's ratio and no volumetric strain")
        .pair().only_with("test", {"compression", "tension"});
    t.number("modulus_between", "", "stress interval of the fit of modulus and Poisson's ratio, over the peak stress")
        .pair().at_least(0).at_most(1).otherwise("[0.4, 0.6]").to(&SpecimenOptions::modulus_between);
    t.number("window", "s", "time over which stress and strains are averaged for strength, moduli and other numbers of "
        "the summary: the reaction of one explicit step oscillates with the mesh")
        .above(0).computed("time.end/400").to(&SpecimenOptions::window);

    t.list("probe[]", "a point whose motion, interface whose opening, or box whose mean stress is written to "
        "probes.csv");
    t.number("at", "m", "position in the undeformed body; outside the body the nearest point of its boundary")
        .pair().required().only_with("watch", {"place", "interface", "tip"}).to(&ProbeOptions::at);
    t.word("watch", {"place", "interface", "stress", "tip"}, "place: displacement and velocity of the point; "
        "interface: opening, slip and cohesion of the nearest interface that can open, averaged over its points (of "
        "pre-cracks, supports, joints and edges the one whose edge is nearest; of those equally near, as at a vertex, "
        "in this order); stress: mean stress in a box; tip: stress intensity factors and J of the nearest tip of a "
        "pre-crack while it stands. knap check, log.txt and run.json say which it took")
        .otherwise("place").to(&ProbeOptions::watch, {ProbeOptions::Watch::place, ProbeOptions::Watch::interface,
                                                     ProbeOptions::Watch::stress, ProbeOptions::Watch::tip});
    t.number("radius", "m", "radius of the domain over which a tip is integrated: many edges, and inside it only the "
        "straight crack in one material. Temperatures, a fluid in the crack, contact of its faces and uniform body "
        "forces are taken into account; other loads inside it are refused")
        .above(0).required().only_with("watch", {"tip"}).to(&ProbeOptions::radius);
    t.number("box", "m", "lower left and upper right corner of the box of a mean stress, in the undeformed body: "
        "its triangles move on; without it the whole body")
        .box().only_with("watch", {"stress"}).to(&ProbeOptions::box);
    t.text("name", "prefix of its columns").a_name().computed("probe1, probe2, ...").to(&ProbeOptions::name);

    t.list("collector[]", "a line that counts the pieces passing through it, fragments of the body and free obstacles: "
        "passages.csv has time, mass, size, height, velocity, spin and energies of each, the summary their statistics");
    t.number("from", "m", "one end, such as the foot of a barrier").pair().to(&CollectorOptions::from);
    t.number("to", "m", "the other end").pair().to(&CollectorOptions::to);
    t.number("x", "m", "in place of both: a vertical without ends; heights are those above obstacles that do not move "
        "freely").to(&CollectorOptions::x);
    t.word("direction", {"both", "forward", "backward"}, "passages that count; forward: from the left of the line to "
        "its right as seen from `from` to `to`, or towards larger x")
        .otherwise("both").to(&CollectorOptions::direction,
                              {CollectorOptions::Direction::both, CollectorOptions::Direction::forward,
                               CollectorOptions::Direction::backward});
    t.text("name", "prefix of its numbers in the summary").a_name().computed("collector1, collector2, ...")
        .to(&CollectorOptions::name);

    t.list("figure[]", "a picture drawn by the run");
    t.word("file", {"*.png", "*.svg", "*.pdf", "*.webp", "*.gif", "*.mp4"}, "file name; the time is added if "
        "there are several. An animation of the body ends in .webp, or where ffmpeg is installed in .gif or .mp4")
        .required().to(&FigureOptions::file);
    t.number("every", "s", "simulated time between two pictures of an animation").above(0).computed("output.every")
        .to(&FigureOptions::every);
    t.number("speed", "", "simulated time over time of the animation: 1e-5 shows 10 us in a second").above(0)
        .computed("all of it in 8 s").to(&FigureOptions::speed);
    t.word("curves", growing_subjects(), "curves that grow below the body in an animation").computed("none")
        .to(&FigureOptions::curves);
    t.word("show", figure_subjects(), "subject: cracks, a field of the body, or curves over time")
        .otherwise("cracks").to(&FigureOptions::show);
    t.number("at", "s", "times of pictures of the body; several pictures share one colour range and are drawn at the "
        "end of the run").one_or_list().at_least(0).computed("time.end").to(&FigureOptions::at);
    t.word("colour", figure_colours(), "colour of the cracks; mode (0 opening, 1 sliding) and break_time need "
        "output.breaks").otherwise("opening").to(&FigureOptions::colour);
    t.word("over", figure_abscissas(), "abscissa: of reactions displacement or time, of probes temperature (that of "
        "the probe) or time")
        .otherwise("displacement").to(&FigureOptions::over);
    t.number("deform", "", "magnification of displacements").at_least(0).otherwise("1").to(&FigureOptions::deform);
    t.number("box", "m", "visible part of the body; a colour range from the data is that of this part")
        .box().computed("the whole body").to(&FigureOptions::box);
    t.number("aspect", "", "magnification of the short side of a slender body against its long side")
        .at_least(1).at_most(1000).otherwise("1").to(&FigureOptions::aspect);
    t.number("range", "*", "colour range, in the unit of the quantity").pair().computed("from the data")
        .to(&FigureOptions::range);
    t.number("mark", "*", "values that are marked: isolines of a temperature; of probes and reactions vertical lines "
        "at these places of the abscissa").one_or_list().computed("none").to(&FigureOptions::mark);
    t.number("measured", "*", "points of an experiment, drawn as crosses: of a figure of the body [x, y] on the "
        "undeformed body [m], of curves pairs of abscissa and ordinate, plain numbers in SI units (strain and mass in "
        "%)").points().computed("none").to(&FigureOptions::measured);
    t.text("measured_by", "source of these points, as in the legend; required with them").otherwise("")
        .to(&FigureOptions::measured_by);
    t.integer("width", "width in pixels").at_least(200).at_most(20000).computed("1600, of an animation 800")
        .to(&FigureOptions::width);
    t.number("paper_width", "m", "width of .svg and .pdf files, as in \"84 mm\"; the colours of a body are a picture "
        "of at least 300 dpi in them").above(0).computed("198 mm").to(&FigureOptions::paper_width);
    t.number("font_size", "", "size of labels in points on paper; larger type leaves less room").at_least(4).at_most(40)
        .computed("8 with paper_width").to(&FigureOptions::font_size);
    t.text("title", "title; empty: that of the scenario").otherwise("").to(&FigureOptions::title);
    t.flag("panel", "without title, legend and axes, as a panel of a contact sheet: knap sweep draws the panels of all "
        "runs with one colour range").otherwise("false").to(&FigureOptions::panel);

    t.table("limits", "limits of the assumptions of the model (README, Limits): a run that exceeds one fails; with "
        "\"none\" it only warns");
    t.number("contact_depth", "", "maximum penetration of free faces that meet over the length of the edge; deeper "
        "steps are repeated with a smaller size, and the run ends where that does not help")
        .above(0).or_word("none").otherwise("0.1");
    t.number("penetration", "m", "maximum interpenetration of two sides in contact")
        .above(0).or_word("none").computed("the critical opening, or a thousandth of the body");
    t.number("law_lag", "", "maximum difference between the work of the interfaces and the energy of their law, over "
        "the dissipated energy").above(0).or_word("none").otherwise("0.2");
    t.number("rotation", "deg", "maximum rotation of a triangle, without domain.rotation = \"large\"")
        .above(0).or_word("none").computed("30 deg, warning from 5 deg");
    t.number("strain", "", "maximum principal strain of a triangle, with domain.rotation = \"large\"")
        .above(0).or_word("none").computed("none, warning from 5 %");
    t.number("area_change", "", "maximum relative change of the area of a triangle; without domain.rotation = "
        "\"large\" a rotation by a changes it by tan^2(a)")
        .above(0).or_word("none").computed("1/3, warning from 5 %; 0.7 with domain.rotation = \"large\"");
    t.number("rotation_work_part", "", "maximum defect of the elastic energy by large rotations over "
        "the largest energy").above(0).or_word("none").otherwise("0.001");
    t.number("temperature_overshoot", "", "maximum excess of a temperature over those around it, over the largest "
        "difference; with conduction").above(0).or_word("none").computed("0.05, warning from 0.001");
    t.number("obstacle_overlap", "m", "maximum depth of a free obstacle in another obstacle or a support")
        .above(0).or_word("none").computed("a thousandth of the body, warning from a tenth of that");
    t.number("obstacle_depth", "", "maximum depth of an edge of the body in an obstacle over the length of the edge, "
        "or half the width of the obstacle if that is less")
        .above(0).or_word("none").computed("0.1, warning from 0.05");
    t.number("slip", "", "maximum slip of a point under pressure over the length of its edge; not of sliding along "
        "straight supports and obstacles").above(0).or_word("none").computed("1, warning from 0.5");
    t.number("overlap", "m2", "maximum area that the deformed body covers twice").above(0).or_word("none")
        .computed("ten triangles, or a thousandth of the body; warning from a tenth of a triangle");

    t.names("expect", "expected results, by number of the summary: bounds, or value and within; a run that misses one "
        "has the exit code 4");
    t.table("expect.*", "bounds of one number").words = summary_names();
    t.number("below", "*", "less than this; a speed also as a multiple of the Rayleigh wave speed, \"0.65 cR\"")
        .or_multiple_of({"cR"}).to(&Expectation::below);
    t.number("above", "*", "more than this").or_multiple_of({"cR"}).to(&Expectation::above);
    t.number("at_least", "*", "this or more").or_multiple_of({"cR"}).to(&Expectation::at_least);
    t.number("at_most", "*", "this or less").or_multiple_of({"cR"}).to(&Expectation::at_most);
    t.number("value", "*", "this value, with the deviation `within`").or_multiple_of({"cR"}).to(&Expectation::value);
    t.number("within", "*", "allowed deviation from `value`, absolute or relative (\"2 %\")")
        .at_least(0).or_multiple_of({"cR", "%"}).to(&Expectation::within);
}

void add_keys_of_calibration(KeyTable& t) {
    t.table("toughness", "what G_c means where cracks run along the edges of a random mesh; as a text: toughness = "
        "\"as measured\", above all tables").or_text("meaning");
    t.word("meaning", {"of interfaces", "as measured"}, "of interfaces: G_c is what an interface dissipates, and an "
        "advance of a crack costs 1.1 to 1.4 times as much; as measured: G_c of the laws within materials is that of a "
        "specimen, and the interfaces get G_c over the surplus of this mesh, order and gamma")
        .otherwise("of interfaces");
    t.text("table", "file of `knap calibrate` with the surplus, relative to the scenario file")
        .computed("a table of the program for glass: BENCHMARKS.md, Toughness of the mesh")
        .only_with("meaning", {"as measured"});

    t.table("strength", "what sigma_c means in bodies that break by compression; as a text: strength = "
        "\"as measured\", above all tables").or_text("meaning");
    t.word("meaning", {"of interfaces", "as measured"}, "of interfaces: sigma_c is that of an interface, and a "
        "specimen with a random mesh has up to 1.3 times the strength that follows (strength_ratio); as measured: "
        "sigma_c of the laws within materials is chosen so that the law gives the measured strength (law_strength), "
        "and the interfaces get sigma_c over the surplus of such specimens; G_c stays")
        .otherwise("of interfaces").to(&StrengthOptions::as_measured, {false, true});
    t.word("test", {"compression", "brazilian"}, "test by which the strength was measured: a plate under uniaxial "
        "compression, or a disc; also of the specimens of `knap calibrate --of strength`")
        .computed("that of [specimen], else compression")
        .to(&StrengthOptions::test, {SpecimenOptions::Test::compression, SpecimenOptions::Test::brazilian});
    t.number("size", "m", "width of the tested plate, which is twice as high, or diameter of the disc; likewise")
        .above(0).computed("that of [specimen]");
    t.text("table", "file of `knap calibrate --of strength` with the surplus, relative to the scenario file")
        .computed("a table of the program: BENCHMARKS.md, Strength as measured")
        .only_with("meaning", {"as measured"});
}

void add_keys_of_ensembles(KeyTable& t) {
    t.table("sweep", "parameter study of `knap sweep`: runs of all combinations");
    t.text("set", "varied keys, each as KEY=VALUE,VALUE,... ; commas in quotes and brackets belong to a value")
        .list().to(&SweepOptions::set);
    t.integer("seeds", "number of seeds of every combination, counted from `seed`")
        .at_least(1).at_most(100000).to(&SweepOptions::n_seeds);
    t.word("quantities", summary_names(), "numbers of the summary in the table of results").list()
        .computed("with a specimen peak_stress and tangent_modulus, broken_length, dissipated, fragments; of every "
            "collector NAME NAME_passages, NAME_largest_energy, NAME_largest_height")
        .to(&SweepOptions::quantities);
    t.word("show", figure_subjects(), "subject of the contact sheet").computed("cracks; with random members no sheet")
        .to(&SweepOptions::show);
    t.table("sweep.random", "members of every combination, for which keys are drawn at random");
    t.integer("members", "their number").at_least(1).at_most(100000).required().to(&RandomMembers::n);
    t.integer("seed", "seed of what is drawn: the values of a member depend on it, on its number and on the key only")
        .at_least(0).computed("`seed`").to(&RandomMembers::seed);
    t.text("file", "csv file whose columns are keys, with units as in `interface.default.sigma_c [Pa]`: each member "
        "draws one line, as of the posterior.csv of knap-fit");
    t.list("sweep.random.vary[]", "a key that is drawn anew for every member; with one of uniform, normal, lognormal "
        "and choice");
    t.text("key", "key of a number, as body.boulder.shift.x, body.boulder.spin, obstacle.terrain.friction, seed: after "
        "a list the name of an entry, after a pair its component x or y").required().to(&RandomKey::key);
    t.number("uniform", "*", "smallest and largest value, in the unit of the key").pair();
    t.number("normal", "*", "mean and standard deviation").pair();
    t.number("lognormal", "*", "mean and standard deviation of the values themselves").pair();
    t.number("within", "*", "of normal and lognormal: values outside of these two are drawn again").pair();
    t.text("choice", "values of which each is as likely; one that occurs twice is twice as likely").list().any_value()
        .to(&RandomKey::choices);

    t.table("study", "convergence study, statistics or search for a factor of safety of `knap study`");
    t.word("refine", {"step", "mesh", "both"}, "what a level divides: time.step, the sizes of [mesh], or both; a step "
        "in CFL or auto follows the mesh by itself").computed("step")
        .to(&StudyOptions::refine, {Refine::step, Refine::mesh, Refine::both});
    t.number("levels", "", "divisors: 4 is a quarter of the step, 0.5 twice the step")
        .list().above(0).computed("[1, 2, 4, 8], with seeds [1]");
    t.integer("seeds", "number of seeds of every level, counted from `seed`, for statistics")
        .at_least(2).at_most(10000).to(&StudyOptions::n_seeds);
    t.word("schemes", {"all", "explicit/explicit", "explicit/implicit", "implicit/explicit", "implicit/implicit"},
        "compared schemes bulk/cohesion, each a line of the diagram; either schemes or line")
        .list().computed("the scenario's own");
    t.word("reference", {"auto", "finest"}, "reference of errors; auto: the exact value, else the value in [expect], "
        "else the finest run of the first line").computed("auto").to(&StudyOptions::against_finest, {false, true});
    t.text("set", "KEY=VALUE for all runs, as with --set; \"KEY=\" removes a key").list().to(&StudyOptions::set);
    t.table("study.safety", "`knap study --safety`: bisection for the factor of safety F, by which c = sigma_c (gamma "
        "+ friction) (norm: sigma_c gamma) and tan phi = friction of laws are divided at the same time; gamma and "
        "delta_c stay");
    t.text("laws", "names of interface laws, as `joint` of [interface.joint]").list()
        .computed("all that may break or slide").to(&SafetyOptions::laws);
    t.number("factors", "", "between which F is searched: at the first one the body must stand, at the second one not")
        .pair().above(0).computed("[1, 3]").to(&SafetyOptions::factors);
    t.number("tolerance", "", "width of the last bracket over F").above(0).below(1).computed("0.005")
        .to(&SafetyOptions::tolerance);
    using Criterion = SafetyOptions::Criterion;
    t.word("criterion", {"rest", "runaway"}, "rest: what is at rest before time.end, without a displacement of "
        "`runaway`, stands (the runs have time.until = \"rest\"); runaway: whatever has no such displacement at "
        "time.end, moving or not. A run without equilibrium at its start, or that violates a gate, does not stand")
        .computed("rest").to(&SafetyOptions::criterion, {Criterion::rest, Criterion::runaway});
    t.number("runaway", "m", "largest displacement at the end that stands").above(0)
        .computed("a hundredth of the diagonal of the body").to(&SafetyOptions::runaway);
    t.list("study.line[]", "a line of the diagram: a variant of the scenario");
    t.text("name", "name in the legend").computed("its scheme").to(&StudyLine::name);
    t.text("set", "KEY=VALUE for its runs").list().to(&StudyLine::set);
    t.number("levels", "", "its divisors").list().above(0).computed("study.levels").to(&StudyLine::levels);
    t.list("study.quantity[]", "a compared number; without one those with a value in [expect], or external_work, "
        "dissipated, strain_energy and kinetic_energy");
    t.text("of", "a number of the summary, or a column of energy.csv, cracks.csv, reactions.csv, probes.csv or "
        "stress_strain.csv, of which the last value counts").required().to(&StudyQuantity::of);
    t.number("at", "s", "time of the compared value of the column").at_least(0).to(&StudyQuantity::at);
    t.number("reaches", "*", "value of the column; compared is the time at which the column first reaches it")
        .to(&StudyQuantity::reaches);
    t.text("since", "another column; compared is the time from its reaching the value to that of the first column, as "
        "for the speed of a wave between two probes").to(&StudyQuantity::since);
    t.flag("largest", "maximum of the column").computed("false").to(&StudyQuantity::largest);
    t.number("slope", "s", "interval of time of the least-squares slope of the column; the slope of `surface` is the "
        "crack speed times G_c, without the jumps from edge to edge").pair().at_least(0).to(&StudyQuantity::slope);
    t.number("exact", "*", "exact value").to(&StudyQuantity::exact);
    t.number("scale", "*", "value by which errors are divided")
        .above(0).computed("the reference, or 1 if that is 0").to(&StudyQuantity::scale);
    t.text("name", "title of its table and figures").computed("from the other keys").to(&StudyQuantity::name);
}
// clang-format on

}  // namespace knap
