// Meshes from Gmsh on the command line.
#include "app/program.hpp"

namespace gmsh_test {

using namespace program;

namespace {

const std::string time_piece =
    "hopkinson_time_piece -q -j 1 -s 'time.end=1 us' -s 'figure[0].at=1 us' -s 'expect={}' ";  // a time that it reaches

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

TEST_CASE("pieces that share a vertex only are warned of and run as two bodies") {
    const Folder folder("gmsh bow tie");
    std::ofstream(folder.path / "m.msh")
        << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n7\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 1 0\n6 2 2 0\n"
        << "7 1 2 0\n$EndNodes\n$Elements\n4\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 2 0 3 5 6\n4 2 0 3 6 7\n$EndElements\n";
    std::ofstream(folder.path / "s.toml")
        << "knap = 1\n[mesh]\nfile = \"m.msh\"\nunit = \"1 mm\"\n"
        << "[material.glass]\ndensity = \"2450 kg/m3\"\nE = \"32 GPa\"\nnu = 0.2\n"
        << "[interface.default]\nbreakable = false\n[[initial]]\nvelocity = [1, 0]\nbox = [1e-3, 1e-3, 2e-3, 2e-3]\n"
        << "[time]\nend = \"20 us\"\n[expect]\nfragments = { value = 2, within = 0 }\n"
        << "momentum_x = { value = 2.45e-3, within = \"1e-9 %\" }\n"
        << "mean_displacement_x = { value = 10e-6, within = \"0.1 %\" }\n";
    CHECK(command("mesh " + folder.in_shell("s.toml")).has("2 pieces"));
    const Answer run = command("run " + folder.in_shell("s.toml") + " -q -j 1 -o " + folder.in_shell("a"));
    CAPTURE(run.text);
    CHECK(run.code == 0);
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
    for (const char* word : {"triangles", "interfaces", "pre-cracked edges", "area [m2]", "edge length [m]",
                             "smallest angle", "stable step"}) {
        CHECK_FALSE(line_with(made.text, word).empty());
        CHECK(line_with(read.text, word) == line_with(made.text, word));
    }
    CHECK(command("check " + folder.in_shell("s.toml")).code == 0);
    CHECK(command("check " + folder.in_shell("s.toml") + " -s 'load[0].on=lid'").code == 2);
}

TEST_CASE("a mesh with a fault ends with 2 and its line and one that can be mended is") {
    const Folder folder("gmsh faults");
    std::ofstream(folder.path / "s.toml")
        << "knap = 1\n[mesh]\nfile = \"m.msh\"\n[material.glass]\ndensity = \"2450 kg/m3\"\nE = \"32 GPa\"\nnu = 0.2\n"
        << "[interface.default]\nbreakable = false\n[time]\nend = \"1 us\"\n";
    const auto check = [&](const std::string& elements) {
        std::ofstream(folder.path / "m.msh") << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 "
                                                "1 1 0\n4 0 1 0\n5 0.1 0.9 0\n$EndNodes\n$Elements\n"
                                             << elements << "$EndElements\n";
        return command("check " + folder.in_shell("s.toml"));
    };
    CHECK(check("2\n1 2 0 1 3 2\n2 2 0 1 3 4\n").code == 0);  // clockwise
    const auto refused = [&](const std::string& elements, const std::string& words) {
        const Answer answer = check(elements);
        CAPTURE(answer.text);
        CHECK(answer.code == 2);
        CHECK(answer.has(words));
        CHECK(answer.has("m.msh:16"));
    };
    refused("3\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 2 0 3 1 2\n", "in the file twice");
    refused("3\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 2 0 1 3 5\n", "same side of the edge");  // of which three triangles
}

}  // namespace gmsh_test
