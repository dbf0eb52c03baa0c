// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelSource_h
#define mammoray_LabelSource_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayStudyModule.h"

#include <cstddef>
#include <string>
#include <vector>

namespace mammoray
{
/// A label volume and the steps that prepare it.
struct LabelSource
{
  /// A file or folder that ReadLabelVolume reads.
  std::string Path;
  /// Keeps the header's axes, without conversion to LPS (VolumeAxes::AsGiven).
  bool AxesAsGiven = false;
  /**
   * Voxels to keep along i, j and k, counted from 0: "FIRST:LAST", both included, ":" for all;
   * either end may be left out. Empty: all.
   */
  std::vector<std::string> Crop;
  /// Voxel size after resampling, mm; 0 keeps the grid.
  double SpacingMm = 0;
  /// Volumes that are as coarse as SpacingMm along some axis keep their grid.
  bool OnlyCoarsen = false;
  /**
   * A skin to add (see AddSkin): "THICKNESS", mm, of the table's only thin material, or
   * "THICKNESS=MATERIAL". Empty: none.
   */
  std::string Skin;
  /**
   * Sides of the grid at which the tissue was cut flat, "i-", "i+" to "k+". The air behind its last
   * voxels there is removed, so that the cut gets no skin, and the tissue is fixed there
   * (CutTissue). The volume alone cannot show whether tissue was cut, as before a chest wall, or
   * has the flat skin of a breast between plates.
   */
  std::vector<std::string> CutSides;
  /// Accepts values outside their ValidRange, of the volume and of its processing.
  bool AcceptUnusual = false;
};

/**
 * The volume of material indices: read, cropped, labels replaced by materials, resampled, cut at
 * its CutSides and given its skin. Throws InputError, one line, on all that can be wrong with it.
 */
MAMMORAYSTUDY_EXPORT LabelVolume ReadMaterials(const LabelSource& source,
  const MaterialTable& table);

/// An end of a grid: before the first or after the last voxel of an axis.
struct GridSide
{
  std::size_t Axis = 0;
  bool AtEnd = false;
};

/// Names of the sides: "i-", "i+", "j-", "j+", "k-", "k+".
MAMMORAYSTUDY_EXPORT const std::vector<std::string>& GridSides();
/// The side of a name. Throws InputError on other names.
MAMMORAYSTUDY_EXPORT GridSide FindGridSide(const std::string& name);

/**
 * The tissue that was cut off when `kept` was taken out of `whole` (the same grid): what only
 * `whole` has, and beyond the ends `sides` of its tissue a layer of 20 mm that continues the last
 * voxels. Thin materials (skin) are not continued: they were not cut. Material indices, 0
 * elsewhere; on the axes of the volumes, in the same frame. Throws InputError on other sides than
 * GridSides, on grids of two sizes and if `whole` is empty.
 */
MAMMORAYSTUDY_EXPORT LabelVolume CutTissue(const LabelVolume& whole, const LabelVolume& kept,
  const MaterialTable& table, const std::vector<std::string>& sides);

/// A function that tells for simulations whether a point lies in tissue that was cut off
/// (BodyField).
MAMMORAYSTUDY_EXPORT BodyField InCutTissue(LabelVolume cut);
/// The same for a volume whose body continues beyond these sides. Empty if there are no sides.
MAMMORAYSTUDY_EXPORT BodyField InCutTissue(const LabelVolume& materials, const MaterialTable& table,
  const std::vector<std::string>& sides);
}

#endif
