// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_DicomFile_h
#define mammoray_Private_DicomFile_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammorayDicomModule.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// True where a file begins as DICOM files do (PS3.10).
bool HasDicomPreamble(const std::string& path);

/// True where it does, or begins as a data set or meta information do in little endian: files of
/// older software have no preamble.
bool HasDicomHeader(const std::string& path);

/// How much of a file is read.
enum class DicomExtent
{
  Whole,
  /// Up to the pixels.
  Header,
  /// To its end, but of long values, the pixels among them, only where they are.
  Elements
};

/// A DICOM file, parsed by DCMTK: preamble, meta information and data set.
class DicomFile
{
public:
  /// Throws InputError that names the file if it is truncated or damaged. `what` is the expected
  /// content.
  DicomFile(const std::string& path, const std::string& what,
    DicomExtent extent = DicomExtent::Whole);

  /// Returns null if the file only looks like DICOM: without preamble, it cannot be parsed or has
  /// no Modality. Otherwise throws as the constructor does.
  static std::unique_ptr<DicomFile> OpenIfDicom(const std::string& path, DicomExtent extent);

  const std::string& Path() const { return this->Name; }
  DcmDataset& Data() const { return *this->File->getDataset(); }
  /// Media Storage SOP Class UID of the meta information; empty where there is none.
  std::string StorageClass() const;

private:
  std::string Name;
  /// DCMTK logs warnings when values are read from the data set, too.
  std::shared_ptr<void> Quiet;
  std::unique_ptr<DcmFileFormat> File;
  bool Preamble;
};

/// DCMTK's log is silent while one of these lives, in all threads.
std::shared_ptr<void> SilenceDcmtk();

/// Throws InputError, one line that names the file, unless every element of a DICOM file can be
/// read, including those after the pixels. DCMTK overflows its stack on sequences that are nested a
/// thousandfold.
MAMMORAYDICOM_EXPORT void CheckDicomElements(const std::string& path);

/// A value of an element without its padding; empty where there is none.
std::string DicomText(DcmItem& data, const DcmTagKey& tag, unsigned long index = 0);

/// All values of an element with '\' between them, as in the file.
std::string DicomTexts(DcmItem& data, const DcmTagKey& tag);

/// A decimal or integer string (DS, IS); nothing when it is absent, malformed or not finite.
std::optional<double> DicomNumber(DcmItem& data, const DcmTagKey& tag, unsigned long index = 0);

/// The first `count` numbers of an element; empty unless there are as many.
std::vector<double> DicomNumbers(DcmItem& data, const DcmTagKey& tag, unsigned long count);

/// The bits of a short (US, SS); nothing when it is absent.
std::optional<std::uint16_t> DicomShort(DcmItem& data, const DcmTagKey& tag);

/// The value of a long (UL); nothing when it is absent.
std::optional<std::uint32_t> DicomUnsigned(DcmItem& data, const DcmTagKey& tag);

/// The distance of slices that a header tells, mm; 0 where it tells none.
double DicomSliceSpacing(DcmItem& data);

/// Whom a data set is about, and in which study.
DicomIdentity ReadIdentity(DcmItem& data);

/// The first item of a sequence; null where there is none.
DcmItem* DicomFirstItem(DcmItem& data, const DcmTagKey& sequence);
}

#endif
