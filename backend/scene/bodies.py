"""The actuator's rigid parts and the faces of those that bend, each a mesh in the frame that carries it."""

import math

import numpy as np

from backend.scene import geometry
from backend.scene.solids import Faces, Mesh, ball, bar_outline, join, lathe, moved, plate, ribbon_faces, turned

RING_OUTER = 0.62
RING_INNER = 0.5
LINK_REACH = 1.15
BALL_RADIUS = 0.095
ROLLER_RADIUS = 0.027
FLOOR = -0.86
BOLTS = 8


def motor_ring() -> Mesh:
    """The gear's output ring, which carries the rollers."""
    return lathe(
        [
            (RING_INNER, -0.12),
            (RING_OUTER, -0.12),
            (RING_OUTER, 0.07),
            (RING_OUTER - 0.025, 0.1),
            (RING_INNER + 0.015, 0.1),
            (RING_INNER, 0.085),
            (RING_INNER, -0.12),
        ],
        segments=96,
    )


def motor_bolts() -> Mesh:
    """The ring's bolts: they make its turning visible."""
    bolt = lathe([(0.026, 0.09), (0.026, 0.108), (0.0, 0.108)], segments=14)
    radius = 0.5 * (RING_OUTER + RING_INNER)
    angles = [2.0 * math.pi * (number + 0.5) / BOLTS for number in range(BOLTS)]
    return join(*(moved(bolt, radius * math.cos(angle), radius * math.sin(angle)) for angle in angles))


def motor_plate() -> Mesh:
    """The plate behind the leaf springs."""
    return lathe([(RING_INNER + 0.01, -0.08), (0.0, -0.08)], segments=64)


def rollers(radius: float) -> Mesh:
    """A pair of rollers about each leaf, at that distance from the joint axis, in the motor's frame."""
    pin = lathe([(ROLLER_RADIUS, -0.08), (ROLLER_RADIUS, 0.075), (ROLLER_RADIUS - 0.008, 0.085), (0.0, 0.085)], 20)
    gap = 0.5 * geometry.LEAF_THICKNESS + ROLLER_RADIUS
    pair = join(moved(pin, radius, gap), moved(pin, radius, -gap))
    return join(*((turned(pair[0], angle), pair[1]) for angle in geometry.LEAF_ANGLES))


def motor_body() -> Mesh:
    """Gear housing, motor and foot, which stand still."""
    housing = lathe([(0.0, -0.46), (0.5, -0.46), (0.53, -0.43), (0.53, -0.13), (0.0, -0.13)], segments=64)
    motor = lathe([(0.0, -0.98), (0.37, -0.98), (0.4, -0.95), (0.4, -0.46), (0.0, -0.46)], segments=64)
    foot = plate(np.array([(-0.3, FLOOR), (0.3, FLOOR), (0.2, -0.3), (-0.2, -0.3)]), -0.44, -0.2)
    return join(motor, housing, foot)


def floor_shadow() -> Mesh:
    """A soft patch on the floor under the actuator."""
    angle = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)
    vertices = np.column_stack([0.95 * np.cos(angle), np.full(64, FLOOR), -0.35 - 0.95 * np.sin(angle)])
    spoke = np.arange(1, 63)
    faces = np.stack([np.zeros(62, dtype=np.int64), spoke, spoke + 1], axis=1)
    return vertices.astype(np.float32), faces.astype(np.uint32)


def link_hub() -> Mesh:
    """The link's hub, in which the leaf springs are clamped."""
    outer = geometry.HUB_RADIUS + 0.02
    return lathe([(outer, -0.07), (outer, 0.11), (outer - 0.02, 0.13), (0.0, 0.13)], segments=48)


def link_bar() -> Mesh:
    """The link with its end ball, along +x."""
    bar = plate(bar_outline(0.0, LINK_REACH - BALL_RADIUS, 0.075, 0.058), 0.13, 0.205, bevel=0.016)
    return join(bar, moved(ball(BALL_RADIUS, 0.165), LINK_REACH - BALL_RADIUS))


def ghost_bar() -> Mesh:
    """Where the link should be: a flat bar just behind it."""
    return plate(bar_outline(0.0, LINK_REACH - BALL_RADIUS, 0.075, 0.075), 0.112, 0.122)


def leaf_faces() -> Faces:
    """Faces of `geometry.all_leaves`."""
    one, corners = ribbon_faces(geometry.LEAF_STATIONS), np.uint32(8 * geometry.LEAF_STATIONS)
    return np.concatenate([one + np.uint32(number) * corners for number in range(len(geometry.LEAF_ANGLES))])


def arrow_faces() -> Faces:
    """Faces of `geometry.arrow_vertices`."""
    return ribbon_faces(geometry.ARROW_STATIONS + 2)
