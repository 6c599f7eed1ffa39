"""Characters that tests draw: whole ones as one outline, and parts of puppets."""

from itertools import pairwise

import numpy as np
import shapely

from nestedcages_core import Mesh, PuppetPart

LIMBS = {
    "torso": ((0, 0.2), (0, 1.0), 0.4),
    "head": ((0, 1.5), (0, 1.75), 0.33),
    "neck": ((0, 1.0), (0, 1.5), 0.13),
    "arm.L": ((0.3, 1.15), (1.7, 1.1), 0.15),
    "arm.R": ((-0.3, 1.15), (-1.7, 1.1), 0.15),
    "leg.L": ((0.22, 0), (0.28, -1.3), 0.17),
    "leg.R": ((-0.22, 0), (-0.28, -1.3), 0.17),
}
"""Ends and half the width of the limbs of a figure, y pointing up."""


def random_figure(seed: int) -> Mesh:
    """Trunk, head, arms and legs of random lengths, widths and directions, for some a tail."""
    rng = np.random.default_rng(seed)
    width, height, head = rng.uniform((0.28, 0.8, 0.25), (0.5, 1.4, 0.45))
    top = height + width + rng.uniform(0.1, 0.3) + head
    parts = [
        shapely.LineString([(0.0, 0.2), (0.0, height)]).buffer(width),
        shapely.Point(0.0, top).buffer(head),
        shapely.LineString([(0.0, height), (0.0, top)]).buffer(rng.uniform(0.1, 0.16)),
    ]

    def limb(place: tuple[float, float], angle: float, long: list[float], radii: tuple[float, float]) -> None:
        joints = [np.array(place)]
        for length in long:
            joints.append(joints[-1] + length * np.array([np.cos(angle), np.sin(angle)]))
            angle += rng.uniform(-0.25, 0.25)
        discs = [shapely.Point(c).buffer(r) for c, r in zip(joints, np.linspace(*radii, len(joints)), strict=True)]
        parts.extend(shapely.union(a, b).convex_hull for a, b in pairwise(discs))

    arm, arm_width, leg, leg_width = rng.uniform((0.5, 0.07, 0.55, 0.1), (0.8, 0.16, 0.9, 0.2))
    angle, spread = rng.uniform((-0.7, 0.05), (0.5, 0.4))
    for side in (1.0, -1.0):
        raised = angle if side > 0.0 else np.pi - angle
        limb((0.8 * side * width, height), raised, [arm, arm * rng.uniform(0.8, 1.1)], (arm_width, 0.9 * arm_width))
        hip = (side * max(0.55 * width, 1.3 * leg_width), 0.1)
        limb(hip, side * spread - 0.5 * np.pi, [leg, leg * rng.uniform(0.8, 1.1)], (leg_width, 0.8 * leg_width))
    if seed % 4 == 1:
        limb((0.8 * width, 0.3), -0.4, [0.5, 0.5, 0.4], (0.1, 0.05))
    whole = shapely.union_all(parts)
    return Mesh.of(shapely.segmentize(whole, 0.01 * np.hypot(*np.diff(np.reshape(whole.bounds, (2, 2)), axis=0)[0])))


def solid(name: str, area: shapely.Geometry, *groups: str) -> PuppetPart:
    return PuppetPart(name, Mesh.of(area), groups)


def limb(name: str, *points: tuple[float, float], width: float = 1.0) -> PuppetPart:
    return solid(name, shapely.LineString(points).buffer(0.5 * width))


def ball(name: str, x: float, y: float, radius: float) -> PuppetPart:
    return solid(name, shapely.Point(x, y).buffer(radius))


def front_figure() -> list[PuppetPart]:
    """A figure from the front: legs behind the torso, arms over it with hands below the arms, and a face."""
    parts = [limb(f"thigh_{s}", (k * 1.0, -1.0), (k * 1.1, -4.0)) for s, k in (("l", 1), ("r", -1))]
    parts += [limb(f"shin_{s}", (k * 1.1, -4.0), (k * 1.2, -7.0), width=0.9) for s, k in (("l", 1), ("r", -1))]
    parts += [limb("neck", (0.0, 3.0), (0.0, 4.4), width=0.8)]
    parts += [solid("torso", shapely.box(-1.6, -1.4, 1.6, 3.4).buffer(0.3))]
    parts += [ball("head", 0.0, 5.5, 1.5), ball("eye_l", 0.5, 5.8, 0.3), ball("eye_r", -0.5, 5.8, 0.3)]
    parts += [ball("pupil_l", 0.5, 5.8, 0.12), ball("pupil_r", -0.5, 5.8, 0.12)]
    for s, k in (("l", 1), ("r", -1)):
        parts += [ball(f"hand_{s}", k * 3.4, -0.4, 0.6)]
        parts += [limb(f"arm_{s}", (k * 1.6, 3.0), (k * 3.4, 0.0), width=0.9)]
    return parts


def side_figure() -> list[PuppetPart]:
    """A figure from the side that looks to the right: one arm and one leg behind the body, one of each before it."""
    far = [limb("leg_far", (0.2, -1.0), (0.2, -5.0), width=0.9), limb("arm_far", (0.2, 2.6), (0.2, -0.4), width=0.7)]
    near = [limb("leg", (-0.2, -1.0), (-0.2, -5.0), width=0.9), limb("arm", (-0.2, 2.6), (-0.2, -0.4), width=0.7)]
    body = [solid("body", shapely.box(-1.0, -1.6, 1.0, 3.0).buffer(0.3)), ball("head", 0.2, 4.2, 1.2)]
    return [*far, *body, ball("eye", 0.9, 4.4, 0.2), ball("ear", 0.3, 4.2, 0.25), *near]
