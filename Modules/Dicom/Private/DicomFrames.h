// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_DicomFrames_h
#define mammoray_Private_DicomFrames_h

#include "Private/DicomFile.h"

#include <cstddef>
#include <memory>
#include <string>

namespace mammoray
{
/// Whether a data set is an MR object of frames with functional groups (PS3.3 C.7.6.16).
bool HasResonanceFrames(DcmItem& data);

/// A multi-frame object seen as data sets of single frames.
class DicomFrames
{
public:
  /// Throws InputError that names the file unless each frame has its functional groups.
  DicomFrames(DcmItem& data, const std::string& path);

  std::size_t Count() const { return this->Groups->card(); }

  /**
   * The object's own elements but pixels and functional groups, and what the groups that all frames
   * share, then those of the frame (from 0), say; all on one level, the later in place of the
   * earlier. The attributes of a converted object are in a group, too (PS3.3 C.7.6.16.2.25).
   */
  std::unique_ptr<DcmItem> Flat(std::size_t frame) const;

private:
  std::unique_ptr<DcmItem> Own;
  DcmSequenceOfItems* Groups = nullptr;
  DcmItem* Shared = nullptr;
};
}

#endif
