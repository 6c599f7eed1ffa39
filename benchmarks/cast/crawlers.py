"""Creatures of the sea and the ground."""

from __future__ import annotations

from math import cos, pi, radians, sin

from .sheet import INK, Sheet


def fish() -> Sheet:
    """A fish that swims to the left."""
    s = Sheet(560, 340)
    body, fin = s.gradient("scales", "#f08a4b", "#f5c26b"), "#d9583b"
    s.blob("tail_fin", "body", [(398, 166), (470, 84), (492, 92), (470, 166), (496, 246), (474, 254)], fin)
    s.blob("dorsal_fin", "body", [(200, 96), (250, 38), (330, 50), (366, 120), (280, 120)], fin)
    s.blob("belly_fin", "body", [(240, 230), (272, 300), (310, 296), (304, 226)], fin)
    s.blob(
        "body",
        None,
        [(64, 172), (120, 102), (230, 72), (340, 110), (424, 158), (424, 182), (340, 222), (230, 256), (120, 234)],
        body,
    )
    for k, x in enumerate((196, 266, 336)):
        s.line(f"stripe_{k}", "body", [(x, 100 + 6 * k), (x + 14, 166), (x, 230 - 8 * k)], 15, "#fff3e0")
    s.blob("side_fin", "body", [(210, 178), (268, 166), (300, 196), (262, 222), (218, 204)], fin)
    s.eye("eye", "body", (124, 150), 19, (-0.2, 0.0))
    s.line("mouth", "body", [(70, 186), (88, 194), (106, 190)], 4, INK)
    s.line("gill", "body", [(166, 120), (178, 166), (164, 214)], 4, "#b5482f")
    s.rides |= {"stripe_0", "stripe_1", "stripe_2", "mouth", "gill"}
    return s


def octopus() -> Sheet:
    """An octopus from the front: four arms before the head's rim, four behind it."""
    s = Sheet(620, 560)
    skin, dark = "#b86fc6", "#94549f"
    for k, way in enumerate((150, 110, 70, 30)):
        _arm(s, f"arm_back_{k}", way, dark, 0.82, 44)
    s.blob(
        "head",
        None,
        [(170, 220), (196, 96), (310, 44), (424, 96), (450, 220), (404, 306), (310, 326), (216, 306)],
        skin,
    )
    for k, way in enumerate((168, 128, 52, 12)):
        _arm(s, f"arm_front_{k}", way, skin, 1.0, 50)
    for k, (x, y, r) in enumerate(((232, 120, 14), (270, 84, 9), (382, 112, 12))):
        s.circle(f"spot_{k}", "head", (x, y), r, "#dba6e2", ink=0)
    s.eye("eye_l", "head", (356, 204), 28, (0.0, 0.2))
    s.eye("eye_r", "head", (264, 204), 28, (0.0, 0.2))
    s.line("mouth", "head", [(284, 256), (310, 270), (336, 256)], 5, INK)
    s.rides |= {"spot_0", "spot_1", "spot_2", "mouth"}
    return s


def _arm(s: Sheet, name: str, way: float, colour: str, size: float, width: float) -> None:
    a = radians(way)
    x, y = 310 + 100 * cos(a), 262 + 20 * sin(a)
    points, widths = [], []
    for k in range(6):
        t = k / 5
        turn = a + (0.9 if cos(a) >= 0 else -0.9) * -t * t * 1.2
        points.append((x, y))
        widths.append(width * (1.0 - 0.8 * t))
        x, y = x + 42 * size * cos(turn), y + 42 * size * sin(turn) + 6
    s.tail(name, "head", points, widths, colour)


def beetle() -> Sheet:
    """A beetle from above, with six legs, horns and wing cases."""
    s = Sheet(460, 560)
    shell, dark = "#3f7d6a", "#2c4d48"
    for side, k in (("l", -1), ("r", 1)):
        for n, (y, rise) in enumerate(((210, -60), (280, 10), (340, 70))):
            knee, foot = (230 + 138 * k, y + rise * 0.6), (230 + 176 * k, y + rise * 1.6 + 16)
            s.limb(f"shin_{side}_{n}", f"leg_{side}_{n}", knee, foot, (14, 8), dark)
            s.limb(f"leg_{side}_{n}", "abdomen" if n else "thorax", (230 + 54 * k, y), knee, (24, 16), dark)
    s.blob(
        "abdomen",
        None,
        [(144, 300), (170, 246), (230, 232), (290, 246), (316, 300), (296, 420), (230, 470), (164, 420)],
        dark,
    )
    for side, k in (("l", -1), ("r", 1)):
        s.tail(
            f"antenna_{side}", "head", [(230 + 22 * k, 124), (230 + 60 * k, 84), (230 + 104 * k, 92)], [8, 7, 10], dark
        )
    s.blob("head", "thorax", [(186, 140), (200, 104), (230, 94), (260, 104), (274, 140), (230, 168)], "#355f58")
    s.tail("horn", "head", [(230, 120), (230, 74), (222, 36)], [24, 18, 8], dark)
    s.blob(
        "thorax",
        "abdomen",
        [(158, 204), (178, 160), (230, 148), (282, 160), (302, 204), (282, 250), (230, 262), (178, 250)],
        shell,
    )
    for side, k in (("l", -1), ("r", 1)):
        s.blob(
            f"wing_{side}",
            "abdomen",
            [(230 + 4 * k, 250), (230 + 66 * k, 250), (230 + 92 * k, 310), (230 + 70 * k, 410), (230 + 6 * k, 462)],
            shell,
        )
        s.circle(f"spot_{side}", f"wing_{side}", (230 + 46 * k, 330), 15, "#e2b84a", ink=0)
        s.circle(f"eye_{side}", "head", (230 + 34 * k, 126), 9, "#e8e0c8", ink=1.5)
    s.rides |= {"spot_l", "spot_r", "eye_l", "eye_r"}
    return s


def snake() -> Sheet:
    """A snake with a head of its own, a tongue and a pattern."""
    s = Sheet(680, 300)
    skin = "#7fae4a"
    path = [(60 + 11 * k, 170 + 42 * sin(2 * pi * k / 26)) for k in range(46)]
    s.tail("body", None, path, [6 + 38 * min(1.0, k / 14) for k in range(46)], skin)
    for k in range(4, 42, 6):
        s.ellipse(f"mark_{k // 6}", "body", path[k], 9 if k > 9 else 5, 9 if k > 9 else 5, "#4d7a2c", ink=0)
        s.rides.add(f"mark_{k // 6}")
    x, y = path[-1]
    s.line("tongue", "head", [(x + 60, y + 2), (x + 88, y + 4)], 4, "#d0405a")
    s.blob(
        "head",
        "body",
        [(x - 24, y - 2), (x - 4, y - 30), (x + 44, y - 22), (x + 68, y), (x + 44, y + 22), (x - 4, y + 28)],
        skin,
    )
    s.eye("eye", "head", (x + 26, y - 10), 8, (0.2, 0.0))
    s.line("mouth", "head", [(x + 30, y + 10), (x + 48, y + 11), (x + 62, y + 6)], 3, INK)
    s.rides |= {"mouth"}
    return s
