"""Energies of the cage: value, gradient and Hessian."""

from __future__ import annotations

from .arap import BoundaryARAP, InteriorARAP
from .area import Area, signed_area
from .base import CageEnergy, Energy
from .blocks import Blocks
from .displacement import InitialDisplacement, StepDisplacement
from .element_energy import ElementEnergy
from .inwards import inwards
from .limits import sharp_angles, short_edges
from .no_energy import NoEnergy
from .shape_keeping import ShapeKeeping
from .springs import Springs
from .weighted_area import WeightedArea
from .weighted_sum import BoundSum, WeightedSum

__all__ = [  # noqa: RUF022 - in the order of explanation
    "Energy",  # what is chosen: the energy of a cage, once its rest shape is known
    "CageEnergy",  # base class: a new energy is its value, gradient and Hessian
    "Blocks",  # a Hessian, in 2 x 2 blocks over the vertices
    "Area",  # the paper's: the area of the cage
    "ShapeKeeping",  # area, and no part of the cage turns
    "BoundaryARAP",  # as rigid as possible along the curve
    "InteriorARAP",  # as rigid as possible inside
    "InitialDisplacement",  # distance from the coarse mesh
    "StepDisplacement",  # distance from the previous step
    "NoEnergy",  # zero: the cage moves only where it is pushed
    "WeightedSum",  # several of them
    "BoundSum",  # the same for one cage
    "WeightedArea",  # the excess, weighted along the fine mesh
    "Springs",  # vertices that are held at their places
    "short_edges",  # a penalty for edges shorter than a length
    "sharp_angles",  # a penalty for angles sharper than an angle
    "ElementEnergy",  # any formula per vertex, edge or turn, by automatic differentiation
    "inwards",  # an energy for cages inside the fine mesh
    "signed_area",  # area enclosed by oriented loops
]
