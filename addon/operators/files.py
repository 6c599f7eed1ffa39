"""Drawings from files, by the menu or dropped into the view, and outlines of what is selected; cages and puppets as
files.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import bpy
from bpy.props import CollectionProperty
from bpy.types import Context, Object
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import cage_sets
from ..blender import views
from ..blender.blocks import removed_on_failure
from ..blender.jobs import Progress, Work
from ..blender.mesh_data import mesh_of
from ..blender.props import choice, flag, number, text, whole
from ..blender.views import FLAT_LIGHT, FRONT, RIGHT, TEXTURES, TOP
from ..cage_sets import CageSet, selection
from ..cage_sets.selection import chosen, each_of_chosen, scene_of, select
from ..core import core
from ..drawing import planar
from ..drawing.painted import paints
from ..drawing.planar import Drawing
from ..errors import FloatArray, UserError, counted
from ..files import exporters, importers, pictures, silhouettes, svg
from ..files.importers import PIXEL
from ..files.pictures import Part, image_on
from ..puppets import armatures, cutouts, exported, imported, repainting
from ..puppets.moving import Making
from .base import DialogJobOperator, GapProperty, Mixin, Operator, Outcome, pose
from .puppet import make_puppet

ONE, PUPPET, SELECTED = "ONE", "PUPPET", "SELECTED"
OUTLINE_ITEMS = (
    ("AUTO", "Automatic", "Parts of drawings with several shapes, one outline of others; exported cages as they were"),
    (ONE, "One Outline", "The filled area of everything, overlaps united; of a picture, around its opaque pixels"),
    ("SEVERAL", "Several Outlines", "An outline of each shape"),
    ("PARTS", "Parts of a Character", "A filled part of each shape with its colours and strokes, one above the other"),
    (PUPPET, "Puppet", "The same with bones, weights and controls, ready to pose"),
    (
        SELECTED,
        "Outline of Selected",
        "No file: one flat outline of all that is selected, across overlaps and depths, solids too; or of each "
        "selected image empty",
    ),
)
PLANE_ITEMS = (
    ("AUTO", "Automatic", "Drawings upright, maps and exported cages on the floor, outlines of objects where they lie"),
    ("FRONT", "Front", "Upright, seen from the front, as Grease Pencil draws"),
    ("TOP", "Top", "On the floor, seen from the top"),
    ("RIGHT", "Right", "Upright, seen from the right"),
    ("VIEW", "View", "As the 3D view looks"),
)
AXES = {"FRONT": FRONT, "TOP": TOP, "RIGHT": RIGHT}
EXTENSIONS = (*importers.SVG, *importers.MAPS, *imported.ENDINGS)
PICTURE = ".png"


class PictureProperties(Mixin):
    """Properties of operators on pictures: how to outline opaque pixels."""

    vertices: whole("Vertices", "Vertex count of the outline of a picture", default=64, min=3, soft_max=256)
    padding: number(
        "Padding",
        "Distance in pixels between the outline and opaque pixels; 0 if not set and all of the picture is opaque",
        default=1.0,
        min=0.0,
        soft_max=32.0,
    )
    threshold: number(
        "Threshold", "Opacity above which a pixel counts as opaque", default=0.5, min=0.0, max=1.0, subtype="FACTOR"
    )
    holes: flag("Holes", "Keep holes open instead of filling them; those of objects are kept if this is not set")

    def traced(self, part: Part) -> Work[Drawing]:
        """The outline of a picture. Raises: UserError."""
        is_set, options = self.properties.is_property_set, {name: getattr(self, name) for name in TRACING}
        return (yield from pictures.traced(part, tile=not is_set("padding"), **options))


# Their names, which are those of the core's options.
TRACING = tuple(PictureProperties.__annotations__)


class FilesOperator(DialogJobOperator):
    """A job on one file or several, which leaves nothing behind if it ends early."""

    exclusive = True

    filepath: text("File Path", "File to read", subtype="FILE_PATH", options={"HIDDEN", "SKIP_PRESET", "SKIP_SAVE"})
    directory: text("Folder", "Folder of the files", subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(
        name="Files",
        description="The files, if there are several",
        type=bpy.types.OperatorFileListElement,
        options={"HIDDEN", "SKIP_SAVE"},
    )
    filter_folder: flag("Folders", "Show folders", default=True, options={"HIDDEN", "SKIP_SAVE"})
    standard: flag(
        "Standard Colours",
        "Show colours as other programs do: sets View Transform of the scene to Standard",
        options={"SKIP_SAVE"},
    )

    def prepare(self, context: Context) -> None:
        if not self.properties.is_property_set("standard"):
            self.standard = not bpy.data.is_saved

    def show_colours(self, context: Context) -> None:
        """Lets the scene show the colours of files as they are, if that is asked for."""
        if self.standard:
            scene_of(context).view_settings.view_transform = "Standard"


def paths_of(operator: Any) -> list[Path]:
    """The files that were chosen in an operator."""
    names = [file.name for file in operator.files if file.name]
    given = [os.path.join(operator.directory, name) for name in names] or [operator.filepath]
    return [Path(bpy.path.abspath(path)) for path in given if path]


class OBJECT_OT_nested_cages_import(FilesOperator, PictureProperties, GapProperty, ImportHelper, bpy.types.Operator):  # type: ignore[misc]
    """Read drawings: the filled area of an SVG, each feature of a GeoJSON, a layered painting as a puppet with bones,
    or the outline of a picture; or make one outline of what is selected
    """

    bl_label = "Import Outlines"
    bl_options = {"REGISTER", "UNDO", "PRESET"}

    filter_glob: text(
        "Filter",
        "Files that are shown",
        default=";".join(f"*{ending}" for ending in (*EXTENSIONS, PICTURE)),
        options={"HIDDEN"},
    )
    scale: number(
        "Scale",
        "Length in Blender of one unit of the file; 0 keeps the size of exported cages, and scales "
        "other SVG to a hundredth",
        min=0.0,
        soft_max=100.0,
    )
    outlines: choice("As", "What to make of a drawing", OUTLINE_ITEMS, default="AUTO", options={"SKIP_SAVE"})
    hidden: flag("Hidden Layers", "Include hidden layers of a painting, as hidden parts")
    repaint: flag(
        "Repaint Selected",
        "Change the selected puppet to this painting: bones, names, poses and actions stay, by the names of layers",
        options={"SKIP_SAVE"},
    )
    replace_weights: flag(
        "Replace Painted Weights",
        "Solve all weights of the selected puppet anew, also those that were painted by hand",
        options={"SKIP_SAVE"},
    )
    plane: choice("Plane", "How drawings are put into the scene", PLANE_ITEMS, default="AUTO")

    def prepare(self, context: Context) -> None:
        FilesOperator.prepare(self, context)
        if self.outlines == SELECTED and not self.properties.is_property_set("holes"):
            self.holes = not _image_empties(context)

    def ask(self, context: Context, event: bpy.types.Event) -> Any:
        if self.outlines != SELECTED:
            return self.invoke_popup(context)
        return super().ask(context, event) if _image_empties(context) else self.start(context)

    def draw(self, context: Context) -> None:
        if self.outlines == SELECTED and not _image_empties(context):
            self.draw_options("plane", "holes", "gap")
            return
        if self.outlines != SELECTED:
            self.draw_options("outlines", "hidden", "repaint", "replace_weights", "plane", "scale", "standard")
        if self.outlines in (ONE, SELECTED):
            self.draw_options(*TRACING)

    def work(self, context: Context) -> Work[None]:
        axes = views.axes_of(context) if self.plane == "VIEW" else AXES.get(self.plane)
        with removed_on_failure():
            if self.outlines == SELECTED:
                yield from self._outline(context, axes)
                return
            paths = paths_of(self)
            if not paths or (paths[0].is_dir() and not any(paths[0].glob("*.[pP][nN][gG]"))):
                raise UserError("Choose a file to read")
            yield from self._repaint(context, paths) if self.repaint else self._read(context, paths, axes)
        self.show_colours(context)

    def _outline(self, context: Context, axes: FloatArray | None) -> Work[None]:
        """One outline of all selected objects, or of each selected image empty."""
        if empties := _image_empties(context):
            yield from self._trace(context, pictures.on_objects(empties))
            return
        active = context.view_layer.objects.active
        objects = sorted(filter(paints, context.selected_objects), key=lambda obj: (obj is not active, obj.name))
        if not objects:
            raise UserError("Select meshes, curves, texts, Grease Pencil drawings or image empties")
        frame = silhouettes.plane_of(context, objects[0], axes)
        self.tell_hidden(context, objects)
        filled = self.properties.is_property_set("holes") and not self.holes
        work = silhouettes.painted_loops(context, objects, frame, fill_holes=filled, gap=self.gap)
        loops, problems = yield from work
        made = silhouettes.place_silhouette(context, objects[0], frame, loops, objects)
        select(context, made)
        self.tell_skipped(problems, "object")
        self.report({"INFO"}, f"'{made.name}': {sum(map(len, loops))} vertices in {counted(len(loops), 'loop')}")

    def _trace(self, context: Context, parts: Sequence[Part]) -> Work[list[Object]]:
        """The outlines of pictures."""
        made = []
        for part in parts:
            made.append(pictures.place_outline(context, part, (yield from self.traced(part))))
        select(context, *made)
        vertices = sum(len(mesh_of(obj).vertices) for obj in made)
        self.report({"INFO"}, f"{vertices} vertices around all opaque pixels of {counted(len(made), 'picture')}")
        return made

    def _read(self, context: Context, paths: list[Path], axes: FloatArray | None) -> Work[None]:
        """Reads files, and places what is in them. Raises: UserError."""
        traced = [path for path in paths if self.outlines == ONE and path.suffix.lower() == PICTURE]
        files = layered_files(path for path in paths if path not in traced)
        placed, drawn, puppets = list[Object](), list[list[Object]](), list[Object]()
        for done, (path, names) in enumerate(files.items()):
            yield Progress(0.5 * done / len(files), f"reading '{path.name}'")
            if names is not None or path.is_dir() or path.suffix.lower() in imported.ENDINGS:
                painting = imported.painting_in(path, names, hidden=self.hidden)
                puppet = imported.jointed(path, painting)
                puppets += imported.place(context, puppet, scale=self.scale)
                self._warn(path, (*painting.notes, *puppet.notes))
                continue
            parts, notes = svg.read(path, self.outlines)
            if parts:
                drawn.append((yield from svg.place(context, path.stem, parts, scale=self.scale)))
                self.shown_by = (TEXTURES, FLAT_LIGHT)
            else:
                shapes, is_placed, notes = importers.shapes_in(path, self.outlines)
                made = yield from importers.place(context, shapes, scale=self.scale)
                placed += made if is_placed else []
                drawn += [] if is_placed else [made]
            self._warn(path, notes)
        lone = [obj for own in drawn for obj in own]
        importers.arrange(placed, TOP if axes is None else axes)
        self.axes = (TOP if placed else FRONT) if axes is None else axes
        upright = FRONT if axes is None else axes
        importers.arrange(lone, upright, centred=bool(lone))
        importers.arrange([obj for obj in puppets if obj.type == "ARMATURE"], upright)
        outlined = [*placed, *lone]
        if traced:
            outlined += yield from self._trace(context, pictures.from_files(traced, upright, self.scale or PIXEL))
        self.framed = (*outlined, *puppets)
        if puppets or self.outlines == PUPPET:
            self.shown_by = (TEXTURES, FLAT_LIGHT)
        if self.outlines == PUPPET and lone:
            context.view_layer.update()
            for own in drawn:
                yield from make_puppet(self, context, own, None, Making())
            return
        select(context, *self.framed)
        if puppets and not outlined:
            rigs = [obj for obj in puppets if obj.type == "ARMATURE"]
            bones = len([bone for rig in rigs for bone in rig.data.bones if armatures.part_of(bone)])
            self.report({"INFO"}, f"{counted(len(puppets) - len(rigs), 'layer')}, {counted(bones, 'bone')}")
            if len(rigs) == 1:
                pose(context, rigs[0])
        elif not traced:
            count = sum(len(mesh_of(obj).vertices) for obj in outlined)
            self.report({"INFO"}, f"{counted(len(outlined), 'outline')}, {count} vertices")

    def _repaint(self, context: Context, paths: list[Path]) -> Work[None]:
        """Changes the selected puppet to a painting. Raises: UserError."""
        files, rig = layered_files(paths), armatures.puppet_of(context.selected_objects)
        if rig is None or len(files) != 1:
            raise UserError("Select the puppet of a painting, and choose one file with the painting as it is now")
        yield Progress(0.0, "reading the painting")
        ((path, names),) = files.items()
        painting = imported.painting_in(path, names, hidden=self.hidden)
        made, notes = repainting.repaint(context, rig, painting, replace_weights=self.replace_weights)
        self._warn(path, (*painting.notes, *notes))
        self.shown_by = (TEXTURES, FLAT_LIGHT)
        select(context, *made)
        self.report({"INFO"}, f"'{rig.name}' has {counted(len(made) - 1, 'layer')}, repainted or as before")

    def _warn(self, path: Path, notes: Iterable[str]) -> None:
        for note in notes:
            self.report({"WARNING"}, f"'{path.name}': {note}")


def _image_empties(context: Context) -> list[Object]:
    """The selected empties that show an image."""
    return [obj for obj in context.selected_objects if obj.type == "EMPTY" and image_on(obj) is not None]


def layered_files(paths: Iterable[Path]) -> dict[Path, list[str] | None]:
    """The files and folders to read; of folders whose pictures were chosen, their names."""
    found, pictures = dict[Path, "list[str] | None"](), dict[Path, list[str]]()
    for path in paths:
        is_picture = path.suffix.lower() == PICTURE
        found[path.parent if is_picture else path] = None
        if is_picture:
            pictures.setdefault(path.parent, []).append(path.name)
    return {**found, **pictures}


class NESTEDCAGES_FH_outlines(bpy.types.FileHandler):
    """Files dropped into the 3D view are imported."""

    bl_idname = "NESTEDCAGES_FH_outlines"
    bl_label = "Outlines for Cages"
    bl_import_operator = OBJECT_OT_nested_cages_import.bl_idname
    bl_file_extensions = ";".join(EXTENSIONS)

    @classmethod
    def poll_drop(cls, context: Context) -> bool:
        return context.mode == "OBJECT" and context.area is not None and context.area.type == "VIEW_3D"


OUTLINES = (
    ("SVG", "SVG", "One path per outline, holes cut out"),
    ("GEOJSON", "GeoJSON", "One feature per outline with its area and centroid, for maps, shapely and game engines"),
)
SUFFIXES = {"SVG": ".svg", "GEOJSON": ".geojson"}
ENGINES = (
    ("GODOT", "Godot 4", "A scene with the textures and actions of a puppet or cutout"),
    ("SPINE", "Spine 4.2", "A skeleton with its atlas and actions"),
    ("SCRIPT", "Own Script", "Bones, meshes, weights and actions as JSON, with the atlas"),
)


class OBJECT_OT_nested_cages_export(Operator, ExportHelper, bpy.types.Operator):  # type: ignore[misc]
    """Write the selected outlines, or a drawing with all of its cages, as they are on this frame, to a file; or a
    puppet with its bones and actions for a game engine
    """

    needs = staticmethod(lambda context: has_outlines(context) or armatures.puppet_of(context.selected_objects))
    missing = "Select cages, a puppet, or other objects with a closed outline"

    bl_label = "Export"
    bl_options = {"REGISTER", "PRESET"}
    modes = ("OBJECT", "POSE")

    filepath: text("File Path", "File to write", subtype="FILE_PATH", options={"HIDDEN", "SKIP_PRESET"})
    filter_glob: text(
        "Filter",
        "Files that are shown",
        default=";".join(f"*{ending}" for ending in SUFFIXES.values()),
        options={"HIDDEN"},
    )
    kind: choice("For", "What reads the file: outlines, or an engine that plays a puppet", (*OUTLINES, *ENGINES))
    flip_y: flag("Y Down", "Let the y axis of a GeoJSON point down, as in images and most 2D engines", default=True)
    world: flag("World", "Write world coordinates, seen from the top, front or right, instead of the first object's")
    scale: number(
        "Scale",
        "Units in the file per unit of the scene, such as pixels per metre; 1 writes an SVG at its size in the "
        "scene's unit of length",
        default=1.0,
        min=1e-9,
        soft_max=1000.0,
    )
    pieces: whole(
        "Pieces",
        "Add convex pieces of at most this many vertices of each cage to a GeoJSON, for engines that need these, such "
        "as Box2D, which takes 8; 0 adds none",
        min=0,
        soft_max=16,
    )

    @property
    def filename_ext(self) -> str:
        """The file extension that Blender's helper adds."""
        return SUFFIXES.get(self.kind) or f".{core.puppets.ENGINES[self.kind.lower()].ending.rpartition('.')[2]}"

    def _puppet(self, context: Context) -> Object | None:
        """The armature of the puppet to write; None if outlines are asked for."""
        objects = context.selected_objects or chosen(context)
        rig = armatures.puppet_of(objects) or cutouts.rig_of(objects)
        if not self.properties.is_property_set("kind") and rig is not None:
            self.kind = ENGINES[0][0]
        return None if self.kind in SUFFIXES else rig

    def draw(self, _context: Context) -> None:
        self.layout.use_property_split = True
        of_outlines = ("world", "scale", *(("flip_y", "pieces") if self.kind == "GEOJSON" else ()))
        for name in ("kind", *(of_outlines if self.kind in SUFFIXES else ())):
            self.layout.prop(self, name)

    def invoke(self, context: Context, event: bpy.types.Event) -> Outcome:  # type: ignore[override]
        if not self.filepath:
            rig = self._puppet(context)
            name = bpy.path.clean_name(rig.data.name if rig is not None else outlines(context)[0].name)
            self.filepath = str(Path(bpy.data.filepath).parent / (name + self.filename_ext))
        asked: Any = super().invoke(context, event)
        return {*asked}

    def run(self, context: Context) -> None:
        if not self.filepath:
            raise UserError("Choose a file to write")
        path = Path(bpy.path.abspath(self.filepath))
        rig = self._puppet(context)
        if rig is not None:
            work = exported.write if armatures.is_puppet(rig) else cutouts.write
            files, notes = work(context, rig, path, self.kind.lower())
            for note in notes:
                self.report({"WARNING"}, note)
            self.report({"INFO"}, f"{', '.join(file.name for file in files)} written")
            return
        if self.kind not in SUFFIXES:
            raise UserError(
                "Select a cutout with bones or a puppet: an imported painting, or parts that 'Make Puppet' moves"
            )
        objects = outlines(context)
        shapes = exporters.meshes(context, objects, world=self.world, scale=self.scale)
        exporters.write(
            path,
            self.kind,
            shapes,
            flip_y=self.flip_y or self.kind == "SVG",
            pieces=max(3, self.pieces) if self.pieces else None,
            levels=[selection.depth_of(obj) for obj in objects] if any(map(cage_sets.level_of, objects)) else None,
            size=exporters.paper(context, objects[0], world=self.world) if self.scale == 1.0 else None,
        )
        self.report({"INFO"}, f"{counted(len(shapes), 'outline')} written to {path.name}")


def has_outlines(context: Context) -> bool:
    """Whether any outline is selected, or what has cages or moves them."""
    return any(map(planar.readable, context.selected_objects)) or next(each_of_chosen(context), None) is not None


def outlines(context: Context) -> list[Object]:
    """The selected outlines, and all of what has cages or moves them; drawing by drawing, the coarsest last."""
    outlined: list[Object] = []
    selected = list(context.selected_objects or chosen(context)[:1])
    for obj in sorted(selected, key=lambda obj: (cage_sets.level_of(obj) or 0, obj.name)):
        about = CageSet.all_of(obj) if cage_sets.level_of(obj) is None else []
        members = [output.members for output in about]
        if about:
            # Around it and inside: one copy of the drawing is enough.
            outlined += sorted(members[0] + [cage for more in members[1:] for cage in more[1:]], key=selection.depth_of)
        elif planar.readable(obj):
            outlined.append(obj)
    return list(dict.fromkeys(outlined))
