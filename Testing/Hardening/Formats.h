// SPDX-License-Identifier: Apache-2.0
// The formats that are read, each with a small whole file of our own making.
#ifndef mammoray_Testing_Formats_h
#define mammoray_Testing_Formats_h

#include <functional>
#include <string>
#include <vector>

namespace mammoray::hardening
{
struct Format
{
  /// With the extension, "volume.nrrd".
  std::string Name;
  std::string Bytes;
  /// Reads a file as a command would; throws Error.
  std::function<void(const std::string& path)> Read;
  /// Whether its header is DICOM's.
  bool IsDicom = false;
};

/// Writes the files into `folder`, where they stay, and reads them back.
std::vector<Format> MakeFormats(const std::string& folder);
}

#endif
