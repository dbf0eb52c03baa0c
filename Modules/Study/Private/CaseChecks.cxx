// SPDX-License-Identifier: Apache-2.0
#include "Private/CaseChecks.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Study/LabelSource.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mammoray
{
namespace
{
std::string Whole(double value)
{
  return std::to_string(std::lround(value));
}

std::string PathOfTissue(const RegistrationCase& input)
{
  return input.Labels.Path.empty() ? std::string("the study's MRI") : input.Labels.Path;
}

/// Whether a direction along an oblique view's receptor leads to the head and to the middle of the
/// body at once, or away from both, as no receptor under that breast does.
bool IsOfOtherBreast(const std::string& direction, char laterality)
{
  const auto has = [&](char letter) { return direction.find(letter) != std::string::npos; };
  const bool tells = (has('H') || has('F')) && (has('L') || has('R'));
  return tells && has('H') != has(laterality);
}

/// Extent of tissue along a direction, mm. `all`: including fixed tissue.
Extent ReachOf(const LabelVolume& volume, const Vector3& direction, const std::vector<bool>& fixed,
  bool all = false)
{
  Extent extent;
  volume.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const int material = volume.Voxels[voxel];
      if (material != 0 && (all || !fixed[static_cast<std::size_t>(material)]))
      {
        extent.Add(Dot(volume.PointAt(i, j, k), direction));
      }
    });
  return extent;
}

/// From the middle of fixed tissue to that of the rest; nullopt if either is missing.
std::optional<Vector3> FixedToFree(const LabelVolume& volume, const std::vector<bool>& fixed)
{
  std::array<Vector3, 2> sums{};
  std::array<double, 2> counts{};
  volume.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (const int material = volume.Voxels[voxel]; material != 0)
      {
        const std::size_t which = fixed[static_cast<std::size_t>(material)] ? 0 : 1;
        sums[which] = sums[which] + volume.PointAt(i, j, k);
        counts[which] += 1;
      }
    });
  if (counts[0] == 0 || counts[1] == 0)
  {
    return std::nullopt;
  }
  return (1 / counts[1]) * sums[1] - (1 / counts[0]) * sums[0];
}

void CheckSide(const RegistrationCase& input, const Extent& breast, const Extent& body,
  char laterality)
{
  const double leftOfIt = body.High - breast.High;
  const double rightOfIt = breast.Low - body.Low;
  constexpr double MuchMm = 100; // an arm's or a chest's width
  const double more = std::max(leftOfIt, rightOfIt);
  const char side = rightOfIt > leftOfIt ? 'L' : 'R';
  if (more >= MuchMm && std::min(leftOfIt, rightOfIt) <= 0.5 * more && laterality != '?' &&
    laterality != side)
  {
    RefuseUnusual(input,
      PathOfTissue(input) + ": expected the " + SideName(laterality) +
        " breast, which the mammogram shows, found the " + SideName(side) +
        " one: " + Whole(leftOfIt) + " mm of the body lie to the left of it, " + Whole(rightOfIt) +
        " mm to the right",
      "Laterality", std::string(1, side));
  }
}

double AreaCm2(const RegistrationTarget& target)
{
  const auto breast = std::count(target.BreastMask.begin(), target.BreastMask.end(), 1);
  return static_cast<double>(breast) * target.Grid.PixelAreaMm2() / 100;
}

/// Limits of the picture's volume, area times thickness, over the MRI's breast. Five virtual
/// studies have 0.44 to 0.77 in CC and 0.51 to 0.85 in MLO: plates do not take all that lies before
/// the chest wall, and oblique pictures show the pectoral muscle, too.
struct SizeLimits
{
  Extent Usual;
  Extent Possible;
};
constexpr SizeLimits CcLimits{ { 0.3, 1.2 }, { 0.15, 2.0 } };
constexpr SizeLimits MloLimits{ { 0.3, 1.6 }, { 0.15, 2.5 } };
/// Area of MLO over that of CC. In those studies it is 0.83 to 1.2.
constexpr Extent UsualAreaRatio{ 0.55, 2.2 };

bool IsWithin(double value, const Extent& limits)
{
  return value >= limits.Low && value <= limits.High;
}

void CheckSize(const RegistrationCase& input, double breastCm3, double areaCm2,
  RegisteredView& view)
{
  const double thicknessMm = input.Start[ThicknessParameter].empty()
    ? view.Mammogram.BodyPartThicknessMm.value_or(0)
    : view.View.Parameters[ThicknessParameter].Start;
  const double picturedCm3 = areaCm2 * thicknessMm / 10;
  if (!(picturedCm3 > 0) || !(breastCm3 > 0))
  {
    return;
  }
  const SizeLimits& limits = view.Mammogram.View == "CC" ? CcLimits : MloLimits;
  const double ratio = picturedCm3 / breastCm3;
  if (!IsWithin(ratio, limits.Possible))
  {
    RefuseUnusual(input,
      view.Path + ": expected a picture of the breast in the MRI (" + Whole(breastCm3) +
        " cm3), found one of " + Whole(picturedCm3) +
        " cm3 (area times thickness): of another breast, or of a part of it",
      "Mammograms", view.Path);
  }
  if (!IsWithin(ratio, limits.Usual))
  {
    view.View.Target.Disagreements.push_back("The picture shows " + Whole(picturedCm3) +
      " cm3 of breast (area times thickness), the MRI " + Whole(breastCm3) +
      " cm3: it may be of another breast, or of a part of it.");
  }
}
}

void RefuseUnusual(const RegistrationCase& input, const std::string& message,
  const std::string& field, const std::string& found)
{
  if (!input.Labels.AcceptUnusual)
  {
    throw InputError(message, { field, found, { "AcceptUnusual" } });
  }
}

void CheckUsual(const RegistrationCase& input, const ValidRange& range, double value,
  const std::string& path, const char* remedy)
{
  if (!input.Labels.AcceptUnusual)
  {
    CheckValidRange(range, value, path, { remedy, "AcceptUnusual" });
  }
}

void CheckPicturedBreast(const RegistrationCase& input, RegisteredView& view)
{
  RegistrationTarget& target = view.View.Target;
  const Mammogram& mammogram = view.Mammogram;
  Extent across;
  for (int row = 0; row < target.Grid.Rows; ++row)
  {
    for (int column = 0; column < target.Grid.Columns; ++column)
    {
      if (target.BreastMask[target.Grid.Index(column, row)] != 0)
      {
        across.Add(target.Grid.PositionOf(column, row)[0]);
      }
    }
  }
  CheckUsual(input, ValidRanges::BreastWidth, across.Length(), view.Path, "PixelSpacingMm");
  if (mammogram.Laterality != 'L' && mammogram.Laterality != 'R')
  {
    return;
  }
  const std::string side = SideName(mammogram.Laterality);
  const bool isOblique = mammogram.View == "MLO" || mammogram.View == "LMO";
  for (const std::string& direction : { mammogram.RowDirection, mammogram.ColumnDirection })
  {
    if (isOblique && IsOfOtherBreast(direction, mammogram.Laterality))
    {
      RefuseUnusual(input,
        view.Path + ": expected an oblique view of the " + side +
          " breast, found the Patient Orientation '" + direction + "' of the other",
        "Laterality", direction);
    }
  }
  // By how mammograms are hung. One that is turned by 90 degrees tells nothing.
  const double inward = target.Grid.ColumnStep[1];
  const char hung = inward > 0 ? 'L' : 'R';
  const bool isSaid = !input.Study && !input.Laterality.empty();
  if (!isSaid && inward != 0 && hung != mammogram.Laterality)
  {
    target.Disagreements.push_back("The header says " + side +
      " breast, but the chest wall is at the " + SideName(hung) + " edge of the picture, as the " +
      SideName(hung) + " breast is hung: check which breast it is.");
  }
}

void CheckHanded(const RegistrationCase& input, const AnatomicalAxes& axes)
{
  if (Dot(Cross(axes.Left, axes.Anterior), axes.Superior) > 0)
  {
    RefuseUnusual(input,
      "orientation " + input.Orientation +
        ": expected axes that are right-handed, found a mirror image, whose left is the patient's "
        "right",
      "Orientation", input.Orientation);
  }
}

void CheckTissue(const RegistrationCase& input, const LabelVolume& materials,
  const std::vector<bool>& fixed, const AnatomicalAxes& axes, char laterality)
{
  if (input.Labels.AcceptUnusual)
  {
    return;
  }
  const std::optional<Vector3> way = FixedToFree(materials, fixed);
  // A breast beside a body may lie mostly to the side of the body's middle, but never behind it.
  if (way && Dot(*way, axes.Anterior) < 0.3 * Norm(*way))
  {
    throw InputError(PathOfTissue(input) +
        ": expected the breast in front of what holds it, found it " + Whole(Dot(*way, axes.Left)) +
        " mm to the left, " + Whole(Dot(*way, axes.Anterior)) + " mm to the front and " +
        Whole(Dot(*way, axes.Superior)) + " mm to the head of that",
      { "Orientation", input.Orientation, { "Orientation", "AcceptUnusual" } });
  }
  if (MidlineBetweenBreasts(materials, fixed, axes))
  {
    throw InputError(PathOfTissue(input) +
        ": expected one breast, found two side by side; 'mammoray segment' makes labels of one "
        "side",
      { "Labels", input.Labels.Path, { "Crop", "AcceptUnusual" } });
  }
  const LabelVolume kept = KeepBreast(materials, fixed, axes);
  for (const Vector3& direction : { axes.Left, axes.Superior })
  {
    const Extent breast = ReachOf(kept, direction, fixed);
    if (breast.Length() >= 0)
    {
      CheckUsual(input, ValidRanges::BreastWidth, breast.Length(), PathOfTissue(input), "Crop");
    }
  }
  CheckSide(input, ReachOf(kept, axes.Left, fixed), ReachOf(materials, axes.Left, fixed, true),
    laterality);
}

void CheckSizes(const RegistrationCase& input, double breastCm3, std::vector<RegisteredView>& views)
{
  // Labels that are given may hold a part of the breast only.
  if (!input.Study || input.Labels.AcceptUnusual)
  {
    return;
  }
  double ccCm2 = 0;
  double mloCm2 = 0;
  RegisteredView* mlo = nullptr;
  for (RegisteredView& view : views)
  {
    const double areaCm2 = AreaCm2(view.View.Target);
    CheckSize(input, breastCm3, areaCm2, view);
    if (view.Mammogram.View == "CC")
    {
      ccCm2 = areaCm2;
    }
    else if (view.Mammogram.View == "MLO")
    {
      mloCm2 = areaCm2;
      mlo = &view;
    }
  }
  if (mlo && ccCm2 > 0 && !IsWithin(mloCm2 / ccCm2, UsualAreaRatio))
  {
    mlo->View.Target.Disagreements.push_back("The breast is " + Whole(mloCm2) + " cm2 in MLO and " +
      Whole(ccCm2) + " in CC: they may be of two breasts, or one shows a part only.");
  }
}
}
