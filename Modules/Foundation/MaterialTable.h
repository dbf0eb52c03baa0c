// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MaterialTable_h
#define mammoray_MaterialTable_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammorayFoundationModule.h"

#include <map>
#include <string>
#include <vector>

namespace mammoray
{
struct SurfaceMesh;
struct TetrahedralMesh;

/// What one material is to X-rays and to mechanics.
struct Material
{
  /// Unique, not empty.
  std::string Name;
  /// Name of the attenuation table (see XRay's AttenuationTable); empty for air.
  std::string Attenuation;
  /// Mass density, g/cm^3; scales the attenuation table from its nominal density. Positive.
  double DensityGPerCm3 = 1.0;
  /// Iodine that it has taken up besides, mg per ml, [0, 500]: a contrast agent.
  double IodineMgPerMl = 0.0;
  /// Young's modulus at small strain, kPa. Positive.
  double YoungsModulusKPa = 5.0;
  /// Poisson's ratio, [0, 0.5).
  double PoissonRatio = 0.49;
  /// How fast it stiffens, [0, 50]; 0: neo-Hookean (see Biomechanics' ElasticMaterial).
  double FungExponent = 0.0;
  /// True where the tissue is fixed to the body (chest wall, pectoral muscle): it does not move.
  bool Held = false;
  /// True for a layer of about a millimetre (skin), which meshes must resolve to keep closed.
  bool Thin = false;
};

/**
 * Which material each label of a volume is made of. Material 0 is always air; several labels may
 * share a material.
 */
struct MAMMORAYFOUNDATION_EXPORT MaterialTable
{
  /// Name of the table, for messages and reports.
  std::string Name;
  /// Materials[0] is air.
  std::vector<Material> Materials;
  /// Label -> index into Materials.
  std::map<int, int> MaterialOfLabel;

  /**
   * The volume with every label replaced by its material's index. Throws InputError that names each
   * unknown label and its voxel count (the first ten of many), and when no voxel is anything but
   * air.
   */
  LabelVolume ToMaterials(const LabelVolume& labels, const std::string& volumeName) const;
  /**
   * Throws InputError, which names `where`, unless the mesh's materials are this table's: none
   * beyond its last, and where the mesh has names for its materials, by index, the same ones. No
   * tetrahedron is of air.
   */
  void CheckMesh(const TetrahedralMesh& mesh, const std::vector<std::string>& names,
    const std::string& where) const;
  void CheckMesh(const SurfaceMesh& mesh, const std::vector<std::string>& names,
    const std::string& where) const;
  /// Index of the material of that name; throws InputError with the known names otherwise.
  int IndexOf(const std::string& name) const;
  /// One entry for each material, in their order.
  std::vector<std::string> Names() const;
  std::vector<bool> Held() const;
  /// Indices of those that are Thin.
  std::vector<int> Thin() const;
  /// Indices of those that are not held and attenuate as gland: what the ratio of stiffness is
  /// about.
  std::vector<int> Glandular() const;
};
}

#endif
