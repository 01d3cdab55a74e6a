"""The actuator as viser nodes: built once, then moved by few messages a frame."""

import math
from dataclasses import astuple, dataclass

import numpy as np
import viser

from backend.scene import geometry
from backend.scene.bodies import (
    arrow_faces,
    floor_shadow,
    ghost_bar,
    leaf_faces,
    link_bar,
    link_hub,
    motor_body,
    motor_bolts,
    motor_plate,
    motor_ring,
    rollers,
)
from backend.scene.palette import DARK, rgb
from backend.scene.solids import Mesh

CAMERA_POSITION = (1.62, 1.05, 4.62)
CAMERA_TARGET = (0.26, -0.02, 0.0)
CAMERA_HEIGHT_ANGLE = math.radians(27.5)
SMALLEST_CHANGE = 1e-3
"""Smaller changes of a drawn angle [rad] or length are not seen, and are not sent."""


@dataclass(frozen=True)
class ScenePose:
    """What the scene shows at one moment: angles in rad, stiffness in N m/rad, torque in N m."""

    link_position: float
    reference: float
    motor_position: float
    deflection: float
    stiffness: float
    stiffness_motor_position: float
    link_disturbance: float


class ActuatorScene:
    """Motor, leaf springs, link, reference ghost and torque arrow on a viser server.

    The link and its ghost stand at their true angles. The motor is drawn ahead of the link by the magnified deflection,
    so that leaf springs, rollers and motor fit together.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._drawn_bend: tuple[float, float] | None = None
        self._drawn_span = 0.0
        with server.atomic():
            self._set_up_view()
            self._build()
        self.update(ScenePose(0.0, 0.0, 0.0, 0.0, 200.0, 53.7, 0.0))

    def update(self, pose: ScenePose) -> None:
        """Move the scene to a pose; one with a value that is not finite is left out."""
        if not all(math.isfinite(value) for value in astuple(pose)):
            return
        shown_deflection = geometry.magnified(pose.deflection)
        with self._server.atomic():
            self._link.wxyz = _about_axis(pose.link_position)
            self._ghost.wxyz = _about_axis(pose.reference)
            self._motor.wxyz = _about_axis(pose.link_position + shown_deflection)
            self._bend_leaves(shown_deflection, geometry.free_length(pose.stiffness_motor_position))
            self._draw_torque(geometry.arrow_span(pose.link_disturbance))

    def _bend_leaves(self, shown_deflection: float, length: float) -> None:
        before = self._drawn_bend
        if before is not None and max(abs(shown_deflection - before[0]), abs(length - before[1])) < SMALLEST_CHANGE:
            return
        self._leaves.vertices = geometry.all_leaves(shown_deflection, length)
        if before is None or abs(length - before[1]) >= SMALLEST_CHANGE:
            self._rollers.vertices = rollers(geometry.roller_radius(length))[0]
        else:
            length = before[1]  # the rollers still stand there: small steps must add up to one that is seen
        self._drawn_bend = (shown_deflection, length)

    def _draw_torque(self, span: float) -> None:
        if abs(span - self._drawn_span) >= SMALLEST_CHANGE:
            self._drawn_span = span
            self._arrow.visible = span != 0.0
            if span != 0.0:
                self._arrow.vertices = geometry.arrow_vertices(span)

    def _set_up_view(self) -> None:
        scene, camera = self._server.scene, self._server.initial_camera
        scene.set_up_direction("+y")
        scene.world_axes.visible = False
        scene.configure_default_lights(False)
        scene.configure_environment_map(None)
        # Mostly even light, as the colours carry meaning; the rest gives form.
        scene.add_light_ambient("/light/even", intensity=2.15)
        scene.add_light_directional("/light/key", intensity=1.1, position=(-1.5, 3.0, 4.0))
        scene.add_light_directional("/light/side", intensity=0.35, position=(4.0, 0.5, 2.0))
        camera.position = CAMERA_POSITION
        camera.look_at = CAMERA_TARGET
        camera.up = (0.0, 1.0, 0.0)
        camera.fov = CAMERA_HEIGHT_ANGLE
        self._server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)

    def _build(self) -> None:
        scene = self._server.scene
        self._motor = scene.add_frame("/motor", show_axes=False)
        self._ghost = scene.add_frame("/ghost", show_axes=False)
        self._link = scene.add_frame("/link", show_axes=False)
        self._add("/floor", floor_shadow(), "floor")
        self._add("/body", motor_body(), "body")
        self._add("/motor/plate", motor_plate(), "plate")
        self._add("/motor/ring", motor_ring(), "ring")
        self._add("/motor/bolts", motor_bolts(), "bolt")
        start = geometry.roller_radius(geometry.free_length(0.0))
        self._rollers = self._add("/motor/rollers", rollers(start), "roller")
        self._add("/ghost/bar", ghost_bar(), "reference", opacity=0.42)
        self._add("/link/hub", link_hub(), "hub")
        self._add("/link/bar", link_bar(), "link")
        straight = geometry.all_leaves(0.0, geometry.free_length(0.0))
        self._leaves = self._add("/link/leaves", (straight, leaf_faces()), "spring")
        self._arrow = self._add("/link/torque", (geometry.arrow_vertices(0.5), arrow_faces()), "disturbance")
        self._arrow.visible = False

    def _add(self, name: str, mesh: Mesh, role: str, opacity: float | None = None) -> viser.MeshHandle:
        return self._server.scene.add_mesh_simple(
            name, *mesh, color=rgb(DARK[role]), opacity=opacity, cast_shadow=False, receive_shadow=False
        )


def _about_axis(angle: float) -> np.ndarray:
    """Quaternion (w, x, y, z) of a turn about the joint axis by `angle` [rad]."""
    return np.array([math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle)])
