"""Meshes and pictures of others, as knap reads them.

    import knap_convert as convert
    convert.mesh("specimen.inp", "specimen.msh")                  # mesh.file; anything that meshio reads
    convert.picture("section.tif", "section.png", colours=6)      # [[map]]; anything that Pillow reads

The command is `knap-convert IN OUT`. Quadrangles are cut along the diagonal that leaves the better triangles, elements
of second order keep their corners. Element sets (*ELSET, physical surfaces) become surfaces and node sets (*NSET) the
boundaries whose edges have both nodes in them; what stays without a set is a surface without a name (mesh.material).
Meshes need meshio, pictures Pillow (Debian: python3-meshio, python3-pil).
"""
import argparse
import importlib
import pathlib
import sys

import knap
import numpy as np

CORNERS = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}
LINES = ("line", "line3")
PLANE = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8"}  # of Abaqus, by nodes


def _needed(module, package):
    try:
        return __import__(module)
    except ImportError:
        raise knap.KnapError(f"this python3 has no {module} (Debian: {package}; pip: {module})") from None


# ---- meshes

def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _flatness(p):
    """Area over the square of the longest side, of triangles [n, 3, 2]."""
    longest = np.max([((p[:, k] - p[:, (k + 1) % 3]) ** 2).sum(axis=1) for k in range(3)], axis=0)
    return 0.5 * _cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) / longest


def cut(quads, points):
    """Two triangles for each quadrangle, along the diagonal whose worse triangle is the better one."""
    quads = np.asarray(quads)
    turned = 0.5 * sum(_cross(points[quads[:, k]], points[quads[:, (k + 1) % 4]]) for k in range(4)) < 0
    quads = np.where(turned[:, None], quads[:, ::-1], quads)
    ways = [np.stack([quads[:, a], quads[:, b]], axis=1) for a, b in (([0, 1, 2], [0, 2, 3]), ([0, 1, 3], [1, 2, 3]))]
    worst = [np.minimum(_flatness(points[w[:, 0]]), _flatness(points[w[:, 1]])) for w in ways]
    best = np.where((worst[1] > worst[0])[:, None, None], ways[1], ways[0])
    flat = np.flatnonzero(np.maximum(*worst) <= 0)
    if len(flat):
        raise knap.KnapError(f"a quadrangle of the nodes {', '.join(str(n + 1) for n in quads[flat[0]])} is no convex or concave "
                             "polygon: its sides cross")
    return best.reshape(-1, 3)


def mesh(source, target):
    """Writes a Gmsh file (.msh 2.2); returns the numbers of triangles and of quadrangles that were cut."""
    meshio = _needed("meshio", "python3-meshio")
    known = importlib.import_module("meshio.abaqus._abaqus").abaqus_to_meshio_type
    for model in ("CPE", "CPS", "CAX", "CPEG"):  # plane elements, which meshio does not name
        for nodes, kind in PLANE.items():
            for ending in ("", "R", "H", "RH", "I", "IH", "M", "MH", "T", "RT"):
                known.setdefault(f"{model}{nodes}{ending}", kind)
    try:
        read = meshio.read(source)
    except (meshio.ReadError, KeyError, ValueError, IndexError, SystemExit) as error:
        raise knap.KnapError(f"{source}: meshio cannot read it: {error}") from None
    points = np.asarray(read.points, float)
    if points.shape[1] > 2 and np.ptp(points[:, 2]) > 1e-8 * np.ptp(points, axis=0).max():
        raise knap.KnapError(f"{source}: the mesh does not lie in a plane z = const")
    points = points[:, :2]
    sets = {name: [np.asarray([] if part is None else part, int) for part in parts]
            for name, parts in read.cell_sets.items() if not name.startswith("gmsh:")}
    named = read.cell_data.get("gmsh:physical")
    names = {tuple(tag): name for name, tag in read.field_data.items()}
    triangles, surface, lines, curve, n_cut = [], [], [], [], 0
    for b, block in enumerate(read.cells):
        n = len(block.data)
        label = np.full(n, "", object)
        for name, parts in sets.items():
            label[parts[b]] = name
        if named is not None:
            dimension = 1 if block.type in LINES else 2
            label = np.array([names.get((tag, dimension), f"group{tag}" if tag else "") for tag in named[b]], object)
        if block.type in LINES:
            lines += [block.data[:, :2]]
            curve += [label]
        elif block.type in CORNERS:
            corners = block.data[:, :CORNERS[block.type]]
            if CORNERS[block.type] == 4:
                corners, label, n_cut = cut(corners, points), np.repeat(label, 2), n_cut + n
            triangles += [corners]
            surface += [label]
        elif block.type != "vertex":
            raise knap.KnapError(f"{source}: it has elements of the type {block.type}, and a plane mesh has triangles and quadrangles")
    if not triangles:
        raise knap.KnapError(f"{source}: it has no triangles and no quadrangles")
    triangles, surface = np.concatenate(triangles), np.concatenate(surface)
    ends, owner = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0, return_counts=True)
    boundary = ends[owner == 1]
    for name, nodes in read.point_sets.items():
        inside = np.zeros(len(points), bool)
        inside[np.asarray(nodes, int)] = True
        chosen = boundary[inside[boundary].all(axis=1)]
        lines, curve = lines + [chosen], curve + [np.full(len(chosen), name, object)]
    lines = np.concatenate(lines) if lines else np.zeros((0, 2), int)
    curve = np.concatenate(curve) if curve else np.zeros(0, object)
    _write_msh(target, points, triangles, surface, lines, curve)
    return len(triangles), n_cut


def _write_msh(target, points, triangles, surface, lines, curve):
    tags = {1: {}, 2: {}}
    for dimension, labels in ((1, curve), (2, surface)):
        for name in labels:
            if name:
                tags[dimension].setdefault(name, len(tags[1]) + len(tags[2]) + 1)
    used = np.unique(triangles)
    with open(target, "w", encoding="utf-8", newline="\n") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n")
        out.write(f"{len(tags[1]) + len(tags[2])}\n")
        for dimension, named in tags.items():
            out.writelines(f'{dimension} {tag} "{name}"\n' for name, tag in named.items())
        out.write(f"$EndPhysicalNames\n$Nodes\n{len(used)}\n")
        out.writelines(f"{n + 1} {points[n, 0]!r} {points[n, 1]!r} 0\n" for n in used)
        out.write(f"$EndNodes\n$Elements\n{len(lines) + len(triangles)}\n")
        number = 0
        for kind, labels, dimension, elements in ((1, curve, 1, lines), (2, surface, 2, triangles)):
            for name, nodes in zip(labels, elements):
                number += 1
                tag = tags[dimension].get(name, 0)
                out.write(f"{number} {kind} 2 {tag} {tag} {' '.join(str(n + 1) for n in nodes)}\n")
        out.write("$EndElements\n")


# ---- pictures

def picture(source, target, colours=None, width=None):
    """Writes a PNG file; `colours`: as many as this, the most frequent ones, without mixtures between them; `width`
    [pixel]: reduced to it. Returns the colours as "#rrggbb", the most frequent first."""
    Image = _needed("PIL.Image", "python3-pil").Image
    try:
        image = Image.open(source)
        image.load()
    except (OSError, SyntaxError) as error:
        raise knap.KnapError(f"{source}: Pillow cannot read it: {error}") from None
    if image.mode in ("I;16", "I", "F"):  # depths above 8 bits: the range that the picture has
        grey = np.asarray(image, float)
        low, high = grey.min(), grey.max()
        image = Image.fromarray(np.uint8(np.round(255 * (grey - low) / max(high - low, 1e-300))))
    image = image.convert("RGB")
    if width and width < image.width:
        image = image.resize((width, round(image.height * width / image.width)), Image.NEAREST if colours is None else Image.BOX)
    if colours:
        image = image.quantize(colours, method=Image.MEDIANCUT, kmeans=3, dither=Image.NONE).convert("RGB")
    image.save(target, "PNG")
    found = sorted(image.getcolors(image.width * image.height), key=lambda c: (-c[0], c[1]))
    return ["#%02x%02x%02x" % rgb for _, rgb in found]


def command():
    """knap-convert"""
    parser = argparse.ArgumentParser(prog="knap-convert", description="Meshes (Abaqus .inp and others) to .msh for mesh.file, pictures (TIFF, JPEG) to .png for [[map]].")
    parser.add_argument("source")
    parser.add_argument("target", help=".msh or .png")
    parser.add_argument("--colours", type=int, help="of a picture: so many, without mixtures at borders")
    parser.add_argument("--width", type=int, help="of a picture, in pixels: reduced to it")
    options = parser.parse_args()
    ending = pathlib.Path(options.target).suffix
    try:
        if ending == ".png":
            found = picture(options.source, options.target, options.colours, options.width)
            print(f"{options.target}: {len(found)} colours: {' '.join(found[:12])}{' ...' if len(found) > 12 else ''}")
        elif ending == ".msh":
            n, n_cut = mesh(options.source, options.target)
            print(f"{options.target}: {n} triangles" + (f", of {n_cut} quadrangles" if n_cut else ""))
        else:
            raise knap.KnapError(f"`{options.target}` ends neither in .msh nor in .png")
    except (knap.KnapError, OSError) as error:
        sys.exit(f"knap-convert: {error}")


if __name__ == "__main__":
    command()
