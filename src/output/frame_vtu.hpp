#pragma once
// A Frame as two VTK files: the triangles (corner-owned points) and the interfaces (line cells), and back.
// Intact interfaces inside the body are left out (they would double the size of a run): they are closed, and their traction is that of
// the stress on either side. A frame that is read back has the others only, which is all that a figure needs.
#include "output/frame.hpp"
#include "output/outputs.hpp"

#include <filesystem>

namespace knap {

/// The arrays of the three files: fields/bulk, fields/interfaces, fields/obstacles.
const std::vector<OutputTable>& frame_outputs();

/// By one thread, before another may write: with its first object VTK makes what all share, and nobody else may be at that. It prints its errors, each several
/// times; from here on it does not, ours are thrown.
void prepare_vtk();

/// Appended raw data with LZ4; what is computed with is float64 (positions), what is looked at is float32.
/// Throws OutputError naming the path.
void write_bulk(const Frame& frame, const std::filesystem::path& path);
/// Those that are damaged, broken, pre-cracked or on a support.
void write_interfaces(const Frame& frame, const std::filesystem::path& path);

/// The outlines of the obstacles as polygons.
void write_obstacles(const Frame& frame, const std::filesystem::path& path);

/// Throws UserError naming the path.
void read_bulk(const std::filesystem::path& path, Frame& frame);
void read_interfaces(const std::filesystem::path& path, Frame& frame);
void read_obstacles(const std::filesystem::path& path, Frame& frame);

}  // namespace knap
