// SPDX-License-Identifier: Apache-2.0
#include "SeriesOptions.h"

#include "DicomOptions.h"
#include "OutputFiles.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/ProjectionImage.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace mammoray
{
namespace
{
/// "x", "y", "z" or three numbers.
Vector3 AxisDirection(const std::vector<std::string>& words)
{
  if (words.empty())
  {
    return { 0, 0, 1 };
  }
  Vector3 direction{ 0, 0, 0 };
  if (words.size() == 1 && words[0].size() == 1 && words[0][0] >= 'x' && words[0][0] <= 'z')
  {
    direction[static_cast<std::size_t>(words[0][0] - 'x')] = 1;
    return direction;
  }
  bool numbers = words.size() == 3;
  std::string found;
  for (std::size_t index = 0; index < words.size(); ++index)
  {
    numbers = numbers && ToNumber(words[index], direction[index]);
    found += (index > 0 ? " " : "") + words[index];
  }
  if (!numbers)
  {
    throw InputError("--axis: expected x, y, z or three numbers, found '" + found + "'");
  }
  return direction;
}
}

void DeclareSeries(const OptionList& add, SeriesArguments& arguments)
{
  const OptionList series = add.Group("Series of projections");
  series("--turn", arguments.Turn, Between(0, 100000),
    "projections of a turning sample, a stack (.tif .mha .nrrd)\n(by --span, for tomography; a "
    ".json beside it holds angles, source, detector and the axis' shadow)");
  series("--tomosynthesis", arguments.Tomosynthesis, Between(0, 1000),
    "projections of a source that moves (a stack or .dcm)\n(from -span/2 to span/2 about an axis "
    "along the receptor's y; register takes a .dcm, which needs --side)");
  series("--span", arguments.SpanDeg, Between(-3600, 3600, "deg"),
    "of --turn (default: 360) or --tomosynthesis (default: 50)\n(the end of a turn is not "
    "repeated)");
  const OptionList expert = series.Expert();
  expert("--axis", arguments.Axis,
    "of --turn: x, y, z (default) or X Y Z, mesh frame; right-handed about it")
    ->type_name("AXIS")
    ->expected(1, 3);
  expert.Numbers("--axis-point", arguments.AxisPoint, "X Y Z",
    "a point of the axis of --turn; default: middle of the mesh");
  expert("--pivot-height", arguments.PivotHeightMm, NonNegative("mm"),
    "of the axis of --tomosynthesis over the receptor");
  expert("--flat-fields", arguments.FlatFields, Between(0, 100000),
    "pictures with nothing in the beam, into NAME_flat beside the stack\n(with noise and all "
    "else)");
}

void CheckSeries(const SeriesArguments& arguments, const std::string& output)
{
  if (arguments.Turn > 0 && arguments.Tomosynthesis > 0)
  {
    throw InputError("--turn: expected no --tomosynthesis beside it, found both");
  }
  if (!arguments.IsAsked())
  {
    if (arguments.SpanDeg || !arguments.Axis.empty() || arguments.AxisPoint ||
      arguments.FlatFields > 0 || arguments.PivotHeightMm > 0)
    {
      throw InputError("series: expected --turn or --tomosynthesis beside --span, --axis, "
                       "--axis-point, --pivot-height and --flat-fields, found neither");
    }
    return;
  }
  if (arguments.Tomosynthesis > 0 && (!arguments.Axis.empty() || arguments.AxisPoint))
  {
    throw InputError("--tomosynthesis: expected no --axis or --axis-point beside it: its axis is "
                     "the receptor's, at --pivot-height");
  }
  if (arguments.Turn > 0 && arguments.PivotHeightMm > 0)
  {
    throw InputError("--pivot-height: expected --tomosynthesis beside it, found --turn");
  }
  if (!IsDicomPath(output))
  {
    CheckStackExtension(output);
  }
  else if (arguments.Turn > 0 || arguments.FlatFields > 0)
  {
    throw InputError(
      "series: expected a stack (.tif .mha .nrrd) of --turn and --flat-fields, found "
      "output " +
      output);
  }
}

std::string SeriesDescriptionPath(const std::string& output)
{
  return std::filesystem::path(output).replace_extension(".json").string();
}

std::string FlatFieldPath(const std::string& output)
{
  return BesideOutput(output, "_flat");
}

ProjectionSeries MakeSeries(const SeriesArguments& arguments, const XRaySource& source,
  const XRayDetector& detector, const Vector3& middle, const VolumeFromGantry& gantry)
{
  ProjectionSeries series;
  if (arguments.Turn > 0)
  {
    series.Axis = { arguments.AxisPoint.value_or(middle), AxisDirection(arguments.Axis) };
    series.Views =
      TurnSample(source, detector, series.Axis, arguments.Turn, arguments.SpanDeg.value_or(360));
  }
  else
  {
    series.Axis = { gantry.Point({ 0, 0, arguments.PivotHeightMm }), gantry.Y };
    series.Views = SweepSource(source, detector, series.Axis, arguments.Tomosynthesis,
      arguments.SpanDeg.value_or(50));
  }
  return series;
}

std::string DescribeSeries(const SeriesArguments& arguments, const ProjectionSeries& series,
  const XRaySource& source, const XRayDetector& detector)
{
  nlohmann::json json{ { "format", "mammoray-projection-series" }, { "formatVersion", 1 },
    { "kind", arguments.Turn > 0 ? "turn" : "tomosynthesis" }, { "lengthUnit", "mm" },
    { "columns", detector.Columns }, { "rows", detector.Rows },
    { "axis", { { "point", series.Axis.Point }, { "direction", series.Axis.Direction } } } };
  if (const auto shadow = ShadowOfAxis(source, detector, series.Axis))
  {
    json["axis"]["columnInFirstRow"] = (*shadow)[0];
    json["axis"]["columnInLastRow"] = (*shadow)[1];
  }
  json["projections"] = nlohmann::json::array();
  for (const ProjectionView& view : series.Views)
  {
    nlohmann::json entry{ { "angleDeg", view.AngleDeg }, { "detectorOrigin", view.Detector.Origin },
      { "columnStep", view.Detector.ColumnStep }, { "rowStep", view.Detector.RowStep } };
    if (view.Source.Type == XRaySource::Kind::Point)
    {
      entry["source"] = view.Source.Position;
    }
    else
    {
      entry["beamDirection"] = view.Source.Direction;
    }
    json["projections"].push_back(entry);
  }
  return json.dump(1) + "\n";
}
}
