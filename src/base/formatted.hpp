#pragma once
// printf into a string; the text of a place.
#include "base/vec.hpp"

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <string>

namespace knap {

/// The text that printf writes for this format and these values.
[[gnu::format(printf, 1, 2)]] inline std::string formatted(const char* format, ...) {
    std::va_list values, again;
    va_start(values, format);
    va_copy(again, values);
    std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, values)), '\0');
    std::vsnprintf(text.data(), text.size() + 1, format, again);
    va_end(again);
    va_end(values);
    return text;
}

/// As messages name a place: "(0.01, 0.02) m".
inline std::string place_text(const Vec2& x) { return formatted("(%.6g, %.6g) m", x.x(), x.y()); }

}  // namespace knap
