// Characters of UTF-8, words that are nearly alike, messages for a terminal.
#include "base/text.hpp"

#include <doctest/doctest.h>

namespace text_test {

using namespace knap;

TEST_CASE("UTF-8: the limits of RFC 3629") {
    for (const char* text :
         {"", "plain", "\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF", "\xEE\x80\x80", "\xEF\xBF\xBF",
          "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF", "\xCF\x83_c \xE2\x89\xA4 3"})
        CHECK_MESSAGE(is_utf8(text), text);
    for (const char* text :
         {"\x80", "\xC0\x80", "\xC1\xBF", "\xC2", "\xC2 ", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xE2\x89",
          "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF", "ab\xE2\x28\xA1"})
        CHECK_FALSE_MESSAGE(is_utf8(text), text);
}

TEST_CASE("UTF-8: characters are counted and never cut") {
    const std::string text = "\xCF\x83\xE2\x89\xA4\xF0\x9F\x98\x80x";  // 2 + 3 + 4 + 1 bytes
    REQUIRE(text.size() == 10);
    CHECK(n_characters(text) == 4);
    const std::size_t begins[] = {0, 2, 2, 5, 5, 5, 9, 9, 9, 9, 10};
    for (std::size_t i = 0; i <= text.size(); ++i) CHECK(character_begin(text, i) == begins[i]);
}

TEST_CASE("the nearest word is proposed where one is alike") {
    const std::vector<std::string> keys{"sigma_c", "G_c", "gamma", "friction", "restitution", "end"};
    const auto meant = [&](const char* word) {
        const std::string* found = nearest(word, keys);
        return found ? *found : "";
    };
    CHECK(meant("sigmac") == "sigma_c");
    CHECK(meant("Gamma") == "gamma");
    CHECK(meant("frcition") == "friction");  // neighbours in the other order
    CHECK(meant("g_c") == "G_c");
    CHECK(meant("edn") == "end");
    CHECK(meant("temperature") == "");
    CHECK(meant("") == "");
    CHECK(did_you_mean("sigmac", keys) == "did you mean `sigma_c`?");
    CHECK(did_you_mean("temperature", keys) == "");
    CHECK(did_you_mean("stres", {"stress_xx", "speed", "stress_yy"}) == "did you mean `stress_xx` or `stress_yy`?");
    CHECK(did_you_mean("st", {"stress_xx", "stress_yy"}) == "");
}

TEST_CASE("messages carry no control characters to a terminal") {
    CHECK(printable("a\x1B[31mb\r\nc\td\x7F") == "a?[31mb?\nc\td?");
    CHECK(printable("\xC2\x9B\xC2\xB5m") == "?\xC2\xB5m");  // U+009B is a control character, U+00B5 a letter
}

TEST_CASE("words and numbers as text") {
    CHECK(joined({"a", "b", "c"}) == "a, b, c");
    CHECK(joined({}, "; ") == "");
    CHECK(trimmed(" \t a b\t") == "a b");
    CHECK(trimmed(" \t") == "");
    CHECK(concatenated("n = ", 3, ", x = ", 0.1) == "n = 3, x = 0.1");
}

}  // namespace text_test
