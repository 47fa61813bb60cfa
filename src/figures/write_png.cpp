#include "figures/write_png.hpp"

#include <cairo.h>
#include <png.h>

#include <csetjmp>
#include <cstdint>
#include <cstring>
#include <vector>

namespace knap {
namespace {

void append_to(png_structp png, png_bytep data, std::size_t n) {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), n);
}

}  // namespace

std::string png_of(cairo_surface_t* image) {
    cairo_surface_flush(image);
    const int width = cairo_image_surface_get_width(image), height = cairo_image_surface_get_height(image);
    const unsigned char* const pixels = cairo_image_surface_get_data(image);
    std::vector<unsigned char> rgb(3 * static_cast<std::size_t>(width));  // of a row
    std::string bytes;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    if (!info || setjmp(png_jmpbuf(png)) != 0) {  // libpng jumps here where it has no memory
        png_destroy_write_struct(&png, &info);
        return "";
    }
    png_set_write_fn(png, &bytes, append_to, nullptr);
    // pictures are flat: filters take longer than they save, and level 2 has three quarters of the time of 3
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
    png_set_compression_level(png, 2);
    png_set_IHDR(png, info, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (int row = 0; row < height; ++row) {
        const unsigned char* at = pixels + static_cast<std::ptrdiff_t>(row) * cairo_image_surface_get_stride(image);
        unsigned char* out = rgb.data();
        for (int column = 0; column < width; ++column, at += sizeof(std::uint32_t)) {
            std::uint32_t pixel;
            std::memcpy(&pixel, at, sizeof pixel);
            for (const int shift : {16, 8, 0}) *out++ = static_cast<unsigned char>(pixel >> shift);
        }
        png_write_row(png, rgb.data());
    }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

}  // namespace knap
