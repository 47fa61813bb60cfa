#include "app/new_file.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"

namespace knap {

void refuse_existing(const std::filesystem::path& file, const std::string& help) {
    std::error_code none;
    if (std::filesystem::is_character_file(file, none)) return;  // /dev/stdout
    if (std::filesystem::exists(file, none)) throw UserError("file-exists", "`" + file.string() + "` exists already", help);
}

void write_new_file(const std::filesystem::path& file, const std::string& text) {
    try {
        write_whole_file(file, text);
    } catch (const OutputError& error) {
        throw UserError("cannot-write", error.what(), "choose another place");
    }
}

}  // namespace knap
