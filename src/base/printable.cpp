#include "base/printable.hpp"

namespace knap {

std::string printable(const std::string& message) {
    std::string shown;
    for (std::size_t i = 0; i < message.size(); ++i) {
        const auto c = static_cast<unsigned char>(message[i]);
        const auto next = static_cast<unsigned char>(i + 1 < message.size() ? message[i + 1] : 0);
        const bool second_set = c == 0xC2 && next >= 0x80 && next < 0xA0;  // U+0080 to U+009F in UTF-8
        const bool control = (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F || second_set;
        shown += control ? '?' : message[i];
        if (second_set) ++i;
    }
    return shown;
}

}  // namespace knap
