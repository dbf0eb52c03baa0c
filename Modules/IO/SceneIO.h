// SPDX-License-Identifier: Apache-2.0
// Scenes from files: the JSON form of mammoray/XRay/Scene.h. SceneQuantities declares its keys.
#ifndef mammoray_SceneIO_h
#define mammoray_SceneIO_h

#include "mammoray/Foundation/Vector3.h"
#include "mammoray/XRay/Scene.h"
#include "mammoray/XRay/Tube.h"
#include "mammorayIOModule.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// A surface, and where it stands.
struct SurfaceSample
{
  /// Names the sample in messages: "scene.json: samples[0]".
  std::string Name;
  /// See ReadSurface; also a mesh of tetrahedra where Material is empty.
  std::string File;
  /// The material inside closed surfaces: one of the material table, by name, or a composition,
  /// "Ti90Al6V4@4.43", with the density in g/cm3 where the composition does not imply it (see
  /// FindComposition). Empty: the labels of the surface are those of the table.
  std::string Material;
  /// Unit of the file's numbers, mm, positive. Default: 1, and 1000 for glTF, which has metres.
  std::optional<double> UnitMm;
  /// The surface is turned right-handedly about the origin of its own frame, the axis having any
  /// length but zero, and then moved to the frame of the scene.
  Vector3 RotationAxis{ 0, 0, 1 };
  double RotationDeg = 0;
  Vector3 TranslationMm{ 0, 0, 0 };
  /// The contents of the file (ReadSurfaces), or what stands for them, mm; and names of its labels,
  /// as MaterialTable::FitMesh takes them.
  std::shared_ptr<const SurfaceMesh> Surface;
  std::vector<std::string> MaterialNames;
};

/// A scene as files and options describe it: with the names of what is to be read.
struct MAMMORAYIO_EXPORT SceneDescription
{
  std::string Description;
  /// A mesh of the materials of a table, or samples.
  std::string Mesh;
  /// Unit of its numbers, as LengthUnitMm has it. Empty: that of its format.
  std::string MeshUnit;
  std::vector<SurfaceSample> Samples;
  /// Material table: a path or the name of a shipped one; or the JSON of a table.
  std::string Materials;
  /// Takes precedence over Materials; not written to files.
  std::optional<MaterialTable> Table;
  /// Other attenuations of the table's materials, by their names: "ATTENUATION[@DENSITY]", g/cm3.
  std::map<std::string, std::string> Attenuations;
  /// Iodine that the table's materials have taken up, mg/ml.
  std::map<std::string, double> IodineMgPerMl;
  /// Scene::OverlapPriority by name.
  std::vector<std::string> OverlapPriority;

  /// X-rays: an energy; else energies, keV, with numbers of photons; else the tube where it has an
  /// anode; else a spectrum (a path or the name of a shipped one).
  std::optional<double> EnergyKeV;
  std::vector<double> EnergiesKeV;
  std::vector<double> Photons;
  XRayTube Tube{ .Anode = "" };
  std::string Spectrum = "W28kVp_Rh50um_Be1mm";
  /// Layers in the beam, as XRayFilter::FromText reads them.
  std::vector<std::string> Filters;

  /// The layer whose absorbed photons count, as XRayFilter::FromText reads it. Empty: all do.
  std::string Scintillator;
  /// The detector's response in a file (ReadDetectorResponse); excludes a scintillator.
  std::string ResponseTable;
  /// The detector's line spread function in a file (ReadLineSpread); excludes a half modulation.
  std::string LineSpread;
  double PixelSpacingMm = 0.1;
  /// Edge of the voxels through which photons are followed.
  double VoxelMm = 1;
  /// Kernels of scatter: "scene" where they are made for it, else as FindScatterKernels takes it.
  std::string Kernels = "breast";

  /// All that needs no file. The steps of its detector are unit vectors; LoadScene multiplies them
  /// by PixelSpacingMm.
  Scene Fixed{
    .Detector = { .ColumnStep = { 1, 0, 0 }, .RowStep = { 0, 1, 0 }, .Columns = 720, .Rows = 1080 }
  };

  /// If true, missing keys take the values of a modern mammography unit (CompleteUnit).
  bool IsRealistic = false;

  /// Keys that were given, "detector.photons".
  std::vector<std::string> Keys;
  /// Whether a key, or one within its object, was given.
  bool Has(const std::string& key) const;
  /// Whether source and detector have places; else those of a mammography unit are meant.
  bool HasSource() const;
  bool HasDetector() const;
  /// The table of materials that Table or Materials gives; empty without both. Throws InputError
  /// as FindMaterialTable and ParseMaterialTable do.
  MaterialTable ReadTable() const;

  /// Throws InputError where quantities contradict each other.
  void Validate() const;
};

/// A unit of length in mm, by its name: um, mm, cm, m or in. Throws InputError on another.
MAMMORAYIO_EXPORT double LengthUnitMm(const std::string& name);

/// What is declared of a key of scene files.
struct SceneQuantity
{
  enum class Kind
  {
    Number,
    /// In the unit of the scene; limits are mm.
    Length,
    WholeNumber,
    /// A component of a vector of any length but 0.
    Component,
    Flag,
    Word,
    Text,
    /// A file that is read.
    File,
    /// A file, or the name of a shipped one.
    FileOrName,
    /// The same, or an object that is what such a file holds.
    Table,
    Sample
  };
  /// How often people set it by hand. Daily and expert quantities are options of programs; rare
  /// ones are set by their keys, in files or with --set.
  enum class Use
  {
    Rare,
    Expert,
    Daily
  };
  /// "detector.photons".
  std::string Key;
  Kind Type;
  /// One line, and details after a line break.
  std::string Help;
  /// Unit of numbers, or form of texts: "keV", "MATERIAL:MM".
  std::string Unit = "";
  /// Range of numbers.
  double Least = 0;
  double Most = 0;
  std::vector<std::string> Words = {};
  Use Usage = Use::Rare;
  /// Number of values in a list; 1: a single value; 0: a list of one or more.
  std::size_t Count = 1;
  /// Whether there is one for each of some materials, by their names.
  bool IsByMaterial = false;
  /// That of SceneDescription; empty: none.
  std::string Default = "";

  /// Whether its values are numbers from Least to Most; components of a vector are not meant.
  bool IsNumeric() const
  {
    return this->Type == Kind::Number || this->Type == Kind::Length ||
      this->Type == Kind::WholeNumber;
  }
};

/// All keys of scene files in the order of their documentation; those within samples are not here.
MAMMORAYIO_EXPORT const std::vector<SceneQuantity>& SceneQuantities();

/// A value for a key, as people type it.
struct SceneSetting
{
  /// Names the value in messages.
  std::string Name;
  /// "detector.photons"; of a quantity by material "iodine.gland".
  std::string Key;
  /// One text; several for lists and vectors. Lists and vectors may also be JSON, "[1, 2, 3]".
  /// Lengths are mm, paths are relative to the working folder.
  std::vector<std::string> Values;
};

/// Sets a quantity and notes its key. Throws InputError on an unknown key and an unusable value.
MAMMORAYIO_EXPORT void SetQuantity(const SceneSetting& setting, SceneDescription& description);

/**
 * Reads a scene from JSON. Lengths become mm, paths those beside the scene's file. Throws
 * InputError "FILE: samples[2].unit: expected ..., found ..." on an unknown or repeated key, a
 * wrong type, a value out of range and a part that lacks what it needs. Files that it names are not
 * read.
 */
MAMMORAYIO_EXPORT SceneDescription ReadScene(const std::string& path);

/// The JSON that ReadScene reads: keys that were given, and values other than the default. Lengths
/// are mm, paths absolute.
MAMMORAYIO_EXPORT std::string WriteScene(const SceneDescription& description);

/// The X-rays behind all filters. Throws InputError.
MAMMORAYIO_EXPORT Spectrum FindSpectrum(const SceneDescription& description);

/// Gives a description that IsRealistic what a modern mammography unit has and no key gives:
/// tungsten tube of 29 kV with 0.05 mm Rh, heel and inverse square, scatter of kernels behind a
/// grid, blur and noise.
MAMMORAYIO_EXPORT void CompleteUnit(SceneDescription& description);

/// Reads the files of surfaces that are not there yet; the mesh becomes a sample. Throws
/// InputError, which names the sample, also on one that reaches farther than a kilometre.
MAMMORAYIO_EXPORT void ReadSurfaces(SceneDescription& description);

/**
 * The scene of a description whose surfaces are there, with its tables and spectra. Photons are
 * followed through voxels, which are not made here. Throws InputError, which names the sample, on
 * an unknown material and a surface of several.
 */
MAMMORAYIO_EXPORT Scene MakeScene(SceneDescription description);

/// ReadSurfaces, then MakeScene.
MAMMORAYIO_EXPORT Scene LoadScene(SceneDescription description);

/// LoadScene of a scene to look at: where neither source nor detector has a place, they stand
/// around the samples (PlaceAround), with 512 x 512 pixels. Throws InputError, which begins with
/// `name`, where only one of them has, and without samples.
MAMMORAYIO_EXPORT Scene LoadPlacedScene(const SceneDescription& description,
  const std::string& name);

/// Reads and loads a scene that is complete: it has samples, a source and a detector. Its dose,
/// which needs voxels, is not asked for. Throws InputError where something is missing.
MAMMORAYIO_EXPORT Scene LoadScene(const std::string& path);
}

#endif
