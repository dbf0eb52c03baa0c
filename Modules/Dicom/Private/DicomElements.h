// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_DicomElements_h
#define mammoray_Private_DicomElements_h

#include "mammoray/Dicom/DicomHeader.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace mammoray
{
/// The value of an element: a text ('\' separates multiple values), numbers, or the items of a
/// sequence. An absent number leaves the element out.
class DicomValue : public std::variant<std::string, std::vector<double>, std::vector<DcmItem>>
{
public:
  DicomValue(const std::string& text)
    : variant(text)
  {
  }
  DicomValue(const char* text)
    : variant(std::string(text))
  {
  }
  template <typename T>
  requires std::is_arithmetic_v<T> DicomValue(T number)
    : variant(std::vector<double>{ static_cast<double>(number) })
  {
  }
  DicomValue(const std::optional<double>& number)
    : variant(number ? std::vector<double>{ *number } : std::vector<double>())
  {
  }
  DicomValue(const std::vector<double>& numbers)
    : variant(numbers)
  {
  }
  DicomValue(const Vector3& numbers)
    : variant(std::vector<double>(numbers.begin(), numbers.end()))
  {
  }
  DicomValue(std::initializer_list<double> numbers)
    : variant(std::vector<double>(numbers))
  {
  }
  DicomValue(const DcmItem& item)
    : variant(std::vector<DcmItem>{ item })
  {
  }
  DicomValue(const std::vector<DcmItem>& items)
    : variant(items)
  {
  }
};

/// The text, or no value, which leaves the element out, if the text is empty.
inline DicomValue IfAny(const std::string& text)
{
  return text.empty() ? DicomValue(std::optional<double>()) : DicomValue(text);
}

/// The value of an empty sequence.
inline const std::vector<DcmItem> NoItems;

/// An element to be written; its representation is the tag's, or that of DCMTK's dictionary.
struct DicomElement
{
  DcmTag Tag;
  DicomValue Value;
};

/// Adds or replaces elements. Numbers of DS have ten significant digits.
void Add(DcmItem& data, std::initializer_list<DicomElement> elements);

/// An item of these elements.
DcmItem Item(std::initializer_list<DicomElement> elements);

/// Adds bytes (OB), words (OW) or floats (OF). Throws InputError if a file cannot hold that many.
void AddBulk(DcmItem& data, const DcmTagKey& tag, const std::vector<std::uint8_t>& values);
void AddBulk(DcmItem& data, const DcmTagKey& tag, const std::vector<std::uint16_t>& values);
void AddBulk(DcmItem& data, const DcmTagKey& tag, const std::vector<float>& values);

/// Adds the Image Pixel module of one unsigned value of `bits` per pixel, without the pixels.
void AddPixelDescription(DcmItem& data, int columns, int rows, int bits,
  const std::string& photometric = "MONOCHROME2");

/// Appends a position in graphics coordinates, whose origin is the upper left corner of the first
/// pixel (PS3.3 C.10.5.1.2). The origin of `pixel` is the centre of that pixel.
void AppendPixel(std::vector<double>& points, const std::array<double, 2>& pixel);

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
DcmItem ImageReference(const DicomHeader& image);
DcmItem SeriesReference(const DicomHeader& image, const DcmTagKey& images);

/// Generates a UID.
std::string NewUid();

/// The local time, formatted by std::strftime; at most 23 characters.
std::string TimeNow(const char* format);

/// Writes a copy of the data set as a file in explicit VR little endian. Throws InputError if it
/// cannot be written.
void WriteDicom(DcmItem& data, const std::string& path);
}

#endif
