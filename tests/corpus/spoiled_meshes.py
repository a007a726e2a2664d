# SPDX-License-Identifier: Apache-2.0
"""Spoils closed meshes in known ways.

    for name, clean in clean_meshes.generated():
        for spoiled in spoiled_meshes.of(name, clean):
            spoiled.kind, spoiled.strength, spoiled.points, spoiled.faces
            spoiled.truth      # points, faces: a clean mesh of the same solid
            spoiled.undefined  # why the solid does not follow from the file any more, or ""

A mesh is spoiled the same way each time. `write_ply` keeps every bit of the coordinates.
"""
import collections
import dataclasses
import zlib

import numpy

from clean_meshes import joined, moved


@dataclasses.dataclass
class Spoiled:
    kind: str
    strength: str
    points: numpy.ndarray
    faces: numpy.ndarray
    truth: tuple
    undefined: str = ""


class Model:
    """A clean mesh and what is asked about it more than once."""

    def __init__(self, name, clean):
        self.name, (self.points, self.faces) = name, clean
        self.size = float((self.points.max(axis=0) - self.points.min(axis=0)).max())
        a, b, c = (self.points[self.faces[:, k]] for k in range(3))
        self.normals = numpy.cross(b - a, c - a)
        self.areas = numpy.linalg.norm(self.normals, axis=1) / 2
        self.area = self.areas.sum()
        self.volume = float(numpy.einsum("ij,ij->i", a - self.points[0], self.normals).sum() / 6)
        self.thickness = 2 * self.volume / self.area  # of a plate
        self.longest = numpy.max([numpy.linalg.norm(b - a, axis=1), numpy.linalg.norm(c - b, axis=1),
                                  numpy.linalg.norm(a - c, axis=1)], axis=0)
        sides = collections.defaultdict(list)
        for face, corners in enumerate(self.faces.tolist()):
            for k in range(3):
                p, q = corners[k], corners[(k + 1) % 3]
                sides[min(p, q), max(p, q)].append(face)
        self.sides = sides
        self.neighbours = [[] for _ in range(len(self.faces))]
        for around in sides.values():
            if len(around) == 2:
                self.neighbours[around[0]].append(around[1])
                self.neighbours[around[1]].append(around[0])
        self.part = numpy.full(len(self.faces), -1)
        parts = 0
        for seed in range(len(self.faces)):
            if self.part[seed] >= 0:
                continue
            for face in self.grown(seed, len(self.faces)):
                self.part[face] = parts
            parts += 1
        self.parts = parts

    def part_volumes(self):
        a = self.points[self.faces[:, 0]] - self.points.mean(axis=0)
        each = numpy.einsum("ij,ij->i", a, self.normals) / 6
        return numpy.bincount(self.part, each)

    def has_cavities(self):
        return bool((self.part_volumes() < 0).any())

    def grown(self, seed, count):
        """Faces connected with `seed`, the nearest first."""
        found, queue = {seed: None}, collections.deque([seed])
        while queue and len(found) < count:
            for other in self.neighbours[queue.popleft()]:
                if other not in found and len(found) < count:
                    found[other] = None
                    queue.append(other)
        return list(found)

    def winding(self, where):
        total = numpy.zeros(len(where))
        for i, p in enumerate(where):
            a, b, c = (self.points[self.faces[:, k]] - p for k in range(3))
            la, lb, lc = (numpy.linalg.norm(v, axis=1) for v in (a, b, c))
            above = numpy.einsum("ij,ij->i", a, numpy.cross(b, c))
            below = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
            total[i] = numpy.arctan2(above, below).sum() / (2 * numpy.pi)
        return total


# --- Pieces of what follows.

def flipped(faces, which):
    faces = faces.copy()
    faces[which] = faces[which][:, [0, 2, 1]]
    return faces


def shuffled(points, faces, rng):
    order = rng.permutation(len(points))
    place = numpy.empty(len(points), dtype=numpy.int64)
    place[order] = numpy.arange(len(points))
    faces = place[faces][rng.permutation(len(faces))]
    turn = rng.integers(0, 3, len(faces))
    rows = numpy.arange(len(faces))
    return points[order], numpy.stack([faces[rows, (turn + k) % 3] for k in range(3)], axis=1)


def unwelded(points, faces, rng, noise=0.0):
    apart = points[faces.reshape(-1)]
    if noise > 0:
        apart = apart + rng.uniform(-noise, noise, apart.shape)
    return apart, numpy.arange(3 * len(faces)).reshape(-1, 3)


def some(count, share, rng):
    return rng.choice(count, max(1, int(round(share * count))), replace=False)


def with_t_junctions(points, faces, sides):
    """Cuts sides (face, k), no two of one face, in the middle: the neighbour keeps the whole edge."""
    points, new, gone = [points], [], []
    first = len(points[0])
    for face, k in sides:
        a, b, c = faces[face, k], faces[face, (k + 1) % 3], faces[face, (k + 2) % 3]
        points.append(((points[0][a] + points[0][b]) / 2)[None])
        new += [[a, first, c], [first, b, c]]
        gone.append(face)
        first += 1
    left = numpy.delete(faces, gone, axis=0)
    return numpy.concatenate(points), numpy.concatenate([left, numpy.array(new, dtype=numpy.int64)])


def patches(model, count, share, rng):
    faces = set()
    for _ in range(count):
        faces.update(model.grown(int(rng.integers(len(model.faces))), max(1, int(share * len(model.faces)))))
    return numpy.array(sorted(faces))


def loop_of(model, patch):
    """The boundary edges of a patch as its faces run along them, and the points in order where it is one loop."""
    inside = set(patch.tolist())
    ahead = {}
    for face in patch.tolist():
        corners = model.faces[face].tolist()
        for k in range(3):
            p, q = corners[k], corners[(k + 1) % 3]
            if not all(other in inside for other in model.sides[min(p, q), max(p, q)]):
                if p in ahead:
                    return None
                ahead[p] = q
    if not ahead:
        return None
    loop = [next(iter(ahead))]
    while ahead[loop[-1]] != loop[0]:
        loop.append(ahead[loop[-1]])
    return loop if len(loop) == len(ahead) else None


CAVITY = "a shell inside a shell of the same orientation may be a solid in a solid or a reversed cavity"


def turned_cavity(model, which):
    """Whether more than half of the area of a shell looks the other way where shells are nested."""
    if not model.has_cavities():
        return ""
    turned = numpy.bincount(model.part[which], model.areas[which], model.parts)
    return CAVITY if (2 * turned > 0.9 * numpy.bincount(model.part, model.areas)).any() else ""


# --- The ways of spoiling: (points, faces[, truth[, undefined]]), or None where it does not apply.

def flip_faces(model, rng, share):
    which = some(len(model.faces), share, rng)
    return model.points, flipped(model.faces, which), None, turned_cavity(model, which)


def flip_patches(model, rng, count, share):
    which = patches(model, count, share, rng)
    return model.points, flipped(model.faces, which), None, turned_cavity(model, which)


def flip_part(model, rng):
    if model.parts < 2 or model.has_cavities():
        return None
    which = model.part == rng.integers(model.parts)
    return model.points, flipped(model.faces, which)


def flip_inner_shell(model, rng):
    inner = numpy.flatnonzero(model.part_volumes() < 0)
    if not len(inner):
        return None
    return model.points, flipped(model.faces, model.part == rng.choice(inner)), None, CAVITY


def inside_out(model, rng):
    return model.points, flipped(model.faces, slice(None))


def drop_faces(model, rng, share):
    """Single faces, up to a share of the area. Holes wider than the walls leave no solid there."""
    left, gone = share * model.area, []
    for face in rng.permutation(len(model.faces)):
        if model.areas[face] <= left and model.longest[face] <= 2 * model.thickness and model.areas[face] < 0.01 * model.area:
            gone.append(face)
            left -= model.areas[face]
    if not gone:
        return None
    return model.points, numpy.delete(model.faces, gone, axis=0)


def drop_patch(model, rng, share):
    which = patches(model, 1, share, rng)
    extent = model.points[model.faces[which]].reshape(-1, 3)
    wide = numpy.linalg.norm(extent.max(axis=0) - extent.min(axis=0)) > 2 * model.thickness
    return (model.points, numpy.delete(model.faces, which, axis=0), None,
            "the hole is wider than the walls are thick" if wide or model.areas[which].sum() > 0.02 * model.area else "")


def drop_and_flip(model, rng, share):
    dropped = drop_faces(model, rng, share)
    if dropped is None:
        return None
    faces = dropped[1]
    which = some(len(faces), 0.1, rng)
    return model.points, flipped(faces, which)


def duplicate(model, rng, share, way):
    which = some(len(model.faces), share, rng)
    more = model.faces[which] if way == "same" else flipped(model.faces[which], slice(None))
    copies = [model.faces, more] + ([flipped(more, slice(None))] if way == "both" else [])
    return shuffled(model.points, numpy.concatenate(copies), rng)


def doubled_with_noise(model, rng, noise, way):
    other = model.points + rng.uniform(-1, 1, model.points.shape) * noise * model.size
    faces = model.faces if way == "same" else flipped(model.faces, slice(None))
    return joined((model.points, model.faces), (other, faces))


def t_junctions(model, rng, share, flips=0.0):
    sides = [(face, int(rng.integers(3))) for face in some(len(model.faces), share, rng)]
    points, faces = with_t_junctions(model.points, model.faces, sides)
    return points, flipped(faces, some(len(faces), flips, rng)) if flips else faces


def noise(model, rng, share):
    points = model.points + rng.uniform(-share, share, model.points.shape) * min(model.size, 20 * model.thickness)
    return (*shuffled(points, model.faces, rng), (points, model.faces))


def apart(model, rng, noise_share, flips=0.0):
    points, faces = unwelded(model.points, model.faces, rng, noise_share * model.size)
    return points, flipped(faces, some(len(faces), flips, rng)) if flips else faces


def slivers_apart(model, rng, share):
    """Faces without area: with a repeated point, with two equal points, on a line."""
    points, faces = [model.points], [model.faces]
    first = len(model.points)
    for face in some(len(model.faces), share, rng):
        a, b, c = model.faces[face]
        middle = (model.points[a] + model.points[b]) / 2
        points += [middle[None], model.points[b][None]]
        faces.append(numpy.array([[a, b, b], [a, first, b], [b, first + 1, c]]))
        first += 2
    return numpy.concatenate(points), numpy.concatenate(faces)


def slivers_between(model, rng, share, flips=0.0):
    """T-junctions closed by faces without area."""
    sides = [(face, int(rng.integers(3))) for face in some(len(model.faces), share, rng)]
    points, faces = with_t_junctions(model.points, model.faces, sides)
    first, more = len(model.points), []
    for i, (face, k) in enumerate(sides):
        more.append([model.faces[face, k], model.faces[face, (k + 1) % 3], first + i])
    faces = numpy.concatenate([faces, numpy.array(more)])
    return points, flipped(faces, some(len(faces), flips, rng)) if flips else faces


def copies(model, rng, offset, spoil):
    """With a copy, moved by `offset` of the box along x (1: side by side) and a little along y where they overlap."""
    box = model.points.max(axis=0) - model.points.min(axis=0)
    other = moved((model.points, model.faces), (offset * box[0], 0 if offset == 1 else 0.013 * box[1], 0))
    truth = joined((model.points, model.faces), other)
    n = len(model.faces)
    if spoil == "copy":
        which = numpy.arange(n, 2 * n)
        if model.has_cavities():
            return None
    else:
        which = some(2 * n, spoil, rng)
    why = CAVITY if model.has_cavities() else ""  # within the other copy, cavities are filled or not
    return truth[0], flipped(truth[1], which), truth, why if offset != 1 else ""


def inside_points(model, rng, count):
    low, high = model.points.min(axis=0), model.points.max(axis=0)
    found = []
    for _ in range(40):
        where = rng.uniform(low, high, (4 * count, 3))
        found += list(where[numpy.abs(model.winding(where) - 1) < 0.01])
        if len(found) >= count:
            return numpy.array(found[:count])
    return None


def inner_faces(model, rng, count):
    """Loose triangles within the solid."""
    if len(model.faces) > 3000:
        return None
    middles = inside_points(model, rng, count)
    if middles is None:
        return None
    points, faces = [model.points], [model.faces]
    for i, p in enumerate(middles):
        points.append(p + rng.normal(0, 0.25, (3, 3)) * model.thickness)
        faces.append(numpy.array([[0, 1, 2]]) + len(model.points) + 3 * i)
    return numpy.concatenate(points), numpy.concatenate(faces)


def membrane(model, rng, share, way, flips=0.0):
    """A wall within the solid along the boundary of a patch, as a union leaves it: one face thick, or two."""
    if len(model.faces) > 6000:
        return None
    for _ in range(12):
        patch = patches(model, 1, share, rng)
        loop = loop_of(model, patch)
        if loop is None:
            continue
        corners = model.points[loop]
        middle = corners.mean(axis=0)
        probes = numpy.concatenate([0.98 * corners + 0.02 * middle, 0.5 * (corners + middle), middle[None],
                                    0.49 * (corners + numpy.roll(corners, 1, axis=0)) + 0.02 * middle])
        if (numpy.abs(model.winding(probes) - 1) < 0.01).all():
            break
    else:
        return None
    centre = len(model.points)
    wall = numpy.array([[loop[i - 1], loop[i], centre] for i in range(len(loop))])
    faces = numpy.concatenate([model.faces, wall] + ([flipped(wall, slice(None))] if way == "twice" else []))
    points = numpy.concatenate([model.points, middle[None]])
    return points, flipped(faces, some(len(faces), flips, rng)) if flips else faces


def fins(model, rng, count):
    """Triangles on edges of the solid, standing out of it."""
    points, faces, area = [model.points], [model.faces], 0.0
    for i, face in enumerate(some(len(model.faces), min(1.0, count / len(model.faces)), rng)):
        a, b, c = model.faces[face]
        normal = model.normals[face] / max(numpy.linalg.norm(model.normals[face]), 1e-300)
        points.append(((model.points[a] + model.points[b]) / 2 + normal * 0.3 * model.longest[face])[None])
        faces.append(numpy.array([[a, b, len(model.points) + i]]))
        area += 0.15 * model.longest[face] ** 2
    why = "sheets outside, with a quarter of the solid's surface in total, enclose volume of their own"
    return numpy.concatenate(points), numpy.concatenate(faces), None, why if area > 0.25 * model.area else ""


def far_in_floats(model, rng, times):
    """Single precision, far from the origin, every face with corners of its own."""
    points = (model.points + numpy.array([times, -0.7 * times, 0.4 * times]) * model.size).astype(numpy.float32)
    points = points.astype(float)
    soup, faces = unwelded(points, model.faces, rng)
    return soup, flipped(faces, some(len(faces), 0.1, rng)), (points, model.faces)


def detached_patch(model, rng, share, noise_share, flip):
    """A patch whose points along its boundary are its own, as parts of a game model have it."""
    which = patches(model, 1, share, rng)
    own, faces = numpy.unique(model.faces[which], return_inverse=True)
    points = model.points[own] + rng.uniform(-1, 1, (len(own), 3)) * noise_share * model.size
    faces = faces.reshape(-1, 3) + len(model.points)
    if flip:
        faces = flipped(faces, slice(None))
    return (numpy.concatenate([model.points, points]),
            numpy.concatenate([numpy.delete(model.faces, which, axis=0), faces]), None,
            turned_cavity(model, which) if flip else "")


def patch_behind_t_junctions(model, rng, share, flip):
    """A patch along whose boundary no edge has its like on the other side."""
    which = patches(model, 1, share, rng)
    inside = set(which.tolist())
    points, faces, first = [model.points], [], len(model.points)
    cut = {}
    for face in which.tolist():
        polygon = []
        for k in range(3):
            p, q = (int(model.faces[face, (k + i) % 3]) for i in range(2))
            polygon.append(p)
            if not all(other in inside for other in model.sides[min(p, q), max(p, q)]):
                if (p, q) not in cut:
                    cut[p, q] = first
                    points.append((0.6 * model.points[p] + 0.4 * model.points[q])[None])
                    first += 1
                polygon.append(cut[p, q])
        for triangle in fan_of(polygon):
            faces.append(triangle)
    faces = numpy.array(faces, dtype=numpy.int64)
    if flip:
        faces = flipped(faces, slice(None))
    return (numpy.concatenate(points), numpy.concatenate([numpy.delete(model.faces, which, axis=0), faces]), None,
            turned_cavity(model, which) if flip else "")


def fan_of(polygon):
    """Triangles of a triangle with points on its sides: from a point on a side where there is one."""
    start = 1 if len(polygon) > 3 else 0
    # polygon: corner, [middle], corner, ...: begin at the first middle so that no triangle is flat
    for i, v in enumerate(polygon):
        if len(polygon) > 3 and v > max(polygon[i - 1], polygon[(i + 1) % len(polygon)]):
            start = i
            break
    turned = polygon[start:] + polygon[:start]
    return [[turned[0], turned[i], turned[i + 1]] for i in range(1, len(turned) - 1)]


def scan_of_defects(model, rng):
    """A little of each: duplicates of both orientations, faces dropped and flipped, slivers, shuffled."""
    dropped = drop_faces(model, rng, 0.003)
    faces = model.faces if dropped is None else dropped[1]
    doubled = faces[some(len(faces), 0.05, rng)]
    opposite = flipped(faces[some(len(faces), 0.05, rng)], slice(None))
    faces = numpy.concatenate([flipped(faces, some(len(faces), 0.05, rng)), doubled, opposite])
    return shuffled(model.points, faces, rng)


DEFECTS = [  # kind, strengths: (label, function, arguments)
    ("order of faces and vertices", [("", lambda m, r: shuffled(m.points, m.faces, r), ())]),
    ("faces flipped", [(f"{100 * k:g} %", flip_faces, (k,)) for k in (0.01, 0.1, 0.3, 0.45)]),
    ("patches flipped", [(f"{n} of {100 * k:g} %", flip_patches, (n, k)) for n, k in ((1, 0.05), (5, 0.03), (1, 0.3))]),
    ("a part flipped", [("", flip_part, ())]),
    ("an inner shell flipped", [("", flip_inner_shell, ())]),
    ("inside out", [("", inside_out, ())]),
    ("faces dropped", [(f"{100 * k:g} % of the area", drop_faces, (k,)) for k in (0.003, 0.01, 0.03)]),
    ("a patch dropped", [(f"{100 * k:g} %", drop_patch, (k,)) for k in (0.005, 0.03)]),
    ("faces dropped and flipped", [("1 %, 10 %", drop_and_flip, (0.01,))]),
    ("duplicates, same side", [(f"{100 * k:g} %", duplicate, (k, "same")) for k in (0.05, 0.5, 1.0)]),
    ("duplicates, opposite side", [(f"{100 * k:g} %", duplicate, (k, "opposite")) for k in (0.05, 0.5, 1.0)]),
    ("triplicates", [(f"{100 * k:g} %", duplicate, (k, "both")) for k in (0.1, 1.0)]),
    ("doubled walls, same side", [(f"{k:g} apart", doubled_with_noise, (k, "same")) for k in (1e-7, 1e-5)]),
    ("doubled walls, opposite side", [(f"{k:g} apart", doubled_with_noise, (k, "opposite")) for k in (1e-7, 1e-6)]),
    ("T-junctions", [(f"{100 * k:g} %", t_junctions, (k,)) for k in (0.05, 0.5)]),
    ("T-junctions and flips", [(f"{100 * k:g} %, 10 %", t_junctions, (k, 0.1)) for k in (0.05, 0.5)]),
    ("vertex noise", [(f"{k:g}", noise, (k,)) for k in (1e-4, 1e-3)]),
    ("unwelded", [("", apart, (0,)), ("and 30 % flipped", apart, (0, 0.3))]),
    ("unwelded with differences", [(f"{k:g}", apart, (k,)) for k in (1e-7, 1e-6, 1e-5)]),
    ("unwelded with differences, flipped", [(f"{k:g}, 10 %", apart, (k, 0.1)) for k in (1e-7, 1e-6, 1e-5)]),
    ("slivers apart", [("10 %", slivers_apart, (0.1,))]),
    ("slivers in edges", [("10 %", slivers_between, (0.1,)), ("10 %, 10 % flipped", slivers_between, (0.1, 0.1))]),
    ("interpenetrating copies", [("one flipped", copies, (0.3, "copy")), ("10 % flipped", copies, (0.3, 0.1))]),
    ("copies that touch", [("one flipped", copies, (1, "copy")), ("10 % flipped", copies, (1, 0.1))]),
    ("loose faces inside", [("3", inner_faces, (3,)), ("20", inner_faces, (20,))]),
    ("inner walls of a union", [("once", membrane, (0.3, "once")), ("twice", membrane, (0.3, "twice")),
                                ("once, 10 % flipped", membrane, (0.3, "once", 0.1))]),
    ("fins outside", [("1", fins, (1,)), ("10", fins, (10,))]),
    ("single precision far away, flipped", [(f"{k:g} sizes", far_in_floats, (k,)) for k in (10, 300)]),
    ("a patch detached", [("", detached_patch, (0.1, 0, False)), ("1e-6", detached_patch, (0.1, 1e-6, False)),
                          ("1e-5, flipped", detached_patch, (0.1, 1e-5, True))]),
    ("a patch behind T-junctions", [("", patch_behind_t_junctions, (0.1, False)),
                                    ("flipped", patch_behind_t_junctions, (0.1, True)),
                                    ("30 %, flipped", patch_behind_t_junctions, (0.3, True))]),
    ("a little of each", [("", scan_of_defects, ())]),
]


def of(name, clean, kinds=None):
    """Everything that applies to a clean mesh; `kinds`: only these."""
    model = Model(name, clean)
    for kind, strengths in DEFECTS:
        if kinds is not None and kind not in kinds:
            continue
        for strength, spoil, arguments in strengths:
            rng = numpy.random.default_rng(zlib.crc32(f"{name}/{kind}/{strength}".encode()))
            made = spoil(model, rng, *arguments)
            if made is None:
                continue
            points, faces = made[:2]
            truth = made[2] if len(made) > 2 and made[2] is not None else clean
            yield Spoiled(kind, strength, points, faces, truth, made[3] if len(made) > 3 else "")


def write_ply(path, points, faces):
    with open(path, "wb") as out:
        out.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty double x\n"
                   f"property double y\nproperty double z\nelement face {len(faces)}\n"
                   "property list uchar int vertex_indices\nend_header\n").encode())
        out.write(numpy.ascontiguousarray(points, dtype="<f8").tobytes())
        rows = numpy.empty(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
        rows["n"], rows["v"] = 3, faces
        out.write(rows.tobytes())
