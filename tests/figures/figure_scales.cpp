// Common ranges of several pictures, complete titles, obstacles at their place, distinct lines.
#include "pixels.hpp"
#include "support/relative.hpp"
#include "support/synthetic_run.hpp"

#include "base/error.hpp"
#include "figures/body_figures.hpp"
#include "figures/contact_sheet.hpp"
#include "figures/curve_figures.hpp"
#include "output/vtk_series.hpp"
#include "record/figure_sequence.hpp"
#include "record/run_files.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <set>

namespace figure_scales_test {

using namespace knap;
using namespace knap::tests;

namespace {

std::filesystem::path pictures() { return picture_directory("test_figure_scales"); }

/// Texts of a figure below its x axis: the numbers of its colour bar, and its name.
std::vector<std::string> legend_texts(const DrawnFigure& figure) {
    std::vector<std::string> found;
    for (const DrawnText& text : figure.texts)
        if (text.box.top() < 40) found.push_back(text.text);
    return found;
}

bool has_text(const DrawnFigure& figure, const std::string& part) {
    return std::any_of(figure.texts.begin(), figure.texts.end(),
                       [&](const DrawnText& text) { return text.text.find(part) != std::string::npos; });
}

/// The plate with all openings and stresses multiplied.
Frame scaled(double factor, double time) {
    Frame frame = synthetic::frame(40);
    frame.time = time;
    for (double& opening : frame.opening) opening *= factor;
    for (Eigen::Vector3d& stress : frame.stress) stress *= factor;
    return frame;
}

}  // namespace

TEST_CASE("paths: the picture shows the way so far and the collectors that cross it") {
    Frame frame = synthetic::frame(20);
    frame.time = 2;
    Histories histories = synthetic::histories();
    histories.fragment_paths = {{"time", "label", "centre_x", "centre_y", "velocity_x", "velocity_y"},
                                {{0, 0, 0.05, 0.02, 3, 4}, {1, 0, 0.3, 0.1, 6, 8}, {3, 0, 9, 9, 60, 80}}};
    const std::vector<PiecePath> paths = piece_paths(histories, frame.time);
    REQUIRE(paths.size() == 1);
    CHECK(paths[0].at == std::vector<Vec2>{{0.05, 0.02}, {0.3, 0.1}});
    CHECK(paths[0].speed == std::vector<double>{5, 10});
    FigureOptions options{.file = "paths.png", .show = "paths", .width = 600};
    const FigureScale scale = body_scale(options, frame, histories);
    CHECK(scale.seen.contains({0.3, 0.1}));
    CHECK_FALSE(scale.seen.contains({1, 1}));
    CHECK(scale.values.max == 10);
    const FigureContext context{.title = "Paths",
                                .collectors = {{"net", {0.2, -infinity}, {0.2, infinity}}, {"far", {9, 0}, {9, 1}}}};
    const auto texts = draw_figure(options, frame, histories, context, pictures()).texts;
    const auto has = [&](const std::string& text) {
        return std::ranges::any_of(texts, [&](const DrawnText& drawn) { return drawn.text == text; });
    };
    CHECK(has("net"));
    CHECK_FALSE(has("far"));
    CHECK(has("speed of the centre [m/s]"));
    CHECK_FALSE(body_scale({.show = "cracks"}, frame, histories).seen.contains({0.3, 0.1}));
    // of a member of a sweep
    histories.fragment_paths = {};
    histories.trajectories = {{"time", "label", "obstacle", "x", "y", "speed"},
                              {{0, 0, NAN, 0, 0, 1}, {0, NAN, 0, 1, 0, 2}, {1, 0, NAN, 2, 0, 3}, {1, NAN, 0, 3, 0, 4}}};
    CHECK(piece_paths(histories, 1).size() == 2);
    CHECK(piece_paths(histories, 1)[1].speed == std::vector<double>{1, 3});
}

TEST_CASE("figures: the pictures of a sequence share colours and view") {
    const Frame early = scaled(0.1, 20e-6), late = scaled(1, 40e-6);
    for (const char* show : {"cracks", "stress_yy", "principal_stress"}) {
        CAPTURE(show);
        const FigureOptions options{.file = "shared.png", .show = show, .at = {20e-6, 40e-6}, .width = 560};
        CHECK(waits_for_the_end(options));
        const FigureScale common = joined(body_scale(options, early, {}), body_scale(options, late, {}));
        const FigureOptions single{.show = show, .width = 560};
        const DrawnFigure own = draw(single, early, {.title = "A plate"}, pictures() / "own.png"),
                          a = draw(single, early, {.title = "A plate"}, pictures() / "a.png", &common),
                          b = draw(single, late, {.title = "A plate"}, pictures() / "b.png", &common),
                          alone = draw(single, late, {.title = "A plate"}, pictures() / "alone.png");
        CHECK(legend_texts(a) == legend_texts(b));
        CHECK(legend_texts(own) != legend_texts(a));
        CHECK(legend_texts(alone) == legend_texts(b));
        CHECK(a.height == b.height);
    }
    // the same from frames on the disk
    const std::filesystem::path run = pictures() / "run";
    std::filesystem::remove_all(run);
    std::filesystem::create_directories(run);
    VtkSeries series(run);
    series.write(early);
    series.write(late);
    const FigureOptions options{.file = "disk.png", .show = "stress_yy", .at = {20e-6, 40e-6}, .width = 560};
    FrameReader reader(run);
    const FigureScale common =
        joined(scale_of(options, reader.frame(0), {}, {}), scale_of(options, reader.frame(1), {}, {}));
    const FigureScale in_memory = joined(body_scale(options, early, {}), body_scale(options, late, {}));
    CHECK(common.values.high == relative(in_memory.values.high, 1e-6));
    CHECK(common.values.low == relative(in_memory.values.low, 1e-6));
    const auto files = draw_sequence(options, reader, {0, 1}, {}, {}, pictures());
    CHECK(files == std::vector{pictures() / "disk_20us.png", pictures() / "disk_40us.png"});
    CHECK_FALSE(waits_for_the_end({.show = "energy", .at = {1, 2}}));
    CHECK_FALSE(waits_for_the_end({.show = "cracks", .at = {1}}));
}

TEST_CASE("figures: a box has the colours of what lies inside") {
    const Frame frame = synthetic::frame(60);
    const FigureOptions whole{.show = "principal_stress", .deform = 0, .width = 560};
    FigureOptions part = whole;
    part.box = Box{{0.002, 0.002}, {0.03, 0.01}};  // far from the tips
    const ValueSpan all = body_scale(whole, frame, {}).values, inside = body_scale(part, frame, {}).values;
    CHECK(inside.max < 0.5 * all.max);
    double largest = 0;
    for (Index t = 0; t < frame.n_triangles(); ++t) {
        const auto in_box = [&](Index c) { return part.box->contains(frame.position[c]); };
        if (in_box(3 * t) || in_box(3 * t + 1) || in_box(3 * t + 2))
            largest = std::max(largest, largest_principal(frame.stress[t]));
    }
    CHECK(inside.max == largest);
    CHECK(legend_texts(draw(part, frame, {}, pictures() / "part.png")) !=
          legend_texts(draw(whole, frame, {}, pictures() / "whole.png")));
    FigureOptions cracks = part;
    cracks.show = "cracks";
    CHECK(body_scale(cracks, frame, {}).values.high < body_scale({.show = "cracks"}, frame, {}).values.high);
}

TEST_CASE("figures: pieces that have flown off leave the colours to the cracks") {
    const Frame frame = synthetic::frame(60);
    const FigureOptions options{.show = "cracks", .width = 560};
    const ValueSpan before = body_scale(options, frame, {}).values;
    std::vector<Index> broken;
    for (Index i = 0; i < frame.n_interfaces(); ++i)
        if (frame.status_of_interface(i) == InterfaceStatus::broken) broken.push_back(i);
    REQUIRE(broken.size() > 10);
    const auto with_openings = [&](double edges, std::size_t n) {  // of the first n broken interfaces
        Frame moved = frame;
        for (std::size_t k = 0; k < n; ++k)
            for (const Index end : {2 * broken[k], 2 * broken[k] + 1})
                moved.opening[end] =
                    edges * (frame.end_position[2 * broken[k] + 1] - frame.end_position[2 * broken[k]]).norm();
        return body_scale(options, moved, {}).values;
    };
    const double edge = (frame.end_position[2 * broken[0] + 1] - frame.end_position[2 * broken[0]]).norm();
    REQUIRE(before.high < 0.5 * edge);
    const ValueSpan some = with_openings(50, broken.size() / 4);
    CHECK(some.high <= before.high);
    CHECK(some.max > 10 * before.high);  // the arrow of what is beyond the colours
    CHECK(with_openings(0.5, broken.size() / 4).high > 0.4 * edge);
    CHECK(with_openings(50, broken.size()).high > 10 * edge);  // all of them have: there is nothing else to show
}

TEST_CASE("figures: titles are whole") {
    const std::string title =
        "Edge-cracked block of soda-lime glass under uniaxial tension of 1 MPa, mesh of 0.5 mm, seed 17, with a law of "
        "Camacho and Ortiz";
    const auto check = [&](const DrawnFigure& figure) {
        std::string shown;
        for (const DrawnText& text : figure.texts) {
            INFO(figure.file.filename().string(), ": ", text.text);
            CHECK(text.box.left >= 0);
            CHECK(text.box.right() <= page_width);
            CHECK(text.box.top() <= figure.height);
            CHECK(text.text.find("…") == std::string::npos);
            if (title.find(text.text) != std::string::npos && text.text.size() > 10)
                shown += (shown.empty() ? "" : " ") + text.text;
        }
        CHECK(shown == title);
    };
    const Frame frame = synthetic::frame(20);
    check(draw({.width = 560}, frame, {.title = title}, pictures() / "title.png"));
    check(draw({.show = "stress_yy", .deform = 100, .width = 560}, frame, {.title = title}, pictures() / "title.png"));
    Chart chart = energy_chart(synthetic::energy());
    chart.title = title;
    check(draw_chart(chart, pictures() / "title.png", 560));
    check(draw_rose(synthetic::breaks(), title, pictures() / "title.png", 560));
    check(draw_contact_sheet({{pictures() / "title.png", "seed 1"}}, 1, title, pictures() / "title_sheet.png", 560));
    // a little too long: smaller
    const Title little = fitted_title(std::string(75, 'a'), "", 560);
    CHECK(little.lines.size() == 1);
    CHECK(little.size < title_size);
}

// T = 300 + 50 x/width in both materials and on both sides of the crack: the isoline of 325 is x = width/2.
TEST_CASE("figures: a temperature is smooth and its isolines lie where they must") {
    const Frame frame = synthetic::frame(20);
    const DrawnFigure figure =
        draw({.show = "temperature", .width = 1120, .mark = {325}}, frame, {}, pictures() / "isoline.png");
    const Pixels pixels(figure.file);
    std::set<int> columns, rows;
    for (int y = 0; y < 7 * pixels.height() / 10; ++y)  // the legend is below
        for (int x = 0; x < pixels.width(); ++x) {
            const std::uint32_t colour = pixels.at(x, y) & 0xFFFFFF;
            if ((colour >> 16) > 0xC0 && ((colour >> 8) & 0xFF) < 0x40 && (colour & 0xFF) < 0x40)
                columns.insert(x), rows.insert(y);
        }
    REQUIRE(columns.size() >= 2);
    CHECK(*columns.rbegin() - *columns.begin() < 8);
    CHECK(rows.size() > 200);
    const auto colours_in_a_row = [](const Pixels& of) {
        std::set<std::uint32_t> colours;
        for (int x = 0; x < of.width(); ++x) colours.insert(of.at(x, of.height() / 5));
        return colours.size();
    };
    const Pixels flat(draw({.show = "velocity_x", .width = 1120}, frame, {}, pictures() / "flat.png").file);
    CHECK(colours_in_a_row(pixels) > 3 * colours_in_a_row(flat));
    bool celsius = false;
    Frame warm = frame;
    warm.celsius = true;
    for (const auto& text : draw({.show = "temperature", .width = 1120}, warm, {}, pictures() / "celsius.png").texts)
        celsius = celsius || text.text.find("[°C]") != std::string::npos;
    CHECK(celsius);
    CHECK_THROWS_AS(draw({.show = "cracks", .mark = {1}}, frame, {}, pictures() / "refused.png"), UserError);
}

TEST_CASE("figures: displacements over the temperature and the thermal work as supply") {
    const History probes{{"time", "a_u_x", "a_u_y", "a_v_x", "a_v_y", "a_T"},
                         {{0, 0, 0, 0, 0, -6}, {1, 1e-3, 0, 0, 0, -2}}};
    const Chart chart = probe_chart(probes, true, true);
    REQUIRE(chart.curves.size() == 1);
    CHECK(chart.curves[0].x == std::vector<double>{-6, -2});
    CHECK(chart.x_unit == "°C");
    const History energy{{"time", "kinetic", "strain", "dissipated", "external_work", "thermal_work"},
                         {{0, 0, 0, 0, 0, 0}, {1, 1, 2, 3, 1, 5}}};
    const Chart balance = energy_chart(energy);
    CHECK(balance.curves[0].y.back() == 6);  // the sum of all
    CHECK(balance.curves[1].label == "external + thermal work");
    CHECK(balance.curves[1].y.back() == 6);
    CHECK(balance.curves[2].y.back() == 5);  // of it thermal work, with its sign
}

TEST_CASE("figures: a half plane reaches the frame") {
    Frame frame = synthetic::frame(20);
    for (Vec2& u : frame.displacement) u = Vec2::Zero();
    // the support below the plate, as a strip of no more than its width
    for (Index k = 0; k < n_outline_points; ++k) {
        const std::array<Vec2, 4> strip{Vec2(0.1, 0), Vec2(0, 0), Vec2(0, -0.005), Vec2(0.1, -0.005)};
        frame.obstacle_position.push_back(strip[std::min<Index>(k, 3)]);
        frame.obstacle_displacement.push_back(Vec2::Zero());
    }
    const auto support_at_border = [&](const DrawnFigure& figure) {  // pixels of the support's colour just inside the
                                                                     // left end of the plot, below its surface
        const Pixels pixels(figure.file);
        int n = 0;
        for (int y = 0; y < pixels.height(); ++y)
            n += pixels.at(54 * pixels.width() / 560, y) == 0xB2B8C2 ||
                 pixels.at(54 * pixels.width() / 560, y) == 0xB3B8C2;
        return n;
    };
    frame.half_plane = {0};
    CHECK(support_at_border(draw({.width = 560}, frame, {}, pictures() / "strip.png")) == 0);
    frame.half_plane = {1};
    for (const char* show : {"cracks", "stress_yy", "materials"}) {
        CAPTURE(show);
        const FigureOptions options{.file = std::string("support_") + show + ".png", .show = show, .width = 560};
        CHECK(support_at_border(draw_figure(options, frame, {}, {}, pictures())) >= 8);
    }
    // it is written and read
    const std::filesystem::path run = pictures() / "support";
    std::filesystem::remove_all(run);
    std::filesystem::create_directories(run);
    VtkSeries(run).write(frame);
    CHECK(read_frame(run, 0).is_half_plane(0));
}

TEST_CASE("figures: the short side of a slender body is stretched as its axis is labelled") {
    Frame bar = synthetic::frame(20);
    for (Vec2& x : bar.position) x.y() *= 0.1;
    const FigureOptions plain{.show = "stress_yy", .deform = 0, .width = 560};
    FigureOptions stretched = plain;
    stretched.aspect = 5;
    const Box seen = body_scale(plain, bar, {}).seen;
    const Plot a = body_plot(seen, plain, 40), b = body_plot(seen, stretched, 40);
    const Vec2 low(0, 0), high(0.1, 0.004);
    const Vec2 size_a = a.on_page(high) - a.on_page(low), size_b = b.on_page(high) - b.on_page(low);
    CHECK(size_b.x() == relative(size_a.x()));
    CHECK(size_b.y() == relative(5 * size_a.y()));
    CHECK(has_text(draw(stretched, bar, {.title = "A bar"}, pictures() / "bar.png"), "y [mm], × 5"));
    CHECK_FALSE(has_text(draw(plain, bar, {.title = "A bar"}, pictures() / "bar_plain.png"), "], ×"));
    for (Vec2& x : bar.position) x = Vec2(x.y(), x.x());
    CHECK(has_text(draw(stretched, bar, {.title = "A column"}, pictures() / "column.png"), "x [mm], × 5"));
    CHECK_THROWS_AS(draw_figure({.file = "a.png", .aspect = 0.5}, bar, {}, {}, pictures()), UserError);
}

TEST_CASE("figures: only the last picture of a run that ended early says so") {
    Frame frame = synthetic::frame(20);
    frame.time = 0.5;
    const auto says_so = [&](double early_end) {
        const FigureContext context{.title = "A run", .early_end = early_end};
        return has_text(draw({.show = "stress_yy", .width = 560}, frame, context, pictures() / "early_end.png"),
                        ", run ended");
    };
    CHECK(says_so(0.5));
    CHECK_FALSE(says_so(2));  // pictures of several times are drawn when the run has ended
    CHECK_FALSE(says_so(infinity));
}

TEST_CASE("figures: cracks have the colour of slip or mode or time of breaking") {
    const Frame frame = synthetic::frame(30);
    History breaks = synthetic::breaks(0);
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        if (drawn_status(frame, i) != InterfaceStatus::broken) continue;
        const Vec2 middle = 0.5 * (frame.end_position[2 * i] + frame.end_position[2 * i + 1]);
        breaks.rows.push_back(
            {1e-3 * middle.x(), middle.x(), middle.y(), 0, 1e-3, middle.y() / synthetic::height, 1e-3});
    }
    const auto values = [&](const char* name) { return crack_values(crack_colour(name), frame, breaks); };
    const std::vector<double> slip = values("slip"), mode = values("mode"), time = values("break_time");
    Index n_broken = 0, n_slipped = 0;
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        const InterfaceStatus status = drawn_status(frame, i);
        CHECK(std::isfinite(slip[i]) == (status == InterfaceStatus::broken || status == InterfaceStatus::precrack));
        CHECK(std::isfinite(mode[i]) == (status == InterfaceStatus::broken));
        n_slipped += slip[i] > 0;
        if (status != InterfaceStatus::broken) continue;
        ++n_broken;
        const Vec2 middle = 0.5 * (frame.end_position[2 * i] + frame.end_position[2 * i + 1]);
        CHECK(time[i] == relative(1e-3 * middle.x()));
        CHECK(mode[i] == relative(middle.y() / synthetic::height));
    }
    CHECK(n_broken > 5);
    CHECK(n_slipped > n_broken);
    for (const std::string& colour : figure_colours()) {
        const FigureOptions options{.file = colour + ".png", .colour = colour, .width = 560};
        CHECK(draw_figure(options, frame, {.breaks = breaks}, {}, pictures()).file == pictures() / (colour + ".png"));
        if (need_of_figure("cracks", colour) == FigureNeed::breaks)
            CHECK_THROWS_AS(draw_figure(options, frame, {}, {}, pictures()), UserError);
    }
    // undamaged interfaces are pale, broken ones dark
    const ColourMap cohesion = crack_colour("beta").map;
    const auto light = [](const Colour& c) { return 0.3 * c.red + 0.6 * c.green + 0.1 * c.blue; };
    CHECK(light(cohesion(1)) > 0.75);
    CHECK(std::max({std::abs(cohesion(1).red - cohesion(1).green), std::abs(cohesion(1).red - cohesion(1).blue)}) <
          0.05);
    for (int i = 0; i < 10; ++i) CHECK(light(cohesion(0.1 * i)) < light(cohesion(0.1 * (i + 1))));
}

TEST_CASE("figures: opened edges that hold still have outlines") {
    Frame frame = synthetic::frame(20);
    for (InterfaceStatus& status : frame.status)
        if (status != InterfaceStatus::intact) status = InterfaceStatus::damaged;
    for (double& cohesion : frame.cohesion) cohesion = std::max(cohesion, 0.99);
    const auto n_dark = [&](double deform) {
        const Pixels pixels(draw({.show = "velocity_x", .deform = deform, .range = {-1e3, 1e3}, .width = 1120}, frame,
                                 {}, pictures() / "opened.png")
                                .file);
        int n = 0;  // between the axes and well inside
        for (int y = 150; y < 400; ++y)
            for (int x = 200; x < 700; ++x) n += (pixels.at(x, y) & 0xFF) < 0x90;
        return n;
    };
    CHECK(n_dark(0) == 0);
    CHECK(n_dark(400) > 300);
}

TEST_CASE("figures: many lines are told apart by colour and pattern") {
    History probes{{"time"}, {}};
    for (int p = 0; p < 25; ++p) probes.columns.push_back("p" + std::to_string(p) + "_v_x");
    for (int i = 0; i < 3; ++i) {
        probes.rows.push_back({1e-6 * i});
        for (int p = 0; p < 25; ++p) probes.rows.back().push_back((1.0 + p) * i);
    }
    const Chart chart = probe_velocity_chart(probes);
    REQUIRE(chart.curves.size() == 25);
    std::set<std::array<double, 4>> styles;
    for (const Curve& curve : chart.curves)
        styles.insert({curve.colour.red, curve.colour.green, curve.colour.blue, static_cast<double>(curve.dash)});
    CHECK(styles.size() == 25);
    std::set<std::vector<double>> patterns;
    for (int kind = 0; kind < n_line_patterns; ++kind) patterns.insert(line_pattern(kind, 1.6));
    CHECK(patterns.size() == n_line_patterns);
    const DrawnFigure figure = draw_chart(chart, pictures() / "many.png", 560);
    for (int p = 0; p < 25; ++p) CHECK(has_text(figure, "p" + std::to_string(p) + ", v_{x}"));
    for (const DrawnText& text : figure.texts) CHECK(text.box.bottom >= 0);
    CHECK(chart.y_unit == "m/s");
}

TEST_CASE("figures: axes of stress and strain follow the axial curve") {
    History wide = synthetic::stress_strain();
    for (std::vector<double>& row : wide.rows) row[3] *= 500, row[4] = row[2] + row[3];  // fragments fly aside
    const Box axes = axis_ranges(stress_strain_chart(wide));
    CHECK(axes.high.x() == relative(0.2));  // [%]
    CHECK(axes.low.x() == relative(-0.2));
    CHECK(axes.high.y() == relative(100e6, 0.1));
}

TEST_CASE("figures: what hardly leaves zero does not cost a step of the axis") {
    const auto labels = [](double low) {
        const Chart chart{
            .x_quantity = "x", .y_quantity = "y", .curves = {{.label = "a", .x = {0, 1, 2}, .y = {0, low, 9}}}};
        std::set<std::string> texts;
        for (const DrawnText& text : draw_chart(chart, pictures() / "hardly.png", 560).texts) texts.insert(text.text);
        return texts;
    };
    CHECK(labels(-0.1).count("−2") == 0);
    CHECK(labels(-1).count("−2") == 1);
}

TEST_CASE("figures: the name of a level keeps off the curves") {
    Chart chart{.x_quantity = "x",
                .y_quantity = "y",
                .curves = {{.label = "a", .x = {0, 1, 2, 2.2, 3}, .y = {0, 5, 5, 0, 0}}},
                .levels = {{"level", 4.8, true}}};
    const auto left_of = [&] {
        for (const DrawnText& text : draw_chart(chart, pictures() / "level.png", 560).texts)
            if (text.text == "level") return text.box.left;
        return -1.;
    };
    CHECK(left_of() > 400);
    chart.curves[0].x = {0, 0.1, 2, 2.95, 3},
    chart.curves[0].y = {0, 1, 2, 5, 5};  // runs through the place at the right
    CHECK(left_of() < 150);
    CHECK(left_of() > 0);
}

TEST_CASE("figures: reactions over time are all forces that can be seen") {
    const Chart chart = reaction_chart(synthetic::reactions(), true);
    CHECK(chart.x_quantity == "time");
    CHECK(chart.curves.size() == 4);
    CHECK(chart.curves[0].x.back() == relative(80e-6));
    const FigureOptions options{.file = "over_time.png", .show = "reactions", .width = 560, .over = "time"};
    CHECK(draw_figure(options, {}, synthetic::histories(20), {}, pictures()).file == pictures() / "over_time.png");
    CHECK_THROWS_AS(draw_figure({.file = "a.png", .show = "reactions", .over = "force"}, {}, synthetic::histories(20),
                                {}, pictures()),
                    UserError);
}

TEST_CASE("figures: fluids in cracks have pressures and volumes and lengths over time") {
    CHECK(fluid_pressure_chart(synthetic::fluids()).curves.size() == 1);
    const Chart volumes = fluid_volume_chart(synthetic::fluids());
    REQUIRE(volumes.curves.size() == 2);
    CHECK(volumes.curves[1].label == "water, injected");
    CHECK(volumes.curves[1].y.back() == relative(1.02e-6));
    CHECK(fluid_length_chart(synthetic::fluids()).curves.at(0).y.back() == relative(0.08));
}

TEST_CASE("figures: what a run does not have is refused with a list of what it has") {
    Histories bare{.energy = synthetic::energy(5), .cracks = synthetic::cracks(5)};
    for (const char* show : {"reactions", "probes", "probe_velocities", "fluid_pressures", "fluid_volumes",
                             "stress_strain", "breaks", "rose", "fragments"}) {
        CAPTURE(show);
        try {
            draw_figure({.file = "a.png", .show = show}, {}, bare, {}, pictures());
            FAIL("drawn");
        } catch (const UserError& error) {
            const std::string message = error.what();
            CHECK(message.find(show) != std::string::npos);
            CHECK(message.find("crack_length") != std::string::npos);
            CHECK(message.find("it has") != std::string::npos);
        }
    }
    bare.probes = {{"time", "p_opening", "p_slip", "p_cohesion"}, {{0, 0, 0, 1}, {1, 0, 0, 1}}};
    CHECK_THROWS_AS(draw_figure({.file = "a.png", .show = "probe_velocities"}, {}, bare, {}, pictures()), UserError);
    CHECK(draw_figure({.file = "a.png", .show = "probes"}, {}, bare, {}, pictures()).file == pictures() / "a.png");
}

TEST_CASE("figures: panels are bare and their legend stands below all") {
    const Frame frame = synthetic::frame(20);
    FigureOptions options{.file = "panel.png", .width = 560, .panel = true};
    CHECK(waits_for_the_end(options));
    const FigureScale scale = body_scale(options, frame, {});
    CHECK(draw(options, frame, {.title = "A plate"}, pictures() / "panel.png").texts.empty());
    const Legend legend = panel_legend(options, frame, {}, {}, scale);
    REQUIRE(legend.bar.has_value());
    CHECK(legend.entries.size() == 2);
    const std::vector<Tile> tiles(
        4, {pictures() / "panel.png",
            "a caption that is longer than the panel is wide and so goes over two lines or more than that"});
    const DrawnFigure sheet = draw_contact_sheet(tiles, 4, "Plates", pictures() / "panels.png", 560, legend);
    CHECK(has_text(sheet, "opening"));
    CHECK(has_text(sheet, "pre-crack"));
    CHECK_FALSE(has_text(sheet, "…"));
    // curves: the same axes
    const Chart small = probe_chart(synthetic::probes(10));
    Box wide = axis_ranges(small);
    wide.high.y() *= 4;
    const auto labels = [](const DrawnFigure& figure) {
        std::set<std::string> texts;
        for (const DrawnText& text : figure.texts) texts.insert(text.text);
        return texts;
    };
    CHECK(labels(draw_chart(small, pictures() / "curve.png", 560, {.axes = wide, .panel = true})) !=
          labels(draw_chart(small, pictures() / "curve.png", 560, {.panel = true})));
}

}  // namespace figure_scales_test
