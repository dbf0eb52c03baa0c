// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomNetwork_h
#define mammoray_DicomNetwork_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayDicomModule.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace mammoray
{
/// An archive cannot be reached, does not answer in time or refuses.
class NetworkError : public Error
{
public:
  using Error::Error;
};

/// Encryption of a connection. All files are PEM.
struct TlsSettings
{
  /// If false, the connection is not encrypted and no file may be given.
  bool Wanted = false;
  /// Certificates of the authorities that may sign the archive's certificate. Empty: the system's.
  std::string AuthoritiesFile;
  /// Own certificate and its key, without passphrase, for archives that require them. Give both or
  /// neither.
  std::string CertificateFile;
  std::string KeyFile;
};

/// An archive that speaks the DICOM protocol (PS3.8).
struct DicomNode
{
  std::string Host;
  int Port = 104;
  /// Application entity titles of the archive and of this program, 1 to 16 characters.
  std::string CalledTitle = "ANY-SCP";
  std::string CallingTitle = "MAMMORAY";
  /// Time-out of the connection and of each answer, s; at least 1.
  int TimeoutSeconds = 30;
  /// With TLS, the archive's certificate must name `Host`.
  TlsSettings Tls;
};

/// Parses "HOST:PORT"; an IPv6 address stands in brackets. Throws InputError on anything else.
MAMMORAYDICOM_EXPORT void SetAddress(DicomNode& node, const std::string& hostAndPort);

/// An archive that speaks DICOMweb (PS3.18).
struct DicomWebServer
{
  /// The part before "/studies": https://pacs.example.org/dicom-web. With https the server's
  /// certificate must match its name. User name and password come from ~/.netrc.
  std::string Url;
  /// Certificates of authorities (PEM) that replace the system's. Empty: the system's.
  std::string AuthoritiesFile;
  /// Time-out of the connection, and of any period without traffic, s; at least 1.
  int TimeoutSeconds = 30;
};

/// Called with each file that was sent; `refusal`: why the archive has not stored it, empty if it
/// has.
using StoredCallback = std::function<void(const std::string& file, const std::string& refusal)>;
/// Returns true to stop the work.
using StopRequest = std::function<bool()>;

/// Lists files in order: `paths` that are files, and the files in `paths` that are folders. Those
/// that are damaged or not DICOM are left out and told to `refused`. Throws InputError if there are
/// no others, or, without `refused`, if one is not DICOM.
MAMMORAYDICOM_EXPORT std::vector<std::string> FindDicomFiles(const std::vector<std::string>& paths,
  const StoredCallback& refused = {});

/// Asks whether the archive speaks to this program (C-ECHO). Throws InputError on unusable titles,
/// NetworkError with the reason if it does not.
MAMMORAYDICOM_EXPORT void VerifyNode(const DicomNode& node);

/**
 * Stores DICOM files in the archive (C-STORE), in order over one association, without changing
 * their values. What it refuses does not stop the others, a lost connection does. Throws InputError
 * before anything is sent if a file is not DICOM; NetworkError with the first refusal and the
 * number of stored files, unless these are all; and Interrupted.
 */
MAMMORAYDICOM_EXPORT void StoreFiles(const std::vector<std::string>& files, const DicomNode& node,
  const StoredCallback& stored, const StopRequest& stop = {});

/// Stores DICOM files by STOW-RS, one request per file, byte for byte. Throws InputError on an
/// invalid address, otherwise as StoreFiles does.
MAMMORAYDICOM_EXPORT void StoreFilesOnWeb(const std::vector<std::string>& files,
  const DicomWebServer& server, const StoredCallback& stored, const StopRequest& stop = {});

/// The reason why a DICOMweb server did not store an object, from the status and JSON body of its
/// answer (PS3.18 section 10.5.3, PS3.3 C.30.1.2). Empty if it was stored. Parts of the body that
/// do not follow the standard are ignored.
MAMMORAYDICOM_EXPORT std::string WhyNotStored(long status, const std::string& body);

/// The archive's description of a study.
struct ArchivedStudy
{
  std::string StudyInstanceUid;
  std::string AccessionNumber;
  std::string PatientId;
  std::string Date;
  std::string Description;
};

/**
 * Finds the studies with an accession number (C-FIND). Throws InputError if the number contains
 * wildcards, if no study has it, or if the studies belong to several patients; NetworkError.
 */
MAMMORAYDICOM_EXPORT std::vector<ArchivedStudy> FindStudies(const std::string& accessionNumber,
  const DicomNode& node);

/**
 * Gets the objects of the studies (C-GET) that are useful for a registration or describe one: MR,
 * MG, breast tomosynthesis, SEG, PR, SR and REG. They are written to a new folder, complete or not
 * at all, with a numbered subfolder per series and numbered files. Returns the number of objects.
 * Throws NetworkError if an object is missing, InputError if the folder cannot be written, and
 * Interrupted.
 */
MAMMORAYDICOM_EXPORT std::size_t GetStudies(const std::vector<ArchivedStudy>& studies,
  const DicomNode& node, const std::string& folder, const ProgressCallback& progress = {});
}

#endif
