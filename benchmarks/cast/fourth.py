"""Ten more characters, drawn before the weights were fitted to all others, and measured once."""
# ruff: noqa: E501
# fmt: off

from __future__ import annotations

from .sheet import INK, Sheet
from .walkers import legs


def rabbit() -> Sheet:
    """A rabbit that sits upright and looks to the left, with a carrot in both paws and a waistcoat."""
    s = Sheet(420, 560)
    fur, dark, pink = "#cdbba7", "#a8937c", "#f0c3c0"
    s.circle("tail", "body", (306, 446), 32, "#f6efe6")
    s.tail("arm_far", "body", [(196, 300), (160, 340), (128, 344)], [34, 28, 22], dark)
    s.circle("paw_far", "arm_far", (120, 344), 15, dark)
    s.ellipse("foot_far", "body", (170, 516), 56, 20, dark)
    s.blob("body", None, [(186, 290), (230, 262), (276, 300), (306, 400), (290, 486), (220, 504), (172, 470), (166, 380)], fur)
    s.blob("waistcoat", "body", [(184, 296), (230, 268), (276, 304), (296, 390), (230, 410), (168, 384)], "#4a6fa5")
    for n in range(3):
        s.circle(f"button_{n}", "waistcoat", (186 + 2 * n, 320 + 26 * n), 6, "#e8c24a", ink=1)
        s.rides.add(f"button_{n}")
    s.ellipse("thigh_near", "body", (256, 452), 60, 52, fur)
    s.ellipse("foot_near", "thigh_near", (204, 518), 66, 22, fur)
    s.tail("ear_far", "head", [(210, 128), (214, 70), (238, 20)], [26, 36, 12], dark)
    s.blob("head", "body", [(126, 206), (150, 152), (206, 130), (256, 166), (258, 226), (214, 266), (158, 256)], fur)
    s.ellipse("muzzle", "head", (144, 222), 34, 26, "#f6efe6")
    s.ellipse("nose", "muzzle", (116, 208), 10, 7, pink)
    for n in range(2):
        s.line(f"whisker_{n}", "muzzle", [(140, 224 + 8 * n), (104, 230 + 14 * n), (76, 226 + 24 * n)], 2, INK)
        s.rides.add(f"whisker_{n}")
    s.eye("eye", "head", (184, 186), 13, (-0.3, 0.0))
    s.tail("ear_near", "head", [(232, 142), (250, 80), (290, 34)], [28, 40, 14], fur)
    s.tail("ear_near_inside", "ear_near", [(238, 122), (252, 82), (280, 48)], [8, 18, 6], pink)
    s.polygon("leaves", "carrot", [(112, 300), (84, 270), (104, 268), (112, 250), (126, 272), (138, 268), (126, 300)], "#4f9a4a")
    s.polygon("carrot", "paw_near", [(96, 298), (140, 298), (122, 404)], "#ea8432")
    s.tail("arm_near", "body", [(236, 312), (196, 366), (146, 356)], [42, 34, 26], fur)
    s.circle("paw_near", "arm_near", (134, 352), 18, fur)
    s.rides |= {"waistcoat", "muzzle", "nose", "ear_near_inside"}
    return s


def bee() -> Sheet:
    """A bee from the side that flies to the right."""
    s = Sheet(520, 380)
    gold, black, glass = "#f2c13d", "#2f2a2a", "#cfe4f2"
    s.blob("wing_far", "thorax", [(300, 160), (270, 80), (310, 30), (352, 60), (336, 150)], "#b8d2e4")
    for n, x in enumerate((286, 316, 344)):
        s.limb(f"leg_far_{n}", "thorax", (x, 230), (x - 6, 290), (11, 8), "#4a4242")
    s.polygon("sting", "abdomen", [(60, 236), (16, 254), (66, 262)], black)
    s.blob("abdomen", "thorax", [(54, 240), (96, 180), (190, 150), (270, 184), (278, 244), (200, 284), (100, 280)], gold)
    for n, x in enumerate((106, 158, 212)):
        s.blob(f"band_{n}", "abdomen", [(x - 12, 186 - 8 * n), (x + 12, 178 - 8 * n), (x + 18, 226), (x + 10, 274), (x - 12, 272), (x - 8, 226)], black, 0)
        s.rides.add(f"band_{n}")
    s.circle("thorax", None, (310, 200), 62, gold)
    s.ellipse("fuzz", "thorax", (302, 186), 40, 30, "#f7dc86", ink=0)
    for n, x in enumerate((280, 310, 340)):
        s.limb(f"shin_near_{n}", f"leg_near_{n}", (x + 2, 292), (x - 14, 330), (11, 8), black)
        s.limb(f"leg_near_{n}", "thorax", (x, 236), (x + 2, 292), (16, 11), black)
    s.tail("feeler_far", "head", [(408, 132), (430, 100), (462, 92)], [8, 7, 7], black)
    s.circle("head", "thorax", (398, 184), 54, gold)
    s.eye("eye", "head", (414, 172), 18, (0.3, 0.0))
    s.line("mouth", "head", [(404, 214), (422, 216), (436, 206)], 4, INK)
    s.circle("cheek", "head", (390, 206), 10, "#ef9a7a", ink=0)
    s.tail("feeler_near", "head", [(390, 136), (398, 96), (428, 74)], [8, 7, 7], black)
    s.circle("knob_near", "feeler_near", (430, 72), 9, black)
    s.blob("wing_near", "thorax", [(290, 168), (220, 110), (200, 50), (250, 40), (310, 90), (322, 160)], glass)
    s.line("vein", "wing_near", [(300, 150), (260, 100), (236, 64)], 3, "#8fb0c8")
    s.rides |= {"fuzz", "mouth", "cheek", "vein", "knob_near"}
    return s


def deer() -> Sheet:
    """A deer that looks to the left, with antlers."""
    s = Sheet(560, 560)
    fur, dark, light = "#b9824e", "#93633a", "#ead7b8"
    legs(s, "hind_far", "body", (396, 330), dark, (54, 26, 18), ((18, 70), (-12, 76), (-8, 18)))
    legs(s, "fore_far", "body", (236, 340), dark, (40, 24, 16), ((4, 66), (-2, 76), (-8, 18)))
    s.blob("tail", "body", [(434, 272), (470, 262), (476, 300), (450, 316)], light)
    s.blob("body", None, [(190, 300), (230, 264), (330, 262), (420, 262), (452, 310), (420, 352), (310, 356), (226, 368)], fur)
    for n, (x, y) in enumerate(((300, 290), (340, 284), (380, 296), (356, 310))):
        s.circle(f"spot_{n}", "body", (x, y), 8, light, ink=0)
        s.rides.add(f"spot_{n}")
    legs(s, "hind_near", "body", (406, 322), fur, (66, 30, 20), ((18, 76), (-14, 80), (-8, 18)))
    legs(s, "fore_near", "body", (222, 336), fur, (46, 26, 18), ((2, 70), (0, 78), (-8, 18)))
    s.tail("neck", "body", [(238, 318), (200, 250), (184, 180)], [92, 64, 48], fur)
    s.tail("antler_far", "head", [(190, 128), (210, 80), (196, 40)], [10, 9, 5], "#7d6a4f")
    s.tail("tine_far", "antler_far", [(206, 92), (232, 72), (240, 50)], [8, 7, 4], "#7d6a4f")
    s.blob("ear_far", "head", [(206, 140), (250, 118), (262, 134), (220, 156)], dark)
    s.blob("head", "neck", [(92, 186), (120, 162), (164, 132), (206, 136), (214, 176), (176, 204), (110, 212)], fur)
    s.ellipse("nose", "head", (98, 190), 12, 10, INK, ink=0)
    s.eye("eye", "head", (164, 160), 9, (-0.2, 0.0))
    s.line("mouth", "head", [(104, 206), (124, 206), (140, 202)], 3, INK)
    s.tail("antler_near", "head", [(176, 132), (170, 80), (140, 36)], [12, 10, 5], "#98835f")
    s.tail("tine_near", "antler_near", [(170, 90), (142, 78), (120, 84)], [9, 7, 4], "#98835f")
    s.blob("ear_near", "head", [(190, 146), (226, 150), (250, 176), (212, 172)], fur)
    s.rides |= {"nose", "mouth"}
    return s


def panda() -> Sheet:
    """A panda from the front that sits, with bamboo in one hand."""
    s = Sheet(480, 520)
    white, black = "#f6f4ee", "#2d2c31"
    for side, k in (("r", -1), ("l", 1)):
        s.circle(f"ear_{side}", "head", (240 + 84 * k, 84), 36, black)
    s.blob("body", None, [(150, 290), (190, 240), (290, 240), (330, 290), (342, 400), (290, 458), (190, 458), (138, 400)], white)
    s.blob("bib", "body", [(160, 270), (240, 236), (320, 270), (300, 310), (240, 322), (180, 310)], black, 0)
    for side, k in (("r", -1), ("l", 1)):
        s.tail(f"leg_{side}", "body", [(240 + 70 * k, 420), (240 + 120 * k, 440), (240 + 160 * k, 452)], [70, 66, 60], black)
        s.circle(f"sole_{side}", f"leg_{side}", (240 + 168 * k, 448), 34, black)
        s.ellipse(f"pad_{side}", f"sole_{side}", (240 + 172 * k, 456), 16, 12, "#d9a3a0", ink=0)
        s.rides.add(f"pad_{side}")
    s.tail("arm_r", "body", [(166, 286), (116, 334), (130, 390)], [58, 50, 42], black)
    s.limb("bamboo", "arm_l", (390, 200), (352, 380), (16, 16), "#6fa34a")
    s.blob("leaf_0", "bamboo", [(388, 214), (420, 180), (450, 178), (424, 206)], "#4f8436")
    s.blob("leaf_1", "bamboo", [(380, 252), (350, 226), (326, 228), (352, 250)], "#4f8436")
    s.tail("arm_l", "body", [(314, 286), (364, 330), (370, 300)], [58, 50, 44], black)
    s.ellipse("head", "body", (240, 156), 118, 104, white)
    for side, k in (("r", -1), ("l", 1)):
        s.ellipse(f"patch_{side}", "head", (240 + 52 * k, 150), 30, 36, black, turn=20.0 * k)
        s.circle(f"eye_{side}", f"patch_{side}", (240 + 48 * k, 148), 12, "#fff", ink=0)
        s.circle(f"pupil_{side}", f"eye_{side}", (240 + 47 * k, 150), 6, INK, ink=0)
        s.rides |= {f"patch_{side}", f"eye_{side}", f"pupil_{side}"}
    s.ellipse("nose", "head", (240, 192), 18, 12, black)
    s.line("mouth", "head", [(214, 218), (240, 226), (266, 218)], 4, INK)
    s.rides |= {"bib", "nose", "mouth"}
    return s


def pirate() -> Sheet:
    """A pirate from the front: hat, beard, a hook, a wooden leg, a sabre in his hand, a coat in front of his legs."""
    s = Sheet(520, 680)
    coat, skin, wood = "#7a2f3a", "#e6b48c", "#9a6b3f"
    s.limb("thigh_l", "coat", (300, 430), (304, 510), (60, 50), "#3c4a63")
    s.limb("shin_l", "thigh_l", (304, 510), (306, 594), (48, 40), "#3c4a63")
    s.blob("boot_l", "shin_l", [(280, 570), (332, 570), (338, 620), (380, 640), (284, 642)], INK)
    s.limb("thigh_r", "coat", (224, 430), (220, 520), (60, 46), "#3c4a63")
    s.limb("peg", "thigh_r", (220, 514), (220, 636), (24, 14), wood)
    s.polygon("blade", "hilt", [(82, 392), (98, 396), (70, 236), (40, 170), (52, 260)], "#d7dde5")
    s.limb("hilt", "hand_r", (88, 396), (94, 436), (14, 12), wood)
    s.tail("guard", "hilt", [(66, 402), (90, 398), (116, 404)], [10, 12, 10], "#e0b84a")
    s.blob("coat", None, [(190, 236), (262, 216), (334, 236), (344, 330), (372, 480), (262, 500), (152, 480), (180, 330)], coat)
    s.blob("shirt", "coat", [(228, 232), (262, 222), (296, 232), (286, 330), (262, 350), (238, 330)], "#f1ead8")
    s.box("belt", "coat", (262, 366), 166, 24, INK, 6)
    s.box("buckle", "belt", (262, 366), 36, 32, "#e0b84a", 4)
    s.limb("upper_arm_r", "coat", (196, 262), (138, 332), (58, 48), coat)
    s.limb("forearm_r", "upper_arm_r", (138, 332), (102, 404), (46, 38), coat)
    s.circle("hand_r", "forearm_r", (92, 418), 22, skin)
    s.limb("upper_arm_l", "coat", (328, 262), (388, 330), (58, 48), coat)
    s.limb("forearm_l", "upper_arm_l", (388, 330), (424, 396), (46, 38), coat)
    s.box("cuff_l", "forearm_l", (430, 408), 48, 30, "#c9a24a", 6)
    s.tail("hook", "cuff_l", [(432, 420), (442, 456), (470, 462), (474, 434)], [10, 9, 8, 4], "#aeb6c2")
    s.ellipse("head", "coat", (262, 164), 62, 72, skin)
    s.blob("beard", "head", [(206, 178), (234, 196), (262, 190), (290, 196), (318, 178), (306, 246), (262, 278), (218, 246)], "#5d3a24")
    s.line("mouth", "beard", [(244, 216), (262, 222), (282, 214)], 5, "#b23b4a")
    s.ellipse("nose", "head", (262, 174), 12, 14, "#d79a72")
    s.eye("eye_l", "head", (288, 150), 10, (0.0, 0.1))
    s.circle("eyepatch", "head", (236, 150), 16, INK)
    s.line("strap", "head", [(204, 132), (236, 144), (314, 112)], 4, INK)
    s.blob("hat", "head", [(150, 122), (190, 90), (214, 48), (262, 32), (310, 48), (334, 90), (374, 122), (262, 112)], INK)
    s.circle("skull", "hat", (262, 80), 18, "#f4f1e6")
    s.tail("feather", "hat", [(318, 70), (366, 50), (412, 64)], [8, 22, 8], "#4a8a5c")
    s.rides |= {"shirt", "belt", "buckle", "guard", "blade", "cuff_l", "beard", "mouth", "nose", "eyepatch", "strap", "hat", "skull"}
    return s


def scorpion() -> Sheet:
    """A scorpion from above: claws of two fingers, eight legs, a tail of segments with a sting."""
    s = Sheet(640, 560)
    shell, dark = "#b0703c", "#875128"
    for side, k in (("r", 1), ("l", -1)):
        for n in range(4):
            y = 250 + 34 * n
            s.limb(f"foot_{side}_{n}", f"leg_{side}_{n}", (320 + 118 * k, y + 14 * (n - 1)), (320 + 168 * k, y + 40 * (n - 1)), (12, 6), dark)
            s.limb(f"leg_{side}_{n}", "body", (320 + 40 * k, y), (320 + 118 * k, y + 14 * (n - 1)), (18, 12), shell)
        s.limb(f"arm_{side}", "body", (320 + 36 * k, 214), (320 + 116 * k, 170), (28, 22), shell)
        s.limb(f"forearm_{side}", f"arm_{side}", (320 + 116 * k, 170), (320 + 132 * k, 104), (24, 22), shell)
        s.tail(f"finger_{side}", f"claw_{side}", [(320 + 150 * k, 76), (320 + 160 * k, 40), (320 + 136 * k, 14)], [20, 16, 4], dark)
        s.tail(f"claw_{side}", f"forearm_{side}", [(320 + 132 * k, 110), (320 + 126 * k, 62), (320 + 106 * k, 20)], [30, 44, 6], shell)
    s.blob("body", None, [(276, 220), (320, 190), (364, 220), (372, 300), (352, 376), (288, 376), (268, 300)], shell)
    for n in range(4):
        s.line(f"ring_{n}", "body", [(280, 262 + 28 * n), (320, 270 + 28 * n), (360, 262 + 28 * n)], 4, dark)
        s.rides.add(f"ring_{n}")
    s.eye("eye_r", "body", (336, 218), 7, (0.0, -0.3))
    s.eye("eye_l", "body", (304, 218), 7, (0.0, -0.3))
    places = [(320, 376), (332, 420), (368, 450), (412, 452), (446, 424)]
    for n, (x, y) in enumerate(places):
        s.circle(f"segment_{n}", "body" if n == 0 else f"segment_{n - 1}", (x, y), 30 - 3 * n, shell if n % 2 else "#bf8049")
    s.tail("sting", "segment_4", [(452, 412), (462, 376), (440, 350)], [26, 20, 3], dark)
    return s


def camel() -> Sheet:
    """A camel that walks to the right, with a saddle blanket between its humps and a rein."""
    s = Sheet(680, 560)
    fur, dark = "#c99b5f", "#a67c45"
    legs(s, "hind_far", "body", (246, 350), dark, (58, 34, 24), ((-10, 66), (8, 74), (18, 8)))
    legs(s, "fore_far", "body", (430, 350), dark, (48, 34, 24), ((6, 66), (-2, 74), (18, 8)))
    s.tail("tail", "body", [(200, 300), (168, 330), (160, 380)], [16, 12, 8], fur)
    s.ellipse("tuft", "tail", (160, 388), 12, 18, "#6b4a26")
    s.blob("hump_back", "body", [(230, 270), (250, 206), (290, 190), (326, 212), (340, 270)], fur)
    s.blob("hump_front", "body", [(344, 270), (362, 208), (400, 190), (438, 212), (450, 270)], fur)
    s.blob("body", None, [(196, 310), (230, 262), (340, 256), (450, 262), (484, 306), (450, 366), (330, 382), (226, 362)], fur)
    s.blob("blanket", "body", [(310, 254), (366, 254), (384, 340), (338, 352), (294, 340)], "#a83d4a")
    for n in range(4):
        s.circle(f"tassel_{n}", "blanket", (304 + 24 * n, 348), 7, "#e8c24a", ink=1)
        s.rides.add(f"tassel_{n}")
    legs(s, "hind_near", "body", (230, 344), fur, (66, 38, 26), ((-8, 70), (8, 78), (18, 8)))
    legs(s, "fore_near", "body", (446, 346), fur, (54, 36, 26), ((6, 70), (0, 78), (18, 8)))
    s.tail("neck", "body", [(450, 320), (524, 330), (560, 260), (566, 170)], [92, 68, 54, 46], fur)
    s.polygon("ear_far", "head", [(548, 132), (540, 92), (564, 126)], dark)
    s.blob("head", "neck", [(536, 150), (556, 120), (600, 122), (646, 150), (654, 180), (612, 192), (552, 190)], fur)
    s.blob("lip", "head", [(616, 152), (652, 154), (660, 184), (624, 190)], "#dcb98a")
    s.ellipse("nostril", "lip", (644, 162), 5, 4, INK, ink=0)
    s.eye("eye", "head", (592, 144), 9, (0.2, 0.1))
    s.line("rein", "head", [(628, 150), (620, 172), (628, 192)], 4, "#a83d4a")
    s.polygon("ear_near", "head", [(558, 138), (556, 96), (580, 130)], fur)
    s.rides |= {"blanket", "lip", "nostril", "rein", "tuft"}
    return s


def mouse() -> Sheet:
    """A mouse from the front with big ears, a dress, four-fingered gloves and shoes."""
    s = Sheet(480, 620)
    grey, dress, pink = "#8f949c", "#d95f76", "#f0b9b4"
    s.tail("tail", "dress", [(286, 440), (360, 470), (400, 420), (440, 440)], [14, 12, 10, 5], pink)
    for side, k in (("r", -1), ("l", 1)):
        x = 240 + 30 * k
        s.limb(f"leg_{side}", "dress", (x, 450), (x + 4 * k, 560), (26, 22), grey)
        s.ellipse(f"shoe_{side}", f"leg_{side}", (x + 16 * k, 572), 36, 18, "#e8c24a")
    for side, k in (("r", -1), ("l", 1)):
        s.limb(f"arm_{side}", "dress", (240 + 40 * k, 290), (240 + 130 * k, 340), (26, 22), grey)
    s.blob("dress", None, [(206, 272), (240, 258), (274, 272), (286, 340), (340, 462), (240, 480), (140, 462), (194, 340)], dress)
    for n in range(5):
        s.circle(f"dot_{n}", "dress", (184 + 28 * n, 424 - 18 * (n % 2)), 9, "#fbe9ec", ink=0)
        s.rides.add(f"dot_{n}")
    s.blob("collar", "dress", [(208, 268), (240, 258), (272, 268), (262, 290), (240, 282), (218, 290)], "#fbf3f0")
    for side, k in (("r", -1), ("l", 1)):
        x, y = 240 + 146 * k, 350
        for n, (dx, dy) in enumerate(((26, -20), (34, 2), (26, 22))):
            s.limb(f"finger_{side}_{n}", f"glove_{side}", (x + 8 * k, y + dy / 3), (x + dx * k, y + dy), (14, 11), "#fff")
        s.limb(f"thumb_{side}", f"glove_{side}", (x, y - 6), (x + 2 * k, y - 30), (14, 11), "#fff")
        s.circle(f"glove_{side}", f"arm_{side}", (x, y), 19, "#fff")
    for side, k in (("r", -1), ("l", 1)):
        s.circle(f"ear_{side}", "head", (240 + 88 * k, 96), 60, grey)
        s.circle(f"ear_inside_{side}", f"ear_{side}", (240 + 88 * k, 98), 40, pink, ink=0)
        s.rides.add(f"ear_inside_{side}")
    s.blob("head", "dress", [(156, 190), (176, 130), (240, 106), (304, 130), (324, 190), (290, 246), (240, 266), (190, 246)], grey)
    s.eye("eye_r", "head", (212, 166), 17, (0.2, 0.1))
    s.eye("eye_l", "head", (268, 166), 17, (-0.2, 0.1))
    s.ellipse("snout", "head", (240, 216), 40, 28, "#d9d5d0")
    s.ellipse("nose", "snout", (240, 200), 14, 10, INK, ink=0)
    s.line("mouth", "snout", [(222, 226), (240, 234), (258, 226)], 3, INK)
    s.polygon("bow", "head", [(206, 96), (240, 112), (274, 96), (274, 132), (240, 116), (206, 132)], dress)
    s.rides |= {"collar", "snout", "nose", "mouth", "bow"}
    return s


def toucan() -> Sheet:
    """A toucan on a branch that looks to the right: a large beak of two parts, a folded wing."""
    s = Sheet(520, 520)
    black, white, orange = "#2c2d34", "#f5efdf", "#f09a2d"
    s.blob("tail", "body", [(150, 360), (190, 370), (150, 470), (104, 500), (110, 430)], black)
    s.limb("leg_far", "body", (232, 400), (240, 440), (22, 14), "#6a8fb0")
    for n in range(2):
        s.limb(f"toe_far_{n}", "leg_far", (240, 438), (268 - 46 * n, 452), (12, 8), "#6a8fb0")
    s.blob("body", None, [(140, 340), (156, 250), (216, 200), (290, 230), (300, 320), (256, 404), (180, 410)], black)
    s.blob("breast", "body", [(262, 222), (296, 246), (296, 300), (266, 320), (240, 270)], white, 0)
    s.limb("leg_near", "body", (206, 404), (210, 446), (24, 15), "#7fa6c9")
    for n in range(2):
        s.limb(f"toe_near_{n}", "leg_near", (210, 444), (240 - 50 * n, 460), (13, 8), "#7fa6c9")
    s.blob("beak_low", "head", [(312, 172), (380, 176), (450, 196), (420, 206), (330, 200)], "#d9662b")
    s.blob("beak_top", "head", [(306, 130), (370, 108), (450, 130), (486, 196), (460, 200), (400, 176), (310, 178)], orange)
    s.blob("beak_tip", "beak_top", [(452, 136), (484, 190), (462, 198), (448, 168)], INK, 0)
    s.circle("head", "body", (262, 168), 66, black)
    s.ellipse("face", "head", (290, 170), 32, 40, white, ink=0)
    s.eye("eye", "face", (286, 154), 12, (0.2, 0.0), "#8fd0e8")
    s.blob("wing", "body", [(170, 260), (216, 236), (246, 280), (220, 360), (150, 420), (146, 330)], "#3b3d48")
    s.blob("feathers", "wing", [(160, 350), (212, 330), (196, 378), (150, 410)], "#50535f")
    s.rides |= {"breast", "beak_tip", "face", "feathers"}
    return s


def skeleton() -> Sheet:
    """A skeleton from the front: bones end to end, ribs on a spine, a jaw below the skull."""
    s = Sheet(480, 680)
    bone, dark = "#efe9d6", "#3a3640"
    s.limb("spine", "pelvis", (240, 380), (240, 196), (22, 22), bone)
    for n in range(4):
        s.tail(f"rib_{n}", "spine", [(168 + 6 * n, 250 + 30 * n), (240, 236 + 30 * n), (312 - 6 * n, 250 + 30 * n)], [10, 14, 10], bone)
        s.rides.add(f"rib_{n}")
    s.limb("collarbone", "spine", (160, 210), (320, 210), (16, 16), bone)
    for side, k in (("r", -1), ("l", 1)):
        s.limb(f"humerus_{side}", "collarbone", (240 + 82 * k, 212), (240 + 112 * k, 310), (22, 18), bone)
        s.limb(f"radius_{side}", f"humerus_{side}", (240 + 112 * k, 310), (240 + 124 * k, 402), (20, 16), bone)
        s.blob(f"hand_{side}", f"radius_{side}", [(240 + 112 * k, 398), (240 + 138 * k, 398), (240 + 148 * k, 446), (240 + 128 * k, 460), (240 + 108 * k, 440)], bone)
        s.limb(f"femur_{side}", "pelvis", (240 + 40 * k, 400), (240 + 46 * k, 510), (28, 22), bone)
        s.limb(f"tibia_{side}", f"femur_{side}", (240 + 46 * k, 510), (240 + 48 * k, 616), (24, 18), bone)
        s.circle(f"knee_{side}", f"tibia_{side}", (240 + 46 * k, 510), 13, bone)
        s.ellipse(f"foot_{side}", f"tibia_{side}", (240 + 64 * k, 630), 36, 14, bone)
        s.rides.add(f"knee_{side}")
    s.blob("pelvis", None, [(176, 366), (240, 386), (304, 366), (300, 410), (262, 428), (218, 428), (180, 410)], bone)
    s.blob("jaw", "skull", [(200, 158), (280, 158), (270, 196), (240, 206), (210, 196)], bone)
    s.blob("skull", "spine", [(172, 104), (196, 52), (240, 38), (284, 52), (308, 104), (284, 156), (240, 172), (196, 156)], bone)
    for side, k in (("r", -1), ("l", 1)):
        s.ellipse(f"socket_{side}", "skull", (240 + 30 * k, 108), 20, 22, dark, ink=0)
        s.rides.add(f"socket_{side}")
    s.polygon("nose", "skull", [(240, 124), (252, 146), (228, 146)], dark)
    s.line("teeth", "skull", [(212, 160), (240, 166), (268, 160)], 5, dark)
    s.rides |= {"nose", "teeth"}
    return s
