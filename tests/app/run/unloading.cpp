// Runs in which damaged points are unloaded and loaded again.
#include "app/program.hpp"

#include <nlohmann/json.hpp>

namespace run_unloading_test {

using namespace program;

TEST_CASE("a crack with secant unloading costs what its law requires") {
    const Folder folder("secant crack");
    REQUIRE(command("run edge_cracked_block -q -j 1 -s 'mesh.size=1 mm' -s 'time.end=30 us' -s 'expect={}' -s "
                    "'figure=[]' -s output.report=false -s output.fields=false -s interface.default.unloading=secant "
                    "-o " +
                    folder.in_shell("run"))
                .code == 0);
    const auto record = nlohmann::json::parse(text_of(folder.path / "run/run.json"));
    for (const auto& gate : record["gates"])
        if (gate["name"] == "law_lag") CHECK(gate["value"] < 1e-3);  // 0.09 with ramps that rounding had made
}

}  // namespace run_unloading_test
