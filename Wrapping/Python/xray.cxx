// SPDX-License-Identifier: Apache-2.0
// The projector for Python, without VTK. mammoray/_projection.py is what users call: it looks at
// shapes and types before, so that what arrives here fits.
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/DeviceError.h"
#include "mammoray/XRay/DualEnergy.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Refraction.h"

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

/// Table and density of a material, or what it attenuates at each energy, 1/mm, where the table has
/// no name.
using Attenuation = std::tuple<std::string, double, std::vector<double>>;

/// `attenuations`: of regions 1, 2, ...
Beam MakeBeamOf(const std::vector<double>& energies, const std::vector<double>& photons,
  bool counting, const std::vector<Attenuation>& attenuations)
{
  Spectrum spectrum;
  spectrum.EnergiesKeV = energies;
  spectrum.Weights = photons;
  spectrum.Validate();
  std::vector<AttenuationTable> tables(attenuations.size() + 1);
  std::vector<const AttenuationTable*> pointers{ nullptr };
  std::vector<double> densities{ 0 };
  for (std::size_t region = 1; region < tables.size(); ++region)
  {
    const auto& [name, density, coefficients] = attenuations[region - 1];
    tables[region] = name.empty()
      ? AttenuationTable{ "region " + std::to_string(region), 1, energies, coefficients }
      : FindAttenuationTable(name);
    pointers.push_back(&tables[region]);
    densities.push_back(name.empty() ? 1 : density);
  }
  return { spectrum,
    counting ? DetectorResponse::PhotonCounting : DetectorResponse::EnergyIntegrating, pointers,
    densities };
}

/// The law of refraction, the distance from body to detector, mm, and what Refract takes as
/// decrements.
using Bend = std::tuple<std::string, double, std::vector<double>>;

/// Of the same attenuations as MakeBeamOf: 0 of those that are numbers.
std::vector<double> DecrementsOf(const std::vector<double>& energies,
  const std::vector<double>& photons, const std::vector<Attenuation>& attenuations)
{
  std::vector<double> decrements;
  for (std::size_t bin = 0; bin < energies.size(); ++bin)
  {
    if (photons[bin] == 0)
    {
      continue;
    }
    decrements.push_back(0);
    for (const auto& [name, density, coefficients] : attenuations)
    {
      decrements.push_back(name.empty() ? 0.0 : RefractiveDecrement(name, energies[bin], density));
    }
  }
  return decrements;
}

/// A mesh on a device.
class MeshProjector
{
public:
  /// `corners`: m x 3 or m x 4; `regions`: m x 2, front and back of triangles, or m x 1, of
  /// tetrahedra.
  MeshProjector(const Array<double>& points, const Array<std::int32_t>& corners,
    const Array<std::uint16_t>& regions, const std::string& method, const std::string& device)
    : Projector(MakeProjector({ .Projection = MethodFromName(method), .Device = device }))
  {
    if (corners.shape(1) == 4)
    {
      TetrahedralMesh mesh;
      mesh.Points = Values<double>(points);
      mesh.Cells = Values<std::int32_t>(corners);
      mesh.Materials = Values<std::int32_t>(regions);
      mesh.ValidateIndices("mesh");
      this->Surface = ExtractInterfaces(mesh, &this->PointIds);
    }
    else
    {
      this->Surface.Points = Values<double>(points);
      this->Surface.Triangles = Values<std::uint32_t>(corners);
      for (py::ssize_t triangle = 0; triangle < regions.shape(0); ++triangle)
      {
        this->Surface.FrontMaterials.push_back(regions.at(triangle, 0));
        this->Surface.BackMaterials.push_back(regions.at(triangle, 1));
      }
    }
    this->Surface.Validate("mesh");
    const py::gil_scoped_release released;
    this->Projector->SetSurface(this->Surface);
  }

  void Move(const Array<double>& points)
  {
    SurfaceMesh moved = this->Surface;
    moved.Points = this->OfSurface(points.data());
    moved.Validate("mesh");
    const py::gil_scoped_release released;
    this->Projector->UpdatePoints(moved.Points);
    this->Surface.Points = std::move(moved.Points);
  }

  /// `velocities`: fields x points x 3.
  py::dict Project(const XRaySource& source, const XRayDetector& detector, const Beam& beam,
    const ExposureOptions& options, const std::optional<Array<double>>& velocities,
    const std::optional<Bend>& bend)
  {
    beam.CheckMaterials(this->Surface.NumberOfMaterials());
    Exposure exposure;
    RefractedImage refracted;
    {
      const py::gil_scoped_release released;
      if (bend)
      {
        refracted = this->Refracted(source, detector, beam, *bend);
        exposure = ToExposure(refracted);
      }
      else
      {
        exposure = Expose(*this->Projector, source, detector, beam, options, GoesOn);
      }
    }
    const PathLengthImage& lengths = exposure.Lengths;
    py::dict result;
    result["transmission"] = ToArray(exposure.Transmission, { lengths.Rows, lengths.Columns });
    result["log_attenuation"] = ToArray(exposure.LogAttenuation, { lengths.Rows, lengths.Columns });
    result["path_lengths"] =
      ToArray(lengths.Lengths, { lengths.Materials, lengths.Rows, lengths.Columns });
    result["inconsistent"] = ToArray(lengths.Inconsistent, { lengths.Rows, lengths.Columns });
    result["warning"] = lengths.InconsistencyWarning();
    if (bend)
    {
      result["deflection"] = ToArray(refracted.Deflection, { 2, lengths.Rows, lengths.Columns });
    }
    if (velocities)
    {
      this->AddDerivatives(source, detector, beam, *velocities, result);
    }
    return result;
  }

  std::string Device() const { return this->Projector->DeviceName(); }
  std::string Method() const { return MethodName(this->Projector->Method()); }

private:
  /// Of all points of the mesh, those of the surface: it has fewer where it was taken from
  /// tetrahedra.
  std::vector<double> OfSurface(const double* values) const
  {
    if (this->PointIds.empty())
    {
      return { values, values + this->Surface.Points.size() };
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

  RefractedImage Refracted(const XRaySource& source, const XRayDetector& detector, const Beam& beam,
    const Bend& bend)
  {
    const auto& [law, distance, decrements] = bend;
    const RefractionOptions options{ law == "geometric" ? RefractionOptions::Law::Geometric
                                                        : RefractionOptions::Law::NearField,
      distance };
    return Refract(*this->Projector, this->Surface.NumberOfPoints(), source, detector, beam,
      decrements, options, GoesOn);
  }

  void AddDerivatives(const XRaySource& source, const XRayDetector& detector, const Beam& beam,
    const Array<double>& velocities, py::dict& result)
  {
    const auto fields = static_cast<int>(velocities.shape(0));
    std::vector<double> moving;
    for (int field = 0; field < fields; ++field)
    {
      const std::vector<double> one = this->OfSurface(velocities.data(field));
      moving.insert(moving.end(), one.begin(), one.end());
    }
    PathLengthDerivatives derivatives;
    std::vector<float> attenuation;
    PathLengthImage image;
    {
      const py::gil_scoped_release released;
      image = this->Projector->Project(source, detector, moving, fields, derivatives);
      attenuation = beam.MeanAttenuation(image);
    }
    result["path_length_derivatives"] = ToArray(derivatives.Lengths,
      { fields, derivatives.Materials, derivatives.Rows, derivatives.Columns });
    result["mean_attenuation"] =
      ToArray(attenuation, { image.Materials, image.Rows, image.Columns });
  }

  std::unique_ptr<PathLengthProjector> Projector;
  SurfaceMesh Surface;
  std::vector<std::int32_t> PointIds;
};

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
  py::class_<Beam>(module, "Beam").def(py::init(&MakeBeamOf));
  py::class_<MeshProjector>(module, "Projector")
    .def(py::init<const Array<double>&, const Array<std::int32_t>&, const Array<std::uint16_t>&,
      const std::string&, const std::string&>())
    .def("move", &MeshProjector::Move)
    .def("project", &MeshProjector::Project)
    .def_property_readonly("device", &MeshProjector::Device)
    .def_property_readonly("method", &MeshProjector::Method);
  module.def("materials", &Materials);
  module.def("spectrum",
    [](const std::string& pathOrName)
    {
      const Spectrum spectrum = FindSpectrum(pathOrName);
      return std::pair(spectrum.EnergiesKeV, spectrum.Weights);
    });
  module.def("decrements", &DecrementsOf);
  module.def("cancelling_weight", &CancellingWeight);
  module.def("devices", &Devices);
}
