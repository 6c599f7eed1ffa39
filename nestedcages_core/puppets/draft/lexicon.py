"""English words for parts of a body, what each of them hangs on, and words for where it is."""

from __future__ import annotations

from itertools import product

_SIDES = {
    "L": "l left links linke linker linkes gauche izquierdo izquierda izq esquerdo esquerda sinistro sinistra lewy "
    "lewa lewe левый левая левое лев 左 왼",
    "R": "r right rechts rechte rechter rechtes droit droite derecho derecha der direito direita destro destra "
    "prawy prawa prawe правый правая правое прав 右 오른",
}
SIDES = {word: side for side, words in _SIDES.items() for word in words.split()}
"""Words for sides, in a dozen languages."""

DEPTHS = {"near": "near", "far": "far", "behind": "far"}
"""Words for what lies nearer to who looks at it."""

ENDS = {"front": "fore", "fore": "fore", "back": "hind", "rear": "hind", "hind": "hind"}
"""Words for the ends of an animal."""

HEIGHTS = {"up": "up", "top": "up", "low": "low", "bottom": "low"}
"""Words for what is above and below, such as jaws."""

HALVES = {"upper": "upper", "up": "upper", "lower": "lower", "low": "lower"}
"""Words for the halves of arms and legs."""

PLACES = {word for word in (*SIDES, *DEPTHS, *ENDS, *HEIGHTS, "upper", "lower") if len(word) > 2}
"""Words that names have before a part of a body, at times as one word: hindleg."""

CODES = {end[0] + side[0]: (end, side) for end, side in product(("front", "back", "hind", "rear"), ("left", "right"))}
"""Short words for a leg of an animal: FL is the left one in front."""

IRREGULAR = {"feet": "foot", "teeth": "tooth", "hooves": "hoof", "calves": "calf"}
"""Plurals without an s alone."""

_TORSO = "torso body chest thorax coat dress robe shirt jacket spine sweater hoodie blouse tunic ribcage"
_HIPS, _LOWER = "hips pelvis", "skirt trousers pants shorts jeans kilt dungarees overalls"
_ARM, _FOREARM = "upper_arm sleeve humerus bicep", "forearm lower_arm ulna"
_VEST = "vest waistcoat apron"
_THIGH, _SHIN = "thigh upper_leg haunch femur", "shin calf lower_leg shank hock tibia"
_FACE = "cheek ear hair fringe beard moustache hat helmet horn antler antenna feeler jaw snout muzzle "
_FACE += "beak bill trunk tusk visor face mask glasses plume crest crown tiara wattle blush freckle "
_FACE += "headband bandana bang ponytail pigtail braid bun eyepatch veil wig hood beanie goatee chin forehead"
_HANDS = "hand paw claw glove fist pincer gauntlet"
_TOOLS = "sword hilt handle shield staff stick spear bow axe wand gun rifle pistol hammer mace dagger knife torch "
_TOOLS += "lantern umbrella cane flag haft pole broom spoon ladle"
_FEET = "foot hoof shoe boot ankle sandal sneaker slipper talon sock"

_HANGS_ON = (
    ("pupil iris glint lash lid eyelash eyelid", "eye"),
    ("earring", "ear, head"),
    ("eye brow eyebrow", "face mask visor head skull helmet"),
    ("lens", "glasses"),
    ("brim", "hat"),
    ("mane", f"neck head, {_TORSO}"),
    ("knee kneepad", f"{_SHIN} {_THIGH} leg"),
    ("elbow cuff", f"{_FOREARM} {_ARM} arm"),
    ("shoulder pauldron", f"{_ARM} arm {_TORSO}"),
    ("button pocket zip zipper tie necktie badge lapel", f"{_TORSO} {_VEST} {_LOWER} belly"),
    ("buckle", "belt"),
    ("blade guard", _TOOLS),
    ("nail", "finger thumb toe"),
    ("sole lace", "foot shoe boot"),
    ("nostril", "nose snout muzzle beak bill, face head skull"),
    ("nose mouth whisker", "snout muzzle, face head skull"),
    ("tooth fang tongue lip", "mouth jaw snout muzzle head skull"),
    ("inner_ear", "ear, head"),
    (_FACE, "head skull helmet face"),
    ("head skull", f"neck, {_TORSO}"),
    ("neck", _TORSO),
    (_TORSO, f"{_HIPS}, {_LOWER}"),
    (f"{_LOWER} waist abdomen", f"{_HIPS}, {_TORSO}"),
    ("tail", f"{_HIPS}, {_LOWER} {_TORSO} abdomen"),
    ("scarf collar ruff necklace bowtie", f"neck, {_TORSO}"),
    ("bell tag pendant", f"collar necklace, neck, {_TORSO}"),
    ("scabbard sheath holster", f"belt, {_HIPS} {_LOWER} {_TORSO}"),
    (f"{_VEST} pouch backpack bag satchel quiver", f"{_HIPS} {_LOWER} {_TORSO}"),
    ("hem", "skirt dress robe coat"),
    ("heel", "foot shoe boot"),
    ("greave", _SHIN),
    ("wrist bracelet watch bracer", f"{_FOREARM}, {_ARM} arm"),
    ("belt", f"{_HIPS}, {_LOWER} {_TORSO}"),
    ("wing fin cape cloak belly breast saddle shell hump udder", f"{_TORSO} {_LOWER} {_HIPS}"),
    (_ARM, _TORSO),
    ("arm", f"upper_arm, {_TORSO}"),
    (_FOREARM, f"{_ARM} arm"),
    ("hand claw glove fist pincer gauntlet", f"{_FOREARM}, {_ARM} arm"),
    ("paw", f"{_FOREARM} {_SHIN}, {_ARM} arm {_THIGH} leg"),
    ("finger thumb", f"{_HANDS} wing"),
    (_TOOLS, f"{_HANDS}, {_FOREARM}, arm"),
    (_THIGH, f"{_HIPS}, {_LOWER} {_TORSO}"),
    ("leg", f"upper_leg thigh, {_HIPS}, {_LOWER} {_TORSO}"),
    (_SHIN, f"{_THIGH} leg"),
    (_FEET, f"{_SHIN}, {_THIGH} leg"),
    ("toe", f"paw {_FEET}"),
)
PARENTS = {
    word: tuple(frozenset(group.split()) for group in parents.split(","))
    for words, parents in _HANGS_ON
    for word in words.split()
}
"""What each part of a body hangs on; where there are several groups, on a part of the first one that is there."""

ROOT_NAMES = _HIPS.split(), _LOWER.split(), f"{_TORSO} waist abdomen".split()
"""Parts of a body that are its root, the most likely first."""

TRUNKS = frozenset(word for words in ROOT_NAMES for word in words)
"""Parts of a body that limbs hang on."""

LEGS = frozenset(f"leg {_THIGH} {_SHIN} paw {_FEET}".split())
"""Parts of a leg."""

ARMS = frozenset(f"arm {_ARM}".split())
"""The first part of an arm."""

RIGID = frozenset(f"{_TOOLS} blade guard beak bill horn antler tusk tooth fang nail claw hoof".split())
"""What does not bend, however long it is."""

NO_EXTENSION = frozenset(f"arm {_ARM} {_FOREARM} {_HANDS}".split())
"""Parts of a body that may be named after what they hold: a bow hand."""

TURNING = frozenset(
    f"arm {_ARM} {_FOREARM} leg {_THIGH} {_SHIN} hand paw claw foot hoof wing fin tail jaw head neck".split()
)
"""Parts of a body that turn, wherever they lie."""

HOLDING = frozenset(f"{_HANDS} beak mouth".split())
"""Parts of a body that hold things."""
