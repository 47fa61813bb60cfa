// The same scenario gives the same bits: for any number of threads, for Debug and Release (tools/test --debug), and for
// the program of yesterday unless somebody meant to change what it computes.
#include "app/program.hpp"

#include <boost/crc.hpp>

#include <cstdlib>
#include <map>
#include <vector>

namespace same_bits_test {

using namespace program;

namespace {

struct Scene {
    const char *name, *arguments, *early_end;
};

const Scene scenes[]{
    {"explicit", "edge_cracked_block -s 'mesh.size=2 mm' -s 'time.end=60 us'", "40 us"},
    {"implicit", "edge_cracked_block_implicit -s 'mesh.size=4 mm' -s 'time.end=60 us' -s 'time.step=5 CFL'", "40 us"},
    {"rock", "granite_tension -s 'time.end=120 us'", "120 us"},
    {"thaw", "permafrost_slope -s 'mesh.size=3 m' -s 'time.end=0.9 s'", "0.9 s"},
};

/// Its laws have states of their own; not among the golden ones.
const Scene with_rates{"rates",
                       "edge_cracked_block -s 'mesh.size=2 mm' -s 'time.end=60 us' -s "
                       "interface.default.unloading=secant -s interface.default.relaxation_time=2e-7 -s "
                       "interface.default.incubation_time=2e-6",
                       "40 us"};
const Scene with_slip_laws{
    "slips",
    "edge_cracked_block -s 'mesh.size=2 mm' -s 'time.end=60 us' -s interface.default.unloading=vertical -s "
    "interface.default.G_II=9 -s interface.default.friction=0.6 -s interface.default.kinetic_friction=0.1 -s "
    "interface.default.slip_distance=1e-7",
    "40 us"};

/// Implicit steps whose factor several threads share: a crack, and pieces that rub.
const Scene implicit_scenes[]{
    {"crack", "edge_cracked_block_implicit -s 'mesh.size=1.5 mm' -s 'time.end=60 us'", "30 us"},
    {"friction", "jointed_slope -s time.bulk=implicit -s time.cohesion=implicit -s 'time.step=100 CFL'", "20 ms"},
};

void run(const Scene& scene, int n_threads, const Folder& folder, const std::string& directory,
         const std::string& more = "") {
    const Answer answer = command("run " + std::string(scene.arguments) + more + " -q -s 'expect={}' " + undrawn +
                                  "-j " + std::to_string(n_threads) + " -o " + folder.in_shell(directory));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
}

std::string hash_of(const fs::path& run) {
    boost::crc_32_type crc;
    for (const char* file : {"energy.csv", "cracks.csv", "fragments.csv"}) {
        const std::string text = text_of(run / file);
        REQUIRE(text.size() > 100);
        crc.process_bytes(text.data(), text.size());
    }
    char hash[9];
    std::snprintf(hash, sizeof hash, "%08x", static_cast<unsigned>(crc.checksum()));
    return hash;
}

std::map<std::string, std::string> golden_hashes() {
    std::map<std::string, std::string> hashes;
    std::ifstream file(KNAP_SOURCE_DIR "/tests/app/data/golden_hashes.txt");
    for (std::string name, hash; file >> name >> hash;) hashes[name] = hash;
    return hashes;
}

/// Every table and frame of a run with one thread.
void check_same_bits(const Scene& scene, std::initializer_list<int> others, const Folder& folder) {
    const auto directory = [&](int n) { return std::string(scene.name) + std::to_string(n); };
    const auto run_with = [&](int n) {
        run(scene, n, folder, directory(n), " -s 'time.end=" + std::string(scene.early_end) + "'");
    };
    run_with(1);
    const fs::path one = folder.path / directory(1);
    for (const int n : others) {
        run_with(n);
        for (const auto& file : fs::recursive_directory_iterator(one)) {
            const fs::path other = folder.path / directory(n) / fs::relative(file.path(), one);
            const std::string ending = file.path().extension();
            if (ending != ".csv" && ending != ".vtu") continue;
            CHECK_MESSAGE(text_of(file.path()) == text_of(other), other.string());
        }
    }
}

}  // namespace

TEST_CASE("the same bits for one and three threads") {
    const Folder folder("threads");
    for (const Scene& scene : scenes) check_same_bits(scene, {3}, folder);
    check_same_bits(with_rates, {3}, folder);
    check_same_bits(with_slip_laws, {3}, folder);
}

TEST_CASE("implicit steps: the same bits for one and two and four threads") {
    const Folder folder("implicit threads");
    for (const Scene& scene : implicit_scenes) check_same_bits(scene, {2, 4}, folder);
}

TEST_CASE("rubble: the same bits for one and two and four threads and for a run in parts") {
    // a ball breaks a plate: large rotations, contact of free faces, three thousand corners (several blocks)
    const Folder folder("rubble");
    write_scene(folder, R"(knap = 1
[domain]
rotation = "large"
[mesh]
size = "0.8 mm"
[[body]]
name = "plate"
shape = "rectangle"
origin = ["-25 mm", "0 mm"]
size = ["50 mm", "6 mm"]
material = "glass"
[[body]]
shape = "disc"
centre = ["0 mm", "9.02 mm"]
radius = "3 mm"
material = "steel"
velocity = ["0 m/s", "-40 m/s"]
[material.glass]
density = "2450 kg/m3"
E = "70 GPa"
nu = 0.22
[material.steel]
density = "7800 kg/m3"
E = "210 GPa"
nu = 0.3
[interface.default]
sigma_c = "20 MPa"
G_c = "20 J/m2"
gamma = 2
friction = 0.3
[interface.steel-steel]
breakable = false
[contact]
friction = 0.2
[time]
end = "8 us"
safety = 0.4
[output]
every = "2 us"
)");
    check_threads_and_parts(folder, {"2", "4"}, {"5us", "6.3us"}, 10);
    const std::string record = text_of(folder.path / "whole" / "run.json");
    const auto number = [&](const std::string& name) {
        const std::size_t at = record.find("\"" + name + "\": ");
        REQUIRE(at != std::string::npos);
        return std::atof(record.c_str() + at + name.size() + 4);
    };
    CHECK(number("face_contacts") > 1000);
    CHECK(number("fragments") > 10);
    CHECK(text_of(folder.path / "whole/energy.csv").find(",rotation_work [J],") != std::string::npos);
    CHECK(text_of(folder.path / "whole/fields/bulk_0004.vtu").find("Name=\"fragment\"") != std::string::npos);
}

TEST_CASE("binding threads to processors leaves the program all processors") {
    const Folder folder("bound");
    const auto threads = [&](const std::string& directory) {
        REQUIRE(command("run bar_ramp_wave -q -s 'time.end=1 us' -s 'expect={}' -s 'figure=[]' -o " +
                        folder.in_shell(directory))
                    .code == 0);
        const std::string text = text_of(folder.path / directory / "run.json");
        return text.substr(text.find("\"threads\""), 16);
    };
    const std::string free = threads("free");
    setenv("OMP_PROC_BIND", "true", 1);
    CHECK(threads("bound") == free);
    unsetenv("OMP_PROC_BIND");
}

TEST_CASE("golden: four scenarios have the bits that they had") {
    const Folder folder("golden");
    const std::map<std::string, std::string> known = golden_hashes();
    for (const Scene& scene : scenes) {
        run(scene, 1, folder, scene.name);
        const std::string hash = hash_of(folder.path / scene.name);
        const std::string advice =
            "where the numbers were meant to change, data/golden_hashes.txt gets: " + std::string(scene.name) + " " +
            hash;
        CHECK_MESSAGE(known.at(scene.name) == hash, advice);
    }
}

}  // namespace same_bits_test
