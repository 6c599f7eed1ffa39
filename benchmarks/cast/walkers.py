"""Animals from the side, on two and four legs."""

from __future__ import annotations

from .sheet import INK, Sheet


def legs(
    sheet: Sheet, name: str, body: str, hip: tuple[float, float], colour: str, widths: tuple[float, float, float],
    bends: tuple[tuple[float, float], tuple[float, float], tuple[float, float]], foot: str = "paw",
) -> None:  # fmt: skip
    """A leg from the hip: thigh, shin and foot; bends: from joint to joint."""
    x, y = hip
    knee = (x + bends[0][0], y + bends[0][1])
    ankle = (knee[0] + bends[1][0], knee[1] + bends[1][1])
    toe = (ankle[0] + bends[2][0], ankle[1] + bends[2][1])
    stem, _, depth = name.partition("_")
    thigh, shin, end = (f"{stem}_{part}_{depth}" for part in ("upper", "lower", foot))
    sheet.limb(end, shin, ankle, toe, (widths[2], widths[2] * 0.8), colour)
    sheet.limb(shin, thigh, knee, ankle, (widths[1], widths[2]), colour)
    sheet.limb(thigh, body, hip, knee, (widths[0], widths[1]), colour)


def cat() -> Sheet:
    """A cat that walks to the left; the head lies over the body, the tail behind it."""
    s = Sheet(520, 400)
    fur, dark, light = "#e8954a", "#c97a35", "#f8d9b0"
    s.tail("tail", "body", [(392, 210), (430, 200), (455, 150), (440, 100), (462, 62)], [26, 25, 22, 18, 10], fur)
    front, back = ((-4, 46), (2, 50), (-20, 6)), ((14, 44), (-10, 54), (-20, 4))
    legs(s, "hind_far", "body", (372, 236), dark, (54, 28, 20), back)
    legs(s, "fore_far", "body", (236, 236), dark, (38, 26, 19), front)
    s.blob(
        "body",
        None,
        [(190, 205), (240, 172), (320, 168), (392, 182), (412, 226), (380, 272), (300, 270), (220, 276)],
        fur,
    )
    s.blob("belly", "body", [(230, 252), (300, 244), (360, 254), (300, 268)], light, 0)
    for k, x in enumerate((290, 320, 350)):
        s.line(f"stripe_{k}", "body", [(x, 172), (x + 3, 190), (x - 2, 205)], 7, dark)
    legs(s, "hind_near", "body", (356, 232), fur, (60, 30, 22), back)
    legs(s, "fore_near", "body", (218, 236), fur, (42, 28, 21), front)
    s.polygon("ear_far", "head", [(172, 132), (190, 84), (208, 128)], dark)
    s.blob("head", "body", [(110, 176), (124, 136), (164, 118), (204, 134), (216, 176), (190, 212), (138, 212)], fur)
    s.polygon("ear_near", "head", [(120, 142), (124, 88), (158, 124)], fur)
    s.polygon("ear_inside", "ear_near", [(127, 132), (129, 104), (148, 124)], "#f3b6a5")
    s.eye("eye_l", "head", (142, 160), 13, (-0.3, 0.1), "#dff3a6")
    s.eye("eye_r", "head", (182, 160), 13, (-0.3, 0.1), "#dff3a6")
    s.ellipse("muzzle", "head", (152, 190), 24, 15, light, ink=0)
    s.ellipse("nose", "muzzle", (150, 182), 7, 5, "#d0606a", ink=0)
    s.line("mouth", "muzzle", [(140, 194), (150, 199), (162, 194)], 2.5, INK)
    for k, y in enumerate((184, 192)):
        s.line(f"whisker_l_{k}", "muzzle", [(134, y), (96, y - 6 + 12 * k)], 1.6, INK)
        s.line(f"whisker_r_{k}", "muzzle", [(172, y), (216, y - 4 + 12 * k)], 1.6, INK)
    s.rides |= {"belly", "stripe_0", "stripe_1", "stripe_2", "ear_inside", "muzzle", "nose", "mouth"}
    return s


def horse() -> Sheet:
    """A horse that looks to the right, with mane, saddle and bridle."""
    s = Sheet(620, 520)
    coat, dark, hair = "#8a5a3c", "#6f4630", "#2f1f1a"
    s.tail("tail", "body", [(128, 190), (96, 214), (84, 280), (98, 350)], [20, 34, 36, 12], hair)
    fore, hind = ((4, 78), (-2, 84), (10, 24)), ((-16, 74), (16, 84), (12, 22))
    legs(s, "hind_far", "body", (176, 262), dark, (58, 32, 20), hind, "hoof")
    legs(s, "fore_far", "body", (388, 262), dark, (46, 30, 20), fore, "hoof")
    s.blob(
        "body",
        None,
        [(124, 196), (180, 164), (290, 176), (390, 160), (440, 200), (424, 266), (340, 290), (210, 290), (138, 264)],
        coat,
    )
    legs(s, "hind_near", "body", (160, 256), coat, (70, 36, 22), hind, "hoof")
    legs(s, "fore_near", "body", (402, 258), coat, (54, 34, 22), fore, "hoof")
    s.blob("saddle", "body", [(230, 166), (280, 178), (330, 162), (340, 220), (284, 236), (238, 220)], "#b8433f")
    s.limb("girth", "saddle", (286, 228), (286, 284), (14, 14), "#5b3b2a")
    s.polygon("ear_far", "head", [(496, 66), (512, 34), (520, 72)], dark)
    s.limb("neck", "body", (404, 204), (490, 96), (96, 54), coat)
    s.blob("mane", "neck", [(376, 170), (404, 112), (456, 62), (480, 72), (440, 116), (408, 176)], hair)
    s.limb("head", "neck", (494, 94), (560, 158), (58, 38), coat)
    s.polygon("ear_near", "head", [(474, 76), (482, 36), (502, 68)], coat)
    s.limb("muzzle", "head", (556, 152), (568, 166), (40, 38), "#d9b79b")
    s.circle("nostril", "muzzle", (572, 160), 4, INK, ink=0)
    s.circle("eye", "head", (508, 96), 7, INK, ink=0)
    s.line("cheek_strap", "head", [(494, 70), (500, 100), (520, 132)], 4, "#3b2a20")
    s.rides |= {"saddle", "girth", "mane", "muzzle", "nostril", "eye", "cheek_strap"}
    return s


def robin() -> Sheet:
    """A small bird that looks to the left, on thin legs."""
    s = Sheet(420, 400)
    back, dark = "#7d6a55", "#5f4f40"
    s.polygon("tail", "body", [(280, 220), (390, 196), (398, 226), (290, 258)], dark)
    s.line("leg_far", "body", [(226, 286), (222, 350)], 6, "#8d5a2b")
    s.line("foot_far", "leg_far", [(246, 352), (222, 349), (192, 352)], 6, "#8d5a2b")
    s.blob(
        "body",
        None,
        [(140, 220), (168, 168), (232, 160), (296, 208), (300, 252), (250, 296), (184, 296), (148, 262)],
        back,
    )
    s.blob("breast", "body", [(146, 226), (172, 190), (204, 214), (214, 262), (186, 288), (154, 260)], "#d8683a", 0)
    s.line("leg_near", "body", [(204, 288), (198, 354)], 7, "#a56a34")
    s.line("foot_near", "leg_near", [(224, 357), (198, 353), (166, 357)], 7, "#a56a34")
    s.blob("wing", "body", [(196, 208), (236, 196), (300, 232), (344, 258), (276, 264), (218, 250)], dark)
    for k in range(3):
        s.line(f"feather_{k}", "wing", [(236 + 16 * k, 226 + 5 * k), (276 + 14 * k, 246 + 3 * k)], 3, "#3f342b")
    s.polygon("beak_lower", "head", [(112, 158), (78, 164), (114, 170)], "#b88a3a")
    s.polygon("beak_upper", "head", [(114, 146), (72, 160), (116, 162)], "#d9a441")
    s.circle("head", "body", (160, 152), 52, back)
    s.blob("face", "head", [(114, 160), (128, 128), (156, 148), (166, 184), (142, 196)], "#d8683a", 0)
    s.eye("eye", "head", (144, 138), 9, (-0.2, 0.0))
    s.rides |= {"breast", "feather_0", "feather_1", "feather_2", "face"}
    return s


def dinosaur() -> Sheet:
    """A tyrannosaur that looks to the left, with a jaw, small arms and spikes."""
    s = Sheet(680, 460)
    skin, dark, light = "#6fae5c", "#578d48", "#d8e8a8"
    legs(s, "leg_far", "body", (352, 262), dark, (84, 44, 26), ((-20, 74), (20, 62), (-34, 6)), "foot")
    s.limb("arm_far", "body", (252, 244), (220, 266), (24, 16), dark)
    s.limb("hand_far", "arm_far", (220, 266), (206, 286), (16, 10), dark)
    for k, (x, y) in enumerate(((300, 148), (346, 158), (392, 176), (440, 196))):
        s.polygon(
            f"spike_{k}", "body" if k < 3 else "tail", [(x - 18, y + 22), (x + 4, y - 22), (x + 22, y + 22)], "#d96a4a"
        )
    s.tail("tail", "body", [(396, 240), (470, 236), (550, 262), (640, 240)], [100, 70, 40, 10], skin)
    s.blob(
        "body",
        None,
        [(226, 186), (290, 160), (380, 176), (430, 220), (420, 280), (350, 316), (270, 290), (226, 240)],
        skin,
    )
    s.blob("belly", "body", [(230, 232), (262, 250), (330, 300), (350, 312), (276, 290)], light, 0)
    legs(s, "leg_near", "body", (374, 258), skin, (100, 50, 30), ((-16, 84), (22, 66), (-40, 4)), "foot")
    s.limb("arm_near", "body", (262, 236), (228, 264), (28, 18), skin)
    s.limb("hand_near", "arm_near", (228, 264), (212, 288), (18, 12), skin)
    s.blob("jaw", "head", [(60, 186), (110, 180), (188, 172), (196, 196), (140, 214), (76, 208)], dark)
    s.limb("neck", "body", (262, 206), (204, 140), (92, 72), skin)
    s.blob(
        "head",
        "neck",
        [(44, 164), (76, 126), (150, 92), (216, 98), (236, 140), (206, 176), (130, 182), (66, 186)],
        skin,
    )
    for k in range(4):
        x = 78 + 24 * k
        s.polygon(f"tooth_{k}", "head", [(x, 178), (x + 7, 194), (x + 14, 177)], "#fff")
    s.eye("eye", "head", (168, 122), 12, (-0.3, 0.0), "#ffe27a")
    s.circle("nostril", "head", (74, 146), 5, INK, ink=0)
    s.rides |= {"belly", "nostril", *(f"tooth_{k}" for k in range(4)), *(f"spike_{k}" for k in range(4))}
    return s


def dragon() -> Sheet:
    """A dragon that looks to the right, with two wings, horns and belly plates."""
    s = Sheet(700, 560)
    skin, dark, light = "#5a6fb8", "#45579a", "#e6d39a"
    s.blob(
        "wing_far", "body", [(330, 250), (300, 130), (330, 40), (380, 96), (430, 80), (424, 150), (400, 240)], "#8d6fa8"
    )
    fore, hind = ((6, 60), (-4, 62), (26, 8)), ((-20, 62), (18, 64), (28, 6))
    legs(s, "hind_far", "body", (244, 356), dark, (80, 40, 28), hind)
    legs(s, "fore_far", "body", (424, 356), dark, (60, 36, 26), fore)
    s.tail("tail", "body", [(236, 330), (160, 360), (90, 340), (60, 270), (84, 214)], [96, 70, 46, 28, 12], skin)
    s.polygon("tail_tip", "tail", [(66, 236), (60, 176), (90, 150), (114, 186), (100, 234)], "#c8574e")
    s.blob(
        "body",
        None,
        [(200, 320), (250, 280), (350, 266), (440, 274), (476, 320), (450, 380), (350, 404), (240, 394)],
        skin,
    )
    s.tail("neck", "body", [(440, 316), (500, 270), (514, 200), (560, 148)], [104, 70, 54, 46], skin)
    for k, (x, y) in enumerate(((474, 318), (500, 280), (520, 240))):
        s.ellipse(f"plate_{k}", "neck", (x, y), 16, 9, light, turn=-60, ink=1.5)
    legs(s, "hind_near", "body", (266, 352), skin, (92, 44, 30), hind)
    legs(s, "fore_near", "body", (440, 354), skin, (70, 40, 28), fore)
    s.tail("horn_far", "head", [(560, 120), (540, 84), (548, 52)], [20, 14, 5], "#d9c9a0")
    s.limb("jaw", "head", (586, 158), (646, 176), (30, 18), dark)
    s.blob("head", "neck", [(530, 140), (552, 104), (600, 100), (664, 132), (668, 156), (610, 168), (556, 178)], skin)
    s.tail("horn_near", "head", [(574, 114), (556, 76), (568, 40)], [22, 15, 5], light)
    s.eye("eye", "head", (592, 126), 10, (0.3, 0.0), "#ffd35a")
    s.circle("nostril", "head", (652, 138), 4, INK, ink=0)
    s.blob(
        "wing_near",
        "body",
        [(352, 310), (270, 200), (210, 90), (290, 120), (330, 92), (360, 150), (410, 140), (408, 300)],
        "#a884c4",
    )
    s.line("wing_bone", "wing_near", [(372, 286), (300, 190), (224, 100)], 8, dark)
    s.rides |= {"plate_0", "plate_1", "plate_2", "nostril", "wing_bone"}
    return s
