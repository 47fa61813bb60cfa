// Figures are judged by what is on the page: size, ink, colours, and where every piece of text lies.
#include "pixels.hpp"
#include "support/relative.hpp"
#include "support/synthetic_run.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "figures/animation.hpp"
#include "figures/contact_sheet.hpp"
#include "figures/curve_figures.hpp"

#include <doctest/doctest.h>

#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>

namespace figures_test {

using namespace knap;
using namespace knap::tests;

namespace {

std::filesystem::path pictures() { return picture_directory("test_figures"); }

/// No text leaves the page or runs into another.
void check_type(const DrawnFigure& figure, double width = page_width) {
    CHECK(figure.texts.size() >= 8);
    for (std::size_t i = 0; i < figure.texts.size(); ++i) {
        const auto& [text, box] = figure.texts[i];
        INFO(figure.file.filename().string(), ": ", text, " at ", box.left, " ", box.bottom, " size ", box.width, " ",
             box.height);
        CHECK(box.left >= 2);
        CHECK(box.bottom >= 2);
        CHECK(box.right() <= width - 2);
        CHECK(box.top() <= figure.height - 2);
        for (std::size_t j = 0; j < i; ++j) {
            INFO("and ", figure.texts[j].text);
            CHECK_FALSE(box.overlaps(figure.texts[j].box));
        }
    }
}

const Frame& plate() {
    static const Frame frame = synthetic::frame();
    return frame;
}

}  // namespace

TEST_CASE("figures: every subject is drawn without a display at the requested width") {
    unsetenv("DISPLAY");
    const FigureContext context{.title = "Edge-cracked block in tension", .rayleigh_speed = 2125};
    for (const std::string& subject : figure_subjects()) {
        const FigureOptions options{.file = subject + ".png", .show = subject, .at = {40e-6}, .width = 600};
        const auto file = draw_figure(options, plate(), synthetic::histories(), context, pictures()).file;
        CHECK(file == pictures() / (subject + ".png"));
        const Pixels picture(file);
        CAPTURE(subject);
        CHECK(picture.width() == 600);
        CHECK(picture.height() > 150);
        CHECK(picture.height() < 600);
        CHECK(picture.colours().size() > (subject == "materials" ? 20
                                          : shows_body(subject)  ? 250
                                                                 : 100));  // materials are few
        CHECK(picture.inked() > (shows_body(subject) ? 0.4 : 0.02));
        CHECK(picture.inked() < 0.9);
    }
}

TEST_CASE("figures: on paper a vector file has its width and its type and its texts are texts") {
    const FigureContext context{.title = "σ < 3 & 4: Edge-cracked block in tension", .rayleigh_speed = 2125};
    for (const std::string show : {"energy", "crack_length", "cracks", "stress_yy"}) {
        FigureOptions options{.file = show + "_paper.svg", .show = show, .paper_width = 84e-3, .font_size = 7};
        const DrawnFigure drawn = draw_figure(options, plate(), synthetic::histories(), context, pictures());
        CAPTURE(show);
        const double points = 72 / 25.4 * 84;
        CHECK(options.page().width * options.page().points == relative(points));
        CHECK(options.page().points * type_size == relative(7));
        check_type(drawn, options.page().width);
        const std::string svg = read_whole_file(drawn.file);
        CHECK(svg.find("width=\"238.11") != svg.npos);
        CHECK((svg.find("t = 40") != svg.npos) == shows_body(show));
        CHECK(svg.find("σ &lt; 3 &amp; 4") != svg.npos);
        CHECK(svg.find("glyph") == svg.npos);
        CHECK(svg.ends_with("</svg>\n"));
    }
    for (const double width : {84e-3, 180e-3}) {  // colours of triangles are pixels
        const FigureOptions options{.file = "dpi.svg", .show = "stress_yy", .paper_width = width};
        const std::string svg =
            read_whole_file(draw_figure(options, plate(), synthetic::histories(), context, pictures()).file);
        const std::string before = "transform=\"matrix(";
        const std::size_t at = svg.find(before, svg.find("<use xlink:href=\"#image"));
        REQUIRE(at != svg.npos);
        const double points_per_pixel = std::stod(svg.substr(at + before.size()));
        CAPTURE(width);
        CHECK(72 / points_per_pixel >= 299.9);  // dpi
    }
    FigureOptions narrow{.file = "n.svg", .show = "energy", .paper_width = 30e-3, .font_size = 12};
    CHECK_THROWS_WITH_AS(check_figure(narrow, synthetic::histories()), doctest::Contains("at most 4.6 pt"), UserError);
    narrow.font_size = 4;
    check_figure(narrow, synthetic::histories());
}

TEST_CASE("figures: captions say what a picture shows") {
    const FigureOptions cracks{.file = "a.png", .at = {20e-6, 40e-6}}, energy{.file = "e.png", .show = "energy"};
    CHECK(caption_of(cracks, "x/a_40us.png", 1) == "Broken and damaged interfaces, coloured by opening, t = 40us");
    CHECK(caption_of(energy, "e.png", 1) == "All terms of the energy balance over time");
    CHECK(caption_of(energy, "e_40us.png", 1).empty());
    CHECK(caption_of(energy, "e.svg", 1).empty());
    const FigureOptions stress{.file = "s.png", .show = "stress_xx", .title = "Waves"};
    CHECK(caption_of(stress, "s.png", 3e-6) == "Waves: Stress sigma xx [Pa] on the body, t = 3 µs");
    // at time.end, before which the run came to rest
    const FigureOptions paths{.file = "p.png", .show = "paths", .at = {60}};
    CHECK(caption_of(paths, "p.png", 9.5).ends_with(", t = 9.5 s"));
    for (const std::string& show : figure_subjects())
        for (const std::string& colour : figure_colours()) {
            const std::string words = words_of({.show = show, .colour = colour});
            CAPTURE(words);
            CHECK(words.find_first_of("{}\\|") == words.npos);
            CHECK(std::ranges::all_of(words, [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
        }
}

TEST_CASE("figures: a body of which a failed run threw parts away is drawn where it is") {
    Frame frame = synthetic::frame();
    const std::array thrown{1e9, 1e300, std::numeric_limits<double>::quiet_NaN()};
    for (Index c = 0; c < 9; ++c) frame.displacement[c] = Vec2(thrown[c / 3], -thrown[c / 3]);
    const FigureContext context{.title = "Blown up", .rayleigh_speed = 2125};
    for (const std::string show : {"cracks", "speed"}) {
        const FigureOptions options{.file = "blown_up_" + show + ".png", .show = show, .at = {40e-6}, .width = 600};
        const Pixels picture(draw_figure(options, frame, synthetic::histories(), context, pictures()).file);
        CHECK(picture.inked() > 0.4);
    }
}

TEST_CASE("figures: texts that are too long are shown from their start") {
    std::string endless;  // letters of two bytes; letter by letter this would take a day
    for (int i = 0; i < 1'000'000; ++i) endless += "ä";
    for (const bool bold : {false, true}) {
        const std::string part = fitted_text(endless, 12, 200, bold);
        const std::string letters = part.substr(0, part.size() - 3);
        CHECK(part == letters + "…");
        CHECK(letters.size() % 2 == 0);
        CHECK(text_width(part, 12, bold) <= 200);
        CHECK(text_width(letters + "ä…", 12, bold) > 200);
        CHECK(fitted_text(letters, 12, 200, bold) == letters);
    }
    CHECK(fitted_text("", 12, 200) == "");
    CHECK(fitted_text("long", 12, 1) == "…");
    Chart chart = probe_chart(synthetic::probes());
    for (Curve& curve : chart.curves) curve.label = endless;
    chart.title = endless;
    check_type(draw_chart(chart, pictures() / "type.png", 600));
    const Frame& frame = plate();
    check_type(draw({.show = "materials", .width = 600}, frame,
                    {.title = endless, .materials = std::vector<std::string>(9, endless)},
                    pictures() / "long_names.png"));
}

TEST_CASE("figures: long names in a legend go over lines and are not cut") {
    const std::string name = "granite of the upper quarry, coarse grained and weathered along its joints";
    const auto shown = [&](const DrawnFigure& figure) {
        std::string all;
        for (const DrawnText& text : figure.texts) all += text.text + " ";
        check_type(figure);
        return all.find("weathered") != std::string::npos && all.find("along its joints") != std::string::npos &&
               all.find("…") == std::string::npos;
    };
    Chart chart = probe_chart(synthetic::probes());
    for (Curve& curve : chart.curves) curve.label = name;
    CHECK(shown(draw_chart(chart, pictures() / "long_legend.png", 600)));
    CHECK(shown(draw({.show = "materials", .width = 600}, plate(),
                     {.title = "A plate", .materials = std::vector<std::string>(9, name)},
                     pictures() / "long_legend.png")));
}

TEST_CASE("figures: the scale of a rose stands next to its petals") {
    const DrawnFigure rose = draw_rose(synthetic::breaks(), "", pictures() / "type.png", 600);
    int n = 0;
    for (const DrawnText& text : rose.texts) {
        const Vec2 middle(text.box.left + 0.5 * text.box.width, text.box.bottom + 0.5 * text.box.height);
        INFO(text.text);
        CHECK((middle - Vec2(200, 196)).norm() > 138);  // of the rose on its page
        n += middle.y() < 30;
    }
    CHECK(n >= 3);
}

TEST_CASE("figures: magnified displacements are labelled with their consequence for contacts") {
    const FigureOptions magnified{.show = "cracks", .deform = 50}, other{.show = "energy", .deform = 50};
    CHECK(magnification(magnified, false) == "displacements × 50");
    CHECK(magnification(magnified, true).find("closed gaps overlap") != std::string::npos);
    CHECK(magnification(other, true).empty());
    CHECK(magnification({.show = "cracks", .deform = 1}, true).empty());
    const DrawnFigure sheet = draw_contact_sheet({{pictures() / "type.png", "seed 1"}}, 1, "Plates",
                                                 pictures() / "sheet.png", 600, {}, magnification(magnified, false));
    CHECK(std::any_of(sheet.texts.begin(), sheet.texts.end(),
                      [](const DrawnText& text) { return text.text == "displacements × 50"; }));
}

TEST_CASE("figures: probes are told apart by colour and their components by pattern") {
    History probes{{"time"}, {}};
    for (const char* name : {"a", "b", "c", "d"})
        for (const char* component : {"_u_x", "_u_y"}) probes.columns.push_back(std::string(name) + component);
    probes.rows = {std::vector<double>(9, 0.0), std::vector<double>(9, 1.0)};
    const Chart chart = probe_chart(probes);
    REQUIRE(chart.curves.size() == 8);
    for (std::size_t i = 0; i < 8; ++i) {
        CHECK(chart.curves[i].label ==
              std::string(1, static_cast<char>('a' + i / 2)) + (i % 2 == 0 ? ", u_{x}" : ", u_{y}"));
        CHECK(chart.curves[i].dash == static_cast<int>(i % 2));
        CHECK(chart.curves[i].colour.red == curve_colour(i / 2).red);
    }
}

TEST_CASE("figures: no text leaves the page or touches another") {
    for (const std::string& subject : figure_subjects())
        check_type(draw_figure({.file = "type.png", .show = subject, .width = 600}, plate(), synthetic::histories(),
                               {.title = "Edge-cracked block in tension", .rayleigh_speed = 2125}, pictures()));
    check_type(draw({.width = 600}, plate(),
                    {.title = "A title that is far too long for one line and goes on beyond what anyone would read at "
                              "the top of a figure"},
                    pictures() / "type.png"));
    check_type(draw({.colour = "beta", .deform = 200, .width = 600}, plate(), {.title = "Edge-cracked block"},
                    pictures() / "cracks_beta.png"));
    // a contact sheet of pictures that are there, and one that is not
    draw({.width = 600}, plate(), {.title = "Edge-cracked block"}, pictures() / "tile.png");
    std::vector<Tile> tiles;
    for (int i = 0; i < 7; ++i)
        tiles.push_back({pictures() / (i == 4 ? "nothing.png" : "tile.png"),
                         "interface.default.sigma_c 3 MPa, seed " + std::to_string(i)});
    for (const std::size_t n_columns : {1, 3, 7})
        check_type(draw_contact_sheet(tiles, n_columns, "Edge-cracked block", pictures() / "sheet.png", 1200));
    CHECK(Pixels(pictures() / "sheet.png").inked() > 0.2);
    check_type(draw_rose(synthetic::breaks(0), "Edge-cracked block", pictures() / "type.png", 600));  // nothing broke
}

TEST_CASE("figures: bodies of all shapes and without cracks keep their type apart") {
    const auto with_shape = [](double a, double b) {
        Frame frame = synthetic::frame(30);
        for (Vec2& x : frame.position) x = Vec2(a * x.x(), b * x.y());
        return frame;
    };
    for (const auto& [a, b] : {std::pair(1.0, 0.02), std::pair(0.01, 1.0), std::pair(0.3, 3.0), std::pair(1e3, 1e3),
                               std::pair(1e-4, 1e-4)}) {
        const Frame frame = with_shape(a, b);
        check_type(draw({.show = "stress_yy", .deform = 0, .width = 400}, frame, {.title = "A plate"},
                        pictures() / "shape.png"));
        check_type(draw({.deform = 0, .width = 400}, frame, {.title = "A plate"}, pictures() / "shape.png"));
    }
    check_type(draw({.box = Box{{0.0512, 0.0171}, {0.0533, 0.0187}}, .width = 400}, plate(), {.title = "A part"},
                    pictures() / "part.png"));
    Frame intact = synthetic::frame(10);
    for (InterfaceStatus& status : intact.status) status = InterfaceStatus::intact;
    check_type(draw({.width = 400}, intact, {.title = "Intact"}, pictures() / "intact.png"));
    const History none{synthetic::energy().columns, {}}, no_cracks{synthetic::cracks().columns, {}};
    check_type(draw_chart(energy_chart(none), pictures() / "none.png", 400));
    check_type(draw_chart(crack_speed_chart(no_cracks, 2125), pictures() / "none.png", 400));
}

TEST_CASE("figures: a uniform field shows no seams between its triangles") {
    Frame frame = synthetic::frame(80);
    for (Eigen::Vector3d& s : frame.stress) s = Eigen::Vector3d(2e6, 0, 0);
    for (InterfaceStatus& status : frame.status) status = InterfaceStatus::intact;
    const FigureOptions options{
        .show = "stress_xx", .deform = 0, .box = Box{{0.02, 0.01}, {0.08, 0.03}}, .range = {-4e6, 4e6}, .width = 700};
    const DrawnFigure figure = draw(options, frame, {}, pictures() / "seams.png");
    const Pixels pixels(figure.file);
    std::set<std::uint32_t> colours;
    for (int y = 60; y < 180; ++y)
        for (int x = 100; x < 600; ++x) colours.insert(pixels.at(x, y));
    CHECK(colours.size() == 1);
}

TEST_CASE("figures: a crack has its position and the colour of its opening") {
    const FigureOptions options{.range = {0, 20e-6}, .width = 1120};
    const DrawnFigure figure = draw(options, plate(), {}, pictures() / "place.png");
    const Pixels pixels(figure.file);
    // the plot is 104 mm wide between 52 and 544 units, two pixels a unit
    int n_black = 0, n_coloured = 0;
    for (int y = 0; y < pixels.height() / 2; ++y) {
        const auto at = [&](double x) { return pixels.at(static_cast<int>(2 * (52 + 492 * (x + 2) / 104)), y); };
        n_black += at(25) == 0;
        const std::uint32_t colour = at(80);  // opening of a few micrometres: the dark blue end
        n_coloured += (colour & 0xFF) > 100 && ((colour >> 16) & 0xFF) < 140 && ((colour >> 8) & 0xFF) < 60;
    }
    CHECK(n_black >= 1);
    CHECK(n_black <= 12);
    CHECK(n_coloured >= 1);
    CHECK(n_coloured <= 30);
}

TEST_CASE("figures: measured points stand where they were measured and widen the axes of curves") {
    const auto is_measured = [](std::uint32_t colour) {
        const int r = colour >> 16, g = (colour >> 8) & 0xFF, b = colour & 0xFF;
        return std::abs(r - 5) < 12 && std::abs(g - 115) < 12 && std::abs(b - 26) < 12;
    };
    const auto n_near = [&](const Pixels& pixels, double x, double y) {  // within the size of a cross
        int n = 0;
        for (double dx = -4; dx <= 4; dx += 0.5)
            for (double dy = -4; dy <= 4; dy += 0.5) n += is_measured(pixels.on_page(x + dx, y + dy));
        return n;
    };
    FigureOptions options{.width = 1120, .measured = {{0.03, 0.01}, {0.09, 0.03}}, .measured_by = "Somebody 1990"};
    const FigureScale scale = scale_of(options, plate(), {}, {});
    const DrawnFigure body = draw(options, plate(), {}, pictures() / "measured.png");
    const auto has_source = [](const DrawnFigure& figure) {
        return std::ranges::any_of(figure.texts, [](const auto& t) { return t.text == "Somebody 1990"; });
    };
    CHECK(has_source(body));
    check_type(body);
    const Pixels pixels(body.file);
    const double unit = 492 / scale.seen.extent().x();  // the plot is 492 units wide, from 52 on
    int found = 0;
    for (const Vec2& x : options.measured)
        for (double y = 40; y < body.height - 4; y += 1)  // a legend stands below, of unknown height
            if (n_near(pixels, 52 + unit * (x.x() - scale.seen.low.x()), y) > 15) {
                ++found;
                break;
            }
    CHECK(found == 2);

    options.show = "crack_speed", options.file = "measured_speed.png", options.measured = {{1e-3, 3000}};
    const Histories histories = synthetic::histories();
    CHECK(scale_of(options, plate(), histories, {}).seen.high == Vec2(1e-3, 3000));
    const DrawnFigure curves = draw_figure(options, plate(), histories, {}, pictures());
    CHECK(has_source(curves));
    check_type(curves);
    options.show = "stress_strain";  // its axis ends at the largest axial strain, but not before a measured one
    options.measured = {{7, 1e9}};
    CHECK(scale_of(options, plate(), histories, {}).seen.high == Vec2(7, 1e9));
    options.show = "rose";
    CHECK_THROWS_AS(draw_figure(options, plate(), histories, {}, pictures()), UserError);
}

TEST_CASE("figures: a load that does not move has no curve of force over displacement") {
    const Chart chart = reaction_chart(synthetic::reactions());
    REQUIRE(chart.curves.size() == 1);
    CHECK(chart.curves[0].label == "load0, F_{y}");
    CHECK(chart.curves[0].x.back() == 1e-6);
    History at_rest{synthetic::reactions().columns, {{0, 1, 2, 0, 0, 3, 4, 0, 0}, {1, 1, 2, 0, 0, 3, 4, 0, 0}}};
    CHECK(reaction_chart(at_rest).curves.size() == 2);
}

TEST_CASE("figures: vector files and names with the time") {
    const FigureContext context{.title = "Plate"};
    const History none;
    const auto starts_with = [](const std::filesystem::path& file, const std::string& expected) {
        std::ifstream in(file, std::ios::binary);
        std::string head(expected.size(), ' ');
        in.read(head.data(), static_cast<std::streamsize>(head.size()));
        return head == expected;
    };
    FigureOptions options{.file = "cracks.svg", .at = {20e-6, 40e-6, 80e-6}};
    auto file = draw_figure(options, plate(), {.energy = none, .cracks = none}, context, pictures()).file;
    CHECK(file == pictures() / "cracks_40us.svg");
    CHECK(starts_with(file, "<?xml"));
    options.file = "cracks.pdf";
    options.at = {};
    file = draw_figure(options, plate(), {.energy = none, .cracks = none}, context, pictures()).file;
    CHECK(file == pictures() / "cracks.pdf");
    CHECK(starts_with(file, "%PDF"));
    CHECK(std::filesystem::file_size(file) > 5000);
}

TEST_CASE("figures: an older picture stays where there is no room for the new one") {
    const std::filesystem::path directory = pictures() / "no room";
    std::filesystem::remove_all(directory);
    std::filesystem::create_directories(directory);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    for (const char* name : {"energy.png", "energy.svg", "energy.pdf"}) {
        CAPTURE(name);
        std::ofstream(directory / name) << "an older picture";
        const rlimit little{.rlim_cur = 1000, .rlim_max = before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &little);
        std::string message;
        try {
            draw_chart(energy_chart(synthetic::energy()), directory / name, 800);
        } catch (const OutputError& error) {
            message = error.what();
        }
        setrlimit(RLIMIT_FSIZE, &before);
        CHECK(message.find(name) != std::string::npos);
        CHECK(message.find("File too large") != std::string::npos);
        CHECK(std::filesystem::file_size(directory / name) == 16);
        CHECK(!std::filesystem::exists(directory / (std::string(name) + ".part")));
    }
    std::signal(SIGXFSZ, handler);
}

TEST_CASE("figures: what cannot be drawn is refused") {
    const auto draw = [](const FigureOptions& options, const std::filesystem::path& directory) {
        draw_figure(options, synthetic::frame(5), synthetic::histories(5), {}, directory);
    };
    CHECK_THROWS_AS(draw({.file = "a.png", .show = "strss_xx"}, pictures()), UserError);
    CHECK_THROWS_AS(draw({.file = "a.png", .colour = "red"}, pictures()), UserError);
    CHECK_THROWS_AS(draw({.file = "a.gif"}, pictures()), UserError);
    CHECK_THROWS_AS(draw({.file = "a.png", .width = 0}, pictures()), UserError);
    for (const char* file : {"a.png", "a.svg", "a.pdf"})
        CHECK_THROWS_AS(draw({.file = file, .width = 300}, pictures() / "missing"), SimulationError);
    for (const char* subject : {"cracks", "materials", "speed"}) CHECK(shows_body(subject));
    CHECK_FALSE(shows_body("energy"));
}

TEST_CASE("figures: the pictures of an animation have one page and its curves grow") {
    FigureOptions options{.file = "crack.webp", .width = animation_width, .curves = "energy"};
    const FigureContext context{.title = "Edge-cracked block in tension", .rayleigh_speed = 2125};
    const Histories histories = synthetic::histories();
    Frame frame = plate();
    const FigureScale common = scale_of(options, frame, histories, context);
    const double end = histories.energy.column("time").back();
    const auto inked_below = [&](double time) {  // of the curves: coloured pixels in the lower part
        frame.time = time;
        const DrawnFigure drawn = draw_picture(options, frame, histories, context, common);
        cairo_surface_t* const image = drawn.image.get();
        REQUIRE(cairo_image_surface_get_width(image) == animation_width);
        const int height = cairo_image_surface_get_height(image), top = height - 400;
        REQUIRE(height > 600);
        int n = 0;
        for (int y = top; y < height; ++y)
            for (int x = 0; x < 500; ++x) {  // not the legend
                const auto* p = cairo_image_surface_get_data(image) + y * cairo_image_surface_get_stride(image) + 4 * x;
                n += std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 60;
            }
        return n;
    };
    const int start = inked_below(0), middle = inked_below(0.5 * end), all = inked_below(end);
    CHECK(start < middle);
    CHECK(middle < all);
    CHECK(draw_picture(options, frame, histories, context, common).texts.size() >= 8);

    // .webp: as many pictures as were given, shown for their times
    const auto picture = [&](std::size_t i) -> Still {
        frame.time = static_cast<double>(i) * 0.25 * end;
        return {draw_picture(options, frame, histories, context, common).image, 0.2};
    };
    const std::filesystem::path file = pictures() / "crack.webp";
    write_animation(file, 5, picture);
    std::ifstream in(file, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    std::vector<int> durations;  // [ms]: bytes 12 to 14 of a chunk ANMF after its head of 8
    for (std::size_t at = bytes.find("ANMF"); at != bytes.npos; at = bytes.find("ANMF", at + 1))
        durations.push_back(static_cast<unsigned char>(bytes[at + 20]) +
                            256 * static_cast<unsigned char>(bytes[at + 21]));
    CHECK(durations == std::vector<int>(5, 200));
    CHECK_THROWS_AS(write_animation(pictures() / "crack.avi", 5, picture), UserError);
    options.curves = "fragments";
    CHECK_THROWS_AS(draw_picture(options, frame, histories, context, common), UserError);
}

}  // namespace figures_test
