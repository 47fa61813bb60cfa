// The memory of a run as bytes, and back. What is read is believed in nothing: lengths are held against the bytes that are left before anything
// is allocated, and a bool is 0 or 1.
#include "app/run/checkpoint.hpp"
#include "base/error.hpp"

#include <cereal/cereal.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>

#include <concepts>
#include <cstring>

namespace knap {
namespace {

template <class T>
concept Number = std::is_arithmetic_v<T>;

class MemoryWriter : public cereal::OutputArchive<MemoryWriter, cereal::AllowEmptyClassElision> {
public:
    MemoryWriter() : OutputArchive(this) {}
    void write(const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }

    std::string bytes;
};

class MemoryReader : public cereal::InputArchive<MemoryReader, cereal::AllowEmptyClassElision> {
public:
    explicit MemoryReader(std::string_view bytes) : InputArchive(this), left(bytes) {}
    void read(void* data, std::size_t size) {
        if (size > left.size()) throw std::runtime_error("it ends too early");
        if (size > 0) std::memcpy(data, left.data(), size);
        left.remove_prefix(size);
    }

    std::string_view left;
};

template <Number T>
void save(MemoryWriter& archive, const T& value) { archive.write(&value, sizeof value); }

template <Number T>
void load(MemoryReader& archive, T& value) {
    if constexpr (std::same_as<T, bool>) {
        unsigned char byte = 0;
        archive.read(&byte, 1);
        if (byte > 1) throw std::runtime_error("it holds what is neither true nor false");
        value = byte == 1;
    } else {
        archive.read(&value, sizeof value);
    }
}

template <class T>
void save(MemoryWriter& archive, const cereal::SizeTag<T>& tag) { archive(tag.size); }

/// Each of so many things has at least a byte.
template <class T>
void load(MemoryReader& archive, cereal::SizeTag<T>& tag) {
    archive(tag.size);
    if (tag.size > archive.left.size()) throw std::runtime_error("it says a length that it has not");
}

template <class T>
void save(MemoryWriter& archive, const cereal::BinaryData<T>& data) { archive.write(data.data, data.size); }

template <class T>
void load(MemoryReader& archive, cereal::BinaryData<T>& data) { archive.read(data.data, data.size); }

template <class Archive, class T>
    requires std::same_as<Archive, MemoryWriter> || std::same_as<Archive, MemoryReader>
void serialize(Archive& archive, cereal::NameValuePair<T>& pair) { archive(pair.value); }

template <class Archive>
void serve(Archive& archive, RunMemory& memory) {
    archive(memory.now, memory.control, memory.recorder, memory.log_size, memory.cpu, memory.wall, memory.cpu_model, memory.cpu_preload, memory.cpu_steps);
}

}  // namespace
}  // namespace knap

CEREAL_SETUP_ARCHIVE_TRAITS(knap::MemoryReader, knap::MemoryWriter)

namespace cereal {

template <class Archive>
void serialize(Archive& archive, knap::Vec2& v) {
    archive(v.x(), v.y());
}

template <class Archive, std::same_as<std::filesystem::path> Path>  // nothing that only converts to one
std::string save_minimal(const Archive&, const Path& path) {
    return path.string();
}

template <class Archive, std::same_as<std::filesystem::path> Path>
void load_minimal(const Archive&, Path& path, const std::string& text) {
    path = text;
}

}  // namespace cereal

namespace knap {

std::string bytes_of(RunMemory& memory) {
    MemoryWriter archive;
    serve(archive, memory);
    return std::move(archive.bytes);
}

void restore(const std::string& bytes, RunMemory& memory) {
    MemoryReader archive(bytes);
    try {
        serve(archive, memory);
    } catch (const std::exception& error) {
        throw SimulationError(std::string("its memory cannot be read: ") + error.what());
    }
    if (!archive.left.empty()) throw SimulationError("its memory is longer than that of a run");
}

}  // namespace knap
