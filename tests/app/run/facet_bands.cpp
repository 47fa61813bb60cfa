// Squares in tension that a zigzag of facets crosses, all at the angle t to the width: closed forms of both couplings.
// Facets that all slide while one side moves straight bear 1 + gamma tan t (sum) or sqrt(1 + gamma^2 tan^2 t) (norm)
// times sigma_c. With the norm and gamma = 1 the elastic traction has the direction of the opening already. With other laws it
// turns while the teeth deform, and the band softens meanwhile: the closed form is that of a long process zone.
#include "app/program.hpp"
#include "base/formatted.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace facet_bands_test {

using namespace program;
using namespace knap;
using knap::tests::relative;

namespace {

constexpr double side = 0.1, sigma_c = 0.25e6;  // [m], [Pa]

struct Band {
    double degrees;
    const char* coupling;
    double gamma, G_c;  // [-], [J/m2]; 2: a process zone of 57 edges
    std::string softening = "", scheme = "bulk = \"implicit\"\ncohesion = \"implicit\"\n";

    double slope() const { return std::tan(degrees * M_PI / 180); }
    double bears() const {
        return std::string(coupling) == "sum" ? 1 + gamma * slope() : std::hypot(1, gamma * slope());
    }
    double length() const { return side * std::hypot(1, slope()); }  // [m] of its facets
};

/// The right side moves as `key` and `value` say within the time `ramp` [s], the left one against it.
nlohmann::json run_of(const Folder& folder, const Band& band, const std::string& key, const std::string& value,
                      double ramp, double step, double end) {
    constexpr int n_facets = 10;
    std::string zigzag;
    for (int k = 0; k <= n_facets; ++k)
        zigzag += formatted("[%.12g, %.12g], ", 0.5 * side + (k % 2 - 0.5) * side / n_facets * band.slope(),
                            k * side / n_facets);
    const auto load = [&](const std::string& on, const std::string& sign) {
        return "[[load]]\non = \"" + on + "\"\n" + key + " = [" + sign + value + ", \"free\"]\n" +
               formatted("ramp = %g\n", ramp);
    };
    const std::string rock = "]\ndensity = 2400\nE = 20e9\nnu = 0.2\n";
    write_scene(folder,
                "knap = 1\n[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.1]\n[[domain.region]]\nmaterial = "
                "\"right\"\npoints = [" +
                    zigzag + "[0.1, 0.1], [0.1, 0]]\n[mesh]\nsize = 0.01\n[material.left" + rock + "[material.right" +
                    rock +
                    formatted("[interface.default]\nbreakable = false\n[interface.left-right]\nsigma_c = "
                              "0.25e6\nG_c = %g\ngamma = %g\ncoupling = \"%s\"\n",
                              band.G_c, band.gamma, band.coupling) +
                    band.softening + load("left", "-") + load("right", "") +
                    formatted("[time]\nend = %.12g\nstep = %.12g\nstep_cracking = %.12g\n", end, step, step) +
                    band.scheme + "[output]\nfields = false\nhistory_every = 0.002\n");
    const Answer made = run_scene(folder, "-j 1 --force -o " + folder.in_shell("run"));
    REQUIRE_MESSAGE(made.code == 0, made.text);
    return nlohmann::json::parse(text_of(folder.path / "run/run.json"));
}

/// Its largest load over that of the closed form, of a band that breaks through.
double load_of(const Folder& folder, const Band& band) {
    const nlohmann::json summary = run_of(folder, band, "velocity", "1e-5", 0.2, 0.001, 1.5)["summary"];
    if (band.G_c == 2)  // it costs G_c over the length of its facets, whatever the law
        CHECK(summary["dissipated"].get<double>() == relative(2 * band.length(), 1e-9));
    return summary["largest_reaction"].get<double>() / (sigma_c * side * band.bears());
}

}  // namespace

TEST_CASE("a band of facets bears the closed form of its coupling and costs its length") {
    const Folder folder("facet bands");
    for (const double degrees : {25., 40.}) {
        CAPTURE(degrees);
        const auto within = [&](const Band& band, double least) {
            CAPTURE(band.coupling);
            CAPTURE(band.gamma);
            CAPTURE(band.scheme);
            const double load = load_of(folder, band);
            CHECK(load > least);
            CHECK(load < 1.0001);
        };
        within({degrees, "norm", 1, 2}, 0.999);
        within({degrees, "norm", 1, 2, "softening = \"table\"\ntable = [[0, 1], [0.3, 0.4], [1, 0]]\n"}, 0.998);
        within({degrees, "norm", 1, 2, "", "bulk = \"auto\"\n"}, 0.999);
        within({degrees, "norm", 0.5, 2}, 0.97);
        within({degrees, "norm", 2, 2}, 0.94), within({degrees, "norm", 2, 200}, 0.99);
        within({degrees, "sum", 0.5, 2}, 0.97);
        within({degrees, "sum", 1, 2}, 0.97), within({degrees, "sum", 1, 200}, 0.999);
    }
}

TEST_CASE("a band of facets that is held open keeps the energy of its law") {
    // openings of the size of rounding that fell back to the other law for one step had a lag of 0.1
    const Folder folder("held facet band");
    const auto lag_of = [&](const Band& band, int steps, double end) {
        const nlohmann::json record = run_of(folder, band, "displacement", "6e-6", 0.5, 0.5 / steps, end);
        CHECK(record["summary"]["dissipated"].get<double>() > 0.25 * 2 * band.length());
        for (const auto& gate : record["gates"])
            if (gate["name"] == "law_lag") return gate["value"].get<double>();
        return 1.;
    };
    for (const auto& [gamma, steps] : {std::pair{1., 200}, {1., 250}, {0.5, 225}}) {
        CAPTURE(gamma);
        CAPTURE(steps);
        const Band band{40, "norm", gamma, 2};
        CHECK(lag_of(band, steps, 0.5) < 1e-12);  // its openings grow along straight lines
        // with theta = 1/2 sides that stop within a step swing on from step to step, and openings turn
        CHECK(lag_of(band, steps, 1) < 2e-6);
    }
    CHECK(lag_of({40, "norm", 1, 2}, 500, 1) < 1e-6);
}

}  // namespace facet_bands_test
