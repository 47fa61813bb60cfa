#include "figures/read_png.hpp"

#include "figures/canvas.hpp"

#include <cairo.h>

#include <algorithm>
#include <cstring>

namespace knap {
namespace {

constexpr double max_pixels = 5e7;
constexpr double max_compression = 1032;  // of deflate: 258 bytes in two bits

/// Checks the first chunk before memory is allocated: signature, length, "IHDR", width, height, bits, kind.
std::string problem_of_size(const std::string& bytes) {
    static const std::string signature("\x89PNG\r\n\x1a\n", 8);
    if (!bytes.starts_with(signature) || bytes.size() < 33 || bytes.compare(12, 4, "IHDR") != 0)
        return "is not a PNG picture";
    const auto number = [&](std::size_t at) {
        double value = 0;
        for (std::size_t i = at; i < at + 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes[i]);
        return value;
    };
    const double n_pixels = number(16) * number(20), bits = static_cast<unsigned char>(bytes[24]);
    if (n_pixels > max_pixels)
        return "has more than " + std::to_string(static_cast<int>(max_pixels / 1e6)) + " million pixels";
    if (n_pixels * bits / 8 > max_compression * static_cast<double>(bytes.size()))
        return "is not a PNG picture: it is too short for its number of pixels";
    return "";
}

}  // namespace

std::optional<Picture> read_png(const std::string& bytes, std::string& problem) {
    problem = problem_of_size(bytes);
    if (!problem.empty()) return std::nullopt;
    problem = "is not a PNG picture with colours";
    std::string_view rest = bytes;
    const auto read = [](void* from, unsigned char* to, unsigned n) {
        std::string_view& left = *static_cast<std::string_view*>(from);
        if (n > left.size()) return CAIRO_STATUS_READ_ERROR;
        std::memcpy(to, left.data(), n);
        left.remove_prefix(n);
        return CAIRO_STATUS_SUCCESS;
    };
    const Image image(cairo_image_surface_create_from_png_stream(read, &rest), cairo_surface_destroy);
    if (cairo_surface_status(image.get()) != CAIRO_STATUS_SUCCESS) return std::nullopt;
    const cairo_format_t format = cairo_image_surface_get_format(image.get());
    if (format != CAIRO_FORMAT_ARGB32 && format != CAIRO_FORMAT_RGB24) return std::nullopt;
    Picture picture{.width = cairo_image_surface_get_width(image.get()),
                    .height = cairo_image_surface_get_height(image.get())};
    picture.rgb.reserve(3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
    for (int row = 0; row < picture.height; ++row) {
        const unsigned char* at =
            cairo_image_surface_get_data(image.get()) + row * cairo_image_surface_get_stride(image.get());
        for (int column = 0; column < picture.width; ++column, at += 4) {
            std::uint32_t pixel;  // opacity, red, green, blue; the colours are multiplied by the opacity
            std::memcpy(&pixel, at, 4);
            const std::uint32_t background = format == CAIRO_FORMAT_ARGB32 ? 255 - (pixel >> 24) : 0;
            for (const int shift : {16, 8, 0})
                picture.rgb.push_back(static_cast<std::uint8_t>(std::min(255u, ((pixel >> shift) & 255) + background)));
        }
    }
    return picture;
}

}  // namespace knap
