// Deformable bodies rebound with R_N of what they hit, where they would with more, and keep R_T of their slip.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <tuple>

namespace rebound_test {

using namespace program;
using knap::tests::relative;

namespace {

const std::string rock =
    "[material.rock]\ndensity = 2700\nE = \"30 GPa\"\nnu = 0.25\n[interface.default]\nbreakable = false\n";

struct Rebound {
    double e;     // [-] -V_N+/V_N- at the point of contact
    double slip;  // [m/s] of the point of contact after it, 0.35 m below the centre
};

/// A body falls with 5 m/s or `speed`, and slides, on a plane at y = 0, which it touches below x = `contact`.
Rebound rebound_of(const Folder& folder, const std::string& shape, double contact, const std::string& law,
                   double slip = 0, double speed = 5) {
    write_scene(folder,
                "knap = 1\n[domain]\nrotation = \"large\"\n" + shape + rock +
                    "[[obstacle]]\nname = \"ground\"\nshape = \"half plane\"\nat = [0, -1e-4]\nnormal = [0, 1]\n" +
                    law + "[[initial]]\nvelocity = [" + std::to_string(slip) + ", " + std::to_string(-speed) +
                    "]\n[time]\nend = 0.004\n[output]\nevery = 1\nfields = false\nhistory_every = 0.004\n");
    const Answer answer = run_scene(folder, "-j 1 --force -s 'figure=[]' -o " + folder.in_shell("run"));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    const auto path = knap::read_csv(folder.path / "run/fragment_paths.csv");
    const auto last = [&](const char* column) { return path.column(column).back(); };
    const double before = path.column("centre_x").front();
    return {(last("velocity_y") + last("spin") * (contact - before)) / speed, last("velocity_x") + 0.35 * last("spin")};
}

std::string size(double h) { return "[mesh]\nsize = " + std::to_string(h) + "\n"; }

}  // namespace

TEST_CASE("rebound: discs and boulders and bars of three meshes have R_N within five percent") {
    const Folder folder("rebound");
    const std::string disc = "shape = \"disc\"\ncentre = [0, 0.35]\nradius = 0.35\n",
                      boulder =
                          "shape = \"polygon\"\npoints = [[-0.45, 0.2], [-0.1, 0], [0.3, 0.15], [0.5, 0.5], "
                          "[0.3, 0.9], [-0.15, 1], [-0.5, 0.65]]\n",
                      bar = "shape = \"polygon\"\npoints = [[0, 0], [0.25, 0], [0.25, 1], [0, 1]]\n";
    for (const auto& [shape, contact, h] : {std::tuple{disc, 0., 0.2},
                                            {disc, 0., 0.14},
                                            {disc, 0., 0.1},
                                            {boulder, -0.1, 0.3},
                                            {boulder, -0.1, 0.2},
                                            {boulder, -0.1, 0.14},
                                            {bar, 0.125, 0.12},
                                            {bar, 0.125, 0.1},
                                            {bar, 0.125, 0.07}})
        for (const double R_N : {0.3, 0.6}) {
            CAPTURE(shape);
            CAPTURE(h);
            CAPTURE(R_N);
            const std::string law = "R_N = " + std::to_string(R_N) + "\n";
            CHECK(rebound_of(folder, shape + size(h), contact, law).e == relative(R_N, 0.05));
        }
    CHECK(rebound_of(folder, disc + size(0.14), 0, "restitution = 0.3\n").e > 0.9);
    CHECK(rebound_of(folder, disc + size(0.14), 0, "R_N = 1\n").e > 0.9);
}

TEST_CASE("rebound: a surface that cannot give way as R_N asks is named with the part that it lacks") {
    const Folder folder("lack");
    const std::string disc = "shape = \"disc\"\ncentre = [0, 0.35]\nradius = 0.35\n";
    const auto lack = [&](double h, double speed) {
        const double e = rebound_of(folder, disc + size(h), 0, "R_N = 0.2\n", 0, speed).e;
        const auto json = nlohmann::json::parse(text_of(folder.path / "run/run.json"));
        for (const auto& gate : json["gates"])
            if (gate["name"] == "rebound_lack" && gate["value"].is_number())
                return std::pair(e, gate["value"].get<double>());
        return std::pair(e, 0.);
    };
    const auto [coarse, none] = lack(0.1, 5);
    CHECK(coarse == relative(0.2, 0.05));
    CHECK(none == 0);
    // where the surface stops giving way the part f of the energy is left: of it the body takes its natural rebound
    const auto [fine, f] = lack(0.03, 30);
    CHECK(f > 0.1);
    CHECK(f < 1);
    CHECK(fine > 0.25);
    CHECK(text_of(folder.path / "run/log.txt").find("warning[rebound_lack]") != std::string::npos);
}

TEST_CASE("rebound: two deformable bodies part with R_N of their materials") {
    const Folder folder("pair");
    // a corner meets the middle of a face, so both fly on along x
    const std::string bodies =
        "[[body]]\nshape = \"polygon\"\npoints = [[0.5, 0], [0, 0.5], [-0.5, 0], [0, -0.5]]\nvelocity = [5, 0]\n"
        "[[body]]\nshape = \"polygon\"\npoints = [[0.501, -0.45], [1.4, -0.45], [1.4, 0.45], [0.501, 0.45]]\n";
    for (const double R_N : {0.3, 0.6}) {
        CAPTURE(R_N);
        write_scene(folder, "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = 0.18\n" + bodies + rock +
                                "[contact]\nfriction = 0\n[[contact.pair]]\nmaterials = [\"rock\", \"rock\"]\nR_N = " +
                                std::to_string(R_N) +
                                "\n[time]\nend = 0.005\n[output]\nevery = 1\nfields = false\nhistory_every = 0.005\n");
        const Answer answer = run_scene(folder, "-j 1 --force -s 'figure=[]' -o " + folder.in_shell("run"));
        CAPTURE(answer.text);
        REQUIRE(answer.code == 0);
        const std::vector<double> v = knap::read_csv(folder.path / "run/fragment_paths.csv").column("velocity_x");
        REQUIRE(v.size() >= 2);
        CHECK(std::abs(v[v.size() - 1] - v[v.size() - 2]) / 5 == relative(R_N, 0.05));
    }
}

TEST_CASE("rebound: friction leaves R_T of the slip of a deformable disc or takes mu of the normal impulse") {
    const Folder folder("slip");
    const std::string disc = "shape = \"disc\"\ncentre = [0, 0.35]\nradius = 0.35\n";
    const auto with = [&](double mu, const std::string& R_T = "R_T = 0.8\n", double h = 0.14) {
        return rebound_of(folder, disc + size(h), 0, "R_N = 0.4\n" + R_T + "friction = " + std::to_string(mu) + "\n", 4)
            .slip;
    };
    // without R_T the least of all, and not what the shear of the body springs back
    CHECK(std::abs(with(0.8, "")) < 0.05 * 4);
    CHECK(std::abs(with(0.8, "R_T = 0.01\n") - 0.01 * 4) < 0.05 * 4);
    CHECK(with(2, "R_T = 0.8\n", 0.07) == relative(0.8 * 4, 0.02));  // of meshes of 0.14 it has a tenth less
    CHECK(with(0.02) == relative(4 - 3 * 0.02 * 1.4 * 5, 0.05));     // its mobility is 1/m + r^2/J = 3/m
}

TEST_CASE("rebound: check says with which the bodies of a scenario leave a surface and how they turn") {
    const Folder folder("said");
    const auto said = [&](const std::string& shape, const std::string& law, const std::string& rigid = "") {
        return accepted(folder, "knap = 1\n[domain]\nrotation = \"large\"\n" + shape + rock + "[contact]\n" + rigid +
                                    "[[obstacle]]\nname = \"ground\"\nshape = \"half plane\"\nat = "
                                    "[0, -1e-4]\nnormal = [0, 1]\n" +
                                    law + "[time]\nend = 0.004\n");
    };
    // its kinetic energy of spin is 2.33 times that of the polygon
    const std::string
        boulder =
            "shape = \"polygon\"\npoints = [[-0.5, 0.3], [0.1, 0], [0.6, 0.4], [0.5, 0.9], [0, 1.2], [-0.45, 0.9]]\n" +
            size(0.9),
        disc = "shape = \"disc\"\ncentre = [0, 0.35]\nradius = 0.35\n" + size(0.1);
    CHECK(said(boulder, "").has("up to 2.33 times the inertia"));
    CHECK(said(boulder, "R_N = 0.7\n").has("(4 triangles: with at least 0.53"));
    CHECK(said(disc, "R_N = 0.3\n").has("bodies rebound with R_N 0.3, deformable ones up to impacts of about "));
    CHECK_FALSE(said(disc, "").has("the inertia of their outlines"));
    CHECK(said(disc, "restitution = 0.3\n")
              .has("restitution 0.3 of faces; a deformable body rebounds by its elasticity"));
    CHECK(said(disc, "restitution = 0.3\n", "[rigid]\n")
              .has("ground: friction 0, restitution 0.3 of faces, and of rigid pieces that cannot break\n"));
}

}  // namespace rebound_test
