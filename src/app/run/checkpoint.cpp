#include "app/run/checkpoint.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"

#include <algorithm>
#include <iterator>

namespace knap {
namespace {

namespace fs = std::filesystem;

const char* const names[] = {"checkpoint", "checkpoint.previous"};
const char* const of_end = "checkpoint.end";

}  // namespace

void Checkpoints::write(RunMemory& memory) {
    const fs::path newest = directory_ / names[0];
    const std::string bytes = packed_checkpoint(bytes_of(memory));
    if (newest_is_whole_) replace_whole_file(newest, directory_ / names[1], bytes);
    else write_whole_file(newest, bytes);
    newest_is_whole_ = true;
    watch_ = Stopwatch();
}

std::string Checkpoints::read(RunMemory& memory) {
    std::string said;
    for (const char* name : names) {
        const fs::path path = directory_ / name;
        if (!fs::exists(path)) continue;
        try {
            restore(unpacked_checkpoint(read_whole_file(path)), memory);
            return said;
        } catch (const SimulationError& error) {
            said += "warning[checkpoint]: " + path.string() + " is not used: " + error.what() + "\n";
            newest_is_whole_ = false;
        }
    }
    throw UserError("no-checkpoint", "the run in `" + directory_.string() + "` cannot go on from its checkpoints", said + "start it again with --force");
}

void Checkpoints::remove() const {
    std::error_code ignored;
    for (const char* name : {names[0], names[1], of_end}) fs::remove(directory_ / name, ignored);
}

void Checkpoints::keep_for_later_end() const {
    std::error_code ignored;
    fs::rename(directory_ / names[0], directory_ / of_end, ignored);
    fs::remove(directory_ / names[1], ignored);
}

bool Checkpoints::end_exists_in(const fs::path& directory) {
    std::error_code none;
    return fs::exists(directory / of_end, none);
}

void Checkpoints::reopen_end(const fs::path& directory) {
    std::error_code error;
    if (!end_exists_in(directory)) return;
    fs::rename(directory / of_end, directory / names[0], error);
    if (error) throw OutputError("cannot rename " + (directory / of_end).string() + ": " + error.message());
}

std::string Checkpoints::problem_in(const fs::path& directory) {
    std::string problem = "it has no checkpoint";
    for (const char* name : {names[0], names[1], of_end}) {
        std::error_code none;
        if (!fs::exists(directory / name, none)) continue;
        try {
            unpacked_checkpoint(read_whole_file(directory / name));
            return "";
        } catch (const SimulationError& error) {
            problem = (directory / name).string() + " is not used: " + error.what();
        }
    }
    return problem;
}

bool Checkpoints::exist_in(const fs::path& directory) {
    std::error_code none;
    return fs::exists(directory / names[0], none) || fs::exists(directory / names[1], none);
}

bool Checkpoints::usable_in(const fs::path& directory) {
    return std::any_of(std::begin(names), std::end(names), [&](const char* name) {
        try {
            unpacked_checkpoint(read_whole_file(directory / name));
            return true;
        } catch (const SimulationError&) {
            return false;
        }
    });
}

}  // namespace knap
