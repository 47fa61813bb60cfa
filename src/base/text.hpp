#pragma once
// Text: numbers as decimals, characters of UTF-8, words that are nearly alike.
#include <charconv>
#include <cstddef>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

/// The parts one after the other; a double has six significant digits.
template <class... Parts>
std::string concatenated(const Parts&... parts) {
    std::ostringstream text;
    (text << ... << parts);
    return std::move(text).str();
}

/// The shortest decimal text that reads back as the same number, whatever the locale; or in a format of std::to_chars.
template <class Number, class... Format>
std::string decimal(Number value, Format... format) {
    char digits[64];
    return {digits, std::to_chars(digits, digits + sizeof digits, value, format...).ptr};
}
/// The same of a double, but "-0.0" for minus zero, since "-0" is an integer in TOML.
std::string shortest(double value);

/// Without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

/// "a, b, c"
std::string joined(const std::vector<std::string>& words, std::string_view separator = ", ");

/// An ASCII letter or digit, or one of _ - .
bool is_plain(char c);

/// The candidate nearest to `word` by edit distance; null when none is near.
const std::string* nearest(std::string_view word, const std::vector<std::string>& candidates);
/// The same as "did you mean `x`?", or "".
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// Whether a byte continues a character of UTF-8 (10xxxxxx).
constexpr bool continues_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; }
/// The number of characters in UTF-8 text.
std::size_t n_characters(std::string_view utf8);
/// With blanks behind it up to `width` characters.
std::string padded(const std::string& utf8, std::size_t width);
/// The first position from `i` on that is not inside a character.
std::size_t character_begin(std::string_view utf8, std::size_t i);
/// Whether all of a text is UTF-8 (RFC 3629).
bool is_utf8(std::string_view text);

/// With & and < escaped, as text between the tags of XML.
std::string xml_text(std::string_view text);

/// A message fit for a terminal: control characters become "?", except line feeds and tabs; columns stay.
std::string printable(const std::string& message);

}  // namespace knap
