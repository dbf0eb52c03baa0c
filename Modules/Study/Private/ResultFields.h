// SPDX-License-Identifier: Apache-2.0
// The fields of result.json, each named once: ListFields tells a structure's fields to a
// FieldWriter or to a FieldReader, so that what is written and what is read cannot differ. A new
// field is one line in its list, one in docs/result-file.md, and a higher ResultFormatVersion.
#ifndef mammoray_ResultFields_h
#define mammoray_ResultFields_h

#include "mammoray/Study/ResultFile.h"

#include <nlohmann/json.hpp>

#include <array>
#include <concepts>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace mammoray
{
using Json = nlohmann::ordered_json;

/// A number that may be unknown: NaN here, null in the file.
struct NumberOrNull
{
  double& Value;
};

/// A list that may be unknown: empty here, null in the file.
struct ListOrNull
{
  std::vector<double>& Values;
};

/// Pairs of names and texts that are one object in the file.
struct NamedTexts
{
  std::vector<std::pair<std::string, std::string>>& Pairs;
};

class FieldWriter;
class FieldReader;

template <typename Fields>
void ListFields(Fields& fields, AnatomicalAxes& axes)
{
  fields("left", axes.Left);
  fields("anterior", axes.Anterior);
  fields("superior", axes.Superior);
}

template <typename Fields>
void ListFields(Fields& fields, Assessment& assessment)
{
  fields("level", assessment.Level);
  fields("reasons", assessment.Reasons);
}

template <typename Fields>
void ListFields(Fields& fields, ResultParameter& parameter)
{
  fields("name", parameter.Name);
  fields("unit", parameter.Unit);
  fields("value", parameter.Value);
  fields("standardDeviation", NumberOrNull{ parameter.StandardDeviation });
  fields("start", parameter.Start);
  fields("lower", parameter.Lower);
  fields("upper", parameter.Upper);
  fields("fixed", parameter.Fixed);
  fields("atBound", parameter.AtBound);
}

template <typename Fields>
void ListFields(Fields& fields, ReceptorGrid& grid)
{
  fields("columns", grid.Columns);
  fields("rows", grid.Rows);
  fields("originMm", grid.Origin);
  fields("columnStepMm", grid.ColumnStep);
  fields("rowStepMm", grid.RowStep);
}

template <typename Fields>
void ListFields(Fields& fields, VolumeFromGantry& placed)
{
  fields("originMm", placed.Origin);
  fields("x", placed.X);
  fields("y", placed.Y);
  fields("z", placed.Z);
}

template <typename Fields>
void ListFields(Fields& fields, MammographyUnit& unit)
{
  fields("sourceToDetectorMm", unit.SourceToDetectorMm);
  fields("focalSpotMm", unit.FocalSpotMm);
  fields("supportHeightMm", unit.SupportHeightMm);
  fields("supportEdgeMm", unit.SupportEdgeMm);
  fields("paddleEdgeMm", unit.PaddleEdgeMm);
  fields("edgeRadiusMm", unit.EdgeRadiusMm);
}

template <typename Fields>
void ListFields(Fields& fields, ResultProjection& projection)
{
  fields("focalSpotMm", projection.FocalSpotMm);
  fields("correlation", NumberOrNull{ projection.After.Correlation });
  fields("meanOutlineDistanceMm", NumberOrNull{ projection.After.MeanOutlineDistanceMm });
}

/// A stage of the case and its wall time.
template <typename Fields>
void ListFields(Fields& fields, std::pair<std::string, double>& timing)
{
  fields("stage", timing.first);
  fields("seconds", timing.second);
}

template <typename Fields>
void ListFields(Fields& fields, RegistrationIteration& iteration)
{
  fields("number", iteration.Number);
  fields("pixelSizeMm", iteration.PixelSizeMm);
  fields("comparison", iteration.Comparison);
  fields("cost", NumberOrNull{ iteration.Cost });
  fields("outlineCost", NumberOrNull{ iteration.OutlineCost });
  fields("intensityCost", NumberOrNull{ iteration.IntensityCost });
  fields("priorCost", NumberOrNull{ iteration.PriorCost });
  fields("parameters", iteration.Parameters);
  fields("seconds", iteration.Seconds);
}

template <typename Fields>
void ListFields(Fields& fields, RegistrationMisfit& misfit)
{
  fields("outlineSigmaMm", misfit.OutlineSigmaMm);
  fields("outlineScaleMm", misfit.OutlineScaleMm);
  fields("pictureSigma", misfit.PictureSigma);
  fields("pictureScaleMm", misfit.PictureScaleMm);
}

template <typename Fields>
void ListFields(Fields& fields, ExpectedError& expected)
{
  fields("medianMm", NumberOrNull{ expected.MedianMm });
  fields("most95Mm", NumberOrNull{ expected.Most95Mm });
}

template <typename Fields>
void ListFields(Fields& fields, ResultCompression& compression)
{
  fields("paddleForceN", compression.PaddleForceN);
  fields("supportForceN", compression.SupportForceN);
  fields("largestWallGlideMm", compression.LargestWallGlideMm);
  fields("otherEquilibriumMm", NumberOrNull{ compression.OtherEquilibriumMm });
  fields("volumeRatio", compression.VolumeRatio);
  fields("smallestJ", compression.SmallestJ);
  fields("largestJ", compression.LargestJ);
  fields("largestPenetrationMm", compression.LargestPenetrationMm);
  fields("relativeResidual", compression.RelativeResidual);
}

template <typename Fields>
void ListFields(Fields& fields, Mammogram& mammogram)
{
  fields("view", mammogram.View);
  fields("laterality", mammogram.Laterality);
  fields("columns", mammogram.Columns);
  fields("rows", mammogram.Rows);
  fields("columnSpacingMm", mammogram.ColumnSpacingMm);
  fields("rowSpacingMm", mammogram.RowSpacingMm);
  fields("bodyPartThicknessMm", mammogram.BodyPartThicknessMm);
  fields("sourceToDetectorMm", mammogram.SourceToDetectorMm);
  fields("peakKilovoltage", mammogram.PeakKilovoltage);
}

template <typename Fields>
void ListFields(Fields& fields, ResultScatter& scatter)
{
  fields("method", scatter.Method);
  fields("airGapMm", scatter.AirGapMm);
  fields("grid", scatter.Grid);
  fields("gridInterspace", scatter.Interspace);
}

template <typename Fields>
void ListFields(Fields& fields, ResultInput& input)
{
  fields("role", input.Role);
  fields("file", input.File);
  fields("sha256", input.Sha256);
}

template <typename Fields>
void ListFields(Fields& fields, ResultFile& result)
{
  fields("trust", result.Trust);
  fields("axes", result.Axes);
  fields("anchorMm", result.Anchor);
  fields("parameters", result.Parameters);
  fields("covariance", ListOrNull{ result.Covariance });
  fields("consideredCovariance", ListOrNull{ result.ConsideredCovariance });
  fields("grid", result.Grid);
  fields("placement", result.Placed);
  fields("unit", result.Unit);
  fields("correlation", NumberOrNull{ result.After.Correlation });
  fields("meanOutlineDistanceMm", NumberOrNull{ result.After.MeanOutlineDistanceMm });
  fields("largestOutlineDistanceMm", NumberOrNull{ result.After.LargestOutlineDistanceMm });
  fields("tissueCorrelation", NumberOrNull{ result.After.TissueCorrelation });
  fields("projections", result.Projections);
  fields("misfit", result.Misfit);
  fields("expectedError", result.Expected);
  fields("converged", result.Converged);
  fields("stopReason", result.StopReason);
  fields("evaluations", result.Evaluations);
  fields("seconds", result.Seconds);
  fields("timings", result.Timings);
  fields("iterations", result.Iterations);
  fields("compression", result.Compression);
  fields("mammogram", result.Mammogram);
  fields("shareExcluded", result.ShareExcluded);
  fields("warnings", result.Warnings);
  fields("inputs", result.Inputs);
  fields("spectrum", result.Spectrum);
  fields("scatter", result.Scatter);
  fields("versions", NamedTexts{ result.Versions });
}

template <typename Fields>
void ListFields(Fields& fields, JointResultFile::Registered& mammogram)
{
  fields("folder", mammogram.Folder);
  fields("view", mammogram.View);
  fields("laterality", mammogram.Laterality);
  fields("trust", mammogram.Level);
  fields("correlation", NumberOrNull{ mammogram.Correlation });
  fields("meanOutlineDistanceMm", NumberOrNull{ mammogram.MeanOutlineDistanceMm });
}

template <typename Fields>
void ListFields(Fields& fields, JointResultFile::Unknown& unknown)
{
  fields("name", unknown.Name);
  fields("unit", unknown.Unit);
  fields("folder", unknown.Folder);
  fields("value", unknown.Value);
  fields("standardDeviation", NumberOrNull{ unknown.StandardDeviation });
}

template <typename Fields>
void ListFields(Fields& fields, JointResultFile& result)
{
  fields("mammograms", result.Mammograms);
  fields("unknowns", result.Unknowns);
  fields("covariance", ListOrNull{ result.Covariance });
  fields("converged", result.Converged);
  fields("stopReason", result.StopReason);
  fields("seconds", result.Seconds);
}

/// Puts fields into a JSON object, in the order in which they are listed.
class FieldWriter
{
public:
  explicit FieldWriter(Json& object)
    : Object(object)
  {
  }

  template <typename T>
  void operator()(const char* name, T&& value)
  {
    this->Object[name] = Make(value);
  }

private:
  template <typename T>
  static Json Make(T& value)
  {
    Json object = Json::object();
    FieldWriter writer(object);
    ListFields(writer, value);
    return object;
  }
  template <typename T>
  requires std::is_arithmetic_v<T>
  static Json Make(T& value) { return value; }
  static Json Make(std::string& value) { return value; }
  static Json Make(char value) { return std::string(1, value); }
  static Json Make(Trust value) { return NameOf(value); }
  static Json Make(NumberOrNull& number) { return number.Value; } // NaN becomes null
  static Json Make(ListOrNull& list)
  {
    return list.Values.empty() ? Json(nullptr) : Json(list.Values);
  }
  static Json Make(NamedTexts& texts)
  {
    Json object = Json::object();
    for (const auto& [name, text] : texts.Pairs)
    {
      object[name] = text;
    }
    return object;
  }
  template <typename T>
  static Json Make(std::optional<T>& value)
  {
    return value ? Json(*value) : Json(nullptr);
  }
  template <std::size_t Count>
  static Json Make(std::array<double, Count>& values)
  {
    return values;
  }
  template <typename T>
  static Json Make(std::vector<T>& values)
  {
    Json list = Json::array();
    for (T& value : values)
    {
      list.push_back(Make(value));
    }
    return list;
  }

  Json& Object;
};

/// Takes fields from a JSON object. Throws InputError that names file, field, what was expected and
/// what was found where one is missing or of another kind.
class FieldReader
{
public:
  /// `prefix`: where the object lies in the file, with a point at its end.
  FieldReader(const Json& object, const std::string& file, const std::string& prefix = "")
    : Object(object)
    , File(file)
    , Prefix(prefix)
  {
  }

  template <typename T>
  void operator()(const char* name, T&& value) const
  {
    const auto found = this->Object.find(name);
    this->Read(found == this->Object.end() ? nullptr : &*found, this->Prefix + name, value);
  }

  /// Throws; `found`: what stands there, by default as in the file.
  [[noreturn]] void Refuse(const std::string& field, const std::string& expected,
    const std::string& found = "") const;

  /// Throws unless "formatVersion" is ResultFormatVersion.
  void CheckVersion() const;

private:
  void Check(bool fits, const Json* json, const std::string& field, const char* expected) const;

  template <typename T>
  void Read(const Json* json, const std::string& field, T& value) const
  {
    this->Check(json && json->is_object(), json, field, "an object");
    const FieldReader reader(*json, this->File, field + ".");
    ListFields(reader, value);
  }
  void Read(const Json* json, const std::string& field, double& value) const;
  void Read(const Json* json, const std::string& field, int& value) const;
  void Read(const Json* json, const std::string& field, bool& value) const;
  void Read(const Json* json, const std::string& field, char& value) const;
  void Read(const Json* json, const std::string& field, std::string& value) const;
  void Read(const Json* json, const std::string& field, Trust& value) const;
  void Read(const Json* json, const std::string& field, NumberOrNull& number) const;
  void Read(const Json* json, const std::string& field, ListOrNull& list) const;
  void Read(const Json* json, const std::string& field, NamedTexts& texts) const;
  template <typename T>
  void Read(const Json* json, const std::string& field, std::optional<T>& value) const
  {
    value.reset();
    if (!json || !json->is_null())
    {
      this->Read(json, field, value.emplace());
    }
  }
  template <std::size_t Count>
  void Read(const Json* json, const std::string& field, std::array<double, Count>& values) const
  {
    const std::string expected = std::to_string(Count) + " numbers";
    this->Check(json && json->is_array() && json->size() == Count, json, field, expected.c_str());
    for (std::size_t index = 0; index < Count; ++index)
    {
      this->Read(&(*json)[index], Element(field, index), values[index]);
    }
  }
  template <typename T>
  void Read(const Json* json, const std::string& field, std::vector<T>& values) const
  {
    this->Check(json && json->is_array(), json, field, "a list");
    values.resize(json->size());
    for (std::size_t index = 0; index < values.size(); ++index)
    {
      this->Read(&(*json)[index], Element(field, index), values[index]);
    }
  }
  static std::string Element(const std::string& field, std::size_t index)
  {
    return field + "[" + std::to_string(index) + "]";
  }

  const Json& Object;
  const std::string File;
  const std::string Prefix;
};
}

#endif
