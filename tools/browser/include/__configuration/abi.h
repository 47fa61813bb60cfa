#pragma once
// In Debian's libc++ for wasm32 iterators of arrays are classes; in the library that the program is otherwise compiled with they are
// pointers, as `const auto* found = std::ranges::find(...)` has them. Headers alone know the difference.
#include_next <__configuration/abi.h>
#undef _LIBCPP_ABI_USE_WRAP_ITER_IN_STD_ARRAY
#undef _LIBCPP_ABI_USE_WRAP_ITER_IN_STD_STRING_VIEW
