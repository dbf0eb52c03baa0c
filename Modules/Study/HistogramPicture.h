// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_HistogramPicture_h
#define mammoray_HistogramPicture_h

#include "mammorayStudyModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Bars of one panel: how many things of each group fall into each bin.
struct HistogramPanel
{
  /// It names the unit, too: "smallest dihedral angle [deg]".
  std::string Title;
  /// Width of a bin, in that unit; the first begins at 0.
  double Step = 1;
  struct Group
  {
    std::string Name;
    /// All groups have as many bins.
    std::vector<std::size_t> Counts;
  };
  std::vector<Group> Groups;
};

/**
 * Draws panels side by side, the height of a bar on a square-root scale, so that a few bad cells
 * among many are seen, and divided in colours by the shares of the groups, and writes .png. No
 * display is needed. Throws InputError when there is nothing to draw or the file cannot be written.
 */
MAMMORAYSTUDY_EXPORT void WriteHistogramPicture(const std::vector<HistogramPanel>& panels,
  const std::string& path);
}

#endif
