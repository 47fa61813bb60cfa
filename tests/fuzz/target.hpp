#pragma once
// A reader as libFuzzer calls it: any bytes give a result or the documented error. Everything else aborts the program:
// another exception, a finding of a sanitizer, require(false). tools/fuzz runs them with clang; the tests replay the
// corpus (replay.cpp).
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace knap::tests {

inline void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "not so: %s\n", what);
    std::abort();
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
    return size == 0 ? std::string() : std::string(reinterpret_cast<const char*>(data), size);
}

}  // namespace knap::tests
