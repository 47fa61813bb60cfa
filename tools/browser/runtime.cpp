// What Debian's C++ library for wasm32 leaves out: exceptions, and memory that runs out as one. The compiler throws and
// catches by instructions of WebAssembly (-fwasm-exceptions); here are the objects that they carry and the search for
// the handler, as the Itanium C++ ABI describes them (https://itanium-cxx-abi.github.io/cxx-abi/abi-eh.html), for one
// thread and this program: no exception specifications, no exceptions of other languages, no std::exception_ptr.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <new>
#include <typeinfo>

/// As every type_info of the library has it in its virtual table.
struct Type : std::type_info {
    virtual void unused1() const;
    virtual void unused2() const;
    virtual bool can_catch(const Type* thrown, void*& object) const;
};

namespace {

/// Lies before each thrown object. Its address, of which generated code carries no more, is that of the object.
struct alignas(16) Header {
    const std::type_info* type;
    void* (*destroy)(void*);  // destructors return `this` on this machine
    Header* below;            // of the exceptions that are being handled
    int n_handlers;           // < 0: it is thrown again and survives them
    void* caught;             // the object as the handler sees it: a base of what was thrown
};
Header* handled = nullptr;  // the innermost one

Header& header_of(void* object) { return static_cast<Header*>(object)[-1]; }

std::uint32_t read_unsigned(const std::uint8_t*& at) {
    std::uint32_t value = 0;
    for (int shift = 0;; shift += 7) {
        value |= static_cast<std::uint32_t>(*at & 0x7F) << shift;
        if ((*at++ & 0x80) == 0) return value;
    }
}
std::int32_t read_signed(const std::uint8_t*& at) {
    std::int32_t value = 0;
    for (int shift = 0;;) {
        const std::uint8_t byte = *at++;
        value |= static_cast<std::int32_t>(byte & 0x7F) << shift, shift += 7;
        if ((byte & 0x80) == 0) return shift < 32 && (byte & 0x40) != 0 ? value - (1 << shift) : value;
    }
}

}  // namespace

extern "C" {

/// Written by generated code before it asks which handler of a try block catches, and read after it.
struct {
    std::uintptr_t site;           // number of the try block in its function
    const std::uint8_t* handlers;  // table of the function
    std::uintptr_t selector;       // answer: number of the type of the handler; 0: none
} __wasm_lpad_context;

int __gxx_wasm_personality_v0(...) { return 0; }  // named in every function that catches; not called

int _Unwind_CallPersonality(void* object) {
    constexpr std::uint8_t absent = 0xFF;
    const std::uint8_t* at = __wasm_lpad_context.handlers;
    __wasm_lpad_context.selector = 0;
    if (*at++ != absent) std::abort();  // start of the landing pads: never given
    const std::uint8_t type_encoding = *at++;
    const std::uint8_t* types = nullptr;
    if (type_encoding != absent) {
        const std::uint32_t offset = read_unsigned(at);
        types = at + offset;
    }
    ++at;  // encoding of the sites
    const std::uint32_t length = read_unsigned(at);
    const std::uint8_t* const actions = at + length;
    std::uint32_t action = 0;
    for (std::uintptr_t site = 0; site <= __wasm_lpad_context.site; ++site)
        read_unsigned(at), action = read_unsigned(at);
    if (action == 0) return 0;
    Header& header = header_of(object);
    for (at = actions + action - 1;;) {
        const std::int32_t number = read_signed(at);
        const std::uint8_t* next = at;
        const std::int32_t offset = read_signed(next);
        if (number > 0) {
            const auto* type = reinterpret_cast<const Type* const*>(types)[-number];
            void* seen = object;
            if (type == nullptr || type->can_catch(static_cast<const Type*>(header.type), seen)) {
                header.caught = seen, __wasm_lpad_context.selector = number;
                return 0;
            }
        }
        if (offset == 0) return 0;
        at += offset;
    }
}

void* __cxa_allocate_exception(std::size_t size) {
    void* const memory = std::malloc(sizeof(Header) + size);
    if (memory == nullptr) std::abort();
    return static_cast<Header*>(memory) + 1;
}
void __cxa_free_exception(void* object) { std::free(&header_of(object)); }

void __cxa_throw(void* object, std::type_info* type, void* (*destroy)(void*)) {
    header_of(object) = {type, destroy, nullptr, 0, object};
    __builtin_wasm_throw(0, object);
}

void* __cxa_get_exception_ptr(void* object) { return header_of(object).caught; }

void* __cxa_begin_catch(void* object) {
    Header& header = header_of(object);
    header.n_handlers = (header.n_handlers < 0 ? -header.n_handlers : header.n_handlers) + 1;
    if (handled != &header) header.below = handled, handled = &header;
    return header.caught;
}

void __cxa_end_catch() {
    Header& header = *handled;
    if (header.n_handlers < 0) {
        if (++header.n_handlers == 0) handled = header.below;
    } else if (--header.n_handlers == 0) {
        handled = header.below;
        if (header.destroy != nullptr) header.destroy(&header + 1);
        std::free(&header);
    }
}

void __cxa_rethrow() {
    if (handled == nullptr) std::terminate();
    handled->n_handlers = -handled->n_handlers;
    __builtin_wasm_throw(0, handled + 1);
}

void __cxa_throw_bad_array_new_length() { throw std::bad_array_new_length(); }

}  // extern "C"

void* operator new(std::size_t size) {
    if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
    throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
