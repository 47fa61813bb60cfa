#include "app/run/checkpoint.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/whole_file.hpp"
#include "record/version.hpp"

#include <boost/crc.hpp>
#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>

#include <algorithm>
#include <concepts>
#include <sstream>

namespace cereal {

template <class Archive>
void serialize(Archive& archive, knap::Vec2& v) {
    archive(v.x(), v.y());
}

template <class Archive, std::same_as<std::filesystem::path> Path>  // not types that only convert to a path
std::string save_minimal(const Archive&, const Path& path) {
    return path.string();
}

template <class Archive, std::same_as<std::filesystem::path> Path>
void load_minimal(const Archive&, Path& path, const std::string& text) {
    path = text;
}

}  // namespace cereal

namespace knap {

template <class Archive>
void serialize(Archive& archive, RunMemory& memory) {
    archive(memory.now, memory.control, memory.recorder, memory.excavations, memory.adaptation, memory.triangle_steps,
            memory.log_size, memory.spent);
}

std::string bytes_of(RunMemory& memory) {
    std::ostringstream stream;
    cereal::BinaryOutputArchive archive(stream);
    archive(memory);
    return std::move(stream).str();
}

void restore(const std::string& bytes, RunMemory& memory) {
    std::istringstream stream(bytes);
    try {
        cereal::BinaryInputArchive archive(stream);
        archive(memory);
    } catch (const std::exception& error) {
        throw SimulationError(std::string("its memory cannot be read: ") + error.what());
    }
    if (stream.peek() != EOF) throw SimulationError("its memory is longer than that of a run");
}

// ---- the file

namespace {

constexpr const char* magic = "knap-checkpoint";
constexpr int format_number = 14;

std::string program() { return version() + "-" + git_hash() + (git_dirty() ? "-changed" : ""); }

std::uint32_t checksum(std::string_view bytes) {
    boost::crc_32_type crc;
    crc.process_bytes(bytes.data(), bytes.size());
    return crc.checksum();
}

}  // namespace

std::string packed_checkpoint(const std::string& memory) {
    return formatted("%s %d %s %zu %u\n", magic, format_number, program().c_str(), memory.size(), checksum(memory)) +
           memory;
}

std::string unpacked_checkpoint(const std::string& file) {
    const std::size_t end = file.substr(0, 200).find('\n');
    if (end == std::string::npos) throw SimulationError("it is not a checkpoint");
    std::istringstream line(file.substr(0, end));
    const std::string_view memory = std::string_view(file).substr(end + 1);
    std::string found_magic, found_program;
    int found_format = 0;
    std::size_t size = 0;
    std::uint32_t sum = 0;
    if (!(line >> found_magic >> found_format) || found_magic != magic) throw SimulationError("it is not a checkpoint");
    if (found_format != format_number)
        throw SimulationError(formatted("its format is %d, that of this program is %d", found_format, format_number));
    if (!(line >> found_program >> size >> sum)) throw SimulationError("its first line is damaged");
    if (found_program != program())
        throw SimulationError("it was written by knap " + found_program + ", this is " + program() +
                              ", whose results may differ in the last bits");
    if (memory.size() != size)
        throw SimulationError(
            formatted("it should have %zu bytes after its first line, it has %zu", size, memory.size()));
    if (checksum(memory) != sum) throw SimulationError("its checksum is wrong");
    return std::string(memory);
}

// ---- the files of a run

namespace fs = std::filesystem;

namespace {

const char* const newest = "checkpoint";
const char* const previous = "checkpoint.previous";
const char* const of_end = "checkpoint.end";

bool is_there(const fs::path& path) {
    std::error_code none;
    return fs::exists(path, none);
}

}  // namespace

void Checkpoints::write(RunMemory& memory) {
    const std::string bytes = packed_checkpoint(bytes_of(memory));
    if (newest_is_whole_) replace_whole_file(directory_ / newest, directory_ / previous, bytes);
    else write_whole_file(directory_ / newest, bytes, true);
    newest_is_whole_ = true;
    watch_ = Stopwatch();
}

std::string Checkpoints::read(RunMemory& memory) {
    std::string warning;
    for (const char* name : {newest, previous}) {
        const fs::path path = directory_ / name;
        if (!is_there(path)) continue;
        try {
            restore(unpacked_checkpoint(read_whole_file(path)), memory);
            return warning;
        } catch (const SimulationError& error) {
            warning += "warning[checkpoint]: " + path.string() + " is not used: " + error.what() + "\n";
            newest_is_whole_ = false;
        }
    }
    throw UserError("no-checkpoint", "the run in `" + directory_.string() + "` cannot continue from its checkpoints",
                    warning + "start it again with --force");
}

void Checkpoints::remove() const {
    std::error_code ignored;
    for (const char* name : {newest, previous, of_end}) fs::remove(directory_ / name, ignored);
}

void Checkpoints::keep_for_later_end() const {
    std::error_code ignored;
    fs::rename(directory_ / newest, directory_ / of_end, ignored);
    fs::remove(directory_ / previous, ignored);
}

bool Checkpoints::exist_in(const fs::path& directory) {
    return is_there(directory / newest) || is_there(directory / previous);
}

bool Checkpoints::end_exists_in(const fs::path& directory) { return is_there(directory / of_end); }

void Checkpoints::reopen_end(const fs::path& directory) {
    std::error_code error;
    if (!end_exists_in(directory)) return;
    fs::rename(directory / of_end, directory / newest, error);
    if (error) throw OutputError("cannot rename " + (directory / of_end).string() + ": " + error.message());
}

std::string Checkpoints::problem_in(const fs::path& directory, bool also_end) {
    std::string problem = "it has no checkpoint";
    for (const char* name : {newest, previous, of_end}) {
        if (!is_there(directory / name) || (name == of_end && !also_end)) continue;
        try {
            unpacked_checkpoint(read_whole_file(directory / name));
            return "";
        } catch (const SimulationError& error) {
            problem = (directory / name).string() + " is not used: " + error.what();
        }
    }
    return problem;
}

}  // namespace knap
