#include "app/run_directory.hpp"

#include "base/error.hpp"

#include <fstream>

namespace knap {

namespace fs = std::filesystem;

void make_run_directory(const fs::path& directory, bool force) {
    std::error_code error;
    if (fs::exists(directory, error)) {
        const bool empty = fs::is_directory(directory, error) && fs::is_empty(directory, error);
        if (!empty && !force)
            throw UserError("run-exists", "`" + directory.string() + "` exists already, nothing was run",
                            "choose another directory with --output, or replace the old run with --force");
        if (!empty && !fs::exists(directory / "run.json", error))
            throw UserError("not-a-run", "`" + directory.string() + "` was not made by knap (no run.json), so --force does not clear it");
        if (!empty) fs::remove_all(directory, error);
        if (error) throw UserError("cannot-write", "cannot clear `" + directory.string() + "`: " + error.message());
    }
    for (const fs::path& part : {directory, directory / "fields", directory / "figures"}) {
        fs::create_directories(part, error);
        if (error) throw UserError("cannot-write", "cannot make `" + part.string() + "`: " + error.message());
    }
}

void write_whole_file(const fs::path& path, const std::string& text) {
    const fs::path temporary = path.string() + ".part";
    std::ofstream file(temporary, std::ios::binary);
    file << text;
    file.close();
    std::error_code error;
    if (file) fs::rename(temporary, path, error);
    if (!file || error) throw SimulationError("cannot write " + path.string() + (error ? ": " + error.message() : ""));
}

}  // namespace knap
