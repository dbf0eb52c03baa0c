// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/Places.h"

#include "mammoray/Foundation/Error.h"

#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QSaveFile>

namespace mammoray
{
std::vector<NamedPlace> ReadPlaces(const QString& path)
{
  QFile file(path);
  if (!file.exists())
  {
    return {};
  }
  const auto refuse = [&path](const QString& why)
  { throw InputError((path + ": expected marks of this program, found " + why).toStdString()); };
  if (!file.open(QIODevice::ReadOnly))
  {
    throw InputError((path + ": cannot be read (" + file.errorString() + ")").toStdString());
  }
  QJsonParseError error;
  const QJsonDocument document = QJsonDocument::fromJson(file.readAll(), &error);
  if (document.isNull())
  {
    refuse(error.errorString());
  }
  std::vector<NamedPlace> places;
  const QJsonArray marks = document.object().value("marks").toArray();
  for (const auto& entry : marks)
  {
    const QJsonObject mark = entry.toObject();
    const QJsonArray point = mark.value("point").toArray();
    if (point.size() != 3 || !point[0].isDouble() || !point[1].isDouble() || !point[2].isDouble())
    {
      refuse("a mark without a point of three numbers");
    }
    places.push_back({ mark.value("name").toString(),
      { point[0].toDouble(), point[1].toDouble(), point[2].toDouble() } });
  }
  return places;
}

void WritePlaces(const std::vector<NamedPlace>& places, const QString& path)
{
  QJsonArray marks;
  for (const NamedPlace& place : places)
  {
    marks.append(QJsonObject{ { "name", place.Name },
      { "point", QJsonArray{ place.Point[0], place.Point[1], place.Point[2] } } });
  }
  const QJsonObject document{ { "frame", "of the labels, mm" }, { "marks", marks } };
  QSaveFile file(path);
  if (!file.open(QIODevice::WriteOnly) || file.write(QJsonDocument(document).toJson()) < 0 ||
    !file.commit())
  {
    throw InputError((path + ": cannot be written (" + file.errorString() + ")").toStdString());
  }
}

Vector3 ToLps(const Vector3& point, const AnatomicalAxes& axes)
{
  return { Dot(point, axes.Left), -Dot(point, axes.Anterior), Dot(point, axes.Superior) };
}

QString CoordinatesText(const Vector3& point, const AnatomicalAxes& axes)
{
  const Vector3 lps = ToLps(point, axes);
  return QString("LPS %1 %2 %3 mm\nRAS %4 %5 %3 mm")
    .arg(lps[0], 0, 'f', 1)
    .arg(lps[1], 0, 'f', 1)
    .arg(lps[2], 0, 'f', 1)
    .arg(-lps[0], 0, 'f', 1)
    .arg(-lps[1], 0, 'f', 1);
}
}
