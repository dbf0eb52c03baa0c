// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_DicomElements_h
#define mammoray_Private_DicomElements_h

#include "mammoray/Dicom/DicomHeader.h"

#include <gdcmDataSet.h>
#include <gdcmTag.h>
#include <gdcmVR.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/// An element's text without the padding at its end; empty where it is absent.
std::string DicomText(const gdcm::DataSet& data, const gdcm::Tag& tag);

/// An element whose value is text: several values with '\' between them.
struct DicomTextElement
{
  gdcm::Tag Tag;
  gdcm::VR::VRType Representation;
  std::string Value;
};
void AddTexts(gdcm::DataSet& data, const std::vector<DicomTextElement>& elements);

/// Adds an element of binary values (US, SS, OB, OW), padded to an even length. Throws
/// InputError on more than a file can hold.
void AddBytes(gdcm::DataSet& data, const gdcm::Tag& tag, gdcm::VR::VRType representation,
  const void* bytes, std::size_t count);

/// Adds single precision numbers (FL).
void AddFloats(gdcm::DataSet& data, const gdcm::Tag& tag, const std::vector<float>& values);

/// Adds double precision numbers (FD).
void AddDoubles(gdcm::DataSet& data, const gdcm::Tag& tag, const std::vector<double>& values);

/// Appends a place on an image as graphics want it, with 0 at the upper left corner of the first
/// pixel (PS3.3 C.10.5.1.2); ours is 0 at that pixel's centre.
void AppendPixel(std::vector<float>& points, const std::array<double, 2>& pixel);

/// Adds an unsigned short (US).
void AddShort(gdcm::DataSet& data, const gdcm::Tag& tag, std::uint16_t value);

/// Adds a sequence; one without items is present and empty.
void AddSequence(gdcm::DataSet& data, const gdcm::Tag& tag,
  const std::vector<gdcm::DataSet>& items);

/// The scheme of codes that no public one has.
inline constexpr const char* OwnCodes = "99MAMMORAY";

/// The item of a code sequence, of SNOMED CT or another scheme.
gdcm::DataSet DicomCode(const std::string& value, const std::string& meaning,
  const std::string& scheme = "SCT");

/**
 * What every object has: its class and new UIDs of itself and its series, patient and study, this
 * software as the equipment, and the time.
 */
void AddCommon(gdcm::DataSet& data, const std::string& sopClassUid, const std::string& modality,
  const std::string& seriesDescription, const DicomIdentity& identity);

/// The item that refers to an image, and the one that refers to it as a member of its series.
gdcm::DataSet ImageReference(const DicomReference& image);
gdcm::DataSet SeriesReference(const DicomReference& image, const gdcm::Tag& images);

/// A decimal string: at most 16 characters, ten digits.
std::string DecimalString(double value);

/// A unique identifier that no other object has.
std::string NewUid();

/// Writes a data set as a file in explicit VR little endian; throws InputError when it cannot be
/// written.
void WriteDicom(const gdcm::DataSet& data, const std::string& path);
}

#endif
