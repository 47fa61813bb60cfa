// [rigid]: a blow in the first step of a run, before which no forces are known.
#include "app/rigid_scene.hpp"
#include "support/relative.hpp"

namespace first_blow_test {

using namespace program;
using knap::tests::relative;

TEST_CASE("rigid pieces: what is handed on in the first step of a run breaks what it breaks without them") {
    const Folder folder("first blow");
    const auto broken = [&](const std::string& rigid) {  // [m]
        const std::string thrown = "velocity = [-3, 0]\n", friction = "friction = 0.3\n";
        const std::string text =
            scene(block("strong", "1e-4, 0", "0.5, 0.5", thrown + "material = \"steel\"\n") +
                      block("weak", "0.5001, 0", "0.5, 0.5", thrown) + ground(friction, "1, 0"),
                  rigid, "2e-3",
                  "sigma_c = 2e6\nG_c = 20\n[material.steel]\ndensity = 2500\nE = 30e9\nnu = 0.2\n"
                  "[interface.steel-steel]\nbreakable = false\n[interface.rock-steel]\nbreakable = false\n");
        REQUIRE(run_to_end(folder, text).code == 0);
        return record(folder)["summary"]["broken_length"].get<double>();
    };
    const double deformable = broken("thaw = 0\n");
    CHECK(deformable > 1);
    CHECK(broken("") == relative(deformable, 0.1));
}

}  // namespace first_blow_test
