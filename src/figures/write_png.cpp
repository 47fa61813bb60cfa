#include "figures/write_png.hpp"

#include <cairo.h>
#include <png.h>

#include <cstdint>
#include <cstring>
#include <vector>

namespace knap {

std::string png_of(cairo_surface_t* image) {
    cairo_surface_flush(image);
    const int width = cairo_image_surface_get_width(image), height = cairo_image_surface_get_height(image);
    const unsigned char* const pixels = cairo_image_surface_get_data(image);
    std::vector<unsigned char> rgb(3 * static_cast<std::size_t>(width) * height);
    unsigned char* out = rgb.data();
    for (int row = 0; row < height; ++row) {
        const unsigned char* at = pixels + static_cast<std::ptrdiff_t>(row) * cairo_image_surface_get_stride(image);
        for (int column = 0; column < width; ++column, at += sizeof(std::uint32_t)) {
            std::uint32_t pixel;
            std::memcpy(&pixel, at, sizeof pixel);
            for (const int shift : {16, 8, 0}) *out++ = static_cast<unsigned char>(pixel >> shift);
        }
    }
    png_image picture{};
    picture.version = PNG_IMAGE_VERSION;
    picture.width = width, picture.height = height;
    picture.format = PNG_FORMAT_RGB;
    picture.flags = PNG_IMAGE_FLAG_FAST;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(picture);
    std::string bytes(size, '\0');
    if (png_image_write_to_memory(&picture, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0) return "";
    bytes.resize(size);
    return bytes;
}

}  // namespace knap
