// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Places_h
#define mammoray_Places_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Vector3.h"

#include <QString>

#include <array>
#include <optional>
#include <vector>

namespace mammoray
{
/// A place of the breast at rest that has a name: a lesion.
struct NamedPlace
{
  QString Name;
  /// Volume frame, mm.
  Vector3 Point{ 0, 0, 0 };
};

/// What is marked: a point of the breast at rest, or a pixel of a mammogram; or nothing.
struct MarkedPlace
{
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  std::size_t Mammogram = 0;
};

/// All marks of a result, the state that can be undone.
struct Marks
{
  std::vector<NamedPlace> Places;
  MarkedPlace Marked;
};

/// The file of a result's folder that keeps the named places.
inline constexpr const char* MarksFileName = "marks.json";

/// Reads the file; none: no places. Throws InputError, one line, on anything else.
std::vector<NamedPlace> ReadPlaces(const QString& path);
/// Writes it atomically. Throws InputError.
void WritePlaces(const std::vector<NamedPlace>& places, const QString& path);

/// Patient coordinates, mm: towards the left, back and head.
Vector3 ToLps(const Vector3& point, const AnatomicalAxes& axes);
/// "LPS 12.3 -45.6 78.9 mm" and the same in RAS, two lines.
QString CoordinatesText(const Vector3& point, const AnatomicalAxes& axes);
}

#endif
