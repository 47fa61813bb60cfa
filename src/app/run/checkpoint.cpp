#include "app/run/checkpoint.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "record/checkpoint_file.hpp"

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
template <class Archive>
void serialize(Archive& archive, knap::Vec3& v) {
    archive(v.x(), v.y(), v.z());
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

namespace {

/// With which another run starts; its recorder then has energies and cracks alone.
void serialize_start(auto& archive, RunMemory& memory) {
    archive(memory.origin, memory.now, memory.control, memory.excavations, memory.adaptation);
}

}  // namespace

template <class Archive>
void serialize(Archive& archive, RunMemory& memory) {
    serialize_start(archive, memory);
    memory.recorder.serialize_energies_and_cracks(archive);
    archive(memory.recorder, memory.triangle_steps, memory.log_size, memory.spent);
}

namespace {

/// The bytes of a memory behind some others.
std::string bytes_behind(std::size_t n, RunMemory& memory) {
    std::ostringstream stream;
    stream << std::string(n, ' ');
    cereal::BinaryOutputArchive archive(stream);
    archive(memory);
    return std::move(stream).str();
}

}  // namespace

std::string bytes_of(RunMemory& memory) { return bytes_behind(0, memory); }

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

std::string packed(RunMemory& memory) {
    return packed_checkpoint(bytes_behind(room_for_head, memory),
                             {.time = memory.now.time, .last_step = memory.now.last_step});
}

// ---- the start of another run

struct MemoryReader::Impl {
    explicit Impl(const std::string& bytes) : stream(bytes), archive(stream) {}
    std::istringstream stream;
    cereal::BinaryInputArchive archive;
};

MemoryReader::MemoryReader(const std::string& bytes) : impl_(std::make_unique<Impl>(bytes)) { impl_->archive(origin_); }
MemoryReader::~MemoryReader() = default;

void MemoryReader::read_motion(State& now, StepControl& control, Excavations& excavations, Adaptation& adaptation) {
    impl_->archive(now, control, excavations, adaptation);
}

void MemoryReader::read_energies_and_cracks(Recorder& recorder) {
    recorder.serialize_energies_and_cracks(impl_->archive);
}

// ---- the files of a run

namespace fs = std::filesystem;

namespace {

bool is_there(const fs::path& path) {
    std::error_code none;
    return fs::exists(path, none);
}

}  // namespace

void Checkpoints::write(RunMemory memory) {
    const std::string bytes = packed(memory);
    if (newest_is_whole_) replace_whole_file(directory_ / newest_checkpoint, directory_ / previous_checkpoint, bytes);
    else write_whole_file(directory_ / newest_checkpoint, bytes, true);
    newest_is_whole_ = true;
    watch_ = Stopwatch();
}

std::string Checkpoints::read(RunMemory& memory) {
    std::string warning;
    for (const char* name : {newest_checkpoint, previous_checkpoint}) {
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
    for (const char* name : {newest_checkpoint, previous_checkpoint, checkpoint_of_end})
        fs::remove(directory_ / name, ignored);
}

void Checkpoints::keep_for_later_end() const {
    std::error_code ignored;
    fs::rename(directory_ / newest_checkpoint, directory_ / checkpoint_of_end, ignored);
    fs::remove(directory_ / previous_checkpoint, ignored);
}

bool Checkpoints::exist_in(const fs::path& directory) {
    return is_there(directory / newest_checkpoint) || is_there(directory / previous_checkpoint);
}

bool Checkpoints::end_exists_in(const fs::path& directory) { return is_there(directory / checkpoint_of_end); }

void Checkpoints::reopen_end(const fs::path& directory) {
    std::error_code error;
    if (!end_exists_in(directory)) return;
    fs::rename(directory / checkpoint_of_end, directory / newest_checkpoint, error);
    if (error) throw OutputError("cannot rename " + (directory / checkpoint_of_end).string() + ": " + error.message());
}

std::string Checkpoints::problem_in(const fs::path& directory, bool also_end) {
    std::string problem = "it has no checkpoint";
    for (const char* name : {newest_checkpoint, previous_checkpoint, checkpoint_of_end}) {
        if (!is_there(directory / name) || (name == checkpoint_of_end && !also_end)) continue;
        try {
            unpacked_checkpoint(read_whole_file(directory / name));
            return "";
        } catch (const SimulationError& error) {
            problem = (directory / name).string() + " is not used: " + error.what();
        }
    }
    return problem;
}

// ---- states

bool KeptStates::is_due(const State& now) const {
    return n_ < times_.size() && StepControl::has_reached(now, times_[n_]);
}

void KeptStates::skip_to(const State& now) {
    for (; is_due(now); ++n_) faults_.push_back(fault_of_whole_state(directory_ / state_file(times_[n_])));
}

void KeptStates::write(RunMemory memory) {
    std::error_code error;
    if (fs::create_directories(directory_ / "states", error); error)
        throw OutputError("cannot make " + (directory_ / "states").string() + ": " + error.message());
    const std::string bytes = packed(memory);
    for (; is_due(memory.now); ++n_) write_whole_file(directory_ / state_file(times_[n_]), bytes, true);
}

std::vector<std::string> KeptStates::missing() const {
    std::vector<std::string> files;
    for (std::size_t i = 0; i < n_; ++i) {
        const std::string fault = i < faults_.size() ? faults_[i] : fault_of_state(directory_ / state_file(times_[i]));
        if (!fault.empty()) files.push_back(state_file(times_[i]).string() + " " + fault);
    }
    return files;
}

}  // namespace knap
