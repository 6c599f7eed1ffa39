"""Sentences of notes, made of a code and its data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

NOTES: Mapping[str, str] = {
    "count least": "{asked} vertices are too few for this shape; the cage has {given}.",
    "count mesh": "A cage has no more vertices than what it encloses: {given}, not {asked}.",
    "count loops": "The vertices per loop of the coarse mesh do not fit the mesh inside: they are redistributed.",
    "count symmetry": "{asked} vertices were asked for; with {symmetry} the cage can have {given}.",
    "count constraint": "{asked} vertices were asked for; what the cage has to keep leaves room for {given}.",
    "count fewer": "{asked} vertices were asked for; the tightest cage that was found has {given}.",
    "count hull": "{asked} vertices were asked for, but a convex cage has at most {given} here.",
    "start fallback": "Started from the {source} instead of the coarse mesh: {text}",
    "start flow": "Started from the {source}: the mesh could not shrink into a coarse mesh {first}.",
    "start reinflation": "Started from the {source}: the mesh could not return from a coarse mesh {first}.",
    "start rest": "The cage stands still: moving to the coordinates asked for, it would meet the shape.",
    "clearance gaps": "The gaps of the shape leave {given:.3g} between it and the cage, not {wanted:.3g}.",
    "clearance inside": "The shape is narrow, and leaves {given:.3g} between it and the cage, not {wanted:.3g}.",
    "loops": "The cage has {given}, but the mesh in it has {wanted}{lost}.",
    "energy": "The cage is the coarse mesh, where {energy} is smallest; Area() makes it tighter.",
    "symmetry grid": "The symmetry is moved by {difference:.3g} to the grid: {symmetry}.",
    "symmetry none": "The shape has no symmetry within {tolerance_percent:.3g} % of its size, so the cage has none.",
    "symmetry found": "Found {symmetry}, to within {difference:.3g}.",
    "outline": "Mirrored or turned, the shape covers {change_percent:.3g} % more: the cage encloses all of that.",
    "outline inside": "The cage is in the {area_percent:.3g} % of the shape that are the same mirrored or turned.",
    "pin": "{count} of {pins} pins have no vertex of the cage nearby: the farthest, at "
    "({place[0]:.4g}, {place[1]:.4g}), is {distance:.3g} away from the next.",
    "edge": "There is no room for edges of {wanted:.6g}: the shortest has {given:.3g}; ask for fewer vertices.",
    "angle": "There is no room for angles of {wanted:.6g}°: the sharpest has {given:.3g}°.",
    "tolerance distance": "{count} vertices keep the cage within {limit:.6g} of the shape, as asked.",
    "tolerance bounded": "{count} vertices keep the cage within {limit:.6g} of the shape, as asked; "
    "fewer than {fewest} cannot.",
    "tolerance excess": "With {count} vertices, the cage is {taken_percent:.4g} % larger than the shape; "
    "{limit_percent:.6g} % was allowed.",
    "time": "The time of {seconds:g} s was over during the {stage}: the cage is the best certified one by then.",
    "work": "The search was ended after {steps} steps, during the {stage}: the cage is the best certified one by then.",
    "library": "Without {library}, parts do not share a loop, and corners at a large clearance are not round.",
    "text": "{text}",
}
"""Sentences of notes, by the code without `note.`, and by what it is `on` where it has several: formats for their data.
`…_percent` is 100 times a value."""


def sentence(code: str, data: Mapping[str, Any], formats: Mapping[str, str] = NOTES) -> str:
    """What a note says, by `formats` of other programs first; the plain text, if there is any, for unknown ones."""
    percent = {f"{name}_percent": 100.0 * value for name, value in data.items() if isinstance(value, float)}
    key = f"{code} {data.get('on', '')}".strip()
    try:
        known = formats.get(key) or NOTES[key.removeprefix("note.")]
        return known.format(**data, **percent)
    except (KeyError, IndexError, ValueError, TypeError):
        return str(data.get("text", ""))
