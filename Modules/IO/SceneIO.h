// SPDX-License-Identifier: Apache-2.0
// Scenes from files: the JSON form of mammoray/XRay/Scene.h. docs/scene.md has the table of its
// keys.
#ifndef mammoray_SceneIO_h
#define mammoray_SceneIO_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/XRay/Scene.h"
#include "mammorayIOModule.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// A closed surface of one material, and where it stands.
struct SurfaceSample
{
  /// Names the sample in messages: "--surface Ti=rod.stl", "scene.json: samples[0]".
  std::string Name;
  /// See ReadSurface.
  std::string File;
  /// One of the material table, by name, or its composition, "Ti90Al6V4@4.43", with the density in
  /// g/cm3 where the composition does not tell it (see FindComposition).
  std::string Material;
  /// Unit of the file's numbers, mm, positive. Default: 1, and 1000 for glTF, which has metres.
  std::optional<double> UnitMm;
  /// The surface is turned right-handedly about the origin of its own frame, the axis having any
  /// length but zero, and then moved to the frame of the scene.
  Vector3 RotationAxis{ 0, 0, 1 };
  double RotationDeg = 0;
  Vector3 TranslationMm{ 0, 0, 0 };
};

/// Limits of what a scene holds. A larger or smaller value has a wrong unit.
namespace SceneLimits
{
/// Largest absolute coordinate: a kilometre.
inline constexpr double LengthMm = 1e6;
inline constexpr double LeastPixelMm = 1e-6;
inline constexpr double MostPixelMm = 1e3;
inline constexpr double LeastEnergyKeV = 1;
inline constexpr double MostEnergyKeV = 500;
inline constexpr double MostAngleDeg = 3600;
}

/// X-rays by an energy, by a tube or by a spectrum, in this order.
struct SceneBeam
{
  std::optional<double> EnergyKeV;
  /// "W", "Mo" or "Rh", with its voltage, 18 to 42 kV.
  std::string Anode;
  double KilovoltagePeak = 28;
  /// A path or the name of a shipped spectrum.
  std::string Spectrum = "W28kVp_Rh50um_Be1mm";
  /// As XRayFilter::FromText reads them.
  std::vector<std::string> Filters;
};

/// The spectrum behind the filters. Throws InputError.
MAMMORAYIO_EXPORT Spectrum FindSpectrum(const SceneBeam& beam);

/// How the detector responds to photons: by a table, or by energy or number.
struct SceneResponse
{
  bool ByEnergy = true;
  /// Only photons count that this layer absorbs, as XRayFilter::FromText reads it. Empty: all.
  std::string Scintillator;
  /// A path (ReadDetectorResponse).
  std::string Table;
};

/// Throws InputError.
MAMMORAYIO_EXPORT DetectorResponse FindResponse(const SceneResponse& response);

/// A scene as files and options describe it: with the names of what is to be read.
struct MAMMORAYIO_EXPORT SceneDescription
{
  /// What needs no file: source, detector, detection, field, scatter but for its tables.
  Scene Fixed;
  /// Keys that the file has, with those of objects as "detector", "detector.photons".
  std::vector<std::string> Keys;

  /// A mesh of the materials of a table, or samples.
  std::string Mesh;
  std::vector<SurfaceSample> Samples;
  /// Material table: a path or the name of a shipped one.
  std::string Materials;
  /// Other attenuations of the table's materials, by their names: "ATTENUATION[@DENSITY]", g/cm3.
  std::map<std::string, std::string> Attenuations;
  /// Iodine that the table's materials have taken up, mg/ml, 0 to 500.
  std::map<std::string, double> IodineMgPerMl;
  /// Scene::OverlapPriority by name.
  std::vector<std::string> OverlapPriority;
  SceneBeam Beam;
  SceneResponse Response;
  /// Edge of the voxels through which photons are followed, 0.05 to 10 mm.
  double VoxelMm = 1;
  /// From where rays are bent to the detector. Default: from the middle of the samples.
  std::optional<double> BendDistanceMm;

  bool Has(const std::string& key) const;
};

/**
 * Reads a scene from JSON over a description, whose other members stay. Lengths become mm, paths
 * those beside the scene's file. Throws InputError "FILE: samples[2].unit: expected ..., found ..."
 * on an unknown or repeated key, a wrong type, a value out of range (SceneLimits), and a part that
 * lacks what it needs. Files that it names are not read.
 */
MAMMORAYIO_EXPORT SceneDescription ReadScene(const std::string& path,
  SceneDescription description = {});

/**
 * The scene with its meshes, tables and spectra. Photons are followed through voxels, which are not
 * made here. Throws InputError, which names the sample, on an unknown material, a surface of
 * several and one that reaches farther than SceneLimits::LengthMm.
 */
MAMMORAYIO_EXPORT Scene LoadScene(const SceneDescription& description);
}

#endif
