// Any bytes as a picture.
#include "target.hpp"

#include "figures/read_png.hpp"

using namespace knap;
using tests::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string problem;
    const std::optional<Picture> picture = read_png(tests::text_of(data, size), problem);
    require(picture || !problem.empty(), "an error says something");
    if (!picture) return 0;
    require(picture->width > 0 && picture->height > 0, "a picture has pixels");
    require(
        picture->rgb.size() == 3 * static_cast<std::size_t>(picture->width) * static_cast<std::size_t>(picture->height),
        "each with its colour");
    return 0;
}
