// Frames and histories through their files and back; and what happens when a file cannot be written.
#include "support/synthetic_run.hpp"

#include "base/error.hpp"
#include "output/history_csv.hpp"
#include "output/vtk_series.hpp"

#include <doctest/doctest.h>

#include <sys/resource.h>

#include <clocale>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <regex>
#include <sstream>

namespace frame_files_test {

using namespace knap;
namespace fs = std::filesystem;

namespace {

/// An empty directory in the build tree.
fs::path fresh(const std::string& name) {
    const fs::path directory = fs::path(KNAP_BINARY_DIR) / "test_frames" / name;
    fs::remove_all(directory);
    fs::create_directories(directory);
    return directory;
}

std::string contents(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

double distance(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    REQUIRE(a.size() == b.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
    return largest;
}

constexpr double single = 6e-8;  // rounding of float32

}  // namespace

TEST_CASE("frame files: the bulk comes back") {
    const Frame written = synthetic::frame(20);
    const fs::path run = fresh("bulk");
    VtkSeries(run).write(written);
    const Frame read = read_frame(run, 0);
    CHECK(read.time == written.time);
    CHECK(read.length_scale == written.length_scale);
    CHECK(read.region == written.region);
    CHECK(distance(read.position, written.position) == 0);
    CHECK(distance(read.displacement, written.displacement) <= single * 2e-5);
    CHECK(distance(read.velocity, written.velocity) <= single);
    REQUIRE(read.stress.size() == written.stress.size());
    for (std::size_t t = 0; t < read.stress.size(); ++t)
        CHECK((read.stress[t] - written.stress[t]).norm() <= 2 * single * written.stress[t].norm());
    REQUIRE(read.stress_zz.size() == written.stress_zz.size());
    for (std::size_t t = 0; t < read.stress_zz.size(); ++t)
        CHECK(std::abs(read.stress_zz[t] - written.stress_zz[t]) <= single * std::abs(written.stress_zz[t]));
}

TEST_CASE("frame files: corners of one node are one point and come back each by itself") {
    Frame written = synthetic::frame(20);
    const auto n_corners = static_cast<Index>(written.position.size());
    std::map<std::pair<double, double>, Index> number;
    for (Index c = 0; c < n_corners; ++c) {
        const Vec2 x = written.position[c];
        const Index node = number.try_emplace({x.x(), x.y()}, static_cast<Index>(number.size())).first->second;
        written.node.push_back(node);
        written.displacement[c] = 1e-5 * x, written.velocity[c] = turned_left(x);
    }
    const fs::path run = fresh("nodes");
    VtkSeries(run).write(written);
    const Frame read = read_frame(run, 0);
    CHECK(distance(read.position, written.position) == 0);
    CHECK(distance(read.displacement, written.displacement) <= single * 1e-5);
    CHECK(distance(read.velocity, written.velocity) <= single);
    CHECK(read.region == written.region);
    const std::string points = std::to_string(number.size());
    CHECK(std::regex_search(contents(run / "fields/bulk_0000.vtu"), std::regex("NumberOfPoints=\"" + points + "\"")));
    CHECK(static_cast<Index>(number.size()) < n_corners / 2);
    CHECK(read.node == written.node);
    REQUIRE(read.n_interfaces() > 0);
    for (Index i = 0; i < read.n_interfaces(); ++i)
        for (Index end = 0; end < 2; ++end)
            for (const Index corner : {read.side_a[i][end], read.side_b[i][end]})
                CHECK(read.position[corner] == read.end_position[2 * i + end]);
}

TEST_CASE("frame files: each compression gives back the same frame") {
    const Frame written = synthetic::frame(20);
    std::vector<std::uintmax_t> sizes;
    for (const Compression compression : {Compression::none, Compression::lz4, Compression::zlib}) {
        const fs::path run = fresh("compression");
        VtkSeries(run, {}, {}, compression).write(written);
        const Frame read = read_frame(run, 0);
        CHECK(distance(read.position, written.position) == 0);
        CHECK(read.region == written.region);
        sizes.push_back(fs::file_size(run / "fields/bulk_0000.vtu"));
    }
    CHECK(sizes[0] > 1.3 * sizes[1]);
    CHECK(sizes[1] > 1.1 * sizes[2]);
}

TEST_CASE("frame files: those of versions that stored three stresses are read") {
    const fs::path old = KNAP_SOURCE_DIR "/tests/output/data/three_stresses";  // bar_pulled_apart in triangles of 4 mm
    REQUIRE(frame_times(old).size() == 2);
    const Frame frame = read_frame(old, 1);
    CHECK(frame.time == frame_times(old)[1]);
    CHECK(frame.n_triangles() == static_cast<Index>(frame.stress.size()));
    CHECK(frame.n_triangles() == 8);
    CHECK(frame.stress_zz.empty());
    double largest = 0;
    for (const Eigen::Vector3d& s : frame.stress) largest = std::max(largest, std::abs(s[0]));
    CHECK(largest > 1e3);  // [Pa]
    CHECK(largest < 3.08e6);
}

TEST_CASE("frame files: the interfaces that are not intact come back") {
    const Frame written = synthetic::frame(40);
    const fs::path run = fresh("interfaces");
    VtkSeries(run).write(written);
    const Frame read = read_frame(run, 0);
    Index j = 0;
    std::array<int, 4> n_of_status{};
    for (Index i = 0; i < written.n_interfaces(); ++i) {
        if (written.status[2 * i] == InterfaceStatus::intact && written.status[2 * i + 1] == InterfaceStatus::intact)
            continue;
        REQUIRE(j < read.n_interfaces());
        CHECK(read.side_a[j] == written.side_a[i]);
        CHECK(read.side_b[j] == written.side_b[i]);
        for (int end = 0; end < 2; ++end) {
            const Index p = 2 * i + end, q = 2 * j + end;
            CHECK(read.end_position[q] == written.end_position[p]);
            CHECK(std::abs(read.cohesion[q] - written.cohesion[p]) <= single * std::abs(written.cohesion[p]));
            CHECK(std::abs(read.opening[q] - written.opening[p]) <= single * std::abs(written.opening[p]));
            CHECK(std::abs(read.slip[q] - written.slip[p]) <= single * std::abs(written.slip[p]));
            CHECK((read.traction[q] - written.traction[p]).norm() <= single * written.traction[p].norm());
            CHECK(read.status[q] == written.status[p]);
            ++n_of_status[static_cast<std::size_t>(written.status[p])];
        }
        ++j;
    }
    CHECK(j == read.n_interfaces());
    for (const int n : n_of_status) CHECK(n > 0);
}

TEST_CASE("frame files: a support is kept and an uncracked body has no interfaces") {
    Frame frame = synthetic::frame(5);
    for (InterfaceStatus& status : frame.status) status = InterfaceStatus::intact;
    const fs::path run = fresh("intact");
    VtkSeries series(run);
    series.write(frame);
    CHECK(read_frame(run, 0).n_interfaces() == 0);
    const std::string text = contents(run / "fields/interfaces_0000.vtu");
    CHECK(std::regex_search(text, std::regex("NumberOfPoints=\"0\" +NumberOfCells=\"1\"")));  // meshio needs a cell
    frame.side_a[3] = {-1, -1};
    series.write(frame);
    const Frame read = read_frame(run, 1);
    REQUIRE(read.n_interfaces() == 1);
    CHECK(read.side_a[0] == std::array<Index, 2>{-1, -1});
    CHECK(read.side_b[0] == frame.side_b[3]);
}

TEST_CASE("frame files: run.pvd is whole after every frame and goes on after a resume") {
    const fs::path run = fresh("series");
    Frame frame = synthetic::frame(5);
    const std::vector<double> times{0, 1e-6 / 3, 2.5e-6};
    const std::regex entry(R"re(<DataSet timestep="[-+.e0-9]+" part="[01]" file="(fields/\w+\.vtu)"/>)re");
    VtkSeries series(run);
    for (std::size_t n = 0; n < times.size(); ++n) {
        frame.time = times[n];
        series.write(frame);
        CHECK(frame_times(run) ==
              std::vector<double>(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(n) + 1));
        const std::string text = contents(run / "run.pvd");
        CHECK(text.ends_with("</VTKFile>\n"));
        int n_files = 0;
        for (std::sregex_iterator it(text.begin(), text.end(), entry), end; it != end; ++it, ++n_files)
            CHECK(fs::exists(run / (*it)[1].str()));
        CHECK(n_files == 2 * static_cast<int>(n + 1));
        CHECK_FALSE(fs::exists(run / "run.pvd.part"));
    }
    VtkSeries resumed(run, {times[0], times[1]});
    CHECK(resumed.missing(false).empty());
    fs::remove(run / "fields/interfaces_0001.vtu");
    fs::remove(run / "run.pvd");
    frame.time = 5e-6;
    resumed.write(frame);
    CHECK(resumed.missing(false) == std::vector<std::string>{"fields/interfaces_0001.vtu does not exist"});
    CHECK(resumed.missing(true).size() == 1 + resumed.times().size());
    CHECK(frame_times(run) == std::vector<double>{times[0], times[1], 5e-6});
    CHECK(nearest_frame(frame_times(run), 4e-6) == 2);
    CHECK(nearest_frame(frame_times(run), 2e-6) == 1);
}

TEST_CASE("frame files: a file that cannot be written or read is named") {
    const fs::path run = fresh("failing");
    Frame frame = synthetic::frame(5);
    const auto message = [](auto action) -> std::string {
        try {
            action();
        } catch (const std::exception& error) {
            return error.what();
        }
        return "nothing was thrown";
    };
    std::ofstream(run / "plain") << "no directory";
    CHECK(message([&] { VtkSeries(run / "plain"); }).find((run / "plain").string()) != std::string::npos);
    VtkSeries series(run);
    fs::create_directory(run / "fields/bulk_0000.vtu");
    CHECK(message([&] { series.write(frame); }).find("bulk_0000.vtu") != std::string::npos);
    fs::remove(run / "fields/bulk_0000.vtu");
    CHECK(series.times().empty());
    if (fs::exists("/dev/full")) {
        fs::create_symlink("/dev/full", run / "fields/bulk_0000.vtu");
        CHECK(message([&] { series.write(frame); }).find("bulk_0000.vtu") != std::string::npos);
        fs::remove(run / "fields/bulk_0000.vtu");
        CHECK(message([&] { write_csv(synthetic::energy(), {"time"}, "/dev/full"); }).find("/dev/full") !=
              std::string::npos);
    }
    series.write(frame);
    std::ofstream(run / "fields/bulk_0000.vtu") << "<VTKFile>cut short";
    CHECK(message([&] { read_frame(run, 0); }).find("bulk_0000.vtu") != std::string::npos);
    CHECK(message([&] { read_frame(run, 7); }).find("bulk_0007.vtu") != std::string::npos);
    CHECK(message([&] { frame_times(run / "none"); }).find("run.pvd") != std::string::npos);
}

TEST_CASE("frame files: what is empty or cut off is named and never read") {
    const fs::path run = fresh("damaged");
    Frame frame = synthetic::frame(8);
    VtkSeries series(run);
    series.write(frame);
    series.write(frame);
    series.flush();
    const fs::path bulk = run / "fields/bulk_0001.vtu";
    const std::string whole = contents(bulk);
    const auto message = [&]() -> std::string {
        try {
            read_frame(run, 1);
        } catch (const UserError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(message().empty());
    for (const double part : {0.0, 0.001, 0.3, 0.999}) {
        CAPTURE(part);
        std::ofstream(bulk, std::ios::binary)
            << whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size())));
        CHECK(series.has(0));
        CHECK_FALSE(series.has(1));
        REQUIRE(series.missing(false).size() == 1);
        CHECK(series.missing(false)[0].starts_with("fields/bulk_0001.vtu is "));
        CHECK(message().find(part > 0 ? "bulk_0001.vtu` is cut off after" : "bulk_0001.vtu` is empty") !=
              std::string::npos);
        CHECK(message().find("--force") != std::string::npos);
    }
    std::string zeroed = whole;  // as some file systems leave it after a loss of power
    std::fill(zeroed.begin() + static_cast<std::ptrdiff_t>(whole.size() / 2), zeroed.end(), '\0');
    std::ofstream(bulk, std::ios::binary) << zeroed;
    CHECK(message().find("is cut off") != std::string::npos);
    std::ofstream(run / "run.pvd", std::ios::binary) << contents(run / "run.pvd").substr(0, 200);
    CHECK_THROWS_AS(frame_times(run), UserError);
    series.list(false);
    CHECK(frame_times(run).size() == 2);
}

TEST_CASE("frame files: no half file has the name of a frame and an older one stays where there is no room") {
    const fs::path run = fresh("no room"), bulk = run / "fields/bulk_0000.vtu";
    VtkSeries series(run);
    const Frame frame = synthetic::frame(20);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const auto write_in = [&](rlim_t bytes) {
        const rlimit little{.rlim_cur = bytes, .rlim_max = before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &little);
        std::string message = "nothing";
        try {
            series.write(frame);
        } catch (const OutputError& error) {
            message = error.what();
        }
        setrlimit(RLIMIT_FSIZE, &before);
        return message;
    };
    CHECK(write_in(1000).find(bulk.string()) != std::string::npos);
    CHECK(fs::is_empty(run / "fields"));
    std::ofstream(bulk) << "an older frame";
    CHECK(write_in(1000).find(bulk.string()) != std::string::npos);
    CHECK(contents(bulk) == "an older frame");
    CHECK(series.times().empty());
    CHECK(write_in(before.rlim_cur) == "nothing");
    CHECK(fs::file_size(bulk) > 1000);
    std::signal(SIGXFSZ, handler);
}

TEST_CASE("frame files: incomplete files of a killed run are removed when the run continues") {
    const fs::path run = fresh("killed");
    const Frame frame = synthetic::frame(5);
    VtkSeries(run).write(frame);
    for (const char* name : {"fields/bulk_0001.vtu.part", "fields/of_someone.part"})
        std::ofstream(run / name) << "half a";
    VtkSeries resumed(run, {frame.time});
    CHECK_FALSE(fs::exists(run / "fields/bulk_0001.vtu.part"));
    CHECK(fs::exists(run / "fields/of_someone.part"));
    CHECK(resumed.missing(false).empty());
}

TEST_CASE("history files: the same bits come back whatever the locale") {
    const History written{{"time", "value"},
                          {{0, -0.1}, {1e-6 / 3, 1e300}, {5e-324, std::numeric_limits<double>::infinity()}}};
    const fs::path file = fresh("history") / "energy.csv";
    const std::string before = std::setlocale(LC_ALL, nullptr);
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    write_csv(written, {"time [s]", "value"}, file);
    const History read = read_csv(file);
    std::setlocale(LC_ALL, before.c_str());
    CHECK(read.columns == written.columns);
    CHECK(read.rows == written.rows);
    CHECK(contents(file).starts_with("time [s],value\n0,-0.1\n"));
    CHECK(read.column("value")[1] == 1e300);
    CHECK_THROWS_WITH_AS(read.column("speed"), doctest::Contains("energy.csv"), UserError);
}

TEST_CASE("history files: names carry units and NaN is an empty field and there is no minus zero") {
    const History written{{"time", "tip_x", "tips", "tip_speed", "branches"},
                          {{-0.0, std::nan(""), 2, -std::nan(""), -0.0}}};
    const fs::path file = fresh("history_none") / "cracks.csv";
    write_csv(written, {"time [s]", "tip_x [m]", "tips", "tip_speed [m/s]", "branches"}, file);
    CHECK(contents(file) == "time [s],tip_x [m],tips,tip_speed [m/s],branches\n0,,2,,0\n");
    const History read = read_csv(file);
    CHECK(read.columns == written.columns);
    CHECK(std::isnan(read.column("tip_x")[0]));
    CHECK(std::isnan(read.column("tip_speed")[0]));
    CHECK(read.column("tips")[0] == 2);
    std::ofstream(file) << "time,tips\n1e-6,2\n";  // as runs before had them
    CHECK(read_csv(file).column("tips")[0] == 2);
}

TEST_CASE("history files: a broken line is named") {
    const fs::path file = fresh("history_broken") / "cracks.csv";
    for (const char* line : {"1,2,3", "1", "1,two", "1,", "1,2 3"}) {
        std::ofstream(file) << "time,length\r\n0,0\r\n" << line << "\n";
        try {
            read_csv(file);
            FAIL("read without complaint: ", line);
        } catch (const UserError& error) {
            CHECK(std::string(error.what()).find("cracks.csv:3") != std::string::npos);
        }
    }
}

}  // namespace frame_files_test
