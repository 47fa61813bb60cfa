// [rigid]: a blow in the first step of a run, before which no forces are known.
#include "app/program.hpp"

#include <nlohmann/json.hpp>

namespace first_blow_test {

using namespace program;

TEST_CASE("rigid pieces: what is handed on in the first step of a run breaks what it breaks without them") {
    const Folder folder("first blow");
    const auto broken = [&](const std::string& rigid) {  // [m]
        write_scene(folder, R"(knap = 1
[domain]
rotation = "large"
[mesh]
size = 0.1
[[body]]
name     = "strong"
shape    = "rectangle"
origin   = [1e-4, 0]
size     = [0.5, 0.5]
velocity = [-3, 0]
material = "steel"
[[body]]
name     = "weak"
shape    = "rectangle"
origin   = [0.5001, 0]
size     = [0.5, 0.5]
velocity = [-3, 0]
material = "rock"
[material.rock]
density = 2500
E       = 20e9
nu      = 0.2
[material.steel]
density = 2500
E       = 20e9
nu      = 0.2
[interface.default]
sigma_c  = 2e6
G_c      = 20
gamma    = 1.5
friction = 0.5
[interface.steel-steel]
breakable = false
[interface.rock-steel]
breakable = false
[contact]
friction = 0.3
[[obstacle]]
shape    = "half plane"
at       = [0, 0]
normal   = [1, 0]
friction = 0.3
[output]
fields = false
[time]
end = 2e-3
[rigid]
)" + rigid);
        REQUIRE(run_scene(folder, "-j 1 -s 'figure=[]' --force -o " + folder.in_shell("run")).code == 0);
        return nlohmann::json::parse(text_of(folder.path / "run/run.json"))["summary"]["broken_length"].get<double>();
    };
    const double deformable = broken("thaw = 0\n");
    CHECK(deformable > 1);
    CHECK(broken("") == doctest::Approx(deformable).epsilon(0.1));
}

}  // namespace first_blow_test
