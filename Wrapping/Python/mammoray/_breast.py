# SPDX-License-Identifier: Apache-2.0
"""Arrays in, arrays out, of what needs VTK: meshing, compression, registration."""
from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import tempfile
from collections.abc import Iterator, Sequence
from typing import Any, Callable, Optional, Union

import numpy
from numpy.typing import ArrayLike, NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkIntArray, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkFieldData, vtkImageData, vtkUnstructuredGrid
from vtkmodules.vtkCommonExecutionModel import vtkTrivialProducer

from . import _filters, _xray
from ._errors import InputError
from ._mesh import Mesh
from ._scene import Material, Materials, Placement, density_of, material_table, materials_of
from ._values import array_of, made_from, three, whole, whole_array_of

Progress = Callable[[float], Any]
_TETRAHEDRON = 10
_POSE = ("thickness", "roll", "pitch", "yaw", "lateral", "anterior", "vertical", "tilt")


MeshArrays = Union[Mesh, tuple[ArrayLike, ArrayLike, ArrayLike]]


@dataclasses.dataclass(frozen=True)
class LabelVolume:
    """A label for each voxel.

    labels: k x j x i, whole numbers from 0 to 65535, the last index along x
    spacing: of the voxels along x, y, z, mm
    origin: centre of voxel [0, 0, 0], mm
    direction: 3 x 3, whose columns are the unit vectors of i, j and k; default: the axes
    """
    labels: ArrayLike
    spacing: ArrayLike
    origin: ArrayLike = (0.0, 0.0, 0.0)
    direction: Optional[ArrayLike] = None


@dataclasses.dataclass(frozen=True)
class CompressionGradient:
    """Derivatives of a loss.

    stiffness: m, of a relative change of the Young's modulus of each tetrahedron; none where a coarse mesh carries these
    materials: the same by region, of all its tetrahedra
    pose: thickness, roll, ... by name, with respect to the plates' motion, per mm or degree; source and detector stay
    """
    stiffness: Optional[NDArray[numpy.float64]]
    materials: dict[int, float]
    pose: dict[str, float]


@dataclasses.dataclass(frozen=True)
class Compression:
    """A breast between the plates.

    points: n x 3, mm; displacement: n x 3, from where they were
    contact_pressure: n, of the plates, kPa; 0 where nothing touches
    volume_ratio: m, deformed over undeformed volume of each tetrahedron
    stress: m, von Mises', of the Cauchy stress, kPa; none where a coarse mesh carries this one
    thickness: between the plates, mm; force: of the paddle, N
    placement: where the unit stands, whose source() and detector() a Scene takes
    """
    points: NDArray[numpy.float64]
    displacement: NDArray[numpy.float64]
    contact_pressure: NDArray[numpy.float64]
    volume_ratio: NDArray[numpy.float64]
    stress: Optional[NDArray[numpy.float64]]
    thickness: float
    force: float
    placement: Placement
    _filter: Any = dataclasses.field(default=None, repr=False, compare=False)

    def backward(self, points: ArrayLike) -> CompressionGradient:
        """The gradient of a number, the loss, in reverse mode: given its derivatives with respect to `points` (n x 3, 1/mm), as
        Gradient.points of a picture has them, those with respect to what the equilibrium depends on, by one back-substitution, however
        many tetrahedra there are. The plates stay, also where a force has found them. Not with image_position, where the shape without
        load depends on the stiffness, too."""
        loss = numpy_to_vtk(array_of(points, "points", (len(self.points), 3)), deep=True)
        found = vtkFieldData()
        self._filter.Backward(loss, found)
        cells, materials, pose = (_values(found, name) for name in ("Stiffness", "Materials", "Pose"))
        return CompressionGradient(cells, {region: float(value) for region, value in enumerate(materials) if region > 0},
                                   dict(zip(_POSE, pose.tolist())))


@dataclasses.dataclass(frozen=True)
class Mammogram:
    """A mammogram as an array.

    pixels: rows x columns, from the top row down; not a number where no X-ray was measured
    pixel_spacing: between neighbouring columns, and between rows, at the receptor, mm
    view: "CC", "MLO", "ML", ...; side: "L" or "R"
    row_direction, column_direction: patient directions of a row (increasing column) and of a column (increasing row): "A", "P", "L",
        "R", "FL", ...
    for_processing: whether pixels are unprocessed intensities
    inverted: whether small values are shown bright
    intensity: "linear" or "logarithmic" in X-ray intensity; empty where it is not said
    intensity_sign: 1: larger values mean more X-ray behind the breast, -1: less, 0: not said
    bits: of a stored value
    thickness, angle, source_to_detector, source_to_patient, kilovoltage: as a DICOM header says them, mm, degrees, kV
    """
    pixels: ArrayLike
    pixel_spacing: tuple[float, float]
    view: str = ""
    side: str = ""
    row_direction: str = ""
    column_direction: str = ""
    for_processing: bool = False
    inverted: bool = False
    intensity: str = ""
    intensity_sign: int = 0
    bits: int = 16
    thickness: Optional[float] = None
    angle: Optional[float] = None
    source_to_detector: Optional[float] = None
    source_to_patient: Optional[float] = None
    kilovoltage: Optional[float] = None


@dataclasses.dataclass(frozen=True)
class Registration:
    """Result of a registration.

    points: n x 3, the breast as the mammogram shows it, mm; displacement: n x 3, from where they were
    tetrahedra: m x 4, rows of points, from 0; regions: m, the material of each
    parameters: by name (thickness, roll, lateral, anterior, ...), mm, degrees, or a factor
    deviations: their standard deviations; not a number where one was not looked for
    covariance: of the parameters in the order of `parameters`; none where it is not known
    sensitivities: of each parameter that was looked for, n x 3, mm per mm or degree, seen from the unit
    placement: where the unit stands
    correlation: of synthetic and real mammogram; tissue_correlation: of the tissue alone, of one breast 0.55 and more
    mean_outline_distance, largest_outline_distance: of their outlines, mm
    force: of the paddle, N
    converged: whether the search ended by itself; stop_reason: why it ended
    trust: "good", "doubtful" or "none"; trust_reasons: what speaks against more, a sentence each
    expected_error: of tissue between the plates, if both are of one breast, mm: half of it lies within the first, 95 % within the
        second; none where it is not known
    tissue: what it was taken from, "labels" or "mesh" (`inputs` of a result.json name the labels or the MRI that was segmented)
    """
    points: NDArray[numpy.float64]
    displacement: NDArray[numpy.float64]
    tetrahedra: NDArray[numpy.int64]
    regions: NDArray[numpy.int32]
    parameters: dict[str, float]
    deviations: dict[str, float]
    covariance: Optional[NDArray[numpy.float64]]
    sensitivities: dict[str, NDArray[numpy.float64]]
    placement: Placement
    correlation: float
    tissue_correlation: float
    mean_outline_distance: float
    largest_outline_distance: float
    force: float
    converged: bool
    stop_reason: str
    trust: str
    trust_reasons: tuple[str, ...]
    expected_error: Optional[tuple[float, float]]
    tissue: str


def _field(grid: Any, name: str) -> Any:
    return vtk_to_numpy(grid.GetFieldData().GetArray(name)).copy()


def _strings(grid: Any, name: str) -> tuple[str, ...]:
    array = grid.GetFieldData().GetAbstractArray(name)
    return tuple(array.GetValue(index) for index in range(array.GetNumberOfValues()))


def _points(grid: Any) -> NDArray[numpy.float64]:
    return vtk_to_numpy(grid.GetPoints().GetData()).astype(numpy.float64)


def _tetrahedra(grid: Any) -> NDArray[numpy.int64]:
    return vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4).astype(numpy.int64)


def _regions(grid: Any) -> NDArray[numpy.int32]:
    return vtk_to_numpy(grid.GetCellData().GetArray("Material")).astype(numpy.int32)


def _values(data: Any, name: str) -> Any:
    array = data.GetArray(name)
    return None if array is None else vtk_to_numpy(array).copy()


def _placement(grid: Any) -> Placement:
    return Placement(*_field(grid, "Placement").reshape(4, 3))


def _grid(points: ArrayLike, tetrahedra: ArrayLike, regions: ArrayLike, what: str = "") -> Any:
    points = array_of(points, f"{what}points", (None, 3))
    corners = whole_array_of(tetrahedra, f"{what}tetrahedra", (None, 4), len(points) - 1)
    materials = whole_array_of(regions, f"{what}regions", (len(corners),), 65535)
    places = vtkPoints()
    places.SetData(numpy_to_vtk(numpy.ascontiguousarray(points), deep=True))
    cells = vtkCellArray()
    cells.SetData(4, numpy_to_vtkIdTypeArray(numpy.ascontiguousarray(corners, dtype=numpy.int64).ravel(), deep=True))
    grid = vtkUnstructuredGrid()
    grid.SetPoints(places)
    grid.SetCells(_TETRAHEDRON, cells)
    array = numpy_to_vtk(numpy.ascontiguousarray(materials, dtype=numpy.int32), deep=True)
    array.SetName("Material")
    grid.GetCellData().AddArray(array)
    return grid


def _mesh_grid(mesh: MeshArrays, name: str) -> Any:
    arrays = (mesh.points, mesh.cells, mesh.regions) if isinstance(mesh, Mesh) else mesh
    if not isinstance(arrays, (tuple, list)) or len(arrays) != 3:
        raise InputError(f"{name}: expected a Mesh or its points, tetrahedra and regions, found {type(mesh).__name__}")
    return _grid(*arrays, f"{name}: ")


def _label_image(volume: LabelVolume, what: str = "") -> Any:
    voxels = whole_array_of(volume.labels, f"{what}labels", (None, None, None), 65535)
    image = vtkImageData()
    image.SetDimensions(*reversed(voxels.shape))
    image.SetSpacing(*three(volume.spacing, f"{what}spacing"))
    image.SetOrigin(*three(volume.origin, f"{what}origin"))
    if volume.direction is not None:
        image.SetDirectionMatrix(array_of(volume.direction, f"{what}direction", (3, 3)).ravel().tolist())
    image.GetPointData().SetScalars(numpy_to_vtk(numpy.ascontiguousarray(voxels, dtype=numpy.uint16).ravel(), deep=True))
    return image


def _told(algorithm: Any, progress: Optional[Progress]) -> Any:
    if progress is not None:
        algorithm.AddObserver("ProgressEvent", lambda caller, event: progress(caller.GetProgress()))
    return algorithm


@contextlib.contextmanager
def _table_of(materials: Optional[Materials], imaged: bool = True) -> Iterator[str]:
    """The name of a table, or a file with these materials for as long as it is needed. imaged: whether attenuations count."""
    if materials is None or isinstance(materials, str):
        yield materials or ""
        return
    known = materials_of(materials)
    if sorted(known) != list(range(1, len(known) + 1)):
        raise InputError(f"materials: expected regions 1, 2, ... without a gap, found {sorted(known)}")
    entries: list[dict[str, Any]] = [{"name": "air", "labels": [0]}]
    for region, material in sorted(known.items()):
        if not imaged:  # every table says an attenuation
            material = dataclasses.replace(material, attenuation="Water, Liquid")
        entries.append(material._entry(f"materials[{region}]", region))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "materials.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"name": "materials", "materials": entries}, file)
        yield path


def mesh(labels: ArrayLike, spacing: ArrayLike, *, origin: ArrayLike = (0.0, 0.0, 0.0), direction: Optional[ArrayLike] = None,
         materials: Optional[Materials] = None, cell_size: float = 4.0, label_spacing: float = 0.0, triangles: int = 0, for_mechanics: bool = False,
         progress: Optional[Progress] = None) -> Mesh:
    """Labels to tetrahedra with a material each. Lengths are mm.

    labels: k x j x i, whole numbers from 0 to 65535, the last index along x
    spacing: of the voxels along x, y, z
    origin: centre of voxel [0, 0, 0]
    direction: 3 x 3, whose columns are the unit vectors of i, j and k; default: the axes
    materials: a table's name or file, which says what each label is made of; or Materials of labels 1, 2, ...; default: labels are
        regions, none of which is fixed
    cell_size: largest circumradius of the cells; 0 with for_mechanics: by the size of the breast
    label_spacing: voxel size to which finer labels are resampled first; 0 keeps them
    triangles: number of triangles between materials to end with, within 10 %; 0 takes the sizes as they are
    for_mechanics: a coarse mesh for compress and register, which follows skin and fixed tissue only
    progress: called with what is done, from 0 to 1

    Gives a Mesh, in the frame of origin and direction. Raises Error in one line, KeyboardInterrupt on Ctrl-C.
    """
    image = _label_image(LabelVolume(labels, spacing, origin, direction))
    if not 0 <= label_spacing < float("inf"):
        raise InputError(f"label_spacing: expected a number of mm of at least 0, found {label_spacing}")
    with _table_of(materials, imaged=False) as table:
        mesher = _told(_filters.vtkBreastMesher(MaterialTable=table, CellSizeMm=cell_size, LabelSpacingMm=label_spacing,
                                                NumberOfTriangles=whole(triangles, "triangles", 0, 2**31 - 1),
                                                ForMechanics=for_mechanics), progress)
        mesher.SetInputData(image)
        mesher.Update()
    grid = mesher.GetOutput()
    return Mesh(_points(grid), _tetrahedra(grid), _regions(grid), _strings(grid, "MaterialNames"))


def _one_of(value: str, known: Sequence[str], name: str) -> int:
    if value not in known:
        raise InputError(f"{name}: expected one of {', '.join(known)}, found {value!r}")
    return list(known).index(value)


def compress(points: ArrayLike, tetrahedra: ArrayLike, regions: ArrayLike, *, materials: Materials, thickness: float = 50.0,
             force: float = 0.0, orientation: str = "LPS", roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0,
             lateral: float = 0.0, anterior: float = 0.0, vertical: float = 0.0, tilt: float = 0.0,
             simulation_mesh: Optional[MeshArrays] = None, element: str = "quadratic",
             chest_wall: str = "fixed", wall_stiffness: tuple[float, float] = (1000.0, 1.0), friction: float = 0.0, pull: float = 0.0,
             image_position: str = "none", gravity: bool = False, support_edge: float = 0.0, paddle_edge: float = 0.0,
             edge_radius: float = 3.0, progress: Optional[Progress] = None) -> Compression:
    """Squeezes a breast between the plates of a mammography unit. Lengths are mm, angles degrees, in the frame of the points.

    points: n x 3; tetrahedra: m x 4, rows of points from 0; regions: m, from 1
    materials: a table's name or file; or Materials of the regions, one of which is fixed (the chest wall)
    thickness: between the faces of support and paddle; force: of the paddle, N, whose thickness is found in its place
    orientation: directions of +x, +y, +z in the patient: a letter each of L/R, A/P, S/I
    roll, pitch, yaw, lateral, anterior, vertical, tilt: where the unit stands from the front of the fixed tissue; roll 0 is CC
    simulation_mesh: a coarse one of the same breast, which carries this one along; default: this one up to 20,000 cells
        (150,000 linear ones), beyond that one that is made of it
    element: "quadratic", or "linear" in a tenth of the time, less accurate
    chest_wall: "fixed", "sliding" or "elastic", of wall_stiffness across and along, kPa/mm
    friction: coefficient between breast and plates; pull: force that draws the breast forwards, N
    image_position: "prone" or "supine": unloaded of that weight first, then under the standing patient's; "none": free of load
    gravity: whether the standing patient's weight counts with "none", too
    support_edge, paddle_edge: of the plates, in front of the receptor's; edge_radius: of these edges
    progress: called with what is done, from 0 to 1

    Gives a Compression. Raises Error in one line, also where these plates have no equilibrium; KeyboardInterrupt on Ctrl-C.
    """
    compression = _told(_filters.vtkBreastCompression(
        Orientation=orientation, ThicknessMm=thickness, ForceN=force, RollDeg=roll, PitchDeg=pitch, YawDeg=yaw, LateralMm=lateral,
        AnteriorMm=anterior, VerticalMm=vertical, TiltDeg=tilt, Element=_one_of(element, ("quadratic", "linear"), "element"),
        ChestWall=_one_of(chest_wall, ("fixed", "sliding", "elastic"), "chest_wall"), WallStiffness=wall_stiffness,
        Friction=friction, PullN=pull, ImagePosition=_one_of(image_position, ("none", "prone", "supine"), "image_position"),
        Gravity=gravity, SupportEdgeMm=support_edge, PaddleEdgeMm=paddle_edge, EdgeRadiusMm=edge_radius), progress)
    compression.SetInputData(_grid(points, tetrahedra, regions))
    if simulation_mesh is not None:
        compression.SetInputData(1, _mesh_grid(simulation_mesh, "simulation_mesh"))
    for region, material in (material_table(materials) if isinstance(materials, str) else materials_of(materials)).items():
        compression.SetMaterial(region, material.youngs_modulus, material.poisson_ratio, material.fixed, material.fung_exponent,
                                weighed_density(material, region))
    compression.Update()
    grid = compression.GetOutput()
    return Compression(
        _points(grid), _values(grid.GetPointData(), "Displacement"), _values(grid.GetPointData(), "ContactPressureKPa"),
        _values(grid.GetCellData(), "J"), _values(grid.GetCellData(), "VonMisesStressKPa"), float(_field(grid, "ThicknessMm")[0]),
        float(_field(grid, "PaddleForceN")[0]), _placement(grid), compression)


def weighed_density(material: Material, region: int) -> float:
    """The density by which the material weighs, or 0 where nobody knows it."""
    density = density_of(material, f"materials[{region}]")
    if density is None and isinstance(material.attenuation, str) and material.attenuation:
        return float(_xray.density(material.attenuation))
    return density or 0.0


def _mammogram_image(mammogram: Mammogram) -> Any:
    pixels = numpy.asarray(mammogram.pixels)
    if pixels.ndim != 2 or pixels.dtype.kind not in "iufb":
        raise InputError(f"mammogram.pixels: expected rows x columns numbers, found {' x '.join(map(str, pixels.shape))} {pixels.dtype}")
    spacing = array_of(mammogram.pixel_spacing, "mammogram.pixel_spacing", (2,))
    image = vtkImageData()
    image.SetDimensions(pixels.shape[1], pixels.shape[0], 1)
    image.SetSpacing(float(spacing[0]), float(spacing[1]), 1)
    # VTK's first row is the lowest.
    image.GetPointData().SetScalars(numpy_to_vtk(numpy.ascontiguousarray(pixels[::-1], dtype=numpy.float32).ravel(), deep=True))

    def add(kind: type, name: str, value: Any) -> None:
        if value is not None:
            array = kind()
            array.SetName(name)
            array.InsertNextValue(value)
            image.GetFieldData().AddArray(array)
    for name, text in (("View", mammogram.view), ("Laterality", mammogram.side or "?"), ("RowDirection", mammogram.row_direction),
                       ("ColumnDirection", mammogram.column_direction),
                       ("PresentationIntent", "FOR PROCESSING" if mammogram.for_processing else "FOR PRESENTATION")):
        add(vtkStringArray, name, text)
    relationship = _one_of(mammogram.intensity, ("", "linear", "logarithmic"), "mammogram.intensity")
    for name, number in (("InvertedForDisplay", int(mammogram.inverted)), ("IntensityRelationship", relationship),
                         ("IntensitySign", mammogram.intensity_sign), ("BitsStored", mammogram.bits)):
        add(vtkIntArray, name, number)
    for name, value in (("BodyPartThicknessMm", mammogram.thickness), ("PositionerPrimaryAngleDeg", mammogram.angle),
                        ("SourceToDetectorMm", mammogram.source_to_detector), ("SourceToPatientMm", mammogram.source_to_patient),
                        ("PeakKilovoltage", mammogram.kilovoltage)):
        add(vtkDoubleArray, name, value)
    return image


def register(breast: Union[LabelVolume, MeshArrays], mammogram: Union[str, os.PathLike[str], Mammogram], *,
             materials: Materials, spectrum: str = "W28kVp_Rh50um_Be1mm", orientation: str = "LPS",
             free: Optional[Sequence[str]] = None, thickness: float = 0.0, roll: float = 0.0,
             anterior: float = 5.0, source_to_detector: float = 0.0, edge_radius: float = 8.0,
             simulation_mesh: Optional[MeshArrays] = None,
             pixel_sizes: tuple[float, float] = (3.0, 1.5), iterations: int = 15, device: str = "",
             progress: Optional[Progress] = None) -> Registration:
    """Finds the compression and pose whose synthetic mammogram matches a mammogram. Lengths are mm, angles degrees.

    breast: at rest; a LabelVolume, from which meshes, stiffness and the place of the unit follow as in `mammoray register --labels`;
        or a Mesh, or its arrays as a tuple: points, n x 3; tetrahedra, m x 4, rows of points from 0; regions, m, from 1
    mammogram: a DICOM file, or a Mammogram
    materials: a table's name or file; or Materials of the labels 1, 2, ... or of the regions, one of which is fixed
    spectrum: name or file of a spectrum
    orientation: directions of +x, +y, +z in the patient: a letter each of L/R, A/P, S/I
    free: what is looked for: thickness, roll, pitch, yaw, lateral, anterior, vertical, tilt, stiffness; default: all but the
        vertical place and stiffness
    thickness: where the search begins; 0: the mammogram's, else 50
    roll: beside the nominal one of the mammogram's view; anterior: of the receptor's edge from the chest wall
    source_to_detector: 0: the mammogram's, else 650
    edge_radius: of the plates; wider than a unit's 3, which is what a breast's mechanics can follow
    simulation_mesh: a coarse one of the same breast (mesh with for_mechanics); default: made of `breast`
    pixel_sizes: in which the pictures are compared, first coarse, then fine
    iterations: at each pixel size, at most
    progress: called with what is done, from 0 to 1

    Gives a Registration, in the frame of `breast`. Raises Error in one line, KeyboardInterrupt on Ctrl-C. For many mammograms of
    one breast use vtkBreastRegistration, which keeps meshes and simulation; for a patient's files `mammoray register --study`.
    """
    with _table_of(materials) as table:
        registration = _told(_filters.vtkBreastRegistration(
            MaterialTable=table, Spectrum=spectrum, Orientation=orientation, ThicknessMm=thickness, RollDeg=roll,
            AnteriorMm=anterior, SourceToDetectorMm=source_to_detector, EdgeRadiusMm=edge_radius,
            PixelSizesMm=pixel_sizes, MaximumIterations=iterations, DeviceName=device), progress)
        if free is not None:
            registration.SetFreeParameters(" ".join(free))
        if isinstance(breast, LabelVolume):
            registration.SetInputData(0, _label_image(breast, "breast."))
        else:
            registration.SetInputData(0, _mesh_grid(breast, "breast"))
        if isinstance(mammogram, (str, os.PathLike)):
            reader = _filters.vtkMammogramReader(FileName=os.fspath(mammogram))
            reader.Update()
        else:
            reader = vtkTrivialProducer()
            reader.SetOutput(_mammogram_image(made_from(Mammogram, mammogram, "mammogram")))
        registration.SetMammogramConnection(reader.GetOutputPort())
        if simulation_mesh is not None:
            registration.SetInputData(2, _mesh_grid(simulation_mesh, "simulation_mesh"))
        registration.Update()
    grid = registration.GetOutput()
    names = _strings(grid, "ParameterNames")
    covariance = _field(grid, "Covariance")
    expected = _field(grid, "ExpectedErrorMm").tolist()
    data = grid.GetPointData()
    sensitivities = {name: _values(data, f"Sensitivity_{name}") for name in names if data.GetArray(f"Sensitivity_{name}")}
    return Registration(
        _points(grid), _values(data, "Displacement"), _tetrahedra(grid), _regions(grid),
        dict(zip(names, _field(grid, "Parameters").tolist())),
        dict(zip(names, _field(grid, "ParameterDeviations").tolist())), covariance if covariance.size else None, sensitivities,
        _placement(grid), float(_field(grid, "Correlation")[0]), float(_field(grid, "TissueCorrelation")[0]),
        float(_field(grid, "MeanOutlineDistanceMm")[0]),
        float(_field(grid, "LargestOutlineDistanceMm")[0]), float(_field(grid, "PaddleForceN")[0]),
        bool(_field(grid, "Converged")[0]), _strings(grid, "StopReason")[0], _strings(grid, "Trust")[0],
        _strings(grid, "TrustReasons"), (expected[0], expected[1]) if expected else None,
        "labels" if isinstance(breast, LabelVolume) else "mesh")
