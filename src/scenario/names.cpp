#include "scenario/names.hpp"

#include <algorithm>

namespace knap {

bool is_name(std::string_view text) {
    const auto allowed = [](unsigned char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == ' ' || c >= 0x80;
    };
    return !text.empty() && text.front() != ' ' && text.back() != ' ' && std::all_of(text.begin(), text.end(), allowed);
}

}  // namespace knap
