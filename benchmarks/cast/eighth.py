"""Ten characters drawn after the seventh ten had been measured, without knowledge of the rules; measured once."""
# ruff: noqa: E501
# fmt: off

from __future__ import annotations

from .sheet import INK, Point, Sheet


def _limbs(s: Sheet, on: str, names: str, joints: list[Point], widths: tuple[float, ...], fill: str, tip: str = "") -> None:
    """Limbs from joint to joint, the upper over the lower; a name more than there are limbs is a hand, below both."""
    parts, last, ((ex, ey), (wx, wy)) = names.split(", "), len(joints) - 1, joints[-2:]
    for name in parts[last:]:
        s.circle(name, parts[last - 1], (wx + 0.16 * (wx - ex), wy + 0.16 * (wy - ey)), 0.66 * widths[last], tip or fill)
    for n in reversed(range(last)):
        s.limb(parts[n], parts[n - 1] if n else on, joints[n], joints[n + 1], (widths[n], widths[n + 1]), fill)


def nurse() -> Sheet:
    """A nurse from the front, with a cap, a stethoscope and a clipboard; in groups."""
    s, skin, dress, hair, white = Sheet(440, 680), "#e9b48f", "#8fc1d4", "#3d2a25", "#f7f5ef"
    s.blob("hair_back", "face", [(164, 120), (220, 78), (276, 120), (288, 190), (270, 226), (170, 226), (152, 190)], hair)
    for side, k, x in (("left", 1, 250), ("right", -1, 190)):
        s.group(f"{side} leg")
        _limbs(s, "skirt", f"leg_upper_{side}, leg_lower_{side}", [(x, 440), (x + 3 * k, 530), (x + 4 * k, 618)], (44, 34, 25), skin)
        s.blob(f"shoe_{side}", f"leg_lower_{side}", [(x - 14 * k, 606), (x + 20 * k, 606), (x + 38 * k, 630), (x + 30 * k, 642), (x - 16 * k, 642)], white)
    s.group("body")
    s.limb("neck", "top", (220, 250), (220, 212), (34, 32), skin)
    s.blob("skirt", None, [(176, 362), (220, 356), (264, 362), (290, 440), (298, 494), (220, 504), (142, 494), (150, 440)], dress)
    s.blob("top", "skirt", [(162, 264), (196, 244), (244, 244), (278, 264), (272, 320), (266, 376), (220, 384), (174, 376), (168, 320)], dress)
    s.line("stethoscope", "top", [(194, 248), (190, 300), (216, 336), (244, 300), (246, 248)], 6, "#3b4148")
    for side, k, joints in (("right", -1, [(168, 276), (140, 350), (130, 428)]), ("left", 1, [(272, 276), (312, 344), (264, 392)])):
        s.group(f"{side} arm")
        if k > 0:
            s.polygon("clipboard", "hand_left", [(222, 330), (282, 318), (298, 404), (238, 416)], "#9a6a41")
        _limbs(s, "top", f"arm_upper_{side}, arm_lower_{side}, hand_{side}", joints, (40, 32, 24), skin)
        s.limb(f"sleeve_{side}", f"arm_upper_{side}", (220 + 52 * k, 274), (220 + 64 * k, 306), (46, 44), dress)
    s.group("head")
    s.blob("face", "neck", [(166, 150), (184, 106), (220, 94), (256, 106), (274, 150), (262, 196), (220, 226), (178, 196)], skin)
    for side, k in (("left", 1), ("right", -1)):
        s.eye(f"eye_{side}", "face", (220 + 24 * k, 160), 10)
    s.blob("fringe", "face", [(160, 154), (176, 100), (220, 80), (264, 100), (280, 154), (262, 140), (240, 116), (206, 128), (176, 140)], hair)
    s.polygon("cap", "face", [(172, 66), (220, 52), (268, 66), (258, 106), (220, 98), (182, 106)], white)
    s.rides |= {"hair_back", "stethoscope", "sleeve_left", "sleeve_right", "fringe"}
    return s


def viking() -> Sheet:
    """A viking from three quarters who turns to the right, with an axe, a round shield and a cape."""
    s, skin, tunic, trousers, leather, steel, red = Sheet(600, 690), "#e2ab86", "#5d7a56", "#6a5c4e", "#74492c", "#a9b1b8", "#c0692e"
    s.blob("Cape", "Chest", [(200, 250), (256, 236), (316, 252), (330, 380), (322, 520), (250, 546), (160, 520), (176, 380)], "#8a3436")
    _limbs(s, "Chest", "LBicep, LForearm, LHand", [(318, 282), (376, 344), (440, 330)], (50, 42, 32), "#c9936f")
    s.circle("Shield", "LHand", (456, 336), 88, "#b8843f")
    for side, x, k in (("L", 300, 1), ("R", 226, -1)):
        _limbs(s, "Hips", f"{side}Thigh, {side}Calf", [(x, 436), (x + 14 * k, 524), (x + 18 * k, 600)], (66, 52, 42), trousers)
        s.blob(f"{side}Boot", f"{side}Calf", [(x + 18 * k - 28, 570), (x + 18 * k + 28, 570), (x + 18 * k + 30, 612), (x + 18 * k + 66, 634), (x + 18 * k + 64, 648), (x + 18 * k - 28, 648)], leather)
    s.blob("Hips", None, [(192, 396), (260, 390), (328, 396), (344, 460), (330, 486), (262, 494), (196, 486), (180, 460)], tunic)
    s.blob("Chest", "Hips", [(184, 276), (222, 250), (300, 248), (336, 276), (338, 344), (326, 414), (262, 422), (194, 414), (182, 344)], tunic)
    s.tail("Belt", "Hips", [(188, 408), (260, 418), (332, 408)], [24, 24, 24], leather)
    s.limb("AxeHaft", "RHand", (150, 560), (70, 250), (15, 15), "#7b5532")
    s.blob("AxeBlade", "AxeHaft", [(86, 266), (60, 244), (24, 236), (8, 290), (20, 346), (56, 332), (96, 318)], steel)
    _limbs(s, "Chest", "RBicep, RForearm, RHand", [(204, 288), (156, 366), (124, 420)], (58, 46, 34), skin)
    s.blob("FurCollar", "Chest", [(172, 276), (200, 240), (232, 246), (266, 268), (302, 246), (338, 250), (346, 284), (300, 292), (262, 300), (206, 304)], "#8f7a60")
    s.blob("Head", "Chest", [(220, 160), (238, 116), (290, 110), (322, 144), (326, 168), (344, 190), (322, 200), (298, 236), (252, 232), (224, 200)], skin)
    s.blob("Beard", "Head", [(226, 186), (252, 206), (300, 206), (324, 196), (324, 250), (298, 310), (284, 330), (264, 304), (234, 250)], red)
    s.eye("Reye", "Head", (272, 168), 9, (0.3, 0.0))
    s.eye("Leye", "Head", (308, 168), 8, (0.3, 0.0))
    for side, x, k in (("L", 310, 1), ("R", 234, -1)):
        s.tail(f"{side}Horn", "Helmet", [(x, 120), (x + 50 * k, 102), (x + 64 * k, 48)], [32, 26, 5], "#efe6cd")
    s.blob("Helmet", "Head", [(212, 160), (214, 106), (266, 70), (318, 98), (336, 148), (300, 140), (252, 144)], steel)
    s.rides |= {"Belt", "FurCollar"}
    return s


def footballer() -> Sheet:
    """A footballer from the side who kicks to the right; the limbs of the near side are number 1."""
    s, skin, far, shirt, shorts, sock = Sheet(600, 640), "#b97a50", "#9a6340", "#2f6db5", "#f2f0ea", "#d9b83a"
    _limbs(s, "shirt", "arm2 upper, arm2 lower, hand2", [(258, 230), (330, 268), (392, 226)], (34, 28, 21), far)
    s.blob("boot2", "leg2 lower", [(160, 576), (196, 578), (218, 598), (252, 606), (250, 620), (156, 620)], "#2b2b30")
    s.limb("leg2 lower", "leg2 upper", (238, 484), (180, 588), (42, 28), "#b3962e")
    s.limb("leg2 upper", "shorts", (232, 382), (238, 484), (54, 42), far)
    s.limb("shorts leg2", "leg2 upper", (230, 382), (237, 440), (66, 62), "#d3d0c8")
    s.blob("shorts", None, [(198, 346), (234, 340), (272, 350), (276, 392), (248, 416), (206, 408), (192, 380)], shorts)
    s.limb("neck", "shirt", (246, 216), (260, 180), (34, 32), skin)
    s.blob("shirt", "shorts", [(194, 346), (196, 280), (214, 220), (250, 204), (278, 226), (284, 290), (276, 360), (232, 368), (200, 364)], shirt)
    s.line("shirt stripe", "shirt", [(268, 240), (270, 300), (262, 354)], 8, "#fff")
    s.blob("head", "neck", [(218, 134), (232, 90), (280, 82), (310, 112), (312, 128), (326, 150), (308, 158), (304, 182), (272, 194), (236, 176)], skin)
    s.ellipse("ear", "head", (250, 140), 11, 15, far)
    s.eye("eye", "head", (292, 126), 8, (0.3, 0.0))
    s.blob("hair", "head", [(214, 142), (214, 92), (252, 62), (302, 72), (310, 98), (276, 100), (258, 122), (240, 124), (236, 150)], "#231a18")
    s.blob("boot1", "leg1 lower", [(432, 416), (450, 386), (482, 384), (530, 362), (538, 376), (494, 430), (456, 446)], "#e2483d")
    s.limb("leg1 lower", "leg1 upper", (346, 428), (446, 416), (46, 30), sock)
    s.limb("leg1 upper", "shorts", (238, 384), (346, 428), (62, 46), skin)
    s.limb("shorts leg1", "leg1 upper", (236, 384), (298, 409), (74, 68), shorts)
    _limbs(s, "shirt", "arm1 upper, arm1 lower, hand1", [(226, 240), (164, 298), (96, 318)], (40, 31, 23), skin)
    s.limb("sleeve1", "arm1 upper", (228, 238), (194, 270), (50, 46), shirt)
    s.rides |= {"sleeve1", "shorts leg1", "shorts leg2", "shirt stripe", "ear"}
    return s


def waiter() -> Sheet:
    """A waiter from three quarters who turns to the left, with a tray and a towel; in groups."""
    s, skin, white, black, hair = Sheet(520, 700), "#f0c6a4", "#f4f2ee", "#363440", "#5b4636"
    s.group("arm right")
    _limbs(s, "torso", "upperArmR, foreArmR", [(206, 284), (146, 330), (100, 238)], (40, 33, 25), "#d8d6d6")
    s.blob("handR", "foreArmR", [(86, 240), (80, 218), (68, 206), (100, 200), (132, 206), (120, 220), (114, 240)], skin)
    s.blob("glass", "tray", [(112, 196), (126, 190), (126, 164), (108, 150), (106, 118), (156, 118), (154, 150), (136, 164), (136, 190), (150, 196)], "#cfe3ea")
    s.ellipse("tray", "handR", (98, 198), 82, 13, "#b4bac2")
    for side, x in (("R", 232), ("L", 294)):
        s.group("leg right" if side == "R" else "leg left")
        s.blob(f"shoe{side}", f"lowerLeg{side}", [(x + 16, 616), (x + 20, 648), (x - 58, 650), (x - 56, 634), (x - 18, 616)], "#1f1d24")
        _limbs(s, "hips", f"upperLeg{side}, lowerLeg{side}", [(x, 428), (x + 4, 526), (x, 626)], (58, 46, 36), black)
    s.group("torso and apron")
    s.limb("neck", "torso", (250, 256), (244, 216), (38, 36), skin)
    s.blob("hips", None, [(206, 386), (264, 380), (322, 386), (328, 436), (264, 450), (200, 436)], black)
    s.blob("torso", "hips", [(192, 280), (222, 254), (292, 252), (322, 278), (322, 340), (318, 404), (262, 412), (208, 404), (198, 340)], "#8a3a4a")
    s.blob("apron", "hips", [(206, 400), (262, 408), (322, 400), (330, 500), (322, 566), (256, 574), (200, 560), (198, 490)], white)
    s.polygon("bowTie", "torso", [(216, 250), (240, 260), (266, 250), (266, 280), (240, 270), (216, 280)], black)
    s.group("face and hair")
    s.blob("headShape", "neck", [(194, 160), (206, 116), (256, 104), (292, 134), (294, 184), (268, 222), (222, 224), (200, 200)], skin)
    s.eye("eyeR", "headShape", (212, 160), 7, (-0.3, 0.0))
    s.eye("eyeL", "headShape", (242, 160), 9, (-0.3, 0.0))
    s.blob("moustache", "headShape", [(190, 204), (216, 192), (252, 204), (266, 196), (248, 214), (216, 206), (194, 214)], hair)
    s.blob("hairTop", "headShape", [(196, 136), (206, 94), (256, 80), (304, 114), (304, 160), (282, 156), (272, 128), (232, 126)], hair)
    s.group("arm left")
    _limbs(s, "torso", "upperArmL, foreArmL, handL", [(312, 288), (344, 370), (240, 372)], (48, 38, 28), white, skin)
    s.blob("towel", "foreArmL", [(262, 348), (316, 350), (322, 420), (320, 470), (264, 466), (258, 410)], "#dfe8ec")
    s.rides |= {"bowTie", "moustache", "hairTop"}
    return s


def cow() -> Sheet:
    """A cow from the side that looks to the left, with a bell; in groups."""
    s, hide, far, patch, pink, horn = Sheet(740, 500), "#f3eee6", "#cfc8be", "#5a3c31", "#e6a9a0", "#d9c79a"
    for side, word, low, colour in (("R", "Right", 0, far), ("L", "Left", 14, hide)):
        if side == "L":
            s.group("Body Group")
            s.tail("tail", "body", [(616, 180), (658, 200), (668, 270), (660, 330)], [22, 18, 13, 11], hide)
            s.blob("tail_tuft", "tail", [(650, 318), (672, 318), (684, 360), (664, 398), (644, 362)], patch)
            s.blob("udder", "body", [(470, 300), (530, 304), (546, 340), (520, 368), (478, 362), (462, 332)], pink)
            s.blob("body", None, [(232, 190), (300, 152), (420, 160), (560, 148), (622, 176), (634, 250), (600, 314), (480, 336), (340, 334), (254, 300)], hide)
            s.blob("patch", "body", [(352, 162), (430, 164), (446, 214), (410, 252), (360, 230)], patch)
        for end, place, x, width in (("F", "Front", 264 + 2 * low, 64), ("B", "Back", 546 + 3 * low, 88)):
            s.group(f"{place} {word} Leg")
            s.polygon(f"{end}{side}_hoof", f"{end}{side}_lower", [(x - 17, 426 + low), (x + 19, 426 + low), (x + 23, 458 + low), (x - 28, 458 + low)], INK)
            _limbs(s, "body", f"{end}{side}_upper, {end}{side}_lower", [(x, 270), (x + 4, 346 + low), (x, 430 + low)], (width, 43, 32), colour)
    s.group("Head Group")
    s.tail("horn_R", "skull", [(158, 92), (146, 66), (154, 40)], [20, 14, 5], "#bfae85")
    s.blob("ear_R", "skull", [(140, 104), (118, 84), (92, 84), (100, 106), (132, 122)], far)
    s.blob("neck", "body", [(184, 112), (232, 126), (300, 160), (310, 240), (262, 278), (206, 222), (172, 190)], hide)
    s.tail("collar", "neck", [(254, 132), (234, 180), (196, 214)], [18, 18, 18], "#b5443a")
    s.blob("bell", "collar", [(192, 210), (210, 208), (222, 246), (186, 252)], "#d9ac3c")
    s.blob("skull", "neck", [(128, 116), (164, 88), (206, 100), (220, 150), (200, 204), (144, 232), (84, 230), (60, 204), (70, 178), (108, 158)], hide)
    s.blob("muzzle", "skull", [(60, 204), (68, 176), (96, 168), (116, 190), (112, 220), (84, 228)], pink)
    s.eye("eye", "skull", (146, 142), 11, (-0.2, 0.1))
    s.tail("horn_L", "skull", [(186, 100), (184, 66), (202, 36)], [24, 17, 5], horn)
    s.blob("ear_L", "skull", [(204, 114), (236, 92), (270, 96), (262, 122), (214, 138)], patch)
    s.rides |= {"patch", "collar", "muzzle"}
    return s


def bear() -> Sheet:
    """A bear from the front on its hind legs, with a scarf."""
    s, fur, dark, light, scarf = Sheet(540, 650), "#8b5a37", "#6f4529", "#cfa678", "#3f8a6d"
    for side, k in (("l", 1), ("r", -1)):
        x = 270 + 62 * k
        _limbs(s, "hips", f"{side}-thigh, {side}-shin", [(x, 456), (x + 10 * k, 530), (x + 10 * k, 590)], (100, 76, 60), fur)
        s.ellipse(f"{side}-foot", f"{side}-shin", (x + 18 * k, 604), 52, 24, dark)
    s.blob("hips", None, [(172, 420), (270, 396), (368, 420), (380, 470), (330, 520), (270, 530), (210, 520), (160, 470)], fur)
    s.blob("chest", "hips", [(178, 290), (214, 254), (270, 244), (326, 254), (362, 290), (382, 380), (374, 450), (270, 474), (166, 450), (158, 380)], fur)
    s.ellipse("tummy", "chest", (270, 376), 72, 80, light)
    for side, k in (("l", 1), ("r", -1)):
        joints = [(270 + 92 * k, 296), (270 + 140 * k, 372), (270 + (128 if k > 0 else 178) * k, 452 if k > 0 else 308)]
        _limbs(s, "chest", f"{side}-arm, {side}-forearm, {side}-paw", joints, (76, 62, 50), fur, dark)
    s.blob("scarf-end", "scarf", [(304, 262), (340, 262), (352, 330), (346, 376), (306, 372), (308, 320)], scarf)
    s.blob("scarf", "chest", [(190, 250), (220, 236), (270, 246), (320, 236), (350, 250), (344, 282), (270, 296), (196, 282)], scarf)
    for side, k in (("l", 1), ("r", -1)):
        s.circle(f"{side}-ear", "head", (270 + 72 * k, 86), 34, fur)
    s.ellipse("jaw", "head", (270, 226), 38, 32, light)
    s.blob("head", "chest", [(168, 166), (190, 100), (270, 70), (350, 100), (372, 166), (348, 216), (270, 238), (192, 216)], fur)
    s.ellipse("snout", "head", (270, 190), 52, 38, light)
    s.ellipse("nose", "snout", (270, 170), 20, 14, INK)
    for side, k in (("l", 1), ("r", -1)):
        s.eye(f"{side}-eye", "head", (270 + 44 * k, 138), 11)
    s.rides |= {"tummy", "snout", "nose"}
    return s


def parrot() -> Sheet:
    """A macaw in flight from the side that looks to the right; in groups."""
    s, red, dark, yellow, blue, bone = Sheet(680, 600), "#d23c35", "#a62d2c", "#efc23f", "#2f63b0", "#f2ead6"
    for depth, x, k, (tip, mid, base) in (("far", 366, 0.9, ("#234c88", "#c79d2e", dark)), ("near", 320, -1, (blue, yellow, red))):
        if depth == "near":
            s.group("feet")
            for depth, dx, colour in (("far", 22, dark), ("near", 0, red)):
                s.blob(f"{depth} claw", f"{depth} thigh", [(262 + dx, 416), (280 + dx, 410), (290 + dx, 436), (270 + dx, 458), (252 + dx, 446), (240 + dx, 428)], "#5d5a60")
                s.limb(f"{depth} thigh", "torso", (300 + dx, 372), (268 + dx, 418), (44, 22), colour)
            s.group("trunk")
            for n, low, colour in ((3, 0, blue), (2, 58, dark), (1, 40, red)):
                s.tail(f"tail feather {n}", "rump", [(200, 384 + 0.1 * low), (138 - 0.2 * low, 410 + 0.6 * low), (54 - (n == 1) * 14, 462 + low)], [32, 28, 8], colour)
            s.blob("rump", "torso", [(274, 310), (296, 360), (248, 402), (196, 416), (176, 392), (212, 350)], red)
            s.blob("torso", None, [(250, 330), (310, 276), (390, 242), (440, 250), (456, 300), (420, 360), (340, 392), (270, 384)], red)
            s.group("head and beak")
            s.blob("lower beak", "skull", [(522, 240), (546, 246), (548, 270), (528, 284), (508, 262)], "#3b3840")
            s.blob("skull", "torso", [(400, 260), (424, 204), (480, 176), (530, 198), (544, 240), (520, 276), (470, 296), (430, 310)], red)
            s.blob("cheek patch", "skull", [(488, 206), (526, 204), (534, 240), (510, 266), (482, 242)], bone)
            s.blob("upper beak", "skull", [(524, 196), (566, 202), (588, 240), (580, 286), (562, 256), (530, 250)], bone)
            s.eye("eye", "skull", (502, 220), 10, (0.2, 0.0), "#f6e8a0")
        s.group(f"wing {depth}")
        s.blob(f"{depth} wing primaries", f"{depth} wing middle", [(x + k * dx, y) for dx, y in ((64, 158), (104, 112), (162, 60), (222, 42), (208, 96), (174, 142), (114, 192), (72, 204))], tip)
        s.blob(f"{depth} wing middle", f"{depth} wing base", [(x + k * dx, y) for dx, y in ((32, 248), (84, 216), (114, 180), (98, 126), (46, 112), (2, 166), (-16, 230))], mid)
        s.blob(f"{depth} wing base", "torso", [(x + k * dx, y) for dx, y in ((8, 330), (52, 268), (58, 208), (8, 168), (-38, 214), (-76, 284), (-52, 336))], base)
    s.rides.add("cheek patch")
    return s


def grasshopper() -> Sheet:
    """A grasshopper from the side that looks to the left."""
    s, green, far, light, brown = Sheet(760, 440), "#7fb045", "#5f8733", "#b9d77a", "#a98b4e"
    for depth, dx, dy, colour in (("far", 34, -12, far), ("near", 0, 0, green)):
        if depth == "near":
            for n in (4, 3, 2, 1):
                s.ellipse(f"abdomen {n}", f"abdomen {n - 1}" if n > 1 else "thorax", (318 + 62 * n, 240 + 4 * n), 48, 50 - 6 * n, light if n % 2 else "#a4c766")
            s.blob("thorax", None, [(190, 210), (250, 188), (340, 196), (374, 236), (356, 282), (280, 300), (206, 284)], green)
            s.blob("hind wing", "thorax", [(300, 204), (400, 186), (540, 204), (636, 244), (560, 258), (420, 252), (320, 244)], "#d8d1a0")
            s.blob("fore wing", "thorax", [(290, 200), (380, 178), (520, 196), (622, 226), (540, 238), (400, 238), (310, 236)], brown)
            s.blob("mandible", "head", [(130, 262), (160, 264), (166, 288), (144, 302), (126, 284)], brown)
            s.blob("head", "thorax", [(136, 180), (174, 154), (216, 168), (232, 220), (216, 268), (170, 286), (132, 272), (122, 224)], green)
            s.blob("pronotum", "thorax", [(208, 174), (260, 162), (318, 186), (322, 232), (282, 262), (218, 262), (202, 214)], far)
            s.eye("eye", "head", (162, 194), 21, (-0.2, 0.0), "#d8633f")
        s.line(f"antenna {depth}", "head", [(172 - 0.6 * dx, 164), (152 - dx, 92 + 0.5 * dx), (106 - 1.4 * dx, 38 + 1.4 * dx)], 6, colour)
        for name, x, knee in (("fore", 232 - dx, -36), ("mid", 304 - 0.6 * dx, 40)):
            _limbs(s, "thorax", f"{name} femur {depth}, {name} tibia {depth}", [(x, 278 + dy), (x + knee, 336 + dy), (x + 0.6 * knee, 404 + dy)], (25, 17, 10), colour)
        s.tail(f"hind tarsus {depth}", f"hind tibia {depth}", [(552 + 1.6 * dx, 394 + dy), (574 + 1.6 * dx, 408 + dy), (612 + 1.6 * dx, 410 + dy)], [13, 13, 6], brown)
        s.limb(f"hind tibia {depth}", f"hind femur {depth}", (476 + dx, 96 - dy), (556 + 1.6 * dx, 400 + dy), (19, 11), brown)
        s.limb(f"hind femur {depth}", "thorax", (334, 264 + dy), (476 + dx, 96 - dy), (56, 22), colour)
    s.rides.add("pronotum")
    return s


def excavator() -> Sheet:
    """An excavator from the side with its bucket on the left: a machine with pins and cylinders."""
    s, yellow, shade, grey, dark = Sheet(860, 520), "#efb52f", "#c98f22", "#8d949b", "#41454b"
    s.box("Track_Far", "Undercarriage", (586, 440), 300, 70, "#2c2f33", 35)
    s.box("Undercarriage", None, (570, 408), 200, 60, grey, 8)
    s.box("Track_Near", "Undercarriage", (560, 450), 320, 80, dark, 40)
    for n, (x, r) in enumerate(((440, 27), (500, 18), (560, 18), (620, 18), (680, 27))):
        s.circle(f"Wheel_{n + 1}", "Undercarriage", (x, 450), r, grey)
    s.box("Turntable", "Undercarriage", (566, 370), 120, 26, dark)
    s.polygon("House", "Turntable", [(452, 290), (560, 276), (736, 258), (740, 364), (452, 364)], yellow)
    s.circle("Beacon", "Cab", (528, 142), 14, "#e2603a")
    s.polygon("Cab", "House", [(468, 152), (576, 152), (586, 340), (446, 340), (446, 240)], yellow)
    s.polygon("Window", "Cab", [(478, 166), (564, 166), (570, 280), (460, 280), (460, 242)], "#bfe0e8")
    s.blob("Driver", "Cab", [(500, 280), (506, 246), (518, 236), (508, 214), (526, 198), (544, 214), (536, 236), (550, 246), (558, 280)], "#d9653b")
    for name, on, end, a, b, c in (("Boom", "House", "Boom", (462, 344), (400, 268), (362, 196)), ("Bucket", "Stick", "Bucket", (168, 214), (130, 310), (112, 352)), ("Stick", "Boom", "Stick", (356, 116), (248, 106), (206, 118))):
        s.limb(f"{name}Cylinder_Rod", end, b, c, (13, 13), "#d7dde1")
        s.limb(f"{name}Cylinder", on, a, b, (26, 24), dark)
    for n in range(3):
        s.polygon(f"Tooth_{n + 1}", "Bucket", [(184 - 30 * n, 424 + 7 * n), (160 - 30 * n, 430 + 7 * n), (180 - 30 * n, 464 + 7 * n)], grey)
    s.blob("Bucket", "Stick", [(150, 332), (108, 326), (76, 360), (70, 412), (92, 448), (140, 446), (190, 432), (176, 390), (168, 352)], grey)
    s.limb("Stick", "Boom", (214, 142), (152, 346), (50, 34), shade)
    s.tail("Boom", "House", [(462, 326), (412, 216), (350, 150), (216, 152)], [44, 62, 58, 40], yellow)
    for name, at in (("Boom", (462, 320)), ("Stick", (220, 152))):
        s.circle(f"{name}_Pin", name, at, 9, dark)
    s.rides |= {"Window", "Tooth_1", "Tooth_2", "Tooth_3", "Boom_Pin", "Stick_Pin"}
    return s


def griffin() -> Sheet:
    """A griffin from the side that looks to the right, with raised wings; in groups."""
    s, hide, far, plume, dark, beak = Sheet(760, 620), "#c99a52", "#a67c3e", "#f0e4cc", "#7a5230", "#e0a52f"
    s.group("WingBack")
    s.blob("FeathersFar", "WingFar", [(376, 128), (440, 90), (520, 50), (500, 120), (470, 190), (436, 240), (400, 220)], "#5f3f26")
    s.blob("WingFar", "Body", [(400, 300), (374, 220), (366, 130), (404, 104), (436, 160), (446, 240), (444, 310)], far)
    for depth, x, back, colour in (("Far", 502, 280, far), ("Near", 458, 236, hide)):
        if depth == "Near":
            s.group("Trunk")
            s.tail("Tail", "Body", [(204, 340), (130, 356), (72, 290), (58, 220), (92, 150)], [30, 24, 21, 17, 12], hide)
            s.blob("TailTuft", "Tail", [(80, 164), (106, 162), (126, 116), (108, 78), (78, 112)], dark)
            s.blob("Body", None, [(184, 340), (240, 292), (340, 296), (440, 276), (500, 310), (502, 380), (440, 424), (330, 414), (236, 430), (188, 396)], hide)
        s.group(f"Legs{depth}")
        s.blob(f"FrontTalon{depth}", f"FrontShin{depth}", [(x - 24, 556), (x - 4, 546), (x + 16, 554), (x + 50, 562), (x + 56, 580), (x + 20, 574), (x - 10, 584), (x - 36, 580)], beak)
        s.limb(f"FrontShin{depth}", f"FrontThigh{depth}", (x + 6, 466), (x, 560), (30, 20), beak)
        s.limb(f"FrontThigh{depth}", "Body", (x - 6, 366), (x + 6, 468), (76, 42), plume if depth == "Near" else "#cdbf9f")
        s.ellipse(f"BackPaw{depth}", f"BackFoot{depth}", (back + 8, 572), 34, 15, colour)
        _limbs(s, "Body", f"BackThigh{depth}, BackShin{depth}, BackFoot{depth}", [(back, 372), (back + 28, 454), (back - 26, 508), (back - 6, 566)], (94, 52, 34, 28), colour)
    s.group("HeadGroup")
    s.blob("Neck", "Body", [(500, 190), (556, 200), (580, 250), (556, 330), (520, 400), (456, 396), (426, 330), (452, 250)], plume)
    s.blob("BeakLower", "Head", [(592, 200), (630, 202), (644, 216), (622, 228), (590, 220)], "#b9832a")
    s.blob("Head", "Neck", [(484, 200), (500, 144), (556, 118), (606, 138), (622, 178), (604, 214), (556, 236), (504, 240)], plume)
    s.blob("BeakUpper", "Head", [(598, 146), (640, 156), (668, 192), (664, 232), (644, 206), (596, 204)], beak)
    s.eye("eye", "Head", (574, 166), 12, (0.3, 0.0), "#f6d765")
    s.blob("Ear", "Head", [(502, 152), (492, 84), (522, 100), (540, 142)], plume)
    s.group("WingFront")
    s.blob("FeathersOuter", "WingOuter", [(276, 96), (222, 50), (134, 40), (160, 92), (176, 132), (206, 180), (262, 220), (306, 190)], dark)
    s.blob("FeathersInner", "WingInner", [(330, 200), (270, 170), (216, 180), (250, 240), (292, 296), (352, 330)], dark)
    s.blob("WingOuter", "WingInner", [(310, 216), (272, 158), (236, 78), (268, 52), (316, 94), (360, 190)], hide)
    s.blob("WingInner", "Body", [(366, 352), (318, 276), (300, 196), (338, 158), (386, 210), (424, 300), (412, 348)], hide)
    return s
