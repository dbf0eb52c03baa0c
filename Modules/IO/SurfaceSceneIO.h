// SPDX-License-Identifier: Apache-2.0
// Surfaces that are X-rayed, each of one material: from files, and from a file that says where they
// stand before a source and a detector.
#ifndef mammoray_SurfaceSceneIO_h
#define mammoray_SurfaceSceneIO_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayIOModule.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// What is X-rayed, and of what it is.
struct SurfaceScene
{
  SurfaceMesh Surface;
  MaterialTable Materials;
};

/// The interfaces of a mesh's file, whose materials are of `table`. Throws InputError.
MAMMORAYIO_EXPORT SurfaceScene ReadMeshScene(const std::string& path, const MaterialTable& table);

/// A closed surface of one material, and where it stands.
struct SurfaceSample
{
  /// What refusals call it: "--surface Ti=rod.stl", "scene.json: samples[0]".
  std::string Name;
  /// See ReadSurface.
  std::string File;
  /// One of a material table, by name, or what it is made of, "Ti90Al6V4@4.43", with the density in
  /// g/cm3 where the composition does not tell it (see FindComposition).
  std::string Material;
  /// The unit of the file's numbers, mm, positive; none: 1, and 1000 of glTF, which has metres.
  std::optional<double> UnitMm;
  /// The file's points, in mm, are turned right-handedly about the origin of their own frame, the
  /// axis of any length but zero, and then moved to the frame of the scene.
  Vector3 RotationAxis{ 0, 0, 1 };
  double RotationDeg = 0;
  Vector3 TranslationMm{ 0, 0, 0 };
};

/**
 * All of them in one surface, their materials added to the table in their order. Throws InputError
 * that names the sample: on an unknown material, a surface of several, and one that reaches farther
 * than SceneLimits::LengthMm.
 */
MAMMORAYIO_EXPORT SurfaceScene ReadSurfaces(const std::vector<SurfaceSample>& samples,
  MaterialTable table);

/// What no scene goes beyond: what does has another unit.
namespace SceneLimits
{
/// Of every coordinate, either way: a kilometre.
inline constexpr double LengthMm = 1e6;
inline constexpr double LeastPixelMm = 1e-6;
inline constexpr double MostPixelMm = 1e3;
inline constexpr double LeastEnergyKeV = 1;
inline constexpr double MostEnergyKeV = 500;
inline constexpr double MostAngleDeg = 3600;
}

/// X-rays as the options of 'mammoray project' say them: one of energy, spectrum and tube.
struct SceneBeam
{
  std::optional<double> EnergyKeV;
  /// A path or a shipped one's name.
  std::string Spectrum;
  /// "W", "Mo" or "Rh", with its voltage, kV.
  std::string Anode;
  std::optional<double> KilovoltagePeak;
  /// As XRayFilter::FromText reads them.
  std::vector<std::string> Filters;
};

/// A point source, or a parallel beam in a direction of any length but zero; frame of the scene.
struct SceneSource
{
  std::optional<Vector3> PositionMm;
  std::optional<Vector3> Direction;
  /// Edges of the focal spot along columns and rows.
  std::optional<std::array<double, 2>> FocalSpotMm;
};

/// A flat detector; frame of the scene.
struct SceneDetector
{
  /// The centre of the pixel in column 0 and row 0.
  Vector3 OriginMm{ 0, 0, 0 };
  /// From a pixel to that of the next column or row, of any length but zero.
  Vector3 ColumnDirection{ 1, 0, 0 };
  Vector3 RowDirection{ 0, 1, 0 };
  int Columns = 1;
  int Rows = 1;
  double PixelSpacingMm = 0.1;
};

/// What a scene file says; empty where it says nothing of it.
struct SceneDescription
{
  std::optional<SceneSource> Source;
  std::optional<SceneDetector> Detector;
  std::optional<SceneBeam> Beam;
  /// Material table: a path or a shipped one's name.
  std::string Materials;
  std::vector<SurfaceSample> Samples;
  /// As ProjectorOptions::Priority, by name.
  std::vector<std::string> OverlapPriority;
};

/**
 * Reads a scene from JSON; docs/scene.md has the table of its keys. Lengths become mm, paths those
 * beside the scene's file. Throws InputError "FILE: samples[2].unit: expected ..., found ..." on an
 * unknown or repeated key, a wrong type, what is out of range (SceneLimits), and a part that lacks
 * what it needs. Files that it names are not read.
 */
MAMMORAYIO_EXPORT SceneDescription ReadScene(const std::string& path);
}

#endif
