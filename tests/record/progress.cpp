// The line that says how a run goes.
#include "record/progress.hpp"

#include "model/make_model.hpp"
#include "model/state.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <string>

namespace progress_test {

using namespace knap;

TEST_CASE("progress: rate and time left count from where this process began") {
    const Model model = make_model({.mesh = tests::bar_mesh(2, 1, 2, 1),
                                    .materials = {{.density = 1000, .E = 1e9, .nu = 0.25}},
                                    .laws = {{.sigma_c = 1e12, .G_c = 1e9}},
                                    .law_of_pair = {{0}}});
    State restored = initial_state(model);
    restored.time = 0.5, restored.n_steps = 1000;
    const Recorder recorder(model, restored, {.end = 1, .history_every = 0.1, .context = {.materials = {"steel"}}});
    std::FILE* file = std::tmpfile();
    REQUIRE(file != nullptr);
    Progress progress(file, restored, 1);
    progress.after_step(restored, recorder, model.mesh.n_triangles());
    std::rewind(file);
    char text[400] = "";
    REQUIRE(std::fgets(text, sizeof text, file) != nullptr);
    std::fclose(file);
    const std::string line = text;
    CAPTURE(line);
    CHECK(line.find(" 50 %") == 0);  // of all
    CHECK(line.find(" 0.00e+00 triangle-steps/s") != std::string::npos);
    CHECK(line.find(" s left") == std::string::npos);  // nothing is known of it yet
}

}  // namespace progress_test
