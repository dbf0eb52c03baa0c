# SPDX-License-Identifier: Apache-2.0
"""Surfaces and tetrahedra, from files, from objects of other packages and from arrays."""
from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Sequence
from typing import Any, Optional, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import _xray
from ._errors import InputError
from ._values import array_of, warn, whole_array_of


class Mesh:
    """Triangles or tetrahedra, with a region each. Lengths are mm.

    points: n x 3. Assign other values to move them: `mesh.points = moved`; the next exposure refits what the device has
    cells: m x 3 triangles, rows of points from 0, whose surfaces close around each region; or m x 4 tetrahedra
    regions: of triangles m x 2, the regions in front of each and behind it (the front is where its normal
        (p1 - p0) x (p2 - p0) points to), or m, the region inside closed surfaces in air; of tetrahedra m. 0 is air. Default: all 1
    names: of regions 0 (air), 1, ..., as a file has them
    file: what it was read from, as long as its points were not moved
    """

    def __init__(self, points: ArrayLike, cells: ArrayLike, regions: Optional[ArrayLike] = None, names: Sequence[str] = ()) -> None:
        places = array_of(points, "points", (None, 3))
        corners = numpy.asarray(cells)
        if corners.ndim != 2 or corners.shape[1] not in (3, 4):
            raise InputError("cells: expected m x 3 triangles or m x 4 tetrahedra, found "
                             f"{' x '.join(map(str, corners.shape)) or 'one number'}")
        corners = whole_array_of(corners, "cells", (None, corners.shape[1]), len(places) - 1)
        triangles = corners.shape[1] == 3
        if not triangles and _are_flat(places, corners):
            raise InputError("cells: expected m x 3 triangles or m x 4 tetrahedra, found m x 4 flat ones: quads? Cut each into two "
                             "triangles, [0, 1, 2] and [0, 2, 3]")
        sides = numpy.ones(len(corners), dtype=int) if regions is None else numpy.asarray(regions)
        if not triangles or sides.ndim != 2:
            sides = whole_array_of(sides, "regions", (len(corners),), 65535)
            self.regions: NDArray[Any] = sides
            if triangles:
                # Behind a triangle; in front of it is air. Closed surfaces may be wound either way.
                a, b, c = (places[corners[:, corner]] - places.mean(axis=0) for corner in range(3)) if len(corners) else (places,) * 3
                if numpy.einsum("ij,ij->", numpy.cross(a, b), c) < 0:
                    corners = corners[:, ::-1]
                sides = numpy.stack([numpy.zeros_like(sides), sides], axis=1)
            else:
                sides = sides[:, None]
        else:
            sides = whole_array_of(sides, "regions", (len(corners), 2), 65535)
            self.regions = sides
        self.cells: NDArray[Any] = corners
        self.names = tuple(names)
        self.file: Optional[str] = None
        self._unit: Optional[str] = None
        self._sides = sides
        self._used = {int(region) for region in numpy.unique(sides)} - {0}
        self._points = places
        self._native = _xray.Surface(places, corners.astype(numpy.int32), sides.astype(numpy.uint16))
        for array in (self._points, self.cells, self.regions, self._sides):
            array.setflags(write=False)

    @property
    def points(self) -> NDArray[numpy.float64]:
        return self._points

    @points.setter
    def points(self, points: ArrayLike) -> None:
        moved = array_of(points, "points", (len(self._points), 3)).copy()
        self._native.move(moved)
        moved.setflags(write=False)
        self._points = moved
        self.file = None

    def __repr__(self) -> str:
        kind = "triangles" if self.cells.shape[1] == 3 else "tetrahedra"
        return f"<mammoray.Mesh of {len(self.points)} points, {len(self.cells)} {kind}{', ' + self.file if self.file else ''}>"


def _are_flat(points: NDArray[Any], cells: NDArray[Any]) -> bool:
    """True if most of the cells, of four points each, are flat: faces, not bodies."""
    if len(cells) == 0:
        return False
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    return bool(numpy.median(abs(numpy.linalg.det(edges)) / numpy.maximum(numpy.linalg.norm(edges, axis=2).max(axis=1) ** 3, 1e-300)) < 1e-3)


def read_mesh(source: Any, unit: Optional[str] = None) -> Mesh:
    """A Mesh of a file or of another package's object.

    source: a file (.stl .ply .obj .vtp .glb .gltf .msh .vtu .vtk; without VTK .stl and what meshio reads); vtkPolyData or
        vtkUnstructuredGrid; a meshio.Mesh; a trimesh.Trimesh; or arrays (points, cells) or (points, cells, regions), as Mesh has them
    unit: of its numbers: "um", "mm", "cm", "m" or "in". Default: mm, of glTF m

    Regions are those of the cell arrays "FrontMaterial" and "BackMaterial" or "Material", of gmsh's physical groups and medit's
    references; 1 without. Raises InputError, which names the file and the place in it.
    """
    mm = None if unit is None else _xray.unit_mm(unit)
    if isinstance(source, (str, os.PathLike)):
        path = os.fspath(source)
        mesh = _read_file(path, mm)
        mesh.file = os.path.abspath(path)
        mesh._unit = unit
        across = float(numpy.ptp(mesh.points, axis=0).max()) if len(mesh.points) else 0.0
        if unit is None and 0 < across < 1:
            warn(f"{path}: {across:.3g} mm across: in metres? unit= names the unit")
        return mesh
    if hasattr(source, "GetClassName"):
        points, cells, regions = _of_vtk(source)
    elif hasattr(source, "vertices") and hasattr(source, "faces"):
        points, cells, regions = source.vertices, source.faces, None
    elif hasattr(source, "points") and hasattr(source, "cells"):
        points, cells, regions = _of_meshio(source)
    elif isinstance(source, (tuple, list)) and len(source) in (2, 3):
        points, cells, regions = (*source, None)[:3]
    else:
        raise InputError("mesh: expected a file, an object of VTK, meshio or trimesh, or (points, cells), found "
                         f"{type(source).__name__}")
    return Mesh(array_of(points, "points", (None, 3)) * (1.0 if mm is None else mm), cells, regions)


def _read_file(path: str, mm: Optional[float]) -> Mesh:
    if hasattr(_xray, "read_mesh"):
        points, cells, regions, names, notes = _xray.read_mesh(path, mm)
        for note in notes:
            warn(note)
        return Mesh(points, cells, regions, names)
    if not os.path.exists(path):
        raise InputError(f"{path}: no such file")
    points, cells, regions = (*_read_stl(path), None) if os.path.splitext(path)[1].lower() == ".stl" else _read_by_meshio(path)
    try:
        return Mesh(array_of(points, "points", (None, 3)) * (1.0 if mm is None else mm), cells, regions)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _read_by_meshio(path: str) -> tuple[Any, Any, Any]:
    try:
        import meshio
    except ImportError:
        raise InputError(f"{path}: expected .stl, or the package meshio for other meshes (pip install meshio), found neither; this copy "
                         "is without VTK") from None
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            read = meshio.read(path)
    except (Exception, SystemExit) as error:  # it exits where no format fits
        raise InputError(f"{path}: meshio cannot read it: {' '.join((said.getvalue() or str(error)).split())}") from None
    return _of_meshio(read)


def _read_stl(path: str) -> tuple[NDArray[numpy.float64], NDArray[Any]]:
    """STL in binary or text; points at the same place become one."""
    try:
        with open(path, "rb") as file:
            content = file.read()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    facet = numpy.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
    count = int.from_bytes(content[80:84], "little")
    if len(content) >= 84 and (len(content) - 84) // 50 == count:
        corners = numpy.frombuffer(content, facet, count, 84)["corners"].reshape(-1, 3).astype(numpy.float64)
    else:
        lines = [line.split() for line in content.decode("ascii", "replace").splitlines()]
        try:
            corners = numpy.array([line[1:4] for line in lines if line[:1] == ["vertex"]], dtype=numpy.float64).reshape(-1, 3)
        except ValueError as error:
            raise InputError(f"{path}: expected three numbers for each vertex of a mesh in STL") from error
        if len(corners) % 3 or not lines or lines[0][:1] != ["solid"]:
            raise InputError(f"{path}: expected a mesh in STL, found {len(content)} bytes of something else")
    if len(corners) == 0:
        raise InputError(f"{path}: expected a mesh in STL, found no triangles")
    points, cells = numpy.unique(corners, axis=0, return_inverse=True)
    return points, cells.reshape(-1, 3)


def _of_vtk(data: Any) -> tuple[Any, Any, Any]:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    if data.IsA("vtkPolyData"):
        triangles = vtkTriangleFilter()
        triangles.PassVertsOff()
        triangles.PassLinesOff()
        triangles.SetInputData(data)
        triangles.Update()
        data = triangles.GetOutput()
        cells, width = data.GetPolys(), 3
    elif data.IsA("vtkUnstructuredGrid"):
        cells, width = data.GetCells(), 4
        if any(data.GetCellType(cell) != 10 for cell in range(data.GetNumberOfCells())):
            raise InputError("mesh: expected a vtkUnstructuredGrid of linear tetrahedra, found other cells")
    else:
        raise InputError(f"mesh: expected vtkPolyData or vtkUnstructuredGrid, found {data.GetClassName()}")
    if data.GetPoints() is None:
        raise InputError("mesh: expected points, found none")

    def values(name: str) -> Any:
        array = data.GetCellData().GetArray(name)
        return None if array is None else vtk_to_numpy(array)
    front, back = values("FrontMaterial"), values("BackMaterial")
    regions = values("Material") if front is None or back is None else numpy.stack([front, back], axis=1)
    return vtk_to_numpy(data.GetPoints().GetData()), vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, width), regions


def _of_meshio(mesh: Any) -> tuple[Any, Any, Any]:
    kinds = [block.type for block in mesh.cells]
    wanted = ("tetra",) if "tetra" in kinds else ("triangle", "quad")
    taken = [index for index, kind in enumerate(kinds) if kind in wanted]
    if not taken:
        raise InputError(f"mesh: expected tetrahedra, triangles or quads, found {', '.join(kinds) or 'no cells'}")
    name = next((known for known in ("Material", "gmsh:physical", "medit:ref") if known in mesh.cell_data), None)
    cells, regions = [], []
    for index in taken:
        corners = numpy.asarray(mesh.cells[index].data)
        labels = numpy.ones(len(corners), int) if name is None else numpy.asarray(mesh.cell_data[name][index])
        if kinds[index] == "quad":
            corners = corners[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
            labels = numpy.repeat(labels, 2)
        cells.append(corners)
        regions.append(labels)
    return mesh.points, numpy.concatenate(cells), numpy.concatenate(regions)


def write_mesh(mesh: Mesh, path: str) -> str:
    """Writes a mesh where what it was read from is not what it is now; gives the path with its extension: .ply of one region in air,
    .vtp of others and .vtu of tetrahedra, doubles as text."""
    if mesh.cells.shape[1] == 3 and mesh._used == {1} and not mesh._sides[:, 0].any():
        head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(mesh.points)}\nproperty double x\nproperty double y\n"
                f"property double z\nelement face {len(mesh.cells)}\nproperty list uchar int vertex_indices\nend_header\n")
        faces = numpy.empty(len(mesh.cells), dtype=[("count", "u1"), ("corners", "<i4", 3)])
        faces["count"] = 3
        faces["corners"] = mesh.cells
        _write(path + ".ply", head.encode() + mesh.points.astype("<f8").tobytes() + faces.tobytes())
        return path + ".ply"

    def array(name: str, kind: str, values: NDArray[Any], components: int = 1) -> str:
        text = " ".join(map(repr, values.ravel().tolist()))
        return f'<DataArray Name="{name}" type="{kind}" NumberOfComponents="{components}" format="ascii">{text}</DataArray>'
    triangles = mesh.cells.shape[1] == 3
    count, width = mesh.cells.shape
    kind, cells, number = ("PolyData", "Polys", "NumberOfPolys") if triangles else ("UnstructuredGrid", "Cells", "NumberOfCells")
    labels = (array("FrontMaterial", "UInt16", mesh._sides[:, 0]) + array("BackMaterial", "UInt16", mesh._sides[:, 1]) if triangles
              else array("Material", "Int32", mesh._sides[:, 0]))
    shapes = "" if triangles else array("types", "UInt8", numpy.full(count, 10))
    text = (f'<VTKFile type="{kind}" version="0.1"><{kind}><Piece NumberOfPoints="{len(mesh.points)}" {number}="{count}">'
            f'<Points>{array("Points", "Float64", mesh.points, 3)}</Points><{cells}>{array("connectivity", "Int64", mesh.cells)}'
            f'{array("offsets", "Int64", width * numpy.arange(1, count + 1))}{shapes}</{cells}><CellData>{labels}</CellData>'
            f"</Piece></{kind}></VTKFile>\n")
    path += ".vtp" if triangles else ".vtu"
    _write(path, text.encode())
    return path


def _write(path: str, content: Union[bytes, str]) -> None:
    """Complete or not at all."""
    staged = path + ".part"
    try:
        with open(staged, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        os.replace(staged, path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error
