"""Meshes and pictures of others, as knap reads them.

    import knap_convert as convert
    convert.mesh("specimen.inp", "specimen.msh")                  # mesh.file; anything that meshio reads
    convert.picture("section.tif", "section.png", colours=6)      # [[map]]; anything that Pillow reads

The command is `knap-convert IN OUT`. Quadrangles are cut along the diagonal that leaves the better triangles, elements of second order keep
their corners. Element sets become surfaces: where sets lie in others the finest that partition the elements, each with the name of the
material that a *SOLID SECTION gives it, else its own. Node sets (*NSET) become the boundaries whose edges have both nodes in them; what
stays without a set is a surface without a name (mesh.material). What is left out is said on stderr. Meshes other than Abaqus need meshio,
pictures Pillow (Debian: python3-meshio, python3-pil).
"""
import argparse
import collections
import pathlib
import re
import types

import knap
import numpy as np

CORNERS = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}
LINES = ("line", "line3")
PLANE = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"}  # of Abaqus, by nodes
MOST_COLOURS = 64  # of a picture whose colours are materials


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


def _abaqus_lines(file):
    """Where, keyword with its parameters (None: data) and cells of the lines of a file and of those that it includes."""
    keyword = ""
    with open(file, encoding="utf-8", errors="replace") as lines:
        for number, line in enumerate(lines, 1):
            line = line.strip()
            if not line or line.startswith("**"):
                continue
            if not line.startswith("*") and not keyword:
                yield f"{file}:{number}", None, [cell.strip() for cell in line.rstrip(",").split(",")]
                continue
            keyword += line
            if line.endswith(","):  # goes on
                continue
            name, *parts = keyword[1:].split(",")
            keyword, name = "", " ".join(name.split()).upper()
            pairs = [part.partition("=") for part in parts]
            options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
            if name == "INCLUDE":
                yield from _abaqus_lines(pathlib.Path(file).parent / options.get("INPUT", ""))
            else:
                yield f"{file}:{number}", name, options


def _abaqus(source):
    """Nodes, elements and sets of an .inp file, as meshio has them, and `materials`: that of a set."""
    points, number_of, blocks, place_of = [], {}, [], {}  # place_of an element: block and row
    sets, spelled, materials, ignored = {"NSET": {}, "ELSET": {}}, {}, {}, collections.Counter()

    def named(kind, name):
        """Names do not depend on the case; the first spelling counts."""
        return sets[kind].setdefault(spelled.setdefault((kind, name.rpartition(".")[2].upper()), name.rpartition(".")[2]), [])

    name, options, cells, n_nodes, where = "", {}, [], 0, ""
    for where, keyword, content in _abaqus_lines(source):
        def fail(problem):
            raise knap.KnapError(f"{where}: {problem}")

        if keyword is not None:
            if cells:
                fail("the element before this line has too few nodes")
            name, options = keyword, content
            if name in ("NGEN", "NFILL", "NCOPY", "ELGEN", "ELCOPY"):
                fail(f"*{name} makes nodes or elements: write the file with all of them")
            if name == "ELEMENT":
                kind = options.get("TYPE", "").upper()
                if plane := re.match(r"(?:CPEG|CPE|CPS|CAX|STRI|S|M3D|DC2D)([34689])", kind):
                    n_nodes, shape = int(plane[1]), PLANE[int(plane[1])]
                elif line := re.match(r"T[23]D([23])|B[23]([123])", kind):
                    n_nodes = 3 if line[1] == "3" or line[2] == "2" else 2
                    shape = "line3" if n_nodes == 3 else "line"
                else:
                    fail(f"the element type {kind} is none of a plane mesh, which has triangles and quadrangles")
                blocks.append((shape, []))
            elif name == "SOLID SECTION" and options.get("MATERIAL"):
                materials[options.get("ELSET", "").rpartition(".")[2].upper()] = options["MATERIAL"]
            elif name not in ("HEADING", "PREPRINT", "NODE", "NSET", "ELSET", "PART", "ASSEMBLY", "INSTANCE", "SOLID SECTION") and not name.startswith("END "):
                ignored[f"*{name}"] += 1
            continue
        try:
            if name == "NODE":
                node = int(content[0])
                if node in number_of:
                    fail(f"node {node} is there before: knap-convert reads one part")
                number_of[node] = len(points)
                points.append([float(cell or 0) for cell in (content[1:4] + ["0", "0"])[:3]])
                if "NSET" in options:
                    named("NSET", options["NSET"]).append(node)
            elif name == "ELEMENT":
                cells += [int(cell) for cell in content]
                if len(cells) < n_nodes + 1:
                    continue
                if len(cells) > n_nodes + 1:
                    fail(f"element {cells[0]} has {len(cells) - 1} nodes instead of {n_nodes}")
                unknown = [node for node in cells[1:] if node not in number_of]
                if unknown:
                    fail(f"element {cells[0]} has the node {unknown[0]}, which the file does not have before this line")
                if cells[0] in place_of:
                    fail(f"element {cells[0]} is there before: knap-convert reads one part")
                place_of[cells[0]] = (len(blocks) - 1, len(blocks[-1][1]))
                blocks[-1][1].append([number_of[node] for node in cells[1:]])
                if "ELSET" in options:
                    named("ELSET", options["ELSET"]).append(cells[0])
                cells = []
            elif name in ("NSET", "ELSET"):
                own = named(name, options.get(name, ""))
                if "GENERATE" in options:
                    first, last, step = [*map(int, content), 1][:3]
                    own += range(first, last + 1, step)
                    continue
                for cell in filter(None, content):
                    if cell.isdigit():
                        own.append(int(cell))
                    elif (name, cell.rpartition(".")[2].upper()) in spelled:
                        own += list(named(name, cell))
                    else:
                        fail(f"there is no set {cell} before this line")
            elif name == "INSTANCE":
                ignored["place of an *INSTANCE"] += 1
        except ValueError:
            fail(f"this is no line of *{name}: a cell is not a number")
    if cells:
        raise knap.KnapError(f"{where}: the last element has too few nodes")
    if ignored:
        knap.note(f"{source}: left out: {', '.join(f'{n} {what}' for what, n in sorted(ignored.items()))}; the scenario has materials, loads and contacts")
    cell_sets = {}
    for set_name, elements in sets["ELSET"].items():
        rows = [[] for _ in blocks]
        for element in dict.fromkeys(elements):
            if element in place_of:
                rows[place_of[element][0]].append(place_of[element][1])
        cell_sets[set_name] = rows
    return types.SimpleNamespace(
        points=np.array(points, float).reshape(-1, 3), cells=[types.SimpleNamespace(type=shape, data=np.array(rows, int)) for shape, rows in blocks if rows],
        cell_sets={set_name: [part for part, (_, rows) in zip(parts, blocks) if rows] for set_name, parts in cell_sets.items()},
        point_sets={set_name: [number_of[node] for node in nodes if node in number_of] for set_name, nodes in sets["NSET"].items()},
        cell_data={}, field_data={}, materials={spelled[("ELSET", key)]: material for key, material in materials.items() if ("ELSET", key) in spelled})


def partition(sets, n):
    """Number of the set of each of n elements, -1 without one: of the finest sets that partition what they cover. `sets`: lists of elements."""
    sets = [np.unique(np.asarray(elements, int)) for elements in sets]
    order = sorted({elements.tobytes(): k for k, elements in reversed(list(enumerate(sets))) if len(elements)}.values(), key=lambda k: (len(sets[k]), k))
    owner = np.full(n, -1)
    for k in order:
        if (owner[sets[k]] < 0).all():
            owner[sets[k]] = k
    if all((owner[sets[k]] >= 0).all() for k in order):
        return owner

    def split(elements, inside, own):
        """Divides elements among the largest sets inside, where these have all of them, and so on."""
        owner[elements] = -1
        below = {}
        for k in inside:
            before = owner[sets[k]]
            if (before < 0).any():
                owner[sets[k][before < 0]] = k
                below[k] = []
            elif (before == before[0]).all():
                below[before[0]].append(k)
        if own is not None and (owner[elements] < 0).any():
            owner[elements] = own
            return
        for k, finer in below.items():
            split(np.flatnonzero(owner == k), finer, k)

    split(np.arange(n), order[::-1], None)
    return owner


def _labels_of_sets(source, sets, materials, n):
    """Name and number of the surface of each element."""
    own, names = partition(sets.values(), n), list(sets)
    label = np.array([materials.get(names[k], names[k]) if k >= 0 else "" for k in own], object)
    for name, elements in sets.items():  # a section may also be of a coarser set
        if name in materials:
            bare = np.asarray(elements, int)[[names[own[e]] not in materials for e in elements]] if len(elements) else []
            label[bare] = materials[name]
    used = set(own[own >= 0])
    unused = [name for k, name in enumerate(names) if k not in used and len(sets[name]) and name not in materials]
    if unused:
        knap.note(f"{source}: without a surface of their own: the sets {', '.join(unused[:12])}{' ...' if len(unused) > 12 else ''}; others divide the elements")
    return label, own + 1


def mesh(source, target):
    """Writes a Gmsh file (.msh 2.2); returns the numbers of triangles and of quadrangles that were cut, and the names of the surfaces."""
    if pathlib.Path(source).suffix.lower() == ".inp":
        read = _abaqus(source)
    else:
        meshio = _needed("meshio", "python3-meshio")
        try:
            read = meshio.read(source)
        except (meshio.ReadError, KeyError, ValueError, IndexError, SystemExit) as error:
            raise knap.KnapError(f"{source}: meshio cannot read it: {error}") from None
    points = np.asarray(read.points, float)
    if points.shape[1] > 2 and len(points) and np.ptp(points[:, 2]) > 1e-8 * np.ptp(points, axis=0).max():
        raise knap.KnapError(f"{source}: the mesh does not lie in a plane z = const")
    points = points[:, :2]
    named, entity_of = read.cell_data.get("gmsh:physical"), read.cell_data.get("gmsh:geometrical")
    names = {tuple(tag): name for name, tag in read.field_data.items()}
    is_plane = [block.type in CORNERS for block in read.cells]
    first = np.cumsum([0] + [len(block.data) * flag for block, flag in zip(read.cells, is_plane)])
    sets, sets_of_lines = {}, {}
    for name, parts in read.cell_sets.items():
        if not name.startswith("gmsh:"):
            sets_of_lines[name] = parts
            sets[name] = [first[b] + e for b, part in enumerate(parts) if part is not None and is_plane[b] for e in part]
    labels, entities = _labels_of_sets(source, sets, getattr(read, "materials", {}), first[-1])
    triangles, surface, entity, lines, curve, n_cut = [], [], [], [], [], 0
    corners_only = collections.Counter()
    for b, block in enumerate(read.cells):
        n = len(block.data)
        if block.type in LINES:
            label = np.full(n, "", object)
            for name, parts in sets_of_lines.items():
                if parts[b] is not None:
                    label[np.asarray(parts[b], int)] = name
        else:
            label, number = labels[first[b]:first[b + 1]], entities[first[b]:first[b + 1]]
        if named is not None:
            dimension = 1 if block.type in LINES else 2
            label = np.array([names.get((tag, dimension), f"group{tag}" if tag else "") for tag in named[b]], object)
            number = np.asarray(entity_of[b] if entity_of is not None else named[b], int)
        if block.type in LINES:
            lines += [block.data[:, :2]]
            curve += [label]
        elif block.type in CORNERS:
            corners = block.data[:, :CORNERS[block.type]]
            if block.data.shape[1] > CORNERS[block.type]:
                corners_only[block.type] += n
            if CORNERS[block.type] == 4:
                corners, label, number, n_cut = cut(corners, points), np.repeat(label, 2), np.repeat(number, 2), n_cut + n
            triangles += [corners]
            surface += [label]
            entity += [number]
        elif block.type != "vertex":
            raise knap.KnapError(f"{source}: it has elements of the type {block.type}, and a plane mesh has triangles and quadrangles")
    if not triangles:
        raise knap.KnapError(f"{source}: it has no triangles and no quadrangles")
    if corners_only:
        knap.note(f"{source}: only the corners are kept of {', '.join(f'{n} {kind}' for kind, n in corners_only.items())}; mesh.order is the order of the run")
    triangles, surface, entity = np.concatenate(triangles), np.concatenate(surface), np.concatenate(entity)
    ends, owner = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0, return_counts=True)
    boundary = ends[owner == 1]
    for name, nodes in read.point_sets.items():
        inside = np.zeros(len(points), bool)
        inside[np.asarray(nodes, int)] = True
        chosen = boundary[inside[boundary].all(axis=1)]
        if not len(chosen):
            knap.note(f"{source}: the node set {name} has no edge of the boundary and is left out")
        lines, curve = lines + [chosen], curve + [np.full(len(chosen), name, object)]
    lines = np.concatenate(lines) if lines else np.zeros((0, 2), int)
    curve = np.concatenate(curve) if curve else np.zeros(0, object)
    _write_msh(target, points, triangles, surface, entity, lines, curve)
    return len(triangles), n_cut, list(dict.fromkeys(surface))


def _write_msh(target, points, triangles, surface, entity, lines, curve):
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
        for kind, labels, entities, dimension, elements in ((1, curve, None, 1, lines), (2, surface, entity, 2, triangles)):
            for k, (name, nodes) in enumerate(zip(labels, elements)):
                number += 1
                tag = tags[dimension].get(name, 0)  # grains are told apart by the entity, too
                out.write(f"{number} {kind} 2 {tag} {tag if entities is None else entities[k]} {' '.join(str(n + 1) for n in nodes)}\n")
        out.write("$EndElements\n")


# ---- pictures

def picture(source, target, colours=None, width=None):
    """Writes a PNG file; `colours`: as many as this, the most frequent ones, without mixtures between them; `width`
    [pixel]: reduced to it. More than 64 colours are refused without `colours`: those of noise are no materials. Returns the colours as "#rrggbb", the most frequent first."""
    if colours is not None and not 1 <= colours <= 256:
        raise knap.KnapError(f"{colours} colours are asked for; a picture keeps 1 to 256")
    if width is not None and width < 1:
        raise knap.KnapError(f"a width of {width} pixels is asked for; it is 1 or more")
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
    found = sorted(image.getcolors(image.width * image.height), key=lambda c: (-c[0], c[1]))
    if colours is None and len(found) > MOST_COLOURS:
        raise knap.KnapError(f"{source} has {len(found)} colours, more than {MOST_COLOURS} materials: --colours N keeps the N most frequent ones without "
                             "mixtures and noise, as --colours 3")
    image.save(target, "PNG")
    return ["#%02x%02x%02x" % rgb for _, rgb in found]


def command():
    """knap-convert"""
    parser = argparse.ArgumentParser(prog="knap-convert", description="Meshes (Abaqus .inp and others) to .msh for mesh.file, pictures (TIFF, JPEG) to .png for [[map]].")
    parser.add_argument("source")
    parser.add_argument("target", help=".msh or .png")
    parser.add_argument("--colours", type=int, help="of a picture: so many, without mixtures at borders")
    parser.add_argument("--width", type=int, help="of a picture, in pixels: reduced to it")
    options = parser.parse_args()
    knap.command_line("knap-convert", lambda: _convert(options))


def _convert(options):
    ending = pathlib.Path(options.target).suffix
    if ending == ".png":
        found = picture(options.source, options.target, options.colours, options.width)
        print(f"{options.target}: {len(found)} colours: {' '.join(found[:12])}{' ...' if len(found) > 12 else ''}")
    elif ending == ".msh":
        n, n_cut, names = mesh(options.source, options.target)
        shown = [name or "(without a name)" for name in names]
        print(f"{options.target}: {n} triangles" + (f", of {n_cut} quadrangles" if n_cut else "") +
              f"; surfaces: {', '.join(shown[:12])}{' ...' if len(shown) > 12 else ''}")
    else:
        raise knap.KnapError(f"`{options.target}` ends neither in .msh nor in .png")


if __name__ == "__main__":
    command()
