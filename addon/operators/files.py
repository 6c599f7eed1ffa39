"""Drawings from files, by the menu or dropped into the view, and outlines of images; cages and puppets as files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import bpy
from bpy.props import CollectionProperty
from bpy.types import Context, Object
from bpy_extras.io_utils import ExportHelper, ImportHelper

from .. import cage_sets
from ..blender.blocks import removed_on_failure
from ..blender.jobs import Progress, Work
from ..blender.mesh_data import mesh_of
from ..blender.props import choice, flag, number, text, whole
from ..blender.views import FLAT_LIGHT, TEXTURES
from ..cage_sets import CageSet, selection
from ..cage_sets.selection import chosen, each_of_chosen, scene_of, select
from ..core import core, game
from ..drawing import planar
from ..errors import UserError, counted
from ..files import exporters, importers, pictures, svg
from ..files.pictures import Picture, image_on
from ..keys import found_object
from ..puppets import armatures, cutouts, exported, imported, repainting
from ..puppets.moving import Making
from .base import DialogJobOperator, Operator, Outcome, pose
from .pictures import NAMES as TRACING
from .pictures import PictureProperties, trace_options
from .puppet import make_puppet

OUTLINE_ITEMS = (
    ("AUTO", "Automatic", "Parts of drawings with several shapes, one outline of others; exported cages as they were"),
    ("ONE", "One Outline", "The filled area of everything, overlaps united; of a picture, around its opaque pixels"),
    ("SEVERAL", "Several Outlines", "An outline of each shape"),
    ("PARTS", "Parts of a Character", "A filled part of each shape with its colours and strokes, one above the other"),
    ("PUPPET", "Puppet", "The same with bones, weights and controls, ready to pose"),
)
PLANE_ITEMS = (
    ("AUTO", "Automatic", "Drawings stand upright; maps and exported cages lie on the floor"),
    ("XZ", "Standing", "Upright, seen from the front, as Grease Pencil draws"),
    ("XY", "Lying", "On the floor, seen from the top"),
)
EXTENSIONS = (*importers.SVG, *importers.MAPS, *imported.ENDINGS)
PICTURE = ".png"


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


class OBJECT_OT_nested_cages_import(FilesOperator, PictureProperties, ImportHelper, bpy.types.Operator):  # type: ignore[misc]
    """Read drawings: the filled area of an SVG, each feature of a GeoJSON, a layered painting as a puppet with bones,
    or the outline of a picture
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
    outlines: choice("As", "What to make of a drawing", OUTLINE_ITEMS, default="AUTO")
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

    def ask(self, context: Context, event: bpy.types.Event) -> Any:
        return super().ask(context, event) if self._shown(context) is not None else self.invoke_popup(context)

    def draw(self, context: Context) -> None:
        if self._shown(context) is not None:
            self.draw_options(*TRACING)
            return
        self.draw_options("outlines", "hidden", "repaint", "replace_weights", "plane", "scale", "standard")
        if self.outlines == "ONE":
            self.draw_options(*TRACING)

    def _shown(self, context: Context) -> Object | None:
        """The selected image empty whose outline is asked for; None if files are to be read."""
        active = context.view_layer.objects.active
        shows = active is not None and active.type == "EMPTY" and image_on(active) is not None and active.select_get()
        return active if shows and self.outlines == "ONE" and not paths_of(self) else None

    def work(self, context: Context) -> Work[None]:
        shown = self._shown(context)
        if shown is not None:
            yield from self._outline_of(context, shown)
            return
        paths = paths_of(self)
        if not paths or (paths[0].is_dir() and not any(paths[0].glob("*.[pP][nN][gG]"))):
            raise UserError("Choose a file to read")
        traced = [path for path in paths if self.outlines == "ONE" and path.suffix.lower() == PICTURE]
        drawings = drawings_in([path for path in paths if path not in traced])
        rig = armatures.puppet_of(context.selected_objects) if self.repaint else None
        if self.repaint and (rig is None or len(drawings) != 1):
            raise UserError("Select the puppet of a painting, and choose one file with the painting as it is now")
        with removed_on_failure():
            yield from self._read(context, drawings, traced, rig)
        self.show_colours(context)

    def _read(
        self, context: Context, drawings: dict[Path, list[str] | None], traced: list[Path], rig: Object | None
    ) -> Work[None]:
        """Reads files, and places what is in them or repaints a puppet. Raises: UserError."""
        shapes: list[importers.Shape] = []
        layered_files: list[tuple[str, Any]] = []
        puppets = []
        for done, (path, names) in enumerate(drawings.items()):
            yield Progress(0.5 * done / len(drawings), f"reading '{path.name}'")
            parts, notes = svg.read(path, self.outlines)
            if rig is not None or names is not None or path.is_dir() or path.suffix.lower() in imported.ENDINGS:
                painting = imported.painting_in(path, names, hidden=self.hidden)
                if rig is not None:
                    self._repaint(context, rig, painting)
                    return
                puppets.append(imported.jointed(path, painting))
                notes = (*painting.notes, *puppets[-1].notes)
            elif parts:
                layered_files.append((path.stem, parts))
            else:
                of_file, notes = importers.shapes_in(path, self.outlines)
                shapes += of_file
            for note in notes:
                self.report({"WARNING"}, f"'{path.name}': {note}")
        made = yield from importers.place(context, shapes, scale=self.scale)
        drawn = [obj for obj, shape in zip(made, shapes, strict=True) if not shape.placed]
        drawn += yield from self._outlines_of(context, traced)
        in_parts = []
        for title, parts in layered_files:
            in_parts.append((yield from svg.place(context, title, parts, scale=self.scale)))
        drawn += [obj for own in in_parts for obj in own]
        placed = [obj for obj in made if obj not in drawn]
        importers.arrange(placed, upright=self.plane == "XZ", centred=False)
        importers.arrange(drawn, upright=self.plane != "XY", centred=bool(drawn))
        made = [*placed, *drawn]
        for puppet in puppets:
            made += imported.place(context, puppet, scale=self.scale, is_upright=self.plane != "XY")
        if self.outlines == "PUPPET" and drawn:
            context.view_layer.update()
            for own in in_parts or [drawn]:
                yield from make_puppet(self, context, own, None, Making())
            self.shown_by, self.framed = (TEXTURES, FLAT_LIGHT), tuple(drawn)
            return
        self.shown_by = (TEXTURES, FLAT_LIGHT) if puppets or layered_files else ()
        self.framed, self.upright = tuple(made), not placed if self.plane == "AUTO" else self.plane == "XZ"
        select(context, *made)
        if puppets and not (placed or drawn):
            layers = sum(len(each.puppet.draft.parts) for each in puppets)
            bones = sum(len(each.bones) for each in puppets)
            self.report({"INFO"}, f"{counted(layers, 'part')}, {counted(bones, 'bone')}")
            if len(puppets) == 1:
                pose(context, made[-1])
            return
        made = [obj for obj in made if obj.type == "MESH"]
        count = sum(len(mesh_of(obj).vertices) for obj in made)
        word = "part" if layered_files and not shapes else "outline"
        self.report({"INFO"}, f"{counted(len(made), word)}, {count} vertices")

    def _outline_of(self, context: Context, shown: Object) -> Work[None]:
        """The outline of the picture that an image empty shows, on it."""
        identity, image = shown.session_uid, image_on(shown)
        assert image is not None
        picture = Picture.of(image)
        mesh = yield from self._trace(picture)
        select(context, pictures.place_outline(context, picture, mesh, found_object(identity)))
        self.report({"INFO"}, f"{len(mesh.vertices)} vertices around all opaque pixels of '{picture.name}'")

    def _outlines_of(self, context: Context, paths: list[Path]) -> Work[list[Object]]:
        """The outlines of picture files, in a row."""
        made, left, unit = list[Object](), 0.0, self.scale or importers.PIXEL
        for path in paths:
            picture = Picture.of(pictures.load(path))
            made.append(pictures.place_outline(context, picture, (yield from self._trace(picture)), unit=unit))
            width = unit * picture.size[0]
            made[-1].location.x, left = left + 0.5 * width, left + (1.0 + pictures.GAP) * width
        return made

    def _trace(self, picture: Picture) -> Work[core.Mesh]:
        return (yield from picture.trace(self.vertices, **trace_options(self)))

    def _repaint(self, context: Context, rig: Object, painting: Any) -> None:
        """Changes a puppet to a painting. Raises: UserError."""
        made, notes = repainting.repaint(context, rig, painting, replace_weights=self.replace_weights)
        for note in (*painting.notes, *notes):
            self.report({"WARNING"}, note)
        self.shown_by = (TEXTURES, FLAT_LIGHT)
        select(context, *made)
        self.report({"INFO"}, f"'{rig.name}' has {counted(len(made) - 1, 'layer')}, repainted or as before")


def drawings_in(paths: list[Path]) -> dict[Path, list[str] | None]:
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
        return SUFFIXES.get(self.kind) or f".{game.ENGINES[self.kind.lower()].ending.rpartition('.')[2]}"

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
