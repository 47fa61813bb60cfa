#include "scenario/exclusions.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace knap {

std::span<const Exclusion> exclusions() {
    static constexpr Exclusion rows[] = {
        {"rotation = \"large\"", "mesh.order = 2",
         "the frame of an interface is that of two triangles with straight sides and uniform strain, and sides of "
         "second order turn differently from point to point"},
        {"[contact]", "cohesion = \"implicit\"",
         "contacts between free faces join vertices, and the iteration for the cohesion at the end of a step is one of "
         "a single vertex"},
        {"cohesion", "bulk = \"auto\"", "implicit steps have the implicit cohesion, explicit ones the explicit"},
        {"mass = \"consistent\"", "bulk = \"auto\"",
         "both schemes share one mass matrix, and that of explicit steps is lumped"},
        {"bulk_viscosity", "bulk = \"implicit\"",
         "it acts on waves of the length of a triangle, which implicit steps do not resolve (theta above 0.5 damps "
         "them)"},
        {"mass_scaling", "bulk = \"implicit\"", "its steps have any size, and no triangle limits them"},
        {"[adapt]", "mass_scaling",
         "the step is that of the finest triangles that may be made, and what limits it is replaced"},
        {"R_N", "bulk = \"implicit\"",
         "the surface gives way as the piece comes to rest and flies back, and a step is longer than that lasts"},
        {"R_N", "bulk = \"auto\"",
         "the surface gives way as the piece comes to rest and flies back, and an implicit step is longer than that "
         "lasts"},
        {"incubation_time", "bulk = \"implicit\"", "a step may be longer than the overload lasts"},
        {"plateau = 1", "cohesion = \"implicit\"",
         "the traction drops from the strength to 0 at once, and an implicit cohesion needs a slope"},
        {"plateau = 1", "bulk = \"auto\"",
         "the traction drops from the strength to 0 at once, and the implicit cohesion of its steps needs a slope"},
        {"plateau = 1", "relaxation_time", "it continues the last piece of the softening, which has no slope"},
        {"coupling = \"norm\"", "coupling = \"sum\"",
         "a vertex has one problem for all its points, with the projections of the norm or the staircases of the sum"},
        {"coupling = \"norm\"", "gamma = 0", "slip would cost nothing, and its direction at zero opening is unknown"},
        {"coupling = \"norm\"", "plateau = 1",
         "the traction drops from the strength to 0 while its direction may turn at the same opening"},
        {"coupling = \"norm\"", "incubation_time",
         "the overload is measured by the half planes of the strength of the sum, and a half ellipse has none"},
        {"coupling = \"norm\"", "unloading = \"vertical\"",
         "at the largest opening, an ellipse of the norm, the traction has any size and a direction that turns with "
         "the opening, and its projection knows such a set at zero opening alone"},
        {"coupling = \"norm\"", "G_II in steps of implicit bulk and cohesion",
         "the traction of steps of implicit bulk and cohesion (bulk = \"auto\" has them) is the gradient of the size "
         "of the opening, and a cohesion that follows its direction, too, leaves it no potential"},
        {"slip_distance", "friction_table",
         "each of them is the friction, over the slip and over the temperature, and together they would be a table of "
         "both"},
        {"slip_distance", "friction_over_pressure",
         "each of them is the friction, over the slip and over the pressure, and together they would be a table of "
         "both"},
        {"scatter", "strength = \"as measured\"", "the measured strength is one number"},
        {"strength_over_bedding", "strength = \"as measured\"",
         "the measured strength is one number, for all directions"},
        {"incubation_time", "strength = \"as measured\"", "the measured strength is one number, for all rates"},
        {"[[body]]", "mesh.file", "each of them defines the bodies (a file may have several, which share no nodes)"},
        {"[[joints]]", "mesh.file",
         "traces cut the shape before it is meshed, and the mesh of a file is given; [[mesh.joint]] makes its curves "
         "joints"},
        {"[[traces]]", "mesh.file",
         "traces cut the shape before it is meshed, and the mesh of a file is given; [[mesh.joint]] makes its curves "
         "joints"},
        {"[[inclusions]]", "mesh.file", "they cut the shape before it is meshed, and the mesh of a file is given"},
        {"[rigid]", "[heat] that changes",
         "such temperatures go on straining a piece, and a rigid one has no strains of its own"},
        {"[rigid]", "[[pressure]]", "a fluid opens cracks without any contact, and a rigid piece has no stresses"},
        {"[[pressure]] rate", "[contact]",
         "faces that part from each other would let a volume of the fluid escape that nobody "
         "knows"},
        {"[[pressure]] rate", "[[excavation]]", "the fluid would flow out of the cracks that the excavation cuts"},
        {"[[pressure]] rate", "start = \"run:DIR@TIME\"",
         "time counts from 0 again, and so does the volume that has entered"},
        {"[rigid]", "[[initial]] stress", "it opens cracks without any contact, and a rigid piece has no stresses"},
        {"[rigid]", "[[excavation]]", "the forces that fade stress what stays, and a rigid piece has no stresses"},
        {"[rigid]", "[[absorb]]", "waves that leave the body are those of a deformable one"},
        {"[rigid]", "[specimen]", "its gauges and its stress are those of a body under load, which is not rigid"},
        {"[rigid]", "a probe of stress", "a rigid piece has no stresses"},
        {"[rigid]", "friction_over_pressure",
         "a rigid piece bears on corners, and nobody knows the pressure of its faces"},
        {"[rigid]", "unloading = \"vertical\"",
         "at its largest opening a damaged point bears what the stresses ask for, and a rigid piece has no stresses"},
        {"[rigid]", "incubation_time", "its memory follows the stress at every time, and a rigid piece has none"},
        {"[adapt]", "bulk = \"implicit\"",
         "a vertex that splits in large triangles rejects the step, and large steps split many"},
        {"[adapt]", "bulk = \"auto\"",
         "a vertex that splits in large triangles rejects the step, and large steps split many"},
        {"[adapt]", "mesh.order = 2", "fields go over to the new mesh as linear ones"},
        {"[adapt]", "rotation = \"large\"", "momentum and energy go over in the undeformed body"},
        {"[adapt]", "[[excavation]]", "triangles that vanished keep their numbers, and a new mesh has others"},
        {"[adapt]", "scatter without a correlation",
         "a new interface would draw its strength anew; with a `correlation` it has a place"},
        {"[adapt]", "bedding.angle by place",
         "a finer triangle would have layers of another direction, and the energy of its stress would change"},
        {"[adapt]", "[[collector]]", "the pieces that it follows are sets of triangles, and these are replaced"},
        {"[adapt]", "a probe of an interface or of a tip", "the edges that it watches are replaced"},
    };
    return rows;
}

std::string_view reason_against(std::string_view one, std::string_view other) {
    const auto found = std::ranges::find_if(exclusions(), [&](const Exclusion& row) {
        return (row.one == one && row.other == other) || (row.one == other && row.other == one);
    });
    if (found == exclusions().end())
        throw std::logic_error("no reason against " + std::string(one) + " with " + std::string(other));
    return found->because;
}

}  // namespace knap
