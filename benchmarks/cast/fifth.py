"""Ten characters drawn after the weights of the graph were frozen, and measured once."""
# ruff: noqa: E501
# fmt: off

from __future__ import annotations

from .sheet import INK, Sheet


def goat() -> Sheet:
    """A goat from the side that looks to the right, with a bell."""
    s = Sheet(600, 460)
    wool, dark, horn = "#d8d2c4", "#a8a294", "#8a7a5c"
    for end, x in (("back", 180), ("front", 360)):
        s.limb(f"{end}_leg_far", "body", (x + 20, 270), (x + 26, 340), (40, 28), dark)
        s.limb(f"{end}_shin_far", f"{end}_leg_far", (x + 26, 340), (x + 22, 410), (24, 18), dark)
        s.box(f"{end}_hoof_far", f"{end}_shin_far", (x + 24, 420), 28, 20, INK)
    s.blob("tail", "body", [(140, 200), (108, 176), (116, 158), (152, 184)], dark)
    s.blob("body", None, [(140, 220), (170, 176), (270, 170), (380, 180), (410, 230), (380, 280), (260, 292), (160, 282)], wool)
    s.ellipse("patch", "body", (250, 216), 40, 28, dark, ink=0)
    for end, x in (("back", 176), ("front", 366)):
        s.limb(f"{end}_shin_near", f"{end}_leg_near", (x + 2, 344), (x - 2, 414), (26, 20), wool)
        s.limb(f"{end}_leg_near", "body", (x, 262), (x + 2, 344), (52, 30), wool)
        s.box(f"{end}_hoof_near", f"{end}_shin_near", (x, 424), 30, 22, INK)
    s.tail("neck", "body", [(370, 230), (410, 180), (430, 130)], [84, 62, 50], wool)
    s.tail("horn_far", "head", [(444, 90), (430, 50), (396, 34)], [16, 13, 7], horn)
    s.blob("ear_far", "head", [(420, 104), (384, 96), (378, 112), (414, 124)], dark)
    s.blob("head", "neck", [(410, 120), (440, 84), (480, 96), (524, 140), (516, 164), (470, 162), (424, 154)], wool)
    s.ellipse("muzzle", "head", (508, 148), 18, 14, dark)
    s.circle("nostril", "muzzle", (514, 144), 3, INK, ink=0)
    s.polygon("beard", "head", [(472, 158), (502, 160), (486, 208)], dark)
    s.eye("eye", "head", (462, 112), 9, (0.2, 0.0))
    s.tail("horn_near", "head", [(452, 94), (444, 48), (410, 20)], [20, 16, 8], horn)
    s.blob("ear_near", "head", [(430, 116), (396, 122), (398, 140), (436, 136)], wool)
    s.tail("collar", "neck", [(378, 172), (408, 192), (444, 190)], [12, 12, 12], "#a33")
    s.circle("bell", "collar", (414, 204), 13, "#e7b93c")
    s.rides |= {"patch", "muzzle", "nostril"}
    return s


def chef() -> Sheet:
    """A cook from the front: cap, moustache, apron, a ladle in one hand."""
    s = Sheet(460, 640)
    white, skin, trousers = "#f4f4f0", "#ecc19c", "#4a5668"
    for side, k in (("left", 1), ("right", -1)):
        s.limb(f"{side}_thigh", "torso", (230 + 34 * k, 400), (230 + 38 * k, 490), (58, 48), trousers)
        s.limb(f"{side}_shin", f"{side}_thigh", (230 + 38 * k, 490), (230 + 40 * k, 580), (46, 38), trousers)
        s.ellipse(f"{side}_shoe", f"{side}_shin", (230 + 52 * k, 596), 42, 18, INK)
        s.limb(f"{side}_upper_arm", "torso", (230 + 84 * k, 258), (230 + 112 * k, 330), (46, 40), white)
        s.limb(f"{side}_forearm", f"{side}_upper_arm", (230 + 112 * k, 330), (230 + 128 * k, 400), (38, 32), white)
        s.circle(f"{side}_hand", f"{side}_forearm", (230 + 132 * k, 414), 20, skin)
    s.limb("ladle", "right_hand", (98, 414), (70, 300), (9, 9), "#8f979f")
    s.ellipse("ladle_bowl", "ladle", (66, 290), 22, 16, "#8f979f")
    s.box("neck", "torso", (230, 216), 44, 40, skin)
    s.blob("torso", None, [(150, 250), (190, 230), (270, 230), (310, 250), (318, 380), (280, 424), (180, 424), (142, 380)], white)
    s.blob("apron", "torso", [(176, 310), (284, 310), (296, 440), (286, 486), (174, 486), (164, 440)], "#c8d8e4")
    s.polygon("scarf", "neck", [(196, 228), (264, 228), (230, 268)], "#c0392b")
    for n in range(3):
        s.circle(f"button_{n}", "torso", (230, 272 + 14 * n), 4, INK, ink=0)
        s.rides.add(f"button_{n}")
    s.ellipse("head", "neck", (230, 160), 60, 62, skin)
    for side, k in (("left", 1), ("right", -1)):
        s.ellipse(f"{side}_ear", "head", (230 + 62 * k, 164), 12, 18, skin)
        s.eye(f"{side}_eye", "head", (230 + 24 * k, 146), 9)
        s.line(f"{side}_brow", "head", [(230 + 12 * k, 128), (230 + 24 * k, 122), (230 + 36 * k, 128)], 5, INK)
        s.rides.add(f"{side}_brow")
    s.ellipse("nose", "head", (230, 170), 12, 14, "#e0a886")
    s.blob("moustache", "head", [(186, 186), (230, 178), (274, 186), (262, 200), (230, 192), (198, 200)], "#5a4030")
    s.line("mouth", "head", [(216, 206), (230, 210), (244, 206)], 3, INK)
    s.box("hat_band", "head", (230, 106), 104, 26, white)
    s.blob("hat_top", "hat_band", [(180, 98), (160, 60), (196, 30), (230, 24), (266, 30), (300, 60), (280, 98)], white)
    s.rides |= {"mouth", "nose"}
    return s


def duck() -> Sheet:
    """A duck from the side that looks to the left, with a cap."""
    s = Sheet(520, 440)
    body, dark, bill = "#f3d34a", "#d9b52f", "#e8842c"
    for name, x, y in (("far", 270, 330), ("near", 230, 336)):
        s.limb(f"leg_{name}", "body", (x, y), (x - 4, y + 50), (18, 12), bill)
        s.blob(f"foot_{name}", f"leg_{name}", [(x + 8, y + 46), (x - 50, y + 62), (x - 54, y + 74), (x + 10, y + 70)], bill)
    s.blob("tail", "body", [(390, 250), (450, 206), (470, 222), (412, 296)], dark)
    s.blob("body", None, [(150, 260), (190, 210), (280, 216), (400, 236), (424, 280), (370, 340), (240, 352), (168, 320)], body)
    s.blob("wing", "body", [(230, 256), (300, 240), (376, 262), (340, 306), (270, 310)], dark)
    s.line("feather_1", "wing", [(280, 290), (316, 292), (344, 276)], 3, "#b8962a")
    s.line("feather_2", "wing", [(270, 274), (306, 276), (336, 262)], 3, "#b8962a")
    s.tail("neck", "body", [(196, 262), (176, 210), (178, 150)], [96, 70, 58], body)
    s.blob("bill_lower", "head", [(126, 146), (70, 150), (66, 160), (124, 162)], "#c96d1c")
    s.circle("head", "neck", (170, 126), 54, body)
    s.blob("bill_upper", "head", [(132, 120), (84, 128), (48, 140), (52, 152), (128, 150)], bill)
    s.eye("eye", "head", (154, 108), 12, (-0.3, 0.0))
    s.ellipse("cheek", "head", (184, 142), 14, 9, "#f0a95a", ink=0)
    s.blob("cap", "head", [(124, 92), (150, 66), (190, 66), (218, 96), (170, 88)], "#3f6fb0")
    s.polygon("cap_peak", "cap", [(130, 86), (140, 98), (92, 104), (96, 94)], "#2d5288")
    s.rides |= {"feather_1", "feather_2", "cheek"}
    return s


def ant() -> Sheet:
    """An ant from the side that walks to the right, with jointed legs."""
    s = Sheet(620, 380)
    shell, dark = "#7a3b2e", "#54261d"
    for n, (x, lean) in enumerate(((280, -46), (320, 6), (352, 60))):
        s.limb(f"tibia_far_{n}", f"femur_far_{n}", (x + lean, 270), (x + 1.5 * lean, 336), (9, 6), dark)
        s.limb(f"femur_far_{n}", "thorax", (x, 206), (x + lean, 270), (14, 10), dark)
    s.blob("abdomen", "waist", [(60, 190), (100, 130), (190, 124), (236, 180), (196, 236), (100, 240)], shell)
    s.ellipse("shine", "abdomen", (140, 156), 36, 14, "#a9614f", ink=0)
    s.ellipse("waist", "thorax", (250, 186), 22, 16, shell)
    s.ellipse("thorax", None, (316, 186), 62, 40, shell)
    for n, (x, lean) in enumerate(((276, -60), (316, -8), (350, 46))):
        s.limb(f"tibia_near_{n}", f"femur_near_{n}", (x + lean, 276), (x + 1.5 * lean, 346), (11, 7), shell)
        s.limb(f"femur_near_{n}", "thorax", (x, 204), (x + lean, 276), (18, 12), shell)
    s.tail("feeler_far", "head", [(440, 130), (470, 90), (520, 84)], [8, 7, 6], dark)
    s.blob("jaw_far", "head", [(478, 192), (520, 196), (528, 212), (482, 208)], dark)
    s.circle("head", "thorax", (426, 168), 58, shell)
    s.eye("eye", "head", (446, 150), 13, (0.3, 0.1))
    s.blob("jaw_near", "head", [(464, 204), (508, 218), (510, 236), (462, 220)], dark)
    s.tail("feeler_near", "head", [(424, 124), (446, 76), (494, 58)], [10, 8, 7], shell)
    s.rides |= {"shine"}
    return s


def princess() -> Sheet:
    """A princess from the front in a wide gown, with long hair, a crown and a wand."""
    s = Sheet(480, 660)
    gown, skin, hair, gold = "#b97fc4", "#f3cfae", "#d9a441", "#efc84a"
    s.blob("hair_back", "head", [(168, 130), (190, 70), (290, 70), (312, 130), (326, 290), (290, 330), (190, 330), (154, 290)], hair)
    for side, k in (("L", 1), ("R", -1)):
        s.ellipse(f"Shoe.{side}", "Skirt", (240 + 40 * k, 626), 34, 16, "#8c4f99")
    s.box("Neck", "Bodice", (240, 226), 36, 50, skin)
    s.blob("Skirt", "Bodice", [(196, 350), (284, 350), (360, 480), (396, 610), (240, 626), (84, 610), (120, 480)], gown)
    s.line("Hem", "Skirt", [(96, 596), (240, 612), (384, 596)], 8, "#f0def4")
    s.blob("Bodice", None, [(186, 250), (216, 240), (264, 240), (294, 250), (284, 320), (288, 366), (192, 366), (196, 320)], "#a468b0")
    s.polygon("Gem", "Bodice", [(240, 268), (252, 282), (240, 298), (228, 282)], "#6fd0e0")
    for side, k in (("L", 1), ("R", -1)):
        s.limb(f"LowerArm.{side}", f"UpperArm.{side}", (240 + 92 * k, 340), (240 + 120 * k, 410), (26, 22), skin)
        s.limb(f"UpperArm.{side}", "Bodice", (240 + 56 * k, 268), (240 + 92 * k, 340), (34, 28), gown)
        s.circle(f"Puff.{side}", f"UpperArm.{side}", (240 + 60 * k, 272), 30, gown)
    s.limb("Wand", "Hand.L", (366, 420), (400, 330), (7, 7), gold)
    s.polygon("Star", "Wand", [(404, 300), (412, 322), (434, 322), (416, 336), (422, 358), (404, 344), (386, 358), (392, 336), (374, 322), (396, 322)], gold)
    for side, k in (("L", 1), ("R", -1)):
        s.circle(f"Hand.{side}", f"LowerArm.{side}", (240 + 124 * k, 420), 16, skin)
    s.ellipse("head", "Neck", (240, 154), 58, 66, skin)
    for side, k in (("L", 1), ("R", -1)):
        s.eye(f"eye_{side}", "head", (240 + 24 * k, 154), 10)
        s.circle(f"Blush.{side}", "head", (240 + 36 * k, 182), 9, "#f0a9a0", ink=0)
        s.rides.add(f"Blush.{side}")
    s.line("Mouth", "head", [(226, 196), (240, 202), (254, 196)], 3, "#b0434f")
    s.blob("Bangs", "head", [(182, 140), (190, 92), (240, 80), (290, 92), (298, 140), (264, 112), (216, 112)], hair)
    s.polygon("Crown", "head", [(200, 96), (196, 50), (220, 74), (240, 40), (260, 74), (284, 50), (280, 96)], gold)
    s.circle("Ruby", "Crown", (240, 80), 8, "#c33", ink=0)
    s.rides |= {"Hem", "Gem", "Mouth", "Ruby"}
    return s


def kangaroo() -> Sheet:
    """A kangaroo from the side that looks to the left, with its young in the pouch."""
    s = Sheet(600, 620)
    fur, dark, light = "#b5793f", "#8c5a2b", "#e6c79c"
    s.limb("far_thigh", "body", (330, 430), (276, 500), (96, 50), dark)
    s.limb("far_shin", "far_thigh", (276, 500), (330, 566), (40, 28), dark)
    s.limb("far_foot", "far_shin", (336, 576), (240, 584), (30, 22), dark)
    s.limb("far_arm", "body", (232, 300), (180, 350), (30, 22), dark)
    s.limb("far_paw", "far_arm", (178, 352), (150, 372), (24, 14), dark)
    s.tail("tail", "body", [(390, 430), (460, 520), (560, 570)], [90, 50, 16], fur)
    s.blob("body", None, [(220, 270), (262, 240), (310, 290), (390, 380), (404, 460), (340, 500), (270, 480), (232, 400), (212, 330)], fur)
    s.blob("belly", "body", [(226, 320), (262, 340), (290, 420), (286, 470), (250, 440), (232, 390)], light, 0)
    s.circle("joey_head", "pouch", (216, 392), 28, fur)
    s.blob("joey_ear", "joey_head", [(222, 370), (232, 336), (246, 346), (238, 378)], fur)
    s.eye("joey_eye", "joey_head", (208, 386), 6, (-0.2, 0.0))
    s.blob("pouch", "body", [(208, 414), (262, 404), (300, 440), (282, 482), (232, 466)], light)
    s.limb("near_shin", "near_thigh", (262, 512), (318, 580), (46, 32), fur)
    s.limb("near_thigh", "body", (340, 434), (262, 512), (116, 58), fur)
    s.limb("near_foot", "near_shin", (324, 590), (214, 600), (34, 24), fur)
    s.limb("near_arm", "body", (250, 304), (196, 366), (36, 26), fur)
    s.limb("near_paw", "near_arm", (194, 368), (162, 392), (28, 16), fur)
    s.tail("neck", "body", [(250, 280), (236, 220), (216, 170)], [84, 58, 46], fur)
    s.blob("ear_far", "head", [(224, 128), (236, 60), (256, 66), (250, 134)], dark)
    s.blob("head", "neck", [(116, 168), (150, 136), (200, 116), (246, 130), (248, 172), (200, 190), (136, 190)], fur)
    s.ellipse("nose", "head", (122, 172), 14, 11, INK)
    s.eye("eye", "head", (190, 146), 9, (-0.2, 0.0))
    s.line("mouth", "head", [(126, 186), (146, 188), (166, 180)], 3, INK)
    s.blob("ear_near", "head", [(236, 136), (262, 70), (284, 80), (262, 148)], fur)
    s.blob("ear_near_inside", "ear_near", [(246, 130), (264, 88), (274, 92), (260, 138)], "#d9a07a", 0)
    s.rides |= {"belly", "nose", "mouth", "ear_near_inside"}
    return s


def lobster() -> Sheet:
    """A lobster from above: claws of two pieces, a tail of segments."""
    s = Sheet(520, 640)
    shell, dark = "#c8402f", "#96281c"
    for side, k in (("l", 1), ("r", -1)):
        for n, y in enumerate((270, 310, 350)):
            s.tail(f"leg_{side}_{n}", "back", [(260 + 40 * k, y), (260 + 100 * k, y + 10), (260 + 140 * k, y + 60)], [16, 12, 7], dark)
        s.tail(f"antenna_{side}", "head", [(260 + 18 * k, 170), (260 + 60 * k, 90), (260 + 56 * k, 20)], [8, 6, 4], dark)
        s.limb(f"arm_{side}", "back", (260 + 50 * k, 240), (260 + 120 * k, 180), (30, 24), shell)
        s.blob(f"thumb_{side}", f"claw_{side}", [(260 + 104 * k, 128), (260 + 84 * k, 96), (260 + 92 * k, 60), (260 + 122 * k, 110)], dark)
        s.blob(f"claw_{side}", f"arm_{side}", [(260 + 110 * k, 186), (260 + 108 * k, 120), (260 + 130 * k, 60), (260 + 172 * k, 90), (260 + 166 * k, 150), (260 + 136 * k, 190)], shell)
    s.blob("fan_l", "tail_4", [(270, 570), (330, 586), (350, 624), (276, 616)], dark)
    s.blob("fan_r", "tail_4", [(250, 570), (190, 586), (170, 624), (244, 616)], dark)
    s.blob("fan_middle", "tail_4", [(240, 566), (280, 566), (292, 630), (228, 630)], shell)
    for n in range(4, 0, -1):
        s.box(f"tail_{n}", "back" if n == 1 else f"tail_{n - 1}", (260, 384 + 46 * n), 108 - 12 * n, 58, shell, r=16)
    s.blob("back", None, [(206, 240), (230, 200), (290, 200), (314, 240), (326, 350), (300, 414), (220, 414), (194, 350)], shell)
    s.blob("head", "back", [(222, 214), (236, 168), (260, 150), (284, 168), (298, 214), (260, 240)], shell)
    for side, k in (("l", 1), ("r", -1)):
        s.eye(f"eye_{side}", "head", (260 + 26 * k, 176), 11, (0.0, -0.3))
    s.line("groove", "back", [(226, 300), (260, 320), (294, 300)], 4, dark)
    s.rides |= {"groove"}
    return s


def clown() -> Sheet:
    """A clown from the front: bow tie, big shoes, a ruff, a balloon on a string."""
    s = Sheet(520, 700)
    suit, skin, red = "#4f8fc4", "#f6dcc6", "#d8402f"
    s.line("string", "hand_left", [(392, 420), (420, 300), (410, 190)], 3, INK)
    s.ellipse("balloon", "string", (410, 130), 46, 60, "#e7657f")
    for side, k in (("left", 1), ("right", -1)):
        s.limb(f"calf_{side}", f"thigh_{side}", (260 + 46 * k, 530), (260 + 50 * k, 620), (54, 44), suit)
        s.limb(f"thigh_{side}", "trunk", (260 + 36 * k, 430), (260 + 46 * k, 530), (74, 60), suit)
        s.ellipse(f"shoe_{side}", f"calf_{side}", (260 + 84 * k, 646), 70, 26, red)
        s.circle(f"toecap_{side}", f"shoe_{side}", (260 + 128 * k, 648), 22, "#f2c94c")
        s.limb(f"arm_{side}", "trunk", (260 + 84 * k, 286), (260 + 124 * k, 360), (50, 42), suit)
        s.limb(f"forearm_{side}", f"arm_{side}", (260 + 124 * k, 360), (260 + 130 * k, 424), (40, 32), suit)
        s.circle(f"hand_{side}", f"forearm_{side}", (260 + 132 * k, 436), 22, "#fff")
    s.blob("trunk", None, [(176, 280), (220, 254), (300, 254), (344, 280), (352, 400), (316, 460), (204, 460), (168, 400)], suit)
    for n, (x, y) in enumerate(((260, 320), (260, 366), (260, 412))):
        s.circle(f"pompom_{n}", "trunk", (x, y), 14, red)
        s.rides.add(f"pompom_{n}")
    s.box("neck", "trunk", (260, 238), 44, 44, skin)
    s.blob("ruff", "neck", [(190, 256), (220, 238), (260, 246), (300, 238), (330, 256), (300, 278), (260, 268), (220, 278)], "#f4f1e4")
    for side, k in (("left", 1), ("right", -1)):
        s.circle(f"curls_{side}", "head", (260 + 70 * k, 140), 36, "#e07a2a")
    s.ellipse("head", "neck", (260, 164), 68, 74, skin)
    for side, k in (("left", 1), ("right", -1)):
        s.ellipse(f"paint_{side}", "head", (260 + 28 * k, 140), 18, 26, "#fff", ink=0)
        s.eye(f"eye_{side}", f"paint_{side}", (260 + 28 * k, 146), 9)
        s.rides.add(f"paint_{side}")
    s.circle("nose", "head", (260, 174), 18, red)
    s.blob("mouth", "head", [(216, 196), (260, 204), (304, 196), (288, 224), (260, 230), (232, 224)], red)
    s.blob("bowtie", "ruff", [(260, 270), (226, 250), (222, 294), (260, 278), (298, 294), (294, 250)], "#f2c94c")
    s.polygon("hat", "head", [(216, 104), (304, 104), (272, 20), (248, 20)], "#7a4fa0")
    s.circle("hat_pompom", "hat", (260, 22), 14, red)
    s.rides |= {"nose", "mouth"}
    return s


def seahorse() -> Sheet:
    """A seahorse that looks to the left, with a curled tail."""
    s = Sheet(420, 620)
    skin, dark = "#e39a4d", "#c17a30"
    s.blob("fin", "belly", [(262, 290), (322, 268), (336, 316), (318, 352), (258, 340)], "#f0c48a")
    for n, y in enumerate((286, 308, 330)):
        s.line(f"ray_{n}", "fin", [(270, y + 8), (296, y), (322, y)], 3, dark)
        s.rides.add(f"ray_{n}")
    s.tail("tail", "belly", [(232, 400), (220, 470), (176, 520), (130, 500), (136, 460), (164, 466)], [78, 56, 40, 28, 20, 12], skin)
    s.blob("belly", None, [(180, 250), (220, 220), (268, 250), (276, 340), (256, 420), (206, 424), (172, 340)], skin)
    for n, y in enumerate((270, 310, 350, 390)):
        s.line(f"ring_{n}", "belly", [(182, y), (212, y + 10), (240, y)], 4, dark)
        s.rides.add(f"ring_{n}")
    s.tail("neck", "belly", [(226, 270), (244, 200), (220, 150)], [86, 62, 58], skin)
    for n, (x, y) in enumerate(((226, 76), (250, 88), (268, 110))):
        s.polygon(f"spike_{n}", "head", [(x - 12, y + 18), (x + 8, y - 26), (x + 14, y + 20)], dark)
    s.blob("head", "neck", [(160, 130), (190, 90), (240, 90), (266, 130), (250, 172), (200, 176)], skin)
    s.limb("snout", "head", (172, 140), (92, 168), (30, 20), skin)
    s.ellipse("lips", "snout", (86, 170), 9, 14, dark)
    s.eye("eye", "head", (206, 124), 14, (-0.3, 0.0))
    s.circle("cheek", "head", (220, 154), 10, "#ef7f5a", ink=0)
    s.rides |= {"cheek"}
    return s


def ninja() -> Sheet:
    """A ninja from the side that looks to the right, a sword on his back."""
    s = Sheet(480, 640)
    cloth, dark, skin, red = "#3a4256", "#272d3d", "#e8bf98", "#b0333a"
    s.limb("far_upper_arm", "chest", (244, 270), (290, 330), (38, 32), dark)
    s.limb("far_forearm", "far_upper_arm", (290, 330), (350, 310), (30, 24), dark)
    s.circle("far_hand", "far_forearm", (358, 308), 16, skin)
    s.limb("far_thigh", "hips", (250, 400), (290, 480), (58, 46), dark)
    s.limb("far_calf", "far_thigh", (290, 480), (270, 570), (42, 32), dark)
    s.limb("far_foot", "far_calf", (268, 580), (312, 584), (32, 24), dark)
    s.limb("scabbard", "chest", (150, 420), (200, 240), (18, 16), "#222")
    s.box("hilt", "scabbard", (208, 212), 16, 56, red)
    s.tail("band_end_1", "headband", [(190, 140), (140, 150), (96, 180)], [16, 16, 14], red)
    s.tail("band_end_2", "headband", [(190, 146), (150, 174), (124, 220)], [14, 14, 12], red)
    s.limb("near_thigh", "hips", (226, 404), (206, 490), (64, 50), cloth)
    s.limb("near_calf", "near_thigh", (206, 490), (160, 570), (46, 34), cloth)
    s.limb("near_foot", "near_calf", (156, 580), (200, 592), (34, 26), cloth)
    s.blob("hips", None, [(196, 360), (280, 360), (286, 410), (262, 440), (206, 440), (190, 410)], cloth)
    s.blob("chest", "hips", [(200, 240), (250, 228), (290, 250), (296, 320), (282, 380), (200, 380), (188, 310)], cloth)
    s.tail("belt", "hips", [(190, 368), (240, 378), (290, 366)], [22, 22, 22], red)
    s.box("neck", "chest", (244, 218), 42, 50, dark)
    s.ellipse("head", "neck", (244, 150), 62, 66, cloth)
    s.blob("face", "head", [(250, 130), (304, 132), (306, 160), (250, 162)], skin)
    s.eye("eye", "face", (284, 146), 8, (0.3, 0.0))
    s.line("brow", "face", [(270, 134), (284, 132), (298, 136)], 4, INK)
    s.tail("headband", "head", [(184, 128), (244, 112), (304, 122)], [22, 22, 22], red)
    s.limb("near_forearm", "near_upper_arm", (196, 346), (250, 390), (34, 26), cloth)
    s.limb("near_upper_arm", "chest", (222, 272), (196, 346), (44, 36), cloth)
    s.circle("near_hand", "near_forearm", (258, 396), 17, skin)
    s.rides |= {"face", "brow"}
    return s
