# SPDX-License-Identifier: Apache-2.0
"""Arrays in, X-ray out."""
from __future__ import annotations

import dataclasses
import difflib
import operator
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _xray
from ._errors import InputError


def array_of(values: ArrayLike, name: str, shape: Sequence[Optional[int]], kind: type = float) -> NDArray[Any]:
    """The values as an array of that shape (None: any length), of finite floats or of whole numbers."""
    try:
        array = numpy.asarray(values)
    except ValueError as error:
        raise InputError(f"{name}: expected an array, found rows of different lengths") from error
    wanted = " x ".join("n" if length is None else str(length) for length in shape)
    if array.ndim != len(shape) or any(length not in (None, found) for length, found in zip(shape, array.shape)):
        raise InputError(f"{name}: expected {wanted} values, found {' x '.join(map(str, array.shape)) or 'one number'}")
    if array.dtype.kind not in "iufb":
        raise InputError(f"{name}: expected numbers, found {array.dtype}")
    if kind is float:
        array = array.astype(numpy.float64)
        if not numpy.isfinite(array).all():
            place = tuple(int(index) for index in numpy.argwhere(~numpy.isfinite(array))[0])
            raise InputError(f"{name}[{', '.join(map(str, place))}]: expected a finite number, found {array[place]}")
        return array
    if array.dtype.kind == "f" and not (array == numpy.floor(array)).all():
        place = tuple(int(index) for index in numpy.argwhere(array != numpy.floor(array))[0])
        raise InputError(f"{name}[{', '.join(map(str, place))}]: expected a whole number, found {array[place]}")
    return array


def whole_array_of(values: ArrayLike, name: str, shape: Sequence[Optional[int]], most: int) -> NDArray[Any]:
    """The same, of whole numbers from 0 to `most`."""
    array = array_of(values, name, shape, int)
    wrong = numpy.argwhere((array < 0) | (array > most))
    if len(wrong) > 0:
        place = tuple(int(index) for index in wrong[0])
        raise InputError(f"{name}[{', '.join(map(str, place))}]: expected 0 to {most}, found {array[place]}")
    return array


def three(values: ArrayLike, name: str) -> tuple[float, float, float]:
    """A point or a direction."""
    array = array_of(values, name, (3,))
    return (float(array[0]), float(array[1]), float(array[2]))


def whole(value: Any, name: str, least: int, most: int) -> int:
    """A whole number in a range."""
    try:
        number = operator.index(value)
    except TypeError as error:
        raise InputError(f"{name}: expected a whole number, found {value!r}") from error
    if not least <= number <= most:
        raise InputError(f"{name}: expected {least} to {most}, found {number}")
    return number


def suggestion(name: str, known: Sequence[str]) -> str:
    """What a mistyped name may have meant, for messages."""
    near = difflib.get_close_matches(name, known, n=3)
    return f"did you mean {' or '.join(near)}?" if near else f"known are {', '.join(known)}"


def made_from(kind: type, values: Any, name: str) -> Any:
    """A dataclass from one of its own or from a mapping of its fields."""
    if isinstance(values, kind):
        return values
    if not isinstance(values, Mapping):
        raise InputError(f"{name}: expected a {kind.__name__} or a dict of its fields, found {values!r}")
    fields = {field.name: field for field in dataclasses.fields(kind)}
    for key in values:
        if key not in fields:
            raise InputError(f"{name}: no field '{key}'; {suggestion(str(key), list(fields))}")
    for key, field in fields.items():
        if (key not in values and field.default is dataclasses.MISSING
                and field.default_factory is dataclasses.MISSING):
            raise InputError(f"{name}: expected the field '{key}', found none")
    return kind(**values)


@dataclasses.dataclass(frozen=True)
class Material:
    """What a region is made of.

    attenuation: name of a table ("adipose", "glandular", "muscle", ...), compound ("Water, Liquid"), formula ("H2O") or mass
        fractions ("H:0.112 O:0.888"); or a number, 1/mm, the same at all energies; or one for each energy of the spectrum, 1/mm
    density: g/cm^3. Elements, NIST's compounds and tables have one of their own; formulas and mass fractions need it
    youngs_modulus: at small strain, kPa
    poisson_ratio: [0, 0.5)
    fung_exponent: how fast it stiffens, [0, 50]; 0: neo-Hookean
    fixed: whether it is fixed to the body (chest wall)
    name: for messages
    """
    attenuation: Union[str, float, Sequence[float], None] = None
    density: Optional[float] = None
    youngs_modulus: float = 5.0
    poisson_ratio: float = 0.49
    fung_exponent: float = 0.0
    fixed: bool = False
    name: str = ""


@dataclasses.dataclass(frozen=True)
class Detector:
    """A flat grid of pixels in any pose, in the frame of the mesh, mm.

    origin: centre of the pixel in row 0 and column 0
    column_step, row_step: from a pixel's centre to that of the next column, and of the next row
    columns, rows: numbers of pixels, 1 to 65535
    samples: samples x samples rays per pixel, whose intensities are averaged, 1 to 16
    """
    origin: ArrayLike
    column_step: ArrayLike
    row_step: ArrayLike
    columns: int
    rows: int
    samples: int = 1

    def _native(self) -> Any:
        return _xray.Detector(three(self.origin, "detector.origin"), three(self.column_step, "detector.column_step"),
                              three(self.row_step, "detector.row_step"), whole(self.columns, "detector.columns", 1, 65535),
                              whole(self.rows, "detector.rows", 1, 65535), whole(self.samples, "detector.samples", 1, 16))


@dataclasses.dataclass(frozen=True)
class ParallelBeam:
    """A source of parallel X-rays. direction: in which they travel, any length, in the frame of the mesh."""
    direction: ArrayLike


@dataclasses.dataclass(frozen=True)
class Projection:
    """An X-ray image; the first index of a picture is the row, the second the column.

    transmission: rows x columns, I / I0; with noise it may exceed 1
    log_attenuation: -ln of it
    path_lengths: (1 + regions) x rows x columns, mm, by the number of the region; of region 0, air, all are 0
    consistency: rows x columns, whether every ray of the pixel crossed closed surfaces; elsewhere the mesh leaks and the value is
        estimated from the neighbours
    path_length_derivatives: parameters x (1 + regions) x rows x columns, mm per unit of the parameter; none without velocities
    log_attenuation_derivatives: parameters x rows x columns, per unit of the parameter
    deflection: 2 x rows x columns, angles by which rays are bent along the detector's columns and rows, radians; none without
        refraction
    names: of a scene's regions, air first
    """
    transmission: NDArray[numpy.float32]
    log_attenuation: NDArray[numpy.float32]
    path_lengths: NDArray[numpy.float32]
    consistency: NDArray[numpy.bool_]
    path_length_derivatives: Optional[NDArray[numpy.float32]] = None
    log_attenuation_derivatives: Optional[NDArray[numpy.float32]] = None
    deflection: Optional[NDArray[numpy.float32]] = None
    names: Sequence[str] = ()


Materials = Union[str, Mapping[int, Union[Material, float, str, Mapping[str, Any]]],
                  Sequence[Union[Material, float, str, Mapping[str, Any]]]]
Spectrum = Union[str, float, tuple[ArrayLike, ArrayLike]]


def material_table(path_or_name: str) -> dict[int, Material]:
    """The materials of a table, by the number of the region: a file (.json) or the name of a shipped one ("victre", "segment",
    "ispy1-breast", "duke-fat-gland", "duke-model")."""
    return {region: Material(**entry) for region, entry in enumerate(_xray.materials(path_or_name)) if region > 0}


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
    made = {}
    for region, entry in entries.items():
        if isinstance(entry, (str, int, float, numpy.number)) and not isinstance(entry, bool):
            made[region] = Material(attenuation=entry)
        else:
            made[region] = made_from(Material, entry, f"materials[{region}]")
    return made


def spectrum_of(spectrum: Spectrum) -> tuple[list[float], list[float]]:
    """Energies, keV, and photons."""
    if isinstance(spectrum, str):
        energies, photons = _xray.spectrum(spectrum)
        return list(energies), list(photons)
    if isinstance(spectrum, (int, float, numpy.number)):
        return [float(spectrum)], [1.0]
    try:
        energies_given, photons_given = spectrum
    except (TypeError, ValueError) as error:
        raise InputError("spectrum: expected a name, an energy in keV, or energies and photons") from error
    lines = array_of(energies_given, "spectrum: energies", (None,))
    return lines.tolist(), array_of(photons_given, "spectrum: photons", (len(lines),)).tolist()


def _scene_of(materials: Materials, regions: set[int], spectrum: Spectrum, photon_counting: bool,
              refracted: bool = False) -> Any:
    """A native scene with materials, spectrum and response."""
    energies, photons = spectrum_of(spectrum)
    known = materials_of(materials)
    attenuations = []
    for region in range(1, max(regions, default=0) + 1):
        if region not in regions:
            attenuations.append(("", 0.0, []))
        elif region not in known or known[region].attenuation is None:
            raise InputError(f"materials: region {region} of the mesh has no attenuation; regions "
                             f"{', '.join(str(r) for r, m in sorted(known.items()) if m.attenuation is not None)} have one")
        elif refracted and not isinstance(known[region].attenuation, str):
            raise InputError(f"materials[{region}].attenuation: expected a composition beside refraction, found numbers")
        else:
            attenuations.append(_attenuation(known[region], region, len(energies)))
    return _xray.Scene(energies, photons, bool(photon_counting), attenuations)


def density_of(material: Material, region: int) -> Optional[float]:
    """The density that is stated, if one is."""
    if material.density is None:
        return None
    density = float(array_of([material.density], f"materials[{region}].density", (1,))[0])
    if density <= 0:
        raise InputError(f"materials[{region}].density: expected a positive number, g/cm^3, found {density:g}")
    return density


def _attenuation(material: Material, region: int, energies: int) -> tuple[str, float, list[float]]:
    value: Any = material.attenuation
    if isinstance(value, str):
        density = density_of(material, region)
        return value, 0.0 if density is None else density, []
    name = f"materials[{region}].attenuation"
    if numpy.ndim(value) == 0:
        return "", 0.0, array_of([value], name, (1,)).tolist() * energies
    return "", 0.0, array_of(value, name, (energies,)).tolist()


def _are_flat(points: NDArray[Any], cells: NDArray[Any]) -> bool:
    """Whether most of the cells, each of four points, are no bodies but faces."""
    if len(cells) == 0:
        return False
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    return bool(numpy.median(abs(numpy.linalg.det(edges)) / numpy.maximum(numpy.linalg.norm(edges, axis=2).max(axis=1) ** 3, 1e-300)) < 1e-3)


class Projector:
    """A mesh on a Vulkan device, for more than one image of it: see project, which takes the same arguments."""

    def __init__(self, points: ArrayLike, cells: ArrayLike, regions: Optional[ArrayLike] = None, *, method: str = "auto",
                 device: str = "") -> None:
        points = array_of(points, "points", (None, 3))
        corners = numpy.asarray(cells)
        if corners.ndim != 2 or corners.shape[1] not in (3, 4):
            raise InputError("cells: expected m x 3 triangles or m x 4 tetrahedra, found "
                             f"{' x '.join(map(str, corners.shape)) or 'one number'}")
        corners = whole_array_of(corners, "cells", (None, corners.shape[1]), len(points) - 1)
        triangles = corners.shape[1] == 3
        if not triangles and _are_flat(points, corners):
            raise InputError("cells: expected m x 3 triangles or m x 4 tetrahedra, found m x 4 flat ones: quads? Cut each into two "
                             "triangles, [0, 1, 2] and [0, 2, 3]")
        if regions is None:
            regions = numpy.ones(len(corners), dtype=int)
        sides = numpy.asarray(regions)
        if not triangles or sides.ndim != 2:
            sides = whole_array_of(sides, "regions", (len(corners),), 65535)
            # Behind a triangle; in front of it is air.
            sides = numpy.stack([numpy.zeros_like(sides), sides], axis=1) if triangles else sides[:, None]
        else:
            sides = whole_array_of(sides, "regions", (len(corners), 2), 65535)
        self._used = {int(region) for region in numpy.unique(sides)} - {0}
        self._points = len(points)
        self._native = _xray.Projector(points, corners.astype(numpy.int32), sides.astype(numpy.uint16), method, device)

    @property
    def device(self) -> str:
        """The device that does the work."""
        return self._native.device

    @property
    def method(self) -> str:
        """"ray-tracing" or "rasterisation"."""
        return self._native.method

    def move(self, points: ArrayLike) -> None:
        """New positions of the same points, n x 3, mm; the device refits what it has."""
        self._native.move(array_of(points, "points", (self._points, 3)))

    def project(self, *, materials: Materials, source: Union[ArrayLike, ParallelBeam],
                detector: Union[Detector, Mapping[str, Any]], spectrum: Spectrum = 20.0, photon_counting: bool = False,
                focal_spot: tuple[float, float] = (0.0, 0.0), focal_spot_samples: int = 5, photons_per_pixel: float = 0.0,
                seed: int = 0, refraction: Optional[str] = None, bend_distance: float = 0.0,
                velocities: Optional[ArrayLike] = None) -> Projection:
        """An image of the mesh as it stands; see project."""
        return self._project(materials, source, detector, spectrum, photon_counting, focal_spot, focal_spot_samples,
                             photons_per_pixel, seed, refraction, bend_distance, velocities)

    def _project(self, materials: Materials, source: Any, detector: Any, spectrum: Spectrum, photon_counting: bool, focal_spot: Any,
                 focal_spot_samples: int, photons_per_pixel: float, seed: int, refraction: Optional[str], bend_distance: float,
                 velocities: Optional[ArrayLike]) -> Projection:
        if isinstance(source, ParallelBeam):
            native_source = _xray.Source(True, three(source.direction, "source.direction"))
        else:
            native_source = _xray.Source(False, three(source, "source"))
        native_detector = made_from(Detector, detector, "detector")._native()
        spot = array_of(focal_spot, "focal_spot", (2,))
        exposure = _xray.Exposure((float(spot[0]), float(spot[1])), whole(focal_spot_samples, "focal_spot_samples", 1, 32),
                                  float(array_of([photons_per_pixel], "photons_per_pixel", (1,))[0]),
                                  whole(seed, "seed", 0, 2**64 - 1))
        if velocities is not None:
            velocities = array_of(velocities, "velocities", (None, self._points, 3))
            if len(velocities) == 0:
                raise InputError("velocities: expected those of one parameter at least, found none")
        if refraction is not None:
            if refraction not in ("geometric", "near-field"):
                raise InputError(f"refraction: expected geometric or near-field, found {refraction!r}")
            if photons_per_pixel or spot.any() or velocities is not None:
                raise InputError("refraction: expected no noise, focal spot or velocities beside it, found some")
        scene = _scene_of(materials, self._used, spectrum, photon_counting, refraction is not None)
        scene.source = native_source
        scene.detector = native_detector
        scene.exposure = exposure
        distance = float(array_of([bend_distance], "bend_distance", (1,))[0])
        if refraction is not None:
            scene.refract(refraction, distance)
        return _projection_of(self._native.project(scene, velocities))


def _projection_of(answer: dict[str, Any], stacklevel: int = 4) -> Projection:
    """stacklevel: of a warning, so that it names the line of the user that asked for the projection."""
    if answer["warning"]:
        warnings.warn(answer["warning"], RuntimeWarning, stacklevel=stacklevel)
    changes = answer.get("path_length_derivatives")
    return Projection(
        answer["transmission"], answer["log_attenuation"], answer["path_lengths"], answer["inconsistent"] == 0, changes,
        None if changes is None else numpy.einsum("mrc,fmrc->frc", answer["mean_attenuation"], changes),
        answer.get("deflection"), answer.get("names", ()))


def project_scene(path: str, *, method: str = "auto", device: str = "") -> Projection:
    """X-rays what a scene file (docs/scene.md) describes, byte for byte as `mammoray project --scene` does. The file has samples or a
    mesh, source and detector; regions are numbered as `names` of the answer lists them. Raises as project; not in the projector
    that is installed alone, which reads no surfaces."""
    if not hasattr(_xray, "project_scene"):
        raise InputError("project_scene: expected a mammoray with VTK, which reads surfaces, found the projector alone")
    return _projection_of(_xray.project_scene(str(path), method, device), 3)


def project(points: ArrayLike, triangles: ArrayLike, regions: Optional[ArrayLike] = None, *, materials: Materials,
            source: Union[ArrayLike, ParallelBeam], detector: Union[Detector, Mapping[str, Any]], spectrum: Spectrum = 20.0,
            photon_counting: bool = False, focal_spot: tuple[float, float] = (0.0, 0.0), focal_spot_samples: int = 5,
            photons_per_pixel: float = 0.0, seed: int = 0, refraction: Optional[str] = None, bend_distance: float = 0.0,
            velocities: Optional[ArrayLike] = None, method: str = "auto", device: str = "") -> Projection:
    """X-rays a body of several materials. Lengths are mm, all in the frame of the points.

    points: n x 3
    triangles: m x 3, rows of points from 0, whose surfaces close around each region; or m x 4, tetrahedra
    regions: of triangles m x 2, the regions in front of each and behind it (the front is where its normal
        (p1 - p0) x (p2 - p0) points to), or m, the region behind it with air in front; of tetrahedra m. 0 is air. Default: all 1
    materials: of the regions: {1: Material(...), ...}, a list of those of regions 1, 2, ..., or a table's name or file; a number
        alone is a linear attenuation, 1/mm, a word the name of an attenuation
    source: position, 3 values; or a ParallelBeam
    detector: a Detector, or a dict of its fields
    spectrum: an energy, keV; name ("W28kVp_Rh50um_Be1mm") or file (.spc or a table of two columns) of a spectrum; or energies (keV, ascending) and photons
    photon_counting: whether the detector counts photons instead of adding up their energy
    focal_spot: its edges along the detector's columns and rows; focal_spot_samples^2 points stand for it
    photons_per_pixel: mean number that meets a pixel without the object, which gives quantum noise from `seed`; 0: none
    refraction: "geometric" (each ray carries its intensity to where it goes) or "near-field" (transport of intensity): rays are
        bent where they pass bodies, bend_distance (mm) before the detector; attenuations must be compositions. Without noise,
        focal spot and velocities
    velocities: parameters x n x 3, how the points move with each of some parameters, mm per unit of it: derivatives come along,
        exact, of the image of a point source without noise
    method: "auto", "ray-tracing" or "rasterisation"
    device: part of the wanted Vulkan device's name

    Gives a Projection. Raises InputError on unusable arrays, DeviceError where no Vulkan device can, each in one line; warns
    (RuntimeWarning) of a mesh that leaks and of an empty picture. Sends each X-ray by ray tracing or rasterisation and applies the Beer-Lambert law:
    I / I0 = sum_E w_E exp(-sum_m mu_m(E) L_m). For several images of one mesh use a Projector, which keeps it on the device.
    """
    return Projector(points, triangles, regions, method=method, device=device)._project(
        materials, source, detector, spectrum, photon_counting, focal_spot, focal_spot_samples, photons_per_pixel, seed, refraction,
        bend_distance, velocities)


def cancelling_weight(first: Union[Material, str], second: Union[Material, str], *, low: Spectrum, high: Spectrum,
                      thickness: float = 40.0, photon_counting: bool = False) -> float:
    """The weight w with which two exposures, of spectra `low` and `high`, are recombined to high.log_attenuation - w *
    low.log_attenuation so that slabs of the two materials, `thickness` mm each, look the same (weighted logarithmic subtraction)."""
    scenes = [_scene_of([first, second], {1, 2}, spectrum, photon_counting) for spectrum in (low, high)]
    return float(_xray.cancelling_weight(scenes[0], scenes[1], 1, 2, float(array_of([thickness], "thickness", (1,))[0])))


def recombine(low: Projection, high: Projection, weight: float) -> NDArray[numpy.float32]:
    """high.log_attenuation - weight * low.log_attenuation: what cancelling_weight does not cancel is left of two exposures."""
    if low.log_attenuation.shape != high.log_attenuation.shape:
        raise InputError(f"dual energy: expected pictures of one size, found {low.log_attenuation.shape} and "
                         f"{high.log_attenuation.shape}")
    return high.log_attenuation - numpy.float32(weight) * low.log_attenuation


def devices() -> list[dict[str, Any]]:
    """The Vulkan devices of this machine, best first: name, driver, type, ray_tracing."""
    return list(_xray.devices())
