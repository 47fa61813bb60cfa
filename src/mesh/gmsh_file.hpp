#pragma once
// The content of a Gmsh file: nodes, lines, triangles and names of physical groups, with the tags of the file.
// Source: Gmsh reference manual, "MSH file format" (version 4.1) and "Legacy formats" (version 2.2).
#include "base/text.hpp"

#include <array>
#include <cstdint>
#include <map>

namespace knap {

/// The most frequent cause of a file without elements.
inline const std::string saved_in_groups =
    "where there are physical groups, Gmsh saves only what is in one: give surfaces one, too";

struct GmshNode {
    std::int64_t tag;
    std::array<double, 3> position;  // in the unit of the file
};

/// A line (2 nodes) or a triangle (3 nodes): the corners of elements of second order. An element in several physical
/// groups occurs several times.
template <std::size_t n_nodes>
struct GmshElement {
    std::array<std::int64_t, n_nodes> nodes;  // tags
    std::int32_t group;                       // tag of the physical group, 0 for none
    std::int64_t entity;                      // tag of the elementary line or surface, 0 for none
    std::size_t where;                        // byte in the file, for messages
};

struct GmshFile {
    /// Reads formats 2.2 and 4.1, ASCII and binary; throws UserError. `name` is the file in messages. The bytes must
    /// outlive this.
    GmshFile(const std::string& bytes, const std::string& name);

    /// Byte of the file that a message is about, and the cure.
    struct Place {
        // NOLINTNEXTLINE(google-explicit-constructor): most messages give the byte alone
        Place(std::size_t byte, std::string cure = "") : where(byte), note(std::move(cure)) {}
        std::size_t where;
        std::string note;
    };
    /// Throws UserError: the parts of the message joined, the file, and the line of the place or the byte in a binary
    /// file.
    template <class... Parts>
    [[noreturn]] void fail(const Place& place, const Parts&... message) const {
        throw_error(place, concatenated(message...));
    }

    /// Where the file gives no name, the tag; empty for tag 0 (no group).
    std::string group_name(int dimension, std::int32_t tag) const;

    const std::string& bytes;
    const std::string name;
    bool binary = false;                                              // the numbers in the sections
    std::size_t end = 0;                                              // byte after the last section
    std::map<std::pair<int, std::int32_t>, std::string> group_names;  // by dimension and tag
    std::vector<GmshNode> nodes;
    std::vector<GmshElement<2>> lines;
    std::vector<GmshElement<3>> triangles;
    std::size_t n_second_order = 0;  // of the triangles, those with 6 nodes

private:
    [[noreturn]] void throw_error(const Place& place, const std::string& message) const;
};

}  // namespace knap
