#include "observe/read_png.hpp"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cmath>

namespace knap {

std::optional<Picture> read_png(const std::string& bytes) {
    static const std::string signature("\x89PNG\r\n\x1a\n", 8);
    if (!bytes.starts_with(signature)) return std::nullopt;
    vtkNew<vtkPNGReader> reader;
    reader->SetMemoryBuffer(bytes.data());
    reader->SetMemoryBufferLength(static_cast<vtkIdType>(bytes.size()));
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    if (reader->GetErrorCode() != 0 || image->GetNumberOfPoints() == 0 || image->GetScalarSize() < 1) return std::nullopt;
    int extent[3];
    image->GetDimensions(extent);
    const int n_components = image->GetNumberOfScalarComponents();
    const double largest = image->GetScalarSize() == 2 ? 65535 : 255;
    Picture picture{.width = extent[0], .height = extent[1]};
    for (int row = extent[1] - 1; row >= 0; --row)  // VTK's rows begin at the bottom
        for (int column = 0; column < extent[0]; ++column) {
            const auto part = [&](int component) { return image->GetScalarComponentAsDouble(column, row, 0, component) / largest; };
            const bool grey = n_components < 3;
            const double opaque = n_components == 2 || n_components == 4 ? part(n_components - 1) : 1;
            for (int i = 0; i < 3; ++i) picture.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * (opaque * part(grey ? 0 : i) + 1 - opaque))));
        }
    return picture;
}

}  // namespace knap
