#include "mesh/gmsh_file.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <set>
#include <string_view>

namespace knap {
namespace {

const char* const how_to_convert = "Gmsh converts it: gmsh -0 old.msh -o new.msh -format msh41 (or msh22)";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_space(char c) { return is_blank(c) || c == '\n'; }

/// Reads a file from its begin. Numbers do not depend on the locale.
class Reader {
public:
    explicit Reader(GmshFile& file) : file_(file), bytes_(file.bytes) {}

    void read() {
        read_header();
        std::set<std::string> seen;
        while (true) {
            const std::size_t where = at_;
            const std::string line(next_line().substr(0, 64));
            if (line.empty()) break;
            if (line.front() != '$' || line.starts_with("$End")) fail(where, "a section `$Name` should begin here");
            const std::string name = line.substr(1);
            if (!seen.insert(name).second && (name == "Nodes" || name == "Elements" || name == "Entities"))
                fail(where, "there is a second section $", name);
            read_section(name, where);
        }
        file_.end = at_;
        for (const char* needed : {"Nodes", "Elements"})
            if (!seen.contains(needed))
                file_.fail_with_note(at_, saved_in_groups, "this file has no section $", needed);
    }

private:
    template <class... Parts>
    [[noreturn]] void fail(const Parts&... parts) const {
        file_.fail(parts...);
    }

    // --- words and numbers; `what` names the expected number in messages

    /// The next line that is not blank, without blanks at its ends; empty at the end of the file.
    std::string_view next_line() {
        while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
        const std::size_t begin = at_, end = std::min(bytes_.find('\n', at_), bytes_.size());
        at_ = std::min(end + 1, bytes_.size());
        std::string_view line = std::string_view(bytes_).substr(begin, end - begin);
        while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
        return line;
    }

    void expect_line(const std::string& expected) {
        const std::size_t where = at_;
        const std::string_view line = next_line();
        if (line == expected) return;
        if (line.empty()) fail(where, "the file ends before `", expected, "`");
        file_.fail_with_note(where, "is there more in this section than it announces?", "`", expected,
                             "` should stand here");
    }

    void skip_blanks() {
        while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
    }

    void end_of_line() {
        skip_blanks();
        if (at_ < bytes_.size() && bytes_[at_] != '\n') fail(at_, "there is more on this line than expected");
        at_ = std::min(at_ + 1, bytes_.size());
        if (file_.binary) return;  // bytes that look like blanks would be numbers
        while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
    }

    void end_of_record() {
        if (!file_.binary) end_of_line();
    }

    /// A number in text, on this line.
    template <class Number = std::int64_t>
    Number text(const char* what) {
        skip_blanks();
        const char *end = bytes_.data() + bytes_.size(), *from = bytes_.data() + at_;
        if (from == end) fail(at_, "the file ends where ", what, " should be");
        if (*from == '\n') fail(at_, "this line ends where ", what, " should be");
        Number number{};
        const auto [last, error] = std::from_chars(*from == '+' ? from + 1 : from, end, number);
        if (error != std::errc() || (last != end && !is_space(*last))) {
            const char* stop = std::find_if(from, std::min(end, from + 24), is_space);
            fail(at_, "`", std::string(from, stop), "` is not ", what);
        }
        at_ = static_cast<std::size_t>(last - bytes_.data());
        return number;
    }

    /// A number of a section: text, or the bytes of `Binary`.
    template <class Binary, class Text>
    Text number(const char* what) {
        if (!file_.binary) return text<Text>(what);
        if (bytes_.size() - at_ < sizeof(Binary)) fail(bytes_.size(), "the file ends where ", what, " should be");
        Binary value;
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }

    std::int64_t integer(const char* what) { return number<std::int32_t, std::int64_t>(what); }
    std::int64_t long_integer(const char* what) { return number<std::int64_t, std::int64_t>(what); }

    double real(const char* what) {
        const std::size_t where = at_;
        const double x = number<double, double>(what);
        if (!std::isfinite(x)) fail(where, what, " is not finite");
        return x;
    }

    /// `n` if that many items of at least so many bytes can still follow.
    std::size_t count(std::int64_t n, std::size_t bytes_each, const char* items) const {
        if (n < 0) fail(at_, n, " ", items, " are announced");
        if (static_cast<std::uint64_t>(n) > (bytes_.size() - at_) / bytes_each)
            fail(at_, n, " ", items, " are announced, and the file ends before that");
        return static_cast<std::size_t>(n);
    }

    /// A count in text on a line of its own, in any file.
    std::size_t text_count(std::size_t bytes_each, const char* items) {
        const std::size_t n = count(text(("the number of " + std::string(items)).c_str()), bytes_each, items);
        end_of_line();
        return n;
    }

    /// A count of format 4.1; `bytes_each` in a binary file.
    std::size_t long_count(std::size_t bytes_each, const char* items) {
        const std::int64_t n = long_integer(("the number of " + std::string(items)).c_str());
        return count(n, file_.binary ? bytes_each : 2, items);
    }

    /// The tag of a physical group; the sign in the file is an orientation, which does not matter here.
    std::int32_t group(std::size_t where, std::int64_t number) const {
        constexpr std::int64_t largest = std::numeric_limits<std::int32_t>::max();
        if (number > largest || number < -largest) fail(where, number, " cannot be the tag of a physical group");
        return static_cast<std::int32_t>(std::abs(number));
    }

    // --- header and sections

    void read_header() {
        const std::string_view first = next_line();
        if (first.empty()) fail(0, "this file is empty");
        if (first == "$NOD")
            file_.fail_with_note(0, how_to_convert,
                                 "this file has version 1 of Gmsh's format; 2.2 and 4.1 can be read");
        if (first != "$MeshFormat") fail(0, "this is no Gmsh mesh: it does not begin with $MeshFormat");
        const std::size_t where = at_;
        const double version = real("the version of the format");
        const std::int64_t type = text("the file type (0 ASCII, 1 binary)"), size = text("the size of numbers");
        is_22_ = std::abs(version - 2.2) < 1e-6;
        if (!is_22_ && std::abs(version - 4.1) >= 1e-6) {
            char shown[32];
            std::snprintf(shown, sizeof shown, "%.1f", std::fmin(std::fabs(version), 1e6));
            file_.fail_with_note(where, how_to_convert, "this file has version ", shown,
                                 " of Gmsh's format; 2.2 and 4.1 can be read");
        }
        if (type != 0 && type != 1) fail(where, "the file type is ", type, ", neither 0 (ASCII) nor 1 (binary)");
        if (size != 8) fail(where, "numbers have ", size, " bytes in this file; 8 can be read");
        file_.binary = type == 1;
        end_of_line();
        if (file_.binary) check_byte_order();
        expect_line("$EndMeshFormat");
    }

    void check_byte_order() {
        const std::size_t where = at_;
        const std::int64_t one = integer("the number 1 that shows the byte order");
        if (one == 0x01000000)
            file_.fail_with_note(where, "save it as text, or on this kind of machine",
                                 "this file was written with the other byte order");
        if (one != 1) fail(where, "the number 1 that shows the byte order is ", one);
    }

    /// Reads a section, or skips one that does not concern the mesh. Begins after `$Name`.
    void read_section(const std::string& name, std::size_t where) {
        if (name == "PartitionedEntities" || name == "GhostElements")
            file_.fail_with_note(where, "save it whole: Mesh > Unpartition in Gmsh, or `UnpartitionMesh;`",
                                 "this mesh is cut into partitions");
        if (name == "PhysicalNames") {
            read_group_names();
        } else if (name == "Entities" && !is_22_) {
            read_entities_41();
        } else if (name == "Nodes") {
            is_22_ ? read_nodes_22() : read_nodes_41();
        } else if (name == "Elements") {
            is_22_ ? read_elements_22() : read_elements_41();
        } else {
            const std::size_t end = bytes_.find("$End" + name, at_);
            if (end == std::string::npos) fail(where, "the section $", name, " has no end");
            at_ = end + 4 + name.size();
            return;
        }
        expect_line("$End" + name);
    }

    /// Text in any file: dimension, tag and "name" per line.
    void read_group_names() {
        for (std::size_t n = text_count(7, "physical names"); n > 0; --n) {
            const std::size_t where = at_;
            const std::int64_t dimension = text("the dimension of a group");
            const std::int32_t tag = group(where, text("the tag of a group"));
            const std::string_view rest = next_line();
            const std::size_t open = rest.find('"'), close = rest.rfind('"');
            if (open != 0 || close == 0 || close + 1 != rest.size())
                fail(where, "a line here is: dimension tag \"name\"");
            if (dimension < 0 || dimension > 3) fail(where, "a group cannot have the dimension ", dimension);
            if (close == 1) fail(where, "this group has an empty name");
            file_.group_names[{static_cast<int>(dimension), tag}] = std::string(rest.substr(1, close - 1));
        }
    }

    void read_nodes_22() {
        file_.nodes.resize(text_count(file_.binary ? 28 : 8, "nodes"));
        for (GmshNode& node : file_.nodes) {
            node.tag = integer("the tag of a node");
            for (double& x : node.position) x = real("a coordinate");
            end_of_record();
        }
    }

    /// ASCII, per element: number, type, number of tags, tags, nodes. Binary, per block: type, number of elements,
    /// number of tags; then for each element: number, tags, nodes.
    void read_elements_22() {
        const std::size_t n_elements = text_count(8, "elements");
        for (std::size_t i = 0; i < n_elements;) {
            const std::size_t where = at_;
            if (!file_.binary) {
                text("the number of an element");
                const int n_nodes = nodes_of_type(where, text("the type of an element"));
                read_element_22(n_nodes, text("the number of tags"), where);
                end_of_line();
                ++i;
                continue;
            }
            const int n_nodes = nodes_of_type(where, integer("the type of elements"));
            const std::int64_t announced = integer("the number of elements");
            const std::size_t n_tags = count(integer("the number of tags"), 4, "tags");
            const std::size_t n = count(announced, 4 * (1 + n_tags + n_nodes), "elements"), left = n_elements - i;
            if (n == 0 || n > left) fail(where, n, " elements follow here, where 1 to ", left, " should");
            for (const std::size_t end = i + n; i < end; ++i) {
                const std::size_t here = at_;
                integer("the number of an element");
                read_element_22(n_nodes, static_cast<std::int64_t>(n_tags), here);
            }
        }
    }

    /// Tags are physical group, entity, and possibly partitions.
    void read_element_22(int n_nodes, std::int64_t n_tags, std::size_t where) {
        std::int32_t of_group = 0;
        for (std::int64_t i = 0; i < n_tags; ++i) {
            const std::int64_t tag = integer("a tag of an element");
            if (i == 0) of_group = group(where, tag);
        }
        std::array<std::int64_t, 3> corners{};
        for (int k = 0; k < n_nodes; ++k) corners[k] = integer("the tag of a node");
        add_element(n_nodes, corners, of_group, where);
    }

    /// Entities have a place (points) or a box, then the physical groups, then (not points) the entities of the
    /// boundary.
    void read_entities_41() {
        std::array<std::size_t, 4> n{};
        for (std::size_t& of_dimension : n) of_dimension = long_count(4, "entities");
        end_of_record();
        has_entities_ = true;
        for (int dimension = 0; dimension < 4; ++dimension)
            for (std::size_t i = 0; i < n[dimension]; ++i) {
                const std::size_t where = at_;
                const std::int64_t tag = integer("the tag of an entity");
                for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) real("a coordinate");
                std::vector<std::int32_t> groups(long_count(4, "physical groups"));
                for (std::int32_t& g : groups) g = group(where, integer("the tag of a physical group"));
                const std::size_t n_borders = dimension == 0 ? 0 : long_count(4, "entities of a boundary");
                for (std::size_t k = 0; k < n_borders; ++k) integer("the tag of an entity");
                end_of_record();
                groups_of_entity_[{dimension, tag}] = std::move(groups);
            }
    }

    /// Numbers of blocks and of items, then the smallest and the largest tag.
    std::array<std::size_t, 2> read_totals_41(std::size_t bytes_each, const char* blocks, const char* items) {
        const std::size_t n_blocks = long_count(20, blocks), n = long_count(bytes_each, items);
        for (const char* end : {"the smallest tag", "the largest tag"}) long_integer(end);
        end_of_record();
        return {n_blocks, n};
    }

    void read_nodes_41() {
        const auto [n_blocks, n_nodes] = read_totals_41(32, "blocks of nodes", "nodes");
        std::vector<GmshNode>& nodes = file_.nodes;
        for (std::size_t block = 0; block < n_blocks; ++block) {
            const std::size_t where = at_;
            const std::int64_t dimension = integer("a dimension");
            integer("the tag of an entity");
            const bool parametric = integer("0 or 1 (parametric)") != 0;
            const std::size_t n = long_count(32, "nodes"), first = nodes.size();
            end_of_record();
            if (dimension < 0 || dimension > 3) fail(where, "nodes cannot have the dimension ", dimension);
            if (n > n_nodes - first)
                fail(where, "the blocks hold more than the ", n_nodes, " nodes that are announced");
            nodes.resize(first + n);
            for (std::size_t i = first; i < nodes.size(); ++i) {
                nodes[i].tag = long_integer("the tag of a node");
                end_of_record();
            }
            for (std::size_t i = first; i < nodes.size(); ++i) {
                for (double& x : nodes[i].position) x = real("a coordinate");
                for (std::int64_t d = 0; parametric && d < dimension; ++d) real("a parametric coordinate");
                end_of_record();
            }
        }
        if (nodes.size() != n_nodes) fail(at_, "the blocks hold ", nodes.size(), " nodes, announced are ", n_nodes);
    }

    void read_elements_41() {
        static const std::vector<std::int32_t> none{0};
        const auto [n_blocks, n_elements] = read_totals_41(16, "blocks of elements", "elements");
        std::size_t n_read = 0;
        for (std::size_t block = 0; block < n_blocks; ++block) {
            const std::size_t where = at_;
            const std::int64_t dimension = integer("a dimension"), tag = integer("the tag of an entity");
            const int n_nodes = nodes_of_type(where, integer("the type of elements"));
            const std::size_t n = long_count(8 * (1 + static_cast<std::size_t>(n_nodes)), "elements");
            end_of_record();
            if (n > n_elements - n_read)
                fail(where, "the blocks hold more than the ", n_elements, " elements that are announced");
            if (dimension != n_nodes - 1) fail(where, "elements of this type cannot have the dimension ", dimension);
            const auto entity = groups_of_entity_.find({n_nodes - 1, tag});
            if (has_entities_ && entity == groups_of_entity_.end())
                fail(where, "$Entities has no entity ", tag, " of dimension ", dimension);
            const std::vector<std::int32_t>& groups = !has_entities_ || entity->second.empty() ? none : entity->second;
            for (std::size_t i = 0; i < n; ++i) {
                const std::size_t here = at_;
                long_integer("the tag of an element");
                std::array<std::int64_t, 3> corners{};
                for (int k = 0; k < n_nodes; ++k) corners[k] = long_integer("the tag of a node");
                end_of_record();
                for (const std::int32_t of_group : groups) add_element(n_nodes, corners, of_group, here);
            }
            n_read += n;
        }
        if (n_read != n_elements) fail(at_, "the blocks hold ", n_read, " elements, announced are ", n_elements);
    }

    /// Number of nodes of an element type; any other type than points, lines and triangles of first order is refused.
    int nodes_of_type(std::size_t where, std::int64_t type) const {
        if (type == 15) return 1;
        if (type == 1 || type == 2) return static_cast<int>(type) + 1;
        // clang-format off
        static const std::map<std::int64_t, const char*> names{
            {3, "a quadrangle"}, {4, "a tetrahedron"}, {5, "a hexahedron"}, {6, "a prism"}, {7, "a pyramid"},
            {8, "a line of 3 nodes"}, {9, "a triangle of 6 nodes"}, {10, "a quadrangle of 9 nodes"}, {16, "a quadrangle of 8 nodes"}};
        // clang-format on
        const auto found = names.find(type);
        const char* note = "only triangles of 3 nodes (type 2), lines of 2 nodes (1) and points (15) can be read";
        if (type == 3 || type == 10 || type == 16)
            note = "only triangles can be read: mesh without `Recombine Surface`";
        if (type == 8 || type == 9)
            note = "only triangles of 3 nodes can be read: save the mesh with order 1 (Mesh.ElementOrder = 1)";
        if (type >= 4 && type <= 7) note = "only plane meshes can be read: mesh in two dimensions (gmsh -2)";
        file_.fail_with_note(where, note,
                             found == names.end() ? "an element of type " + std::to_string(type) : found->second,
                             " is in this mesh");
    }

    void add_element(int n_nodes, const std::array<std::int64_t, 3>& corners, std::int32_t of_group,
                     std::size_t where) {
        if (n_nodes == 2) file_.lines.push_back({{corners[0], corners[1]}, of_group, where});
        if (n_nodes == 3) file_.triangles.push_back({corners, of_group, where});
    }

    GmshFile& file_;
    const std::string& bytes_;
    std::size_t at_ = 0;
    bool is_22_ = false;  // else 4.1
    bool has_entities_ = false;
    std::map<std::pair<int, std::int64_t>, std::vector<std::int32_t>> groups_of_entity_;  // by dimension and tag
};

}  // namespace

GmshFile::GmshFile(const std::string& bytes_of_file, const std::string& name_of_file)
    : bytes(bytes_of_file), name(name_of_file) {
    Reader(*this).read();
}

void GmshFile::throw_error(std::size_t where, const std::string& message, const std::string& note) const {
    constexpr std::size_t longest_line_shown = 160;
    Diagnostic d{.code = "bad-mesh", .message = message, .file = name, .note = note};
    where = std::min(where, bytes.size());
    if (binary) {
        d.message += " (at byte " + std::to_string(where) + ")";
        throw UserError({d});
    }
    const std::size_t line = where == 0 ? std::string::npos : bytes.rfind('\n', where - 1);
    const std::size_t begin = line == std::string::npos ? 0 : line + 1,
                      stop = std::min(bytes.find('\n', begin), bytes.size());
    d.line = 1 + static_cast<int>(std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(begin), '\n'));
    d.column = 1 + static_cast<int>(where - begin);
    if (stop - begin <= longest_line_shown) {
        d.source_line = bytes.substr(begin, stop - begin);
        const auto is_control = [](unsigned char c) { return c < ' ' || c == 127; };
        std::replace_if(d.source_line.begin(), d.source_line.end(), is_control, ' ');
    }
    throw UserError({d});
}

std::string GmshFile::group_name(int dimension, std::int32_t tag) const {
    if (tag == 0) return "";
    const auto found = group_names.find({dimension, tag});
    return found == group_names.end() ? std::to_string(tag) : found->second;
}

}  // namespace knap
