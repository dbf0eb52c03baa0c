// SPDX-License-Identifier: Apache-2.0
// The fields of result.json. ListFields names those of a structure once, for FieldWriter and for
// FieldReader. A new field is one line in its list, one in Data/result.schema.json, and a
// higher ResultFormatVersion.
#ifndef mammoray_ResultFields_h
#define mammoray_ResultFields_h

#include "mammoray/Study/ResultFile.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
using Json = nlohmann::ordered_json;

/// A number or a list that may be unknown: NaN or empty here, null in the file.
template <typename T>
struct OrNull
{
  T& Value;
};
template <typename T>
OrNull(T&) -> OrNull<T>;

/// A list that files of version 5 may lack, empty then.
template <typename T>
struct OrAbsent
{
  T& Value;
};
template <typename T>
OrAbsent(T&) -> OrAbsent<T>;

/// Names and texts that are one object in the file.
using NamedTexts = std::vector<std::pair<std::string, std::string>>;

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
  fields("standardDeviation", OrNull{ parameter.StandardDeviation });
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
  fields("correlation", OrNull{ projection.After.Correlation });
  fields("meanOutlineDistanceMm", OrNull{ projection.After.MeanOutlineDistanceMm });
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
  fields("cost", OrNull{ iteration.Cost });
  fields("outlineCost", OrNull{ iteration.OutlineCost });
  fields("intensityCost", OrNull{ iteration.IntensityCost });
  fields("priorCost", OrNull{ iteration.PriorCost });
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
  fields("medianMm", OrNull{ expected.MedianMm });
  fields("most95Mm", OrNull{ expected.Most95Mm });
}

/// The mechanical state, and what the search says of another one.
struct CompressionFields
{
  EquilibriumMeasures& State;
  double& OtherEquilibriumMm;
};

template <typename Fields>
void ListFields(Fields& fields, CompressionFields& compression)
{
  fields("paddleForceN", compression.State.PaddleForceN);
  fields("supportForceN", compression.State.SupportForceN);
  fields("largestWallGlideMm", compression.State.LargestWallGlideMm);
  fields("otherEquilibriumMm", OrNull{ compression.OtherEquilibriumMm });
  fields("volumeRatio", compression.State.VolumeRatio);
  fields("smallestJ", compression.State.SmallestJ);
  fields("largestJ", compression.State.LargestJ);
  fields("largestPenetrationMm", compression.State.LargestPenetrationMm);
  fields("relativeResidual", compression.State.RelativeResidual);
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
  fields("covariance", OrNull{ result.Covariance });
  fields("consideredCovariance", OrNull{ result.ConsideredCovariance });
  fields("grid", result.Grid);
  fields("placement", result.Placed);
  fields("unit", result.Unit);
  fields("correlation", OrNull{ result.After.Correlation });
  fields("meanOutlineDistanceMm", OrNull{ result.After.MeanOutlineDistanceMm });
  fields("largestOutlineDistanceMm", OrNull{ result.After.LargestOutlineDistanceMm });
  fields("tissueCorrelation", OrNull{ result.After.TissueCorrelation });
  fields("projections", result.Projections);
  fields("misfit", result.Misfit);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  ExpectedError expected = result.Expected.value_or(ExpectedError{ unknown, unknown });
  fields("expectedError", expected);
  result.Expected = std::isnan(expected.MedianMm) ? std::nullopt : std::optional(expected);
  fields("converged", result.Converged);
  fields("stopReason", result.StopReason);
  fields("evaluations", result.Evaluations);
  fields("seconds", result.Seconds);
  fields("timings", result.Timings);
  fields("iterations", result.Iterations);
  fields("compression", CompressionFields{ result.Compression, result.OtherEquilibriumMm });
  fields("mammogram", result.Mammogram);
  fields("shareExcluded", result.ShareExcluded);
  fields("warnings", result.Warnings);
  fields("notes", OrAbsent{ result.Notes });
  fields("inputs", result.Inputs);
  fields("spectrum", result.Spectrum);
  fields("scatter", result.Scatter);
  fields("versions", result.Versions);
}

template <typename Fields>
void ListFields(Fields& fields, JointResultFile::Registered& mammogram)
{
  fields("folder", mammogram.Folder);
  fields("view", mammogram.View);
  fields("laterality", mammogram.Laterality);
  fields("trust", mammogram.Level);
  fields("correlation", OrNull{ mammogram.Correlation });
  fields("meanOutlineDistanceMm", OrNull{ mammogram.MeanOutlineDistanceMm });
}

template <typename Fields>
void ListFields(Fields& fields, JointResultFile::Unknown& unknown)
{
  fields("name", unknown.Name);
  fields("unit", unknown.Unit);
  fields("folder", unknown.Folder);
  fields("value", unknown.Value);
  fields("standardDeviation", OrNull{ unknown.StandardDeviation });
}

template <typename Fields>
void ListFields(Fields& fields, JointResultFile& result)
{
  fields("mammograms", result.Mammograms);
  fields("unknowns", result.Unknowns);
  fields("covariance", OrNull{ result.Covariance });
  fields("converged", result.Converged);
  fields("stopReason", result.StopReason);
  fields("seconds", result.Seconds);
}

class FieldWriter;

template <typename T>
concept HasFields = requires(FieldWriter& writer, T& value)
{
  ListFields(writer, value);
};

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
  requires(!HasFields<T>) static Json Make(T& value) { return value; } // NaN becomes null
  static Json Make(char value) { return std::string(1, value); }
  static Json Make(Trust value) { return NameOf(value); }
  template <HasFields T>
  static Json Make(T& value)
  {
    Json object = Json::object();
    FieldWriter writer(object);
    ListFields(writer, value);
    return object;
  }
  template <HasFields T>
  static Json Make(std::vector<T>& values)
  {
    Json list = Json::array();
    for (T& value : values)
    {
      list.push_back(Make(value));
    }
    return list;
  }
  template <typename T>
  static Json Make(std::optional<T>& value)
  {
    return value ? Json(*value) : Json(nullptr);
  }
  static Json Make(OrNull<double>& number) { return number.Value; }
  static Json Make(OrNull<std::vector<double>>& list)
  {
    return list.Value.empty() ? Json(nullptr) : Json(list.Value);
  }
  template <typename T>
  static Json Make(OrAbsent<T>& list)
  {
    return list.Value;
  }
  static Json Make(NamedTexts& texts)
  {
    Json object = Json::object();
    for (const auto& [name, text] : texts)
    {
      object[name] = text;
    }
    return object;
  }

  Json& Object;
};

/// Takes fields from a JSON object. Throws InputError that names file, field, what was expected and
/// what was found.
class FieldReader
{
public:
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

  /// Throws; `found` is by default the field's value in the file.
  [[noreturn]] void Refuse(const std::string& field, const std::string& expected,
    const std::string& found = "") const;

  /// Throws unless "formatVersion" is ResultFormatVersion.
  void CheckVersion() const;

private:
  void Check(bool fits, const Json* json, const std::string& field,
    const std::string& expected) const;

  void Read(const Json* json, const std::string& field, std::string& value) const;
  void Read(const Json* json, const std::string& field, Trust& value) const;
  void Read(const Json* json, const std::string& field, NamedTexts& texts) const;
  void Read(const Json* json, const std::string& field, char& value) const
  {
    std::string letter;
    this->Read(json, field, letter);
    this->Check(letter.size() == 1, json, field, "one letter");
    value = letter.front();
  }
  void Read(const Json* json, const std::string& field, double& value) const
  {
    this->Check(json && json->is_number(), json, field, "a number");
    json->get_to(value);
  }
  void Read(const Json* json, const std::string& field, int& value) const
  {
    this->Check(json && json->is_number_integer(), json, field, "a whole number");
    json->get_to(value);
  }
  void Read(const Json* json, const std::string& field, bool& value) const
  {
    this->Check(json && json->is_boolean(), json, field, "true or false");
    json->get_to(value);
  }
  void Read(const Json* json, const std::string& field, OrNull<double>& number) const
  {
    this->Check(json && (json->is_null() || json->is_number()), json, field, "a number or null");
    number.Value = json->is_null() ? std::numeric_limits<double>::quiet_NaN() : json->get<double>();
  }
  void Read(const Json* json, const std::string& field, OrNull<std::vector<double>>& list) const
  {
    this->Check(json && (json->is_null() || json->is_array()), json, field, "a list or null");
    list.Value.clear();
    if (!json->is_null())
    {
      this->Read(json, field, list.Value);
    }
  }
  template <typename T>
  void Read(const Json* json, const std::string& field, OrAbsent<T>& list) const
  {
    list.Value.clear();
    if (json)
    {
      this->Read(json, field, list.Value);
    }
  }
  template <typename T>
  void Read(const Json* json, const std::string& field, std::optional<T>& value) const
  {
    value.reset();
    if (!json || !json->is_null())
    {
      this->Read(json, field, value.emplace());
    }
  }
  template <HasFields T>
  void Read(const Json* json, const std::string& field, T& value) const
  {
    this->Check(json && json->is_object(), json, field, "an object");
    const FieldReader reader(*json, this->File, field + ".");
    ListFields(reader, value);
  }
  template <std::size_t Count>
  void Read(const Json* json, const std::string& field, std::array<double, Count>& values) const
  {
    this->Check(json && json->is_array() && json->size() == Count, json, field,
      std::to_string(Count) + " numbers");
    this->ReadElements(*json, field, values);
  }
  template <typename T>
  void Read(const Json* json, const std::string& field, std::vector<T>& values) const
  {
    this->Check(json && json->is_array(), json, field, "a list");
    values.resize(json->size());
    this->ReadElements(*json, field, values);
  }
  template <typename List>
  void ReadElements(const Json& json, const std::string& field, List& values) const
  {
    for (std::size_t index = 0; index < values.size(); ++index)
    {
      this->Read(&json[index], field + "[" + std::to_string(index) + "]", values[index]);
    }
  }

  const Json& Object;
  const std::string File;
  const std::string Prefix;
};
}

#endif
