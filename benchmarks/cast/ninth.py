"""Ten characters drawn without knowledge of the rules, for a test on drawings that nothing was fitted to."""
# ruff: noqa: E501
# fmt: off

from __future__ import annotations

from .eighth import _limbs
from .sheet import INK, Sheet


def firefighter() -> Sheet:
    """A firefighter from the front, with an axe and an air tank; in groups."""
    s, coat, stripe, skin, black, red = Sheet(480, 720), "#46506a", "#e8d44d", "#e0a67e", "#26262c", "#c8372d"
    s.group("Back")
    s.polygon("Axe", "Left Hand", [(366, 420), (380, 190), (340, 196), (330, 146), (384, 150), (386, 126), (400, 128), (398, 152), (438, 166), (396, 188), (380, 420)], "#b9483c")
    s.box("Air Tank", "Jacket", (298, 284), 58, 150, "#d9b43a", 24)
    s.group("Legs")
    for word, k in (("Left", 1), ("Right", -1)):
        x = 240 + 40 * k
        s.blob(f"{word} Boot", f"{word} Lower Leg", [(x - 22 * k, 620), (x + 36 * k, 620), (x + 40 * k, 660), (x + 62 * k, 684), (x + 56 * k, 698), (x - 24 * k, 698)], black)
        _limbs(s, "Hips", f"{word} Upper Leg, {word} Lower Leg", [(x, 460), (x + 6 * k, 556), (x + 8 * k, 640)], (82, 66, 56), coat)
        s.polygon(f"{word} Leg Stripe", f"{word} Lower Leg", [(x + 7 * k - 29, 606), (x + 7 * k + 29, 606), (x + 7 * k + 28, 624), (x + 7 * k - 28, 624)], stripe)
    s.group("Body")
    s.limb("Neck", "Jacket", (240, 262), (240, 214), (44, 40), skin)
    s.blob("Hips", None, [(170, 420), (240, 410), (310, 420), (322, 476), (240, 500), (158, 476)], coat)
    s.blob("Jacket", "Hips", [(160, 280), (196, 248), (240, 256), (284, 248), (320, 280), (316, 360), (322, 446), (240, 456), (158, 446), (164, 360)], coat)
    s.tail("Jacket Stripe", "Jacket", [(164, 396), (240, 404), (316, 396)], [18, 18, 18], stripe)
    for word, joints in (("Right", [(176, 286), (132, 364), (118, 436)]), ("Left", [(304, 286), (356, 366), (378, 288)])):
        s.group(f"{word} Arm")
        _limbs(s, "Jacket", f"{word} Upper Arm, {word} Forearm, {word} Hand", joints, (60, 50, 42), coat, black)
    s.group("Head")
    s.blob("Face", "Neck", [(184, 156), (200, 110), (240, 98), (280, 110), (296, 156), (284, 206), (240, 236), (196, 206)], skin)
    for word, k in (("Left", 1), ("Right", -1)):
        s.eye(f"{word} eye", "Face", (240 + 24 * k, 160), 10)
    s.blob("Helmet", "Face", [(152, 146), (182, 96), (202, 60), (240, 46), (278, 60), (298, 96), (328, 146), (282, 132), (240, 126), (198, 132)], red)
    s.rides |= {"Left Leg Stripe", "Right Leg Stripe", "Jacket Stripe"}
    return s


def detective() -> Sheet:
    """A detective in a trench coat from three quarters who turns to the right, with a magnifying glass."""
    s, coat, far, skin, grey, hat = Sheet(540, 700), "#c2a06a", "#a1834f", "#eabf9b", "#4d4f5c", "#6d5a43"
    s.blob("coat_back", "pelvis", [(190, 420), (260, 410), (330, 420), (352, 560), (330, 600), (256, 610), (176, 600), (168, 540)], "#80673c")
    s.limb("magnifier", "hand.L", (440, 352), (470, 262), (13, 13), "#5a3a24")
    s.circle("lens", "magnifier", (482, 222), 38, "#cfe8ee")
    _limbs(s, "chest", "upper_arm.L, forearm.L, hand.L", [(316, 292), (372, 374), (440, 326)], (48, 40, 30), far, skin)
    for side, x in (("L", 298), ("R", 232)):
        s.blob(f"foot.{side}", f"shin.{side}", [(x - 22, 616), (x + 20, 616), (x + 30, 640), (x + 64, 652), (x + 62, 668), (x - 24, 668)], "#2e2522")
        _limbs(s, "pelvis", f"thigh.{side}, shin.{side}", [(x, 440), (x + 5, 536), (x, 630)], (62, 48, 40), grey)
    s.blob("pelvis", None, [(200, 400), (264, 394), (328, 400), (336, 450), (264, 474), (194, 450)], grey)
    s.blob("coat_front.L", "pelvis", [(274, 406), (328, 402), (348, 480), (356, 570), (304, 586), (286, 500)], far)
    s.blob("coat_front.R", "pelvis", [(192, 404), (276, 408), (280, 500), (254, 592), (172, 580), (180, 480)], coat)
    s.limb("neck", "chest", (256, 264), (262, 214), (40, 38), skin)
    s.blob("chest", "pelvis", [(186, 284), (224, 252), (264, 262), (300, 250), (334, 282), (336, 350), (328, 424), (262, 432), (196, 424), (186, 350)], coat)
    s.tail("belt", "pelvis", [(190, 414), (262, 424), (332, 412)], [24, 24, 24], hat)
    s.blob("collar", "chest", [(198, 276), (220, 234), (264, 272), (304, 232), (324, 268), (294, 300), (266, 330), (232, 304)], far)
    _limbs(s, "chest", "upper_arm.R, forearm.R, hand.R", [(206, 300), (154, 384), (178, 456)], (56, 46, 36), coat, skin)
    s.blob("head", "neck", [(212, 164), (226, 122), (276, 112), (314, 138), (318, 180), (304, 222), (262, 240), (222, 210)], skin)
    s.eye("eye.R", "head", (270, 170), 9, (0.3, 0.0))
    s.eye("eye.L", "head", (304, 168), 7, (0.3, 0.0))
    s.blob("nose", "head", [(290, 172), (304, 180), (326, 196), (318, 206), (292, 202)], skin)
    s.blob("hat_crown", "head", [(212, 128), (220, 72), (262, 64), (306, 68), (320, 120), (266, 138)], hat)
    s.blob("hat_brim", "hat_crown", [(172, 148), (216, 124), (264, 134), (320, 116), (366, 130), (322, 144), (264, 156), (212, 154)], hat)
    s.rides |= {"lens", "belt", "collar", "nose", "hat_brim"}
    return s


def boxer() -> Sheet:
    """A boxer from the side in guard, who looks to the right."""
    s, skin, far, shorts, glove, boot = Sheet(560, 700), "#a86b45", "#875334", "#2f5fa8", "#c8332f", "#efeae0"
    s.blob("LeftGlove", "LeftForeArm", [(448, 226), (450, 184), (484, 160), (520, 182), (520, 226), (488, 250)], "#9d2926")
    _limbs(s, "Chest", "LeftArm, LeftForeArm", [(320, 262), (404, 308), (470, 234)], (52, 42, 32), far)
    s.blob("LeftFoot", "LeftLeg", [(332, 584), (376, 584), (384, 622), (424, 642), (422, 658), (332, 658)], "#c9c3b6")
    _limbs(s, "Hips", "LeftUpLeg, LeftLeg", [(290, 410), (356, 500), (354, 608)], (70, 56, 36), far)
    s.limb("LeftShorts", "LeftUpLeg", (288, 408), (332, 468), (86, 78), "#244a84")
    s.limb("Neck", "Chest", (298, 240), (324, 186), (54, 46), skin)
    s.blob("Spine", "Hips", [(226, 310), (280, 300), (330, 312), (328, 380), (270, 400), (218, 386)], skin)
    s.blob("Hips", None, [(208, 378), (260, 368), (322, 374), (334, 420), (292, 448), (230, 448), (202, 424)], shorts)
    s.tail("Waistband", "Hips", [(208, 378), (264, 374), (324, 376)], [22, 22, 22], boot)
    s.blob("Chest", "Spine", [(222, 262), (248, 224), (310, 212), (350, 240), (354, 300), (326, 338), (260, 342), (222, 318)], skin)
    s.blob("Head", "Neck", [(288, 146), (300, 100), (344, 86), (380, 104), (384, 128), (402, 154), (386, 162), (382, 194), (346, 208), (308, 192)], skin)
    s.eye("Reye", "Head", (364, 132), 8, (0.3, 0.0))
    s.blob("Hair", "Head", [(284, 140), (288, 92), (338, 70), (384, 92), (382, 106), (340, 106), (322, 128), (304, 136)], "#211712")
    s.blob("RightFoot", "RightLeg", [(144, 594), (186, 598), (198, 634), (232, 646), (230, 660), (140, 660)], boot)
    _limbs(s, "Hips", "RightUpLeg, RightLeg", [(250, 412), (234, 520), (170, 616)], (80, 62, 38), skin)
    s.limb("RightShorts", "RightUpLeg", (252, 410), (242, 484), (94, 88), shorts)
    s.blob("RightGlove", "RightForeArm", [(360, 298), (360, 254), (396, 226), (434, 248), (436, 294), (402, 322)], glove)
    _limbs(s, "Chest", "RightArm, RightForeArm", [(258, 264), (296, 362), (380, 300)], (64, 49, 36), skin)
    s.rides |= {"LeftShorts", "Waistband", "Hair", "RightShorts"}
    return s


def violinist() -> Sheet:
    """A violinist in a long gown from three quarters who turns to the left; in groups."""
    s, skin, gown, deep, hair, wood = Sheet(520, 700), "#edc09d", "#7d2f55", "#5f2141", "#2e211e", "#a8592a"
    s.group("right arm")
    s.limb("r_upperarm", "bodice", (216, 288), (120, 312), (36, 30), "#d6a783")
    s.group("legs")
    for side, x in (("r", 238), ("l", 290)):
        s.blob(f"{side}_shoe", f"{side}_shin", [(x + 16, 634), (x + 18, 664), (x - 48, 668), (x - 46, 656), (x - 14, 632)], INK)
        _limbs(s, "gown_skirt", f"{side}_thigh, {side}_shin", [(x, 440), (x + 4, 540), (x, 642)], (54, 40, 26), skin)
    s.group("gown")
    s.limb("neck", "bodice", (258, 272), (250, 214), (34, 32), skin)
    s.blob("gown_lower", "gown_skirt", [(196, 486), (262, 500), (334, 486), (354, 560), (368, 626), (262, 642), (160, 626), (176, 560)], deep)
    s.blob("gown_skirt", None, [(212, 388), (262, 382), (318, 388), (340, 470), (338, 512), (262, 526), (190, 512), (192, 470)], gown)
    s.blob("bodice", "gown_skirt", [(206, 284), (230, 262), (260, 276), (292, 260), (324, 286), (316, 340), (318, 398), (264, 408), (214, 398), (216, 340)], gown)
    s.tail("sash", "gown_skirt", [(212, 392), (264, 402), (320, 390)], [18, 18, 18], "#d8b25a")
    s.group("left arm and violin")
    _limbs(s, "bodice", "l_upperarm, l_forearm", [(306, 290), (280, 384), (172, 324)], (42, 34, 24), skin)
    s.tail("violin", "l_hand", [(300, 252), (286, 257), (255, 269), (225, 280), (211, 285)], [20, 64, 42, 56, 20], wood)
    s.limb("violin_neck", "violin", (232, 278), (141, 312), (12, 9), INK)
    s.circle("l_hand", "l_forearm", (162, 314), 17, skin)
    s.group("head")
    s.circle("hair_bun", "face", (318, 108), 30, hair)
    s.blob("face", "neck", [(196, 160), (208, 116), (256, 104), (294, 134), (296, 184), (270, 224), (224, 228), (202, 200)], skin)
    s.eye("r_eye", "face", (216, 162), 7, (-0.3, 0.2))
    s.eye("l_eye", "face", (248, 162), 9, (-0.3, 0.2))
    s.blob("hair_front", "face", [(194, 146), (206, 98), (256, 82), (304, 112), (308, 164), (292, 190), (280, 150), (244, 122), (214, 128)], hair)
    s.group("bow")
    s.polygon("bow", "r_hand", [(112, 392), (314, 206), (320, 212), (122, 402)], "#6b3d1e")
    s.circle("r_hand", "r_forearm", (124, 398), 16, skin)
    s.limb("r_forearm", "r_upperarm", (120, 312), (124, 384), (30, 22), "#d6a783")
    s.rides |= {"sash", "violin_neck", "hair_front"}
    return s


def wolf() -> Sheet:
    """A wolf from the side that looks to the left; in groups."""
    s, fur, far, light, dark = Sheet(760, 490), "#868b95", "#666b76", "#c9ccd1", "#4c505a"
    for depth, front, back, colour in (("far", 290, 536, far), ("near", 342, 586, fur)):
        if depth == "near":
            s.group("body")
            s.tail("tail tip", "tail base", [(656, 268), (690, 330), (702, 400)], [46, 44, 8], dark)
            s.tail("tail base", "hips", [(584, 204), (634, 230), (672, 306)], [36, 52, 46], fur)
            s.blob("hips", None, [(472, 190), (550, 164), (616, 188), (630, 246), (590, 300), (510, 306), (466, 260)], fur)
            s.blob("ribcage", "hips", [(266, 206), (320, 162), (420, 166), (510, 176), (530, 236), (500, 280), (400, 312), (320, 318), (262, 284)], fur)
        s.group("near legs" if depth == "near" else "shaded side")
        s.ellipse(f"back paw {depth}", f"back foot {depth}", (back - 10, 446), 30, 15, colour)
        _limbs(s, "hips", f"back leg upper {depth}, back leg lower {depth}, back foot {depth}", [(back - 20, 236), (back - 30, 326), (back + 22, 380), (back, 440)], (100, 52, 34, 28), colour)
        s.ellipse(f"front paw {depth}", f"front leg lower {depth}", (front - 14, 446), 28, 15, colour)
        _limbs(s, "ribcage", f"front leg upper {depth}, front leg lower {depth}", [(front, 260), (front + 8, 350), (front - 2, 438)], (74, 40, 27), colour)
    s.group("head")
    s.blob("ear far", "skull", [(172, 106), (166, 44), (194, 64), (212, 104)], far)
    s.blob("neck ruff", "ribcage", [(196, 104), (250, 96), (330, 150), (372, 216), (336, 290), (262, 286), (206, 226), (176, 170)], light)
    s.blob("lower jaw", "skull", [(92, 182), (150, 178), (204, 168), (216, 190), (180, 208), (128, 202), (98, 196)], fur)
    s.blob("skull", "neck ruff", [(64, 146), (106, 130), (150, 114), (180, 84), (226, 84), (254, 120), (248, 170), (206, 190), (140, 178), (80, 172)], fur)
    s.ellipse("nose", "skull", (74, 148), 15, 12, INK)
    s.eye("eye", "skull", (166, 124), 10, (-0.2, 0.0), "#f1cf62")
    s.blob("ear near", "skull", [(196, 98), (208, 32), (236, 60), (246, 110)], dark)
    s.rides.add("nose")
    return s


def rhinoceros() -> Sheet:
    """A rhinoceros from the side that looks to the right."""
    s, hide, far, plate, horn = Sheet(820, 510), "#9a9792", "#787570", "#aaa7a1", "#d8cfb8"
    s.blob("tail_tip", "tail", [(70, 318), (88, 316), (94, 350), (78, 372), (62, 348)], INK)
    s.tail("tail", "body", [(136, 206), (92, 250), (80, 328)], [24, 15, 11], hide)
    for numbers, dx, colour in (((4, 3), 54, far), ((2, 1), 0, hide)):
        if not dx:
            s.blob("body", None, [(108, 250), (150, 170), (260, 140), (380, 160), (480, 126), (560, 160), (590, 240), (560, 320), (440, 350), (280, 358), (160, 340)], hide)
            s.blob("hip_plate", "body", [(134, 204), (190, 160), (264, 160), (288, 230), (262, 300), (190, 330), (136, 300)], plate)
            s.blob("shoulder_plate", "body", [(408, 166), (470, 138), (536, 166), (556, 240), (524, 310), (450, 316), (418, 240)], plate)
        for n, x in zip(numbers, (190 + dx, 484 + dx), strict=True):
            s.ellipse(f"foot{n}", f"leg{n}_low", (x + 4, 462 - 0.2 * dx), 38, 20, colour)
            _limbs(s, "body", f"leg{n}, leg{n}_low", [(x, 290), (x + 4, 384 - 0.2 * dx), (x, 452 - 0.2 * dx)], (100, 70, 58), colour)
    s.blob("ear2", "head", [(602, 206), (616, 138), (640, 148), (640, 204)], far)
    s.blob("neck", "body", [(506, 150), (580, 156), (644, 210), (648, 296), (590, 336), (520, 316), (490, 230)], hide)
    s.blob("jaw", "head", [(600, 300), (680, 326), (724, 336), (722, 362), (664, 372), (604, 344)], far)
    s.blob("horn2", "head", [(656, 240), (696, 266), (708, 214), (706, 186), (676, 206)], horn)
    s.blob("horn1", "head", [(704, 290), (752, 316), (780, 246), (788, 176), (748, 220)], horn)
    s.blob("head", "neck", [(566, 214), (606, 180), (660, 220), (720, 270), (754, 310), (736, 348), (680, 346), (620, 328), (576, 290)], hide)
    s.eye("eye", "head", (650, 254), 9, (0.2, 0.0))
    s.blob("ear1", "head", [(580, 216), (572, 142), (600, 150), (618, 202)], hide)
    s.rides |= {"hip_plate", "shoulder_plate"}
    return s


def eagle() -> Sheet:
    """An eagle from the front with spread wings, its head turned to the right."""
    s, brown, dark, deep, white, yellow = Sheet(960, 620), "#7a5233", "#5e3d25", "#4a2f1d", "#f4efe2", "#e9ab2e"
    for n in (1, 3, 2):
        s.tail(f"TailFeather_{n}", "TailBase", [(458 + 11 * n, 446), (404 + 38 * n, 520), (350 + 65 * n, 596)], [34, 50, 26], white)
    s.blob("TailBase", "Torso", [(446, 416), (480, 404), (514, 416), (522, 468), (480, 488), (438, 468)], brown)
    for side, k in (("L", 1), ("R", -1)):
        s.blob(f"Primaries{side}", f"Wing{side}_03", [(480 + k * dx, y) for dx, y in ((280, 160), (340, 130), (436, 174), (462, 236), (424, 226), (440, 290), (396, 258), (400, 330), (350, 280), (346, 340), (300, 270))], deep)
        s.blob(f"Secondaries{side}", f"Wing{side}_02", [(480 + k * dx, y) for dx, y in ((110, 230), (220, 170), (310, 180), (324, 250), (312, 330), (262, 300), (244, 356), (194, 316), (172, 366), (120, 320))], dark)
        s.tail(f"Wing{side}_03", f"Wing{side}_02", [(480 + 280 * k, 166), (480 + 340 * k, 154), (480 + 410 * k, 196)], [56, 50, 14], brown)
        _limbs(s, "Torso", f"Wing{side}_01, Wing{side}_02", [(480 + 46 * k, 286), (480 + 172 * k, 226), (480 + 292 * k, 168)], (96, 72, 58), brown)
    s.blob("Torso", None, [(416, 270), (450, 236), (510, 236), (544, 270), (550, 350), (522, 430), (480, 456), (438, 430), (410, 350)], brown)
    s.ellipse("BreastFeathers", "Torso", (480, 340), 42, 66, "#94683f")
    for side, k in (("L", 1), ("R", -1)):
        x = 480 + 52 * k
        s.blob(f"Talon{side}", f"Shank{side}", [(x - 20, 506), (x, 496), (x + 20, 506), (x + 34, 546), (x + 12, 532), (x, 554), (x - 12, 532), (x - 34, 546)], yellow)
        s.limb(f"Shank{side}", f"Thigh{side}", (480 + 50 * k, 452), (x, 510), (22, 18), yellow)
        s.limb(f"Thigh{side}", "Torso", (480 + 34 * k, 394), (480 + 50 * k, 456), (66, 40), dark)
    s.blob("Neck", "Torso", [(432, 272), (448, 206), (512, 206), (528, 272), (504, 300), (480, 288), (456, 302)], white)
    s.blob("BeakLower", "Head", [(520, 194), (556, 200), (562, 212), (540, 220), (516, 214)], "#c98d1f")
    s.blob("Head", "Neck", [(438, 190), (452, 142), (500, 128), (538, 156), (540, 194), (510, 226), (460, 232)], white)
    s.blob("BeakUpper", "Head", [(530, 156), (568, 164), (592, 200), (582, 234), (566, 208), (528, 202)], yellow)
    s.eye("eye", "Head", (508, 174), 10, (0.2, 0.0), "#f2d45a")
    s.rides.add("BreastFeathers")
    return s


def koala() -> Sheet:
    """A koala from the front that sits and holds a branch; in groups."""
    s, fur, dark, light, bark, green = Sheet(520, 620), "#9aa0a8", "#7b8189", "#e6e4e0", "#7d5a3a", "#7fa35c"
    sides = (("left", 1), ("right", -1))
    s.group("Ears")
    for side, k in sides:
        s.circle(f"{side}Ear", "head", (260 + 122 * k, 118), 62, fur)
        s.circle(f"{side}EarInner", f"{side}Ear", (260 + 126 * k, 122), 38, "#e0b7b4")
    s.group("Body")
    s.blob("hips", None, [(168, 460), (260, 430), (352, 460), (368, 530), (320, 574), (200, 574), (152, 530)], fur)
    s.blob("torso", "hips", [(182, 330), (210, 280), (310, 280), (338, 330), (366, 430), (340, 500), (260, 518), (180, 500), (154, 430)], fur)
    s.blob("chestFluff", "torso", [(206, 310), (260, 296), (314, 310), (308, 390), (260, 430), (212, 390)], light)
    s.group("Legs")
    for side, k in sides:
        s.ellipse(f"{side}Thigh", "hips", (260 + 94 * k, 516), 62, 48, fur, turn=20 * k)
        s.ellipse(f"{side}Foot", f"{side}Thigh", (260 + 126 * k, 560), 48, 32, dark)
    s.group("Arms")
    for side, k in sides:
        s.limb(f"{side}UpperArm", "torso", (260 + 86 * k, 332), (260 + 134 * k, 416), (68, 56), fur)
        if side == "right":
            for n, (x, y, turn) in enumerate(((96, 326, -20), (144, 322, 50), (94, 376, -70))):
                s.ellipse(f"leaf{n + 1}", "branch", (x, y), 13, 42, green, turn=turn)
            s.tail("branch", "rightPaw", [(108, 346), (150, 400), (206, 452), (244, 540)], [10, 13, 15, 17], bark)
        s.circle(f"{side}Paw", f"{side}Forearm", (260 + (62 if k > 0 else 52) * k, 452), 29, dark)
        s.limb(f"{side}Forearm", f"{side}UpperArm", (260 + 134 * k, 416), (260 + 76 * k, 448), (56, 46), fur)
    s.group("Face")
    s.blob("head", "torso", [(138, 200), (160, 128), (260, 94), (360, 128), (382, 200), (350, 270), (260, 298), (170, 270)], fur)
    for side, k in (("Left", 1), ("Right", -1)):
        s.eye(f"eye{side}", "head", (260 + 66 * k, 180), 13)
    s.ellipse("nose", "head", (260, 212), 29, 42, "#3a3a42")
    s.rides |= {"leftEarInner", "rightEarInner", "chestFluff", "nose"}
    return s


def fairy() -> Sheet:
    """A fairy in flight from three quarters who turns to the left, with a wand; in groups."""
    s, skin, far, petal, hair, wing = Sheet(640, 660), "#f1c8a6", "#d9ab88", "#d972a0", "#e3a23c", "#cfeadf"
    s.group("Wings")
    s.blob("Wing_Lower_Far", "Torso", [(300, 290), (400, 256), (510, 250), (530, 290), (440, 320), (340, 316)], "#a8cfc4")
    s.blob("Wing_Upper_Far", "Torso", [(290, 276), (330, 150), (390, 50), (450, 30), (466, 100), (420, 200), (340, 290)], "#b4d8cc")
    s.blob("Wing_Lower_Near", "Torso", [(304, 296), (420, 290), (520, 320), (540, 380), (470, 400), (370, 346)], "#bfe0d4")
    s.blob("Wing_Upper_Near", "Torso", [(300, 284), (380, 170), (480, 90), (570, 90), (566, 170), (470, 260), (350, 312)], wing)
    s.blob("Hair_Back", "Head", [(250, 96), (310, 84), (358, 130), (376, 210), (356, 256), (316, 226), (270, 150)], hair)
    s.group("Limbs")
    _limbs(s, "Torso", "Arm_Far, Forearm_Far, Hand_Far", [(268, 268), (200, 322), (148, 376)], (28, 23, 17), far)
    for depth, joints, foot, colour in (("Far", [(318, 374), (322, 476), (404, 534)], [(398, 530), (436, 552), (470, 586)], far), ("Near", [(348, 374), (396, 472), (474, 548)], [(468, 544), (504, 570), (534, 610)], skin)):
        s.tail(f"Foot_{depth}", f"Calf_{depth}", foot, [24, 24, 8], "#8db65a")
        _limbs(s, "Pelvis", f"Thigh_{depth}, Calf_{depth}", joints, (50, 35, 24), colour)
    s.group("Dress")
    s.blob("Pelvis", None, [(282, 340), (330, 326), (374, 346), (384, 390), (336, 410), (290, 390)], petal)
    for n, points in enumerate(([(340, 346), (376, 348), (420, 404), (418, 446), (370, 430)], [(280, 348), (314, 348), (308, 424), (276, 452), (262, 416)], [(302, 348), (352, 348), (358, 424), (334, 468), (304, 426)])):
        s.blob(f"Petal_{n + 1}", "Pelvis", points, "#c45a8c" if n < 2 else petal)
    s.limb("Neck", "Torso", (290, 262), (276, 212), (28, 27), skin)
    s.blob("Torso", "Pelvis", [(256, 268), (280, 246), (318, 248), (336, 276), (352, 346), (322, 370), (286, 360), (272, 310)], "#8db65a")
    s.group("Head")
    s.blob("Head", "Neck", [(222, 160), (234, 114), (284, 100), (322, 130), (324, 180), (296, 218), (248, 224), (226, 196)], skin)
    s.eye("eye_Far", "Head", (240, 162), 8, (-0.2, 0.0))
    s.eye("eye_Near", "Head", (272, 162), 11, (-0.2, 0.0))
    s.blob("Ear", "Head", [(308, 158), (356, 122), (352, 168), (316, 188)], skin)
    s.blob("Hair_Front", "Head", [(214, 152), (230, 96), (290, 80), (338, 116), (334, 160), (308, 144), (270, 126), (240, 132)], hair)
    s.group("Arm and wand")
    s.polygon("Star", "Wand", [(104, 128), (114, 158), (146, 160), (120, 180), (130, 212), (104, 192), (78, 212), (88, 180), (62, 160), (94, 158)], "#f3d24c")
    s.limb("Wand", "Hand_Near", (152, 334), (108, 190), (9, 7), "#7a5637")
    _limbs(s, "Torso", "Arm_Near, Forearm_Near, Hand_Near", [(308, 270), (236, 346), (152, 304)], (34, 27, 19), skin)
    s.rides.add("Hair_Front")
    return s


def minotaur() -> Sheet:
    """A minotaur from the front, with a great axe."""
    s, fur, dark, skin, horn, iron = Sheet(640, 760), "#6b4630", "#52341f", "#b07a52", "#e8dcc0", "#9aa2aa"
    s.tail("tail", "pelvis", [(360, 440), (436, 500), (462, 580), (440, 640)], [26, 20, 16, 26], dark)
    for side, k in (("lf", 1), ("rt", -1)):
        x = 320 + 58 * k
        s.polygon(f"{side}_hoof", f"{side}_cannon", [(x + 18 * k - 26, 690), (x + 18 * k + 26, 690), (x + 18 * k + 36, 730), (x + 18 * k - 36, 730)], INK)
        _limbs(s, "pelvis", f"{side}_thigh, {side}_shin, {side}_cannon", [(x, 460), (x + 28 * k, 552), (x + 6 * k, 630), (x + 18 * k, 694)], (108, 70, 44, 40), fur)
    s.blob("pelvis", None, [(246, 424), (320, 410), (394, 424), (410, 480), (320, 512), (230, 480)], fur)
    s.blob("abs", "pelvis", [(250, 330), (320, 320), (390, 330), (386, 436), (320, 450), (254, 436)], skin)
    s.blob("loincloth", "pelvis", [(256, 430), (320, 440), (384, 430), (376, 540), (320, 580), (264, 540)], "#8b2f2b")
    s.blob("chest", "abs", [(196, 240), (250, 206), (320, 214), (390, 206), (444, 240), (440, 320), (390, 366), (320, 352), (250, 366), (200, 320)], skin)
    s.limb("axe_handle", "rt_fist", (118, 660), (84, 230), (18, 18), "#7a5230")
    s.blob("axe_head", "axe_handle", [(84, 236), (50, 250), (16, 200), (16, 310), (60, 290), (90, 300), (124, 282), (166, 300), (158, 190), (118, 242)], iron)
    for side, joints in (("rt", [(206, 258), (134, 350), (106, 440)]), ("lf", [(434, 258), (506, 350), (520, 444)])):
        _limbs(s, "chest", f"{side}_bicep, {side}_forearm, {side}_fist", joints, (92, 70, 50), skin)
    s.blob("neck", "chest", [(226, 240), (252, 150), (320, 116), (388, 150), (414, 240), (364, 262), (320, 290), (276, 262)], dark)
    s.blob("head", "neck", [(254, 130), (276, 84), (320, 72), (364, 84), (386, 130), (372, 190), (352, 232), (320, 242), (288, 232), (268, 190)], fur)
    for side, k in (("lf", 1), ("rt", -1)):
        s.tail(f"{side}_horn", "head", [(320 + 40 * k, 96), (320 + 112 * k, 84), (320 + 136 * k, 20)], [36, 30, 5], horn)
        s.blob(f"{side}_ear", "head", [(320 + 54 * k, 126), (320 + 104 * k, 116), (320 + 128 * k, 142), (320 + 62 * k, 152)], fur)
        s.ellipse(f"{side}_eye", "head", (320 + 32 * k, 146), 10, 7, "#f0c040", turn=18 * k)
    s.ellipse("muzzle", "head", (320, 218), 54, 38, "#a98468")
    s.line("nose_ring", "muzzle", [(306, 224), (302, 250), (320, 264), (338, 250), (334, 224)], 6, "#d9b23c")
    s.rides |= {"lf_eye", "rt_eye", "muzzle"}
    return s
