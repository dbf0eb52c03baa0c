# SPDX-License-Identifier: Apache-2.0
"""Scenes, exposures of them, and series of exposures. What a scene's fields may be is declared once, in Modules/IO; setting a
field asks there."""
from __future__ import annotations

import dataclasses
import json
import operator
import os
import struct
import threading
import warnings
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Callable, ClassVar, Optional, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _xray
from ._errors import InputError
from ._mesh import Mesh, _write, read_mesh, write_mesh
from ._values import array_of, made_from, number, suggestion, three, warn, whole

Progress = Callable[[float, str], Any]
Floats = NDArray[numpy.float32]


@dataclasses.dataclass(frozen=True)
class Material:
    """Material of a region.

    attenuation: name of a table ("adipose", "glandular", "muscle", ...), compound ("Water, Liquid"), element or formula ("H2O") or
        mass fractions ("H:0.112 O:0.888"); a number, 1/mm, the same at all energies; or (energies in keV, values in 1/mm)
    density: g/cm^3. Elements, NIST's compounds and tables have one of their own; formulas and mass fractions need it
    iodine: that it has taken up, mg/ml
    youngs_modulus: at small strain, kPa
    poisson_ratio: [0, 0.5)
    fung_exponent: how fast it stiffens, [0, 50]; 0: neo-Hookean
    fixed: whether it is fixed to the body (chest wall)
    name: for messages and results
    """
    attenuation: Union[str, float, tuple[ArrayLike, ArrayLike], None] = None
    density: Optional[float] = None
    iodine: float = 0.0
    youngs_modulus: float = 5.0
    poisson_ratio: float = 0.49
    fung_exponent: float = 0.0
    fixed: bool = False
    name: str = ""

    def _text(self, place: str) -> str:
        """The attenuation as scene files have it."""
        value: Any = self.attenuation
        if value is None:
            raise InputError(f"{place}.attenuation: expected a name or number, found none")
        if isinstance(value, str):
            return value
        if numpy.isscalar(value):
            return f"{number(value, f'{place}.attenuation')!r}/mm"
        try:
            energies, values = value
        except (TypeError, ValueError) as error:
            raise InputError(f"{place}.attenuation: expected a name, a number, or energies and values, found {value!r}") from error
        lines = array_of(energies, f"{place}.attenuation: energies", (None,))
        return " ".join(f"{energy!r}:{each!r}" for energy, each in zip(
            lines.tolist(), array_of(values, f"{place}.attenuation: values", (len(lines),)).tolist())) + "/mm"

    def _entry(self, place: str, region: int) -> dict[str, Any]:
        """The entry of a material table for it."""
        density = density_of(self, place)
        text = self._text(place)
        stated = density is not None and not text.endswith("/mm")
        return {"name": self.name or f"region {region}", "labels": [region], "attenuation": text,
                **({"density_g_per_cm3": density} if stated else {}), "iodine_mg_per_ml": float(self.iodine),
                "youngs_modulus_kpa": float(self.youngs_modulus), "poisson_ratio": float(self.poisson_ratio),
                "fung_exponent": float(self.fung_exponent), "fixed": bool(self.fixed)}


Materials = Union[str, Mapping[int, Union[Material, float, str, Mapping[str, Any]]],
                  Sequence[Union[Material, float, str, Mapping[str, Any]]]]


def material_table(path_or_name: str) -> dict[int, Material]:
    """The materials of a table, by the number of the region: a file (.json) or the name of a shipped one ("victre", "segment",
    "ispy1-breast", "duke-fat-gland", "duke-model")."""
    return {region: Material(**entry) for region, entry in enumerate(_xray.materials(path_or_name)) if region > 0}


def material_of(entry: Any, place: str) -> Material:
    """A Material, however it was given."""
    if isinstance(entry, (str, int, float, numpy.number)) and not isinstance(entry, bool):
        return Material(attenuation=entry if isinstance(entry, str) else float(entry))
    made = made_from(Material, entry, place)
    assert isinstance(made, Material)
    return made


def materials_of(materials: Materials) -> dict[int, Material]:
    """Materials by the number of their region, however they were given."""
    if isinstance(materials, str):
        return material_table(materials)
    if isinstance(materials, Mapping):
        entries = {whole(region, "materials: region", 1, 65535): entry for region, entry in materials.items()}
    elif isinstance(materials, Sequence):
        entries = dict(enumerate(materials, 1))
    else:
        raise InputError(f"materials: expected a table's name, a dict by region or a list, found {materials!r}")
    return {region: material_of(entry, f"materials[{region}]") for region, entry in entries.items()}


def density_of(material: Material, place: str) -> Optional[float]:
    """The density that is stated, if one is."""
    if material.density is None:
        return None
    density = number(material.density, f"{place}.density")
    if density <= 0:
        raise InputError(f"{place}.density: expected a positive number, g/cm^3, found {density:g}")
    return density


# The declarations of scene files, by class and field: "detector.pixel-spacing" is Detector.pixel_spacing.
_QUANTITIES = {quantity["key"]: quantity for quantity in _xray.quantities()}
_RENAMED = {"beam.filter": "filters"}
_APART = ("unit", "mesh", "mesh-unit", "materials", "samples")


def _field_of(key: str, prefix: str) -> str:
    return _RENAMED.get(key, key[len(prefix):].replace("-", "_").replace(".", "_"))


def _fields_within(prefix: str) -> dict[str, Any]:
    return {_field_of(key, prefix): quantity for key, quantity in _QUANTITIES.items()
            if key not in _APART and (key.startswith(prefix) if prefix else _part_of(key) is None)}


def _part_of(key: str) -> Optional[str]:
    part = key.split(".")[0]
    return part if part in ("source", "detector", "beam", "scatter", "refraction") else None


def _number_text(value: Any) -> str:
    try:
        return str(operator.index(value))
    except TypeError:
        pass
    try:
        return repr(float(value))
    except (TypeError, ValueError):
        return str(value)


def _settings_of(quantity: Mapping[str, Any], name: str, value: Any) -> tuple[Any, ...]:
    """A value as the core's settings: name in messages, key, texts."""
    key = quantity["key"]
    if quantity["by_material"]:
        if not isinstance(value, Mapping):
            raise InputError(f"{name}: expected a dict by names of materials, found {value!r}")
        return tuple((f"{name}[{material!r}]", f"{key}.{material}", (str(each) if quantity["is_text"] else _number_text(each),))
                     for material, each in value.items())
    if isinstance(value, (bool, numpy.bool_)):
        return ((name, key, (str(bool(value)).lower(),)),)
    if quantity["is_list"]:
        values = [value] if numpy.isscalar(value) else list(value)
        if not values:
            raise InputError(f"{name}: expected at least one value, found none")
        if quantity["is_text"]:
            return ((name, key, tuple(map(str, values))),)
        return ((name, key, ("[" + ", ".join(map(_number_text, values)) + "]",)),)
    return ((name, key, (str(value) if quantity["is_text"] else _number_text(value),)),)


class _Part:
    """A group of fields. What is assigned is looked at at once; None is the default."""
    _prefix: ClassVar[str] = ""
    _declared: ClassVar[dict[str, Any]] = {}

    def __init_subclass__(cls) -> None:
        cls._declared = _fields_within(cls._prefix)
        lines = []
        for name, quantity in cls._declared.items():
            # Where a scene stands that has no places is another thing than where the program puts it.
            described = " ".join(quantity["help"].split()).replace("; without it the mammography unit's", "")
            limits = quantity["range"]
            facts = [quantity["unit"] and f"{quantity['unit']}", limits and f"{limits[0]:g} to {limits[1]:g}",
                     quantity["words"] and " | ".join(quantity["words"]), quantity["default"] and f"default {quantity['default']}"]
            lines.append(f"    {name}: {described} [{'; '.join(fact for fact in facts if fact)}]".replace(" []", ""))
        cls.__doc__ = (cls.__doc__ or "").rstrip() + "\n\n" + "\n".join(lines) + "\n"

    def __setattr__(self, name: str, value: Any) -> None:
        if name.startswith("_"):
            object.__setattr__(self, name, value)
            return
        if name not in self._declared:
            raise InputError(f"{type(self).__name__}: no field '{name}'; {suggestion(name, self._names())}")
        settings = self.__dict__.setdefault("_given", {})
        if value is None:
            settings.pop(name, None)
        else:
            if isinstance(value, numpy.ndarray):
                value = value.tolist()
            given = _settings_of(self._declared[name], self._prefix + name, value)
            _xray.check(given)
            settings[name] = given
            value = dict(value) if isinstance(value, Mapping) else tuple(value) if isinstance(value, (list, tuple)) else value
        object.__setattr__(self, name, value)

    def _names(self) -> list[str]:
        return list(self._declared)

    def _all(self) -> list[Any]:
        return [setting for settings in self.__dict__.get("_given", {}).values() for setting in settings]


@dataclasses.dataclass
class Source(_Part):
    """Where X-rays come from, and their focal spot. Lengths are mm, in the frame of the scene."""
    _prefix: ClassVar[str] = "source."
    position: Optional[ArrayLike] = None
    beam_direction: Optional[ArrayLike] = None
    focal_spot: Optional[ArrayLike] = None
    focal_spot_samples: Optional[int] = None
    inverse_square: Optional[bool] = None
    heel_angle: Optional[float] = None
    heel_depth_um: Optional[float] = None


@dataclasses.dataclass
class Detector(_Part):
    """A flat grid of pixels in any pose, and what it makes of photons. Lengths are mm, in the frame of the scene."""
    _prefix: ClassVar[str] = "detector."
    origin: Optional[ArrayLike] = None
    column_direction: Optional[ArrayLike] = None
    row_direction: Optional[ArrayLike] = None
    columns: Optional[int] = None
    rows: Optional[int] = None
    pixel_spacing: Optional[float] = None
    samples: Optional[int] = None
    response: Optional[str] = None
    scintillator: Optional[str] = None
    response_table: Optional[str] = None
    photons: Optional[float] = None
    electronic_noise: Optional[float] = None
    half_modulation: Optional[float] = None
    line_spread: Optional[str] = None
    gain_spread: Optional[float] = None
    dead_pixels: Optional[float] = None
    dark_level: Optional[float] = None
    bits: Optional[int] = None
    seed: Optional[int] = None


@dataclasses.dataclass
class Beam(_Part):
    """The spectrum of the X-rays: one of kev, energies with photons, tube with kvp, and spectrum; and what filters it."""
    _prefix: ClassVar[str] = "beam."
    spectrum: Optional[str] = None
    kev: Optional[float] = None
    energies: Optional[ArrayLike] = None
    photons: Optional[ArrayLike] = None
    tube: Optional[str] = None
    kvp: Optional[float] = None
    target_angle: Optional[float] = None
    filters: Union[str, Sequence[str], None] = None

    def weights(self) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """Energies, keV, and numbers of photons behind all filters."""
        energies, photons, _, _, _ = _xray.spectrum(self._all())
        return numpy.array(energies), numpy.array(photons)

    @property
    def mean_energy(self) -> float:
        """keV."""
        return float(_xray.spectrum(self._all())[3])

    @property
    def half_value_layer(self) -> float:
        """The first one, mm of aluminium."""
        return float(_xray.spectrum(self._all())[4])


@dataclasses.dataclass
class Scatter(_Part):
    """Scattered photons, and the grid before the detector. Lengths are mm."""
    _prefix: ClassVar[str] = "scatter."
    method: Optional[str] = None
    kernels: Optional[str] = None
    air_gap: Optional[float] = None
    photons: Optional[float] = None
    voxel: Optional[float] = None
    grid_ratio: Optional[float] = None
    grid_lines_per_cm: Optional[float] = None
    grid_septum_um: Optional[float] = None
    grid_interspace: Optional[str] = None


@dataclasses.dataclass
class Refraction(_Part):
    """How rays are bent. Lengths are mm."""
    _prefix: ClassVar[str] = "refraction."
    law: Optional[str] = None
    distance: Optional[float] = None


@dataclasses.dataclass
class Sample:
    """A mesh of one material, and where it stands.

    mesh: a Mesh, or what read_mesh takes
    material: what its closed surfaces enclose: a Material; one of the scene's materials, by name; what it is made of, "Al",
        "Ti90Al6V4@4.43" with the density in g/cm^3 where that does not tell it; or a number, 1/mm. None: the regions of the mesh
        are those of the scene's materials
    axis, angle: the mesh is turned right-handedly about this line through the origin of its own frame, degrees
    translation: and then moved, mm
    """
    mesh: Any
    material: Union[Material, str, float, None] = None
    axis: ArrayLike = (0.0, 0.0, 1.0)
    angle: float = 0.0
    translation: ArrayLike = (0.0, 0.0, 0.0)

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self.__dataclass_fields__:
            raise InputError(f"Sample: no field '{name}'; {suggestion(name, list(self.__dataclass_fields__))}")
        if name == "mesh" and not isinstance(value, Mesh):
            value = read_mesh(value)
        elif name in ("axis", "translation"):
            value = three(value, f"sample.{name}")
            if name == "axis" and not any(value):
                raise InputError("sample.axis: expected a direction, found none")
        elif name == "angle":
            value = number(value, "sample.angle")
        elif name == "material" and value is not None and not isinstance(value, str):
            value = material_of(value, "sample.material")
        object.__setattr__(self, name, value)


@dataclasses.dataclass(frozen=True)
class Placement:
    """Where a mammography unit stands in the frame of the scene: the gantry's origin, where the chest-wall edge of the image receptor
    meets its midline, mm, and unit vectors: x along that edge, y from chest wall to nipple, z from receptor to source."""
    origin: NDArray[numpy.float64]
    x: NDArray[numpy.float64]
    y: NDArray[numpy.float64]
    z: NDArray[numpy.float64]

    def source(self, distance: float = 650.0) -> Source:
        """The focus that far above the receptor, mm."""
        return Source(position=self.origin + distance * self.z)

    def detector(self, columns: int, rows: int, pixel_spacing: float = 0.5) -> Detector:
        """The receptor: columns from its chest-wall edge towards the nipple, rows along -x, their middle at the origin."""
        return Detector(self.origin + 0.5 * pixel_spacing * self.y + 0.5 * (rows - 1) * pixel_spacing * self.x, self.y, -self.x,
                        columns, rows, pixel_spacing)


def _side(text: str) -> str:
    """L or R."""
    letter = text[:1].upper() if isinstance(text, str) else ""
    if letter not in ("L", "R") or text.upper() not in ("L", "R", "LEFT", "RIGHT"):
        raise InputError(f"side: expected left or right, found {text!r}")
    return letter


_PARTS = {"source": Source, "detector": Detector, "beam": Beam, "scatter": Scatter, "refraction": Refraction}


class Scene(_Part):
    """Everything that one picture depends on. Lengths are mm, in one frame; scene files (docs/reference/scene-files.md) hold the same.

    samples: a Sample or several; a Mesh counts as one whose regions are those of `materials`
    materials: of the regions: {1: Material(...), ...}, a list of those of regions 1, 2, ..., or a table's name or file; a number is a
        linear attenuation, 1/mm, a word what the material is made of
    source, detector, beam, scatter, refraction: Source, Detector, Beam, Scatter, Refraction. Without source and detector's origin
        both are placed around the samples: the source before them, looking along +y, rows of the picture downwards along -z
    """

    samples: list[Sample]
    materials: Union[str, dict[int, Material], None]
    source: Source
    detector: Detector
    beam: Beam
    scatter: Scatter
    refraction: Refraction

    def __init__(self, samples: Any = (), *, materials: Optional[Materials] = None, source: Optional[Source] = None,
                 detector: Optional[Detector] = None, beam: Optional[Beam] = None, scatter: Optional[Scatter] = None,
                 refraction: Optional[Refraction] = None, **fields: Any) -> None:
        for name, value in {"samples": samples, "materials": materials, "source": source, "detector": detector, "beam": beam,
                            "scatter": scatter, "refraction": refraction, **fields}.items():
            setattr(self, name, value)
        self._made: Any = None
        self._unit: Optional[dict[str, Any]] = None  # what place_unit says of a mammogram

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _PARTS:
            kind = _PARTS[name]
            if value is None:
                value = kind()
            elif not isinstance(value, kind):
                value = made_from(kind, value, name)
            object.__setattr__(self, name, value)
        elif name == "samples":
            several = list(value) if isinstance(value, (list, tuple)) else [value]
            object.__setattr__(self, name, [each if isinstance(each, Sample) else Sample(each) for each in several])
        elif name == "materials":
            kept = value if value is None or isinstance(value, str) else materials_of(value)
            object.__setattr__(self, name, kept)
        else:
            super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        if name in self._declared:  # not set
            return None
        raise AttributeError(f"Scene: no field '{name}'; {suggestion(name, self._names())}")

    def _names(self) -> list[str]:
        return ["samples", "materials", *_PARTS, *self._declared]

    def __repr__(self) -> str:
        given = [*(f"{name}={getattr(self, name)!r}" for name in _PARTS if getattr(self, name)._all()),
                 *(f"{name}={getattr(self, name)!r}" for name in self._declared if getattr(self, name) is not None)]
        return f"Scene({', '.join([repr(self.samples), f'materials={self.materials!r}', *given])})"

    def _table(self) -> tuple[list[Any], list[str]]:
        """The setting of the materials, and each sample's material."""
        known = dict(self.materials) if isinstance(self.materials, dict) else {}
        texts = []
        for index, sample in enumerate(self.samples):
            material = sample.material
            if material is None:
                if isinstance(self.materials, dict):
                    self._check_regions(sample.mesh, known)
                texts.append("")
            elif isinstance(material, str):
                texts.append(material)
            elif material.name or material.iodine:
                place = f"samples[{index}].material"
                if isinstance(self.materials, str):
                    raise InputError(f"{place}: expected no name or iodine beside a table's name, found some")
                same = [region for region, other in known.items() if other == material]
                region = same[0] if same else max(known, default=0) + 1
                known[region] = material
                texts.append(material.name or f"region {region}")
            else:
                density = density_of(material, f"samples[{index}].material")
                text = material._text(f"samples[{index}].material")
                texts.append(text if density is None or text.endswith("/mm") else f"{text}@{density!r}")
        if isinstance(self.materials, str):
            return [("materials", "materials", (self.materials,))], texts
        if not known:
            return [], texts
        entries = [{"name": "air", "labels": [0]}]
        for region in range(1, max(known) + 1):
            used = known[region] if region in known and known[region].attenuation is not None else Material(1.0)
            entries.append({**used._entry(f"materials[{region}]", region), "unusual": True})
        return [("materials", "materials", (json.dumps({"materials": entries}),))], texts

    @staticmethod
    def _check_regions(mesh: Mesh, known: Mapping[int, Material]) -> None:
        imaged = {region for region, material in known.items() if material.attenuation is not None}
        missing = sorted(mesh._used - imaged)
        if missing:
            raise InputError(f"materials: region {missing[0]} of the mesh has no attenuation; regions "
                             f"{', '.join(map(str, sorted(imaged)))} have one")

    def _settings(self) -> tuple[tuple[Any, ...], list[str]]:
        table, texts = self._table()
        parts = [setting for name in _PARTS for setting in getattr(self, name)._all()]
        return (*table, *self._all(), *parts), texts

    def _native(self, is_placed: bool = True) -> Any:
        """The scene as the core has it, made anew only where more than a place has changed."""
        if not self.samples:
            raise InputError("samples: expected one at least, found none")
        if is_placed:
            self._check_places()
        settings, texts = self._settings()
        key = (settings, texts, [sample.mesh._native for sample in self.samples])
        if self._made is None or self._made[0] != key:
            self._made = None
            # Without a named table the numbers of regions decide.
            named = isinstance(self.materials, str)
            native = _xray.Scene(settings, [(f"samples[{index}]", sample.mesh._native, text, sample.mesh.names if named else ())
                                            for index, (sample, text) in enumerate(zip(self.samples, texts))])
            for note in native.notes:
                warn(note)
            self._made = (key, native)
        native = self._made[1]
        native.place([(sample.axis, sample.angle, sample.translation) for sample in self.samples])
        return native

    def _check_places(self) -> None:
        source = self.source.position is not None or self.source.beam_direction is not None
        if source and self.detector.origin is None:
            raise InputError("detector.origin: expected beside a source, found none")
        if not source and self.detector.origin is not None:
            raise InputError("source.position: expected beside detector.origin, found none")
        if not source and self.detector.pixel_spacing is not None:
            raise InputError("detector.pixel_spacing: expected an origin beside it, found none")

    def expose(self, projector: Optional[Projector] = None, progress: Optional[Progress] = None) -> Exposure:
        """A picture. `projector`: the device to use; default: one that this thread keeps, so that a further picture repeats only what
        has changed. `progress` is called with what is done, from 0 to 1, and a word for it; what it raises stops the work.

        Raises InputError, which names the field; DeviceError without a Vulkan device; KeyboardInterrupt on Ctrl-C. Warns
        (RuntimeWarning) of surfaces that leak and of an empty picture."""
        if not isinstance(projector, (Projector, type(None))):
            raise InputError(f"projector: expected a Projector, found {projector!r}")
        return (projector or _shared()).expose(self, progress)

    def place_unit(self, orientation: str = "LPS", *, thickness: float = 50.0, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0,
                   lateral: float = 0.0, anterior: float = 0.0, vertical: float = 0.0, tilt: float = 0.0,
                   source_to_detector: float = 650.0, support_height: float = 2.0, anchor: Optional[ArrayLike] = None,
                   side: Optional[str] = None) -> Placement:
        """Gives source and detector the places of a mammography unit around a breast, mm and degrees.

        orientation: directions of +x, +y, +z in the patient: a letter each of L/R, A/P, S/I
        thickness: between the faces of support and paddle; support_height: of the support's face over the receptor
        roll: 0 is CC, positive turns the source to the patient's left; pitch: to the front; yaw: about the line to the source
        lateral, anterior, vertical: shifts of the unit along its x, y and z
        anchor: the point that all this refers to; default: middle of the mesh at the chest wall
        side: "left" or "right", for DICOM; a right breast hangs with its chest wall at the right, so that the picture is turned
        """
        right = side is not None and _side(side) == "R"
        native = self._native(False)
        place = None if anchor is None else three(anchor, "anchor")
        pose = [number(value, name) for name, value in (
            ("thickness", thickness), ("roll", roll), ("pitch", pitch), ("yaw", yaw), ("lateral", lateral), ("anterior", anterior),
            ("vertical", vertical), ("tilt", tilt))]
        unit = Placement(*map(numpy.array, native.place_unit(orientation, place, number(source_to_detector, "source_to_detector"),
                                                             number(support_height, "support_height"), pose)))
        columns, rows = self.detector.columns or 720, self.detector.rows or 1080
        placed = unit.detector(columns, rows, self.detector.pixel_spacing or 0.1)
        for name in ("origin", "column_direction", "row_direction", "columns", "rows", "pixel_spacing"):
            setattr(self.detector, name, getattr(placed, name))
        if right:
            columns_mm, rows_mm = ((count - 1) * placed.pixel_spacing for count in (columns, rows))
            self.detector.origin = numpy.asarray(placed.origin) + columns_mm * unit.y - rows_mm * unit.x
            self.detector.column_direction, self.detector.row_direction = -unit.y, unit.x
        self._unit = {"orientation": orientation, "side": side, "distances": (float(thickness), float(source_to_detector - support_height))}
        self.source.position = unit.source(source_to_detector).position
        self.source.beam_direction = None
        if self.scatter.air_gap is None and self.scatter.method == "kernels":
            self.scatter.air_gap = support_height
        return unit

    def check(self) -> list[str]:
        """Lists the faults of its picture, a sentence each: surfaces that leak, samples that are not seen whole, parts that overlap and
        count twice (overlap_priority mends it). Makes an exposure; parts are searched on the host."""
        native = self._native()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            exposed = _shared().expose(self)
        return [line for text in native.check(exposed._native) for line in text.splitlines()]

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes a scene file, and meshes that are not what a file holds beside it. `mammoray project --scene` makes the same picture."""
        path = os.fspath(path)
        settings, texts = self._settings()
        described = json.loads(_xray.describe(settings))
        native = self._native()
        if self.source.position is None and self.source.beam_direction is None:
            described.setdefault("source", {})["position"] = list(native.source[1])
            origin, column, row, columns, rows = native.detector
            described.setdefault("detector", {}).update({
                "origin": origin, "column-direction": column, "row-direction": row, "columns": columns, "rows": rows,
                "pixel-spacing": float(numpy.linalg.norm(column))})
        described["samples"] = [self._sample_entry(sample, text, f"{os.path.splitext(path)[0]}-{index}")
                                for index, (sample, text) in enumerate(zip(self.samples, texts))]
        _write(path, json.dumps(described, indent=2) + "\n")

    @staticmethod
    def _sample_entry(sample: Sample, material: str, stem: str) -> dict[str, Any]:
        mesh = sample.mesh
        entry: dict[str, Any] = {"file": mesh.file or os.path.abspath(write_mesh(mesh, stem))}
        if mesh.file and mesh._unit:
            entry["unit"] = mesh._unit
        if material:
            entry["material"] = material
        if sample.angle:
            entry["rotation"] = {"axis": list(sample.axis), "angle": sample.angle}
        if any(sample.translation):
            entry["translation"] = list(sample.translation)
        return entry


def load_scene(path: Union[str, os.PathLike[str]]) -> Scene:
    """Reads a scene file (docs/reference/scene-files.md) with its meshes. Raises InputError, which names the place in the file. Where
    it has neither source nor detector, place_unit gives them the places that `mammoray project` would."""
    path = os.fspath(path)
    described = json.loads(_xray.read_scene(path))
    scene = Scene()
    samples = []
    if "mesh" in described:
        samples.append(Sample(read_mesh(described.pop("mesh"), described.pop("mesh-unit", None))))
    for entry in described.pop("samples", []):
        turn = entry.get("rotation", {"axis": (0, 0, 1), "angle": 0})
        samples.append(Sample(read_mesh(entry["file"], entry.get("unit")), entry.get("material"), turn["axis"], turn["angle"],
                              entry.get("translation", (0, 0, 0))))
    scene.samples = samples
    table = described.pop("materials", None)
    if isinstance(table, dict):
        table = {region: _material_of_entry(entry) for region, entry in enumerate(table["materials"]) if region > 0}
    scene.materials = table

    def take(part: Any, prefix: str, values: Mapping[str, Any]) -> None:
        for name, value in values.items():
            key = f"{prefix}{name}"
            if key not in _QUANTITIES:
                take(part or getattr(scene, name), key + ".", value)
            else:
                holder = part or scene
                setattr(holder, _field_of(key, holder._prefix), value)
    take(None, "", described)
    return scene


def _material_of_entry(entry: Mapping[str, Any]) -> Material:
    names = {"density_g_per_cm3": "density", "iodine_mg_per_ml": "iodine", "youngs_modulus_kpa": "youngs_modulus", "held": "fixed"}
    fields = {names.get(key, key): value for key, value in entry.items() if key not in ("labels", "thin", "unusual")}
    if isinstance(fields.get("attenuation"), dict):
        fields["attenuation"] = " ".join(f"{name}:{share}" for name, share in fields["attenuation"].items())
    return Material(**fields)


@dataclasses.dataclass(frozen=True)
class Dose:
    """The dose that photons leave in the samples.

    photons: how many were followed
    air_kerma: before the samples, without backscatter, of detector.photons, mGy; 0 without them; height: over the detector, mm
    mass: by material, g; per_air_kerma: mean dose, mGy per mGy; error: its standard error
    """
    photons: int
    height: float
    air_kerma: float
    mass: dict[str, float]
    per_air_kerma: dict[str, float]
    error: dict[str, float]


class Exposure:
    """A picture as the detector sees it. The first index is the row, the second the column."""

    def __init__(self, native: Any, unit: Optional[dict[str, Any]] = None) -> None:
        self._native = native
        self._unit = unit

    @property
    def transmission(self) -> Floats:
        """I / I0; with noise it may exceed 1."""
        return self._native.transmission

    @property
    def log_attenuation(self) -> Floats:
        """-ln(I / I0)."""
        return self._native.log_attenuation

    @property
    def path_lengths(self) -> Floats:
        """materials x rows x columns, mm, in the order of `materials`; those of air are 0."""
        return self._native.path_lengths

    @property
    def materials(self) -> tuple[str, ...]:
        """Names, air first."""
        return tuple(self._native.names)

    @property
    def consistency(self) -> NDArray[numpy.bool_]:
        """True where every ray of the pixel crossed closed surfaces. Elsewhere a mesh leaks, and the neighbours give the value."""
        return self._native.inconsistent == 0

    @property
    def deflection(self) -> Optional[Floats]:
        """2 x rows x columns, angles by which rays are bent along columns and rows, radians; None without refraction."""
        return self._native.deflection

    @property
    def dose(self) -> Optional[Dose]:
        """Where the scene's `dose` asked for it."""
        found = self._native.dose
        if found is None:
            return None
        photons, height, kerma, *columns = found
        return Dose(photons, height, kerma, *(dict(zip(self.materials[1:], column[1:])) for column in columns))

    def display(self) -> Floats:
        """Picture as a mammography unit shows it: 0 (black) to 1, rim evened out, details raised, sigmoid."""
        return self._native.display()

    def derivatives(self, velocities: Union[ArrayLike, Sequence[ArrayLike]]) -> Derivatives:
        """Exact derivatives with parameters that move points: `velocities` is parameters x n x 3, mm per unit of the parameter, in the
        frame of the mesh; a list of these for several samples. Of a point-like or parallel source, without noise, blur, averaged
        samples, scatter and refraction."""
        surfaces = self._native.points
        given = [velocities] if len(surfaces) == 1 else list(velocities)  # type: ignore[arg-type]
        if len(given) != len(surfaces):
            raise InputError(f"velocities: expected those of {len(surfaces)} samples, found {len(given)}")
        name = "velocities" if len(surfaces) == 1 else "velocities[{}]"
        arrays = [array_of(each, name.format(index), (None, count, 3)) for index, (each, count) in enumerate(zip(given, surfaces))]
        if len({len(array) for array in arrays}) != 1 or len(arrays[0]) == 0:
            raise InputError("velocities: expected those of one parameter at least, as many of each sample, found "
                             + ", ".join(str(len(array)) for array in arrays))
        lengths, weights = self._native.derivatives(arrays)
        return Derivatives(lengths, numpy.einsum("mrc,fmrc->frc", weights, lengths))

    def backward(self, transmission: Optional[ArrayLike] = None, path_lengths: Optional[ArrayLike] = None) -> Gradient:
        """The gradient of a number, the loss, in reverse mode: given its derivatives with respect to `transmission` (rows x columns),
        `path_lengths` (materials x rows x columns, 1/mm) or both, those with respect to what the picture was made of, for the price of
        about two pictures, however many points there are. For log_attenuation pass `-d / transmission`. Goes through focal spots,
        averaged samples and blur. Without noise, scatter and refraction; the open field is taken for constant."""
        if transmission is None and path_lengths is None:
            raise InputError("backward: expected transmission or path_lengths, found neither")
        shape = self.path_lengths.shape
        given = [None if values is None else array_of(values, name, wanted)
                 for values, name, wanted in ((transmission, "transmission", shape[1:]), (path_lengths, "path_lengths", shape))]
        found = self._native.backward(*given)
        vectors = {name: numpy.array(found[name]) for name in (
            "translation", "rotation", "photons", "source", "origin", "column_step", "row_step")}
        return Gradient(found["points"], attenuation=dict(zip(self.materials, found["attenuation"])), **vectors)

    def save(self, path: Union[str, os.PathLike[str]], what: str = "transmission", *, side: Optional[str] = None,
             orientation: Optional[str] = None, view: str = "", for_processing: bool = False, patient_name: str = "",
             patient_id: str = "") -> None:
        """Writes a picture by its extension: .png (16 bits, 0 to 1), .tif .mha .nrrd (floats), .vti (all). what: "transmission",
        "display", "path lengths" or "deflection" (.mha .nrrd .vti). All but .png needs a copy with VTK.

        A .dcm is a DICOM mammogram For Presentation, which needs a copy with DCMTK. side: "left" or "right"; orientation: directions of
        +x, +y, +z in the patient; both default to what Scene.place_unit was given. view: "CC", "MLO", ...; default: that of the unit's
        angle. for_processing: transmissions, linear. patient_name, patient_id: as DICOM writes them."""
        path = os.fspath(path)
        if what not in ("transmission", "display", "path lengths", "deflection"):
            raise InputError(f"what: expected transmission, display, path lengths or deflection, found {what!r}")
        if what == "deflection" and self.deflection is None:
            raise InputError("what: expected refraction beside deflection, found none")
        if os.path.splitext(path)[1].lower() == ".dcm":
            if what not in ("transmission", "display"):
                raise InputError(f"{path}: expected transmission or display for .dcm, found {what}")
            if not hasattr(_xray, "write_mammogram"):
                raise InputError(f"{path}: expected a copy of mammoray with DCMTK, which writes DICOM, found one without (a wheel has none)")
            unit = self._unit or {}
            side = side or unit.get("side")
            if side is None:
                raise InputError(f"{path}: expected side, left or right, for a DICOM mammogram, found none")
            _xray.write_mammogram(self._native, path, orientation or unit.get("orientation", "LPS"), _side(side), view,
                                  unit.get("distances"), for_processing, what == "display", patient_name, patient_id)
        elif os.path.splitext(path)[1].lower() == ".png":
            if what not in ("transmission", "display"):
                raise InputError(f"{path}: expected .mha, .nrrd or .vti for {what}, found .png")
            _write(path, _png(self.transmission if what == "transmission" else self.display()))
        elif not hasattr(_xray, "write"):
            raise InputError(f"{path}: expected .png, which this copy without VTK writes, found another")
        elif what == "display":
            _xray.write_stack(self.display()[None], *self._native.spacing, path)
        else:
            _xray.write(self._native, path, what)

    def _repr_png_(self) -> bytes:
        return _png(self.transmission)

    def __repr__(self) -> str:
        rows, columns = self.transmission.shape
        return f"<mammoray.Exposure of {columns} x {rows} pixels, {', '.join(self.materials[1:])}>"


@dataclasses.dataclass(frozen=True)
class Derivatives:
    """path_lengths: parameters x materials x rows x columns, mm per unit of the parameter
    log_attenuation: parameters x rows x columns, per unit of the parameter"""
    path_lengths: Floats
    log_attenuation: Floats


@dataclasses.dataclass(frozen=True)
class Gradient:
    """Derivatives of a loss.

    points: of each sample, n x 3, with respect to the points of its mesh, 1/mm
    translation: samples x 3, with respect to Sample.translation, 1/mm
    rotation: samples x 3, with respect to the vector along Sample.axis whose length is Sample.angle, 1/rad
    attenuation: by material, of a relative change of its attenuation at all energies, or of its density
    photons: with respect to the numbers of photons by energy (Beam.weights)
    source: with respect to the place of the source, or the direction of parallel rays
    origin, column_step, row_step: with respect to the detector's place and the steps between its pixels
    """
    points: list[NDArray[numpy.float64]]
    translation: NDArray[numpy.float64]
    rotation: NDArray[numpy.float64]
    attenuation: dict[str, float]
    photons: NDArray[numpy.float64]
    source: NDArray[numpy.float64]
    origin: NDArray[numpy.float64]
    column_step: NDArray[numpy.float64]
    row_step: NDArray[numpy.float64]


def _png(values: Floats) -> bytes:
    """Grey of 16 bits, 0 black and 1 white."""
    rows, columns = values.shape
    grey = numpy.rint(numpy.clip(values, 0, 1) * 65535).astype(">u2")
    lines = numpy.zeros((rows, 1 + 2 * columns), numpy.uint8)  # each begins with its filter: none
    lines[:, 1:] = grey.view(numpy.uint8).reshape(rows, -1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 16, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(lines.tobytes(), 6)) + chunk(b"IEND", b""))


class Projector:
    """A Vulkan device, and what it keeps between pictures: a moved mesh is refitted, another beam traces nothing.

        with mammoray.Projector() as projector:
            for mesh.points in shapes:
                image = projector.expose(scene)

    method: "auto", "ray-tracing" or "rasterisation"; device: part of the wanted device's name. One thread at a time may use it.
    """

    def __init__(self, method: str = "auto", device: str = "") -> None:
        self._native = _xray.Projector(method, device)

    def expose(self, scene: Scene, progress: Optional[Progress] = None) -> Exposure:
        """Does the same as Scene.expose, on this device."""
        return self._expose(scene._native(), None, 0, False, progress, scene._unit)

    def _expose(self, native: Any, view: Any, index: int, air: bool, progress: Optional[Progress],
                unit: Optional[dict[str, Any]] = None) -> Exposure:
        exposed = self._native.expose(native, view, index, air, progress)
        if exposed.warning:
            warn(exposed.warning)
        return Exposure(exposed, unit)

    def close(self) -> None:
        """Gives back what it holds on the device. It opens again when it is used."""
        self._native.close()

    def __enter__(self) -> Projector:
        return self

    def __exit__(self, *failure: Any) -> None:
        self.close()

    @property
    def device(self) -> str:
        """The device that does the work."""
        return str(self._native.device)

    @property
    def method(self) -> str:
        """"ray-tracing" or "rasterisation"."""
        return str(self._native.method)

    @property
    def traces(self) -> int:
        """How often rays have been traced: once for each point of the focal spot and each sample of a pixel."""
        return int(self._native.traces)


_kept = threading.local()


def _shared() -> Projector:
    if not hasattr(_kept, "projector"):
        _kept.projector = Projector()
    projector: Projector = _kept.projector
    return projector


class Series:
    """Projections of one scene: iterate over it for an Exposure each, or take numpy.asarray of it for all transmissions, projections
    x rows x columns. Each picture has noise of its own.

    angles: degrees
    sources: where the source is in the scene's frame (the direction of parallel rays), projections x 3, mm
    detectors: projections x 3 x 3: detector's origin, step of a column and of a row, mm
    axis: a point of the axis and its direction
    axis_columns: at which columns the axis' shadow crosses the first and the last row, for a reconstruction; None along the rows
    """

    def __init__(self, scene: Scene, turns: bool, count: int, span: float, point: Optional[ArrayLike], direction: ArrayLike,
                 projector: Optional[Projector]) -> None:
        self._scene = scene._native()
        self._projector = projector
        self._turns = turns
        views, middle, self.axis_columns = self._scene.views(
            turns, whole(count, "count", 1, 100000), number(span, "span"), None if point is None else three(point, "axis_point"),
            three(direction, "axis"))
        self._views = views
        self.axis = (middle, three(direction, "axis"))
        self.angles = numpy.array([view.angle for view in views])
        self.sources = numpy.array([view.source for view in views])
        self.detectors = numpy.array([view.detector for view in views])

    def __len__(self) -> int:
        return len(self._views)

    def __getitem__(self, index: int) -> Exposure:
        place = operator.index(index)
        place += len(self) if place < 0 else 0
        if not 0 <= place < len(self):
            raise IndexError(f"projection {index} of {len(self)}")
        return self._take(self._views[place], place, False)

    def _take(self, view: Any, index: int, air: bool) -> Exposure:
        return (self._projector or _shared())._expose(self._scene, view, index, air, None)

    def __iter__(self) -> Iterator[Exposure]:
        return (self[index] for index in range(len(self)))

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> NDArray[Any]:
        return _stack(self).astype(dtype or numpy.float32, copy=False)

    def flat_fields(self, count: int) -> Floats:
        """Pictures with nothing in the beam, count x rows x columns, with noise and all else."""
        return _stack(self._take(None, len(self) + index, True) for index in range(whole(count, "count", 1, 100000)))

    def save(self, path: Union[str, os.PathLike[str]], flat_fields: int = 0) -> None:
        """Writes a stack of transmissions (.tif .mha .nrrd), with flat fields into NAME_flat beside it, and NAME.json with angles,
        places and axis, as `mammoray project --turn` does. Needs a copy with VTK."""
        if not hasattr(_xray, "write_stack"):
            raise InputError(f"{os.fspath(path)}: expected a copy with VTK, which writes stacks; numpy.save takes numpy.asarray(series)")
        stem, extension = os.path.splitext(os.fspath(path))
        first = self[0]._native.spacing
        _xray.write_stack(numpy.asarray(self), *first, stem + extension)
        if flat_fields:
            _xray.write_stack(self.flat_fields(flat_fields), *first, f"{stem}_flat{extension}")
        _, _, _, columns, rows = self._scene.detector
        axis: dict[str, Any] = {"point": self.axis[0], "direction": self.axis[1]}
        if self.axis_columns is not None:
            axis["columnInFirstRow"], axis["columnInLastRow"] = self.axis_columns
        place = "source" if self._scene.source[0] else "beamDirection"
        _write(stem + ".json", json.dumps({
            "format": "mammoray-projection-series", "formatVersion": 1, "kind": "turn" if self._turns else "tomosynthesis",
            "lengthUnit": "mm", "columns": columns, "rows": rows, "axis": axis,
            "projections": [{"angleDeg": angle, "detectorOrigin": detector[0], "columnStep": detector[1], "rowStep": detector[2],
                             place: source}
                            for angle, source, detector in zip(self.angles.tolist(), self.sources.tolist(), self.detectors.tolist())],
        }, indent=1) + "\n")


def _stack(exposures: Iterable[Exposure]) -> Floats:
    return numpy.stack([exposure.transmission for exposure in exposures])


def turn(scene: Scene, count: int, span: float = 360.0, axis: Union[str, ArrayLike] = "z", axis_point: Optional[ArrayLike] = None,
         projector: Optional[Projector] = None) -> Series:
    """Tomography: the samples turn about an axis before source and detector that stand still, right-handed; projection i at i / count
    of the span, degrees. axis: "x", "y", "z" or a direction; axis_point: a point of it, mm, default: middle of the samples."""
    named = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
    if isinstance(axis, str):
        if axis not in named:
            raise InputError(f"axis: expected x, y, z or three numbers, found {axis!r}")
        axis = named[axis]
    return Series(scene, True, count, span, axis_point, axis, projector)


def tomosynthesis(scene: Scene, count: int, span: float = 50.0, pivot_height: float = 0.0, projector: Optional[Projector] = None) -> Series:
    """The source moves over an arc above samples and detector that stand still, from -span/2 to span/2, degrees, about the line along
    the detector's rows of pixels (along its columns' direction) that lies pivot_height, mm, over the middle of the detector."""
    native = scene._native()
    origin, column, row, _, rows = (numpy.array(value) for value in native.detector)
    normal = numpy.cross(column, row)
    normal *= numpy.sign(normal @ (numpy.array(native.source[1]) - origin)) / numpy.linalg.norm(normal)
    # Right-handed about a mammography unit's y, which its columns follow.
    return Series(scene, False, count, span, origin + 0.5 * (rows - 1) * row + number(pivot_height, "pivot_height") * normal, column,
                  projector)


@dataclasses.dataclass(frozen=True)
class DualEnergy:
    """low, high: the two exposures
    weight: with which the two materials look the same; recombined: high.log_attenuation - weight * low.log_attenuation"""
    low: Exposure
    high: Exposure
    weight: float
    recombined: Floats


def dual_energy(scene: Scene, high: Beam, cancel: tuple[str, str] = ("fat", "gland"), thickness: float = 50.0,
                projector: Optional[Projector] = None) -> DualEnergy:
    """A second exposure with the beam `high`, and weighted logarithmic subtraction with which slabs of the two materials `cancel` (names
    of the scene's materials), `thickness` mm each, look the same."""
    camera = projector or _shared()
    if not isinstance(high, Beam):
        high = made_from(Beam, high, "high")
    if high.kvp is not None and high.tube is None and high.spectrum is None:
        high = dataclasses.replace(high, tube=scene.beam.tube)
    low_native = scene._native()
    other = Scene(scene.samples, materials=scene.materials, **{name: getattr(scene, name) for name in _PARTS if name != "beam"}, beam=high,
                  **{name: getattr(scene, name) for name in scene._declared if getattr(scene, name) is not None})
    first, second = cancel
    weight = low_native.cancelling_weight(other._native(), first, second, number(thickness, "thickness"))
    low = camera.expose(scene)
    taken = camera._expose(other._native(), None, 1, False, None)
    return DualEnergy(low, taken, weight, taken._native.recombine(low._native, weight))


def devices() -> list[dict[str, Any]]:
    """The Vulkan devices of this machine, best first: name, driver, type, ray_tracing."""
    return list(_xray.devices())
