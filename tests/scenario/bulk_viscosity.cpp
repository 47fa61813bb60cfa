// Where viscosity is on by itself, and that this refuses no file.
#include "samples.hpp"

#include <doctest/doctest.h>

using namespace knap;
using samples::changed;

TEST_CASE("scenario: viscosity is the default where faces rub in explicit steps") {
    constexpr std::array none{0., 0., 0.}, usual{0., 1.2, 0.1};  // b1, b2, b3
    const std::string contact = changed("[mesh]", "rotation = \"large\"\n[contact]\n[mesh]"),
                      rough = samples::least +
                              "[[obstacle]]\nshape = \"half plane\"\nat = [0, -1]\nnormal = [0, 1]\n"
                              "friction = 0.3\n",
                      smooth = changed("friction = 0.3\n", "", rough),
                      excavation = "[[excavation]]\nat = \"9 us\"\nbox = [0, 0, 0.01, 0.01]\n";
    const auto in_time = [](const std::string& keys, const std::string& text) {
        return changed("end = 80e-6\n", "end = 80e-6\n" + keys, text);
    };
    const struct {
        const char* what;
        std::string text;
        std::array<double, 3> expected;
    } cases[] = {
        {"nothing rubs", samples::least, none},
        {"contact", contact, usual},
        {"contact and an excavation", contact + excavation, usual},
        {"contact with none", changed("nu = 0.2\n", "nu = 0.2\nbulk_viscosity = [0, 0]\n", contact), none},
        {"contact with another",
         changed("nu = 0.2\n", "nu = 0.2\nbulk_viscosity = [0.01, 0]\n", contact),
         {0.01, 0, 0}},
        {"contact with another of shear",
         changed("nu = 0.2\n", "nu = 0.2\nshear_viscosity = 0.01\n", contact),
         {0, 1.2, 0.01}},
        {"shear alone", changed("nu = 0.2\n", "nu = 0.2\nshear_viscosity = 0.01\n", smooth), {0, 0, 0.01}},
        {"an obstacle with friction", rough, usual},
        {"friction over pressure",
         changed("G_c = 3\n", "G_c = 3\nfriction_over_pressure = [[0, 0], [1e6, 1e6]]\n", samples::least),
         {0, 1.2, 0.3}},
        {"friction over slip beside a bulk viscosity",
         changed("nu = 0.2\n", "nu = 0.2\nbulk_viscosity = [0.06, 1.2]\n",
                 changed("G_c = 3\n", "G_c = 3\nfriction = 0.6\nkinetic_friction = 0.3\nslip_distance = 1e-3\n",
                         samples::least)),
         {0.06, 1.2, 0.3}},
        {"an obstacle without friction", smooth, none},
        {"second order", changed("[mesh]", "[mesh]\norder = 2", rough), usual},
        {"second order and an excavation", changed("[mesh]", "[mesh]\norder = 2", rough) + excavation, none},
        {"implicit steps", in_time("bulk = \"implicit\"\ncohesion = \"implicit\"\n", rough), none},
        {"both steps", in_time("bulk = \"auto\"\n", rough), usual},
        {"both steps, implicit ones in seconds", in_time("bulk = \"auto\"\nstep = \"1 us\"\n", rough), usual},
        {"a step in seconds", in_time("step = \"1 ns\"\n", rough), none},
        {"a step in stable ones", in_time("step = \"0.5 CFL\"\n", rough), usual},
    };
    for (const auto& [what, text, expected] : cases) {
        CAPTURE(what);
        const Scenario scenario = samples::read(text).scenario;
        const Elastic& elastic = scenario.materials.at(0).elastic;
        const auto& [b1, b2] = elastic.bulk_viscosity;
        CHECK(std::array{b1, b2, elastic.shear_viscosity} == expected);
        CHECK(scenario.works().viscosity == (expected != none));
    }
}
