// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomNode_h
#define mammoray_DicomNode_h

#include "mammoray/Archive/NetworkError.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayArchiveModule.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace mammoray
{
/// How a connection is encrypted. All files are PEM.
struct TlsSettings
{
  /// Without it the connection is not encrypted, and no file may be named.
  bool Wanted = false;
  /// Certificates of the authorities that may vouch for the archive's; empty: the system's.
  std::string AuthoritiesFile;
  /// Our own certificate and its key, without passphrase, for archives that ask for them; both or
  /// neither.
  std::string CertificateFile;
  std::string KeyFile;
};

/// An archive that is asked by DICOM's own protocol (PS3.8).
struct DicomNode
{
  std::string Host;
  int Port = 104;
  /// Application entity titles, 1 to 16 characters: the archive's and ours.
  std::string CalledTitle = "ANY-SCP";
  std::string CallingTitle = "MAMMORAY";
  /// For the connection and for each answer, s; at least 1.
  int TimeoutSeconds = 30;
  /// With TLS the archive must prove that it is `Host`.
  TlsSettings Tls;
};

/// "HOST:PORT", an IPv6 address in brackets. Throws InputError on anything else.
MAMMORAYARCHIVE_EXPORT void SetAddress(DicomNode& node, const std::string& hostAndPort);

/// Told of each file that the archive has taken.
using StoredCallback = std::function<void(const std::string& file)>;
/// True where the work is to be stopped.
using StopRequest = std::function<bool()>;

/// Those of the paths that are files, and the files in those that are folders, in order; throws
/// InputError where one of them is no DICOM file or there is none.
MAMMORAYARCHIVE_EXPORT std::vector<std::string> FindDicomFiles(
  const std::vector<std::string>& paths);

/**
 * Stores DICOM files in the archive (C-STORE), in their order over one association, their values as
 * they are. Throws InputError before anything is sent where a file is none, NetworkError with the
 * number of those that were stored, Interrupted.
 */
MAMMORAYARCHIVE_EXPORT void StoreFiles(const std::vector<std::string>& files, const DicomNode& node,
  const StoredCallback& stored, const StopRequest& stop = {});

/// What the archive says of a study.
struct ArchivedStudy
{
  std::string StudyInstanceUid;
  std::string AccessionNumber;
  std::string PatientId;
  std::string Date;
  std::string Description;
};

/**
 * The studies with this accession number (C-FIND), which holds no wildcards. Throws InputError on
 * one that does, where there is no such study, and where they are of several patients;
 * NetworkError.
 */
MAMMORAYARCHIVE_EXPORT std::vector<ArchivedStudy> FindStudies(const std::string& accessionNumber,
  const DicomNode& node);

/**
 * Gets all objects of the studies (C-GET) of the kinds that a registration can use or that tell of
 * one (MR, MG and breast tomosynthesis, SEG, PR, SR, REG) into a new folder, complete or not at
 * all: a folder for each series with its objects, all numbered. Gives their number. Throws
 * NetworkError where one of these is not got, InputError where the folder cannot be written,
 * Interrupted.
 */
MAMMORAYARCHIVE_EXPORT std::size_t GetStudies(const std::vector<ArchivedStudy>& studies,
  const DicomNode& node, const std::string& folder, const ProgressCallback& progress = {});
}

#endif
