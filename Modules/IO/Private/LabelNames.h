// SPDX-License-Identifier: Apache-2.0
// Names of labels, as programs that edit label volumes keep them: 3D Slicer in the header of its
// .seg.nrrd, ITK-SNAP in a text beside the volume.
#ifndef mammoray_Private_LabelNames_h
#define mammoray_Private_LabelNames_h

#include "Private/StoredVoxels.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayIOModule.h"

#include <map>
#include <string>
#include <vector>

namespace mammoray
{
/// A segment of 3D Slicer.
struct Segment
{
  /// Its name; its ID if it has none. Not empty.
  std::string Name;
  /// The value of its voxels, 1 to 65535, in the volume of its layer, from 0.
  int Label = 1;
  int Layer = 0;
};

/**
 * The segments that an NRRD's header describes by its pairs "SegmentN_...", in the order of N; none
 * in a header without them. Throws InputError, one line, on values that are no label or layer, and
 * if one label of a layer has two names.
 */
MAMMORAYIO_EXPORT std::vector<Segment> ReadSegments(const TextHeader& header);

/**
 * Names of the labels in a volume file: those of its segments, or else those of the label
 * description of ITK-SNAP beside it (LabelDescriptionOf). Empty: none. Throws InputError, one line,
 * if one of them is damaged and if they contradict each other.
 */
MAMMORAYIO_EXPORT std::map<int, std::string> ReadLabelNames(const std::string& path);

/// The pairs with which 3D Slicer shows the named labels of a volume as segments.
std::map<std::string, std::string> SegmentPairs(const LabelVolume& volume);

/// The text by which ITK-SNAP knows the named labels ("Export Label Descriptions").
std::string LabelDescription(const LabelVolume& volume);
}

#endif
