#pragma once
// Animations: .webp by libwebp; .gif and .mp4 by the program ffmpeg, where it is installed. The same pictures give the
// same bytes.
#include "figures/canvas.hpp"

#include <functional>

namespace knap {

/// By the ending of the file.
bool is_animation(const std::filesystem::path& file);

/// Throws UserError where this machine cannot write it.
void check_animation(const std::filesystem::path& file);

struct Still {
    Image image{nullptr, nullptr};
    double seconds = 0;  // for which it is shown
};

/// Writes `n` pictures, made one after the other. All pictures must have the width of the last one; each is aligned
/// with the bottom of a page of its height. `lines`: drawings of lines without a field. Throws UserError as
/// check_animation does, OutputError for a file that cannot be written.
void write_animation(const std::filesystem::path& file, std::size_t n, const std::function<Still(std::size_t)>& picture,
                     bool lines = false);

/// An image as .webp, which is smaller than a .png.
std::string webp_of(const Image& image);

/// A .png as .webp of this width [pixel] at most.
std::string webp_of_png(const std::filesystem::path& file, int width);

/// One image above the other, on white. Both have the same width.
Image stacked(const Image& above, const Image& below);

}  // namespace knap
