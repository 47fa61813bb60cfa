// Pieces that fly and spin as whole ones: what theta above 1/2 takes of a spin is told before and after a run, and
// their motion is no inertia of heat.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace moving_pieces_test {

using namespace program;
using knap::tests::relative;

namespace {

/// A bar of 0.2 m that nothing holds and that turns by 5 rad.
std::string spinning(const std::string& time, const std::string& material = "", const std::string& more = "") {
    return rectangle("0.2, 0.1", "0.1", "rotation = \"large\"\n") +
           "[material.steel]\ndensity = 7800\nE = 200e9\nnu = 0.3\n" + material +
           "[interface.default]\nbreakable = false\n[[initial]]\nspin = \"50 rad/s\"\nvelocity = [20, 0]\n" + more +
           "[time]\n" + time + "[output]\nfields = false\n";
}

nlohmann::json record_of(const Folder& folder) { return nlohmann::json::parse(text_of(folder.path / "run/run.json")); }

nlohmann::json gate(const Folder& folder, const std::string& name) {
    const nlohmann::json record = record_of(folder);
    for (const nlohmann::json& gate : record["gates"])
        if (gate["name"] == name) return gate;
    return {};
}

}  // namespace

// L falls by (theta - 1/2) h w^2 of itself per time, 0.025 in 0.1 s at the first spin w: w falls as 1/sqrt(1 + 2 x 0.025).
TEST_CASE("moving pieces: what theta takes of a spin is in a gate and check tells it before") {
    const Folder folder("braked spin");
    const std::string implicit = "end = 0.1\nbulk = \"implicit\"\nstep = 2e-4\ntheta = ";
    const Answer warned = accepted(folder, spinning(implicit + "1\n"));
    CHECK(warned.has("warning[braked-spin]"));
    CHECK(warned.has("theta = 1 takes 2.5 % of the spin of 2.86e+03 deg/s of a free body"));
    const Answer braked = run_scene(folder, "-j 1 -o " + folder.in_shell("run"));
    CAPTURE(braked.text);
    REQUIRE(braked.code == 0);
    CHECK(braked.has("braked_spin"));
    const auto spin = knap::read_csv(folder.path / "run/fragment_paths.csv").column("spin");
    const double lost = 1 - spin.back() / spin.front();
    CHECK(lost == relative(1 - 1 / std::sqrt(1.05), 2e-3));
    CHECK(gate(folder, "braked_spin")["value"].get<double>() == relative(lost, 0.01));
    for (const std::string& keeps : {implicit + "0.5\n", std::string("end = 0.1\nstep = 1e-5\n")}) {
        CAPTURE(keeps);
        CHECK_FALSE(accepted(folder, spinning(keeps)).has("braked-spin"));
        REQUIRE(run_scene(folder, "-j 1 --force -o " + folder.in_shell("run")).code == 0);
        CHECK(gate(folder, "braked_spin")["value"].is_null());
        const auto kept = knap::read_csv(folder.path / "run/fragment_paths.csv").column("spin");
        CHECK(kept.back() == relative(kept.front(), 1e-6));
    }
}

// Its kinetic energy is 300 times the strain energy of its temperatures.
TEST_CASE("moving pieces: a flight and a spin are no inertia of heat") {
    const Folder folder("warm flight");
    const auto inertia = [&](bool flies) {
        std::string text = spinning("end = 2e-3\ndamping = \"5 kHz\"\n", "expansion = 1e-5\n",
                                    "[heat]\ntemperature = \"100*(t/2e-3)*(x/0.2)^2\"\n");
        if (!flies) text.erase(text.find("[[initial]]"), text.find("[heat]") - text.find("[[initial]]"));
        write_scene(folder, text);
        const Answer answer = run_scene(folder, "-j 1 --force -o " + folder.in_shell("run"));
        CAPTURE(answer.text);
        REQUIRE(answer.code == 0);
        const nlohmann::json summary = record_of(folder)["summary"];
        if (flies) CHECK(summary["kinetic_energy"].get<double>() > 100 * summary["strain_energy"].get<double>());
        return summary["kinetic_part"].get<double>();
    };
    const double rests = inertia(false), flies = inertia(true);
    CAPTURE(rests);
    CAPTURE(flies);
    CHECK(rests < 0.1);
    CHECK(flies == relative(rests, 1e-3));
}

}  // namespace moving_pieces_test
