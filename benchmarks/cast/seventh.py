"""Ten characters drawn after the sixth ten had been measured, without knowledge of the rules; measured once."""
# ruff: noqa: E501
# fmt: off

from __future__ import annotations

from .sheet import INK, Point, Sheet


def _limbs(s: Sheet, on: str, names: str, joints: list[Point], widths: tuple[float, ...], fill: str, tip: str = "") -> None:
    """Limbs from joint to joint, the upper over the lower; a name more than there are limbs is a hand, over both."""
    parts, last = names.split(", "), len(joints) - 1
    for n in reversed(range(last)):
        s.limb(parts[n], parts[n - 1] if n else on, joints[n], joints[n + 1], (widths[n], widths[n + 1]), fill)
    for name in parts[last:]:
        s.circle(name, parts[last - 1], joints[last], 0.62 * widths[last], tip or fill)


def cowboy() -> Sheet:
    """A cowboy from the front, with a vest, a holster and a lasso; names in words with capitals."""
    s, skin, jeans, shirt, leather = Sheet(480, 680), "#e3b08a", "#4a6488", "#c7b48c", "#7d4f2f"
    s.line("Lasso", "Right Hand", [(122, 430), (84, 470), (96, 524), (134, 528), (152, 484), (128, 436)], 9, "#cda766")
    s.blob("Hips", None, [(186, 370), (240, 362), (294, 370), (302, 416), (240, 440), (178, 416)], jeans)
    s.box("Neck", "Chest", (240, 226), 40, 46, skin)
    s.blob("Chest", "Hips", [(174, 256), (212, 238), (268, 238), (306, 256), (300, 330), (292, 384), (188, 384), (180, 330)], shirt)
    s.ellipse("Head", "Neck", (240, 168), 50, 58, skin)
    for side, k in (("Left", 1), ("Right", -1)):
        _limbs(s, "Hips", f"{side} Thigh, {side} Calf", [(240 + 30 * k, 404), (240 + 42 * k, 494), (240 + 44 * k, 584)], (60, 48, 38), jeans)
        s.blob(f"{side} Boot", f"{side} Calf", [(240 + 24 * k, 556), (240 + 66 * k, 556), (240 + 70 * k, 606), (240 + 92 * k, 630), (240 + 26 * k, 632)], leather)
        s.blob(f"{side} Vest", "Chest", [(240 + 22 * k, 240), (240 + 52 * k, 242), (240 + 62 * k, 300), (240 + 54 * k, 374), (240 + 20 * k, 370), (240 + 32 * k, 300)], leather)
        _limbs(s, "Chest", f"{side} Upper Arm, {side} Forearm, {side} Hand", [(240 + 66 * k, 268), (240 + 94 * k, 344), (240 + 114 * k, 424)], (46, 38, 28), shirt, skin)
        s.eye(f"{side} eye", "Head", (240 + 20 * k, 166), 9)
    s.box("Belt", "Hips", (240, 382), 114, 20, "#4d3222")
    s.blob("Holster", "Belt", [(288, 382), (324, 388), (324, 450), (300, 458), (290, 430)], "#4d3222")
    s.blob("Bandana", "Neck", [(204, 222), (240, 230), (276, 222), (268, 246), (240, 280), (212, 246)], "#b93a32")
    s.blob("Mustache", "Head", [(206, 206), (240, 192), (274, 206), (240, 206)], "#5a3a22")
    s.blob("Hat", "Head", [(130, 122), (188, 136), (200, 70), (240, 80), (280, 70), (292, 136), (350, 122), (310, 156), (240, 146), (170, 156)], leather)
    s.rides |= {"Left Vest", "Right Vest", "Belt", "Mustache"}
    return s


def guitarist() -> Sheet:
    """A guitarist from three quarters who turns to the right; names as Blender has them."""
    s, skin, tee, dark, hair, wood = Sheet(520, 690), "#dba67e", "#b8494f", "#3f4357", "#6a4128", "#d39a4c"
    s.blob("hair_back", "head", [(204, 120), (256, 86), (306, 120), (306, 220), (282, 276), (216, 280), (194, 210)], hair)
    s.limb("upper_arm.L", "chest", (300, 268), (352, 352), (40, 32), "#98393f")
    for side, x, y, k in (("L", 276, 424, 1), ("R", 224, 438, -1)):
        _limbs(s, "pelvis", f"thigh.{side}, shin.{side}", [(x, y), (x + 14 * k, y + 92), (x + 22 * k, y + 182)], (58, 47, 37), dark)
        s.blob(f"shoe.{side}", f"shin.{side}", [(x + 20 * k - 20, y + 172), (x + 20 * k + 20, y + 172), (x + 20 * k + 60, y + 202), (x + 20 * k + 58, y + 216), (x + 20 * k - 22, y + 216)], "#ece7dd")
    s.blob("pelvis", None, [(194, 394), (250, 386), (304, 394), (308, 432), (252, 450), (192, 438)], dark)
    s.limb("neck", "chest", (254, 250), (260, 212), (38, 36), skin)
    s.blob("chest", "pelvis", [(188, 268), (220, 248), (284, 246), (314, 262), (306, 336), (304, 404), (194, 408), (190, 336)], tee)
    s.line("strap", "chest", [(210, 250), (250, 300), (294, 350)], 12, "#2f2a2a")
    s.limb("guitar_neck", "guitar", (296, 357), (424, 311), (18, 14), "#5b3a25")
    s.polygon("headstock", "guitar_neck", [(415, 304), (453, 286), (466, 309), (422, 322)], "#5b3a25")
    s.blob("guitar", "chest", [(151, 410), (153, 360), (188, 339), (236, 343), (271, 324), (308, 353), (299, 399), (259, 407), (224, 441), (184, 447)], wood)
    _limbs(s, "upper_arm.L", "forearm.L, hand.L", [(352, 352), (400, 316)], (32, 27), skin)
    _limbs(s, "chest", "upper_arm.R, forearm.R, hand.R", [(204, 276), (154, 362), (244, 376)], (46, 36, 27), tee, skin)
    s.blob("head", "neck", [(214, 150), (232, 108), (280, 106), (304, 142), (304, 158), (322, 178), (302, 190), (276, 226), (240, 218), (218, 190)], skin)
    s.blob("beard", "head", [(222, 186), (244, 204), (290, 196), (300, 192), (292, 222), (266, 246), (236, 226)], hair)
    s.eye("eye.R", "head", (258, 160), 9, (0.3, 0.0))
    s.eye("eye.L", "head", (290, 160), 7, (0.3, 0.0))
    s.blob("hair_front", "head", [(208, 170), (206, 120), (250, 84), (304, 110), (308, 140), (268, 122), (232, 134)], hair)
    s.rides.add("strap")
    return s


def skater() -> Sheet:
    """A girl on inline skates from the side, with a helmet and a knee pad, who speeds to the right."""
    s, skin, top, shorts, boot = Sheet(460, 610), "#c98d63", "#f0b13c", "#3f6fa0", "#d9556b"
    _limbs(s, "torso", "rear-upper-arm, rear-forearm, rear-hand", [(262, 240), (322, 282), (376, 240)], (34, 28, 22), "#b27b55")
    _limbs(s, "hips", "rear-thigh, rear-shin", [(222, 356), (170, 440), (92, 476)], (50, 36, 26), "#b27b55")
    for n in range(3):
        s.circle(f"rear-wheel-{n + 1}", "rear-skate", (34 + 11 * n, 476 + 30 * n), 14, "#e9e6dc")
        s.circle(f"front-wheel-{n + 1}", "front-skate", (272 + 30 * n, 570), 15, "#f6f3ea")
    s.blob("rear-skate", "rear-shin", [(112, 462), (104, 500), (86, 540), (66, 548), (44, 478), (76, 464)], "#b24357")
    s.blob("hips", None, [(196, 330), (234, 324), (268, 336), (262, 376), (226, 386), (194, 370)], shorts)
    s.limb("neck", "torso", (270, 230), (286, 198), (32, 30), skin)
    s.blob("torso", "hips", [(198, 336), (210, 280), (238, 222), (280, 216), (294, 244), (284, 300), (262, 350), (222, 354)], top)
    s.limb("front-shin", "front-thigh", (314, 416), (284, 512), (38, 30), skin)
    s.limb("front-thigh", "hips", (236, 360), (314, 416), (56, 42), shorts)
    s.blob("front-skate", "front-shin", [(262, 490), (304, 494), (312, 528), (348, 546), (348, 562), (260, 562)], boot)
    s.ellipse("front-knee-pad", "front-shin", (320, 424), 20, 24, "#2f3340")
    s.tail("ponytail", "head", [(254, 160), (210, 176), (180, 220)], [26, 28, 10], "#2c211f")
    s.blob("head", "neck", [(250, 150), (262, 112), (310, 106), (336, 142), (352, 166), (336, 184), (304, 212), (268, 202)], skin)
    s.eye("eye", "head", (318, 152), 8, (0.3, 0.0))
    s.blob("helmet", "head", [(242, 146), (250, 96), (300, 72), (348, 104), (350, 132), (290, 132)], boot)
    _limbs(s, "torso", "front-upper-arm, front-forearm, front-hand", [(256, 244), (202, 308), (134, 342)], (38, 30, 23), skin)
    s.rides.add("front-knee-pad")
    return s


def grandmother() -> Sheet:
    """An old woman from three quarters who turns to the left, with a shawl, a walking stick and a handbag."""
    s, skin, blouse, grey = Sheet(440, 640), "#efc8a8", "#8a6fa8", "#d4d3d6"
    for side, x in (("r", 190), ("l", 256)):
        s.limb(f"{side}_leg", "skirt", (x, 530), (x - 2, 584), (30, 24), "#d9b596")
        s.blob(f"{side}_shoe", f"{side}_leg", [(x + 18, 576), (x + 18, 604), (x - 42, 606), (x - 36, 588), (x - 14, 576)], "#5d3a34")
    s.line("walking_stick", "r_hand", [(116, 388), (100, 376), (86, 390), (84, 480), (82, 600)], 9, "#7a4f2d")
    _limbs(s, "blouse", "r_upperarm, r_lowerarm, r_hand", [(172, 280), (136, 346), (92, 400)], (38, 32, 25), "#735b8e", skin)
    s.limb("neck", "blouse", (216, 256), (210, 220), (36, 34), skin)
    s.blob("blouse", "skirt", [(154, 282), (186, 250), (246, 246), (288, 278), (290, 350), (220, 372), (156, 354)], blouse)
    s.blob("skirt", None, [(162, 346), (222, 340), (284, 346), (322, 460), (328, 552), (222, 562), (128, 552), (136, 460)], "#55637d")
    s.blob("apron", "skirt", [(164, 350), (228, 350), (246, 510), (196, 524), (142, 506)], "#f3eee2")
    s.blob("shawl", "blouse", [(146, 292), (182, 244), (216, 254), (254, 242), (296, 290), (262, 320), (200, 356), (184, 320)], "#c9767e")
    s.circle("bun", "head", (266, 128), 28, grey)
    s.blob("head", "neck", [(152, 164), (172, 124), (222, 116), (256, 150), (254, 200), (218, 234), (168, 226), (154, 206), (136, 194)], skin)
    s.blob("hair", "head", [(160, 144), (176, 110), (230, 100), (268, 142), (262, 196), (240, 196), (234, 154), (200, 136)], grey)
    s.eye("r_eye", "head", (168, 172), 8, (-0.3, 0.0))
    s.eye("l_eye", "head", (200, 172), 9, (-0.3, 0.0))
    s.line("handbag_strap", "handbag", [(230, 444), (240, 410), (268, 410), (280, 444)], 6, "#5d2c29")
    s.blob("handbag", "l_hand", [(222, 440), (288, 440), (298, 494), (214, 494)], "#7c3f3a")
    _limbs(s, "blouse", "l_upperarm, l_lowerarm, l_hand", [(274, 286), (300, 356), (254, 404)], (42, 33, 26), blouse, skin)
    s.rides |= {"apron", "shawl"}
    return s


def lion() -> Sheet:
    """A lion from the side that looks to the right."""
    s, hide, far, mane, light = Sheet(660, 480), "#d9a758", "#b98a43", "#8a4f27", "#f0d9a8"
    s.tail("Tail", "Body", [(176, 220), (112, 250), (64, 210), (60, 140)], [26, 20, 16, 12], hide)
    s.blob("TailTuft", "Tail", [(48, 148), (74, 146), (88, 106), (64, 72), (40, 104)], mane)
    for depth, dx, colour in (("Far", 34, far), ("Near", 0, hide)):
        if depth == "Near":
            s.blob("Body", None, [(168, 220), (220, 176), (330, 184), (430, 180), (484, 220), (478, 296), (410, 330), (300, 314), (210, 312)], hide)
        for end, x, knee, width in (("Back", 212 + dx, 20, 86), ("Front", 428 + dx, 0, 68)):
            s.ellipse(f"{end}{depth}_Paw", f"{end}{depth}_Lower", (x + 4, 434), 32, 16, colour)
            _limbs(s, "Body", f"{end}{depth}_Upper, {end}{depth}_Lower", [(x, 258), (x + knee, 350), (x - 8, 424)], (width, 45, 31), colour)
    s.blob("Mane", "Head", [(470, 70), (540, 56), (580, 100), (572, 200), (556, 270), (490, 310), (420, 280), (390, 200), (410, 110)], mane)
    s.circle("EarFar", "Head", (534, 88), 17, far)
    s.blob("Jaw", "Head", [(528, 200), (580, 204), (606, 214), (592, 236), (548, 236), (524, 222)], light)
    s.blob("Head", "Body", [(452, 150), (480, 100), (540, 98), (574, 140), (618, 166), (618, 200), (570, 212), (500, 224), (460, 196)], hide)
    s.blob("Muzzle", "Head", [(556, 166), (590, 158), (620, 172), (618, 200), (580, 210), (556, 196)], light)
    s.ellipse("Nose", "Muzzle", (612, 166), 14, 10, "#5a3330")
    s.circle("EarNear", "Head", (480, 106), 20, hide)
    s.eye("eye", "Head", (550, 144), 10, (0.3, 0.0))
    s.rides |= {"Muzzle", "Nose"}
    return s


def squirrel() -> Sheet:
    """A squirrel from the side that sits, looks to the left and holds an acorn."""
    s, red, far, light = Sheet(500, 530), "#b8622f", "#934c22", "#f1d9b6"
    s.tail("tail 3", "tail 2", [(420, 230), (380, 170), (330, 130), (290, 150)], [96, 84, 70, 36], red)
    s.tail("tail 2", "tail 1", [(404, 370), (436, 300), (410, 220)], [80, 104, 96], red)
    s.tail("tail 1", "body", [(310, 450), (370, 440), (410, 360)], [50, 66, 80], red)
    s.ellipse("right foot", "body", (196, 478), 48, 16, far)
    _limbs(s, "body", "right arm, right forearm, right paw", [(204, 286), (152, 330), (112, 304)], (34, 26, 20), far)
    s.blob("body", None, [(196, 250), (250, 240), (300, 290), (336, 380), (324, 460), (250, 482), (190, 456), (178, 350)], red)
    s.blob("belly", "body", [(192, 290), (216, 300), (226, 370), (220, 450), (192, 446), (184, 360)], light)
    s.ellipse("left foot", "left thigh", (226, 484), 54, 17, red)
    s.ellipse("left thigh", "body", (276, 424), 56, 58, red)
    s.ellipse("acorn", "left paw", (130, 326), 20, 26, "#c99547")
    s.blob("acorn cap", "acorn", [(106, 318), (112, 296), (130, 288), (150, 296), (154, 318), (130, 312)], "#6f4a2a")
    _limbs(s, "body", "left arm, left forearm, left paw", [(228, 304), (212, 368), (150, 342)], (42, 30, 22), red)
    s.blob("right ear", "head", [(176, 150), (172, 96), (196, 106), (208, 150)], far)
    s.blob("head", "body", [(250, 180), (220, 140), (170, 138), (124, 176), (96, 212), (112, 236), (170, 260), (232, 256), (258, 220)], red)
    s.blob("left ear", "head", [(206, 156), (216, 92), (244, 110), (244, 168)], red)
    s.eye("eye", "head", (168, 186), 14, (-0.2, 0.0), "#fff4e0")
    s.ellipse("nose", "head", (98, 208), 9, 8, INK)
    s.rides |= {"belly", "nose"}
    return s


def gorilla() -> Sheet:
    """A gorilla from three quarters on its knuckles; names as in files of motion capture."""
    s, fur, dark, skin = Sheet(580, 560), "#4b4e58", "#3a3c45", "#7b7478"
    for side, x in (("Left", 362), ("Right", 258)):
        s.ellipse(f"{side}Foot", f"{side}Leg", (x - 10, 522), 44, 16, skin)
        _limbs(s, "Hips", f"{side}UpLeg, {side}Leg", [(x - 10, 394), (x + 6, 452), (x, 508)], (76, 54, 40), dark)
    _limbs(s, "Chest", "RightArm, RightForeArm, RightHand", [(172, 236), (126, 346), (132, 480)], (86, 67, 48), dark, skin)
    s.ellipse("Hips", None, (334, 384), 92, 66, dark)
    s.blob("Chest", "Hips", [(144, 240), (184, 180), (300, 150), (410, 190), (446, 290), (430, 390), (330, 432), (220, 400), (160, 320)], fur)
    s.blob("Pecs", "Chest", [(168, 266), (230, 300), (300, 270), (320, 320), (270, 362), (200, 350), (168, 310)], skin)
    _limbs(s, "Chest", "LeftArm, LeftForeArm, LeftHand", [(398, 246), (446, 350), (450, 488)], (104, 74, 54), fur, skin)
    s.ellipse("LeftEar", "Head", (294, 158), 15, 19, skin)
    s.blob("Crest", "Head", [(172, 110), (196, 56), (234, 44), (268, 76), (276, 120)], dark)
    s.blob("Head", "Chest", [(150, 156), (166, 104), (220, 82), (274, 104), (292, 170), (270, 230), (210, 250), (164, 226)], fur)
    s.blob("Face", "Head", [(152, 146), (204, 134), (256, 146), (258, 184), (236, 214), (170, 214), (150, 180)], skin)
    s.ellipse("Jaw", "Head", (202, 224), 50, 28, skin)
    s.ellipse("Muzzle", "Face", (200, 200), 50, 28, "#8a8287")
    for side, k in (("Left", 1), ("Right", -1)):
        s.eye(f"{side}_eye", "Face", (200 + 22 * k, 160), 9, (-0.2, 0.0))
    s.tail("BrowRidge", "Face", [(152, 148), (200, 138), (250, 148)], [14, 20, 14], dark)
    s.rides |= {"Pecs", "Face", "Muzzle", "BrowRidge"}
    return s


def shark() -> Sheet:
    """A shark from the side that swims to the left."""
    s, blue, far, pale = Sheet(780, 380), "#5f7f96", "#4a6679", "#dfe7ea"
    s.blob("pectoral fin (far)", "body", [(262, 226), (310, 226), (300, 280), (260, 310)], far)
    s.blob("tail fin top", "tail", [(634, 186), (664, 180), (720, 90), (756, 62), (724, 160), (690, 204)], blue)
    s.blob("tail fin bottom", "tail", [(640, 190), (690, 196), (716, 250), (722, 290), (670, 242)], blue)
    s.blob("anal fin", "tail", [(560, 216), (604, 208), (606, 240), (588, 238)], far)
    s.blob("tail", "body", [(476, 142), (560, 158), (640, 176), (684, 190), (640, 204), (560, 222), (480, 250)], blue)
    s.blob("dorsal fin", "body", [(330, 120), (380, 40), (424, 22), (416, 80), (438, 132)], blue)
    s.blob("body", None, [(210, 130), (300, 104), (400, 108), (500, 140), (512, 220), (440, 262), (320, 274), (220, 250)], blue)
    s.blob("belly", "body", [(230, 236), (330, 226), (430, 226), (490, 226), (430, 256), (320, 268), (250, 262)], pale)
    s.blob("mouth", "head", [(96, 196), (180, 206), (246, 214), (220, 244), (150, 246), (116, 232)], "#8c3b44")
    s.blob("jaw", "head", [(104, 232), (170, 240), (222, 222), (254, 222), (252, 248), (186, 268), (126, 260)], pale)
    s.blob("head", "body", [(270, 106), (190, 116), (90, 150), (38, 180), (60, 200), (150, 216), (220, 226), (272, 240), (284, 180)], blue)
    for n in range(3):
        s.polygon(f"bottom tooth {n + 1}", "jaw", [(116 + 22 * n, 240), (132 + 22 * n, 243), (124 + 22 * n, 222)], "#fff")
        s.polygon(f"top tooth {n + 1}", "head", [(98 + 24 * n, 206), (114 + 24 * n, 209), (105 + 24 * n, 226)], "#fff")
        s.line(f"gill {n + 1}", "head", [(210 + 20 * n, 156), (204 + 20 * n, 180), (210 + 20 * n, 204)], 4, far)
    s.eye("eye", "head", (136, 168), 11, (-0.3, 0.0))
    s.blob("pectoral fin (near)", "body", [(306, 232), (360, 226), (390, 290), (396, 340), (340, 300)], blue)
    s.rides |= {"belly", "mouth", "gill 1", "gill 2", "gill 3"}
    return s


def centaur() -> Sheet:
    """A centaur from the side who looks to the right, with a bow, an arrow and a quiver."""
    s, coat, skin, hair = Sheet(640, 740), "#9c6238", "#e0ae86", "#4a2d20"
    s.tail("tail", "horse_body", [(136, 430), (84, 470), (66, 550), (80, 620)], [30, 38, 40, 14], hair)
    s.line("bow", "bow_hand", [(516, 130), (568, 190), (584, 276), (568, 362), (516, 420)], 9, "#6d4526")
    s.line("bowstring", "bow", [(518, 132), (470, 280), (518, 418)], 2, INK)
    _limbs(s, "torso", "bow_arm_upper, bow_arm_lower, bow_hand", [(424, 262), (500, 290), (578, 279)], (38, 30, 23), "#c4936d")
    s.limb("quiver", "torso", (322, 250), (372, 376), (44, 32), "#7a3f33")
    for depth, dx, colour in (("far", 34, "#7d4d2b"), ("near", 0, coat)):
        if depth == "near":
            s.blob("horse_body", None, [(126, 430), (190, 394), (300, 404), (390, 390), (452, 420), (450, 488), (380, 520), (260, 512), (170, 516), (122, 480)], coat)
        for end, x, width in (("hind", 166 + dx, 78), ("fore", 404 + dx, 62)):
            _limbs(s, "horse_body", f"{depth}_{end}_thigh, {depth}_{end}_cannon", [(x, 474), (x + 4, 574), (x, 678)], (width, 34, 22), colour)
            s.polygon(f"{depth}_{end}_hoof", f"{depth}_{end}_cannon", [(x - 14, 672), (x + 16, 672), (x + 26, 704), (x - 20, 704)], INK)
    s.limb("neck", "torso", (400, 240), (412, 200), (40, 36), skin)
    s.blob("torso", "horse_body", [(352, 260), (384, 228), (430, 236), (456, 280), (444, 350), (452, 430), (410, 458), (364, 430), (362, 340)], skin)
    s.blob("head", "neck", [(378, 140), (396, 102), (440, 100), (462, 136), (478, 164), (462, 180), (434, 212), (394, 198)], skin)
    s.blob("beard", "head", [(412, 182), (440, 190), (466, 176), (462, 214), (436, 240), (414, 216)], hair)
    s.eye("eye", "head", (444, 146), 8, (0.3, 0.0))
    s.blob("hair", "head", [(468, 110), (430, 80), (382, 96), (354, 160), (346, 240), (376, 246), (404, 190), (398, 130), (430, 116)], hair)
    s.line("arrow", "draw_hand", [(440, 288), (520, 286), (608, 282)], 5, "#caa86a")
    _limbs(s, "torso", "draw_arm_upper, draw_arm_lower, draw_hand", [(382, 268), (316, 318), (454, 288)], (46, 36, 26), skin)
    return s


def goblin() -> Sheet:
    """A goblin from three quarters who turns to the left, with a club, a sack and one shoulder plate."""
    s, green, far = Sheet(560, 600), "#86a84e", "#6b8a3c"
    s.blob("Sack", "Torso", [(300, 260), (360, 230), (430, 270), (450, 350), (410, 410), (330, 400), (290, 340)], "#b79a6a")
    s.limb("Club", "R_Fist", (122, 402), (60, 220), (22, 62), "#8a6038")
    _limbs(s, "Torso", "R_Arm_Up, R_Arm_Low, R_Fist", [(216, 286), (166, 346), (114, 380)], (44, 36, 32), far)
    for side, x, k in (("R", 236, -1), ("L", 296, 1)):
        _limbs(s, "Pelvis", f"{side}_Leg_Up, {side}_Leg_Low", [(x, 441), (x + 18 * k, 502), (x + 16 * k, 560)], (54, 44, 30), green if k > 0 else far)
        s.blob(f"{side}_Foot", f"{side}_Leg_Low", [(x + 16 * k + 18, 552), (x + 16 * k + 20, 584), (x + 16 * k - 68, 588), (x + 16 * k - 72, 570), (x + 16 * k - 20, 552)], green if k > 0 else far)
        s.blob(f"{side}_Ear", "Head", [(236 + 66 * k, 160), (236 + 126 * k, 120), (236 + 202 * k, 110), (236 + 136 * k, 180), (236 + 66 * k, 206)], green if k > 0 else far)
    s.blob("Pelvis", None, [(212, 410), (264, 400), (322, 410), (326, 446), (266, 466), (208, 448)], far)
    s.blob("Torso", "Pelvis", [(196, 300), (226, 264), (300, 262), (332, 300), (338, 380), (316, 430), (216, 430), (194, 372)], green)
    s.blob("Loincloth", "Pelvis", [(206, 424), (266, 434), (328, 422), (320, 450), (284, 462), (270, 512), (240, 506), (236, 460)], "#7b5a3a")
    s.blob("Jaw", "Head", [(172, 214), (230, 226), (292, 210), (284, 262), (232, 284), (184, 262)], far)
    s.blob("Head", "Torso", [(156, 180), (172, 120), (236, 94), (300, 120), (318, 184), (290, 230), (230, 240), (178, 228)], green)
    s.eye("R_eye", "Head", (192, 160), 15, (-0.3, 0.0), "#f4e58a")
    s.eye("L_eye", "Head", (250, 160), 18, (-0.3, 0.0), "#f4e58a")
    s.blob("Nose", "Head", [(216, 160), (230, 190), (212, 206), (164, 214), (190, 186)], green)
    s.polygon("Fang", "Jaw", [(252, 238), (270, 234), (264, 212)], "#fff")
    _limbs(s, "Torso", "L_Arm_Up, L_Arm_Low, L_Fist", [(318, 294), (366, 364), (355, 432)], (50, 40, 36), green)
    s.blob("ShoulderPlate", "L_Arm_Up", [(284, 292), (300, 260), (344, 262), (364, 306), (330, 322)], "#8b9198")
    return s
