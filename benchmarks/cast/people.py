"""People and a robot, from the front and from the side."""

from __future__ import annotations

from .sheet import INK, Sheet


def girl() -> Sheet:
    """A girl from the front, in groups: legs, body, arms, head."""
    s = Sheet(420, 620)
    skin, dress, hair = "#f1c49c", s.gradient("dress", "#d95d7c", "#a83b62"), "#5b3424"
    s.group("back")
    s.blob(
        "hair_back",
        "head",
        [(130, 110), (160, 50), (210, 36), (260, 50), (290, 110), (286, 220), (210, 236), (134, 220)],
        hair,
    )
    s.group("legs")
    for side, k in (("r", -1), ("l", 1)):
        x = 210 + 26 * k
        s.limb(f"shin_{side}", f"thigh_{side}", (x + 2 * k, 470), (x + 3 * k, 562), (34, 26), skin)
        s.limb(f"thigh_{side}", "dress", (x, 380), (x + 2 * k, 470), (42, 34), skin)
        s.ellipse(f"shoe_{side}", f"shin_{side}", (x + 10 * k, 572), 28, 14, "#3b3f73")
    s.group("body")
    s.limb("neck", "dress", (210, 236), (210, 196), (32, 30), skin)
    s.blob(
        "dress",
        None,
        [(168, 236), (210, 226), (252, 236), (256, 310), (300, 410), (210, 430), (120, 410), (164, 310)],
        dress,
    )
    s.box("belt", "dress", (210, 312), 90, 16, "#f2d16b")
    s.blob("collar", "dress", [(182, 234), (210, 228), (238, 234), (210, 256)], "#fff")
    s.group("arms")
    for side, k in (("r", -1), ("l", 1)):
        s.circle(f"hand_{side}", f"forearm_{side}", (210 + 116 * k, 398), 17, skin)
        s.limb(f"forearm_{side}", f"upper_arm_{side}", (210 + 86 * k, 316), (210 + 114 * k, 388), (26, 20), skin)
        s.limb(f"upper_arm_{side}", "dress", (210 + 46 * k, 252), (210 + 86 * k, 316), (38, 28), dress)
    s.group("head")
    s.blob(
        "head",
        "neck",
        [(144, 130), (160, 80), (210, 62), (260, 80), (276, 130), (256, 186), (210, 210), (164, 186)],
        skin,
    )
    for side, k in (("r", -1), ("l", 1)):
        x = 210 + 28 * k
        s.eye(f"eye_{side}", "head", (x, 136), 13, (0.1, 0.1))
        s.line(f"brow_{side}", "head", [(x - 12, 114), (x, 109), (x + 12, 114)], 4, hair)
        s.ellipse(f"cheek_{side}", "head", (x + 10 * k, 162), 11, 7, "#ef9f93", ink=0)
    s.line("nose", "head", [(208, 148), (214, 156), (207, 158)], 2.5, "#b07b5a")
    s.line("mouth", "head", [(192, 174), (210, 183), (228, 174)], 3.5, "#a8323e")
    s.blob(
        "fringe",
        "head",
        [(140, 120), (158, 62), (210, 44), (262, 62), (280, 120), (240, 92), (200, 100), (170, 94)],
        hair,
    )
    s.rides |= {"hair_back", "belt", "collar", "nose", "mouth", "fringe", "cheek_l", "cheek_r", "brow_l", "brow_r"}
    return s


def walker() -> Sheet:
    """A man who walks to the right: near arm over the coat, far arm behind it."""
    s = Sheet(420, 640)
    skin, coat, dark, cloth = "#d9a47c", "#4a7a8c", "#3a6270", "#3d3a4d"
    s.limb("far_upper_arm", "coat", (206, 226), (232, 304), (40, 34), dark)
    s.limb("far_forearm", "far_upper_arm", (232, 304), (276, 360), (32, 24), dark)
    s.circle("far_hand", "far_forearm", (284, 368), 15, skin)
    for depth, hip, knee, ankle in (
        ("far", (204, 388), (176, 474), (128, 548)),
        ("near", (212, 390), (246, 476), (238, 574)),
    ):
        colour = cloth if depth == "near" else "#2f2c3c"
        s.blob(
            f"{depth}_shoe",
            f"{depth}_shin",
            [
                (ankle[0] - 16, ankle[1] + 22),
                (ankle[0] - 14, ankle[1] - 8),
                (ankle[0] + 14, ankle[1] - 6),
                (ankle[0] + 46, ankle[1] + 14),
                (ankle[0] + 44, ankle[1] + 24),
            ],
            "#6b3f2a",
        )
        s.limb(f"{depth}_shin", f"{depth}_thigh", knee, ankle, (38, 28), colour)
        s.limb(f"{depth}_thigh", "coat", hip, knee, (58, 42), colour)
    s.limb("neck", "coat", (210, 206), (214, 168), (34, 30), skin)
    s.blob(
        "coat",
        None,
        [(170, 216), (210, 198), (248, 220), (256, 310), (266, 410), (206, 424), (156, 408), (164, 310)],
        coat,
    )
    s.line("coat_edge", "coat", [(240, 222), (246, 310), (250, 408)], 3, INK)
    for k in range(3):
        s.circle(f"button_{k}", "coat", (234 + 3 * k, 262 + 44 * k), 5, "#e8d38a", ink=1)
    s.blob(
        "head",
        "neck",
        [(166, 116), (184, 70), (230, 62), (262, 96), (276, 124), (258, 134), (252, 166), (214, 180), (178, 160)],
        skin,
    )
    s.blob(
        "hair",
        "head",
        [(158, 128), (160, 74), (204, 44), (256, 66), (262, 92), (216, 92), (200, 120), (184, 140)],
        "#4d3a2c",
    )
    s.ellipse("ear", "head", (206, 126), 10, 14, "#c98f66")
    s.eye("eye", "head", (242, 108), 8, (0.3, 0.0))
    s.line("brow", "head", [(230, 92), (242, 88), (254, 93)], 4, "#4d3a2c")
    s.line("mouth", "head", [(236, 150), (248, 152), (254, 147)], 3, "#8c3b3b")
    s.limb("near_forearm", "near_upper_arm", (186, 306), (212, 376), (36, 26), coat)
    s.circle("near_hand", "near_forearm", (217, 386), 17, skin)
    s.limb("near_upper_arm", "coat", (206, 230), (186, 306), (46, 38), coat)
    s.rides |= {"coat_edge", "button_0", "button_1", "button_2", "hair", "ear", "brow", "mouth"}
    return s


def robot() -> Sheet:
    """A robot of plates from three quarters: the far arm lies behind the torso, pins hold the joints."""
    s = Sheet(460, 560)
    steel, dark, blue = "#a9b8c6", "#74838f", "#5b8bb0"
    s.box("far_arm", "chest", (306, 232), 34, 110, dark)
    s.box("far_forearm", "far_arm", (310, 316), 30, 96, "#84939f")
    s.polygon(
        "far_claw", "far_forearm", [(296, 350), (326, 350), (338, 388), (318, 376), (304, 376), (286, 388)], "#d28f3e"
    )
    for depth, x, colour in (("far", 262, dark), ("near", 192, steel)):
        s.box(f"{depth}_foot", f"{depth}_shin", (x - 6, 516), 70, 24, "#39424d")
        s.box(f"{depth}_shin", f"{depth}_thigh", (x, 458), 34, 112, colour)
        s.box(f"{depth}_thigh", "hips", (x, 384), 40, 96, colour)
        s.circle(f"{depth}_knee_pin", f"{depth}_shin", (x, 416), 8, "#eee", ink=2)
    s.box("hips", None, (228, 346), 130, 44, blue)
    s.limb("neck", "chest", (232, 172), (232, 128), (30, 30), dark)
    s.box("chest", "hips", (230, 250), 172, 170, steel, 22)
    s.box("panel", "chest", (246, 238), 84, 62, "#2f3a46")
    for k, colour in enumerate(("#e0524d", "#e6c34a", "#63b667")):
        s.circle(f"lamp_{k}", "panel", (222 + 24 * k, 238), 8, colour, ink=1)
    s.box("head", "neck", (232, 92), 120, 88, blue, 20)
    s.box("visor", "head", (226, 86), 88, 30, "#1d2630", 14)
    for k in (0, 1):
        s.circle(f"eye_{k}", "visor", (206 + 40 * k, 86), 9, "#7ff0e0", ink=0)
    s.line("antenna", "head", [(252, 52), (262, 20)], 5, INK)
    s.circle("bulb", "antenna", (263, 16), 9, "#e0524d")
    s.box("near_forearm", "near_arm", (134, 322), 34, 100, "#bccad6")
    s.polygon(
        "near_claw", "near_forearm", [(118, 358), (150, 358), (162, 398), (142, 386), (126, 386), (108, 398)], "#e6a24a"
    )
    s.box("near_arm", "chest", (140, 236), 40, 112, steel)
    s.circle("near_shoulder_pin", "near_arm", (140, 196), 9, "#eee", ink=2)
    s.circle("near_elbow_pin", "near_forearm", (138, 282), 8, "#eee", ink=2)
    s.rides |= {"panel", "lamp_0", "lamp_1", "lamp_2", "visor", "eye_0", "eye_1", "near_shoulder_pin"}
    s.rides |= {"near_elbow_pin", "near_knee_pin", "far_knee_pin"}
    return s
