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

/// Adds single precision numbers (FL).
void AddFloats(DcmItem& data, const DcmTagKey& tag, const std::vector<float>& values);

/// Adds double precision numbers (FD).
void AddDoubles(DcmItem& data, const DcmTagKey& tag, const std::vector<double>& values);

/// Appends a place on an image as graphics want it, with 0 at the upper left corner of the first
/// pixel (PS3.3 C.10.5.1.2); ours is 0 at that pixel's centre.
void AppendPixel(std::vector<float>& points, const std::array<double, 2>& pixel);

/// Adds an unsigned short (US).
void AddShort(DcmItem& data, const DcmTagKey& tag, std::uint16_t value);

/// Adds a sequence; one without items is present and empty.
void AddSequence(DcmItem& data, const DcmTagKey& tag, const std::vector<DcmItem>& items);

/// The scheme of codes that no public one has.
inline constexpr const char* OwnCodes = "99MAMMORAY";

/// The item of a code sequence, of SNOMED CT or another scheme.
DcmItem DicomCode(const std::string& value, const std::string& meaning,
  const std::string& scheme = "SCT");

/**
 * What every object has: its class and new UIDs of itself and its series, patient and study, this
 * software as the equipment, and the time.
 */
void AddCommon(DcmItem& data, const std::string& sopClassUid, const std::string& modality,
  const std::string& seriesDescription, const DicomIdentity& identity);

/// The item that refers to an image, and the one that refers to it as a member of its series.
DcmItem ImageReference(const DicomReference& image);
DcmItem SeriesReference(const DicomReference& image, const DcmTagKey& images);

/// A decimal string: at most 16 characters, ten digits.
std::string DecimalString(double value);

/// A unique identifier that no other object has.
std::string NewUid();

/// Writes a copy of the data set as a file in explicit VR little endian. Throws InputError if it
/// cannot be written.
void WriteDicom(DcmItem& data, const std::string& path);
}

#endif
