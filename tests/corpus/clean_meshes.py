# SPDX-License-Identifier: Apache-2.0
"""Closed meshes, each welded, oriented outward, of a known solid: what spoiled_meshes.py spoils.

    for name, (points, faces) in clean_meshes.generated():

Points are n x 3 doubles, faces m x 3 point numbers. Every mesh is the same each time.
"""
import math

import numpy

PI = math.pi


def mesh(points, faces):
    return numpy.asarray(points, dtype=float), numpy.asarray(faces, dtype=numpy.int64)


def joined(*meshes):
    points, faces, first = [], [], 0
    for p, f in meshes:
        points.append(p)
        faces.append(f + first)
        first += len(p)
    return numpy.concatenate(points), numpy.concatenate(faces)


def moved(a_mesh, offset=(0, 0, 0), scale=1):
    return a_mesh[0] * numpy.asarray(scale, dtype=float) + numpy.asarray(offset, dtype=float), a_mesh[1]


def reversed_mesh(a_mesh):
    return a_mesh[0], a_mesh[1][:, [0, 2, 1]]


def turned(a_mesh, x=0.3, y=0.5, z=0.7):
    """Turned about the axes, so that nothing lies along them."""
    points = a_mesh[0]
    for axis, angle in enumerate((x, y, z)):
        c, s = math.cos(angle), math.sin(angle)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        points = points.copy()
        points[:, i], points[:, j] = c * points[:, i] - s * points[:, j], s * points[:, i] + c * points[:, j]
    return points, a_mesh[1]


def blocks(solid, size=(1, 1, 1)):
    """The surface of the unit cells for which the three-dimensional array `solid` is true."""
    padded = numpy.pad(numpy.asarray(solid, dtype=bool), 1)
    number, points, faces = {}, [], []

    def at(key):
        if key not in number:
            number[key] = len(points)
            points.append([key[axis] * size[axis] for axis in range(3)])
        return number[key]

    for cell in numpy.argwhere(padded):
        for axis in range(3):
            for side in (0, 1):
                other = cell.copy()
                other[axis] += 2 * side - 1
                if padded[tuple(other)]:
                    continue
                corners = []
                for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    key = cell - 1
                    key[axis] += side
                    key[(axis + 1) % 3] += i
                    key[(axis + 2) % 3] += j
                    corners.append(at(tuple(int(k) for k in key)))
                if side == 0:
                    corners.reverse()
                faces += [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
    return mesh(points, faces)


def box(n=1, size=(1, 1, 1)):
    return blocks(numpy.ones((n, n, n)), [s / n for s in size])


def icosphere(cuts=3, radius=lambda p: 1.0):
    t = (1 + math.sqrt(5)) / 2
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t), (0, 1, -t),
              (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
             (8, 6, 7), (9, 8, 1)]
    points = [numpy.array(p) / math.sqrt(1 + t * t) for p in points]
    for _ in range(cuts):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                p = points[a] + points[b]
                middles[key] = len(points)
                points.append(p / numpy.linalg.norm(p))
            return middles[key]

        for a, b, c in faces:
            d, e, f = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, d, f), (b, e, d), (c, f, e), (d, e, f)]
        faces = finer
    return mesh([p * radius(p) for p in points], faces)


def grid_faces(rows, columns, wrap_rows, wrap_columns):
    faces = []
    for i in range(rows if wrap_rows else rows - 1):
        for j in range(columns if wrap_columns else columns - 1):
            a, b = i * columns + j, (i + 1) % rows * columns + j
            c, d = (i + 1) % rows * columns + (j + 1) % columns, i * columns + (j + 1) % columns
            faces += [[a, b, c], [a, c, d]]
    return faces


def revolved(profile, around=32):
    """Around z: of points (r, z) that begin and end on the axis (r = 0), or of a closed ring of points off it; the
    solid lies to the left of the way in the half plane (r to the right, z up)."""
    closed = profile[0][0] > 0
    inner = profile if closed else profile[1:-1]
    points = [(r * math.cos(2 * PI * i / around), r * math.sin(2 * PI * i / around), z)
              for i in range(around) for r, z in inner]
    faces = grid_faces(around, len(inner), True, closed)
    if not closed:
        low, high, n = len(points), len(points) + 1, len(inner)
        points += [(0, 0, profile[0][1]), (0, 0, profile[-1][1])]
        for i in range(around):
            k = (i + 1) % around
            faces.append([low, k * n, i * n])
            faces.append([high, i * n + n - 1, k * n + n - 1])
    return mesh(points, faces)


def triangulated(polygon):
    """A simple polygon, counter-clockwise, by cutting off ears."""
    def area(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    left, faces = list(range(len(polygon))), []
    while len(left) > 3:
        for i in range(len(left)):
            a, b, c = (left[(i + k - 1) % len(left)] for k in range(3))
            p, q, r = polygon[a], polygon[b], polygon[c]
            if area(p, q, r) <= 1e-12:
                continue
            if any(area(p, q, polygon[v]) >= 0 and area(q, r, polygon[v]) >= 0 and area(r, p, polygon[v]) >= 0
                   for v in left if v not in (a, b, c)):
                continue
            faces.append([a, b, c])
            del left[i]
            break
        else:
            raise ValueError("no ear")
    return faces + [left]


def prism(polygon, height, layers=1):
    n = len(polygon)
    points = [(x, y, height * k / layers) for k in range(layers + 1) for x, y in polygon]
    faces = [[c, b, a] for a, b, c in triangulated(polygon)]
    faces += [[v + layers * n for v in face] for face in triangulated(polygon)]
    for k in range(layers):
        for i in range(n):
            a, b = k * n + i, k * n + (i + 1) % n
            faces += [[a, b, b + n], [a, b + n, a + n]]
    return mesh(points, faces)


def swept(curve, radius, across=10, closed=True):
    """A tube along points of a curve; its ends are closed by fans."""
    curve = numpy.asarray(curve, dtype=float)
    n = len(curve)
    points, normal = [], None
    for i in range(n):
        ahead = curve[(i + 1) % n] if closed or i + 1 < n else curve[i]
        behind = curve[i - 1] if closed or i > 0 else curve[i]
        way = (ahead - behind) / numpy.linalg.norm(ahead - behind)
        if normal is None:
            normal = numpy.cross(way, (0.2, 0.3, 0.9))
        normal = normal - way * normal.dot(way)
        normal /= numpy.linalg.norm(normal)
        other = numpy.cross(way, normal)
        for k in range(across):
            angle = 2 * PI * k / across
            points.append(curve[i] + radius * (math.cos(angle) * normal + math.sin(angle) * other))
    faces = [list(reversed(face)) for face in grid_faces(n, across, closed, True)]
    if closed:  # the frame comes back turned: joined where it fits best
        last, first = (n - 1) * across, 0
        faces = [f for f in faces if not (min(f) < across and max(f) >= last)]
        shift = min(range(across), key=lambda s: sum(numpy.linalg.norm(points[last + k] - points[(k + s) % across])
                                                     for k in range(across)))
        for k in range(across):
            a, b = last + k, last + (k + 1) % across
            c, d = first + (k + 1 + shift) % across, first + (k + shift) % across
            faces += [[a, b, c], [a, c, d]]
    else:
        start, end = len(points), len(points) + 1
        points += [curve[0], curve[-1]]
        for k in range(across):
            j, last = (k + 1) % across, (n - 1) * across
            faces += [[start, j, k], [end, last + k, last + j]]
    return mesh(points, faces)


def signed_volume(a_mesh):
    p = a_mesh[0] - a_mesh[0].mean(axis=0)
    a, b, c = (p[a_mesh[1][:, k]] for k in range(3))
    return float(numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6)


def wound_volume(mesh, columns=1000):
    """The volume of the places that a closed mesh winds around more often than not, within 1e-5 of it: of copies that
    overlap the union's, where signed_volume() is the sum. By columns, none of which lies along a face."""
    points = turned(mesh)[0]
    low, high = points.min(axis=0), points.max(axis=0)
    step = (high - low)[:2] / columns
    scaled = (points[:, :2] - low[:2]) / step - 0.5  # column i at i
    where, heights, signs = [], [], []
    for face in mesh[1]:
        (ax, ay), (bx, by), (cx, cy) = scaled[face]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        x0, x1 = int(numpy.ceil(min(ax, bx, cx))), int(numpy.floor(max(ax, bx, cx)))
        y0, y1 = int(numpy.ceil(min(ay, by, cy))), int(numpy.floor(max(ay, by, cy)))
        if area == 0 or x1 < x0 or y1 < y0:
            continue
        x, y = numpy.meshgrid(numpy.arange(x0, x1 + 1), numpy.arange(y0, y1 + 1), indexing="ij")
        u = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area
        v = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area
        hit = (u >= 0) & (v >= 0) & (u + v <= 1)
        x, y, u, v = x[hit], y[hit], u[hit], v[hit]
        z = points[face, 2]
        where.append(x * columns + y)
        heights.append(u * z[0] + v * z[1] + (1 - u - v) * z[2])
        signs.append(numpy.full(len(x), -1 if area > 0 else 1))
    where, heights, signs = map(numpy.concatenate, (where, heights, signs))
    order = numpy.lexsort((heights, where))
    where, heights, signs = where[order], heights[order], signs[order]
    total = numpy.cumsum(signs)  # back to 0 after each column
    inside = (total[:-1] > 0) & (where[1:] == where[:-1])
    return float((heights[1:] - heights[:-1])[inside].sum() * step[0] * step[1])


def outward(a_mesh):
    return a_mesh if signed_volume(a_mesh) > 0 else reversed_mesh(a_mesh)


def is_closed(a_mesh):
    f = a_mesh[1]
    ways = numpy.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]])
    n = len(a_mesh[0])
    return bool((numpy.sort(ways[:, 0] * n + ways[:, 1]) == numpy.sort(ways[:, 1] * n + ways[:, 0])).all())


def gear(teeth=12):
    polygon = []
    for i in range(teeth):
        for k, r in ((0, 0.8), (0.2, 1.0), (0.5, 1.0), (0.7, 0.8)):
            angle = 2 * PI * (i + k) / teeth
            polygon.append((r * math.cos(angle), r * math.sin(angle)))
    return prism(polygon, 0.4)


def comb(teeth=6):
    polygon = [(0, 0), (teeth - 0.5, 0)]
    for i in reversed(range(teeth)):
        polygon += [(i + 0.5, 2), (i, 2)] if i == 0 else [(i + 0.5, 2), (i, 2), (i, 0.4), (i - 0.5, 0.4)]
    return prism(polygon, 1.5)


def bolt():
    return revolved([(0, 0), (1, 0), (1, 0.6), (0.5, 0.7), (0.5, 2.4), (0.4, 2.5), (0, 2.5)], 6)


def cup(wall=0.1, around=32):
    return revolved([(0, 0), (1, 0), (1, 0.7), (1, 1.4), (1, 2), (1 - wall, 2), (1 - wall, 1.3), (1 - wall, 0.7),
                     (1 - wall, wall), (0, wall)], around)


def bottle():
    outer = [(0, 0), (0.8, 0), (0.8, 1.5), (0.3, 2), (0.3, 2.6)]
    return revolved(outer + [(0.22, 2.6), (0.22, 1.95), (0.7, 1.45), (0.7, 0.1), (0, 0.1)], 24)


def bowl(wall=0.04):
    steps = [PI / 2 * k / 8 for k in range(9)]
    outer = [(math.sin(a), -math.cos(a)) for a in steps]
    inner = [((1 - wall) * math.sin(a), -(1 - wall) * math.cos(a)) for a in reversed(steps)]
    outer[0], inner[-1] = (0, outer[0][1]), (0, inner[-1][1])
    return revolved(outer + inner, 32)


def knot(p=2, q=3, n=120):
    ways = [2 * PI * i / n for i in range(n)]
    return swept([((2 + math.cos(q * t)) * math.cos(p * t), (2 + math.cos(q * t)) * math.sin(p * t), math.sin(q * t))
                  for t in ways], 0.35)


def helix(turns=4, n=160):
    ways = [2 * PI * turns * i / n for i in range(n + 1)]
    return swept([(math.cos(t), math.sin(t), 0.12 * t) for t in ways], 0.15, 8, False)


def ring(radius=1.0, tube=0.3, around=32, across=14):
    return revolved([(radius + tube * math.cos(2 * PI * k / across), tube * math.sin(2 * PI * k / across))
                     for k in range(across)], around)


def lattice(n=3, gap=2):
    size = n * (gap + 1) + 1
    grid = numpy.indices((size,) * 3) % (gap + 1) == 0
    return blocks(grid.sum(axis=0) >= 2)


def cheese():
    solid = numpy.ones((9, 9, 9))
    for x, y, z in ((2, 2, 2), (6, 2, 3), (2, 6, 6), (6, 6, 6), (4, 4, 2)):
        solid[x:x + 2, y:y + 2, z:z + 2] = 0
    return blocks(solid)


def tray():
    solid = numpy.ones((10, 8, 4))
    solid[1:-1, 1:-1, 1:] = 0
    return blocks(solid)


def house():
    solid = numpy.ones((12, 10, 6))
    solid[1:6, 1:9, 1:5] = 0
    solid[7:11, 1:9, 1:5] = 0  # two rooms
    solid[6, 4:6, 1:4] = 0  # the door between them
    solid[0, 4:6, 2:4] = 0  # a window
    return blocks(solid)


def stairs():
    solid = numpy.zeros((6, 3, 6))
    for k in range(6):
        solid[k, :, :k + 1] = 1
    return blocks(solid)


def bracket():
    return prism([(0, 0), (4, 0), (4, 0.5), (0.5, 0.5), (0.5, 3), (0, 3)], 2)


def flanged_bracket():
    """A block with two thin flanges, as few faces as it takes."""
    return prism([(0, 0), (10, 0), (10, 0.6), (7, 0.6), (7, 4), (3, 4), (3, 0.6), (0, 0.6)], 6)


def pipe():
    return revolved([(0.8, 0), (1, 0), (1, 1), (1, 2), (1, 3), (0.8, 3), (0.8, 2), (0.8, 1)], 32)


def elbow():
    ways = [PI / 2 * i / 16 for i in range(17)]
    return swept([(math.cos(t), math.sin(t), 0) for t in ways], 0.25, 16, False)


def hollow(outer, inner):
    return joined(outer, reversed_mesh(inner))


def frame():
    solid = numpy.zeros((7, 7, 7))
    edges = (numpy.indices((7, 7, 7)) % 6 == 0).sum(axis=0) >= 2
    solid[edges] = 1
    return blocks(solid)


def _all():
    bumps = lambda p: 1 + 0.25 * math.sin(5 * p[0]) * math.sin(4 * p[1] + 1) * math.cos(6 * p[2])
    spikes = lambda p: 1 + 0.8 * max(abs(p[0]), abs(p[1]), abs(p[2])) ** 12
    yield "cube", lambda: box()
    yield "cube_8", lambda: box(8)
    yield "cube_turned", lambda: turned(box(4))
    yield "plate_thin", lambda: box(8, (1, 1, 0.03))
    yield "plate_12_faces", lambda: box(1, (1, 0.7, 0.05))
    yield "needle", lambda: turned(box(3, (1, 0.05, 0.05)))
    yield "tetrahedron", lambda: mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
                                      [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
    yield "sphere", lambda: icosphere(3)
    yield "sphere_coarse", lambda: icosphere(1)
    yield "asteroid", lambda: icosphere(4, bumps)
    yield "spiky_ball", lambda: icosphere(3, spikes)
    yield "torus", lambda: ring()
    yield "torus_thin", lambda: ring(1, 0.06, 48, 8)
    yield "cone", lambda: revolved([(0, 0), (1, 0), (0.5, 1), (0, 2)], 24)
    yield "hourglass", lambda: revolved([(0, 0), (1, 0), (0.15, 1), (1, 2), (0, 2)], 24)
    yield "gear", gear
    yield "heat_sink", comb
    yield "l_bracket", bracket
    yield "flanged_bracket", flanged_bracket
    yield "bolt", bolt
    yield "cup", cup
    yield "cup_thin", lambda: cup(0.04, 48)
    yield "cup_6_sides", lambda: cup(0.2, 6)
    yield "bottle", bottle
    yield "bowl", bowl
    yield "pipe", pipe
    yield "elbow", elbow
    yield "knot", knot
    yield "knot_5", lambda: knot(2, 5, 160)
    yield "spring", helix
    yield "lattice", lattice
    yield "frame", frame
    yield "cheese", cheese
    yield "tray", tray
    yield "house", house
    yield "stairs", stairs
    yield "hollow_ball", lambda: hollow(icosphere(3), moved(icosphere(3), scale=0.8))
    yield "hollow_ball_thin", lambda: hollow(icosphere(3), moved(icosphere(3), scale=0.95))
    yield "hollow_cube", lambda: hollow(box(4), moved(box(4), (0.1, 0.1, 0.1), 0.8))
    yield "doll", lambda: joined(icosphere(3), reversed_mesh(moved(icosphere(3), scale=0.85)),
                                 moved(icosphere(3), scale=0.6), reversed_mesh(moved(icosphere(3), scale=0.45)))
    yield "two_cavities", lambda: joined(box(4), reversed_mesh(moved(icosphere(2), (0.27, 0.5, 0.5), 0.2)),
                                         reversed_mesh(moved(icosphere(2), (0.73, 0.5, 0.5), 0.2)))
    yield "three_balls", lambda: joined(*(moved(icosphere(2), (2.5 * i, 0.3 * i, 0)) for i in range(3)))
    yield "chain", lambda: joined(*(moved(ring(1, 0.2) if i % 2 == 0 else turned(ring(1, 0.2), PI / 2, 0, 0),
                                          (1.5 * i, 0, 0)) for i in range(4)))
    yield "plate_of_bolts", lambda: joined(*(moved(bolt(), (3 * i, 3 * j, 0)) for i in range(3) for j in range(2)))
    yield "large_and_small", lambda: joined(icosphere(3), moved(box(2), (1.5, 0, 0), 0.4),
                                            moved(icosphere(2), (-1.6, 0, 0), 0.3))


def generated():
    """name, mesh: in a fixed order."""
    for name, make in _all():
        made = outward(make())
        assert is_closed(made), name
        yield name, made
