// Passes every file of the given folders to a reader, as libFuzzer does, with a limit of ten seconds of processor time
// each. (In the release build, more than one second for less than 10 kB counts as a hang; sanitizers are slower.)
#include "target.hpp"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

int main(int argc, char** argv) {
    namespace fs = std::filesystem;
    std::vector<fs::path> files;
    for (int i = 1; i < argc; ++i)
        for (const auto& entry : fs::directory_iterator(argv[i])) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    int n_slow = 0;
    for (const fs::path& file : files) {
        std::ifstream in(file, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        std::printf("%s\n", file.filename().c_str());
        std::fflush(stdout);  // the last one named is the one that failed
        const std::clock_t begin = std::clock();
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
        const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        if (seconds > 10) std::printf("    took %.1f s\n", seconds), ++n_slow;
    }
    std::printf("%zu inputs\n", files.size());
    return files.empty() || n_slow > 0;
}
