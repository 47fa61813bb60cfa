#include "output/vtk_series.hpp"

#include "base/checksum.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
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
#include <vtkSmartPointer.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <sstream>

namespace knap {
namespace {

using std::filesystem::path;
using Entries = std::vector<Index>;  // the points or cells of a frame that are written
using VtkArray = vtkSmartPointer<vtkDataArray>;

enum class Of { points, cells };

/// One array of a file: its documentation, how it is made from a frame, and how it is read into one.
struct Array {
    Output output;
    Of of;
    int n_components;
    VtkArray (*make)(const Frame&, const Entries&);  // null where the frame has no such values
    void (*read)(vtkDataArray*, Frame&) = nullptr;   // null: follows from other arrays
    bool optional = false;                           // not in every file
    int once_components = 0;                         // earlier versions wrote so many
};

/// An array of `n` tuples with the components value(i, j).
template <class Type, class Value>
VtkArray filled(std::size_t n, int n_components, Value value) {
    const auto array = vtkSmartPointer<Type>::New();
    array->SetNumberOfComponents(n_components);
    array->SetNumberOfTuples(static_cast<vtkIdType>(n));
    auto* out = array->GetPointer(0);
    for (std::size_t i = 0; i < n; ++i)
        for (int j = 0; j < n_components; ++j) *out++ = static_cast<typename Type::ValueType>(value(i, j));
    return array;
}

/// Component j of a number or vector; vectors in the plane have a third component 0 in VTK.
template <class Entry>
double component(const Entry& entry, int j) {
    if constexpr (requires { entry.size(); }) return j < entry.size() ? entry[j] : 0;
    else return static_cast<double>(entry);
}

template <class Type, int n_components, auto member>
VtkArray make(const Frame& frame, const Entries& entries) {
    if ((frame.*member).empty() && !entries.empty()) return nullptr;
    return filled<Type>(entries.size(), n_components,
                        [&](std::size_t i, int j) { return component((frame.*member)[entries[i]], j); });
}

template <class Entry>
void read_into(vtkDataArray* array, std::vector<Entry>& list) {
    list.resize(static_cast<std::size_t>(array->GetNumberOfTuples()));
    for (std::size_t i = 0; i < list.size(); ++i) {
        const double* tuple = array->GetTuple(static_cast<vtkIdType>(i));
        if constexpr (requires { list[i].size(); }) std::copy_n(tuple, list[i].size(), list[i].data());
        else list[i] = static_cast<Entry>(*tuple);
    }
}

/// An array that stores a member of a frame.
template <class Type, int n_components, auto member>
Array stored(Of of, std::string_view name, std::string_view unit, std::string_view doc, bool optional = false) {
    const auto read = [](vtkDataArray* array, Frame& frame) { read_into(array, frame.*member); };
    return {{name, unit, doc}, of, n_components, make<Type, n_components, member>, read, optional};
}

/// A number of every triangle that follows from its stress.
template <auto of>
VtkArray make_of_stress(const Frame& frame, const Entries& triangles) {
    return filled<vtkFloatArray>(triangles.size(), 1, [&](std::size_t i, int) { return of(frame, triangles[i]); });
}
double principal_stress(const Frame& frame, Index t) { return largest_principal(frame.stress[t]); }

/// Components of a stress in VTK's order, by their places in (xx, yy, xy, zz); 4: zero.
constexpr std::array stress_names{"xx", "yy", "zz", "xy", "yz", "zx"};
constexpr std::array stress_places{0, 1, 3, 2, 4, 4};

VtkArray make_stress(const Frame& frame, const Entries& triangles) {
    return filled<vtkFloatArray>(triangles.size(), 6, [&](std::size_t i, int j) {
        const int place = stress_places[j];
        return place < 3 ? frame.stress[triangles[i]][place] : place == 3 ? frame.stress_zz[triangles[i]] : 0;
    });
}

/// Earlier versions wrote (xx, yy, xy).
void read_stress(vtkDataArray* array, Frame& frame) {
    if (array->GetNumberOfComponents() == 3) return read_into(array, frame.stress);
    for (vtkIdType t = 0; t < array->GetNumberOfTuples(); ++t) {
        const double* s = array->GetTuple(t);
        frame.stress.emplace_back(s[0], s[1], s[3]);
        frame.stress_zz.push_back(s[2]);
    }
}

/// Mean displacement of the two sides, so that viewers can warp the interfaces like the body.
VtkArray make_mean_displacement(const Frame& frame, const Entries& points) {
    return filled<vtkFloatArray>(points.size(), 3, [&](std::size_t i, int j) {
        const Index p = points[i], a = frame.side_a[p / 2][p % 2], b = frame.side_b[p / 2][p % 2];
        return 0.5 *
               (component(frame.displacement[a < 0 ? b : a], j) + component(frame.displacement[b < 0 ? a : b], j));
    });
}

VtkArray make_sides(const Frame& frame, const Entries& points) {
    return filled<vtkTypeInt32Array>(points.size(), 2, [&](std::size_t i, int j) {
        const Index corner = (j == 0 ? frame.side_a : frame.side_b)[points[i] / 2][points[i] % 2];
        return corner < 0 || frame.node.empty() ? corner : frame.node[corner];
    });
}

/// Of the corners of a point the first one.
void read_sides(vtkDataArray* array, Frame& frame) {
    std::vector<Index> first_corner(frame.node.size(), -1);  // per point of the bulk
    for (auto c = static_cast<Index>(frame.node.size()) - 1; c >= 0; --c) first_corner[frame.node[c]] = c;
    const auto corner = [&](double point) { return point < 0 ? -1 : first_corner.at(static_cast<std::size_t>(point)); };
    const vtkIdType n_points = array->GetNumberOfTuples();
    frame.side_a.resize(n_points / 2), frame.side_b.resize(n_points / 2);
    for (vtkIdType p = 0; p < n_points; ++p) {
        frame.side_a[p / 2][p % 2] = corner(array->GetComponent(p, 0));
        frame.side_b[p / 2][p % 2] = corner(array->GetComponent(p, 1));
    }
}

/// One file of a frame: points, cells of consecutive points, arrays (those of points first).
struct FramePart {
    std::string name, doc;
    struct {
        std::vector<Vec2> Frame::*position;
        int cell_type;
        Index points_per_cell;
    } geometry;
    std::vector<Array> arrays;
};

using F = Frame;
using Float = vtkFloatArray;
using Int = vtkTypeInt32Array;
using Byte = vtkUnsignedCharArray;
using Double = vtkDoubleArray;

const std::vector<FramePart>& parts() {
    constexpr Of points = Of::points, cells = Of::cells;
    static const std::vector<FramePart> list{
        {"bulk",
         "arrays of fields/bulk_NNNN.vtu: the triangles; corners that nothing has parted are one point; points in m, "
         "undeformed; the field TimeValue is the time in s",
         {&F::position, VTK_TRIANGLE, 3},
         {stored<Float, 3, &F::displacement>(points, "displacement", "m", "displacement of a corner"),
          stored<Float, 3, &F::velocity>(points, "velocity", "m/s", "velocity of a corner"),
          stored<Float, 1, &F::temperature>(points, "temperature", "K", "temperature of a corner; only with heat",
                                            true),
          {{"stress", "Pa",
            "xx, yy, zz, xy, yz = 0, zx = 0, mean over a triangle; tension is positive; zz is 0 in plane stress and "
            "nu (xx + yy) - E a dT in plane strain"},
           cells,
           6,
           make_stress,
           read_stress,
           false,
           3},
          {{"principal_stress", "Pa", "largest principal stress of a triangle, in the plane"},
           cells,
           1,
           make_of_stress<principal_stress>},
          {{"von_mises", "Pa", "von Mises' stress of a triangle"}, cells, 1, make_of_stress<von_mises>},
          {{"max_shear", "Pa", "maximum shear stress: half of largest minus smallest of the three principal stresses"},
           cells,
           1,
           make_of_stress<max_shear>},
          stored<Int, 1, &F::region>(cells, "region", "",
                                     "number of the material of a triangle, in the order of `materials` of run.json"),
          stored<Int, 1, &F::grain>(cells, "grain", "", "number of the grain, -1: none; only where there are grains",
                                    true),
          stored<Float, 1, &F::layer_angle>(cells, "layer_angle", "deg",
                                            "angle of the layers to x; only where that of a bedding varies", true),
          stored<Int, 1, &F::piece_state>(cells, "piece_state", "",
                                          "0: its piece is deformable, 1: rigid, 2: asleep; with [rigid]", true),
          stored<Int, 1, &F::fragment>(
              cells, "fragment", "", "number of the fragment at this time, as in fragment_paths.csv; the heaviest is 0",
              true)}},
        {"interfaces",
         "arrays of fields/interfaces_NNNN.vtu: interfaces that are damaged, broken, pre-cracked or on a support, each "
         "with two points",
         {&F::end_position, VTK_LINE, 2},
         {stored<Float, 1, &F::cohesion>(points, "beta", "", "cohesion: 1 intact, 0 broken"),
          stored<Float, 1, &F::opening>(points, "opening", "m", "opening along the normal"),
          stored<Float, 1, &F::slip>(points, "slip", "m", "slip along the interface"),
          stored<Float, 2, &F::traction>(points, "traction", "Pa", "normal and tangential traction"),
          stored<Float, 1, &F::fluid>(
              points, "fluid_pressure", "Pa",
              "pressure of the fluids that have reached its faces, 0: dry; only with [[pressure]]", true),
          {{"displacement", "m", "mean displacement of the two sides"}, points, 3, make_mean_displacement},
          stored<Byte, 1, &F::status>(points, "status", "", "0 intact, 1 damaged, 2 broken, 3 pre-crack"),
          {{"sides", "", "numbers of the points on both sides in fields/bulk, -1: the support"},
           points,
           2,
           make_sides,
           read_sides}}},
        {"obstacles",
         "arrays of fields/obstacles_NNNN.vtu: the outlines of the obstacles as polygons",
         {&F::obstacle_position, VTK_POLYGON, n_outline_points},
         {stored<Double, 3, &F::obstacle_displacement>(points, "displacement", "m", "displacement of the outline"),
          stored<Byte, 1, &F::half_plane>(cells, "half_plane", "", "1: a half plane, of which a strip is drawn",
                                          true)}}};
    return list;
}

/// Corners of the part that are one node are one point.
bool shares_points(const FramePart& part, const Frame& frame) {
    return part.geometry.position == &F::position && !frame.node.empty();
}

/// Points that are written: of the bulk the first corner of each node, of interfaces only those that are not intact or
/// lie on a support.
Entries points_of(const FramePart& part, const Frame& frame) {
    Entries points;
    const bool shares = shares_points(part, frame);
    for (Index p = 0; p < static_cast<Index>((frame.*part.geometry.position).size()); ++p)
        if (!shares || frame.node[p] == static_cast<Index>(points.size())) points.push_back(p);
    if (part.geometry.position == &F::end_position)
        std::erase_if(points, [&](Index p) {
            return frame.status_of_interface(p / 2) == InterfaceStatus::intact && !frame.on_support(p / 2);
        });
    return points;
}

/// The first object that VTK makes initialises data that all threads share, so one thread makes it before any other
/// writes. VTK prints its errors, each several times; from here on it does not, since this file throws them.
void prepare_vtk() {
    vtkObject::GlobalWarningDisplayOff();
    const vtkNew<vtkUnstructuredGrid> first;
}

vtkFieldData* data_of(vtkUnstructuredGrid* grid, Of of) {
    return of == Of::points ? static_cast<vtkFieldData*>(grid->GetPointData()) : grid->GetCellData();
}

constexpr std::size_t min_raw_points = 100;  // a grid of fewer is not written raw (below)

/// Returns the checksum of the file.
std::uint64_t write_part(const FramePart& part, const Frame& frame, Compression compression, const path& file) {
    const Entries points = points_of(part, frame);
    const bool is_outline = part.geometry.position == &F::obstacle_position;
    const Index n = is_outline ? frame.n_outline() : part.geometry.points_per_cell;
    const bool shares = shares_points(part, frame);
    const std::size_t n_corners = shares ? frame.node.size() : points.size();
    Entries cells(n_corners / n);
    std::iota(cells.begin(), cells.end(), 0);
    vtkNew<vtkUnstructuredGrid> grid;
    vtkNew<vtkPoints> positions;
    positions->SetData(filled<vtkDoubleArray>(points.size(), 3, [&](std::size_t i, int j) {
        return component((frame.*part.geometry.position)[points[i]], j);
    }));
    grid->SetPoints(positions);
    vtkNew<vtkCellArray> connectivity;
    // meshio reads no grid without cells: interfaces that are all intact are a polygon without points
    const bool none = points.empty() && part.geometry.cell_type == VTK_LINE;
    connectivity->SetData(
        filled<Int>(none ? 2 : cells.size() + 1, 1, [&](std::size_t i, int) { return none ? 0 : n * i; }),
        filled<Int>(n_corners, 1, [&](std::size_t i, int) { return shares ? frame.node[i] : static_cast<Index>(i); }));
    grid->SetCells(none ? VTK_POLYGON : part.geometry.cell_type, connectivity);
    for (const Array& array : part.arrays) {
        const VtkArray made = array.make(frame, array.of == Of::points ? points : cells);
        if (!made) continue;
        made->SetName(std::string(array.output.name).c_str());
        if (array.output.name == "stress")
            for (int j = 0; j < 6; ++j) made->SetComponentName(j, stress_names[j]);
        if (const std::string unit(unit_of_temperature(array.output.unit, frame.celsius)); !unit.empty())
            made->GetInformation()->Set(vtkDataArray::UNITS_LABEL(), unit.c_str());
        data_of(grid, array.of)->AddArray(made);
    }
    vtkNew<vtkDoubleArray> time;
    time->SetName("TimeValue");  // the name that ParaView looks for
    time->InsertNextValue(frame.time);
    grid->GetFieldData()->AddArray(time);
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetInputData(grid);
    writer->SetDataModeToAppended();
    // In a raw file meshio changes offsets while it looks for them, and takes one of a few bytes for another.
    const bool is_small = points.size() < min_raw_points;
    writer->SetEncodeAppendedData(is_small);
    switch (is_small ? Compression::none : compression) {
        case Compression::none: writer->SetCompressorTypeToNone(); break;
        case Compression::lz4: writer->SetCompressorTypeToLZ4(); break;
        case Compression::zlib: writer->SetCompressorTypeToZLib(), writer->SetCompressionLevel(1);
    }
    writer->WriteToOutputStringOn();  // VTK does not look whether the system takes the last bytes
    if (writer->Write() == 0 || writer->GetErrorCode() != vtkErrorCode::NoError)
        throw OutputError("cannot make " + file.string() + ": " +
                          vtkErrorCode::GetStringFromErrorCode(writer->GetErrorCode()));
    const std::string bytes = writer->GetOutputString();
    write_whole_file(file, bytes);
    return checksum(bytes);
}

/// By the end of a file of VTK, which reads half a file without an error.
std::string fault_of(const path& file) { return fault_of_end(file, "</VTKFile>"); }

constexpr const char* cure_of_damage =
    "`knap run` of its scenario with --force computes the run again and writes all files; the others can be used";

void read_part(const FramePart& part, const path& file, Frame& frame) {
    const auto fail = [&](const std::string& problem) {
        throw UserError("damaged-file", "`" + file.string() + "` " + problem, cure_of_damage);
    };
    prepare_vtk();
    if (!std::filesystem::is_regular_file(file))
        throw UserError("missing-file", "there is no file `" + file.string() + "`", cure_of_damage);
    if (const std::string fault = fault_of(file); !fault.empty()) fail(fault);
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    reader->SetFileName(file.string().c_str());
    reader->Update();
    if (reader->GetErrorCode() != vtkErrorCode::NoError) fail("cannot be read");
    vtkUnstructuredGrid* grid = reader->GetOutput();
    vtkDataArray* time = grid->GetFieldData()->GetArray("TimeValue");
    if (!time || time->GetNumberOfTuples() == 0) fail("has no time");
    frame.time = time->GetComponent(0, 0);
    vtkDataArray* const corners = grid->GetCells()->GetConnectivityArray();
    const auto of_corners = [&](vtkDataArray* of_points) {
        const auto list = vtkSmartPointer<vtkDataArray>::Take(of_points->NewInstance());
        list->SetNumberOfComponents(of_points->GetNumberOfComponents());
        list->SetNumberOfTuples(corners->GetNumberOfTuples());
        for (vtkIdType c = 0; c < corners->GetNumberOfTuples(); ++c) {
            const auto point = static_cast<vtkIdType>(corners->GetComponent(c, 0));
            if (point < 0 || point >= of_points->GetNumberOfTuples()) fail("has a corner without a point");
            list->SetTuple(c, point, of_points);
        }
        return list;
    };
    if (part.geometry.position == &F::position) read_into(corners, frame.node);
    if (grid->GetNumberOfPoints() > 0)
        read_into(of_corners(grid->GetPoints()->GetData()), frame.*part.geometry.position);
    for (const Array& array : part.arrays) {
        const std::string name(array.output.name);
        vtkDataArray* found = data_of(grid, array.of)->GetArray(name.c_str());
        if (!array.read || (!found && array.optional)) continue;
        if (!found || (found->GetNumberOfComponents() != array.n_components &&
                       found->GetNumberOfComponents() != array.once_components))
            fail("has no array `" + name + "` of " + std::to_string(array.n_components) + " components");
        array.read(array.of == Of::points ? of_corners(found).Get() : found, frame);
        const char* const unit = found->GetInformation()->Get(vtkDataArray::UNITS_LABEL());
        if (array.output.unit == "K") frame.celsius = unit && std::string_view(unit) == "C";
    }
}

std::string file_of(const FramePart& part, std::size_t frame) {
    const std::string number = std::to_string(frame);
    return "fields/" + part.name + "_" + std::string(4 - std::min<std::size_t>(number.size(), 4), '0') + number +
           ".vtu";
}

/// The parts of every frame; the outlines only where there are obstacles.
std::span<const FramePart> parts_with(bool obstacles) { return std::span(parts()).first(obstacles ? 3 : 2); }

void write_collection(const path& run, const std::vector<double>& times, bool obstacles) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  "
        "<Collection>\n";
    for (std::size_t i = 0; i < times.size(); ++i)
        for (const FramePart& part : parts_with(obstacles))
            text += "    <DataSet timestep=\"" + shortest(times[i] + 0.0) + "\" part=\"" +
                    std::to_string(&part - parts().data()) + "\" file=\"" + file_of(part, i) + "\"/>\n";
    write_whole_file(run / "run.pvd", text + "  </Collection>\n</VTKFile>\n");
}

}  // namespace

const std::vector<OutputTable>& frame_outputs() {
    static const std::vector<OutputTable> tables = [] {
        std::vector<OutputTable> tables;
        for (const FramePart& part : parts()) {
            OutputTable& table = tables.emplace_back(OutputTable{"fields/" + part.name, part.doc, {}});
            for (const Array& array : part.arrays) table.rows.push_back(array.output);
        }
        return tables;
    }();
    return tables;
}

VtkSeries::VtkSeries(path run, std::vector<double> written, std::vector<Sums> sums, Compression compression)
    : run_(std::move(run)), times_(std::move(written)), sums_(std::move(sums)), compression_(compression) {
    prepare_vtk();
    std::error_code error;
    std::filesystem::create_directories(run_ / "fields", error);
    if (error) throw OutputError("cannot make " + (run_ / "fields").string() + ": " + error.message());
    for (const path& file : std::filesystem::directory_iterator(run_ / "fields", error))
        if (file.string().ends_with(".vtu.part")) std::filesystem::remove(file, error);
    for (std::size_t i = 0; i < sums_.size(); ++i)
        for (std::size_t k = 0; k < parts().size(); ++k)
            if (const path file = run_ / file_of(parts()[k], i); fault_of(file).empty())
                faults_[file_of(parts()[k], i)] = fault_of_bytes(file, sums_[i][k]);
}

std::string VtkSeries::fault_of_file(const std::string& name) const {
    const auto found = faults_.find(name);
    return found != faults_.end() && !found->second.empty() ? found->second : fault_of(run_ / name);
}

void VtkSeries::write(const Frame& frame) {
    const bool obstacles = frame.n_obstacles() > 0;
    Sums sums{};
    for (std::size_t k = 0; k < parts_with(obstacles).size(); ++k)
        sums[k] = write_part(parts()[k], frame, compression_, run_ / file_of(parts()[k], times_.size()));
    times_.push_back(frame.time), sums_.push_back(sums);
    write_collection(run_, times_, obstacles);
}

void VtkSeries::list(bool obstacles) const {
    if (!times_.empty()) write_collection(run_, times_, obstacles);
}

void VtkSeries::flush() {
    std::error_code none;
    for (; n_flushed_ < times_.size(); ++n_flushed_)
        for (const FramePart& part : parts())
            if (const path file = run_ / file_of(part, n_flushed_); std::filesystem::exists(file, none))
                flush_to_disk(file);
    for (const path& named : {run_ / "run.pvd", run_ / "fields"})
        if (std::filesystem::exists(named, none)) flush_to_disk(named);
}

bool VtkSeries::has(std::size_t frame) const {
    return std::ranges::all_of(parts_with(false),
                               [&](const FramePart& part) { return fault_of_file(file_of(part, frame)).empty(); });
}

std::vector<std::string> VtkSeries::missing(bool obstacles) const {
    std::vector<std::string> files;
    for (std::size_t i = 0; i < times_.size(); ++i)
        for (const FramePart& part : parts_with(obstacles))
            if (const std::string fault = fault_of_file(file_of(part, i)); !fault.empty())
                files.push_back(file_of(part, i) + " " + fault);
    return files;
}

std::vector<double> frame_times(const path& run) {
    const path file = run / "run.pvd";
    std::istringstream in(read_given_file(file, "missing-file"));
    if (const std::string fault = fault_of(file); !fault.empty())
        throw UserError("damaged-file", "`" + file.string() + "` " + fault, cure_of_damage);
    std::vector<double> times;
    const std::string key = "timestep=\"";
    for (std::string line; std::getline(in, line);) {
        const std::size_t at = line.find(key);
        if (at == std::string::npos || line.find("part=\"0\"") == std::string::npos) continue;
        if (std::from_chars(line.data() + at + key.size(), line.data() + line.size(), times.emplace_back()).ec !=
            std::errc())
            throw UserError("damaged-file", "`" + file.string() + "`: a time is not a number");
    }
    return times;
}

Frame read_frame(const path& run, std::size_t index) {
    Frame frame;
    for (const FramePart& part : parts())
        if (const path file = run / file_of(part, index); &part != &parts()[2] || std::filesystem::exists(file))
            read_part(part, file, frame);
    frame.length_scale = diagonal(frame.position);
    return frame;
}

std::size_t nearest_frame(const std::vector<double>& times, double time) {
    const auto distance = [&](double other) { return std::abs(other - time); };
    return static_cast<std::size_t>(std::ranges::min_element(times, {}, distance) - times.begin());
}

}  // namespace knap
