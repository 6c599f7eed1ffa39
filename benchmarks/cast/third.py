"""Twelve more characters, drawn after the weights of the graph were frozen: from the side, the front and above."""
# ruff: noqa: E501
# fmt: off

from __future__ import annotations

from math import cos, radians, sin

from .sheet import INK, Sheet


def fox() -> Sheet:
    """A fox that trots to the right; each leg is one piece with a sock over it."""
    s = Sheet(620, 420)
    fur, dark, white = "#d9702e", "#a9501d", "#fbf1e4"
    s.tail("tail", "body", [(178, 214), (120, 222), (70, 196), (34, 150)], [34, 56, 58, 10], fur)
    s.blob("tail_tip", "tail", [(30, 146), (66, 160), (82, 190), (52, 190)], white, 0)
    for name, x in (("hind", 206), ("fore", 384)):
        s.tail(f"{name}_leg_far", "body", [(x, 236), (x + 14, 296), (x - 4, 342), (x + 16, 376)], [52, 34, 20, 18], dark)
        s.ellipse(f"{name}_sock_far", f"{name}_leg_far", (x + 12, 372), 15, 14, INK)
    s.blob("body", None, [(168, 214), (220, 180), (320, 186), (400, 172), (432, 220), (392, 268), (290, 262), (196, 266)], fur)
    s.blob("chest", "body", [(398, 196), (434, 214), (420, 258), (384, 268), (378, 230)], white, 0)
    for name, x in (("hind", 196), ("fore", 396)):
        s.tail(f"{name}_leg_near", "body", [(x, 234), (x - 10, 300), (x - 30, 346), (x - 8, 384)], [60, 38, 22, 20], fur)
        s.ellipse(f"{name}_sock_near", f"{name}_leg_near", (x - 12, 382), 16, 14, INK)
    s.polygon("ear_far", "head", [(452, 104), (470, 44), (492, 100)], dark)
    s.limb("neck", "body", (404, 206), (454, 148), (72, 58), fur)
    s.blob("head", "neck", [(420, 132), (452, 94), (500, 100), (530, 136), (586, 160), (520, 178), (452, 176)], fur)
    s.blob("cheek", "head", [(446, 160), (490, 150), (540, 162), (500, 182), (458, 182)], white, 0)
    s.circle("nose", "head", (584, 158), 9, INK, ink=0)
    s.eye("eye", "head", (504, 130), 8, (0.3, 0.0))
    s.polygon("ear_near", "head", [(432, 116), (430, 44), (474, 100)], fur)
    s.polygon("ear_inside", "ear_near", [(440, 104), (438, 66), (460, 98)], white)
    s.rides |= {"tail_tip", "chest", "cheek", "nose", "ear_inside"}
    return s


def owl() -> Sheet:
    """An owl from the front, on its feet, with a book under a wing."""
    s = Sheet(420, 480)
    brown, light, gold = "#7a5a3c", "#d8b98a", "#e7a93a"
    s.blob("tail", "body", [(176, 400), (244, 400), (256, 462), (210, 472), (164, 462)], "#5d4229")
    s.ellipse("body", None, (210, 300), 112, 132, brown)
    s.ellipse("belly", "body", (210, 322), 74, 92, light, ink=0)
    for row in range(3):
        for k in range(3 - row % 2):
            s.ellipse(f"fleck_{row}_{k}", "belly", (182 + 28 * k + 14 * (row % 2), 284 + 34 * row), 7, 5, brown, ink=0)
            s.rides.add(f"fleck_{row}_{k}")
    for side, k in (("r", -1), ("l", 1)):
        s.blob(f"foot_{side}", "body", [(210 + 26 * k, 412), (210 + 62 * k, 412), (210 + 72 * k, 446), (210 + 18 * k, 446)], gold)
    s.polygon("book", "wing_l", [(276, 300), (352, 290), (360, 372), (284, 384)], "#a33b4a")
    for side, k in (("r", -1), ("l", 1)):
        s.blob(
            f"wing_{side}",
            "body",
            [(210 + 84 * k, 218), (210 + 124 * k, 250), (210 + 136 * k, 340), (210 + 96 * k, 384), (210 + 72 * k, 300)],
            "#634629",
        )
    for side, k in (("r", -1), ("l", 1)):
        s.polygon(f"tuft_{side}", "head", [(210 + 50 * k, 74), (210 + 96 * k, 30), (210 + 92 * k, 104)], "#5d4229")
    s.blob("head", "body", [(104, 136), (140, 78), (210, 64), (280, 78), (316, 136), (280, 202), (210, 220), (140, 202)], brown)
    for side, k in (("r", -1), ("l", 1)):
        s.circle(f"disc_{side}", "head", (210 + 48 * k, 138), 50, light)
        s.circle(f"eye_{side}", f"disc_{side}", (210 + 44 * k, 138), 28, gold)
        s.circle(f"pupil_{side}", f"eye_{side}", (210 + 42 * k, 140), 14, INK, ink=0)
        s.rides |= {f"disc_{side}", f"eye_{side}", f"pupil_{side}"}
    s.polygon("beak", "head", [(196, 154), (224, 154), (210, 186)], gold)
    s.rides |= {"belly", "beak"}
    return s


def astronaut() -> Sheet:
    """An astronaut from the front: a pack behind, a hose, gloves and boots."""
    s = Sheet(480, 640)
    suit, grey, blue = "#e9ecf2", "#aab2c0", "#3d6fb0"
    s.box("pack", "torso", (240, 300), 210, 190, grey, 20)
    for side, k in (("r", -1), ("l", 1)):
        x = 240 + 44 * k
        s.box(f"boot_{side}", f"shin_{side}", (x + 8 * k, 590), 70, 44, grey, 14)
        s.limb(f"shin_{side}", f"thigh_{side}", (x, 494), (x + 4 * k, 572), (62, 54), suit)
        s.limb(f"thigh_{side}", "torso", (x, 400), (x, 494), (76, 62), suit)
        s.line(f"stripe_{side}", f"thigh_{side}", [(x - 30, 452), (x, 458), (x + 30, 452)], 8, blue)
        s.rides.add(f"stripe_{side}")
    for side, k in (("r", -1), ("l", 1)):
        s.circle(f"glove_{side}", f"forearm_{side}", (240 + 176 * k, 388), 28, grey)
        s.limb(f"forearm_{side}", f"upper_arm_{side}", (240 + 142 * k, 316), (240 + 174 * k, 376), (54, 46), suit)
        s.limb(f"upper_arm_{side}", "torso", (240 + 84 * k, 246), (240 + 142 * k, 318), (66, 54), suit)
    s.blob("torso", None, [(150, 236), (190, 208), (290, 208), (330, 236), (322, 330), (310, 416), (170, 416), (158, 330)], suit)
    s.box("panel", "torso", (240, 318), 88, 54, grey, 8)
    for k, colour in enumerate(("#d94f4f", "#efc14a", "#5bb36a")):
        s.circle(f"button_{k}", "panel", (216 + 24 * k, 308), 8, colour, ink=0)
    s.line("dial", "panel", [(206, 330), (240, 336), (274, 330)], 5, INK)
    s.tail("hose", "torso", [(196, 318), (150, 350), (120, 320), (140, 270)], [12, 12, 12, 12], grey)
    s.circle("helmet", "torso", (240, 138), 92, suit)
    s.ellipse("visor", "helmet", (240, 140), 68, 54, "#2c3f63")
    s.ellipse("glint", "visor", (216, 118), 20, 10, "#9fb8e0", turn=-24.0, ink=0)
    s.line("antenna", "helmet", [(300, 74), (318, 48), (322, 24)], 6, grey)
    s.circle("antenna_knob", "antenna", (322, 22), 9, "#d94f4f")
    s.rides |= {"panel", "button_0", "button_1", "button_2", "dial", "visor", "glint", "antenna_knob", "pack"}
    return s


def monkey() -> Sheet:
    """A monkey from the front, one arm up, with a banana and a long tail."""
    s = Sheet(540, 600)
    fur, dark, skin = "#8a5a34", "#6c4426", "#e9bf93"
    s.tail("tail", "body", [(318, 420), (400, 440), (452, 380), (430, 300), (480, 260)], [26, 24, 22, 20, 14], dark)
    for side, k in (("r", -1), ("l", 1)):
        x = 270 + 52 * k
        s.ellipse(f"foot_{side}", f"leg_{side}", (x + 44 * k, 548), 40, 18, skin)
        s.tail(f"leg_{side}", "body", [(x, 414), (x + 34 * k, 470), (x + 26 * k, 540)], [56, 42, 30], fur)
    s.blob("body", None, [(204, 300), (230, 260), (310, 260), (336, 300), (340, 400), (300, 448), (240, 448), (200, 400)], fur)
    s.ellipse("belly", "body", (270, 366), 48, 62, skin, ink=0)
    s.tail("arm_r", "body", [(222, 284), (160, 320), (140, 390), (150, 430)], [46, 38, 30, 26], fur)
    s.circle("hand_r", "arm_r", (152, 444), 24, skin)
    s.tail("banana", "hand_l", [(440, 76), (420, 120), (424, 166), (452, 200)], [8, 28, 28, 8], "#f2d04a")
    s.tail("arm_l", "body", [(318, 284), (384, 270), (414, 210), (420, 160)], [46, 38, 30, 26], fur)
    s.circle("hand_l", "arm_l", (422, 148), 24, skin)
    for side, k in (("r", -1), ("l", 1)):
        s.circle(f"ear_{side}", "head", (270 + 92 * k, 164), 34, fur)
        s.circle(f"ear_inside_{side}", f"ear_{side}", (270 + 94 * k, 164), 20, skin, ink=0)
        s.rides.add(f"ear_inside_{side}")
    s.ellipse("head", "body", (270, 166), 92, 96, fur)
    s.blob("face", "head", [(214, 150), (240, 126), (270, 144), (300, 126), (326, 150), (322, 206), (270, 240), (218, 206)], skin, 0)
    s.eye("eye_r", "face", (244, 160), 13, (0.2, 0.1))
    s.eye("eye_l", "face", (296, 160), 13, (0.2, 0.1))
    s.ellipse("nose", "face", (270, 186), 12, 8, dark, ink=0)
    s.line("mouth", "face", [(238, 208), (270, 222), (302, 208)], 4, INK)
    s.rides |= {"belly", "face", "nose", "mouth"}
    return s


def lizard() -> Sheet:
    """A lizard from above, head to the right, legs spread."""
    s = Sheet(720, 380)
    skin, dark = "#6fae5c", "#4b8a3f"
    s.tail("tail", "body", [(250, 192), (170, 210), (100, 180), (30, 220)], [64, 44, 26, 4], skin)
    for end, x in (("hind", 274), ("fore", 452)):
        for side, k in (("r", 1), ("l", -1)):
            back = -1 if end == "hind" else 1
            knee, foot = (x + 26 * back, 190 + 96 * k), (x + 74 * back, 190 + 132 * k)
            for n in range(3):
                turn = radians(-50 + 50 * n)
                tip = (foot[0] + 34 * back * cos(turn), foot[1] + 34 * k * (0.4 + sin(turn) * 0.6))
                s.limb(f"{end}_toe_{side}_{n}", f"{end}_foot_{side}", foot, tip, (11, 5), dark)
            s.circle(f"{end}_foot_{side}", f"{end}_lower_{side}", foot, 15, dark)
            s.limb(f"{end}_lower_{side}", f"{end}_upper_{side}", knee, foot, (28, 20), skin)
            s.limb(f"{end}_upper_{side}", "body", (x, 190 + 34 * k), knee, (42, 28), skin)
    s.blob("body", None, [(226, 190), (280, 142), (370, 132), (470, 148), (512, 190), (470, 232), (370, 248), (280, 238)], skin)
    for n in range(4):
        s.ellipse(f"spot_{n}", "body", (290 + 58 * n, 190), 18, 12, dark, ink=0)
        s.rides.add(f"spot_{n}")
    s.blob("head", "body", [(496, 160), (560, 140), (620, 160), (648, 190), (620, 220), (560, 240), (496, 220)], skin)
    s.eye("eye_r", "head", (572, 222), 12, (0.3, 0.2), "#f3dd6b")
    s.eye("eye_l", "head", (572, 158), 12, (0.3, -0.2), "#f3dd6b")
    s.tail("tongue", "head", [(630, 190), (668, 184), (700, 194)], [10, 8, 6], "#d8485c")
    return s


def spider() -> Sheet:
    """A spider from above: eight legs of two parts under the middle body, the hind body over it."""
    s = Sheet(560, 560)
    hair, dark = "#5b4a6b", "#41344e"
    for side, k in (("r", 1), ("l", -1)):
        for n, angle in enumerate((-52, -18, 18, 54)):
            c, d = cos(radians(angle)) * k, sin(radians(angle))
            hip, knee = (280 + 30 * c, 250 + 34 * d), (280 + 140 * c, 250 + 150 * d - 20)
            tip = (280 + 220 * c, 250 + 210 * d + (40 if n > 1 else -30))
            s.limb(f"tip_{side}_{n}", f"leg_{side}_{n}", knee, tip, (16, 7), dark)
            s.limb(f"leg_{side}_{n}", "middle", hip, knee, (26, 17), hair)
    for side, k in (("r", 1), ("l", -1)):
        s.tail(f"fang_{side}", "middle", [(280 + 16 * k, 198), (280 + 30 * k, 170), (280 + 18 * k, 148)], [18, 14, 4], dark)
    s.ellipse("middle", None, (280, 250), 60, 62, hair)
    s.ellipse("abdomen", "middle", (280, 372), 88, 104, dark)
    s.polygon("mark", "abdomen", [(256, 340), (304, 340), (280, 372), (304, 410), (256, 410), (280, 372.5)], "#c9414e")
    for n, (x, y, r) in enumerate(((262, 216, 10), (298, 216, 10), (246, 230, 7), (314, 230, 7))):
        s.circle(f"eye_{n}", "middle", (x, y), r, "#f4f0e0", ink=1)
        s.circle(f"pupil_{n}", f"eye_{n}", (x, y - 2), r / 2, INK, ink=0)
        s.rides |= {f"eye_{n}", f"pupil_{n}"}
    s.rides |= {"mark"}
    return s


def mermaid() -> Sheet:
    """A mermaid who looks to the left: hair before and behind, a tail in one piece with a fluke, a shell in her hand."""
    s = Sheet(520, 700)
    skin, hair, scale = "#f0c39d", "#b5463c", "#3f9a8c"
    s.blob("hair_back", "head", [(196, 70), (270, 50), (320, 100), (330, 220), (300, 320), (250, 270), (230, 150)], hair)
    s.limb("upper_arm_far", "torso", (216, 250), (170, 310), (30, 26), "#dca983")
    s.limb("forearm_far", "upper_arm_far", (170, 310), (122, 276), (26, 20), "#dca983")
    s.circle("hand_far", "forearm_far", (112, 268), 14, "#dca983")
    s.blob("shell", "hand_far", [(80, 262), (92, 230), (124, 230), (134, 258), (106, 272)], "#f3d6c4")
    s.blob("fluke", "tail", [(330, 600), (380, 570), (470, 590), (420, 630), (440, 690), (370, 660), (320, 640)], "#2f7a70")
    s.tail("tail", "torso", [(242, 390), (238, 470), (270, 550), (344, 616)], [112, 100, 68, 34], scale)
    s.limb("neck", "torso", (236, 236), (226, 190), (34, 30), skin)
    s.blob("torso", None, [(190, 250), (236, 228), (280, 250), (272, 320), (290, 400), (196, 400), (206, 320)], skin)
    s.blob("top", "torso", [(192, 276), (236, 268), (276, 276), (268, 312), (236, 318), (204, 312)], "#8a5aa8")
    s.ellipse("belt", "torso", (242, 394), 58, 16, "#2f7a70")
    s.blob("head", "neck", [(166, 130), (184, 90), (228, 76), (268, 104), (268, 158), (236, 200), (192, 198), (172, 172)], skin)
    s.eye("eye", "head", (196, 138), 9, (-0.3, 0.0))
    s.line("brow", "head", [(184, 122), (196, 117), (210, 121)], 4, hair)
    s.line("mouth", "head", [(180, 178), (192, 182), (204, 176)], 4, "#b23b4a")
    s.blob("fringe", "head", [(170, 112), (190, 66), (250, 56), (284, 110), (262, 130), (236, 96)], hair)
    s.polygon("star", "fringe", [(252, 70), (260, 86), (278, 88), (264, 100), (268, 118), (252, 108), (236, 118), (240, 100), (226, 88), (244, 86)], "#f2c94c")
    s.limb("upper_arm_near", "torso", (268, 262), (312, 340), (32, 28), skin)
    s.limb("forearm_near", "upper_arm_near", (312, 340), (262, 396), (28, 22), skin)
    s.circle("hand_near", "forearm_near", (254, 404), 15, skin)
    s.rides |= {"top", "belt", "brow", "mouth", "fringe", "star"}
    return s


def rooster() -> Sheet:
    """A rooster that looks to the right: tail feathers, comb, wattle, feet with toes."""
    s = Sheet(520, 520)
    red, brown, yellow = "#cf3b34", "#a7622f", "#e8b13c"
    for n, (x, y) in enumerate(((40, 190), (60, 130), (110, 90))):
        s.tail(f"feather_{n}", "body", [(160, 270), (100 + 10 * n, 230 - 24 * n), (x, y)], [26, 34, 8], ("#2f5d50", "#3b7464", "#244a40")[n])
    for depth, x in (("far", 262), ("near", 226)):
        if depth == "near":
            s.blob("body", None, [(130, 268), (190, 226), (270, 220), (330, 250), (336, 320), (270, 374), (180, 360)], brown)
        colour = yellow if depth == "near" else "#c08f2b"
        for n in range(3):
            s.limb(f"toe_{depth}_{n}", f"shank_{depth}", (x, 460), (x + 34 - 34 * n, 482 - 6 * (n == 1)), (11, 7), colour)
        s.limb(f"shank_{depth}", f"drumstick_{depth}", (x + 4, 396), (x, 462), (15, 13), colour)
        s.limb(f"drumstick_{depth}", "body", (x, 336), (x + 4, 396), (64, 26), brown)
    s.tail("neck", "body", [(300, 288), (340, 220), (350, 150)], [92, 62, 50], "#d98a3a")
    s.blob("comb", "head", [(322, 96), (330, 56), (350, 82), (364, 46), (378, 82), (398, 62), (398, 106)], red)
    s.blob("wattle", "head", [(378, 150), (398, 146), (402, 190), (386, 200), (374, 180)], red)
    s.circle("head", "neck", (360, 124), 42, "#d98a3a")
    s.polygon("beak", "head", [(392, 108), (444, 128), (392, 142)], yellow)
    s.eye("eye", "head", (372, 114), 9, (0.3, 0.0))
    s.blob("wing", "body", [(190, 262), (260, 250), (296, 282), (256, 326), (170, 330), (150, 300)], "#7f4820")
    s.line("wing_line", "wing", [(180, 310), (220, 306), (260, 292)], 4, INK)
    s.rides |= {"wing_line"}
    return s


def crocodile() -> Sheet:
    """A crocodile from the side that looks to the left: upper and lower jaw, teeth, plates on its back."""
    s = Sheet(860, 360)
    skin, dark, pale = "#6d9a4b", "#50763a", "#cfd9a0"
    for n in range(3):
        s.polygon(f"tooth_low_{n}", "jaw_low", [(80 + 44 * n, 216), (94 + 44 * n, 216), (87 + 44 * n, 196)], "#fffbe8")
    s.blob("jaw_low", "head", [(40, 214), (130, 208), (240, 200), (270, 236), (180, 246), (60, 240)], pale)
    for name, x in (("fore", 356), ("hind", 548)):
        s.limb(f"{name}_foot_far", f"{name}_leg_far", (x - 2, 306), (x - 34, 312), (22, 16), dark)
        s.limb(f"{name}_leg_far", "body", (x, 240), (x - 2, 306), (52, 28), dark)
    for n in range(5):
        s.polygon(f"plate_{n}", "body", [(350 + 52 * n, 158), (376 + 52 * n, 122), (400 + 52 * n, 158)], dark)
    s.tail("tail", "body", [(580, 206), (680, 224), (760, 204), (840, 240)], [104, 66, 40, 6], skin)
    s.blob("body", None, [(270, 190), (340, 150), (460, 140), (580, 152), (640, 204), (580, 262), (440, 272), (310, 256)], skin)
    s.blob("belly", "body", [(320, 244), (440, 236), (570, 240), (560, 262), (440, 270), (330, 258)], pale, 0)
    s.blob("head", "body", [(26, 192), (60, 170), (180, 168), (220, 134), (280, 140), (320, 190), (290, 236), (220, 212), (60, 214)], skin)
    s.circle("brow", "head", (238, 144), 24, skin)
    s.eye("eye", "brow", (236, 142), 13, (-0.3, 0.0), "#f3e27a")
    s.ellipse("nostril", "head", (48, 180), 7, 4, INK, ink=0)
    for n in range(3):
        s.polygon(f"tooth_up_{n}", "head", [(60 + 48 * n, 208), (74 + 48 * n, 208), (67 + 48 * n, 228)], "#fffbe8")
        s.rides |= {f"tooth_up_{n}", f"tooth_low_{n}"}
    for name, x in (("fore", 330), ("hind", 572)):
        s.limb(f"{name}_foot_near", f"{name}_leg_near", (x - 2, 318), (x - 40, 326), (26, 18), skin)
        s.limb(f"{name}_leg_near", "body", (x, 236), (x - 2, 318), (62, 32), skin)
    s.rides |= {"belly", "brow", "nostril"}
    return s


def bat() -> Sheet:
    """A bat from the front: wings of an arm, a hand and a skin between, ears, small feet."""
    s = Sheet(760, 420)
    fur, skin, dark = "#4d4459", "#7b6b8c", "#332c3d"
    for side, k in (("r", -1), ("l", 1)):
        s.blob(
            f"skin_{side}",
            f"arm_{side}",
            [(380 + 40 * k, 200), (380 + 150 * k, 110), (380 + 330 * k, 150), (380 + 290 * k, 236), (380 + 210 * k, 220),
             (380 + 150 * k, 280), (380 + 60 * k, 270)],
            skin,
        )
        s.limb(f"finger_{side}", f"arm_{side}", (380 + 152 * k, 108), (380 + 332 * k, 148), (16, 8), dark)
        s.limb(f"arm_{side}", "body", (380 + 40 * k, 200), (380 + 152 * k, 108), (28, 18), fur)
        s.limb(f"foot_{side}", "body", (380 + 24 * k, 318), (380 + 30 * k, 356), (16, 10), dark)
    s.ellipse("body", None, (380, 252), 62, 84, fur)
    s.ellipse("belly", "body", (380, 270), 38, 54, skin, ink=0)
    for side, k in (("r", -1), ("l", 1)):
        s.polygon(f"ear_{side}", "head", [(380 + 18 * k, 96), (380 + 64 * k, 20), (380 + 62 * k, 124)], fur)
        s.polygon(f"ear_inside_{side}", f"ear_{side}", [(380 + 32 * k, 92), (380 + 58 * k, 44), (380 + 56 * k, 106)], "#c98aa0")
        s.rides.add(f"ear_inside_{side}")
    s.circle("head", "body", (380, 138), 66, fur)
    s.eye("eye_r", "head", (354, 128), 15, (0.1, 0.1), "#f6e58a")
    s.eye("eye_l", "head", (406, 128), 15, (-0.1, 0.1), "#f6e58a")
    s.blob("snout", "head", [(350, 164), (380, 150), (410, 164), (398, 186), (362, 186)], skin)
    s.ellipse("nose", "snout", (380, 160), 9, 6, INK, ink=0)
    for side, k in (("r", -1), ("l", 1)):
        s.polygon(f"fang_{side}", "snout", [(380 + 8 * k, 180), (380 + 18 * k, 180), (380 + 13 * k, 198)], "#ffffff")
        s.rides.add(f"fang_{side}")
    s.rides |= {"belly", "snout", "nose"}
    return s


def ballerina() -> Sheet:
    """A ballerina from the side who looks to the right: one leg back, both arms up, a tutu around her hips."""
    s = Sheet(560, 720)
    skin, pink, hair = "#f2cba8", "#e88fb0", "#4a3226"
    s.limb("arm_far_upper", "torso", (282, 238), (320, 180), (28, 24), "#dfb48e")
    s.limb("arm_far_lower", "arm_far_upper", (320, 180), (312, 110), (24, 18), "#dfb48e")
    s.ellipse("hand_far", "arm_far_lower", (308, 96), 11, 18, "#dfb48e")
    s.limb("thigh_back", "torso", (256, 392), (170, 452), (54, 42), "#dfb48e")
    s.limb("shin_back", "thigh_back", (170, 452), (74, 430), (40, 24), "#dfb48e")
    s.tail("shoe_back", "shin_back", [(84, 434), (50, 424), (20, 402)], [24, 20, 8], pink)
    s.limb("thigh_front", "torso", (276, 392), (284, 506), (58, 44), skin)
    s.limb("shin_front", "thigh_front", (284, 506), (282, 628), (42, 24), skin)
    s.tail("shoe_front", "shin_front", [(282, 616), (284, 656), (290, 700)], [26, 22, 8], pink)
    s.limb("neck", "torso", (268, 220), (274, 178), (26, 24), skin)
    s.blob("torso", None, [(238, 244), (266, 218), (298, 240), (296, 300), (288, 350), (300, 402), (236, 402), (250, 340)], pink)
    s.blob("tutu", "torso", [(120, 378), (240, 346), (300, 346), (420, 372), (400, 410), (270, 424), (140, 412)], "#f6c2d4")
    s.line("tutu_edge", "tutu", [(140, 400), (268, 412), (402, 396)], 5, pink)
    s.circle("bun", "head", (234, 112), 22, hair)
    s.ellipse("head", "neck", (274, 146), 40, 46, skin)
    s.blob("hair", "head", [(236, 150), (240, 108), (276, 94), (312, 112), (296, 126), (262, 128), (252, 162)], hair)
    s.eye("eye", "head", (294, 146), 6, (0.3, 0.0))
    s.polygon("nose", "head", [(308, 146), (324, 160), (308, 164)], skin)
    s.line("mouth", "head", [(292, 174), (300, 176), (306, 172)], 3, "#b23b4a")
    s.limb("arm_near_upper", "torso", (264, 240), (222, 190), (30, 26), skin)
    s.limb("arm_near_lower", "arm_near_upper", (222, 190), (214, 118), (26, 20), skin)
    s.ellipse("hand_near", "arm_near_lower", (212, 100), 12, 20, skin)
    s.rides |= {"tutu", "tutu_edge", "bun", "hair", "nose", "mouth"}
    return s


def snowman() -> Sheet:
    """A snowman from the front: three balls, a hat, stick arms with mittens, a broom."""
    s = Sheet(520, 640)
    snow, wood = "#eef4fa", "#7a5330"
    s.circle("base", None, (260, 500), 116, snow)
    for side, k in (("r", -1), ("l", 1)):
        s.line(f"arm_{side}", "chest", [(260 + 70 * k, 320), (260 + 130 * k, 290), (260 + 176 * k, 262)], 10, wood)
        s.line(f"twig_{side}", f"arm_{side}", [(260 + 134 * k, 288), (260 + 160 * k, 300)], 6, wood)
    s.circle("chest", "base", (260, 332), 88, snow)
    s.limb("broom", "mitten_l", (440, 150), (452, 420), (12, 12), wood)
    s.blob("bristles", "broom", [(436, 150), (420, 70), (440, 60), (462, 76), (450, 152)], "#d8b45a")
    for side, k in (("r", -1), ("l", 1)):
        s.circle(f"mitten_{side}", f"arm_{side}", (260 + 186 * k, 256), 24, "#b8383f")
    for n in range(3):
        s.circle(f"button_{n}", "chest", (260, 294 + 34 * n), 8, INK, ink=0)
        s.rides.add(f"button_{n}")
    s.circle("head", "chest", (260, 198), 68, snow)
    s.limb("scarf", "head", (206, 250), (314, 250), (30, 30), "#3d6fb0")
    s.limb("scarf_end", "scarf", (300, 254), (318, 326), (28, 30), "#345f96")
    s.polygon("carrot", "head", [(256, 192), (256, 214), (330, 214)], "#ea8432")
    for side, k in (("r", -1), ("l", 1)):
        s.circle(f"eye_{side}", "head", (260 + 26 * k, 178), 9, INK, ink=0)
        s.rides.add(f"eye_{side}")
    s.line("mouth", "head", [(228, 226), (258, 240), (290, 232)], 5, INK)
    s.box("crown", "brim", (260, 92), 96, 84, "#33364a", 6)
    s.box("band", "crown", (260, 122), 96, 18, "#b8383f", 0)
    s.box("brim", "head", (260, 140), 150, 18, "#33364a", 8)
    s.rides |= {"scarf", "carrot", "mouth", "band"}
    return s
