#include "app/run_directory.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"

#include <algorithm>

namespace knap {

namespace fs = std::filesystem;

namespace {

UserError cannot_write(const std::string& what, const fs::path& path, const std::error_code& error) {
    return UserError("cannot-write", "cannot " + what + " `" + path.string() + "`: " + error.message());
}

}  // namespace

void make_run_directory(const fs::path& directory, bool replace, const FirstFiles& files) {
    std::error_code error;
    const bool there = fs::exists(directory, error) && !(fs::is_directory(directory, error) && fs::is_empty(directory, error));
    if (there && !replace)
        throw UserError("run-exists", "`" + directory.string() + "` exists already, nothing was run",
                        "choose another directory with --output, or replace the old run with --force");
    if (there && !fs::exists(directory / "run.json", error))
        throw UserError("not-a-run", "`" + directory.string() + "` was not made by knap (no run.json), so --force does not clear it");

    const fs::path whole = directory.has_filename() ? directory : directory.parent_path();  // "out/" is "out"
    const fs::path partial = whole.string() + ".part";
    fs::remove_all(partial, error);
    for (const fs::path& part : {partial, partial / "fields", partial / "figures"})
        if (fs::create_directories(part, error); error) throw cannot_write("make", part, error);
    for (const auto& [name, text] : files) write_whole_file(partial / name, text);
    if (fs::remove_all(whole, error); error) throw cannot_write("clear", whole, error);
    if (fs::rename(partial, whole, error); error) throw cannot_write("make", whole, error);
}

bool began_with(const fs::path& directory, const FirstFiles& files) {
    return std::all_of(files.begin(), files.end(), [&](const auto& file) {
        const auto& [name, text] = file;
        return name == "run.json" || (fs::is_regular_file(directory / name) && read_whole_file(directory / name) == text);
    });
}

}  // namespace knap
