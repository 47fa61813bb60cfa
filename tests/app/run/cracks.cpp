// Cracks of whole runs: what cracks.csv and arms.csv say, held against the broken interfaces of breaks.csv, which know
// nothing of arms.
#include "analysis/crack_history.hpp"
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <vector>

namespace cracks_test {

using namespace program;
using knap::History;
using knap::tests::relative;

namespace {

/// The broken interfaces of a run, as a graph.
class Broken {
public:
    explicit Broken(const History& breaks) {
        const std::vector<double> x = breaks.column("x"), y = breaks.column("y"), angle = breaks.column("angle"),
                                  length = breaks.column("length");
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double a = angle[i] * std::acos(-1.0) / 180, dx = 0.5 * length[i] * std::cos(a),
                         dy = 0.5 * length[i] * std::sin(a);
            const int p = vertex(x[i] - dx, y[i] - dy), q = vertex(x[i] + dx, y[i] + dy);
            around_[p].emplace_back(q, length[i]), around_[q].emplace_back(p, length[i]);
        }
    }

    /// The vertex within 0.1 um, or a new one.
    int vertex(double x, double y) {
        const long i = std::lround(x * 1e7), j = std::lround(y * 1e7);
        for (long k = i - 1; k <= i + 1; ++k)
            for (long l = j - 1; l <= j + 1; ++l)
                if (const auto found = vertices_.find({k, l}); found != vertices_.end()) return found->second;
        around_.emplace_back();
        return vertices_[{i, j}] = static_cast<int>(around_.size()) - 1;
    }

    /// Distances along broken edges from the nearest of these vertices [m]; infinite where none leads.
    std::vector<double> distances(const std::vector<int>& from) const {
        std::vector<double> distance(around_.size(), HUGE_VAL);
        std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> queue;
        for (const int v : from) queue.emplace(distance[v] = 0, v);
        while (!queue.empty()) {
            const auto [d, v] = queue.top();
            queue.pop();
            if (d > distance[v]) continue;
            for (const auto& [w, length] : around_[v])
                if (d + length < distance[w]) queue.emplace(distance[w] = d + length, w);
        }
        return distance;
    }

private:
    std::map<std::pair<long, long>, int> vertices_;
    std::vector<std::vector<std::pair<int, double>>> around_;
};

double number_in(const std::string& json, const std::string& name) {
    const std::size_t at = json.find("\"" + name + "\": ");
    REQUIRE(at != std::string::npos);
    return std::stod(json.substr(at + name.size() + 4));
}

/// The largest growth of the main length from one line to the next as it is known during a run [m], of a plate of 100 x
/// 40 mm with a pre-crack to its middle.
double largest_live_jump(const fs::path& run) {
    const History breaks = knap::read_csv(run / "breaks.csv");
    const std::vector<double> x = breaks.column("x"), y = breaks.column("y"), angle = breaks.column("angle"),
                              length = breaks.column("length"), time = breaks.column("time");
    Broken numbers(breaks);
    knap::InterfaceGraph graph;
    const auto vertex = [&](double vx, double vy) {
        const auto v = static_cast<std::size_t>(numbers.vertex(vx, vy));
        if (v >= graph.vertices.size()) graph.vertices.resize(v + 1), graph.on_boundary.resize(v + 1);
        graph.vertices[v] = {vx, vy};
        graph.on_boundary[v] = vx < 1e-6 || vx > 100e-3 - 1e-6 || vy < 1e-6 || vy > 40e-3 - 1e-6;
        return static_cast<knap::Index>(v);
    };
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double a = angle[i] * std::acos(-1.0) / 180, dx = 0.5 * length[i] * std::cos(a),
                     dy = 0.5 * length[i] * std::sin(a);
        graph.ends.push_back({vertex(x[i] - dx, y[i] - dy), vertex(x[i] + dx, y[i] + dy)});
        graph.length.push_back(length[i]);
    }
    graph.ends.push_back({vertex(0, 20e-3), vertex(50e-3, 20e-3)});
    graph.length.push_back(50e-3);
    knap::CrackHistory cracks(graph, knap::crack_options(std::hypot(100e-3, 40e-3), 10e-3, 4000, 1));
    double largest = 0, before = 0;
    for (const double now : knap::read_csv(run / "cracks.csv").column("time")) {
        std::vector<knap::InterfaceStatus> status(graph.ends.size(), knap::InterfaceStatus::intact);
        for (std::size_t i = 0; i < time.size(); ++i)
            if (time[i] <= now * (1 + 1e-12)) status[i] = knap::InterfaceStatus::broken;
        status.back() = knap::InterfaceStatus::precrack;
        const double main = cracks.snapshot(now, status).main_length;
        largest = std::max(largest, main - before);
        before = main;
    }
    CHECK(before > 30e-3);
    return largest;
}

/// Lengths never fall, speeds that are known stay so, and all that broke lies within ten edges of an arm, or is shorter
/// than that.
void check_cracks(const fs::path& run) {
    const double pruned = 10 * number_in(text_of(run / "run.json"), "mean_edge_m");
    const History cracks = knap::read_csv(run / "cracks.csv"), arms = knap::read_csv(run / "arms.csv");
    for (const char* column : {"main_length", "crack_length", "broken_length", "branches", "n_broken"}) {
        const std::vector<double> values = cracks.column(column);
        for (std::size_t i = 1; i < values.size(); ++i)
            CHECK_MESSAGE(values[i] >= values[i - 1], column << " at line " << i);
    }
    const std::vector<double> speed = cracks.column("tip_speed");
    for (std::size_t i = 1; i < speed.size(); ++i) CHECK((std::isnan(speed[i - 1]) || std::isfinite(speed[i])));
    CHECK(std::isfinite(speed.back()));

    // each arm grows from its start on, and the last lengths of all are the whole
    const std::vector<double> number = arms.column("arm"), time = arms.column("time"), length = arms.column("length"),
                              x = arms.column("x"), y = arms.column("y");
    double sum = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
        const bool first = i == 0 || number[i] != number[i - 1],
                   last = i + 1 == number.size() || number[i + 1] != number[i];
        if (first) CHECK(length[i] == 0);
        if (!first) CHECK(length[i] > length[i - 1]);
        if (!first) CHECK(time[i] >= time[i - 1]);
        if (last) sum += length[i];
    }
    CHECK(sum == relative(cracks.column("crack_length").back(), 1e-9));

    Broken broken(knap::read_csv(run / "breaks.csv"));
    std::vector<int> on_arms;
    for (std::size_t i = 0; i < x.size(); ++i) on_arms.push_back(broken.vertex(x[i], y[i]));
    const std::vector<double> distance = broken.distances(on_arms);
    for (std::size_t v = 0; v < distance.size(); ++v) {
        if (std::isfinite(distance[v])) {
            CHECK(distance[v] < pruned);  // a twig
            continue;
        }
        const std::vector<double> in_stretch = broken.distances({static_cast<int>(v)});
        for (const double d : in_stretch) CHECK((d < pruned || std::isinf(d)));
    }
}

void run_block(int seed, const std::string& options, const Folder& folder) {
    CAPTURE(seed);
    const std::string name = std::to_string(seed);
    const Answer run =
        command("run edge_cracked_block -q -j 1 -s output.fields=false -s output.breaks=true -s 'expect={}' " +
                undrawn + options + "-s seed=" + name + " -o " + folder.in_shell(name));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    check_cracks(folder.path / name);
}

}  // namespace

TEST_CASE("the starter plate forks as its picture shows") {
    const Folder folder("starter");
    REQUIRE(command("new " + folder.in_shell("plate.toml")).code == 0);
    const Answer run = command("run " + folder.in_shell("plate.toml") +
                               " -q -j 1 -s output.fields=false -s output.breaks=true " + undrawn +
                               "-s 'expect={ "
                               "branches = { at_least = 1, at_most = 1 }, tips = { at_least = 2, at_most = 2 } }' -o " +
                               folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    check_cracks(folder.path / "run");
    // both arms of the fork at 77 mm are long, and the speed is known for five sixths of the growth
    const History arms = knap::read_csv(folder.path / "run/arms.csv");
    const std::vector<double> number = arms.column("arm"), x = arms.column("x"), length = arms.column("length");
    CHECK(x.back() > 85e-3);
    CHECK(length.back() > 10e-3);
    CHECK(number.back() == 1);
    const std::vector<double> speed = knap::read_csv(folder.path / "run/cracks.csv").column("tip_speed");
    CHECK(std::count_if(speed.begin(), speed.end(), [](double v) { return v > 0; }) > 245);
    const std::string json = text_of(folder.path / "run/run.json");
    CHECK(number_in(json, "mean_tip_speed") <= number_in(json, "max_tip_speed"));
    CHECK(number_in(json, "max_tip_speed") < 0.65 * number_in(json, "rayleigh_speed_m_per_s"));
    // the main tip never goes back, nor does it or its length jump
    const History cracks = knap::read_csv(folder.path / "run/cracks.csv");
    const std::vector<double> tip_x = cracks.column("tip_x"), tip_y = cracks.column("tip_y");
    for (std::size_t i = 1; i < tip_x.size(); ++i)
        CHECK_FALSE(std::hypot(tip_x[i] - tip_x[i - 1], tip_y[i] - tip_y[i - 1]) > 6e-3);
    CHECK(
        largest_live_jump(folder.path / "run") <
        10e-3);  // an isolated stretch of less than ten edges that joins; breaks.csv knows no damaged edges that bridge a
                 // gap sooner
}

TEST_CASE("coarse blocks: no length falls and no arm of ten edges is lost") {
    const Folder folder("coarse_blocks");
    for (int seed = 1; seed <= 4; ++seed) run_block(seed, "-s 'mesh.size=2 mm' ", folder);
    run_block(5, "-s 'mesh.size=1 mm' ", folder);
}

TEST_CASE("twenty blocks: no length falls and no arm of ten edges is lost" * doctest::test_suite("slow")) {
    const Folder folder("twenty_blocks");
    for (int seed = 1; seed <= 20; ++seed) run_block(seed, "", folder);
}

TEST_CASE("the summary says where a crack left the triangles that resolve it") {
    const Folder folder("unresolved");
    const auto expects = [&](const std::string& strength, const std::string& expected) {
        const Answer run = command(
            "run edge_cracked_block -q --force -s output.fields=false " + undrawn +
            "-s 'mesh.size=4 mm' -s "
            "'mesh.refine=[{ along = [[\"50 mm\", \"20 mm\"], [\"66 mm\", \"20 mm\"]], width = \"12 mm\", size = \"1 "
            "mm\" }]' "
            "-s 'load[0].traction=[\"0 MPa\", \"2 MPa\"]' -s 'load[1].traction=[\"0 MPa\", \"-2 MPa\"]' -s "
            "interface.default.sigma_c='" +
            strength + "' -s 'expect={ main_length = { above = \"25 mm\" }, " + expected + " }' -o " +
            folder.in_shell("run"));
        CHECK_MESSAGE(run.code == 0, run.text);
    };
    // 1.5 process zones are 1.64 mm, longer than the edges in the strip, which ends at x = 72 mm
    expects("9 MPa",
            "unresolved_part = { above = 0.3, below = 0.8 }, unresolved_x = { above = \"72 mm\", below = \"76 mm\" }");
    expects("3.08 MPa", "unresolved_part = { at_most = 0 }");  // 14 mm, longer than all edges
}

}  // namespace cracks_test
