// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MaterialTable_h
#define mammoray_MaterialTable_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayFoundationModule.h"

#include <map>
#include <string>
#include <vector>

namespace mammoray
{
struct SurfaceMesh;
struct TetrahedralMesh;

/// X-ray and mechanical properties of one material.
struct Material
{
  /// Name; unique and not empty.
  std::string Name;
  /// Name of the attenuation table (see XRay's AttenuationTable); empty for air.
  std::string Attenuation;
  /// Mass density, g/cm^3, to which the attenuation is scaled. 0: none is stated, the attenuation's
  /// own counts (XRay's AttenuationTable::DensityOf).
  double DensityGPerCm3 = 0.0;
  /// Concentration of iodine (contrast agent) in the material, mg/ml, [0, 500].
  double IodineMgPerMl = 0.0;
  /// Young's modulus at small strain, kPa; positive.
  double YoungsModulusKPa = 5.0;
  /// Poisson's ratio, [0, 0.5).
  double PoissonRatio = 0.49;
  /// Exponent of Fung's law, [0, 50]; 0 is neo-Hookean (see Biomechanics' ElasticMaterial).
  double FungExponent = 0.0;
  /// True if the tissue is fixed to the body and does not move (chest wall, pectoral muscle).
  bool Fixed = false;
  /// True for a layer of about a millimetre (skin), which meshes must resolve to keep it closed.
  bool Thin = false;
};

/// The materials of a label volume. Material 0 is always air; several labels may share a material.
struct MAMMORAYFOUNDATION_EXPORT MaterialTable
{
  /// Name of the table for messages and reports.
  std::string Name;
  /// Materials[0] is air.
  std::vector<Material> Materials;
  /// Label -> index into Materials.
  std::map<int, int> MaterialOfLabel;

  /**
   * Replaces every label by the index of its material. In a volume with Names a label's name
   * decides, whatever number it has: first the material of this name, where upper and lower case,
   * blanks, hyphens and underscores are alike; then, for a name that a program made of the label's
   * number ("Segment_2", "Label 2"), that number in the table. In a volume without Names the number
   * decides, as it does for label 0, and where no name at all is one of the table's but all numbers
   * are. Notes (Note) say so, and which labels have a number that means another material.
   *
   * Throws InputError with each unknown label, its name and its number of voxels (the first ten of
   * many) and the known names, and if all voxels are air.
   */
  LabelVolume ToMaterials(const LabelVolume& labels, const std::string& volumeName) const;
  /// Replaces the materials of a mesh by the table's of the same names, matched as those of labels;
  /// `names` are by index. Materials without a name keep their number. Throws InputError, starting
  /// with `where`, on names and numbers that the table lacks, on a tetrahedron of air, and if only
  /// some materials have names and these come in another order.
  void FitMesh(TetrahedralMesh& mesh, const std::vector<std::string>& names,
    const std::string& where) const;
  void FitMesh(SurfaceMesh& mesh, const std::vector<std::string>& names,
    const std::string& where) const;
  /// Index of the material with this name, matched as those of labels. Throws InputError with the
  /// known names if there is none.
  int IndexOf(const std::string& name) const;
  /// One entry per material, in order.
  std::vector<std::string> Names() const;
  /// The name of each label's material, for LabelVolume::Names, without air.
  std::map<int, std::string> LabelNames() const;
  std::vector<bool> Fixed() const;
  /// Indices of the materials that are Thin.
  std::vector<int> Thin() const;
  /// Indices of the materials that are not fixed and attenuate like gland; the stiffness ratio
  /// applies to them.
  std::vector<int> Glandular() const;
};
}

#endif
