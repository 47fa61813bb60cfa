#include "scenario/toml_tree.hpp"

#include "base/text.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace knap {
namespace {

Place place_of(const toml::source_region& region) {
    const auto [begin, end] = std::pair(region.begin, region.end);
    const bool one_line = begin.line == end.line && end.column > begin.column;
    // a value over several lines is marked to the end of its first line (Source::quote shortens the length)
    const int length = one_line ? static_cast<int>(end.column - begin.column) : std::numeric_limits<int>::max();
    return {static_cast<int>(begin.line), static_cast<int>(begin.column), length};
}

Node node_of(const toml::node& value) {
    Node node{.type = Node::Type::date, .place = place_of(value.source())};
    if (const toml::table* table = value.as_table()) {
        node.type = Node::Type::table;
        for (const auto& [key, member] : *table) {
            Node& child = node.children.emplace_back(node_of(member));
            child.name = std::string(key.str());
            child.name_place = place_of(key.source());
        }
        std::ranges::stable_sort(node.children, {}, [](const Node& child) {  // the library sorts by name
            return std::pair(child.name_place.line, child.name_place.column);
        });
    } else if (const toml::array* array = value.as_array()) {
        node.type = Node::Type::array;
        for (const toml::node& item : *array) node.children.push_back(node_of(item));
    } else if (const auto text = value.value_exact<std::string>()) {
        node.type = Node::Type::text, node.text = *text;
    } else if (const auto integer = value.value_exact<std::int64_t>()) {
        node.type = Node::Type::integer, node.integer = *integer, node.number = static_cast<double>(*integer);
    } else if (const auto number = value.value_exact<double>()) {
        node.type = Node::Type::number, node.number = *number;
    } else if (const auto boolean = value.value_exact<bool>()) {
        node.type = Node::Type::boolean, node.boolean = *boolean;
    }
    return node;
}

/// Position of the quote that ends the string beginning at `at`, or the end of the text.
std::size_t end_of_string(std::string_view text, std::size_t at) {
    const char quote = text[at];
    const std::string three(3, quote);
    const bool is_long = text.substr(at, 3) == three;
    for (at += is_long ? 3 : 1; at < text.size(); ++at) {
        if (text[at] == '\\' && quote == '"') ++at;
        else if (is_long && text.substr(at, 3) == three) return at + 2;
        else if (!is_long && (text[at] == quote || text[at] == '\n')) return at;
    }
    return text.size();
}

/// Place of a key with too many parts. (The library limits nested brackets itself, to 256.)
std::optional<Place> too_deep_key(std::string_view text) {
    std::size_t n_dots = 0;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const char c = text[at];
        if (c == '"' || c == '\'') at = end_of_string(text, at);
        else if (c == '#') at = std::min(text.find('\n', at), text.size()) - 1;
        else if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) n_dots = 0;
        else if (c == '.' && ++n_dots == max_key_parts) {
            const std::string_view before = text.substr(0, at);
            const auto n_lines = std::count(before.begin(), before.end(), '\n');
            const std::size_t begin = before.rfind('\n') + 1;  // 0 where there is none
            return Place{1 + static_cast<int>(n_lines), 1 + static_cast<int>(at - begin), 1};
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::vector<PathPart>> path_parts(std::string_view path) {
    std::vector<PathPart> parts;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t dot = std::min(path.find('.', begin), path.size());
        const std::string_view text = path.substr(begin, dot - begin);
        const std::size_t bracket = std::min(text.find('['), text.size());
        PathPart& part = parts.emplace_back(PathPart{std::string(text.substr(0, bracket)), std::nullopt});
        if (part.name.empty()) return std::nullopt;
        if (bracket < text.size()) {
            const char* end = text.data() + text.size();
            const auto [last, error] = std::from_chars(text.data() + bracket + 1, end, part.index.emplace());
            if (error != std::errc() || last + 1 != end || *last != ']') return std::nullopt;
        }
        begin = dot + 1;
    }
    return parts;
}

Node* find_part(Node& above, const PathPart& part) {
    if (above.type == Node::Type::array) {
        const auto is_named = [&](const Node& entry) {
            const Node* name = entry.find("name");
            return name && name->text == part.name;
        };
        const auto found = std::ranges::find_if(above.children, is_named);
        if (part.index) return nullptr;
        if (found != above.children.end()) return &*found;
        const bool is_pair = above.children.size() == 2 && above.children.front().type != Node::Type::table;
        return is_pair && (part.name == "x" || part.name == "y") ? &above.children[part.name == "y"] : nullptr;
    }
    Node* node = above.find(part.name);
    if (!node || !part.index) return node;
    return node->type == Node::Type::array && *part.index < node->children.size() ? &node->children[*part.index]
                                                                                  : nullptr;
}

std::optional<TomlError> parse_toml(const std::string& text, Node& root) {
    if (const std::optional<Place> place = too_deep_key(text))
        return TomlError{"a key has more than " + std::to_string(max_key_parts) + " parts", *place};
    try {
        root = node_of(toml::parse(std::string_view(text)));
        return std::nullopt;
    } catch (const toml::parse_error& error) {
        Place place = place_of(error.source());
        place.length = 1;
        const std::string message(error.description());
        const bool too_deep = message.find("TOML_MAX_NESTED_VALUES") != std::string::npos;
        return TomlError{too_deep ? "brackets go deeper than 256 levels" : message, place};
    }
}

Node parse_toml_value(std::string_view toml) {
    Node root;
    const bool good = !parse_toml("x = " + std::string(toml), root) && root.children.size() == 1;
    return good ? std::move(root.children.front()) : Node{};
}

std::string toml_quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) {
            out += c;
        } else {
            constexpr std::string_view digits = "0123456789ABCDEF";
            out += std::string("\\u00") + digits[static_cast<unsigned char>(c) / 16] + digits[c % 16];
        }
    }
    return out + '"';
}

std::string toml_text(const Node& node) {
    switch (node.type) {
        case Node::Type::text: return toml_quoted(node.text);
        case Node::Type::boolean: return node.boolean ? "true" : "false";
        case Node::Type::integer: return std::to_string(node.integer);
        case Node::Type::number: {
            const std::string digits = shortest(node.number);
            return node.unit.empty() ? digits : toml_quoted(digits + " " + node.unit);
        }
        default: break;
    }
    std::vector<std::string> items;
    for (const Node& child : node.children) items.push_back(toml_text(child));
    return "[" + joined(items) + "]";
}

}  // namespace knap
