// The outside of a checkpoint file: format, program, length and checksum, so that nothing damaged or foreign is taken for a run's memory.
#include "app/run/checkpoint.hpp"
#include "app/run/version.hpp"
#include "base/error.hpp"

#include <boost/crc.hpp>

#include <charconv>
#include <sstream>

namespace knap {
namespace {

constexpr const char* magic = "knap-checkpoint";
constexpr int layout = 5;

std::string program() { return version() + "-" + git_hash() + (git_dirty() ? "-changed" : ""); }

std::uint32_t checksum(std::string_view bytes) {
    boost::crc_32_type crc;
    crc.process_bytes(bytes.data(), bytes.size());
    return crc.checksum();
}

}  // namespace

std::string packed_checkpoint(const std::string& memory) {
    return std::string(magic) + " " + std::to_string(layout) + " " + program() + " " + std::to_string(memory.size()) + " " + std::to_string(checksum(memory)) + "\n" +
           memory;
}

std::string unpacked_checkpoint(const std::string& file) {
    const std::size_t end = file.substr(0, 200).find('\n');
    if (end == std::string::npos) throw SimulationError("it is not a checkpoint");
    std::istringstream line(file.substr(0, end));
    std::string found_magic, found_program;
    int found_format = 0;
    std::size_t size = 0;
    std::uint32_t sum = 0;
    if (!(line >> found_magic >> found_format) || found_magic != magic) throw SimulationError("it is not a checkpoint");
    if (found_format != layout) throw SimulationError("its format " + std::to_string(found_format) + " is not the one of this program, " + std::to_string(layout));
    if (!(line >> found_program >> size >> sum)) throw SimulationError("its first line is damaged");
    if (found_program != program()) throw SimulationError("it was written by knap " + found_program + ", this is " + program() + ", whose bits may differ");
    if (file.size() - end - 1 != size) throw SimulationError("it should have " + std::to_string(size) + " bytes, it has " + std::to_string(file.size() - end - 1));
    if (checksum(std::string_view(file).substr(end + 1)) != sum) throw SimulationError("its checksum is wrong");
    return file.substr(end + 1);
}

}  // namespace knap
