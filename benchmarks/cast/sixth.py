"""Ten characters drawn after names got an order and the weights were fitted to all others; measured once."""
# ruff: noqa: E501
# fmt: off

from __future__ import annotations

from .sheet import INK, Sheet


def hedgehog() -> Sheet:
    """A hedgehog from the side that looks to the left, with an apple on its spines."""
    s = Sheet(520, 380)
    fur, skin, brown = "#b98f63", "#e9cda5", "#6d4c33"
    for end, x in (("fore", 190), ("hind", 350)):
        s.limb(f"{end}_leg_far", "body", (x + 16, 290), (x + 14, 334), (26, 20), fur)
        s.ellipse(f"{end}_foot_far", f"{end}_leg_far", (x + 8, 342), 18, 9, fur)
    s.blob("spines", "body", [(170, 200), (210, 110), (300, 80), (400, 120), (440, 220), (420, 290), (300, 300), (200, 280)], brown)
    s.blob("body", None, [(150, 240), (200, 190), (300, 200), (400, 240), (410, 290), (340, 316), (220, 316), (164, 296)], fur)
    for n, (x, y) in enumerate(((240, 140), (300, 120), (360, 150), (390, 210), (270, 170), (330, 180))):
        s.line(f"spine_{n}", "spines", [(x, y), (x + 12, y - 18)], 4, "#8a6748")
        s.rides.add(f"spine_{n}")
    for end, x in (("fore", 180), ("hind", 340)):
        s.limb(f"{end}_leg_near", "body", (x, 290), (x - 2, 336), (30, 22), fur)
        s.ellipse(f"{end}_foot_near", f"{end}_leg_near", (x - 8, 346), 20, 10, fur)
    s.blob("head", "body", [(190, 200), (150, 210), (96, 250), (70, 276), (100, 290), (160, 290), (196, 260)], skin)
    s.circle("nose", "head", (72, 274), 10, INK)
    s.eye("eye", "head", (138, 240), 8)
    s.ellipse("ear", "head", (182, 216), 16, 20, fur)
    s.line("mouth", "head", [(96, 284), (112, 282), (124, 272)], 3, INK)
    s.circle("apple", "spines", (320, 92), 26, "#c8402f")
    s.line("stem", "apple", [(320, 70), (324, 56)], 4, brown)
    s.rides |= {"mouth", "stem", "nose"}
    return s


def ostrich() -> Sheet:
    """An ostrich from the side that runs to the right."""
    s = Sheet(480, 640)
    black, pink, white = "#33313a", "#e3a99a", "#efece6"
    s.limb("thigh_b", "body", (220, 360), (190, 440), (46, 26), "#d79585")
    s.limb("shank_b", "thigh_b", (190, 440), (150, 530), (20, 14), "#d79585")
    s.blob("foot_b", "shank_b", [(146, 524), (160, 530), (176, 552), (140, 550)], "#d79585")
    s.blob("tailfeathers", "body", [(150, 290), (96, 256), (70, 290), (84, 330), (150, 340)], white)
    s.blob("body", None, [(140, 300), (190, 250), (280, 244), (340, 290), (320, 350), (240, 384), (160, 360)], black)
    s.limb("thigh_a", "body", (250, 362), (280, 452), (52, 28), pink)
    s.limb("shank_a", "thigh_a", (280, 452), (250, 560), (22, 14), pink)
    s.blob("foot_a", "shank_a", [(244, 556), (262, 556), (290, 580), (238, 580)], pink)
    s.tail("neck", "body", [(320, 290), (364, 230), (372, 150), (380, 90)], [40, 26, 22, 22], pink)
    s.ellipse("head", "neck", (392, 76), 34, 24, pink)
    s.polygon("beak_low", "head", [(414, 82), (456, 92), (416, 96)], "#d8a24a")
    s.polygon("beak_up", "head", [(416, 66), (462, 86), (414, 86)], "#e7b25a")
    s.eye("eye", "head", (396, 68), 9)
    s.blob("wing", "body", [(190, 280), (270, 270), (300, 310), (240, 346), (170, 330), (150, 300)], "#45434e")
    for n, x in enumerate((170, 200, 232)):
        s.blob(f"plume_{n}", "wing", [(x, 316), (x + 24, 318), (x + 12, 362), (x - 12, 360)], white)
    return s


def gardener() -> Sheet:
    """A woman from the front with a straw hat, a braid, dungarees and a watering can."""
    s = Sheet(480, 680)
    skin, denim, straw, hair = "#e5b48c", "#4c6a92", "#e6cf86", "#7b4a2b"
    for side, k in (("L", 1), ("R", -1)):
        s.limb(f"leg_upper_{side}", "dungarees", (240 + 30 * k, 410), (240 + 34 * k, 500), (58, 46), denim)
        s.limb(f"leg_lower_{side}", f"leg_upper_{side}", (240 + 34 * k, 500), (240 + 36 * k, 590), (44, 38), denim)
        s.blob(f"boot_{side}", f"leg_lower_{side}", [(240 + 16 * k, 580), (240 + 58 * k, 580), (240 + 70 * k, 630), (240 + 14 * k, 632)], "#6b8f3c")
        s.limb(f"arm_upper_{side}", "shirt", (240 + 66 * k, 266), (240 + 92 * k, 336), (44, 36), "#c8553d")
        s.limb(f"arm_lower_{side}", f"arm_upper_{side}", (240 + 92 * k, 336), (240 + 112 * k, 404), (32, 26), skin)
        s.circle(f"hand_{side}", f"arm_lower_{side}", (240 + 116 * k, 416), 18, skin)
    s.box("can", "hand_R", (106, 470), 66, 60, "#8fa6a0")
    s.tail("spout", "can", [(80, 478), (50, 450), (36, 430)], [16, 10, 8], "#8fa6a0")
    s.line("can_handle", "can", [(92, 442), (124, 416), (140, 446)], 6, "#8fa6a0")
    s.box("neck", "shirt", (240, 224), 40, 44, skin)
    s.blob("shirt", "dungarees", [(174, 250), (210, 236), (270, 236), (306, 250), (304, 330), (176, 330)], "#c8553d")
    s.blob("dungarees", None, [(180, 310), (196, 280), (284, 280), (300, 310), (308, 420), (270, 446), (210, 446), (172, 420)], denim)
    for side, k in (("L", 1), ("R", -1)):
        s.box(f"strap_{side}", "dungarees", (240 + 32 * k, 262), 14, 52, denim)
        s.circle(f"button_{side}", "dungarees", (240 + 32 * k, 290), 6, "#e7b93c")
        s.rides |= {f"strap_{side}", f"button_{side}"}
    s.box("pocket", "dungarees", (240, 330), 54, 40, "#3f5b80")
    s.ellipse("head", "neck", (240, 166), 58, 64, skin)
    for side, k in (("L", 1), ("R", -1)):
        s.eye(f"eye_{side}", "head", (240 + 22 * k, 160), 9)
        s.ellipse(f"blush_{side}", "head", (240 + 34 * k, 184), 9, 6, "#e08f7a", ink=0)
        s.rides.add(f"blush_{side}")
    s.blob("fringe", "head", [(186, 150), (200, 108), (240, 100), (280, 108), (294, 150), (240, 130)], hair)
    s.tail("braid", "head", [(290, 170), (312, 230), (308, 300)], [26, 24, 16], hair)
    s.ellipse("bow", "braid", (308, 306), 16, 9, "#c8553d")
    s.line("mouth", "head", [(226, 200), (240, 206), (254, 200)], 3, INK)
    s.ellipse("hat_brim", "head", (240, 112), 108, 24, straw)
    s.blob("hat_crown", "hat_brim", [(190, 106), (200, 60), (240, 46), (280, 60), (290, 106)], straw)
    s.rides |= {"pocket", "mouth"}
    return s


def samurai() -> Sheet:
    """A samurai from the front in armour, with a helmet and two swords."""
    s = Sheet(520, 700)
    red, dark, gold, skin = "#a33b32", "#2f3a4a", "#d8b24a", "#dfb288"
    s.limb("katana_sheath", "belt", (300, 420), (420, 520), (16, 12), "#3a2b28")
    for side, k in (("left", 1), ("right", -1)):
        s.limb(f"{side}_upper_leg", "kusazuri", (260 + 38 * k, 440), (260 + 46 * k, 530), (62, 52), dark)
        s.limb(f"{side}_lower_leg", f"{side}_upper_leg", (260 + 46 * k, 530), (260 + 50 * k, 620), (46, 40), red)
        s.ellipse(f"{side}_sandal", f"{side}_lower_leg", (260 + 60 * k, 640), 36, 16, "#c9a36b")
        s.limb(f"{side}_arm", "cuirass", (260 + 92 * k, 280), (260 + 126 * k, 356), (50, 42), dark)
        s.limb(f"{side}_lower_arm", f"{side}_arm", (260 + 126 * k, 356), (260 + 136 * k, 424), (40, 34), dark)
        s.circle(f"{side}_fist", f"{side}_lower_arm", (260 + 138 * k, 438), 22, skin)
    s.limb("blade", "hilt", (122, 400), (60, 210), (12, 6), "#d5dbe0")
    s.limb("hilt", "right_fist", (130, 470), (118, 404), (12, 12), "#3a2b28")
    s.blob("kusazuri", "cuirass", [(176, 400), (344, 400), (372, 490), (148, 490)], red)
    s.box("neck", "cuirass", (260, 226), 46, 40, skin)
    s.blob("cuirass", None, [(172, 260), (220, 240), (300, 240), (348, 260), (340, 410), (180, 410)], red)
    s.box("belt", "cuirass", (260, 404), 172, 24, gold)
    for side, k in (("left", 1), ("right", -1)):
        s.box(f"{side}_sode", f"{side}_arm", (260 + 104 * k, 290), 62, 76, red)
    s.ellipse("head", "neck", (260, 176), 52, 58, skin)
    for side, k in (("left", 1), ("right", -1)):
        s.eye(f"{side}_eye", "head", (260 + 20 * k, 172), 8)
        s.line(f"{side}_eyebrow", "head", [(260 + 8 * k, 158), (260 + 32 * k, 150)], 6, INK)
        s.rides.add(f"{side}_eyebrow")
    s.blob("moustache", "head", [(236, 200), (260, 194), (284, 200), (276, 210), (260, 202), (244, 210)], INK)
    s.blob("helmet", "head", [(190, 160), (204, 110), (260, 86), (316, 110), (330, 160), (260, 138)], dark)
    for side, k in (("left", 1), ("right", -1)):
        s.blob(f"{side}_flap", "helmet", [(260 + 60 * k, 140), (260 + 86 * k, 150), (260 + 96 * k, 210), (260 + 60 * k, 200)], dark)
        s.tail(f"{side}_horn", "helmet", [(260 + 20 * k, 100), (260 + 56 * k, 60), (260 + 62 * k, 20)], [16, 12, 6], gold)
    return s


def diver() -> Sheet:
    """A diver from the side who swims to the right, with a tank, a mask and fins."""
    s = Sheet(700, 360)
    suit, grey, skin = "#2d4a5e", "#8b98a1", "#e0b48e"
    s.limb("arm_far_upper", "torso", (430, 190), (490, 230), (34, 28), "#243c4d")
    s.limb("arm_far_lower", "arm_far_upper", (490, 230), (560, 226), (26, 22), "#243c4d")
    s.circle("hand_far", "arm_far_lower", (572, 224), 14, skin)
    s.limb("thigh_far", "torso", (270, 190), (190, 214), (46, 36), "#243c4d")
    s.limb("calf_far", "thigh_far", (190, 214), (110, 226), (34, 24), "#243c4d")
    s.blob("flipper_far", "calf_far", [(112, 214), (104, 238), (30, 270), (22, 250)], "#c9932e")
    s.blob("torso", None, [(250, 170), (320, 140), (430, 146), (464, 180), (430, 212), (320, 214), (256, 204)], suit)
    s.limb("tank", "torso", (310, 122), (410, 122), (40, 40), "#e0b93c")
    s.tail("hose", "tank", [(424, 118), (470, 108), (520, 150), (540, 176)], [8, 8, 8, 8], INK)
    s.box("belt", "torso", (286, 186), 18, 54, grey)
    s.ellipse("head", "torso", (510, 160), 46, 42, suit)
    s.ellipse("face", "head", (528, 164), 26, 28, skin)
    s.box("mask", "face", (536, 154), 36, 24, "#9fc7d8")
    s.eye("eye", "face", (540, 154), 6)
    s.box("regulator", "face", (546, 184), 26, 18, grey)
    s.limb("thigh_near", "torso", (266, 196), (184, 184), (50, 38), suit)
    s.limb("calf_near", "thigh_near", (184, 184), (104, 170), (36, 26), suit)
    s.blob("flipper_near", "calf_near", [(106, 158), (100, 184), (20, 176), (24, 144)], "#e0a93c")
    s.limb("arm_near_upper", "torso", (424, 188), (400, 256), (38, 30), suit)
    s.limb("arm_near_lower", "arm_near_upper", (400, 256), (460, 300), (28, 24), suit)
    s.circle("hand_near", "arm_near_lower", (470, 308), 15, skin)
    s.limb("torch", "hand_near", (470, 310), (520, 316), (14, 18), grey)
    s.rides |= {"belt", "regulator"}
    return s


def squid() -> Sheet:
    """A squid from the front whose layers have hardly any names."""
    s = Sheet(420, 640)
    red, light = "#c1503f", "#e39a86"
    for k in range(3):
        for side in (-1, 1):
            x = 210 + side * (18 + 30 * k)
            s.tail(f"tentacle{'rl'[side > 0]}{k}", "Layer 2", [(x, 380), (x + 20 * side, 460), (x + 6 * side, 540), (x + 26 * side, 590)], [26, 20, 14, 7], light if k % 2 else red)
    for side, name in ((-1, "fin r"), (1, "fin l")):
        s.blob(name, "Layer 1", [(210 + 60 * side, 90), (210 + 140 * side, 130), (210 + 120 * side, 190), (210 + 60 * side, 180)], light)
    s.blob("Layer 1", None, [(210, 30), (270, 100), (284, 220), (260, 320), (160, 320), (136, 220), (150, 100)], red)
    s.ellipse("Layer 2", "Layer 1", (210, 346), 76, 50, red)
    for side in ("r", "l"):
        s.eye(f"eye {side}", "Layer 2", (210 + (40 if side == "l" else -40), 346), 18, (0.2, 0.0))
    for n, (x, y) in enumerate(((190, 120), (236, 170), (184, 220), (230, 260))):
        s.circle(f"path{n + 31}", "Layer 1", (x, y), 9, light, ink=0)
        s.rides.add(f"path{n + 31}")
    return s


def butterfly() -> Sheet:
    """A butterfly from above."""
    s = Sheet(560, 460)
    orange, dark, blue = "#e08a35", "#3b2c2a", "#4f79b8"
    for side, k in (("l", -1), ("r", 1)):
        s.blob(f"lower_wing_{side}", "thorax", [(280 + 16 * k, 250), (280 + 110 * k, 250), (280 + 170 * k, 330), (280 + 110 * k, 400), (280 + 40 * k, 340)], orange)
        s.circle(f"lower_spot_{side}", f"lower_wing_{side}", (280 + 110 * k, 330), 22, blue)
        s.blob(f"upper_wing_{side}", "thorax", [(280 + 14 * k, 220), (280 + 90 * k, 80), (280 + 220 * k, 60), (280 + 240 * k, 170), (280 + 120 * k, 256)], orange)
        s.circle(f"upper_spot_{side}", f"upper_wing_{side}", (280 + 170 * k, 130), 30, blue)
        s.circle(f"upper_dot_{side}", f"upper_spot_{side}", (280 + 170 * k, 130), 12, "#fff")
        s.rides |= {f"lower_spot_{side}", f"upper_spot_{side}", f"upper_dot_{side}"}
    s.tail("abdomen", "thorax", [(280, 260), (280, 320), (280, 384)], [34, 30, 12], dark)
    s.ellipse("thorax", None, (280, 226), 24, 44, dark)
    s.circle("head", "thorax", (280, 172), 22, dark)
    for side, k in (("l", -1), ("r", 1)):
        s.tail(f"antenna_{side}", "head", [(280 + 10 * k, 158), (280 + 40 * k, 110), (280 + 50 * k, 70)], [5, 5, 9], dark)
        s.eye(f"eye_{side}", "head", (280 + 12 * k, 168), 7)
    return s


def raccoon() -> Sheet:
    """A raccoon from the front that holds a fish."""
    s = Sheet(520, 600)
    grey, dark, light = "#8d8f94", "#3c3d42", "#d9d9d6"
    s.tail("tail", "body", [(330, 470), (420, 470), (460, 400), (440, 320)], [60, 66, 60, 34], grey)
    for n, (x, y) in enumerate(((410, 474), (452, 424), (452, 366))):
        s.line(f"stripe_{n}", "tail", [(x - 24, y - 18), (x + 20, y + 12)], 14, dark)
        s.rides.add(f"stripe_{n}")
    for side, k in (("left", 1), ("right", -1)):
        s.ellipse(f"leg_{side}", "body", (260 + 56 * k, 490), 44, 50, grey)
        s.ellipse(f"foot_{side}", f"leg_{side}", (260 + 70 * k, 540), 44, 20, dark)
    s.blob("body", None, [(180, 330), (210, 280), (310, 280), (340, 330), (356, 460), (310, 520), (210, 520), (164, 460)], grey)
    s.ellipse("belly", "body", (260, 430), 60, 80, light)
    s.limb("fish", "paw_right", (210, 400), (300, 384), (44, 30), "#7fb0c0")
    s.polygon("fish_tail", "fish", [(306, 382), (346, 356), (346, 410)], "#7fb0c0")
    s.eye("fish_eye", "fish", (206, 394), 6)
    for side, k in (("left", 1), ("right", -1)):
        s.limb(f"arm_{side}", "body", (260 + 70 * k, 320), (260 + 60 * k, 384), (40, 32), grey)
        s.circle(f"paw_{side}", f"arm_{side}", (260 + 48 * k, 398), 20, dark)
    for side, k in (("left", 1), ("right", -1)):
        s.blob(f"ear_{side}", "head", [(260 + 50 * k, 140), (260 + 76 * k, 84), (260 + 104 * k, 120), (260 + 90 * k, 170)], grey)
        s.blob(f"inner_ear_{side}", f"ear_{side}", [(260 + 64 * k, 140), (260 + 78 * k, 106), (260 + 92 * k, 126), (260 + 84 * k, 156)], light)
        s.rides.add(f"inner_ear_{side}")
    s.blob("head", "body", [(150, 220), (190, 150), (260, 132), (330, 150), (370, 220), (320, 280), (260, 296), (200, 280)], grey)
    for side, k in (("left", 1), ("right", -1)):
        s.ellipse(f"mask_{side}", "head", (260 + 54 * k, 212), 46, 28, dark, turn=-18 * k)
        s.eye(f"eye_{side}", f"mask_{side}", (260 + 46 * k, 208), 13)
        s.rides.add(f"mask_{side}")
    s.ellipse("muzzle", "head", (260, 250), 48, 34, light)
    s.ellipse("nose", "muzzle", (260, 234), 16, 11, INK)
    s.line("mouth", "muzzle", [(240, 262), (260, 270), (280, 262)], 3, INK)
    s.rides |= {"muzzle", "nose", "mouth", "belly"}
    return s


def giraffe() -> Sheet:
    """A giraffe from the side that looks to the left."""
    s = Sheet(560, 760)
    hide, spot, dark = "#e3bd72", "#a8703a", "#7d5a35"
    for end, x in (("front", 230), ("back", 400)):
        s.limb(f"{end}_upleg_far", "trunk", (x + 20, 480), (x + 24, 570), (44, 30), "#c9a45c")
        s.limb(f"{end}_lowleg_far", f"{end}_upleg_far", (x + 24, 570), (x + 20, 680), (26, 18), "#c9a45c")
        s.box(f"{end}_hoof_far", f"{end}_lowleg_far", (x + 20, 694), 28, 22, dark)
    s.tail("tail", "trunk", [(446, 420), (480, 470), (484, 540)], [16, 11, 7], hide)
    s.blob("tassel", "tail", [(478, 530), (492, 530), (500, 580), (472, 584)], dark)
    s.tail("mane", "neck", [(236, 380), (196, 260), (168, 130)], [26, 22, 18], dark)
    s.tail("neck", "trunk", [(240, 420), (200, 300), (170, 190), (154, 130)], [100, 66, 50, 44], hide)
    s.blob("trunk", None, [(190, 400), (250, 370), (380, 384), (450, 420), (450, 490), (380, 520), (250, 520), (196, 480)], hide)
    for n, (x, y) in enumerate(((260, 420), (320, 450), (380, 430), (410, 480), (280, 484))):
        s.ellipse(f"patch_{n}", "trunk", (x, y), 22, 18, spot, ink=0)
        s.rides.add(f"patch_{n}")
    for n, (x, y) in enumerate(((222, 370), (196, 300), (178, 236))):
        s.ellipse(f"neck_patch_{n}", "neck", (x, y), 14, 18, spot, ink=0)
        s.rides.add(f"neck_patch_{n}")
    for end, x in (("front", 220), ("back", 396)):
        s.limb(f"{end}_upleg_near", "trunk", (x, 484), (x + 2, 576), (50, 34), hide)
        s.limb(f"{end}_lowleg_near", f"{end}_upleg_near", (x + 2, 576), (x - 2, 690), (28, 20), hide)
        s.box(f"{end}_hoof_near", f"{end}_lowleg_near", (x - 2, 704), 30, 24, dark)
    s.limb("horn_far", "head", (158, 100), (168, 64), (9, 11), dark)
    s.blob("head", "neck", [(180, 110), (150, 90), (110, 106), (62, 150), (70, 172), (120, 168), (170, 152)], hide)
    s.limb("horn_near", "head", (146, 98), (150, 60), (10, 12), dark)
    s.blob("ear", "head", [(168, 104), (206, 88), (214, 102), (178, 122)], hide)
    s.eye("eye", "head", (134, 116), 9)
    s.ellipse("nostril", "head", (78, 152), 5, 4, INK, ink=0)
    s.line("mouth", "head", [(70, 168), (92, 164), (108, 158)], 3, INK)
    s.rides |= {"nostril", "mouth"}
    return s


def schoolkid() -> Sheet:
    """A boy from the side who walks to the right, with a cap, a satchel and a scarf in the wind."""
    s = Sheet(460, 660)
    skin, jacket, trousers, red = "#e7bd97", "#4f7d5a", "#54596b", "#c23f38"
    s.limb("upperarm_far", "jacket", (226, 262), (262, 330), (36, 30), "#3f6549")
    s.limb("forearm_far", "upperarm_far", (262, 330), (306, 372), (28, 22), "#3f6549")
    s.circle("hand_far", "forearm_far", (314, 380), 15, skin)
    s.limb("thigh_far", "jacket", (224, 410), (272, 490), (50, 40), "#444857")
    s.limb("shin_far", "thigh_far", (272, 490), (258, 580), (38, 30), "#444857")
    s.blob("shoe_far", "shin_far", [(242, 574), (276, 576), (306, 604), (240, 606)], INK)
    s.tail("scarf_end", "scarf", [(196, 226), (140, 216), (86, 240)], [26, 26, 22], red)
    s.blob("satchel", "jacket", [(130, 260), (186, 250), (190, 370), (134, 376)], "#9a6b3c")
    s.box("satchel_flap", "satchel", (158, 286), 56, 50, "#84582f")
    s.blob("jacket", None, [(178, 250), (220, 236), (260, 250), (272, 400), (256, 424), (190, 424), (176, 400)], jacket)
    s.line("strap", "jacket", [(206, 246), (196, 300), (184, 340)], 8, "#84582f")
    s.limb("thigh_near", "jacket", (218, 414), (190, 500), (54, 42), trousers)
    s.limb("shin_near", "thigh_near", (190, 500), (140, 574), (40, 32), trousers)
    s.blob("shoe_near", "shin_near", [(122, 566), (152, 582), (164, 616), (110, 600)], INK)
    s.box("neck", "jacket", (222, 228), 34, 36, skin)
    s.blob("head", "neck", [(168, 150), (196, 100), (250, 96), (284, 140), (282, 190), (240, 218), (190, 206)], skin)
    s.blob("hair", "head", [(164, 170), (160, 110), (210, 84), (230, 120), (204, 140), (196, 190)], "#5b3a22")
    s.ellipse("ear", "head", (208, 166), 13, 18, skin)
    s.eye("eye", "head", (256, 150), 9, (0.3, 0.0))
    s.line("brow", "head", [(244, 130), (258, 126), (270, 130)], 5, "#5b3a22")
    s.blob("nose", "head", [(276, 158), (298, 172), (278, 180)], skin)
    s.line("mouth", "head", [(254, 194), (266, 194), (276, 188)], 3, INK)
    s.blob("cap", "head", [(160, 120), (186, 70), (244, 66), (276, 104), (220, 112)], red)
    s.blob("peak", "cap", [(262, 92), (316, 100), (320, 112), (260, 112)], red)
    s.tail("scarf", "neck", [(184, 220), (222, 236), (262, 222)], [30, 32, 28], red)
    s.limb("upperarm_near", "jacket", (216, 266), (184, 340), (40, 32), jacket)
    s.limb("forearm_near", "upperarm_near", (184, 340), (206, 404), (30, 24), jacket)
    s.circle("hand_near", "forearm_near", (210, 416), 16, skin)
    s.rides |= {"strap", "brow", "mouth", "satchel_flap"}
    return s
