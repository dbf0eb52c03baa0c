// SPDX-License-Identifier: Apache-2.0
// X-rays for Python, without VTK unless MAMMORAY_WITH_SCENES is defined. mammoray/_scene.py is what
// users call: it looks at shapes and types before, so that what arrives here fits.
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/SceneIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Display.h"
#include "mammoray/XRay/DualEnergy.h"
#include "mammoray/XRay/Exposer.h"
#include "mammoray/XRay/OverlapMeasure.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/ProjectionSeries.h"
#include "mammoray/XRay/Shadow.h"
#include "mammoray/XRay/Tube.h"
#ifdef MAMMORAY_WITH_SCENES
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ProjectionImage.h"

#include "vtkImageData.h"
#include "vtkUnstructuredGrid.h"
#endif
#ifdef MAMMORAY_WITH_DICOM
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/IO/MammogramSynthesis.h"
#endif
#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/SurfaceMesher.h"
#endif

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace
{
using namespace mammoray;

template <typename Value>
using Array = py::array_t<Value, py::array::c_style | py::array::forcecast>;

template <typename Result, typename Value>
std::vector<Result> Values(const Array<Value>& array)
{
  return { array.data(), array.data() + array.size() };
}

template <typename Value>
py::array_t<Value> ToArray(const std::vector<Value>& values, const std::vector<py::ssize_t>& shape)
{
  return py::array_t<Value>(shape, values.data());
}

/// Reports progress to Python, and asks between pieces of work whether Ctrl-C was pressed.
ProgressCallback Reporting(const py::object& progress)
{
  return [&progress](double fraction, const char* stage)
  {
    const py::gil_scoped_acquire held;
    if (PyErr_CheckSignals() != 0)
    {
      return false;
    }
    if (!progress.is_none())
    {
      try
      {
        progress(fraction, stage);
      }
      catch (py::error_already_set& error)
      {
        error.restore();
        return false;
      }
    }
    return true;
  };
}

/// A surface whose points move, and the points of the mesh that they were taken from.
class MovingSurface
{
public:
  /// `corners`: m x 3 or m x 4; `regions`: m x 2, front and back of triangles, or m x 1, of
  /// tetrahedra.
  MovingSurface(const Array<double>& points, const Array<std::int32_t>& corners,
    const Array<std::uint16_t>& regions)
  {
    SurfaceMesh surface;
    if (corners.shape(1) == 4)
    {
      TetrahedralMesh mesh;
      mesh.Points = Values<double>(points);
      mesh.Cells = Values<std::int32_t>(corners);
      mesh.Materials = Values<std::int32_t>(regions);
      const py::gil_scoped_release released;
      mesh.ValidateIndices("mesh");
      surface = ExtractInterfaces(mesh, &this->PointIds);
    }
    else
    {
      surface.Points = Values<double>(points);
      surface.Triangles = Values<std::uint32_t>(corners);
      for (py::ssize_t triangle = 0; triangle < regions.shape(0); ++triangle)
      {
        surface.FrontMaterials.push_back(regions.at(triangle, 0));
        surface.BackMaterials.push_back(regions.at(triangle, 1));
      }
    }
    surface.Validate("mesh");
    this->Now = std::make_shared<const SurfaceMesh>(std::move(surface));
    this->MeshPoints = points.shape(0);
  }

  void Move(const Array<double>& points)
  {
    auto moved = std::make_shared<SurfaceMesh>(*this->Now);
    moved->Points = this->OfSurface(points.data());
    moved->Validate("mesh");
    this->Now = std::move(moved);
  }

  /// Of all points of the mesh, those of the surface: it has fewer where it was taken from
  /// tetrahedra.
  std::vector<double> OfSurface(const double* values) const
  {
    if (this->PointIds.empty())
    {
      return { values, values + this->Now->Points.size() };
    }
    std::vector<double> chosen;
    chosen.reserve(3 * this->PointIds.size());
    for (const std::int32_t point : this->PointIds)
    {
      const double* const first = values + 3 * static_cast<std::ptrdiff_t>(point);
      chosen.insert(chosen.end(), first, first + 3);
    }
    return chosen;
  }

  /// Values of the surface's points as those of the mesh, n x 3; 0 where it has none.
  py::array_t<double> OfMesh(std::span<const double> values, const Vector3& turnedBack) const
  {
    py::array_t<double> all({ this->MeshPoints, py::ssize_t{ 3 } });
    double* const first = all.mutable_data();
    std::fill(first, first + all.size(), 0.0);
    for (std::size_t point = 0; 3 * point < values.size(); ++point)
    {
      const Vector3 turned =
        Rotated({ values[3 * point], values[3 * point + 1], values[3 * point + 2] }, turnedBack);
      const auto to = this->PointIds.empty() ? static_cast<std::ptrdiff_t>(point)
                                             : static_cast<std::ptrdiff_t>(this->PointIds[point]);
      std::copy(turned.begin(), turned.end(), first + 3 * to);
    }
    return all;
  }

  std::shared_ptr<const SurfaceMesh> Surface() const { return this->Now; }
  /// Of the mesh.
  py::ssize_t NumberOfPoints() const { return this->MeshPoints; }

private:
  py::ssize_t MeshPoints = 0;
  std::shared_ptr<const SurfaceMesh> Now;
  std::vector<std::int32_t> PointIds;
};

/// An exposer that one call at a time uses: others, of a thread or of what progress calls, are
/// refused.
struct SharedExposer : Exposer
{
  using Exposer::Exposer;
  mutable std::atomic_flag IsBusy;
};
class ExposerUse
{
public:
  explicit ExposerUse(const SharedExposer& exposer)
    : Used(exposer)
  {
    if (exposer.IsBusy.test_and_set())
    {
      throw InputError("projector: expected one that is free, found one in use by another thread "
                       "or by the caller of progress");
    }
  }
  ExposerUse(const ExposerUse&) = delete;
  ExposerUse& operator=(const ExposerUse&) = delete;
  ~ExposerUse() { this->Used.IsBusy.clear(); }

private:
  const SharedExposer& Used;
};

/// Name in messages, key of scene files, and texts.
using Setting = std::tuple<std::string, std::string, std::vector<std::string>>;
/// Name in messages, surface, material's text, names of the surface's labels.
using Sample =
  std::tuple<std::string, std::shared_ptr<MovingSurface>, std::string, std::vector<std::string>>;
/// Axis, degrees, translation.
using Placing = std::tuple<Vector3, double, Vector3>;

SceneDescription Describe(const std::vector<Setting>& settings)
{
  SceneDescription description;
  for (const auto& [name, key, values] : settings)
  {
    SetQuantity({ name, key, values }, description);
  }
  return description;
}

/// A scene whose surfaces move and are placed.
class PlacedScene
{
public:
  PlacedScene(const std::vector<Setting>& settings, const std::vector<Sample>& samples)
  {
    const NoteKeeper notes;
    SceneDescription description = Describe(settings);
    for (const auto& [name, surface, material, names] : samples)
    {
      description.Samples.push_back({ .Name = name,
        .Material = material,
        .Surface = surface->Surface(),
        .MaterialNames = names });
      this->Surfaces.push_back(surface);
      this->Shown.push_back(surface->Surface());
    }
    this->HasSource = description.HasSource();
    this->HasDetector = description.HasDetector();
    this->VoxelMm = description.VoxelMm;
    if (!this->HasDetector)
    {
      // A mammography unit's are the default of files.
      int& columns = description.Fixed.Detector.Columns;
      int& rows = description.Fixed.Detector.Rows;
      columns = description.Has("detector.columns") ? columns : 512;
      rows = description.Has("detector.rows") ? rows : 512;
    }
    auto scene = std::make_shared<Scene>(MakeScene(std::move(description)));
    scene->Validate();
    this->Current = std::move(scene);
    this->Notes = notes.Lines();
  }

  /// Brings surfaces where they are now.
  void Place(const std::vector<Placing>& placings)
  {
    std::vector<SceneSample> samples = this->Current->Samples;
    bool isNew = false;
    for (std::size_t index = 0; index < samples.size(); ++index)
    {
      SceneSample& sample = samples[index];
      const auto& [axis, degrees, translation] = placings[index];
      const double length = Norm(axis);
      const Vector3 rotation = (degrees * std::numbers::pi / 180 / length) * axis;
      isNew = isNew || rotation != sample.Rotation || translation != sample.TranslationMm;
      sample.Rotation = rotation;
      sample.TranslationMm = translation;
      const std::shared_ptr<const SurfaceMesh> now = this->Surfaces[index]->Surface();
      if (now != this->Shown[index])
      {
        // Its labels may be others than the mesh's: those of the scene's table.
        auto moved = std::make_shared<SurfaceMesh>(*sample.Surface);
        moved->Points = now->Points;
        sample.Surface = std::move(moved);
        this->Shown[index] = now;
        isNew = true;
      }
    }
    const bool isPlaced = this->HasSource || this->HasDetector;
    if (!isNew && (isPlaced || this->IsAround))
    {
      return;
    }
    auto scene = std::make_shared<Scene>(*this->Current);
    scene->Samples = std::move(samples);
    if (isNew)
    {
      scene->Scatter.Voxels.reset();
    }
    if (!isPlaced)
    {
      // Where it was first: a part that moves would else stand still in its picture.
      if (!this->IsAround)
      {
        PlaceAround(*scene);
      }
      this->IsAround = true;
    }
    this->Current = std::move(scene);
  }

  /// The scene, with voxels where photons are followed through it.
  std::shared_ptr<const Scene> WithVoxels(const std::shared_ptr<const Scene>& scene,
    const ProgressCallback& progress) const
  {
    if (scene->Scatter.Voxels ||
      !(scene->Dose || scene->Scatter.Method == SceneScatter::Model::MonteCarlo))
    {
      return scene;
    }
#ifdef MAMMORAY_HAS_MESHING
    auto with = std::make_shared<Scene>(*scene);
    with->Scatter.Voxels =
      std::make_shared<VoxelScene>(LabelSurfaces(*Assemble(*scene), this->VoxelMm, progress),
        MakePhotonMaterials(scene->Materials));
    return with;
#else
    (void)progress;
    throw InputError("dose, scatter.method: expected a mammoray with Meshing, found one without");
#endif
  }

  /// Places of a unit in the frame of the scene: its origin and axes x, y and z.
  std::array<Vector3, 4> PlaceUnitAround(const std::string& orientation,
    const std::optional<Vector3>& anchor, double sourceToDetectorMm, double supportHeightMm,
    const std::vector<double>& pose) const
  {
    const AnatomicalAxes axes = AnatomicalAxes::FromCode(orientation);
    MammographyUnit unit;
    unit.SourceToDetectorMm = sourceToDetectorMm;
    unit.SupportHeightMm = supportHeightMm;
    const BreastPose placed{ pose.at(0), pose.at(1), pose.at(2), pose.at(3), pose.at(4), pose.at(5),
      pose.at(6), pose.at(7) };
    const Scene& scene = *this->Current;
    const PoseFrame frame = anchor ? PoseFrame{ axes, *anchor }
                                   : FindPoseFrame(*Assemble(scene), scene.Materials.Fixed(), axes);
    const VolumeFromGantry gantry = PlaceUnit(frame, unit, placed);
    return { gantry.Origin, gantry.X, gantry.Y, gantry.Z };
  }

  /// What is wrong with a picture, or nothing; `wantsAll`: all of it should be on the detector.
  static std::string WarningOf(const Scene& scene, const Exposure& exposure, bool wantsAll)
  {
    const std::string holes = exposure.Lengths->InconsistencyWarning();
    return !holes.empty() ? holes : ShadowWarning(scene, exposure, wantsAll);
  }

  std::shared_ptr<const Scene> Current;
  std::vector<std::shared_ptr<MovingSurface>> Surfaces;
  /// What was said while the scene was made.
  std::vector<std::string> Notes;

private:
  std::vector<std::shared_ptr<const SurfaceMesh>> Shown;
  bool HasSource = false;
  bool HasDetector = false;
  bool IsAround = false;
  double VoxelMm = 1;
};

/// An exposure, and what it was made of.
struct ExposedScene
{
  Exposure Picture;
  std::shared_ptr<const Scene> Of;
  std::vector<std::shared_ptr<MovingSurface>> Surfaces;
  std::shared_ptr<SharedExposer> Device;
  std::string Warning;

  /// Velocities of the points of each sample's mesh, fields x points x 3: path lengths, and their
  /// weight in the log attenuation.
  py::tuple Differentiate(const std::vector<Array<double>>& velocities) const
  {
    const auto fields = static_cast<std::size_t>(velocities.front().shape(0));
    const std::vector<SceneSample>& samples = this->Of->Samples;
    std::vector<double> all;
    std::size_t length = 0;
    for (std::size_t field = 0; field < fields; ++field)
    {
      for (std::size_t index = 0; index < samples.size(); ++index)
      {
        std::vector<double> one =
          this->Surfaces[index]->OfSurface(velocities[index].data(static_cast<py::ssize_t>(field)));
        for (std::size_t at = 0; at < one.size(); at += 3)
        {
          const Vector3 turned =
            Rotated({ one[at], one[at + 1], one[at + 2] }, samples[index].Rotation);
          all.insert(all.end(), turned.begin(), turned.end());
        }
      }
      length = field == 0 ? all.size() : length;
    }
    const VectorFields moving(std::move(all), length);
    Exposer::Derivatives derivatives;
    {
      const py::gil_scoped_release released;
      const ExposerUse use(*this->Device);
      derivatives = this->Device->Differentiate(*this->Of, moving);
    }
    const PathLengthDerivatives& lengths = derivatives.Lengths;
    const auto count = static_cast<py::ssize_t>(fields);
    return py::make_tuple(
      ToArray(lengths.Lengths, { count, lengths.Materials, lengths.Rows, lengths.Columns }),
      ToArray(derivatives.MeanAttenuation, { lengths.Materials, lengths.Rows, lengths.Columns }));
  }
};

/// What a loss's derivatives are with respect to the parts of an exposure's scene.
py::dict Backward(const ExposedScene& exposed, const std::optional<Array<float>>& transmission,
  const std::optional<Array<float>>& lengths)
{
  Exposer::Loss loss;
  loss.Transmission = transmission ? Values<float>(*transmission) : std::vector<float>();
  loss.Lengths = lengths ? Values<float>(*lengths) : std::vector<float>();
  Exposer::Gradient gradient;
  {
    const py::gil_scoped_release released;
    const ExposerUse use(*exposed.Device);
    gradient = exposed.Device->Backward(*exposed.Of, loss);
  }
  py::list points;
  std::size_t begin = 0;
  for (std::size_t index = 0; index < exposed.Surfaces.size(); ++index)
  {
    const SceneSample& sample = exposed.Of->Samples[index];
    const std::size_t count = sample.Surface->Points.size();
    points.append(exposed.Surfaces[index]->OfMesh(std::span(gradient.Points).subspan(begin, count),
      -1.0 * sample.Rotation));
    begin += count;
  }
  std::vector<Vector3> translations;
  std::vector<Vector3> rotations;
  for (const Exposer::Gradient::Motion& motion : gradient.Samples)
  {
    translations.push_back(motion.Translation);
    rotations.push_back(motion.Rotation);
  }
  py::dict result;
  result["points"] = points;
  result["translation"] = translations;
  result["rotation"] = rotations;
  result["attenuation"] = gradient.Attenuation;
  result["photons"] = gradient.Spectrum;
  result["source"] = gradient.Source;
  result["origin"] = gradient.Origin;
  result["column_step"] = gradient.ColumnStep;
  result["row_step"] = gradient.RowStep;
  return result;
}

/// A device with what it keeps. Closed, it opens again when it is used.
class Camera
{
public:
  Camera(const std::string& method, std::string device)
    : Options{ .Projection = MethodFromName(method), .Device = std::move(device) }
  {
  }

  SharedExposer& Open()
  {
    if (!this->Device)
    {
      this->Device = std::make_shared<SharedExposer>(this->Options);
    }
    return *this->Device;
  }
  void Close() { this->Device.reset(); }

  /// From elsewhere where there is a view, with noise of the seed plus `number`; `isAir`: nothing
  /// in the beam.
  std::unique_ptr<ExposedScene> Expose(PlacedScene& placed,
    const std::optional<ProjectionView>& view, std::uint64_t number, bool isAir,
    const py::object& progress)
  {
    auto exposed = std::make_unique<ExposedScene>();
    const ProgressCallback report = Reporting(progress);
    this->Open();
    exposed->Device = this->Device;
    const std::shared_ptr<const Scene> before = placed.Current;
    std::shared_ptr<const Scene> with;
    {
      const py::gil_scoped_release released;
      const ExposerUse use(*exposed->Device);
      with = placed.WithVoxels(before, ShareOf(report, 0, 0.1));
      exposed->Of = with;
      if (view || number > 0)
      {
        auto other = std::make_shared<Scene>(*with);
        other->Source = view ? view->Source : other->Source;
        other->Detector = view ? view->Detector : other->Detector;
        other->Detection.Seed += number;
        exposed->Of = std::move(other);
      }
      exposed->Picture = isAir ? Exposer::ExposeAir(*exposed->Of)
                               : exposed->Device->Expose(*exposed->Of, ShareOf(report, 0.1, 1));
    }
    if (placed.Current == before) // not moved by another thread
    {
      placed.Current = with;
    }
    exposed->Surfaces = placed.Surfaces;
    exposed->Warning =
      isAir ? std::string() : PlacedScene::WarningOf(*with, exposed->Picture, false);
    return exposed;
  }

  std::string DeviceName() { return this->Open().DeviceName(); }
  std::string Method() { return MethodName(this->Open().Method()); }
  std::size_t Traces() const { return this->Device ? this->Device->NumberOfTraces() : 0; }

private:
  ProjectorOptions Options;
  std::shared_ptr<SharedExposer> Device;
};

/// Middle of the box around a scene.
Vector3 MiddleOf(const Scene& scene)
{
  const auto box =
    ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, Assemble(scene)->Points);
  return { box[0].Middle(), box[1].Middle(), box[2].Middle() };
}

/// The views of a turning sample, or of a source that moves over the detector; and where the axis'
/// shadow crosses the first and the last row.
py::tuple MakeViews(const PlacedScene& placed, bool isTurn, int number, double spanDeg,
  const std::optional<Vector3>& point, const Vector3& direction)
{
  const Scene& scene = *placed.Current;
  const AxisLine axis{ point ? *point : MiddleOf(scene), direction };
  return py::make_tuple(isTurn ? TurnSample(scene.Source, scene.Detector, axis, number, spanDeg)
                               : SweepSource(scene.Source, scene.Detector, axis, number, spanDeg),
    axis.Point, ShadowOfAxis(scene.Source, scene.Detector, axis));
}

/// What a material table says, as _scene.Material takes it.
py::list Materials(const std::string& pathOrName)
{
  py::list materials;
  for (const Material& material : FindMaterialTable(pathOrName).Materials)
  {
    py::dict entry;
    entry["name"] = material.Name;
    entry["attenuation"] = material.Attenuation;
    entry["density"] = material.DensityGPerCm3;
    entry["iodine"] = material.IodineMgPerMl;
    entry["youngs_modulus"] = material.YoungsModulusKPa;
    entry["poisson_ratio"] = material.PoissonRatio;
    entry["fung_exponent"] = material.FungExponent;
    entry["fixed"] = material.Fixed;
    materials.append(entry);
  }
  return materials;
}

/// The declarations of scene files' keys: key, help, kind of value, number of values, unit,
/// default.
py::list Quantities()
{
  using Kind = SceneQuantity::Kind;
  py::list quantities;
  for (const SceneQuantity& quantity : SceneQuantities())
  {
    py::dict entry;
    entry["key"] = quantity.Key;
    entry["help"] = quantity.Help;
    entry["unit"] = quantity.Unit;
    entry["default"] = quantity.Default;
    entry["words"] = quantity.Words;
    entry["range"] = quantity.IsNumeric()
      ? py::object(py::make_tuple(quantity.Least, quantity.Most))
      : py::object(py::none());
    entry["is_list"] = quantity.Count != 1;
    entry["is_text"] =
      !quantity.IsNumeric() && quantity.Type != Kind::Component && quantity.Type != Kind::Flag;
    entry["by_material"] = quantity.IsByMaterial;
    quantities.append(entry);
  }
  return quantities;
}

py::list Devices()
{
  py::list devices;
  std::string reason;
  for (const DeviceDescription& device : ListDevices(&reason))
  {
    py::dict entry;
    entry["name"] = device.Name;
    entry["driver"] = device.Driver;
    entry["type"] = device.Type;
    entry["ray_tracing"] = device.RayTracing;
    devices.append(entry);
  }
  return devices;
}

#ifdef MAMMORAY_WITH_SCENES
/// Points, corners, regions (m x 2, or m of tetrahedra) and names of a mesh, mm; and notes.
py::tuple ReadMeshFile(const std::string& path, const std::optional<double>& unitMm)
{
  const NoteKeeper notes;
  MeshOrSurface read;
  SurfaceMesh& surface = read.Surface;
  std::vector<std::string>& names = read.MaterialNames;
  TetrahedralMesh mesh;
  {
    const py::gil_scoped_release released;
    read = ReadMeshOrSurface(path);
    if (read.Volume)
    {
      mesh = FromGrid(read.Volume, &names);
      surface.Points = std::move(mesh.Points);
    }
    ScaleSurface(path, unitMm, path, surface);
  }
  const auto points =
    ToArray(surface.Points, { static_cast<py::ssize_t>(surface.NumberOfPoints()), 3 });
  if (!mesh.Cells.empty())
  {
    const auto count = static_cast<py::ssize_t>(mesh.NumberOfCells());
    return py::make_tuple(points, ToArray(mesh.Cells, { count, 4 }),
      ToArray(mesh.Materials, { count }), names, notes.Lines());
  }
  const auto count = static_cast<py::ssize_t>(surface.NumberOfTriangles());
  Array<std::uint16_t> sides({ count, py::ssize_t{ 2 } });
  for (py::ssize_t triangle = 0; triangle < count; ++triangle)
  {
    sides.mutable_at(triangle, 0) = surface.FrontMaterials[static_cast<std::size_t>(triangle)];
    sides.mutable_at(triangle, 1) = surface.BackMaterials[static_cast<std::size_t>(triangle)];
  }
  return py::make_tuple(points, ToArray(surface.Triangles, { count, 3 }), sides, names,
    notes.Lines());
}

/// Writes a picture; a file of path lengths, or of deflections, where `what` says so.
void WriteExposure(const ExposedScene& exposed, const std::string& path, const std::string& what)
{
  const XRayDetector& detector = exposed.Of->Detector;
  const py::gil_scoped_release released;
  WriteProjection(what == "deflection"
      ? ToDeflectionImage(exposed.Picture, detector)
      : ToImage(exposed.Picture, detector, exposed.Of->Materials.Names()),
    path, what == "path lengths");
}

void WriteStack(const Array<float>& values, double columnMm, double rowMm, const std::string& path)
{
  WriteProjectionStack({ .Columns = static_cast<int>(values.shape(2)),
                         .Rows = static_cast<int>(values.shape(1)),
                         .Number = static_cast<int>(values.shape(0)),
                         .ColumnSpacingMm = columnMm,
                         .RowSpacingMm = rowMm,
                         .Values = Values<float>(values) },
    path);
}
#endif

#ifdef MAMMORAY_WITH_DICOM
/// Writes a mammogram. `distances`: thickness of the breast, and from the source to it; or none.
void WriteMammogramOf(const ExposedScene& exposed, const std::string& path,
  const std::string& orientation, char side, const std::string& view,
  const std::optional<std::pair<double, double>>& distances, bool forProcessing, bool display,
  const std::string& patientName, const std::string& patientId)
{
  const py::gil_scoped_release released;
  CheckDicomText(patientName, "patient_name");
  CheckDicomText(patientId, "patient_id");
  SceneMammogram mammogram{ .Axes = AnatomicalAxes::FromCode(orientation),
    .Laterality = side,
    .View = view,
    .ForProcessing = forProcessing,
    .Display = display };
  if (distances)
  {
    mammogram.ThicknessMm = distances->first;
    mammogram.SourceToPatientMm = distances->second;
  }
  DicomMammogramOptions options;
  options.Identity.PatientName = patientName;
  options.Identity.PatientId = patientId;
  options.Derivation = SyntheticDerivation(forProcessing, "a breast");
  WriteMammogram(MakeMammogram(exposed.Picture, *exposed.Of, mammogram), options, path);
}
#endif

/// Throws ours as mammoray._errors has them.
void Translate(std::exception_ptr thrown)
{
  const auto raise = [](const char* name, const std::exception& error)
  { PyErr_SetString(py::module_::import("mammoray._errors").attr(name).ptr(), error.what()); };
  try
  {
    std::rethrow_exception(std::move(thrown));
  }
  catch (const Interrupted&)
  {
    if (!PyErr_Occurred())
    {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  }
  catch (const InputError& error)
  {
    raise("InputError", error);
  }
  catch (const DeviceError& error)
  {
    raise("DeviceError", error);
  }
  catch (const Error& error)
  {
    raise("Error", error);
  }
}

/// An array of the exposure's own memory, which keeps it alive.
template <typename Value>
py::array View(const py::object& exposure, const std::vector<Value>& values,
  const std::vector<py::ssize_t>& shape)
{
  py::array_t<Value> array(shape, values.data(), exposure);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

void DeclareExposure(py::module_& module)
{
  const auto shape = [](const ExposedScene& exposed) -> std::vector<py::ssize_t> {
    return { exposed.Picture.Lengths->Rows, exposed.Picture.Lengths->Columns };
  };
  py::class_<ExposedScene>(module, "Exposure")
    .def_property_readonly("transmission",
      [shape](const py::object& self)
      {
        const auto& exposed = self.cast<const ExposedScene&>();
        return View(self, exposed.Picture.Transmission, shape(exposed));
      })
    .def_property_readonly("log_attenuation",
      [shape](const py::object& self)
      {
        const auto& exposed = self.cast<const ExposedScene&>();
        return View(self, exposed.Picture.LogAttenuation, shape(exposed));
      })
    .def_property_readonly("path_lengths",
      [](const py::object& self)
      {
        const auto& exposed = self.cast<const ExposedScene&>();
        const PathLengthImage& lengths = *exposed.Picture.Lengths;
        return View(self, lengths.Lengths, { lengths.Materials, lengths.Rows, lengths.Columns });
      })
    .def_property_readonly("inconsistent",
      [shape](const py::object& self)
      {
        const auto& exposed = self.cast<const ExposedScene&>();
        return View(self, exposed.Picture.Lengths->Inconsistent, shape(exposed));
      })
    .def_property_readonly("deflection",
      [](const py::object& self) -> py::object
      {
        const auto& exposed = self.cast<const ExposedScene&>();
        const PathLengthImage& lengths = *exposed.Picture.Lengths;
        return exposed.Picture.Deflection.empty()
          ? py::object(py::none())
          : View(self, exposed.Picture.Deflection, { 2, lengths.Rows, lengths.Columns });
      })
    .def_property_readonly("dose",
      [](const ExposedScene& exposed) -> py::object
      {
        const std::optional<Dose>& dose = exposed.Picture.Absorbed;
        return dose ? py::object(py::make_tuple(dose->Photons, dose->HeightMm, dose->AirKermaMgy,
                        dose->MassesG, dose->PerAirKerma, dose->Error))
                    : py::object(py::none());
      })
    .def_property_readonly("names",
      [](const ExposedScene& exposed) { return exposed.Of->Materials.Names(); })
    .def_property_readonly("spacing",
      [](const ExposedScene& exposed)
      {
        const XRayDetector& detector = exposed.Of->Detector;
        return std::pair(Norm(detector.ColumnStep), Norm(detector.RowStep));
      })
    .def_property_readonly("points",
      [](const ExposedScene& exposed)
      {
        std::vector<py::ssize_t> counts;
        for (const std::shared_ptr<MovingSurface>& surface : exposed.Surfaces)
        {
          counts.push_back(surface->NumberOfPoints());
        }
        return counts;
      })
    .def_readonly("warning", &ExposedScene::Warning)
    .def("display",
      [shape](const ExposedScene& exposed)
      { return ToArray(DisplayValues(exposed.Picture, exposed.Of->Detector), shape(exposed)); })
    .def("derivatives", &ExposedScene::Differentiate)
    .def("backward", &Backward)
    .def("recombine",
      [shape](const ExposedScene& high, const ExposedScene& low, double weight)
      { return ToArray(Recombine(low.Picture, high.Picture, weight), shape(high)); });
#ifdef MAMMORAY_WITH_SCENES
  module.def("write", &WriteExposure);
  module.def("write_stack", &WriteStack);
#endif
#ifdef MAMMORAY_WITH_DICOM
  module.def("write_mammogram", &WriteMammogramOf);
#endif
}

void DeclareScene(py::module_& module)
{
  py::class_<MovingSurface, std::shared_ptr<MovingSurface>>(module, "Surface")
    .def(py::init<const Array<double>&, const Array<std::int32_t>&, const Array<std::uint16_t>&>())
    .def("move", &MovingSurface::Move);
  py::class_<PlacedScene>(module, "Scene")
    .def(py::init<const std::vector<Setting>&, const std::vector<Sample>&>())
    .def("place", &PlacedScene::Place)
    .def_readonly("notes", &PlacedScene::Notes)
    .def("place_unit", &PlacedScene::PlaceUnitAround)
    .def("views", &MakeViews)
    .def_property_readonly("source",
      [](const PlacedScene& placed)
      {
        const XRaySource& source = placed.Current->Source;
        const bool isPoint = source.Type == XRaySource::Kind::Point;
        return std::pair(isPoint, isPoint ? source.Position : source.Direction);
      })
    .def_property_readonly("detector",
      [](const PlacedScene& placed)
      {
        const XRayDetector& detector = placed.Current->Detector;
        return std::tuple(detector.Origin, detector.ColumnStep, detector.RowStep, detector.Columns,
          detector.Rows);
      })
    .def("check",
      [](const PlacedScene& placed, const ExposedScene& exposed)
      {
        const std::shared_ptr<const Scene> scene = placed.Current;
        const py::gil_scoped_release released;
        const std::string overlap = scene->OverlapPriority.empty()
          ? MeasureOverlap(*Assemble(*scene), scene->Source, scene->Detector)
              .Warning(scene->Materials.Names())
          : std::string();
        return std::pair(PlacedScene::WarningOf(*scene, exposed.Picture, true), overlap);
      })
    .def("cancelling_weight",
      [](const PlacedScene& low, const PlacedScene& high, const std::string& first,
        const std::string& second, double thicknessMm)
      {
        const MaterialTable& table = low.Current->Materials;
        const auto indexOf = [&table](const std::string& name)
        {
          try
          {
            return table.IndexOf(name);
          }
          catch (const InputError& error)
          {
            throw InputError(std::string("cancel: ") + error.what());
          }
        };
        return CancellingWeight(MakeBeam(*low.Current), MakeBeam(*high.Current), indexOf(first),
          indexOf(second), thicknessMm);
      });
  py::class_<ProjectionView>(module, "View")
    .def_readonly("angle", &ProjectionView::AngleDeg)
    .def_property_readonly("source",
      [](const ProjectionView& view)
      {
        return view.Source.Type == XRaySource::Kind::Point ? view.Source.Position
                                                           : view.Source.Direction;
      })
    .def_property_readonly("detector",
      [](const ProjectionView& view) {
        return std::tuple(view.Detector.Origin, view.Detector.ColumnStep, view.Detector.RowStep);
      });
  py::class_<Camera>(module, "Projector")
    .def(py::init<const std::string&, const std::string&>())
    .def("expose", &Camera::Expose)
    .def("close", &Camera::Close)
    .def_property_readonly("device", &Camera::DeviceName)
    .def_property_readonly("method", &Camera::Method)
    .def_property_readonly("traces", &Camera::Traces);
}
}

PYBIND11_MODULE(_xray, module)
{
  py::register_exception_translator(&Translate);
  DeclareExposure(module);
  DeclareScene(module);
  module.def("quantities", &Quantities);
  module.def("materials", &Materials);
  module.def("density",
    [](const std::string& attenuation) { return FindAttenuationTable(attenuation).DensityOf(0); });
  module.def("unit_mm", &LengthUnitMm);
  module.def("spectrum",
    [](const std::vector<Setting>& settings)
    {
      const SceneDescription description = Describe(settings);
      description.Validate();
      const Spectrum spectrum = FindSpectrum(description);
      return std::tuple(spectrum.EnergiesKeV, spectrum.Weights, spectrum.Name,
        spectrum.MeanEnergyKeV(), HalfValueLayerMm(spectrum));
    });
  module.def("devices", &Devices);
  module.def("check", [](const std::vector<Setting>& settings) { Describe(settings); });
  module.def("describe",
    [](const std::vector<Setting>& settings) { return WriteScene(Describe(settings)); });
  module.def("read_scene", [](const std::string& path) { return WriteScene(ReadScene(path)); });
#ifdef MAMMORAY_WITH_SCENES
  module.def("read_mesh", &ReadMeshFile);
#endif
}
