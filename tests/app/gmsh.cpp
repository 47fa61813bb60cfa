// Meshes from Gmsh on the command line.
#include "program.hpp"

using namespace program;

namespace {

const std::string time_piece = "hopkinson_time_piece -q -j 1 -s 'time.end=1 us' -s 'expect={}' ";

std::string line_with(const std::string& text, const std::string& word) {
    const std::size_t at = text.find(word);
    return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
}

}  // namespace

TEST_CASE("a run keeps the mesh that it read and can be repeated from its own directory") {
    const Folder folder("gmsh run");
    REQUIRE(command("run " + time_piece + "-o " + folder.in_shell("a")).code == 0);
    CHECK(text_of(folder.path / "a" / "mesh.msh") == text_of(KNAP_SOURCE_DIR "/scenarios/hopkinson_time_piece.msh"));
    CHECK(text_of(folder.path / "a" / "resolved.toml").find("file = \"mesh.msh\"") != std::string::npos);
    REQUIRE(command("run " + folder.in_shell("a/resolved.toml") + " -q -j 1 -o " + folder.in_shell("b")).code == 0);
    CHECK(text_of(folder.path / "a" / "energy.csv") == text_of(folder.path / "b" / "energy.csv"));
    REQUIRE(command("run " + folder.in_shell("a/resolved.toml") + " -q -j 1 --force -o " + folder.in_shell("a")).code ==
            0);  // in its own place
    CHECK(text_of(folder.path / "a" / "mesh.msh") == text_of(folder.path / "b" / "mesh.msh"));
    CHECK(command("render " + folder.in_shell("a") + " -o " + folder.in_shell("c")).code == 0);
}

TEST_CASE("a mesh that knap wrote takes the place of meshing and gives the same report") {
    const Folder folder("gmsh again");
    const Answer made = command("mesh edge_cracked_block -s 'mesh.size=2 mm' -o " + folder.in_shell("m.msh"));
    REQUIRE(made.code == 0);
    std::ofstream(folder.path / "s.toml") << "knap = 1\n[mesh]\nfile = \"m.msh\"\ncracks = [\"crack\"]\n"
                                          << "[material.glass]\ndensity = \"2450 kg/m3\"\nE = \"32 GPa\"\nnu = 0.2\n"
                                          << "[interface.default]\nsigma_c = \"3.08 MPa\"\nG_c = \"3 J/m2\"\n"
                                          << "[[load]]\non = \"top\"\ntraction = [0, 1e6]\n[time]\nend = \"1 us\"\n";
    const Answer read = command("mesh " + folder.in_shell("s.toml"));
    CAPTURE(read.text);
    REQUIRE(read.code == 0);
    for (const char* word :
         {"triangles", "interfaces", "pre-cracked edges", "area [m2]", "edge length [m]", "smallest angle", "stable step"}) {
        CHECK_FALSE(line_with(made.text, word).empty());
        CHECK(line_with(read.text, word) == line_with(made.text, word));
    }
    CHECK(command("check " + folder.in_shell("s.toml")).code == 0);
    CHECK(command("check " + folder.in_shell("s.toml") + " -s 'load[0].on=lid'").code == 2);
}
