// Any bytes as a checkpoint. The first byte is the kind of the others:
//     0  a file
//     1  edits of the checkpoint of a real run. An edit has a position (2 bytes), a number of bytes to remove, a number
//        of bytes to insert, and these bytes.
#include "target.hpp"

#include "app/run/checkpoint.hpp"
#include "base/error.hpp"
#include "support/bodies.hpp"

using namespace knap;
using namespace knap::tests;

namespace {

/// A plate that is torn apart: some fans have split, some points are half broken.
ModelInput torn_plate() {
    ModelInput input;
    input.mesh = bar_mesh(4, 2, 2, 1);
    input.materials = {{.density = 1, .E = 1, .nu = 0.2}};
    input.laws = {{.sigma_c = 1e-3, .G_c = 2e-6, .gamma = 1, .friction = 0.3}};
    input.law_of_pair = {{0}};
    input.loads = {load(Load::Kind::velocity, "left", -0.01, std::nullopt),
                   load(Load::Kind::velocity, "right", 0.01, std::nullopt)};
    return input;
}

struct RealRun {
    RealRun()
        : control(limits),
          recorder(run.model, run.now,
                   {.end = 1, .history_every = 0.1, .context = {.materials = {"glass"}}, .breaks = true}) {
        const double h = 0.8 * run.stepper.stable_step();
        for (int i = 0; i < 60; ++i) {
            const StepReport report = run.step(h);
            recorder.after_step(run.now, report);
        }
        require(!run.now.split_fans.empty(), "the plate is torn");
    }

    const StepLimits limits{.largest = 1, .cracking = 1, .smallest = 1e-9, .end = 1};
    Run run{torn_plate()};
    StepControl control;
    Recorder recorder;
    Excavations excavations{{}};
    Adaptation adaptation{{}, {}};
    std::int64_t triangle_steps = 3;
    RunOrigin origin{.scenario = "name = \"torn\"\n"};
    RunMemory memory{.origin = origin,
                     .now = run.now,
                     .control = control,
                     .recorder = recorder,
                     .excavations = excavations,
                     .adaptation = adaptation,
                     .triangle_steps = triangle_steps,
                     .log_size = 7,
                     .spent = {.cpu = 1, .wall = 2, .steps = 0.5}};
};

std::string edited(std::string bytes, const std::string& edits) {
    for (std::size_t at = 0; at + 4 <= edits.size();) {
        const auto byte = [&](std::size_t i) {
            return static_cast<std::size_t>(static_cast<unsigned char>(edits[at + i]));
        };
        const std::size_t where = (byte(0) + 256 * byte(1)) % (bytes.size() + 1), n_gone = byte(2), n_new = byte(3);
        const std::string come = edits.substr(at + 4, n_new);
        bytes.replace(where, n_gone, come);
        at += 4 + n_new;
    }
    return bytes;
}

void read(const std::string& file, RealRun& real) {
    try {
        const std::string memory = unpacked_checkpoint(file);
        restore(memory, real.memory);
        require(bytes_of(real.memory) == memory, "what was restored is what was kept");
    } catch (const SimulationError& error) {
        require(error.what()[0] != '\0', "an error says something");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static RealRun real;
    static const std::string whole = bytes_of(real.memory);
    if (size == 0) return 0;
    const std::string rest = text_of(data + 1, size - 1);
    read(data[0] % 2 == 0 ? rest : edited(packed_checkpoint(whole, {.time = 1, .last_step = 1}), rest), real);
    return 0;
}
