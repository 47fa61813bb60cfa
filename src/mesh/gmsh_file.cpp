// The numbers of a section are text or bytes. Names of sections, physical names and the counts of format 2.2 are text
// in any file.
#include "mesh/gmsh_file.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <set>
#include <span>
#include <string_view>

namespace knap {
namespace {

using Integer = std::int64_t;

const char* const how_to_convert = "Gmsh converts it: gmsh -0 old.msh -o new.msh -format msh41 (or msh22)";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_space(char c) { return is_blank(c) || c == '\n'; }

struct ElementType {
    int n_corners, n_nodes;  // the corners come first
};

/// Fails for all types but points, lines and triangles of first and second order.
ElementType element_type(const GmshFile& file, std::size_t where, Integer type) {
    if (type == 15) return {1, 1};
    if (type == 1 || type == 2) return {static_cast<int>(type) + 1, static_cast<int>(type) + 1};
    if (type == 8) return {2, 3};
    if (type == 9) return {3, 6};
    constexpr auto no_quads =
        "only triangles can be read: mesh without `Recombine Surface`, or cut them by knap-convert";
    constexpr auto order_2 =
        "only triangles of 3 and 6 nodes can be read: save the mesh with order 2 at most (Mesh.ElementOrder = 2)";
    constexpr auto plane = "only plane meshes can be read: mesh in two dimensions (gmsh -2)";
    constexpr auto known =
        "only triangles of 3 and 6 nodes (types 2 and 9), lines of 2 and 3 nodes (1, 8) and points (15) can be read";
    struct Type {
        Integer type;
        const char *name, *note;
    };
    // clang-format off
    constexpr Type types[]{
        {3, "a quadrangle", no_quads}, {10, "a quadrangle of 9 nodes", no_quads},
        {16, "a quadrangle of 8 nodes", no_quads},
        {4, "a tetrahedron", plane}, {5, "a hexahedron", plane}, {6, "a prism", plane}, {7, "a pyramid", plane},
        {20, "a triangle of 9 nodes", order_2}, {21, "a triangle of 10 nodes", order_2},
        {26, "a line of 4 nodes", order_2}};
    // clang-format on
    for (const auto& t : types)
        if (t.type == type) file.fail({where, t.note}, t.name, " is in this mesh");
    file.fail({where, known}, "an element of type ", type, " is in this mesh");
}

/// Reads a file from its start. Numbers do not depend on the locale; `what` names the expected number in messages.
class Reader {
public:
    explicit Reader(GmshFile& file) : file_(file), bytes_(file.bytes) {}

    void read() {
        read_header();
        std::set<std::string> seen;
        for (std::size_t where = at_; true; where = at_) {
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
            if (!seen.contains(needed)) fail({at_, saved_in_groups}, "this file has no section $", needed);
    }

private:
    using Entity = std::pair<int, Integer>;  // dimension and tag

    template <class... Parts>
    [[noreturn]] void fail(const GmshFile::Place& place, const Parts&... parts) const {
        file_.fail(place, parts...);
    }

    // --- lines

    template <class Predicate>
    void skip(Predicate is_skipped) {
        while (at_ < bytes_.size() && is_skipped(bytes_[at_])) ++at_;
    }

    /// The next line that is not blank, without blanks at its ends; empty at the end of the file.
    std::string_view next_line() {
        skip(is_space);
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
        fail({where, "is there more in this section than it announces?"}, "`", expected, "` should stand here");
    }

    void end_of_line() {
        skip(is_blank);
        if (at_ < bytes_.size() && bytes_[at_] != '\n') fail(at_, "there is more on this line than expected");
        at_ = std::min(at_ + 1, bytes_.size());
        if (!file_.binary) skip(is_space);  // in a binary file, bytes that look like blanks may be numbers
    }

    void end_of_record() {
        if (!file_.binary) end_of_line();
    }

    // --- numbers

    template <class Number = Integer>
    Number text(const char* what) {
        skip(is_blank);
        const char *end = bytes_.data() + bytes_.size(), *from = bytes_.data() + at_;
        if (from == end) fail(at_, "the file ends where ", what, " should be");
        if (*from == '\n') fail(at_, "this line ends where ", what, " should be");
        Number number{};
        const auto [last, error] = std::from_chars(*from == '+' ? from + 1 : from, end, number);
        if (error != std::errc() || (last != end && !is_space(*last)))
            fail(at_, "`", std::string(from, std::find_if(from, std::min(end, from + 24), is_space)), "` is not ",
                 what);
        at_ = static_cast<std::size_t>(last - bytes_.data());
        return number;
    }

    /// A number of a section: text, or the bytes of `Binary`.
    template <class Binary, class Text = Binary>
    Text number(const char* what) {
        if (!file_.binary) return text<Text>(what);
        if (bytes_.size() - at_ < sizeof(Binary)) fail(bytes_.size(), "the file ends where ", what, " should be");
        Binary value;
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }

    Integer integer(const char* what) { return number<std::int32_t, Integer>(what); }
    Integer long_integer(const char* what) { return number<std::int64_t>(what); }
    /// Tag of a node or an element.
    Integer tag(const char* what) { return is_41_ ? long_integer(what) : integer(what); }

    double real(const char* what) {
        const std::size_t where = at_;
        const double x = number<double>(what);
        if (!std::isfinite(x)) fail(where, what, " is not finite");
        return x;
    }

    /// `n` where the file has room for that many items of at least `bytes_each`.
    std::size_t count(Integer n, std::size_t bytes_each, const char* items) const {
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
        const Integer n = long_integer(("the number of " + std::string(items)).c_str());
        return count(n, file_.binary ? bytes_each : 2, items);
    }

    /// The tag of a physical group. Its sign in the file is an orientation, which has no meaning here.
    std::int32_t group(std::size_t where, Integer number) const {
        constexpr Integer largest = std::numeric_limits<std::int32_t>::max();
        if (number > largest || number < -largest) fail(where, number, " cannot be the tag of a physical group");
        return static_cast<std::int32_t>(std::abs(number));
    }

    // --- header and sections

    void read_header() {
        constexpr auto readable = " of Gmsh's format; 2.2 and 4.1 can be read";
        const std::string_view first = next_line();
        if (first.empty()) fail(0, "this file is empty");
        if (first == "$NOD") fail({0, how_to_convert}, "this file has version 1", readable);
        if (first != "$MeshFormat")
            fail({0, "knap-convert FILE.inp FILE.msh reads Abaqus, and all that meshio does"},
                 "this is no Gmsh mesh: it begins with `" + std::string(first.substr(0, 40)) + "`, not $MeshFormat");
        const std::size_t where = at_;
        const double version = real("the version of the format");
        const Integer type = text("the file type (0 ASCII, 1 binary)"), size = text("the size of numbers");
        is_41_ = std::abs(version - 4.1) < 1e-6;
        if (!is_41_ && std::abs(version - 2.2) >= 1e-6) {
            char shown[32];
            std::snprintf(shown, sizeof shown, "%.1f", std::fmin(std::fabs(version), 1e6));
            fail({where, how_to_convert}, "this file has version ", shown, readable);
        }
        if (type != 0 && type != 1) fail(where, "the file type is ", type, ", neither 0 (ASCII) nor 1 (binary)");
        if (size != 8) fail(where, "numbers have ", size, " bytes in this file; 8 can be read");
        file_.binary = type == 1;
        end_of_line();
        if (file_.binary) {
            const std::size_t here = at_;
            const Integer one = integer("the number 1 that shows the byte order");
            if (one == 0x01000000)
                fail({here, "save it as text, or on this kind of machine"},
                     "this file was written with the other byte order");
            if (one != 1) fail(here, "the number 1 that shows the byte order is ", one);
        }
        expect_line("$EndMeshFormat");
    }

    /// Reads a section after its line `$Name`; skips one that does not describe the mesh.
    void read_section(const std::string& name, std::size_t where) {
        struct {
            const char* name;
            void (Reader::*in_22)();
            void (Reader::*in_41)();
        } constexpr sections[]{{"PhysicalNames", &Reader::read_group_names, &Reader::read_group_names},
                               {"Entities", nullptr, &Reader::read_entities_41},
                               {"Nodes", &Reader::read_nodes_22, &Reader::read_nodes_41},
                               {"Elements", &Reader::read_elements_22, &Reader::read_elements_41}};
        if (name == "PartitionedEntities" || name == "GhostElements")
            fail({where, "save it whole: Mesh > Unpartition in Gmsh, or `UnpartitionMesh;`"},
                 "this mesh is cut into partitions");
        for (const auto& section : sections)
            if (const auto read = is_41_ ? section.in_41 : section.in_22; read && name == section.name) {
                (this->*read)();
                return expect_line("$End" + name);
            }
        const std::size_t end = bytes_.find("$End" + name, at_);
        if (end == std::string::npos) fail(where, "the section $", name, " has no end");
        at_ = end + 4 + name.size();
    }

    /// Text in any file: dimension, tag and "name" per line.
    void read_group_names() {
        for (std::size_t n = text_count(7, "physical names"); n > 0; --n) {
            const std::size_t where = at_;
            const Integer dimension = text("the dimension of a group");
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
    /// number of tags; then for each element: number, tags, nodes. Tags are physical group, entity, partitions.
    void read_elements_22() {
        const std::size_t n_elements = text_count(8, "elements");
        for (std::size_t i = 0; i < n_elements;) {
            const std::size_t where = at_, left = n_elements - i;
            if (!file_.binary) integer("the number of an element");
            const ElementType type = element_type(file_, where, integer("the type of an element"));
            const Integer announced = file_.binary ? integer("the number of elements") : 1;
            const std::size_t n_tags = count(integer("the number of tags"), file_.binary ? 4 : 2, "tags");
            const std::size_t n = file_.binary ? count(announced, 4 * (1 + n_tags + type.n_nodes), "elements") : 1;
            if (n == 0 || n > left) fail(where, n, " elements follow here, where 1 to ", left, " should");
            for (const std::size_t end = i + n; i < end; ++i) {
                const std::size_t here = file_.binary ? at_ : where;
                if (file_.binary) integer("the number of an element");
                std::int32_t of_group = 0;
                Integer entity = 0;
                for (std::size_t k = 0; k < n_tags; ++k) {
                    const Integer tag = integer("a tag of an element");
                    if (k == 0) of_group = group(here, tag);
                    if (k == 1) entity = tag;
                }
                add_element(type, {&of_group, 1}, entity, here);
            }
        }
    }

    /// Per entity: its place (points) or box, the physical groups, and (not points) the entities of the boundary.
    void read_entities_41() {
        std::array<std::size_t, 4> n{};
        for (std::size_t& of_dimension : n) of_dimension = long_count(4, "entities");
        end_of_record();
        has_entities_ = true;
        for (int dimension = 0; dimension < 4; ++dimension)
            for (std::size_t i = 0; i < n[dimension]; ++i) {
                const std::size_t where = at_;
                const Integer tag = integer("the tag of an entity");
                for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) real("a coordinate");
                std::vector<std::int32_t> groups(long_count(4, "physical groups"));
                for (std::int32_t& g : groups) g = group(where, integer("the tag of a physical group"));
                for (std::size_t k = dimension == 0 ? 0 : long_count(4, "entities of a boundary"); k > 0; --k)
                    integer("the tag of an entity");
                end_of_record();
                groups_of_entity_[{dimension, tag}] = std::move(groups);
            }
    }

    struct Block {
        std::size_t where;
        Entity entity;
        Integer type;   // of elements; for nodes 1 where parametric coordinates follow
        std::size_t n;  // items
    };

    /// A section in blocks: numbers of blocks and of items, smallest and largest tag; then per block dimension and tag
    /// of an entity, `type`, the number of items, and these.
    void read_blocks_41(const std::string& items, std::size_t bytes_each, const char* type,
                        void (Reader::*read)(const Block&)) {
        const std::size_t n_blocks = long_count(20, ("blocks of " + items).c_str());
        const std::size_t n_items = long_count(bytes_each, items.c_str());
        for (const char* limit : {"the smallest tag", "the largest tag"}) long_integer(limit);
        end_of_record();
        std::size_t n_read = 0;
        for (std::size_t i = 0; i < n_blocks; ++i) {
            Block block{.where = at_};
            const Integer dimension = integer("a dimension");
            block.entity = {static_cast<int>(dimension), integer("the tag of an entity")};
            block.type = integer(type);
            block.n = long_count(bytes_each, items.c_str());
            end_of_record();
            if (dimension < 0 || dimension > 3) fail(block.where, items, " cannot have the dimension ", dimension);
            if (block.n > n_items - n_read)
                fail(block.where, "the blocks hold more than the ", n_items, " ", items, " that are announced");
            (this->*read)(block);
            n_read += block.n;
        }
        if (n_read != n_items) fail(at_, "the blocks hold ", n_read, " ", items, ", announced are ", n_items);
    }

    void read_nodes_41() { read_blocks_41("nodes", 32, "0 or 1 (parametric)", &Reader::read_block_of_nodes); }

    void read_block_of_nodes(const Block& block) {
        file_.nodes.resize(file_.nodes.size() + block.n);
        const std::span<GmshNode> nodes = std::span(file_.nodes).last(block.n);
        for (GmshNode& node : nodes) node.tag = tag("the tag of a node"), end_of_record();
        for (GmshNode& node : nodes) {
            for (double& x : node.position) x = real("a coordinate");
            for (int d = 0; block.type != 0 && d < block.entity.first; ++d) real("a parametric coordinate");
            end_of_record();
        }
    }

    void read_elements_41() { read_blocks_41("elements", 16, "the type of elements", &Reader::read_block_of_elements); }

    void read_block_of_elements(const Block& block) {
        const ElementType type = element_type(file_, block.where, block.type);
        const auto& [dimension, number] = block.entity;
        if (dimension != type.n_corners - 1)
            fail(block.where, "elements of this type cannot have the dimension ", dimension);
        const auto entity = groups_of_entity_.find(block.entity);
        if (has_entities_ && entity == groups_of_entity_.end())
            fail(block.where, "$Entities has no entity ", number, " of dimension ", dimension);
        const bool in_group = has_entities_ && !entity->second.empty();
        for (std::size_t i = 0; i < block.n; ++i) {
            const std::size_t where = at_;
            tag("the tag of an element");
            add_element(type, in_group ? std::span<const std::int32_t>(entity->second) : no_group, number, where);
        }
    }

    /// Reads the nodes of an element, which end its record.
    void add_element(ElementType type, std::span<const std::int32_t> groups, Integer entity, std::size_t where) {
        std::array<Integer, 6> nodes{};
        for (int k = 0; k < type.n_nodes; ++k) nodes[k] = tag("the tag of a node");
        end_of_record();
        for (const std::int32_t of_group : groups) {
            if (type.n_corners == 2) file_.lines.push_back({{nodes[0], nodes[1]}, of_group, entity, where});
            if (type.n_corners < 3) continue;
            file_.triangles.push_back({{nodes[0], nodes[1], nodes[2]}, of_group, entity, where});
            file_.n_second_order += type.n_nodes == 6;
        }
    }

    static constexpr std::array<std::int32_t, 1> no_group{0};
    GmshFile& file_;
    const std::string& bytes_;
    std::size_t at_ = 0;  // byte
    bool is_41_ = false;  // else 2.2
    bool has_entities_ = false;
    std::map<Entity, std::vector<std::int32_t>> groups_of_entity_;
};

}  // namespace

GmshFile::GmshFile(const std::string& bytes_of_file, const std::string& name_of_file)
    : bytes(bytes_of_file), name(name_of_file) {
    Reader(*this).read();
}

void GmshFile::throw_error(const Place& place, const std::string& message) const {
    constexpr std::size_t longest_line_shown = 160;
    Diagnostic d{.code = "bad-mesh", .message = message, .file = name, .note = place.note};
    const std::size_t where = std::min(place.where, bytes.size());
    if (binary) {
        d.message += " (at byte " + std::to_string(where) + ")";
        throw UserError({d});
    }
    const std::size_t begin = where == 0 ? 0 : bytes.rfind('\n', where - 1) + 1,  // npos + 1 = 0
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
