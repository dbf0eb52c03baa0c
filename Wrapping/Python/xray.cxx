// SPDX-License-Identifier: Apache-2.0
// The projector for Python, without VTK. mammoray/_projection.py is what users call: it looks at
// shapes and types before, so that what arrives here fits.
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Meshes.h"
#ifdef MAMMORAY_WITH_SCENES
#include "mammoray/IO/SceneIO.h"
#endif
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/DualEnergy.h"
#include "mammoray/XRay/Exposer.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Shadow.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
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

/// Asks between pieces of work whether Ctrl-C was pressed.
bool GoesOn(double /*fraction*/, const char* /*stage*/)
{
  const py::gil_scoped_acquire held;
  return PyErr_CheckSignals() == 0;
}

/// Table and density (0: its own) of a material; or, where the table has no name, its linear
/// attenuation at each energy, 1/mm. Without both the region is not in the mesh.
using Attenuation = std::tuple<std::string, double, std::vector<double>>;

/// `attenuations`: of regions 1, 2, ... The scene has no samples: the projector has them.
Scene MakeScene(const std::vector<double>& energies, const std::vector<double>& photons,
  bool counting, const std::vector<Attenuation>& attenuations)
{
  Scene scene;
  scene.XRays.EnergiesKeV = energies;
  scene.XRays.Weights = photons;
  scene.XRays.Validate();
  scene.Response =
    counting ? DetectorResponse::PhotonCounting : DetectorResponse::EnergyIntegrating;
  scene.Materials.Materials.push_back({ .Name = "air" });
  scene.Attenuations.emplace_back();
  for (const auto& [name, density, coefficients] : attenuations)
  {
    const std::string region = "region " + std::to_string(scene.Attenuations.size());
    scene.Attenuations.push_back(!name.empty() ? FindAttenuationTable(name)
        : coefficients.empty()                 ? AttenuationTable()
                               : AttenuationTable{ region, 1, energies, coefficients });
    scene.Materials.Materials.push_back({ .Name = region,
      .Attenuation = name,
      .DensityGPerCm3 = scene.Attenuations.back().DensityOf(density) });
  }
  return scene;
}

/// What _projection.Projection is made of.
py::dict ToDict(const Scene& scene, const Exposure& exposure)
{
  const PathLengthImage& lengths = *exposure.Lengths;
  py::dict result;
  result["transmission"] = ToArray(exposure.Transmission, { lengths.Rows, lengths.Columns });
  result["log_attenuation"] = ToArray(exposure.LogAttenuation, { lengths.Rows, lengths.Columns });
  result["path_lengths"] =
    ToArray(lengths.Lengths, { lengths.Materials, lengths.Rows, lengths.Columns });
  result["inconsistent"] = ToArray(lengths.Inconsistent, { lengths.Rows, lengths.Columns });
  const std::string holes = lengths.InconsistencyWarning();
  result["warning"] = holes.empty() ? ShadowWarning(scene, exposure) : holes;
  if (!exposure.Deflection.empty())
  {
    result["deflection"] = ToArray(exposure.Deflection, { 2, lengths.Rows, lengths.Columns });
  }
  return result;
}

/// A mesh on a device.
class MeshProjector
{
public:
  /// `corners`: m x 3 or m x 4; `regions`: m x 2, front and back of triangles, or m x 1, of
  /// tetrahedra.
  MeshProjector(const Array<double>& points, const Array<std::int32_t>& corners,
    const Array<std::uint16_t>& regions, const std::string& method, const std::string& device)
    : Device({ .Projection = MethodFromName(method), .Device = device })
  {
    this->Device.DeviceName(); // opens it
    SurfaceMesh surface;
    if (corners.shape(1) == 4)
    {
      TetrahedralMesh mesh;
      mesh.Points = Values<double>(points);
      mesh.Cells = Values<std::int32_t>(corners);
      mesh.Materials = Values<std::int32_t>(regions);
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
    this->Show(std::move(surface));
  }

  void Move(const Array<double>& points)
  {
    SurfaceMesh moved = *this->Surface;
    moved.Points = this->OfSurface(points.data());
    moved.Validate("mesh");
    this->Show(std::move(moved));
  }

  /// `velocities`: fields x points x 3.
  py::dict Project(Scene scene, const std::optional<Array<double>>& velocities)
  {
    scene.Samples = { { this->Surface } };
    Exposure exposure;
    {
      const py::gil_scoped_release released;
      exposure = this->Device.Expose(scene, GoesOn);
    }
    py::dict result = ToDict(scene, exposure);
    if (velocities)
    {
      this->AddDerivatives(scene, *velocities, result);
    }
    return result;
  }

  std::string DeviceName() { return this->Device.DeviceName(); }
  std::string Method() { return MethodName(this->Device.Method()); }

private:
  /// Brings the mesh onto the device.
  void Show(SurfaceMesh surface)
  {
    Scene scene;
    scene.Samples = { { std::make_shared<const SurfaceMesh>(std::move(surface)) } };
    const py::gil_scoped_release released;
    this->Device.Load(scene);
    this->Surface = scene.Samples.front().Surface;
  }

  /// Of all points of the mesh, those of the surface: it has fewer where it was taken from
  /// tetrahedra.
  std::vector<double> OfSurface(const double* values) const
  {
    if (this->PointIds.empty())
    {
      return { values, values + this->Surface->Points.size() };
    }
    std::vector<double> chosen;
    chosen.reserve(3 * this->PointIds.size());
    for (const std::int32_t point : this->PointIds)
    {
      chosen.insert(chosen.end(), values + 3 * static_cast<std::ptrdiff_t>(point),
        values + 3 * static_cast<std::ptrdiff_t>(point) + 3);
    }
    return chosen;
  }

  void AddDerivatives(const Scene& scene, const Array<double>& velocities, py::dict& result)
  {
    const auto fields = static_cast<int>(velocities.shape(0));
    VectorFields moving;
    moving.Length = this->Surface->Points.size();
    for (int field = 0; field < fields; ++field)
    {
      const std::vector<double> one = this->OfSurface(velocities.data(field));
      moving.Values.insert(moving.Values.end(), one.begin(), one.end());
    }
    Exposer::Derivatives derivatives;
    {
      const py::gil_scoped_release released;
      derivatives = this->Device.Differentiate(scene, moving);
    }
    const PathLengthDerivatives& lengths = derivatives.Lengths;
    result["path_length_derivatives"] =
      ToArray(lengths.Lengths, { fields, lengths.Materials, lengths.Rows, lengths.Columns });
    result["mean_attenuation"] =
      ToArray(derivatives.MeanAttenuation, { lengths.Materials, lengths.Rows, lengths.Columns });
  }

  Exposer Device;
  std::shared_ptr<const SurfaceMesh> Surface;
  std::vector<std::int32_t> PointIds;
};

#ifdef MAMMORAY_WITH_SCENES
py::dict ProjectScene(const std::string& path, const std::string& method, const std::string& device)
{
  Scene scene;
  Exposure exposure;
  {
    const py::gil_scoped_release released;
    scene = LoadScene(path);
    exposure =
      Exposer({ .Projection = MethodFromName(method), .Device = device }).Expose(scene, GoesOn);
  }
  py::dict result = ToDict(scene, exposure);
  result["names"] = scene.Materials.Names();
  return result;
}
#endif

/// What a material table says, as _projection.Material takes it.
py::list Materials(const std::string& pathOrName)
{
  py::list materials;
  for (const Material& material : FindMaterialTable(pathOrName).Materials)
  {
    py::dict entry;
    entry["name"] = material.Name;
    entry["attenuation"] = material.Attenuation;
    entry["density"] = material.DensityGPerCm3;
    entry["youngs_modulus"] = material.YoungsModulusKPa;
    entry["poisson_ratio"] = material.PoissonRatio;
    entry["fung_exponent"] = material.FungExponent;
    entry["fixed"] = material.Fixed;
    materials.append(entry);
  }
  return materials;
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
}

PYBIND11_MODULE(_xray, module)
{
  py::register_exception_translator(&Translate);
  py::class_<XRaySource>(module, "Source")
    .def(py::init(
      [](bool parallel, const Vector3& place)
      {
        XRaySource source;
        source.Type = parallel ? XRaySource::Kind::Parallel : XRaySource::Kind::Point;
        (parallel ? source.Direction : source.Position) = place;
        return source;
      }));
  py::class_<XRayDetector>(module, "Detector")
    .def(py::init(
      [](const Vector3& origin, const Vector3& columnStep, const Vector3& rowStep, int columns,
        int rows, int samples) {
        return XRayDetector{ origin, columnStep, rowStep, columns, rows, samples };
      }));
  py::class_<ExposureOptions>(module, "Exposure")
    .def(py::init(
      [](const std::array<double, 2>& spot, int spotSamples, double photons, std::uint64_t seed)
      {
        ExposureOptions options;
        options.FocalSpotColumnMm = spot[0];
        options.FocalSpotRowMm = spot[1];
        options.FocalSpotSamples = spotSamples;
        options.PhotonsPerPixel = photons;
        options.Seed = seed;
        options.Validate();
        return options;
      }));
  py::class_<Scene>(module, "Scene")
    .def(py::init(&MakeScene))
    .def_readwrite("source", &Scene::Source)
    .def_readwrite("detector", &Scene::Detector)
    .def_readwrite("exposure", &Scene::Detection)
    .def("refract",
      [](Scene& scene, const std::string& law, double distanceMm)
      {
        scene.Refraction = law == "geometric" ? RefractionOptions::Law::Geometric
                                              : RefractionOptions::Law::NearField;
        scene.BendDistanceMm = distanceMm;
      });
  py::class_<MeshProjector>(module, "Projector")
    .def(py::init<const Array<double>&, const Array<std::int32_t>&, const Array<std::uint16_t>&,
      const std::string&, const std::string&>())
    .def("move", &MeshProjector::Move)
    .def("project", &MeshProjector::Project)
    .def_property_readonly("device", &MeshProjector::DeviceName)
    .def_property_readonly("method", &MeshProjector::Method);
  module.def("materials", &Materials);
  module.def("density",
    [](const std::string& attenuation) { return FindAttenuationTable(attenuation).DensityOf(0); });
  module.def("spectrum",
    [](const std::string& pathOrName)
    {
      const Spectrum spectrum = FindSpectrum(pathOrName);
      return std::pair(spectrum.EnergiesKeV, spectrum.Weights);
    });
  module.def("cancelling_weight",
    [](const Scene& low, const Scene& high, int first, int second, double thicknessMm)
    { return CancellingWeight(MakeBeam(low), MakeBeam(high), first, second, thicknessMm); });
  module.def("devices", &Devices);
#ifdef MAMMORAY_WITH_SCENES
  module.def("project_scene", &ProjectScene);
#endif
}
