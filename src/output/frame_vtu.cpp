#include "output/frame_vtu.hpp"

#include "base/error.hpp"
#include "base/whole_file.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkInformation.h>
#include <vtkInformationStringKey.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>

namespace knap {

const std::vector<OutputTable>& frame_outputs() {
    static const std::vector<OutputTable> tables{
        {"fields/bulk", "arrays of fields/bulk_NNNN.vtu: the triangles, each with corners of its own; points in m, undeformed, time in s as TimeValue",
         {{"displacement", "m", "of a corner"},
          {"velocity", "m/s", "of a corner"},
          {"stress", "Pa", "xx, yy, xy of a triangle; tension positive"},
          {"principal_stress", "Pa", "the largest one of a triangle"},
          {"region", "", "number of the material of a triangle, in the order of `materials` of run.json"},
          {"grain", "", "number of its grain, -1: none; only where there are grains"}}},
        {"fields/interfaces", "arrays of fields/interfaces_NNNN.vtu: two points an interface, those that are damaged, broken, pre-cracked or on a support",
         {{"beta", "", "cohesion: 1 intact, 0 broken"},
          {"opening", "m", "along the normal"},
          {"slip", "m", "along the interface"},
          {"traction", "Pa", "normal and tangential"},
          {"displacement", "m", "mean of both sides"},
          {"status", "", "0 intact, 1 damaged, 2 broken, 3 pre-crack"},
          {"sides", "", "numbers of the corners on both sides in fields/bulk, -1: the support"}}},
        {"fields/obstacles", "arrays of fields/obstacles_NNNN.vtu: the outlines of obstacles",
         {{"displacement", "m", "of a point of the outline"},
          {"half_plane", "", "1: a half plane, of which the outline is a part"}}},
    };
    return tables;
}

namespace {

using std::filesystem::path;

/// Parts of a frame, in the order of frame_outputs().
enum class FramePart { bulk, interfaces, obstacles };

/// An array of `n` tuples whose entry (i, j) is value(i, j).
template <class Array, class Value>
vtkNew<Array> filled(const char* name, Index n, int n_components, Value value) {
    vtkNew<Array> array;
    array->SetName(name);
    array->SetNumberOfComponents(n_components);
    array->SetNumberOfTuples(n);
    auto* out = array->GetPointer(0);
    for (Index i = 0; i < n; ++i)
        for (int j = 0; j < n_components; ++j) *out++ = static_cast<typename Array::ValueType>(value(i, j));
    return array;
}

/// VTK's vectors have three components.
auto in_plane(const std::vector<Vec2>& values) {
    return [&](Index i, int j) { return j < 2 ? values[i][j] : 0.0; };
}

Index count(const std::vector<Vec2>& values) { return static_cast<Index>(values.size()); }

/// Points, and cells of `n_ends` consecutive points each.
void set_geometry(vtkUnstructuredGrid* grid, const std::vector<Vec2>& position, int cell_type, Index n_ends) {
    const Index n_points = count(position), n_cells = n_points / n_ends;
    vtkNew<vtkPoints> points;
    points->SetData(filled<vtkDoubleArray>("Points", n_points, 3, in_plane(position)));
    grid->SetPoints(points);
    vtkNew<vtkCellArray> cells;
    cells->SetData(filled<vtkTypeInt32Array>("offsets", n_cells + 1, 1, [&](Index i, int) { return n_ends * i; }),
                   filled<vtkTypeInt32Array>("connectivity", n_points, 1, [](Index i, int) { return i; }));
    grid->SetCells(cell_type, cells);
}

/// Where readers of VTK look for units.
void add_units(vtkDataSetAttributes* arrays, const OutputTable& table) {
    for (int i = 0; i < arrays->GetNumberOfArrays(); ++i) {
        const auto row = std::ranges::find(table.rows, std::string_view(arrays->GetArray(i)->GetName()), &Output::name);
        if (row != table.rows.end() && !row->unit.empty())
            arrays->GetArray(i)->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), std::string(row->unit).c_str());
    }
}

void write(vtkUnstructuredGrid* grid, FramePart part, double time, const path& file) {
    const OutputTable& table = frame_outputs()[static_cast<std::size_t>(part)];
    add_units(grid->GetPointData(), table);
    add_units(grid->GetCellData(), table);
    vtkNew<vtkDoubleArray> time_value;  // the name that ParaView looks for
    time_value->SetName("TimeValue");
    time_value->InsertNextValue(time);
    grid->GetFieldData()->AddArray(time_value);
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetInputData(grid);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToLZ4();
    write_whole_file(file, [&](const path& written) {
        writer->SetFileName(written.c_str());
        if (writer->Write() == 0 || writer->GetErrorCode() != vtkErrorCode::NoError)
            throw OutputError("cannot write " + file.string() + ": " + vtkErrorCode::GetStringFromErrorCode(writer->GetErrorCode()));
    });
}

vtkNew<vtkXMLUnstructuredGridReader> opened(const path& file) {
    prepare_vtk();
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    if (!std::filesystem::is_regular_file(file)) throw UserError("missing-file", "there is no file `" + file.string() + "`");
    reader->SetFileName(file.string().c_str());
    reader->Update();
    if (reader->GetErrorCode() != vtkErrorCode::NoError) throw UserError("damaged-file", "`" + file.string() + "` cannot be read");
    return reader;
}

/// The entries of one array, checked for presence and shape.
class Values {
public:
    Values(vtkFieldData* data, const char* name, int n_components, const path& file) : array_(data->GetArray(name)) {
        if (!array_ || array_->GetNumberOfComponents() != n_components)
            throw UserError("damaged-file", "`" + file.string() + "` has no array `" + name + "` of " + std::to_string(n_components) + " components");
    }
    Index size() const { return static_cast<Index>(array_->GetNumberOfTuples()); }
    double operator()(Index i, int j = 0) const { return array_->GetComponent(i, j); }
    Vec2 vector(Index i) const { return {(*this)(i, 0), (*this)(i, 1)}; }

private:
    vtkDataArray* array_;
};

std::vector<Vec2> vectors(const Values& values) {
    std::vector<Vec2> out(values.size());
    for (Index i = 0; i < values.size(); ++i) out[i] = values.vector(i);
    return out;
}

std::vector<Vec2> positions(vtkUnstructuredGrid* grid) {
    std::vector<Vec2> out(grid->GetNumberOfPoints());
    double x[3];
    for (std::size_t i = 0; i < out.size(); ++i) {
        grid->GetPoint(static_cast<vtkIdType>(i), x);
        out[i] = {x[0], x[1]};
    }
    return out;
}

std::vector<double> numbers(const Values& values) {
    std::vector<double> out(values.size());
    for (Index i = 0; i < values.size(); ++i) out[i] = values(i);
    return out;
}

/// Mean displacement of the two sides, so that the interfaces can be warped like the body.
Vec2 mean_displacement(const Frame& frame, Index point) {
    const Index a = frame.side_a[point / 2][point % 2], b = frame.side_b[point / 2][point % 2];
    const Vec2 u_a = a < 0 ? frame.displacement[b] : frame.displacement[a];
    const Vec2 u_b = b < 0 ? frame.displacement[a] : frame.displacement[b];
    return 0.5 * (u_a + u_b);
}

/// Both points of each interface that is worth its place on the disk.
std::vector<Index> kept_points(const Frame& frame) {
    std::vector<Index> kept;
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        const bool intact = frame.status[2 * i] == PointStatus::intact && frame.status[2 * i + 1] == PointStatus::intact;
        const bool on_support = frame.side_a[i][0] < 0 || frame.side_b[i][0] < 0;
        if (!intact || on_support) kept.insert(kept.end(), {2 * i, 2 * i + 1});
    }
    return kept;
}

}  // namespace

void prepare_vtk() {
    vtkObject::GlobalWarningDisplayOff();
    const vtkNew<vtkUnstructuredGrid> first;
}

void write_bulk(const Frame& frame, const path& file) {
    const Index n_corners = count(frame.position), n = frame.n_triangles();
    vtkNew<vtkUnstructuredGrid> grid;
    set_geometry(grid, frame.position, VTK_TRIANGLE, 3);
    grid->GetPointData()->AddArray(filled<vtkFloatArray>("displacement", n_corners, 3, in_plane(frame.displacement)));
    grid->GetPointData()->AddArray(filled<vtkFloatArray>("velocity", n_corners, 3, in_plane(frame.velocity)));
    vtkNew<vtkFloatArray> stress = filled<vtkFloatArray>("stress", n, 3, [&](Index t, int j) { return frame.stress[t][j]; });
    const char* names[] = {"xx", "yy", "xy"};
    for (int j = 0; j < 3; ++j) stress->SetComponentName(j, names[j]);
    grid->GetCellData()->AddArray(stress);
    grid->GetCellData()->AddArray(
        filled<vtkFloatArray>("principal_stress", n, 1, [&](Index t, int) { return largest_principal(frame.stress[t]); }));
    grid->GetCellData()->AddArray(filled<vtkTypeInt32Array>("region", n, 1, [&](Index t, int) { return frame.region[t]; }));
    if (!frame.grain.empty())
        grid->GetCellData()->AddArray(filled<vtkTypeInt32Array>("grain", n, 1, [&](Index t, int) { return frame.grain[t]; }));
    write(grid, FramePart::bulk, frame.time, file);
}

void write_interfaces(const Frame& frame, const path& file) {
    const std::vector<Index> kept = kept_points(frame);
    const auto n = static_cast<Index>(kept.size());
    std::vector<Vec2> ends;
    for (const Index p : kept) ends.push_back(frame.end_position[p]);
    vtkNew<vtkUnstructuredGrid> grid;
    set_geometry(grid, ends, VTK_LINE, 2);
    vtkPointData* data = grid->GetPointData();
    const auto add_float = [&](const char* name, int n_components, auto value) {
        data->AddArray(filled<vtkFloatArray>(name, n, n_components, [&](Index i, int j) { return value(kept[i], j); }));
    };
    add_float("beta", 1, [&](Index p, int) { return frame.cohesion[p]; });
    add_float("opening", 1, [&](Index p, int) { return frame.opening[p]; });
    add_float("slip", 1, [&](Index p, int) { return frame.slip[p]; });
    add_float("traction", 2, [&](Index p, int j) { return frame.traction[p][j]; });
    add_float("displacement", 3, [&](Index p, int j) { return j < 2 ? mean_displacement(frame, p)[j] : 0.0; });
    data->AddArray(filled<vtkUnsignedCharArray>("status", n, 1, [&](Index i, int) { return frame.status[kept[i]]; }));
    data->AddArray(filled<vtkTypeInt32Array>("sides", n, 2, [&](Index i, int j) {
        const Index p = kept[i];
        return (j == 0 ? frame.side_a : frame.side_b)[p / 2][p % 2];
    }));
    write(grid, FramePart::interfaces, frame.time, file);
}

void write_obstacles(const Frame& frame, const path& file) {
    vtkNew<vtkUnstructuredGrid> grid;
    set_geometry(grid, frame.obstacle_position, VTK_POLYGON, n_outline_points);
    grid->GetPointData()->AddArray(filled<vtkDoubleArray>("displacement", count(frame.obstacle_position), 3, in_plane(frame.obstacle_displacement)));
    grid->GetCellData()->AddArray(filled<vtkUnsignedCharArray>("half_plane", frame.n_obstacles(), 1, [&](Index o, int) { return frame.is_half_plane(o) ? 1 : 0; }));
    write(grid, FramePart::obstacles, frame.time, file);
}

void read_bulk(const path& file, Frame& frame) {
    const auto reader = opened(file);
    vtkUnstructuredGrid* grid = reader->GetOutput();
    const Values time(grid->GetFieldData(), "TimeValue", 1, file);
    if (time.size() == 0) throw UserError("damaged-file", "`" + file.string() + "` has no time");
    const Values stress(grid->GetCellData(), "stress", 3, file), region(grid->GetCellData(), "region", 1, file);
    frame.time = time(0);
    frame.position = positions(grid);
    frame.length_scale = diagonal(frame.position);
    frame.displacement = vectors({grid->GetPointData(), "displacement", 3, file});
    frame.velocity = vectors({grid->GetPointData(), "velocity", 3, file});
    frame.stress.resize(stress.size());
    frame.region.resize(region.size());
    for (Index t = 0; t < stress.size(); ++t) {
        frame.stress[t] = {stress(t, 0), stress(t, 1), stress(t, 2)};
        frame.region[t] = static_cast<std::int32_t>(region(t));
    }
    if (!grid->GetCellData()->HasArray("grain")) return;
    const Values grain(grid->GetCellData(), "grain", 1, file);
    for (Index t = 0; t < grain.size(); ++t) frame.grain.push_back(static_cast<std::int32_t>(grain(t)));
}

void read_interfaces(const path& file, Frame& frame) {
    const auto reader = opened(file);
    vtkUnstructuredGrid* grid = reader->GetOutput();
    vtkPointData* data = grid->GetPointData();
    const Values status(data, "status", 1, file), sides(data, "sides", 2, file);
    const Index n_points = status.size();
    frame.end_position = positions(grid);
    frame.cohesion = numbers({data, "beta", 1, file});
    frame.opening = numbers({data, "opening", 1, file});
    frame.slip = numbers({data, "slip", 1, file});
    frame.traction = vectors({data, "traction", 2, file});
    frame.status.resize(n_points);
    frame.side_a.resize(n_points / 2);
    frame.side_b.resize(n_points / 2);
    for (Index p = 0; p < n_points; ++p) {
        frame.status[p] = static_cast<PointStatus>(status(p));
        frame.side_a[p / 2][p % 2] = static_cast<Index>(sides(p, 0));
        frame.side_b[p / 2][p % 2] = static_cast<Index>(sides(p, 1));
    }
}

void read_obstacles(const path& file, Frame& frame) {
    const auto reader = opened(file);
    frame.obstacle_position = positions(reader->GetOutput());
    frame.obstacle_displacement = vectors({reader->GetOutput()->GetPointData(), "displacement", 3, file});
    if (!reader->GetOutput()->GetCellData()->HasArray("half_plane")) return;  // older runs have none
    const Values half_plane(reader->GetOutput()->GetCellData(), "half_plane", 1, file);
    for (Index o = 0; o < half_plane.size(); ++o) frame.half_plane.push_back(static_cast<std::uint8_t>(half_plane(o)));
}

}  // namespace knap
