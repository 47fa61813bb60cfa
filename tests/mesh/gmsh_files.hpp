#pragma once
// Gmsh files for the tests.
#include "base/error.hpp"
#include "mesh/gmsh.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace knap::testing {

/// data/block.geo, meshed by Gmsh 4.8.4 and saved in all four formats.
inline const std::vector<std::string> gmsh_files{"block_22_ascii.msh", "block_22_binary.msh", "block_41_ascii.msh",
                                                 "block_41_binary.msh"};

inline std::string gmsh_bytes(const std::string& file) {
    std::ifstream in(std::string(KNAP_SOURCE_DIR "/tests/mesh/data/") + file, std::ios::binary);
    REQUIRE(in);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A unit square of two triangles in format 2.2 with the sections given.
inline std::string square_file(const std::string& elements = "2\n1 2 0 1 2 3\n2 2 0 1 3 4\n",
                               const std::string& nodes = "4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n",
                               const std::string& before = "") {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + before + "$Nodes\n" + nodes + "$EndNodes\n$Elements\n" +
           elements + "$EndElements\n";
}

/// What is wrong with a file; an empty message when it is read.
inline Diagnostic mistake(const std::string& bytes) {
    try {
        read_gmsh(bytes, "m.msh");
    } catch (const UserError& error) {
        REQUIRE(error.diagnostics.size() == 1);
        CHECK(error.diagnostics[0].file == "m.msh");
        return error.diagnostics[0];
    }
    return {};
}

/// `text` with one stretch put in the place of another.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE_MESSAGE(at != std::string::npos, from);
    return text.replace(at, from.size(), to);
}

}  // namespace knap::testing
