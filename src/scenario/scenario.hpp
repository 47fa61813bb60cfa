#pragma once
// A scenario: the options structs of the lower layers. SI throughout.
#include "analysis/collectors.hpp"
#include "analysis/energy_ledger.hpp"
#include "analysis/gates.hpp"
#include "analysis/probes.hpp"
#include "analysis/rest_watch.hpp"
#include "analysis/specimen.hpp"
#include "figures/figures.hpp"
#include "material/cohesive_law.hpp"
#include "material/elastic.hpp"
#include "mesh/shape.hpp"
#include "mesh/triangulate.hpp"
#include "microstructure/grains.hpp"
#include "microstructure/materials.hpp"
#include "microstructure/scatter.hpp"
#include "model/loads.hpp"
#include "model/model.hpp"
#include "model/obstacle.hpp"
#include "output/vtk_series.hpp"
#include "record/summary.hpp"
#include "scenario/ensemble_options.hpp"
#include "scenario/strength_options.hpp"
#include "scenario/surplus.hpp"
#include "scenario/toml_tree.hpp"
#include "stepper/adapt/adaptation.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/scheme_change.hpp"

#include <memory>

namespace knap {

struct NamedMaterial {
    std::string name;
    Elastic elastic;
    std::shared_ptr<const PlaceField> layer_angle = nullptr;  // [deg] in the place of the angle of its bedding
};

struct NamedLaw {
    std::string name;  // "default", or "a-b" for a pair of materials, or a free name used by a support
    CohesiveLaw law;
    Scatter scatter;
    StrengthOverBedding over_bedding;
    double measured_G_c = 0;  // [J/m2] with toughness = "as measured" G_c of the law times the surplus; 0: likewise G_c
    Surplus surplus = {};     // of the mesh, by which measured_G_c was divided
    double measured_sigma_c = 0;  // [Pa] likewise with strength = "as measured"
    Surplus strength_surplus = {};
};

/// A body that is meshed by itself.
struct Body {
    std::string name;  // empty: the body of [domain], the only one; else its boundaries are NAME.left, ...
    std::string path;  // of the table that defines it: "domain", "body[2]"
    Shape shape;
    MeshOptions mesh;                           // with a size and a seed of its own
    bool own_mesh_size = false;                 // mesh_size of the body is given
    std::vector<std::size_t> excavations = {};  // of Scenario; their outlines are the last regions of the shape
};

/// Consecutive bodies that one [[bodies]] makes.
struct BodyGroup {
    std::string name;
    std::size_t first, n;  // of Scenario::bodies
};

/// Grains that replace one material.
struct GrainedRock {
    GrainOptions grains;
    Index material = 0;  // the replaced one
    std::vector<Mineral> minerals;
};

/// A time step as given in a scenario.
struct StepLength {
    double value = 0;             // [s], or a multiple; 0 = not given
    bool of_stable_step = false;  // a multiple of the stable step of the explicit bulk ("20 CFL")
    double seconds(double stable_step) const { return of_stable_step ? value * stable_step : value; }
    bool operator==(const StepLength&) const = default;
};

template <>
inline std::optional<StepLength> value_as(const Node& node) {
    return node.is_number() ? std::optional(StepLength{node.number, node.unit == "CFL"}) : std::nullopt;  // "auto"
}

struct TimeOptions {
    double end = 0;  // [s]
    SchemeOptions scheme;
    StepLength step;           // 0 = auto
    StepLength step_cracking;  // from the first loss of cohesion on; 0 = step
    StepLength step_min;       // 0 = 2^-20 of the step
    double safety = 0.8;       // [-] fraction of the stable step used by "auto"
    double mass_scaling = 0;   // [-] part of the mass that may move to triangles which limit the step
    bool start_in_equilibrium = false;
    std::string start_run;  // from which the run starts, as given, and the time of its state; empty: none
    RestOptions rest;
    SchemeChangeOptions change;  // with BulkScheme::automatic; its explicit step follows from the mesh
};

struct OutputOptions {
    double every = 0;                             // [s] between field frames, and lines of fragments
    double frame_every = 0;                       // [s] between field frames; 0: every
    double history_every = 0;                     // [s] between lines of energy.csv and cracks.csv
    bool fields = true;                           // write .vtu frames
    Compression compression = Compression::none;  // of these
    bool breaks = false;                          // write breaks.csv
    bool trajectories = false;                    // write trajectories.csv in place of fragment_paths.csv
    bool report = true;                           // write report.html
    double checkpoint_every = 60;                 // [s] of wall time between checkpoints
    std::vector<double> states;                   // [s] at which the whole state is kept

    /// [s] Between field frames; 0: there are none.
    double between_frames() const { return !fields ? 0 : frame_every > 0 ? frame_every : every; }
};

/// A mesh that was read from a file.
struct MeshFile {
    Mesh mesh;                             // regions are the scenario's materials
    std::vector<std::string> others = {};  // surfaces of the file that are no material
    Index of_others = 0;                   // their material
};

/// The copy of a file of the scenario in a run directory.
struct NamedFile {
    std::string key;   // path of the key that names the file
    std::string name;  // in the run directory
    std::string bytes;
    std::string prefix = {};  // of the name in the value of the key
};

/// What one [[inclusions]], [[joints]] or [[traces]] placed: a part of one of the lists of the shape.
struct PlacedSet {
    std::string path;      // "inclusions[0]"
    std::size_t body = 0;  // of Scenario::bodies
    enum class Part { regions, holes, cracks } part;
    std::size_t first = 0;
    int n = 0;
    double fraction = 0;               // [-] of the area of the body; inclusions
    std::vector<int> file_lines = {};  // of each, in the file that has it; traces
    int n_cropped = 0;                 // lines of the file that lie outside the body; traces

    bool is_random() const { return file_lines.empty(); }  // else from a file
};

struct Scenario {
    std::string name, title;
    std::uint64_t seed = 1;
    std::vector<Body> bodies;  // none with a mesh file
    std::vector<BodyGroup> groups;
    std::shared_ptr<const MeshFile> given;  // null: the bodies are meshed
    PlaneModel plane = PlaneModel::strain;
    bool large_rotation = false;
    double thickness = 1;  // [m]
    MeshOptions mesh;      // of bodies that have no size of their own
    Index order = 1;       // of the displacement on a triangle
    std::vector<NamedMaterial> materials;
    std::vector<NamedLaw> laws;
    std::vector<std::vector<Index>> law_of_pair;
    std::vector<std::vector<ContactLaw>> contact_of_pair;  // of [contact], as in Model
    std::vector<Index> law_within;                         // within a grain, by material
    std::vector<Index> law_of_joint;                       // by number of the joint set, of the sets with cohesion
    std::vector<PlacedSet> placed_sets;
    /// The table to which line `i` of a list of a body's shape belongs: that which placed it, "joints[0]" or "traces[0]
    /// (line 12)", or else number `i` of the list at `path`.
    std::string table_of_part(std::size_t body, PlacedSet::Part part, std::size_t i, const std::string& path) const;
    std::vector<GrainedRock> rocks;
    std::vector<MaterialMap> maps;
    std::vector<NamedFile> files;  // copied to the run directory
    std::vector<Load> loads;
    std::vector<CrackPressure> crack_pressures;
    std::vector<Support> supports;
    std::vector<InitialVelocity> initial_velocities;  // those of the bodies, then [[initial]]
    std::vector<InitialStress> initial_stresses;
    std::vector<Obstacle> obstacles;
    std::vector<Excavation> excavations;
    AdaptOptions adapt;
    TimeOptions time;
    OutputOptions output;
    std::vector<ProbeOptions> probes;
    std::vector<CollectorOptions> collectors;
    std::optional<SpecimenOptions> specimen;
    StrengthOptions strength;
    std::vector<FigureOptions> figures;
    std::vector<AllowedLimit> allowed_limits;  // of [limits]
    std::vector<Expectation> expect;
    StudyOptions study;
    std::optional<Heat> heat;
    SweepOptions sweep;

    /// The file of the state from which the run starts; null: none.
    const NamedFile* start_file() const {
        const auto found = std::ranges::find(files, "time.start", &NamedFile::key);
        return found == files.end() ? nullptr : &*found;
    }
    /// [m] The smallest distance of interface points that is requested anywhere: an edge, of order 2 half an edge.
    double finest_edge(double mean_edge) const {
        for (const RefinedPlace& place : mesh.refine) mean_edge = std::min(mean_edge, place.size);
        if (adapt.active()) mean_edge = std::min(mean_edge, adapt.size);
        for (const Body& body : bodies)
            if (body.own_mesh_size) mean_edge = std::min(mean_edge, body.mesh.size);
        return mean_edge / order;
    }
    std::vector<std::string> boundary_names() const {
        std::vector<std::string> names;
        if (given) names = given->mesh.boundary_names, std::erase(names, "");
        for (const Body& body : bodies)
            names.insert(names.end(), body.shape.boundary_names.begin(), body.shape.boundary_names.end());
        return names;
    }
    /// Names of bodies and groups of them.
    std::vector<std::string> body_names() const {
        std::vector<std::string> names;
        for (const Body& body : bodies)
            if (!body.name.empty()) names.push_back(body.name);
        for (const BodyGroup& group : groups) names.push_back(group.name);
        return names;
    }
    RareWorks works() const {
        const auto any_law = [&](const auto& has) {
            return std::ranges::any_of(laws,
                                       [&](const NamedLaw& named) { return named.law.breakable() && has(named.law); });
        };
        return {.rotation = large_rotation,
                .damping = time.scheme.damping > 0,
                .viscosity = std::ranges::any_of(
                    materials, [](const NamedMaterial& named) { return named.elastic.has_viscosity(); }),
                .radiation = !time.scheme.absorbing.empty(),
                .excavation = !excavations.empty(),
                .adaptation = adapt.active(),
                .secant = any_law([](const CohesiveLaw& law) { return law.unloading == Unloading::secant; }),
                .heat = heat.has_value(),
                .conduction = heat && heat->conduction,
                .law_change = std::ranges::any_of(laws,
                                                  [](const NamedLaw& named) {
                                                      return named.law.of_temperature &&
                                                             !named.law.of_temperature->strength.empty();
                                                  }),
                .delay = any_law([](const CohesiveLaw& law) { return law.relaxation_time > 0; }),
                .incubation = any_law([](const CohesiveLaw& law) { return law.incubation_time > 0; }),
                .cohesive_friction =
                    any_law([](const CohesiveLaw& law) { return law.sigma_c > 0 && law.friction_range()[1] > 0; }),
                .rigid = time.scheme.rigid.active(),
                .mode_mix = any_law([](const CohesiveLaw& law) { return law.has_mode_mix(); })};
    }
    std::vector<std::string> material_names() const {
        std::vector<std::string> names;
        for (const NamedMaterial& material : materials) names.push_back(material.name);
        return names;
    }
};

}  // namespace knap
