# SPDX-License-Identifier: Apache-2.0
"""Meshes whose solids are known."""

import numpy as np
import pytest


def cube_triangles(low=(0, 0, 0), high=(1, 1, 1)):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    points = np.asarray(low, float) + corners * (np.asarray(high, float) - np.asarray(low, float))
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return points, np.array(faces, np.int64)


def cube_tets(low=(0, 0, 0), high=(1, 1, 1)):
    """Six tets around the diagonal (Kuhn)."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    points = np.asarray(low, float) + corners * (np.asarray(high, float) - np.asarray(low, float))
    steps = (4, 2, 1)
    tets = []
    for i in range(3):
        for j in range(3):
            if i != j:
                a = steps[i]
                b = a + steps[j]
                tets.append((0, a, b, 7))
    return points, np.array(tets, np.int64)


def sphere_triangles(radius=1.0, rings=24, sectors=48):
    """Points on the sphere; the polyhedron lies within it."""
    theta = np.linspace(0, np.pi, rings + 1)[1:-1]
    phi = np.arange(sectors) * 2 * np.pi / sectors
    ring = np.stack((np.outer(np.sin(theta), np.cos(phi)), np.outer(np.sin(theta), np.sin(phi)),
                     np.outer(np.cos(theta), np.ones(sectors))), axis=-1).reshape(-1, 3)
    points = radius * np.concatenate(([[0, 0, 1.0]], ring, [[0, 0, -1.0]]))
    faces = []
    last = len(points) - 1
    for s in range(sectors):
        t = (s + 1) % sectors
        faces.append((0, 1 + s, 1 + t))
        for r in range(rings - 2):
            a, b = 1 + r * sectors, 1 + (r + 1) * sectors
            faces += [(a + s, b + s, b + t), (a + s, b + t, a + t)]
        b = 1 + (rings - 2) * sectors
        faces.append((last, b + t, b + s))
    return points, np.array(faces, np.int64)


def winding_number(points, faces, queries):
    """The generalised winding number, by Van Oosterom and Strackee's solid angles."""
    corners = points[faces][None] - np.asarray(queries)[:, None, None]
    a, b, c = corners[:, :, 0], corners[:, :, 1], corners[:, :, 2]
    la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    above = np.einsum("qfi,qfi->qf", a, np.cross(b, c))
    below = (la * lb * lc + np.einsum("qfi,qfi->qf", a, b) * lc
             + np.einsum("qfi,qfi->qf", b, c) * la + np.einsum("qfi,qfi->qf", c, a) * lb)
    return np.arctan2(above, below).sum(axis=1) / (2 * np.pi)


def distance_to_triangles(points, faces, queries):
    """To the nearest of all triangles, by the seven regions of each (brute force)."""
    best = np.full(len(queries), np.inf)
    for face in faces:
        a, b, c = points[face]
        for i, p in enumerate(queries):
            best[i] = min(best[i], _to_triangle(p, a, b, c))
    return best


def _to_segment(p, a, b):
    along = np.clip(np.dot(p - a, b - a) / np.dot(b - a, b - a), 0, 1)
    return np.linalg.norm(p - a - along * (b - a))


def _to_triangle(p, a, b, c):
    normal = np.cross(b - a, c - a)
    area = np.dot(normal, normal)
    if area > 0:
        u = np.dot(np.cross(c - b, p - b), normal) / area
        v = np.dot(np.cross(a - c, p - c), normal) / area
        if u >= 0 and v >= 0 and u + v <= 1:
            return abs(np.dot(p - a, normal)) / np.sqrt(area)
    return min(_to_segment(p, a, b), _to_segment(p, b, c), _to_segment(p, c, a))


@pytest.fixture
def cube():
    return cube_triangles()


@pytest.fixture
def tets():
    return cube_tets()


@pytest.fixture
def sphere():
    return sphere_triangles()
