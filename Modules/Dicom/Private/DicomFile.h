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
/// True if the file starts with a DICOM preamble (PS3.10).
bool HasDicomPreamble(const std::string& path);

/// Part of a file to read.
enum class DicomExtent
{
  Whole,
  /// Everything before the pixels.
  Header,
  /// All elements, but long values such as pixels are only located.
  Elements
};

/// What a slice lacks of a place in the patient (ReadSlicePlace), for messages. Empty: nothing.
std::string MissingOfPlace(DcmItem& data);

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
  /// Media Storage SOP Class UID of the meta information. Empty if there is none.
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

/// True if the pixels lie in fragments (compressed). DCMTK 3.6.9 has another name for it.
template <typename Syntax>
bool IsEncapsulated(const Syntax& syntax)
{
  if constexpr (requires { syntax.usesEncapsulatedFormat(); })
  {
    return syntax.usesEncapsulatedFormat();
  }
  else
  {
    return syntax.isEncapsulated();
  }
}

/// Value `index` of an element without padding. Empty if missing.
std::string DicomText(DcmItem& data, const DcmTagKey& tag, unsigned long index = 0);

/// All values of an element, separated by '\' as in the file.
std::string DicomTexts(DcmItem& data, const DcmTagKey& tag);

/// A decimal or integer string (DS, IS). Nothing if it is missing, malformed or not finite.
std::optional<double> DicomNumber(DcmItem& data, const DcmTagKey& tag, unsigned long index = 0);

/// The first `count` numbers of an element. Empty if there are fewer.
std::vector<double> DicomNumbers(DcmItem& data, const DcmTagKey& tag, unsigned long count);

/// The bits of a short (US, SS). Nothing if it is missing.
std::optional<std::uint16_t> DicomShort(DcmItem& data, const DcmTagKey& tag);

/// An unsigned long (UL). Nothing if it is missing.
std::optional<std::uint32_t> DicomUnsigned(DcmItem& data, const DcmTagKey& tag);

/// Reads the place of a slice. Of an enhanced object, `data` is a frame from DicomFrames::Flat.
SlicePlace ReadSlicePlace(DcmItem& data);

/// Patient and study of a data set.
DicomIdentity ReadIdentity(DcmItem& data);

/// The first item of a sequence. Null if there is none.
DcmItem* DicomFirstItem(DcmItem& data, const DcmTagKey& sequence);
}

#endif
