// Figures are judged by what is on the page: size, ink, colours, and where every piece of text lies.
#include "synthetic_run.hpp"

#include "base/error.hpp"
#include "observe/body_figures.hpp"
#include "observe/curve_figures.hpp"
#include "observe/figures.hpp"

#include <cairo.h>
#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <set>

using namespace knap;

namespace {

std::filesystem::path pictures() {
    const std::filesystem::path directory = std::filesystem::path(KNAP_BINARY_DIR) / "test_figures";
    std::filesystem::create_directories(directory);
    return directory;
}

struct Picture {
    int width, height;
    std::set<std::uint32_t> colours;
    double inked;  // part of the pixels that are not white
};

Picture read_png(const std::filesystem::path& file) {
    cairo_surface_t* image = cairo_image_surface_create_from_png(file.string().c_str());
    REQUIRE(cairo_surface_status(image) == CAIRO_STATUS_SUCCESS);
    Picture p{cairo_image_surface_get_width(image), cairo_image_surface_get_height(image), {}, 0};
    const unsigned char* data = cairo_image_surface_get_data(image);
    for (int y = 0; y < p.height; ++y) {
        const auto* row = reinterpret_cast<const std::uint32_t*>(data + y * cairo_image_surface_get_stride(image));
        for (int x = 0; x < p.width; ++x) {
            const std::uint32_t colour = row[x] & 0xFFFFFF;
            p.colours.insert(colour);
            p.inked += colour != 0xFFFFFF;
        }
    }
    p.inked /= static_cast<double>(p.width) * p.height;
    cairo_surface_destroy(image);
    return p;
}

bool overlap(const Area& a, const Area& b) { return a.left < b.right() && b.left < a.right() && a.bottom < b.top() && b.bottom < a.top(); }

/// No text leaves the page or runs into another.
void check_type(const DrawnFigure& figure) {
    CHECK(figure.texts.size() >= 8);
    for (std::size_t i = 0; i < figure.texts.size(); ++i) {
        const auto& [text, box] = figure.texts[i];
        INFO(figure.file.filename().string(), ": ", text, " at ", box.left, " ", box.bottom, " size ", box.width, " ", box.height);
        CHECK(box.left >= 2);
        CHECK(box.bottom >= 2);
        CHECK(box.right() <= page_width - 2);
        CHECK(box.top() <= figure.height - 2);
        for (std::size_t j = 0; j < i; ++j) {
            INFO("and ", figure.texts[j].text);
            CHECK_FALSE(overlap(box, figure.texts[j].box));
        }
    }
}

const Frame& plate() {
    static const Frame frame = synthetic::frame();
    return frame;
}

}  // namespace

TEST_CASE("figures: every subject is drawn without a display at the asked width") {
    unsetenv("DISPLAY");
    const FigureContext context{.title = "Edge-cracked block in tension", .rayleigh_speed = 2125};
    for (const std::string& subject : figure_subjects()) {
        const FigureOptions options{.file = subject + ".png", .show = subject, .at = {40e-6}, .width = 1200};
        const auto files = draw_figure(options, plate(), synthetic::energy(), synthetic::cracks(), context, pictures());
        REQUIRE(files.size() == 1);
        CHECK(files[0] == pictures() / (subject + ".png"));
        const Picture picture = read_png(files[0]);
        CAPTURE(subject);
        CHECK(picture.width == 1200);
        CHECK(picture.height > 300);
        CHECK(picture.height < 1200);
        CHECK(picture.colours.size() > (shows_body(subject) ? 250 : 100));
        CHECK(picture.inked > (shows_body(subject) ? 0.4 : 0.02));
        CHECK(picture.inked < 0.9);
    }
}

TEST_CASE("figures: no text leaves the page or touches another") {
    for (const std::string& subject : figure_fields()) {
        check_type(draw_field({.show = subject, .width = 600}, plate(), "Edge-cracked block in tension", pictures() / "type.png"));
    }
    check_type(draw_cracks({.width = 600}, plate(), "A title that is far too long for one line and goes on beyond what anyone would read at the top of a figure", pictures() / "type.png"));
    check_type(draw_cracks({.colour = "beta", .deform = 200, .width = 600}, plate(), "Edge-cracked block", pictures() / "cracks_beta.png"));
    for (const Chart& chart : {energy_chart(synthetic::energy()), crack_length_chart(synthetic::cracks()), crack_speed_chart(synthetic::cracks(), 2125)})
        check_type(draw_chart(chart, pictures() / "type.png", 600));
}
