// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelSource_h
#define mammoray_LabelSource_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammorayStudyModule.h"

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
}

#endif
