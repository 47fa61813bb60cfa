// dcb_displacement with interface edges of 0.01 mm against the algorithm it is taken from, on the same mesh in the same
// steps; what is ours on purpose, and what it changes: scenarios/BENCHMARKS.md.
#include "support/published_beam.hpp"
#include "app/program.hpp"
#include "support/relative.hpp"

#include "output/history_csv.hpp"

#include <sstream>

namespace published_beam_test {

using namespace program;
using knap::tests::PublishedBeam;
using knap::tests::relative;

namespace {

/// Reads what `knap mesh` writes (Gmsh 2.2, in m); the beam computes in mm.
PublishedBeam beam_of(const fs::path& file, const PublishedBeam::Options& options) {
    std::istringstream in(text_of(file));
    std::vector<std::array<double, 2>> nodes;
    std::vector<std::array<int, 3>> triangles;
    std::string word;
    int n = 0, number = 0, type = 0, n_tags = 0;
    double z = 0;
    while (in >> word && word != "$Nodes") {
    }
    in >> n;
    nodes.resize(n);
    for (auto& [x, y] : nodes) in >> number >> x >> y >> z, x *= 1e3, y *= 1e3;
    while (in >> word && word != "$Elements") {
    }
    in >> n;
    for (int i = 0; i < n; ++i) {
        in >> number >> type >> n_tags;
        for (int k = 0; k < n_tags; ++k) in >> word;
        std::array<int, 3> corners{};
        for (int k = 0; k < type + 1; ++k)
            in >> corners[k], --corners[k];  // type 1: a line of two nodes, 2: a triangle
        if (type == 2) triangles.push_back(corners);
    }
    REQUIRE(in);
    return {nodes, triangles, options};
}

const std::string coarse =
    "-s 'mesh.refine=[{ inside = [\"0 mm\", \"0 mm\", \"1.6 mm\", \"0.01 mm\"], size = \"10 um\" }]' ";
const std::string lean = "-q -j 1 -s output.fields=false -s 'expect={}' -s output.history_every=1e-12 " + undrawn;

struct Difference {
    double worst = 0, at_end = 0;  // of an energy, in parts of the largest
    double crack = 0;              // [mm] the largest
    double residual = 0;           // of the beam's own interface problem [mm/ms]
};

/// Until `end`, in the steps that knap took.
Difference difference(const Folder& folder, const PublishedBeam::Options& options, double end) {
    const knap::History energy = knap::read_csv(folder.path / "run/energy.csv"),
                        cracks = knap::read_csv(folder.path / "run/cracks.csv");
    const std::vector<double> step = energy.column("step"), kinetic = energy.column("kinetic"),
                              strain = energy.column("strain"), surface = energy.column("surface"),
                              crack = cracks.column("broken_length");
    PublishedBeam beam = beam_of(folder.path / "beam.msh", options);
    Difference found;
    double largest = 0;  // [mJ]
    for (std::size_t row = 1; row < step.size() && beam.time < end * (1 - 1e-9); ++row) {
        beam.step(1e3 * step[row]);
        const auto [W, T, Psi] = beam.energies();
        largest = std::max(largest, W + T + Psi);
        found.at_end = std::max(
            {std::abs(1e3 * strain[row] - W), std::abs(1e3 * kinetic[row] - T), std::abs(1e3 * surface[row] - Psi)});
        found.worst = std::max(found.worst, found.at_end);
        found.crack = std::max(found.crack, std::abs(1e3 * crack[row] - beam.crack()));
    }
    CHECK(beam.time == relative(end, 1e-9));
    found.worst /= largest;
    found.at_end /= largest;
    found.residual = beam.worst;
    return found;
}

void run_until(const std::string& end, const Folder& folder) {
    REQUIRE(command("mesh dcb_displacement " + coarse + "-o " + folder.in_shell("beam.msh")).code == 0);
    const Answer run =
        command("run dcb_displacement " + coarse + lean + "--until " + end + " -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
}

constexpr PublishedBeam::Options theirs{}, with_our_contact{.hovers = false},
    ours{.leaves_its_area = false, .hovers = false};

}  // namespace

TEST_CASE("dcb at 0.01 mm: the published algorithm until the crack runs") {
    const Folder folder("published beam begin");
    run_until("0.06ms", folder);
    const Difference same = difference(folder, with_our_contact, 0.06);  // the glue at the held end is far away
    CHECK(same.residual < 1e-12);
    CHECK(same.worst < 1e-10);
    CHECK(same.crack < 1e-9);
}

TEST_CASE("dcb at 0.01 mm: the published algorithm to the end" * doctest::test_suite("slow")) {
    const Folder folder("published beam");
    run_until("0.6ms", folder);
    SUBCASE("with our contact and our glue at the held end: the same") {
        const Difference same = difference(folder, ours, 0.6);
        CHECK(same.residual < 1e-12);
        CHECK(same.worst < 1e-10);
        CHECK(same.crack < 1e-9);
    }
    SUBCASE("with their glue at the held end: the same until the process zone is there") {
        const Difference same = difference(folder, with_our_contact, 0.55);
        CHECK(same.worst < 1e-10);
        CHECK(same.crack < 1e-9);
    }
    SUBCASE("in all as they do: what the two differences make") {
        const Difference before = difference(folder, theirs, 0.55), all = difference(folder, theirs, 0.6);
        MESSAGE("energies differ by ", before.worst, " until 0.55 ms, ", before.at_end, " there and ", all.at_end,
                " at 0.6 ms; crack by ", all.crack, " mm");
        CHECK(before.worst < 1e-4);
        CHECK(before.at_end < 1e-5);
        CHECK(before.crack < 0.011);  // [mm] an edge, for a step
        CHECK(all.at_end < 1e-3);
        CHECK(all.crack < 0.011);
    }
}

}  // namespace published_beam_test
