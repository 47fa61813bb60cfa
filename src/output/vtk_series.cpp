#include "output/vtk_series.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "output/frame_vtu.hpp"
#include "output/history_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

namespace knap {

namespace {

using std::filesystem::path;

std::string file_of(const char* part, std::size_t index) {
    std::string number = std::to_string(index);
    if (number.size() < 4) number.insert(0, 4 - number.size(), '0');
    return "fields/" + std::string(part) + "_" + number + ".vtu";
}

std::string entry(double time, int part, const std::string& file) {
    return "    <DataSet timestep=\"" + csv_line(std::vector<double>{time}) + "\" part=\"" + std::to_string(part) + "\" file=\"" + file + "\"/>\n";
}

void write_collection(const path& run, const std::vector<double>& times, bool obstacles) {
    std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
    for (std::size_t i = 0; i < times.size(); ++i) {
        text += entry(times[i], 0, file_of("bulk", i)) + entry(times[i], 1, file_of("interfaces", i));
        if (obstacles) text += entry(times[i], 2, file_of("obstacles", i));
    }
    write_whole_file(run / "run.pvd", text + "  </Collection>\n</VTKFile>\n");
}

}  // namespace

VtkSeries::VtkSeries(path run, std::vector<double> written) : run_(std::move(run)), times_(std::move(written)) {
    prepare_vtk();
    std::error_code error;
    std::filesystem::create_directories(run_ / "fields", error);
    if (error) throw OutputError("cannot make " + (run_ / "fields").string() + ": " + error.message());
    for (const path& file : std::filesystem::directory_iterator(run_ / "fields", error))
        if (file.string().ends_with(".vtu.part")) std::filesystem::remove(file, error);
}

void VtkSeries::write(const Frame& frame) {
    write_bulk(frame, run_ / file_of("bulk", times_.size()));
    write_interfaces(frame, run_ / file_of("interfaces", times_.size()));
    if (frame.n_obstacles() > 0) write_obstacles(frame, run_ / file_of("obstacles", times_.size()));
    times_.push_back(frame.time);
    write_collection(run_, times_, frame.n_obstacles() > 0);
}

bool VtkSeries::has(std::size_t frame) const {
    std::error_code none;
    return std::filesystem::exists(run_ / file_of("bulk", frame), none) && std::filesystem::exists(run_ / file_of("interfaces", frame), none);
}

std::vector<std::string> VtkSeries::missing(bool obstacles) const {
    std::vector<const char*> parts{"bulk", "interfaces"};
    if (obstacles) parts.push_back("obstacles");
    std::vector<std::string> files;
    std::error_code none;
    for (std::size_t i = 0; i < times_.size(); ++i)
        for (const char* part : parts)
            if (!std::filesystem::exists(run_ / file_of(part, i), none)) files.push_back(file_of(part, i));
    return files;
}

std::vector<double> frame_times(const path& run) {
    const path file = run / "run.pvd";
    std::ifstream in(file, std::ios::binary);
    if (!in) throw UserError("missing-file", "cannot read `" + file.string() + "`");
    std::vector<double> times;
    const std::string key = "timestep=\"";
    for (std::string line; std::getline(in, line);) {
        const std::size_t at = line.find(key);
        if (at == std::string::npos || line.find("part=\"0\"") == std::string::npos) continue;
        const char* begin = line.data() + at + key.size();
        double time = 0;
        if (std::from_chars(begin, line.data() + line.size(), time).ec != std::errc()) throw UserError("damaged-file", "`" + file.string() + "`: a time is not a number");
        times.push_back(time);
    }
    return times;
}

Frame read_frame(const path& run, std::size_t index) {
    Frame frame;
    read_bulk(run / file_of("bulk", index), frame);
    read_interfaces(run / file_of("interfaces", index), frame);
    const path obstacles = run / file_of("obstacles", index);
    if (std::filesystem::exists(obstacles)) read_obstacles(obstacles, frame);
    return frame;
}

std::size_t nearest_frame(const std::vector<double>& times, double time) {
    const auto nearer = [&](double a, double b) { return std::abs(a - time) < std::abs(b - time); };
    return static_cast<std::size_t>(std::min_element(times.begin(), times.end(), nearer) - times.begin());
}

}  // namespace knap
