#include "geometry/gmsh_source.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

namespace knap {
namespace {

constexpr std::size_t longest_line_shown = 160;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_space(char c) { return is_blank(c) || c == '\n'; }

}  // namespace

void GmshSource::fail(std::size_t where, const std::string& message, const std::string& note) const {
    Diagnostic d{.code = "bad-mesh", .message = message, .file = name_, .note = note};
    where = std::min(where, bytes_.size());
    if (binary) {
        d.message += " (at byte " + std::to_string(where) + ")";
        throw UserError({d});
    }
    const std::size_t line = where == 0 ? std::string::npos : bytes_.rfind('\n', where - 1);
    const std::size_t begin = line == std::string::npos ? 0 : line + 1, end = std::min(bytes_.find('\n', begin), bytes_.size());
    d.line = 1 + static_cast<int>(std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin), '\n'));
    d.column = 1 + static_cast<int>(where - begin);
    if (end - begin <= longest_line_shown) {
        d.source_line = bytes_.substr(begin, end - begin);
        std::replace_if(
            d.source_line.begin(), d.source_line.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
    }
    throw UserError({d});
}

void GmshSource::skip_blanks() {
    while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
}

std::string_view GmshSource::next_line() {
    while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
    const std::size_t begin = at_, end = std::min(bytes_.find('\n', at_), bytes_.size());
    at_ = std::min(end + 1, bytes_.size());
    std::string_view line = std::string_view(bytes_).substr(begin, end - begin);
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    return line;
}

template <class Number>
Number GmshSource::text_number(const char* what) {
    skip_blanks();
    const char *end = bytes_.data() + bytes_.size(), *from = bytes_.data() + at_;
    if (from == end) fail(at_, "the file ends where " + std::string(what) + " should be");
    if (*from == '\n') fail(at_, "this line ends where " + std::string(what) + " should be");
    Number number{};
    const auto [last, error] = std::from_chars(*from == '+' ? from + 1 : from, end, number);
    if (error != std::errc() || (last != end && !is_space(*last))) {
        const char* stop = std::find_if(from, std::min(end, from + 24), is_space);
        fail(at_, "`" + std::string(from, stop) + "` is not " + std::string(what));
    }
    at_ = static_cast<std::size_t>(last - bytes_.data());
    return number;
}

std::int64_t GmshSource::text_integer(const char* what) { return text_number<std::int64_t>(what); }

double GmshSource::text_real(const char* what) {
    const std::size_t where = at_;
    const double number = text_number<double>(what);
    if (!std::isfinite(number)) fail(where, std::string(what) + " is not finite");
    return number;
}

void GmshSource::end_of_line() {
    skip_blanks();
    if (at_ < bytes_.size() && bytes_[at_] != '\n') fail(at_, "there is more on this line than wanted");
    at_ = std::min(at_ + 1, bytes_.size());
    if (binary) return;  // what looks like blanks would be numbers
    while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
}

bool GmshSource::skip_past(std::string_view text) {
    const std::size_t found = bytes_.find(text, at_);
    if (found == std::string::npos) return false;
    at_ = found + text.size();
    return true;
}

void GmshSource::need(std::size_t n_bytes, const char* what) const {
    if (left() < n_bytes) fail(bytes_.size(), "the file ends where " + std::string(what) + " should be");
}

template <class Integer>
std::int64_t GmshSource::binary_integer(const char* what) {
    need(sizeof(Integer), what);
    Integer number;
    std::memcpy(&number, bytes_.data() + at_, sizeof number);
    at_ += sizeof number;
    return number;
}
template std::int64_t GmshSource::binary_integer<std::int32_t>(const char*);
template std::int64_t GmshSource::binary_integer<std::int64_t>(const char*);

double GmshSource::real(const char* what) {
    if (!binary) return text_real(what);
    need(sizeof(double), what);
    double number;
    std::memcpy(&number, bytes_.data() + at_, sizeof number);
    if (!std::isfinite(number)) fail(at_, std::string(what) + " is not finite");
    at_ += sizeof number;
    return number;
}

std::size_t GmshSource::checked_count(std::int64_t n, std::size_t bytes_each, const char* what) const {
    if (n < 0) fail(at_, std::to_string(n) + " " + what + " are announced");
    if (static_cast<std::uint64_t>(n) > left() / bytes_each)
        fail(at_, std::to_string(n) + " " + what + " are announced, and the file ends before that");
    return static_cast<std::size_t>(n);
}

}  // namespace knap
