"""Nested cages in the plane: coarse outlines that strictly enclose a detailed shape, and the safe way there.

Augmenting Nested Cages with IPC (Gurditta & Jacobson 2022) in numpy and scipy. The main entry is :func:`nested_cages`.
"""

from __future__ import annotations

from .batch import BatchProgress, Outcome, nested_cages_many
from .contact import IPC, AllPairs, Cells, NoFilter, SequentialQP, SmallestDistance, TimeOfImpact
from .contact.reinflation import Reinflation
from .coordinates import Grids, Harmonic, MeanValue, PiecewiseLinear, cage_coordinates, deform, grids
from .decimation import ArcLength, DouglasPeucker, EdgeCollapse, OnCurve, OuterHull, OwnDecimation, Visvalingam
from .energies import (
    Area,
    BoundaryARAP,
    ElementEnergy,
    InitialDisplacement,
    InteriorARAP,
    NoEnergy,
    ShapeKeeping,
    StepDisplacement,
    WeightedSum,
)
from .errors import FlowError, InvalidMeshError, NestedCagesError, NestingError, ReinflationError
from .exchange import (
    Feature,
    features_from_geojson,
    from_engine_json,
    from_geojson,
    from_svg,
    is_engine_json,
    read_geojson,
    read_svg,
    to_engine_json,
    to_geojson,
    to_svg,
    write_engine_json,
    write_geojson,
    write_svg,
)
from .exchange.pictures import alpha_channel, boundary_of_pixels, collision_outline, read_png
from .flow import FlowResult, TwoSidedFlow
from .geometry.mesh import Mesh
from .geometry.quadrature import EvenSamples, GaussLegendre, Midpoint, QuadraticFallOff
from .hierarchy import Hierarchy, Level, NestedCagesRun, NestingReport, Progress, Settings, nested_cages
from .published.gurditta_jacobson_2022 import GradientDescent, PaperContact, PaperFlow, Repairs, SignedDistanceFlow
from .published.sacht_2015 import VelocityFilter
from .published.sellan_2022 import LevelSet
from .solver import ProjectedNewton
from .tightening import Tightening
from .verification import Certificate, MotionCertificate, verify, verify_motion

__version__ = "0.1.0"

__all__ = [
    "IPC",
    "AllPairs",
    "ArcLength",
    "Area",
    "BatchProgress",
    "BoundaryARAP",
    "Cells",
    "Certificate",
    "DouglasPeucker",
    "EdgeCollapse",
    "ElementEnergy",
    "EvenSamples",
    "Feature",
    "FlowError",
    "FlowResult",
    "GaussLegendre",
    "GradientDescent",
    "Grids",
    "Harmonic",
    "Hierarchy",
    "InitialDisplacement",
    "InteriorARAP",
    "InvalidMeshError",
    "Level",
    "LevelSet",
    "MeanValue",
    "Mesh",
    "Midpoint",
    "MotionCertificate",
    "NestedCagesError",
    "NestedCagesRun",
    "NestingError",
    "NestingReport",
    "NoEnergy",
    "NoFilter",
    "OnCurve",
    "Outcome",
    "OuterHull",
    "OwnDecimation",
    "PaperContact",
    "PaperFlow",
    "PiecewiseLinear",
    "Progress",
    "ProjectedNewton",
    "QuadraticFallOff",
    "Reinflation",
    "ReinflationError",
    "Repairs",
    "SequentialQP",
    "Settings",
    "ShapeKeeping",
    "SignedDistanceFlow",
    "SmallestDistance",
    "StepDisplacement",
    "Tightening",
    "TimeOfImpact",
    "TwoSidedFlow",
    "VelocityFilter",
    "Visvalingam",
    "WeightedSum",
    "alpha_channel",
    "boundary_of_pixels",
    "cage_coordinates",
    "collision_outline",
    "deform",
    "features_from_geojson",
    "from_engine_json",
    "from_geojson",
    "from_svg",
    "grids",
    "is_engine_json",
    "nested_cages",
    "nested_cages_many",
    "read_geojson",
    "read_png",
    "read_svg",
    "to_engine_json",
    "to_geojson",
    "to_svg",
    "verify",
    "verify_motion",
    "write_engine_json",
    "write_geojson",
    "write_svg",
]
