// Frames are written in another thread: all of them, in order, from the state as it was, and no failure is lost.
#include "output/frame_writer.hpp"

#include "support/synthetic_run.hpp"

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/whole_file.hpp"
#include "figures/curve_figures.hpp"
#include "figures/figures.hpp"
#include "output/vtk_series.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace frame_writer_test {

using namespace knap;
namespace fs = std::filesystem;

namespace {

State at(double time) {
    State state;
    state.time = time;
    state.displacement.assign(3, Vec2(time, -time));
    return state;
}

std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const OutputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

}  // namespace

TEST_CASE("frame writer: every state is written once and in order and as it was when it was added") {
    std::vector<double> written;
    FrameWriter writer([&](const State& now) {
        CHECK(now.displacement == at(now.time).displacement);
        written.push_back(now.time);
    });
    State now = at(0);
    for (int i = 0; i < 200; ++i) {
        writer.add(now);
        now = at(i + 1);  // goes on at once
        if (i % 50 != 7) continue;
        writer.finish();
        CHECK(written.size() == static_cast<std::size_t>(i) + 1);
    }
    writer.finish();
    REQUIRE(written.size() == 200);
    for (int i = 0; i < 200; ++i) CHECK(written[i] == i);
}

TEST_CASE("frame writer: a third state waits until the first is written") {
    std::atomic<int> n_added = 0, n_written = 0, n_waiting = 0;
    std::atomic<bool> may_write = false;
    FrameWriter writer([&](const State&) {
        while (!may_write) std::this_thread::yield();
        ++n_written;
    });
    std::jthread steps([&] {
        for (int i = 0; i < 6; ++i) {
            writer.add(at(i));
            ++n_added;
            n_waiting = std::max<int>(n_waiting, n_added - n_written);
        }
    });
    while (n_added < 2) std::this_thread::yield();  // goes on while the first is being written
    CHECK(n_written == 0);
    for (int i = 0; i < 10000; ++i) std::this_thread::yield();
    may_write = true;
    steps.join();
    CHECK(n_waiting <= 2);
    writer.finish();
    CHECK(n_written == 6);
}

TEST_CASE("frame writer: after a failure every call reports it and nothing more is written") {
    std::vector<double> written;
    const auto fail_at_1 = [&](const State& now) {
        if (now.time == 1) throw OutputError("cannot write the second");
        written.push_back(now.time);
    };
    SUBCASE("at the end of all") {
        FrameWriter writer(fail_at_1);
        writer.add(at(0));
        writer.add(at(1));
        CHECK(message_of([&] { writer.finish(); }) == "cannot write the second");
        CHECK(message_of([&] { writer.check(); }) == "cannot write the second");
        CHECK(message_of([&] { writer.add(at(2)); }) == "cannot write the second");
        CHECK(message_of([&] { writer.finish(); }) == "cannot write the second");
    }
    SUBCASE("by a step between two frames") {
        FrameWriter writer(fail_at_1);
        writer.add(at(0));
        writer.add(at(1));
        CHECK(message_of([&] {
                  for (;;) writer.check(), std::this_thread::yield();
              }) == "cannot write the second");
    }
    SUBCASE("by one of the next frames") {
        FrameWriter writer(fail_at_1);
        int n = 0;
        CHECK(message_of([&] {
                  for (;; ++n) writer.add(at(n));
              }) == "cannot write the second");
        CHECK(n <= 3);
    }
    SUBCASE("and lost with the writer only where another failure ends the run") {
        const auto run = [&] {
            FrameWriter writer(fail_at_1);
            for (int i = 0; i < 2; ++i) writer.add(at(i));
            throw OutputError("cannot write energy.csv");
        };
        CHECK(message_of(run) == "cannot write energy.csv");
    }
    CHECK(written == std::vector<double>{0});
}

TEST_CASE("frame writer: the destructor waits until all is written") {
    int n_written = 0;
    const auto run = [&](int n) {
        FrameWriter writer([&](const State&) { ++n_written; });
        for (int i = 0; i < n; ++i) writer.add(at(i));
        if (n == 3) throw OutputError("the steps failed");
    };
    run(0);
    CHECK(n_written == 0);
    run(2);
    CHECK(n_written == 2);
    CHECK_THROWS_AS(run(3), OutputError);
    CHECK(n_written == 5);
}

TEST_CASE("frame writer: frames written while figures are drawn equal frames written alone") {
    const fs::path root = fs::path(KNAP_BINARY_DIR) / "test_frame_writer";
    fs::remove_all(root);
    const Frame frame = synthetic::frame(30);
    VtkSeries alone(root / "alone"), beside(root / "beside");
    for (int i = 0; i < 5; ++i) alone.write(frame);
    FrameWriter writer([&](const State&) { beside.write(frame); });
    for (int i = 0; i < 5; ++i) {
        writer.add(at(i));
        draw_chart(energy_chart(synthetic::energy()), root / "energy.png", 800);
        draw_figure({.file = "cracks.png"}, frame, {}, {.title = "cracks"}, root);
    }
    writer.finish();
    int n_files = 0;
    for (const auto& file : fs::recursive_directory_iterator(root / "alone")) {
        if (!file.is_regular_file()) continue;
        CHECK(read_whole_file(file) == read_whole_file(root / "beside" / fs::relative(file, root / "alone")));
        ++n_files;
    }
    CHECK(n_files == 11);
}

TEST_CASE("frame writer: its processor time is its own") {
    const double long_enough = 0.02;  // [s]
    const auto work = [&] {
        const double begin = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID);
        while (Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID) - begin < long_enough) continue;
    };
    FrameWriter writer([&](const State&) { work(); });
    work();
    CHECK(writer.cpu() < 0.5 * long_enough);
    writer.add(at(0));
    writer.finish();
    CHECK(writer.cpu() >= long_enough);
    CHECK(writer.cpu() < 1.5 * long_enough);
}

}  // namespace frame_writer_test
