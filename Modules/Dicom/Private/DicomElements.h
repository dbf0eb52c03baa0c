// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_DicomElements_h
#define mammoray_Private_DicomElements_h

#include "mammoray/Dicom/DicomHeader.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/// An element with a text value. A '\' separates multiple values.
struct DicomTextElement
{
  DcmTagKey Tag;
  DcmEVR Representation;
  std::string Value;
};
void AddTexts(DcmItem& data, const std::vector<DicomTextElement>& elements);

/// Adds or replaces an element with binary values (AT, FD, FL, OB, OF, OW, SL, SS, UL, US) of
/// `count` bytes. Throws InputError if a file cannot hold that many.
void AddBytes(DcmItem& data, const DcmTagKey& tag, DcmEVR representation, const void* bytes,
  std::size_t count);

/// Adds single-precision numbers (FL).
void AddFloats(DcmItem& data, const DcmTagKey& tag, const std::vector<float>& values);

/// Adds double-precision numbers (FD).
void AddDoubles(DcmItem& data, const DcmTagKey& tag, const std::vector<double>& values);

/// Appends a position in graphics coordinates, whose origin is the upper left corner of the first
/// pixel (PS3.3 C.10.5.1.2). The origin of `pixel` is the centre of that pixel.
void AppendPixel(std::vector<float>& points, const std::array<double, 2>& pixel);

/// Adds an unsigned short (US).
void AddShort(DcmItem& data, const DcmTagKey& tag, std::uint16_t value);

/// Adds a sequence, which may be empty.
void AddSequence(DcmItem& data, const DcmTagKey& tag, const std::vector<DcmItem>& items);

/// Scheme of codes that no public scheme has.
inline constexpr const char* OwnCodes = "99MAMMORAY";

/// Item of a code sequence, by default of SNOMED CT.
DcmItem DicomCode(const std::string& value, const std::string& meaning,
  const std::string& scheme = "SCT");

/**
 * Adds what every object has: class, new UIDs of object and series, patient and study, this
 * software as the equipment, and the time.
 */
void AddCommon(DcmItem& data, const std::string& sopClassUid, const std::string& modality,
  const std::string& seriesDescription, const DicomIdentity& identity);

/// Items that refer to an image, and to an image as a member of its series.
DcmItem ImageReference(const DicomReference& image);
DcmItem SeriesReference(const DicomReference& image, const DcmTagKey& images);

/// A decimal string (DS) of ten significant digits.
std::string DecimalString(double value);

/// Generates a UID.
std::string NewUid();

/// Writes a copy of the data set as a file in explicit VR little endian. Throws InputError if it
/// cannot be written.
void WriteDicom(DcmItem& data, const std::string& path);
}

#endif
