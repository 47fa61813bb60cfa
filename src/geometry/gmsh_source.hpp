#pragma once
// The bytes of a Gmsh file, read from the front: words and lines of text, and numbers that are text or binary.
#include <cstdint>
#include <string>
#include <string_view>

namespace knap {

/// Numbers do not depend on the locale. What is wrong throws UserError with the file and the line, or the byte of a binary file.
class GmshSource {
public:
    /// `name` is the file in messages; the bytes must live as long as this.
    GmshSource(const std::string& bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

    bool binary = false;  // of the numbers in the sections; section names and their counts are text in any file

    const std::string& name() const { return name_; }
    std::size_t at() const { return at_; }
    std::size_t left() const { return bytes_.size() - at_; }
    [[noreturn]] void fail(std::size_t where, const std::string& message, const std::string& note = {}) const;

    // text; `what` is wanted, for messages
    std::string_view next_line();                 // skips blank ones; without blanks at its ends; empty at the end of the file
    std::int64_t text_integer(const char* what);  // on this line
    double text_real(const char* what);
    void end_of_line();  // there must be nothing more on this line
    /// Skips all up to this text; false when it does not come.
    bool skip_past(std::string_view text);

    // numbers of a section
    std::int64_t integer(const char* what) { return binary ? binary_integer<std::int32_t>(what) : text_integer(what); }
    std::int64_t long_integer(const char* what) { return binary ? binary_integer<std::int64_t>(what) : text_integer(what); }
    double real(const char* what);
    void end_of_record() {
        if (!binary) end_of_line();
    }

    /// `n` if that many things of at least so many bytes can still come.
    std::size_t checked_count(std::int64_t n, std::size_t bytes_each, const char* what) const;

private:
    template <class Integer>
    std::int64_t binary_integer(const char* what);
    template <class Number>
    Number text_number(const char* what);
    void skip_blanks();
    void need(std::size_t n_bytes, const char* what) const;

    const std::string& bytes_;
    std::string name_;
    std::size_t at_ = 0;
};

}  // namespace knap
