"""Ten more characters, from the side and from the front, drawn after the rules were frozen."""

from __future__ import annotations

from .sheet import INK, Sheet
from .walkers import legs


def dog() -> Sheet:
    """A dog that looks to the left, with a collar and a hanging ear."""
    s = Sheet(540, 420)
    fur, dark, light = "#c9a06a", "#a57d4c", "#f3e2c2"
    legs(s, "hind_far", "body", (396, 244), dark, (60, 30, 22), ((16, 50), (-8, 58), (-22, 4)))
    legs(s, "fore_far", "body", (240, 250), dark, (42, 28, 20), ((-2, 50), (0, 54), (-22, 4)))
    s.tail("tail", "body", [(408, 196), (444, 172), (470, 130), (470, 92)], [28, 24, 18, 8], fur)
    s.blob(
        "body",
        None,
        [(196, 196), (260, 174), (350, 176), (420, 196), (432, 240), (404, 276), (320, 270), (236, 288), (198, 250)],
        fur,
    )
    s.blob("patch", "body", [(300, 180), (350, 178), (372, 206), (340, 234), (304, 220)], dark, 0)
    legs(s, "hind_near", "body", (384, 238), fur, (66, 32, 24), ((18, 54), (-10, 60), (-24, 4)))
    legs(s, "fore_near", "body", (222, 248), fur, (46, 30, 22), ((-2, 54), (0, 56), (-24, 4)))
    s.limb("neck", "body", (224, 212), (176, 148), (80, 62), fur)
    s.limb("collar", "neck", (168, 186), (220, 158), (16, 16), "#b8383f")
    s.circle("tag", "collar", (186, 190), 10, "#f0c94a")
    s.blob(
        "head",
        "neck",
        [(66, 150), (92, 126), (130, 116), (168, 96), (204, 112), (210, 150), (180, 178), (120, 180), (76, 176)],
        fur,
    )
    s.blob("snout", "head", [(62, 150), (90, 132), (128, 140), (130, 172), (84, 178)], light)
    s.ellipse("nose", "snout", (68, 148), 11, 8, INK, ink=0)
    s.line("mouth", "snout", [(76, 168), (98, 170), (118, 162)], 3, INK)
    s.eye("eye", "head", (146, 130), 9, (-0.3, 0.0))
    s.blob("ear", "head", [(176, 104), (204, 104), (224, 150), (214, 194), (190, 190), (184, 150)], dark)
    s.rides |= {"patch", "collar", "snout", "nose", "mouth"}
    return s


def elephant() -> Sheet:
    """An elephant that looks to the left; a large ear over the head, a trunk in one piece."""
    s = Sheet(640, 520)
    skin, dark, light = "#9aa3b5", "#7e8799", "#b9c0cf"
    for name, x in (("hind", 470), ("fore", 290)):
        s.limb(f"{name}_foot_far", f"{name}_leg_far", (x, 400), (x - 2, 442), (56, 60), dark)
        s.limb(f"{name}_leg_far", "body", (x, 310), (x, 400), (74, 56), dark)
    s.line("tail", "body", [(530, 240), (556, 290), (552, 340)], 10, dark)
    s.ellipse("tail_tuft", "tail", (552, 348), 11, 17, INK, ink=0)
    s.blob(
        "body",
        None,
        [(250, 210), (330, 150), (450, 150), (534, 210), (544, 300), (500, 356), (380, 372), (270, 350)],
        skin,
    )
    for name, x in (("hind", 500), ("fore", 320)):
        s.limb(f"{name}_foot_near", f"{name}_leg_near", (x, 410), (x - 2, 458), (62, 66), skin)
        s.limb(f"{name}_leg_near", "body", (x, 312), (x, 410), (86, 62), skin)
    s.tail("tusk_far", "head", [(176, 260), (146, 286), (112, 284)], [20, 16, 4], "#e8e0c8")
    s.tail("trunk", "head", [(168, 210), (126, 250), (104, 320), (116, 390), (90, 428)], [78, 62, 46, 36, 26], skin)
    s.blob(
        "head",
        "body",
        [(150, 180), (176, 120), (240, 96), (300, 130), (316, 210), (280, 266), (210, 276), (160, 244)],
        skin,
    )
    s.tail("tusk_near", "head", [(196, 256), (166, 296), (128, 300)], [24, 18, 4], "#f5efda")
    s.eye("eye", "head", (196, 176), 11, (-0.3, 0.1))
    s.blob("ear", "head", [(244, 140), (300, 116), (350, 160), (346, 244), (296, 280), (258, 226)], light)
    for k in (-1, 0, 1):
        s.ellipse(f"toe_{k + 1}", "fore_foot_near", (318 + 18 * k, 482), 8, 6, light, ink=1)
    s.rides |= {"toe_0", "toe_1", "toe_2", "tail_tuft"}
    return s


def penguin() -> Sheet:
    """A penguin from the front, with a scarf."""
    s = Sheet(400, 480)
    black, belly, orange = "#2f3647", "#f4f2ea", "#e8973d"
    for side, k in (("r", -1), ("l", 1)):
        s.ellipse(f"foot_{side}", "body", (200 + 50 * k, 428), 42, 16, orange)
        s.blob(
            f"wing_{side}",
            "body",
            [
                (200 + 86 * k, 196),
                (200 + 122 * k, 226),
                (200 + 150 * k, 320),
                (200 + 128 * k, 336),
                (200 + 96 * k, 290),
                (200 + 76 * k, 240),
            ],
            black,
        )
    s.blob(
        "body",
        None,
        [(112, 250), (140, 190), (200, 172), (260, 190), (288, 250), (284, 360), (240, 424), (160, 424), (116, 360)],
        black,
    )
    s.blob(
        "belly",
        "body",
        [(140, 270), (168, 226), (200, 220), (232, 226), (260, 270), (252, 360), (200, 408), (148, 360)],
        belly,
        0,
    )
    s.circle("head", "body", (200, 128), 74, black)
    s.blob("face", "head", [(146, 140), (160, 96), (200, 112), (240, 96), (254, 140), (226, 178), (174, 178)], belly, 0)
    s.eye("eye_r", "head", (176, 126), 12, (0.2, 0.1))
    s.eye("eye_l", "head", (224, 126), 12, (-0.2, 0.1))
    s.polygon("beak", "head", [(178, 146), (222, 146), (200, 172)], orange)
    s.limb("scarf", "body", (142, 192), (258, 192), (28, 28), "#c8404f")
    s.limb("scarf_end", "scarf", (238, 196), (250, 258), (26, 30), "#b1323f")
    for k in range(3):
        s.circle(f"button_{k}", "belly", (200, 262 + 40 * k), 7, INK, ink=0)
    s.rides |= {"belly", "face", "beak", "scarf", "button_0", "button_1", "button_2"}
    return s


def frog() -> Sheet:
    """A frog that sits, from the front."""
    s = Sheet(520, 420)
    skin, dark, light = "#69b04f", "#4f9139", "#d9ecb0"
    for side, k in (("r", -1), ("l", 1)):
        x = 260 + 120 * k
        s.blob(
            f"hind_foot_{side}",
            f"shank_{side}",
            [(x + 10 * k, 348), (x + 40 * k, 340), (x + 104 * k, 366), (x + 90 * k, 382), (x + 6 * k, 376)],
            dark,
        )
        s.limb(f"shank_{side}", f"thigh_{side}", (x + 44 * k, 248), (x + 20 * k, 352), (46, 28), dark)
        s.limb(f"thigh_{side}", "body", (260 + 76 * k, 316), (x + 44 * k, 250), (76, 48), skin)
    s.blob(
        "body",
        None,
        [(166, 240), (200, 190), (260, 178), (320, 190), (354, 240), (340, 330), (260, 362), (180, 330)],
        skin,
    )
    s.blob("belly", "body", [(200, 270), (260, 248), (320, 270), (310, 330), (260, 350), (210, 330)], light, 0)
    for side, k in (("r", -1), ("l", 1)):
        x = 260 + 64 * k
        s.blob(
            f"hand_{side}", f"arm_{side}", [(x - 12, 356), (x + 12, 356), (x + 34, 388), (x, 394), (x - 34, 388)], skin
        )
        s.limb(f"arm_{side}", "body", (x, 270), (x, 362), (40, 24), skin)
    s.blob(
        "head",
        "body",
        [(150, 160), (190, 112), (260, 100), (330, 112), (370, 160), (336, 212), (260, 228), (184, 212)],
        skin,
    )
    for side, k in (("r", -1), ("l", 1)):
        x = 260 + 62 * k
        s.circle(f"lid_{side}", "head", (x, 104), 34, skin)
        s.circle(f"eye_{side}", f"lid_{side}", (x, 102), 22, "#fff", ink=1.5)
        s.ellipse(f"pupil_{side}", f"eye_{side}", (x, 104), 13, 7, INK, ink=0)
        s.circle(f"nostril_{side}", "head", (260 + 14 * k, 150), 4, INK, ink=0)
    s.line("mouth", "head", [(184, 176), (260, 200), (336, 176)], 5, INK)
    s.rides |= {"belly", "mouth", *(f"{part}_{side}" for part in ("eye", "pupil", "nostril") for side in "lr")}
    return s


def knight() -> Sheet:
    """A knight from the front, with a sword and a shield."""
    s = Sheet(520, 640)
    steel, dark, red, leather = "#b4bcc8", "#858f9e", "#a93b3b", "#6b4a30"
    s.blob("cape", "torso", [(186, 200), (260, 188), (334, 200), (366, 470), (260, 500), (154, 470)], red)
    for side, k in (("r", -1), ("l", 1)):
        x = 260 + 36 * k
        s.limb(f"shin_{side}", f"thigh_{side}", (x + 2 * k, 478), (x + 4 * k, 570), (44, 34), steel)
        s.limb(f"thigh_{side}", "hips", (x, 384), (x + 2 * k, 478), (58, 46), dark)
        s.ellipse(f"knee_{side}", f"shin_{side}", (x + 2 * k, 476), 19, 17, steel)
        s.blob(
            f"boot_{side}",
            f"shin_{side}",
            [(x - 18, 560), (x + 18, 560), (x + 20 + 18 * k, 604), (x - 20 + 18 * k, 604)],
            leather,
        )
    s.box("hips", None, (260, 366), 130, 58, dark, 12)
    s.blob("torso", "hips", [(190, 216), (260, 196), (330, 216), (340, 280), (316, 356), (204, 356), (180, 280)], steel)
    s.polygon("crest", "torso", [(240, 246), (280, 246), (280, 282), (260, 304), (240, 282)], red)
    s.box("belt", "torso", (260, 344), 124, 20, leather)
    s.box("buckle", "belt", (260, 344), 24, 24, "#e0b84a")
    s.limb("neck", "torso", (260, 212), (260, 176), (40, 40), dark)
    s.blob("plume", "helmet", [(256, 70), (272, 30), (330, 22), (360, 66), (344, 110), (312, 70)], red)
    s.blob(
        "helmet",
        "neck",
        [(204, 130), (214, 84), (260, 60), (306, 84), (316, 130), (302, 186), (260, 200), (218, 186)],
        steel,
    )
    s.box("slit", "helmet", (260, 128), 78, 16, INK, 8)
    for k in range(3):
        s.circle(f"rivet_{k}", "helmet", (240 + 20 * k, 162), 4, INK, ink=0)
    s.limb("upper_arm_r", "torso", (192, 236), (150, 316), (48, 36), dark)
    s.limb("forearm_r", "upper_arm_r", (150, 316), (134, 390), (40, 30), steel)
    s.polygon("blade", "hilt", [(102, 380), (118, 380), (122, 170), (110, 140), (98, 170)], "#dfe6ee")
    s.limb("hilt", "hand_r", (110, 386), (110, 436), (14, 14), leather)
    s.limb("guard", "hilt", (84, 382), (138, 382), (14, 14), "#e0b84a")
    s.circle("hand_r", "forearm_r", (124, 404), 20, leather)
    s.circle("shoulder_r", "upper_arm_r", (188, 232), 34, steel)
    s.limb("upper_arm_l", "torso", (328, 236), (374, 312), (48, 36), dark)
    s.limb("forearm_l", "upper_arm_l", (374, 312), (372, 380), (40, 30), steel)
    s.circle("shoulder_l", "upper_arm_l", (332, 232), 34, steel)
    s.blob("shield", "forearm_l", [(310, 310), (372, 294), (434, 310), (426, 400), (372, 452), (318, 400)], red)
    s.polygon(
        "shield_cross",
        "shield",
        [
            (364, 316),
            (380, 316),
            (380, 350),
            (412, 350),
            (412, 366),
            (380, 366),
            (380, 420),
            (364, 420),
            (364, 366),
            (332, 366),
            (332, 350),
            (364, 350),
        ],
        "#f0e6d0",
    )
    s.rides |= {
        "crest",
        "belt",
        "buckle",
        "slit",
        "rivet_0",
        "rivet_1",
        "rivet_2",
        "knee_l",
        "knee_r",
        "blade",
        "guard",
        "shield_cross",
    }
    return s


def witch() -> Sheet:
    """A witch who looks to the left, with a hat, long hair and a broom in her near hand."""
    s = Sheet(460, 620)
    skin, robe, dark, hair = "#bcd6a0", "#5a3f7a", "#46315f", "#d9742f"
    s.limb("far_upper_arm", "robe", (222, 236), (176, 290), (42, 36), dark)
    s.limb("far_forearm", "far_upper_arm", (176, 290), (126, 300), (36, 26), dark)
    s.circle("far_hand", "far_forearm", (112, 302), 15, skin)
    s.blob("far_shoe", "robe", [(196, 548), (226, 548), (226, 584), (160, 588), (150, 574)], INK)
    s.blob("hair_back", "head", [(226, 110), (276, 100), (312, 160), (318, 250), (290, 300), (262, 240)], hair)
    s.limb("neck", "robe", (228, 216), (222, 176), (32, 30), skin)
    s.blob(
        "robe",
        None,
        [(192, 226), (228, 206), (268, 226), (280, 340), (322, 548), (230, 566), (144, 548), (184, 340)],
        robe,
    )
    s.blob("near_shoe", "robe", [(244, 552), (276, 550), (278, 590), (206, 596), (196, 580)], INK)
    s.line("hem", "robe", [(152, 540), (232, 554), (314, 540)], 6, "#d0b04a")
    s.box("sash", "robe", (230, 330), 102, 18, "#d0b04a", 6)
    s.blob(
        "head",
        "neck",
        [(166, 140), (186, 104), (232, 92), (266, 116), (272, 158), (244, 190), (196, 196), (174, 176)],
        skin,
    )
    s.polygon("nose", "head", [(176, 128), (136, 158), (178, 160)], "#a9c68c")
    s.eye("eye", "head", (198, 132), 9, (-0.3, 0.0))
    s.line("brow", "head", [(184, 118), (198, 112), (212, 118)], 4, hair)
    s.line("mouth", "head", [(178, 176), (194, 174), (206, 166)], 3, INK)
    s.blob("lock", "head", [(230, 100), (262, 110), (276, 170), (256, 210), (244, 160)], hair)
    s.polygon("hat", "head", [(176, 100), (258, 92), (296, 8), (226, 40)], dark)
    s.limb("brim", "hat", (144, 108), (288, 94), (22, 22), dark)
    s.line("hat_band", "hat", [(184, 92), (220, 88), (256, 84)], 9, "#d0b04a")
    s.limb("broom_stick", "near_hand", (222, 452), (88, 352), (12, 12), "#8a5b33")
    s.blob(
        "broom_brush",
        "broom_stick",
        [(214, 440), (232, 466), (318, 520), (338, 492), (300, 440), (240, 432)],
        "#c99a4a",
    )
    s.circle("near_hand", "near_forearm", (166, 408), 18, skin)
    s.limb("near_forearm", "near_upper_arm", (232, 328), (176, 398), (44, 30), robe)
    s.limb("near_upper_arm", "robe", (240, 240), (232, 328), (52, 44), robe)
    s.rides |= {"hem", "sash", "nose", "brow", "mouth", "lock", "brim", "hat_band", "broom_brush"}
    return s


def crab() -> Sheet:
    """A crab from the front: claws of two parts, eyes on stalks, six legs."""
    s = Sheet(620, 400)
    shell, dark = "#d9593f", "#b3432f"
    for side, k in (("r", -1), ("l", 1)):
        for n in range(3):
            knee, tip = (
                (310 + (150 + 26 * n) * k, 250 + 8 * n),
                (310 + (178 + 12 * n - 20 * (n == 2)) * k, 316 + 20 * n),
            )
            s.limb(f"tip_{side}_{n}", f"leg_{side}_{n}", knee, tip, (18, 8), dark)
            s.limb(f"leg_{side}_{n}", "shell", (310 + 84 * k, 246 + 14 * n), knee, (26, 18), dark)
        s.limb(f"stalk_{side}", "shell", (310 + 40 * k, 164), (310 + 48 * k, 104), (16, 12), dark)
        s.eye(f"eye_{side}", f"stalk_{side}", (310 + 49 * k, 92), 18, (0.0, 0.1))
        s.limb(f"arm_{side}", "shell", (310 + 96 * k, 200), (310 + 186 * k, 164), (36, 30), dark)
        s.blob(
            f"thumb_{side}",
            f"claw_{side}",
            [
                (310 + 206 * k, 130),
                (310 + 186 * k, 100),
                (310 + 192 * k, 58),
                (310 + 216 * k, 84),
                (310 + 226 * k, 120),
            ],
            shell,
        )
        s.blob(
            f"claw_{side}",
            f"arm_{side}",
            [
                (310 + 176 * k, 166),
                (310 + 196 * k, 124),
                (310 + 232 * k, 108),
                (310 + 234 * k, 50),
                (310 + 276 * k, 96),
                (310 + 264 * k, 156),
                (310 + 216 * k, 184),
            ],
            shell,
        )
    s.blob(
        "shell",
        None,
        [(190, 220), (230, 164), (310, 146), (390, 164), (430, 220), (400, 284), (310, 302), (220, 284)],
        shell,
    )
    for k, (x, y) in enumerate(((260, 190), (310, 176), (360, 190))):
        s.circle(f"dot_{k}", "shell", (x, y), 9, "#f0a07f", ink=0)
    s.line("mouth", "shell", [(272, 240), (310, 258), (348, 240)], 5, INK)
    s.rides |= {"dot_0", "dot_1", "dot_2", "mouth"}
    return s


def turtle() -> Sheet:
    """A turtle that walks to the right: a shell over the body."""
    s = Sheet(560, 360)
    skin, dark, shell = "#8fb06a", "#6f9050", "#8a6a3f"
    for name, x in (("hind", 176), ("fore", 336)):
        s.limb(f"{name}_foot_far", f"{name}_leg_far", (x + 14, 274), (x + 34, 284), (28, 22), dark)
        s.limb(f"{name}_leg_far", "body", (x, 232), (x + 14, 274), (46, 32), dark)
    s.tail("tail", "body", [(132, 226), (100, 236), (70, 254)], [28, 18, 6], skin)
    s.limb("neck", "body", (374, 220), (432, 160), (56, 42), skin)
    s.limb("body", None, (150, 226), (380, 226), (58, 58), skin)
    for name, x in (("hind", 196), ("fore", 356)):
        s.limb(f"{name}_foot_near", f"{name}_leg_near", (x + 12, 286), (x + 36, 298), (32, 26), skin)
        s.limb(f"{name}_leg_near", "body", (x, 236), (x + 12, 286), (54, 36), skin)
    s.blob("shell", "body", [(120, 228), (140, 150), (210, 92), (280, 90), (350, 140), (392, 222), (260, 246)], shell)
    for k, (x, y) in enumerate(((190, 160), (260, 142), (322, 170))):
        s.blob(
            f"scute_{k}",
            "shell",
            [(x - 26, y), (x - 12, y - 26), (x + 16, y - 24), (x + 28, y + 4), (x + 6, y + 28), (x - 18, y + 24)],
            "#b08d55",
        )
    s.line("shell_rim", "shell", [(128, 220), (256, 240), (386, 216)], 8, "#6b502c")
    s.blob("head", "neck", [(412, 152), (424, 116), (464, 102), (504, 122), (510, 156), (470, 178), (430, 174)], skin)
    s.eye("eye", "head", (474, 130), 10, (0.3, 0.0))
    s.line("mouth", "head", [(470, 160), (490, 158), (504, 150)], 3, INK)
    s.rides |= {"shell", "scute_0", "scute_1", "scute_2", "shell_rim", "mouth"}
    return s


def stork() -> Sheet:
    """A stork that looks to the right, with long legs, a long neck and a folded wing."""
    s = Sheet(460, 640)
    white, black, red = "#f4f1ea", "#2f3340", "#d8542f"
    for depth, x in (("far", 226), ("near", 196)):
        colour = red if depth == "near" else "#b04426"
        if depth == "near":
            s.polygon("tail", "body", [(96, 290), (40, 330), (60, 350), (122, 326)], black)
            s.blob(
                "body", None, [(96, 300), (140, 250), (220, 236), (284, 262), (292, 310), (236, 352), (156, 348)], white
            )
        s.limb(f"foot_{depth}", f"shin_{depth}", (x + 6, 566), (x + 46, 572), (12, 9), colour)
        s.limb(f"shin_{depth}", f"thigh_{depth}", (x - 6, 452), (x + 6, 566), (14, 11), colour)
        s.limb(f"thigh_{depth}", "body", (x, 330), (x - 6, 452), (30, 15), colour)
    s.blob("wing", "body", [(250, 262), (190, 256), (120, 296), (44, 346), (120, 344), (200, 326), (254, 300)], black)
    s.blob("wing_top", "wing", [(248, 264), (200, 258), (150, 286), (196, 302), (240, 292)], white)
    s.tail("neck", "body", [(266, 290), (312, 240), (304, 180), (322, 122)], [64, 44, 34, 30], white)
    s.polygon("beak_lower", "head", [(346, 118), (444, 148), (348, 130)], "#b04426")
    s.polygon("beak_upper", "head", [(344, 98), (450, 142), (346, 122)], red)
    s.ellipse("head", "neck", (328, 106), 34, 27, white)
    s.eye("eye", "head", (336, 100), 7, (0.2, 0.0))
    s.rides |= {"wing_top"}
    return s


def caterpillar() -> Sheet:
    """A caterpillar of round segments, each over the next, with stub legs and feelers."""
    s = Sheet(640, 280)
    greens = ("#9fcf4f", "#86b93e")
    for n in range(6, 0, -1):
        x, y = 170 + 66 * n, 170 - (14 if n % 2 else 0)
        on = None if n == 3 else f"segment_{n - 1}" if n > 3 else f"segment_{n + 1}"
        s.limb(f"leg_{n}", f"segment_{n}", (x - 4, y + 34), (x - 10, y + 62), (18, 14), "#c97f3f")
        s.circle(f"segment_{n}", on, (x, y), 46 if n == 3 else 44, greens[n % 2])
        s.circle(f"dot_{n}", f"segment_{n}", (x + 4, y - 14), 8, "#f2e26a", ink=0)
        s.rides.add(f"dot_{n}")
    for side, k in (("far", 1), ("near", -1)):
        s.line(f"feeler_{side}", "head", [(166 + 16 * k, 112), (160 + 30 * k, 76), (150 + 48 * k, 58)], 6, INK)
        s.circle(f"knob_{side}", f"feeler_{side}", (150 + 48 * k, 56), 10, "#d9593f")
        s.rides.add(f"knob_{side}")
    s.circle("head", "segment_1", (164, 152), 56, "#e2b84a")
    s.eye("eye_l", "head", (150, 140), 13, (-0.2, 0.0))
    s.eye("eye_r", "head", (188, 140), 13, (-0.2, 0.0))
    s.line("mouth", "head", [(144, 172), (164, 184), (188, 172)], 4, INK)
    s.rides |= {"mouth"}
    return s
