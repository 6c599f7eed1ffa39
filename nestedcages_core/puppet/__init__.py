"""Puppets: layered drawings whose parts hang together by joints and move by themselves.

- `PuppetPart`: a painted solid of the drawing; `draft_puppet`: which part hangs on which, with bones.
- `PuppetDraft`: parts, links and bones; `PartChoice`: what a user decides about a part instead.
- `puppet_of`: the draft's `Puppet`: a `BendField` for each part that bends, weights, and a `JointRange` for each bone.
- `Puppet.caps`: each `Cap` is paint that stays behind at a joint, so that nothing opens there.
- `reweighted`: the puppet with weights that were painted by hand.
- `walk`: a `Clip` for any puppet that has legs, or its `Figure`, within the proved ranges.
"""

from .caps import Cap
from .clips import Clip, walk
from .draft import PuppetDraft, draft_puppet
from .fields import BendField
from .limbs import Figure, Limbs
from .links import Hold, Link, PartChoice
from .parts import PuppetPart
from .puppet import Puppet, puppet_of, reweighted
from .ranges import JointRange
from .sides import Side

__all__ = [
    "BendField",
    "Cap",
    "Clip",
    "Figure",
    "Hold",
    "JointRange",
    "Limbs",
    "Link",
    "PartChoice",
    "Puppet",
    "PuppetDraft",
    "PuppetPart",
    "Side",
    "draft_puppet",
    "puppet_of",
    "reweighted",
    "walk",
]
