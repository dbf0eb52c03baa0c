// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_DicomFrames_h
#define mammoray_Private_DicomFrames_h

#include "Private/DicomFile.h"

#include <cstddef>
#include <memory>
#include <string>

namespace mammoray
{
/// True for an MR object whose frames have functional groups (PS3.3 C.7.6.16).
bool HasResonanceFrames(DcmItem& data);

/// Presents a multi-frame object as one data set per frame.
class DicomFrames
{
public:
  /// Throws InputError that names the file unless each frame has its functional groups.
  DicomFrames(DcmItem& data, const std::string& path);

  std::size_t Count() const { return this->Groups->card(); }

  /**
   * Merges the object's own elements, without pixels and functional groups, with the shared groups
   * and then the groups of the frame (from 0). Later elements replace earlier ones. A converted
   * object keeps its original attributes in a group, too (PS3.3 C.7.6.16.2.25).
   */
  std::unique_ptr<DcmItem> Flat(std::size_t frame) const;

private:
  std::unique_ptr<DcmItem> Own;
  DcmSequenceOfItems* Groups = nullptr;
  DcmItem* Shared = nullptr;
};
}

#endif
