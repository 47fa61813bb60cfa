#include "app/checkpoint.hpp"

#include "app/run_directory.hpp"
#include "base/error.hpp"

#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>

#include <concepts>
#include <sstream>

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
namespace {

namespace fs = std::filesystem;

const char* const names[] = {"checkpoint", "checkpoint.previous"};

template <class Archive>
void serve(Archive& archive, RunMemory& memory) {
    archive(memory.now, memory.control, memory.recorder, memory.log_size, memory.cpu, memory.wall, memory.cpu_steps);
}

void load(const fs::path& path, RunMemory& memory) {
    std::istringstream bytes(unpacked_checkpoint(read_whole_file(path)));
    try {
        cereal::BinaryInputArchive archive(bytes);
        serve(archive, memory);
    } catch (const std::exception& error) {  // cereal::Exception, or lengths that no memory has
        throw SimulationError(std::string("its memory cannot be read: ") + error.what());
    }
}

}  // namespace

void Checkpoints::write(RunMemory& memory) {
    std::ostringstream bytes;
    {
        cereal::BinaryOutputArchive archive(bytes);
        serve(archive, memory);
    }
    const fs::path newest = directory_ / names[0];
    if (fs::exists(newest)) fs::rename(newest, directory_ / names[1]);
    write_whole_file(newest, packed_checkpoint(std::move(bytes).str()));
    watch_ = Stopwatch();
}

std::string Checkpoints::read(RunMemory& memory) const {
    std::string said;
    for (const char* name : names) {
        const fs::path path = directory_ / name;
        if (!fs::exists(path)) continue;
        try {
            load(path, memory);
            return said;
        } catch (const SimulationError& error) {
            said += "warning[checkpoint]: " + path.string() + " is not used: " + error.what() + "\n";
        }
    }
    throw UserError("no-checkpoint", "the run in `" + directory_.string() + "` cannot go on from its checkpoints", said + "start it again with --force");
}

void Checkpoints::remove() const {
    std::error_code ignored;
    for (const char* name : names) fs::remove(directory_ / name, ignored);
}

bool Checkpoints::exist_in(const fs::path& directory) {
    std::error_code none;
    return fs::exists(directory / names[0], none) || fs::exists(directory / names[1], none);
}

}  // namespace knap
