// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomWeb_h
#define mammoray_DicomWeb_h

#include "mammoray/Archive/DicomNode.h"
#include "mammorayArchiveModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// An archive that is asked by DICOMweb (PS3.18).
struct DicomWebServer
{
  /// Up to where "/studies" follows: https://pacs.example.org/dicom-web. With https the server must
  /// prove its name. Name and password are those of ~/.netrc, for this host.
  std::string Url;
  /// Certificates of authorities (PEM) in place of the system's; empty: those.
  std::string AuthoritiesFile;
  /// For the connection, and for any time in which nothing moves, s; at least 1.
  int TimeoutSeconds = 30;
};

/**
 * Stores DICOM files by STOW-RS, one after the other, their bytes as they are. Throws InputError on
 * another address, NetworkError with the number of those that were stored, Interrupted.
 */
MAMMORAYARCHIVE_EXPORT void StoreFilesOnWeb(const std::vector<std::string>& files,
  const DicomWebServer& server, const StoredCallback& stored, const StopRequest& stop = {});
}

#endif
