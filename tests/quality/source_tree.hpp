#pragma once
// The files of the repository as text.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace source_tree {

namespace fs = std::filesystem;

struct File {
    std::string path;  // from the root of the repository, with '/'
    std::vector<std::string> lines;

    bool has_extension(std::string_view e) const { return fs::path(path).extension() == e; }
    bool is_cpp() const { return has_extension(".hpp") || has_extension(".cpp"); }
};

inline fs::path root() { return KNAP_SOURCE_DIR; }

inline File read(const fs::path& path) {
    File file{fs::relative(path, root()).generic_string(), {}};
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) file.lines.push_back(line);
    return file;
}

/// Text files below a folder of the repository, sorted; pictures and the like are left out.
inline std::vector<File> files_below(const std::string& folder) {
    static const std::set<std::string> binary{".png", ".svg", ".pdf", ".vtu", ".gif", ".webp"};
    std::vector<File> files;
    if (!fs::exists(root() / folder)) return files;
    for (const auto& entry : fs::recursive_directory_iterator(root() / folder)) {
        if (entry.is_regular_file() && !binary.contains(entry.path().extension().string()))
            files.push_back(read(entry.path()));
    }
    std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.path < b.path; });
    return files;
}

/// All text files that belong to the project.
inline std::vector<File> all_files() {
    std::vector<File> files;
    for (const char* folder : {"src", "tests", "tools", "scenarios", "third_party_notes", ".ci"}) {
        for (File& file : files_below(folder)) files.push_back(std::move(file));
    }
    for (const auto& entry : fs::directory_iterator(root())) {
        if (entry.is_regular_file() && entry.path().extension() != ".png") files.push_back(read(entry.path()));
    }
    return files;
}

}  // namespace source_tree
