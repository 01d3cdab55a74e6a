"""What moves in the scene, as pure laws: deflection, leaf springs, rollers and the torque arrow.

The joint axis is z and points at the camera, so a positive angle turns counter-clockwise on the screen. Lengths are in
scene units (the link reaches 1.15); angles are in radians.
"""

import math
from typing import Final

import numpy as np

from backend.scene.solids import Vertices, ribbon, turned

MAGNIFICATION: Final = 8.0
"""How many times larger than real the deflection is drawn; the scene says so in its corner."""
LARGEST_SHOWN_DEFLECTION: Final = 0.6
"""Drawn deflections level off towards this angle [rad], so that a soft joint under load does not fold up."""

HUB_RADIUS: Final = 0.15
"""Where the leaf springs are clamped to the link's hub."""
LEAF_REACH: Final = 0.335
"""Drawn length of a whole leaf, from clamp to free end."""
LEAF_ANGLES: Final = tuple(math.pi * (0.25 + 0.5 * number) for number in range(4))
"""Directions of the leaves in the link's frame [rad]: between the link's bar, so that it hides none."""
LEAF_THICKNESS: Final = 0.038
LEAF_STATIONS: Final = 13
"""Stations along a leaf: all but two over the bent part, the rest over the straight, unloaded end."""

LENGTH_PER_TURN_M: Final = 0.005 / (2.0 * math.pi)
"""Leaf length per radian of the stiffness motor [m/rad]: a screw of 5 mm a turn."""
LEAF_LENGTH_RANGE_M: Final = (0.025, 0.092)
"""Free leaf length at the stiff and at the soft end stop [m]."""
SCENE_UNITS_PER_M: Final = 3.45

SMALLEST_SHOWN_TORQUE: Final = 0.1
"""Below this torque [N m] the arrow is hidden."""
LARGEST_SHOWN_TORQUE: Final = 12.0
"""From this torque [N m] on the arrow no longer grows."""
ARROW_RADIUS: Final = 0.93
ARROW_START: Final = 0.14
ARROW_PER_TORQUE: Final = 0.085
"""Length of the arrow [rad/(N m)]."""
ARROW_STATIONS: Final = 15


def magnified(deflection: float) -> float:
    """The angle [rad] drawn for a deflection theta_e - theta_l [rad]: `MAGNIFICATION` times it, levelling off."""
    return LARGEST_SHOWN_DEFLECTION * math.tanh(MAGNIFICATION * deflection / LARGEST_SHOWN_DEFLECTION)


def free_length(stiffness_motor_position: float) -> float:
    """Leaf length between clamp and roller, in scene units, from theta_ms [rad]: proportional, within the end stops."""
    shortest, longest = LEAF_LENGTH_RANGE_M
    return SCENE_UNITS_PER_M * min(max(LENGTH_PER_TURN_M * stiffness_motor_position, shortest), longest)


def roller_radius(length: float) -> float:
    """Distance of the rollers from the joint axis at a free length, both in scene units."""
    return HUB_RADIUS + length


def leaf_vertices(shown_deflection: float, length: float) -> Vertices:
    """Corners (8 `LEAF_STATIONS`, 3) of the leaf along +x of the link's frame.

    A cantilever clamped at the hub and loaded at the roller: w = w_L (3 u^2 - u^3) / 2 with u = x / L. The roller's end
    is seen from the joint axis at `shown_deflection`, the (magnified) angle by which the motor is ahead of the link;
    past the roller nothing loads the leaf, and it goes on straight. `length` is the free length in scene units.
    """
    contact_x = roller_radius(length) * math.cos(shown_deflection)
    contact_y = roller_radius(length) * math.sin(shown_deflection)
    bent = contact_x - HUB_RADIUS
    along = np.linspace(0.0, 1.0, LEAF_STATIONS - 2)
    slope = contact_y / bent * (3.0 * along - 1.5 * along**2)
    line = np.column_stack([HUB_RADIUS + bent * along, contact_y * (3.0 * along**2 - along**3) / 2.0])

    remaining = max(LEAF_REACH - length, 0.0)
    direction = np.array([1.0, slope[-1]]) / math.hypot(1.0, slope[-1])
    line = np.vstack([line, line[-1] + 0.5 * remaining * direction, line[-1] + remaining * direction])
    slope = np.append(slope, [slope[-1], slope[-1]])
    across = np.column_stack([-slope, np.ones_like(slope)]) / np.hypot(1.0, slope)[:, None]
    half = 0.5 * LEAF_THICKNESS * across
    return ribbon(line + half, line - half, -0.06, 0.07)


def all_leaves(shown_deflection: float, length: float) -> Vertices:
    """The corners of the four leaves, one after the other, in the link's frame."""
    leaf = leaf_vertices(shown_deflection, length)
    return np.concatenate([turned(leaf, angle) for angle in LEAF_ANGLES])


def arrow_span(torque: float) -> float:
    """Signed angle [rad] that the arrow of a link disturbance [N m] covers; 0 when it is too small to be shown.

    A positive disturbance pushes clockwise, as J_l theta_l'' = tau_s - b_l theta_l' - tau_d.
    """
    if not abs(torque) >= SMALLEST_SHOWN_TORQUE:
        return 0.0
    return -math.copysign(0.08 + ARROW_PER_TORQUE * min(abs(torque), LARGEST_SHOWN_TORQUE), torque)


def arrow_vertices(span: float) -> Vertices:
    """Corners (8 (`ARROW_STATIONS` + 2), 3) of an arc arrow in the link's frame, beside the bar, over `span` [rad]."""
    head = min(0.21, 0.6 * abs(span))
    shaft = np.linspace(0.0, abs(span) - head, ARROW_STATIONS)
    angle = math.copysign(1.0, span) * (ARROW_START + np.append(shaft, [shaft[-1], abs(span)]))
    width = np.append(np.full(ARROW_STATIONS, 0.024), [0.45 * head, 0.0])
    if span < 0.0:
        width = -width  # a mirrored arrow would be inside out
    ray = np.column_stack([np.cos(angle), np.sin(angle)])
    inner, outer = (ARROW_RADIUS - width)[:, None] * ray, (ARROW_RADIUS + width)[:, None] * ray
    return ribbon(inner, outer, 0.14, 0.18)
