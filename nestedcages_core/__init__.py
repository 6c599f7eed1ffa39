"""Nested cages in the plane: coarse outlines that strictly enclose a detailed shape, with collision-free motion.

Augmenting Nested Cages with IPC (Gurditta & Jacobson 2022) in numpy and scipy. The main entry is `nested_cages`.

``__all__`` lists what most programs need. Method objects, such as contacts, energies and decimations, can be imported
from here as well; each package (`contact`, `energies`, `decimation`, ...) documents its own.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from .errors import Fault as Fault
from .errors import FlowError, InvalidMeshError, NestedCagesError, NestingError, ReinflationError
from .geometry.drawable import Drawable
from .libraries import imported_later

if TYPE_CHECKING:
    from .batch import BatchProgress as BatchProgress
    from .batch import Outcome as Outcome
    from .batch import nested_cages_many
    from .checker import Verdict as Verdict
    from .checker import check
    from .constraints.axis_aligned import AxisAligned as AxisAligned
    from .constraints.base import Bound as Bound
    from .constraints.base import Constraint as Constraint
    from .constraints.base import Terms as Terms
    from .constraints.box import Box as Box
    from .constraints.edges_and_angles import LeastAngle as LeastAngle
    from .constraints.edges_and_angles import LeastEdge as LeastEdge
    from .constraints.half_planes import HalfPlanes as HalfPlanes
    from .constraints.loop_clearance import LoopClearance as LoopClearance
    from .constraints.outside import Outside as Outside
    from .contact import SequentialQP as SequentialQP
    from .contact.ipc import IPC as IPC
    from .contact.reinflation import Reinflation
    from .coordinates import Grids as Grids
    from .coordinates import Harmonic as Harmonic
    from .coordinates import MeanValue as MeanValue
    from .coordinates import PiecewiseLinear as PiecewiseLinear
    from .coordinates import cage_coordinates, deform
    from .coordinates import grids as grids
    from .decimation import ArcLength as ArcLength
    from .decimation import LineCycles as LineCycles
    from .decimation import OnCurve as OnCurve
    from .decimation import OwnDecimation as OwnDecimation
    from .energies import Area as Area
    from .energies import Blocks as Blocks
    from .energies import CageEnergy as CageEnergy
    from .energies.choices import BoundaryARAP as BoundaryARAP
    from .energies.choices import ElementEnergy as ElementEnergy
    from .energies.choices import InitialDisplacement as InitialDisplacement
    from .energies.choices import InteriorARAP as InteriorARAP
    from .energies.choices import ShapeKeeping as ShapeKeeping
    from .energies.choices import StepDisplacement as StepDisplacement
    from .energies.no_energy import NoEnergy as NoEnergy
    from .energies.weighted_sum import WeightedSum as WeightedSum
    from .errors.codes import CODES as CODES
    from .flow import FlowResult
    from .flow import TwoSidedFlow as TwoSidedFlow
    from .formats import Coverage as Coverage
    from .formats import Feature as Feature
    from .formats import Limits as Limits
    from .formats import convex_pieces as convex_pieces
    from .formats import coverage_cages as coverage_cages
    from .formats import (
        features_from_geojson,
        from_geojson,
        from_svg,
        read_geojson,
        read_svg,
        to_geojson,
        to_svg,
        write_geojson,
        write_svg,
    )
    from .formats import joined as joined
    from .formats import read_map as read_map
    from .formats import read_svg_drawing as read_svg_drawing
    from .formats import svg_drawing as svg_drawing
    from .formats.pictures import alpha_channel as alpha_channel
    from .formats.pictures import boundary_of_pixels as boundary_of_pixels
    from .formats.pictures import collision_outline, read_png
    from .formats.swept import swept
    from .geometry.mesh import Mesh
    from .geometry.symmetry import DetectSymmetry as DetectSymmetry
    from .geometry.symmetry import Mirror as Mirror
    from .geometry.symmetry import Rotation as Rotation
    from .levels import (
        Hierarchy,
        Level,
        NestingReport,
        Progress,
        Settings,
        Share,
        inner_cages,
        nested_cages,
    )
    from .levels.check_methods import check_constraint as check_constraint
    from .levels.check_methods import check_decimation as check_decimation
    from .levels.check_methods import check_energy as check_energy
    from .levels.excess_by_count import ExcessByCount as ExcessByCount
    from .levels.excess_by_count import excess_by_count as excess_by_count
    from .levels.runs import InnerCagesRun as InnerCagesRun
    from .levels.runs import NestedCagesRun
    from .motion import AnimatedCagesRun as AnimatedCagesRun
    from .motion import Key as Key
    from .motion import MotionReport as MotionReport
    from .motion import MovingCages as MovingCages
    from .motion import MovingLevel as MovingLevel
    from .motion import animated_cages
    from .motion import followed as followed
    from .motion import stream_cages as stream_cages
    from .published import AUGMENTED_2022 as AUGMENTED_2022
    from .published import AUGMENTED_2022_REPAIRED as AUGMENTED_2022_REPAIRED
    from .published import GradientDescent as GradientDescent
    from .published import PaperContact as PaperContact
    from .published import PaperFlow as PaperFlow
    from .published import PaperWeights as PaperWeights
    from .published import Repairs as Repairs
    from .published import as_published as as_published
    from .puppets import Bone as Bone
    from .puppets import Character as Character
    from .puppets import PartChoice as PartChoice
    from .puppets import Puppet as Puppet
    from .puppets import PuppetDraft as PuppetDraft
    from .puppets import PuppetPart as PuppetPart
    from .puppets import Skeleton as Skeleton
    from .puppets import bone_weights as bone_weights
    from .puppets import draft_puppet as draft_puppet
    from .puppets import puppet_of as puppet_of
    from .puppets import puppet_parts as puppet_parts
    from .puppets import suggest_bones as suggest_bones
    from .puppets import walk as walk
    from .puppets import with_joints as with_joints
    from .solver.banded import Rows as Rows
    from .solver.newton import ProjectedNewton as ProjectedNewton
    from .solver.quadratic_program import InteriorPoint as InteriorPoint
    from .tightening import Tightening as Tightening
    from .tolerance import Within
    from .verification import Certificate, MotionCertificate, verify, verify_motion

__version__ = "1.0.0"

__all__ = [  # noqa: RUF022 - in the order in which one would explain it
    # the input
    "Mesh",
    # the work
    "nested_cages",
    "NestedCagesRun",
    "inner_cages",
    "nested_cages_many",
    "Settings",
    "Within",
    "Share",
    "Progress",
    # the results
    "Hierarchy",
    "Level",
    "NestingReport",
    "FlowResult",
    "Reinflation",
    # the certificates
    "verify",
    "verify_motion",
    "Certificate",
    "MotionCertificate",
    "check",
    # cages that follow a moving drawing
    "animated_cages",
    "swept",
    # cages that move their drawing
    "cage_coordinates",
    "deform",
    # files and texts
    "read_svg",
    "write_svg",
    "from_svg",
    "to_svg",
    "read_geojson",
    "write_geojson",
    "from_geojson",
    "features_from_geojson",
    "to_geojson",
    "read_png",
    "collision_outline",
    # what can go wrong
    "NestedCagesError",
    "InvalidMeshError",
    "FlowError",
    "ReinflationError",
    "NestingError",
]

_LATER = {
    "geometry.mesh": "Mesh",
    "levels": "Hierarchy Level NestingReport Progress Settings Share inner_cages nested_cages",
    "levels.runs": "InnerCagesRun NestedCagesRun",
    "flow": "FlowResult TwoSidedFlow",
    "contact": "SequentialQP",
    "contact.reinflation": "Reinflation",
    "energies": "Area Blocks CageEnergy",
    "tightening": "Tightening",
    "tolerance": "Within",
    "verification": "Certificate MotionCertificate verify verify_motion",
    "energies.weighted_sum": "WeightedSum",
    "energies.no_energy": "NoEnergy",
    "contact.ipc": "IPC",
    "decimation": "LineCycles OnCurve ArcLength OwnDecimation",
    "energies.choices": "BoundaryARAP ElementEnergy InitialDisplacement InteriorARAP ShapeKeeping StepDisplacement",
    "geometry.symmetry": "DetectSymmetry Mirror Rotation",
    "solver.banded": "Rows",
    "solver.newton": "ProjectedNewton",
    "solver.quadratic_program": "InteriorPoint",
    "batch": "BatchProgress Outcome nested_cages_many",
    "checker": "Verdict check",
    "constraints.axis_aligned": "AxisAligned",
    "constraints.base": "Bound Constraint Terms",
    "constraints.box": "Box",
    "constraints.edges_and_angles": "LeastAngle LeastEdge",
    "constraints.half_planes": "HalfPlanes",
    "constraints.loop_clearance": "LoopClearance",
    "constraints.outside": "Outside",
    "errors.codes": "CODES",
    "coordinates": "Grids Harmonic MeanValue PiecewiseLinear cage_coordinates deform grids",
    "formats": (
        "Coverage Feature Limits convex_pieces coverage_cages features_from_geojson from_geojson from_svg joined "
        "read_geojson read_map read_svg read_svg_drawing svg_drawing to_geojson to_svg write_geojson write_svg"
    ),
    "formats.swept": "swept",
    "formats.pictures": "alpha_channel boundary_of_pixels collision_outline read_png",
    "levels.check_methods": "check_constraint check_decimation check_energy",
    "levels.excess_by_count": "ExcessByCount excess_by_count",
    "motion": "AnimatedCagesRun Key MotionReport MovingCages MovingLevel animated_cages followed stream_cages",
    "puppets": (
        "Bone Character PartChoice Puppet PuppetDraft PuppetPart Skeleton bone_weights draft_puppet puppet_of "
        "puppet_parts suggest_bones walk with_joints"
    ),
    "published": (
        "AUGMENTED_2022 AUGMENTED_2022_REPAIRED GradientDescent PaperContact PaperFlow PaperWeights Repairs "
        "as_published"
    ),
}
"""Modules and their public names, which are imported on first use: the help of the command needs none of them."""

if not TYPE_CHECKING:  # a type checker would then take any name for one of the package
    __getattr__ = imported_later(__name__, _LATER)

Drawable.formats = staticmethod(lambda name: import_module(f".formats.{name}", __name__))


def __dir__() -> list[str]:
    return sorted(__all__)
