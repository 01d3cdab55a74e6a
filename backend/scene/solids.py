"""Meshes of plain bodies: turned about the joint axis (z), cut from a plate, or bent ribbons.

A mesh is `(vertices, faces)`: (n, 3) float32 positions in scene units (the link is about 1 long) and (m, 3) uint32
corner numbers, counter-clockwise seen from outside.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Vertices = NDArray[np.float32]
Faces = NDArray[np.uint32]
Mesh = tuple[Vertices, Faces]


def lathe(profile: Sequence[tuple[float, float]], segments: int = 64, crisp: bool = True) -> Mesh:
    """Turn a profile about the z axis.

    Parameters
    ----------
    profile : (radius, z) points; with the solid on the left of the path when radius points right and z points up.
    segments : corners of a full circle.
    crisp : keep the edges between the profile's pieces sharp; False shades over them, for a sphere.
    """
    points = np.asarray(profile, dtype=np.float64)
    # Sharp edges need corners that are not shared, as normals are averaged over shared corners.
    rows = np.repeat(points, 2, axis=0)[1:-1] if crisp else points
    angle = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    radius, height = rows[:, :1], rows[:, 1:]
    vertices = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), np.broadcast_to(height, (len(rows), segments))], axis=-1
    )
    starts = range(0, len(rows) - 1, 2 if crisp else 1)
    return vertices.reshape(-1, 3).astype(np.float32), np.concatenate([_band(row, segments) for row in starts])


def _band(row: int, segments: int) -> Faces:
    """Faces between one ring of corners and the next."""
    here = row * segments + np.arange(segments)
    beside = row * segments + (np.arange(segments) + 1) % segments
    above, above_beside = here + segments, beside + segments
    lower = np.stack([here, beside, above_beside], axis=1)
    upper = np.stack([here, above_beside, above], axis=1)
    return np.concatenate([lower, upper]).astype(np.uint32)


def plate(outline: NDArray[np.float64], z_low: float, z_high: float, bevel: float = 0.0) -> Mesh:
    """Cut a plate from a convex outline (n, 2), counter-clockwise, with its front edge broken by `bevel`."""
    corners = len(outline)
    following = np.roll(outline, -1, axis=0) - outline
    edge = following / np.linalg.norm(following, axis=1, keepdims=True)
    normal = np.stack([edge[:, 1], -edge[:, 0]], axis=1)
    mitre = normal + np.roll(normal, 1, axis=0)
    inset = outline - bevel * 2.0 * mitre / np.sum(mitre**2, axis=1, keepdims=True)
    # Side, bevel and front are separate bands of corners, so that the edges between them stay sharp.
    levels = [(outline, z_low), (outline, z_high - bevel), (outline, z_high - bevel), (inset, z_high), (inset, z_high)]
    vertices = np.concatenate([np.column_stack([ring, np.full(corners, z)]) for ring, z in levels])
    front = np.arange(1, corners - 1) + 4 * corners
    fan = np.stack([np.full(corners - 2, 4 * corners), front, front + 1], axis=1).astype(np.uint32)
    return vertices.astype(np.float32), np.concatenate([_band(0, corners), _band(2, corners), fan])


def bar_outline(x_start: float, x_end: float, start_half_width: float, end_half_width: float) -> NDArray[np.float64]:
    """Outline (n, 2) of a tapered bar along x with round ends about `x_start` and `x_end`."""
    turn = np.linspace(-np.pi / 2.0, np.pi / 2.0, 17)
    end = np.column_stack([x_end + end_half_width * np.cos(turn), end_half_width * np.sin(turn)])
    start = np.column_stack([x_start - start_half_width * np.cos(turn), -start_half_width * np.sin(turn)])
    return np.concatenate([end, start])


def ball(radius: float, z: float, segments: int = 28) -> Mesh:
    """Sphere about (0, 0, z)."""
    polar = np.linspace(-np.pi / 2.0, np.pi / 2.0, segments // 2)
    return lathe([(float(radius * np.cos(p)), float(z + radius * np.sin(p))) for p in polar], segments, crisp=False)


def ribbon(left: NDArray[np.float64], right: NDArray[np.float64], z_low: float, z_high: float) -> Vertices:
    """Corners (8 n, 3) of a strip between two edges (n, 2); `ribbon_faces(n)` joins them.

    Each of the four sides has corners of its own, so that a thin strip is shaded flat and not as a round wire.
    """
    low, high = np.full(len(left), z_low), np.full(len(left), z_high)
    corners = [(left, high), (left, low), (right, low), (right, high)]
    edges = [np.column_stack([edge, z]) for edge, z in corners]
    sides = [edges[side + step & 3] for side in range(4) for step in (0, 1)]
    return np.concatenate(sides).astype(np.float32)


def ribbon_faces(stations: int) -> Faces:
    """Faces of a `ribbon` with that many stations, with both ends closed."""
    here = np.arange(stations - 1)
    start = 2 * stations * np.arange(4)
    end = start + stations - 1
    quads = [start[[[0, 1, 2], [0, 2, 3]]], end[[[0, 2, 1], [0, 3, 2]]]]
    for side in range(4):
        near, far = 2 * side * stations + here, (2 * side + 1) * stations + here
        quads += [np.stack([near, far + 1, far], axis=1), np.stack([near, near + 1, far + 1], axis=1)]
    return np.concatenate(quads).astype(np.uint32)


def join(*meshes: Mesh) -> Mesh:
    """One mesh out of several."""
    offsets = np.cumsum([0] + [len(vertices) for vertices, _ in meshes[:-1]])
    faces = [mesh[1] + np.uint32(offset) for mesh, offset in zip(meshes, offsets, strict=True)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(faces).astype(np.uint32)


def moved(mesh: Mesh, x: float = 0.0, y: float = 0.0) -> Mesh:
    """The mesh shifted in the plane of motion."""
    return mesh[0] + np.array([x, y, 0.0], dtype=np.float32), mesh[1]


def turned(vertices: Vertices, angle: float) -> Vertices:
    """Vertices (n, 3) turned about the z axis by `angle` [rad], counter-clockwise seen from +z."""
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y, z = vertices[:, 0], vertices[:, 1], vertices[:, 2]
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y, z]).astype(np.float32)
