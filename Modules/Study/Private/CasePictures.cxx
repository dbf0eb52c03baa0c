// SPDX-License-Identifier: Apache-2.0
#include "Private/CaseChecks.h"
#include "Private/HeaderRules.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/MammogramPictureIO.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

namespace mammoray
{
namespace
{
/// Warns of a length that is given in place of the header's where they differ by more than
/// rounding.
void TellOther(const char* what, double givenMm, double headerMm,
  std::vector<std::string>& warnings)
{
  if (!(std::abs(givenMm - headerMm) <= 0.01 * headerMm))
  {
    warnings.push_back(std::string(what) + ": " + NumberText(givenMm) +
      " mm as given; the header says " + NumberText(headerMm) + " mm.");
  }
}

MammographyUnit UnitOf(const RegistrationCase& input, const std::string& path,
  const Mammogram& mammogram, std::vector<std::string>& warnings)
{
  MammographyUnit unit;
  const std::optional<double>& given = input.SourceToDetectorMm;
  const std::optional<double>& header = mammogram.SourceToDetectorMm;
  if (mammogram.SourceFootPixel && given)
  {
    throw InputError(path +
      ": expected no other source to detector distance beside projections, which each say their "
      "own, found one");
  }
  if (given && header)
  {
    TellOther("Source to detector distance", *given, *header, warnings);
  }
  unit.SourceToDetectorMm = given ? *given : header.value_or(unit.SourceToDetectorMm);
  if (!given && !header)
  {
    warnings.push_back("The header does not say the source to detector distance; " +
      std::to_string(static_cast<int>(unit.SourceToDetectorMm)) + " mm is assumed.");
  }
  unit.SupportHeightMm = input.SupportHeightMm.value_or(unit.SupportHeightMm);
  if (!(unit.SourceToDetectorMm > 0) || !(unit.SupportHeightMm >= 0))
  {
    throw InputError(
      "unit: expected a positive source to detector distance and a support height of at "
      "least 0, found " +
      std::to_string(unit.SourceToDetectorMm) + " and " + std::to_string(unit.SupportHeightMm) +
      " mm");
  }
  CheckUsual(input, ValidRanges::SourceDistance, unit.SourceToDetectorMm, path,
    "SourceToDetectorMm");
  unit.EdgeRadiusMm = input.EdgeRadiusMm;
  return unit;
}

/// What is given in place of what the header says. Throws InputError where the header says another
/// breast, or a view for which the unit is turned otherwise.
void Describe(const RegistrationCase& input, const std::string& path,
  const PictureDescription& given, Mammogram& mammogram)
{
  if (given.PixelSpacingMm)
  {
    mammogram.ColumnSpacingMm = *given.PixelSpacingMm;
    mammogram.RowSpacingMm = *given.PixelSpacingMm;
  }
  if (given.Laterality != '?' && mammogram.Laterality != '?' &&
    given.Laterality != mammogram.Laterality)
  {
    RefuseUnusual(input,
      path + ": expected a mammogram of the " + SideName(given.Laterality) + " breast, found " +
        mammogram.Laterality + " in its header",
      "Laterality", std::string(1, mammogram.Laterality));
  }
  mammogram.Laterality = given.Laterality == '?' ? mammogram.Laterality : given.Laterality;
  if (given.View.empty())
  {
    return;
  }
  const std::optional<double> rollDeg = NominalRollDeg(mammogram);
  const std::string view = std::exchange(mammogram.View, given.View);
  if (rollDeg && rollDeg != NominalRollDeg(mammogram))
  {
    RefuseUnusual(input,
      path + ": expected a mammogram of the view " + given.View + ", found " + view +
        " in its header",
      "MammogramViews", view);
  }
}

/// Throws InputError if the header of a DICOM mammogram says that it does not show a whole breast
/// (WhyNotWholeBreast).
void CheckWholeBreast(const RegistrationCase& input, const std::string& path)
{
  const std::optional<DicomHeader> header = ReadDicomHeader(path);
  if (const std::string found = header ? WhyNotWholeBreast(*header) : ""; !found.empty())
  {
    RefuseUnusual(input,
      path + ": expected a mammogram of a whole breast on the receptor, found '" +
        EscapeControls(found) + "' in its header",
      "Mammograms", found);
  }
}

/// Throws InputError if the last view's picture is an earlier one's, or if its pixels have no
/// detector's size.
void CheckMammogram(const RegistrationCase& input, const std::vector<RegisteredView>& views)
{
  const RegisteredView& latest = views.back();
  for (const double spacing : { latest.Mammogram.ColumnSpacingMm, latest.Mammogram.RowSpacingMm })
  {
    CheckUsual(input, ValidRanges::PixelSpacing, spacing, latest.Path, "PixelSpacingMm");
  }
  const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t number = 0; number + 1 < views.size(); ++number)
  {
    if (std::ranges::equal(latest.Mammogram.Pixels, views[number].Mammogram.Pixels, same))
    {
      RefuseUnusual(input,
        latest.Path + ": expected another picture than " + views[number].Path + ", found the same",
        "Mammograms", latest.Path);
    }
  }
}

/// One mammogram, or the projections of one compression.
std::vector<Mammogram> ReadCaseMammograms(const RegistrationCase& input, std::size_t number,
  std::vector<std::string>& warnings)
{
  const std::string& path = input.Mammograms[number];
  const std::vector<double>& thickness = input.Start[ThicknessParameter];
  const PictureDescription given{ input.PixelSpacingMm,
    input.MammogramViews.empty() ? "" : input.MammogramViews[number],
    input.Laterality.empty() ? '?' : input.Laterality.front(),
    thickness.empty() ? std::nullopt : std::optional(thickness.front()) };
  if (IsPicturePath(path))
  {
    return { ReadMammogramPicture(path, given) };
  }
  std::error_code problem;
  if (std::filesystem::is_regular_file(path, problem) && !HasDicomHeader(path))
  {
    throw InputError(path +
      ": expected a DICOM mammogram, or a picture of one (.jpg, .jpeg or .png), found neither");
  }
  std::vector<Mammogram> mammograms = ReadProjections(path, given);
  CheckWholeBreast(input, path);
  if (given.PixelSpacingMm)
  {
    TellOther("Pixel spacing", *given.PixelSpacingMm, mammograms.front().ColumnSpacingMm, warnings);
  }
  for (Mammogram& mammogram : mammograms)
  {
    Describe(input, path, given, mammogram);
  }
  return mammograms;
}

/// Throws InputError if a mask leaves too little of the breast to compare.
void CheckMask(const std::string& path, const std::vector<RegistrationTarget>& levels,
  double marginMm)
{
  for (const RegistrationTarget& level : levels)
  {
    std::size_t left = 0;
    for (std::size_t pixel = 0; pixel < level.BreastMask.size(); ++pixel)
    {
      left += level.BreastMask[pixel] != 0 && level.SignedDistanceMm[pixel] < -marginMm &&
          !IsExcluded(level, pixel)
        ? 1
        : 0;
    }
    if (left < FewestComparedPixels)
    {
      throw InputError(path +
        ": expected a mask that is 0 where the breast is compared, found one that leaves out all " +
        (left == 0 ? "of it" : "but " + std::to_string(left) + " pixels of the compared size"));
    }
  }
}

/// Where the source of a projection stood, gantry frame.
Vector3 FocalSpotOf(const Mammogram& projection, const RegistrationTarget& target)
{
  const std::array<double, 2>& foot = projection.SourceFootPixel.value();
  const ReceptorPoint over = target.Grid.PositionOf(foot[0], foot[1]);
  return { over[0], over[1], projection.SourceToDetectorMm.value() };
}
}

void ReadCasePictures(const RegistrationCase& input, std::vector<RegisteredView>& views)
{
  const std::size_t number = views.size() - 1;
  RegisteredView& view = views.back();
  const std::string& path = input.Mammograms[number];
  std::vector<Mammogram> projections = ReadCaseMammograms(input, number, view.Warnings);
  const std::size_t middle = MiddleProjection(projections);
  view.Mammogram = std::move(projections[middle]);
  CheckMammogram(input, views);
  const char side = views.front().Mammogram.Laterality;
  if (view.Mammogram.Laterality != side && view.Mammogram.Laterality != '?' && side != '?')
  {
    throw InputError(path + ": expected a mammogram of the same breast as " + views.front().Path +
      " (" + side + "), found one of the other (" + view.Mammogram.Laterality + ")");
  }
  view.View.Target = PrepareTarget(view.Mammogram, input.Targets);
  CheckPicturedBreast(input, view);
  if (!input.Masks.empty())
  {
    ExcludePixels(
      ReadMask(input.Masks[number], view.View.Target.Grid.Columns, view.View.Target.Grid.Rows),
      view.View.Target);
  }
  view.Warnings.insert(view.Warnings.end(), view.View.Target.Warnings.begin(),
    view.View.Target.Warnings.end());
  view.View.Unit = UnitOf(input, path, view.Mammogram, view.Warnings);
  view.View.Levels = MakeLevels(view.View.Target, input.Options.PixelSizesMm);
  if (!input.Masks.empty())
  {
    CheckMask(input.Masks[number], view.View.Levels, input.Options.IntensityMarginMm);
  }
  if (projections.size() == 1)
  {
    return;
  }
  if (!input.Masks.empty())
  {
    throw InputError(path + ": expected no mask beside projections, found " + input.Masks[number]);
  }
  view.View.Unit = WithFocalSpot(view.View.Unit, FocalSpotOf(view.Mammogram, view.View.Target));
  for (std::size_t other = 0; other < projections.size(); ++other)
  {
    if (other != middle)
    {
      const RegistrationTarget target = PrepareTarget(projections[other], input.Targets);
      const Vector3 spot = FocalSpotOf(projections[other], target);
      view.View.Projections.push_back({ spot, MakeLevels(target, input.Options.PixelSizesMm) });
      projections[other] = {}; // a series of a real unit has a gigabyte
    }
  }
}
}
