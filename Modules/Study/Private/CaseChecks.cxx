// SPDX-License-Identifier: Apache-2.0
#include "Private/CaseChecks.h"

#include "Private/HeaderRules.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Study/LabelSource.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace mammoray
{
namespace
{
const char* NameOfSide(char laterality)
{
  return laterality == 'L' ? "left" : "right";
}

std::string PathOfTissue(const RegistrationCase& input)
{
  return input.Study ? std::string("the study's MRI") : input.Labels.Path;
}

/// Which breast the picture is of by how mammograms are hung; nothing of one turned by 90 degrees.
std::optional<char> HungAs(const RegistrationTarget& target)
{
  const double inward = target.Grid.ColumnStep[1];
  return inward > 0 ? std::optional('L') : inward < 0 ? std::optional('R') : std::nullopt;
}

/// Whether a direction along an oblique view's receptor leads to the head and to the middle of the
/// body at once, or away from both, as no receptor under that breast does.
bool IsOfOtherBreast(const std::string& direction, char laterality)
{
  const auto has = [&](char letter) { return direction.find(letter) != std::string::npos; };
  const bool tells = (has('H') || has('F')) && (has('L') || has('R'));
  return tells && has('H') != has(laterality);
}

/// Of what is not air along a direction, mm; nor what is held, where that is told.
Extent ReachOf(const LabelVolume& volume, const Vector3& direction, const std::vector<bool>* held)
{
  Extent extent;
  volume.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const int material = volume.Voxels[voxel];
      if (material != 0 && !(held && (*held)[static_cast<std::size_t>(material)]))
      {
        extent.Add(Dot(volume.PointAt(i, j, k), direction));
      }
    });
  return extent;
}

/// From the middle of what is held to the middle of what is not; nothing where one is missing.
std::optional<Vector3> HeldToFree(const LabelVolume& volume, const std::vector<bool>& held)
{
  std::array<Vector3, 2> sums{};
  std::array<double, 2> counts{};
  volume.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (const int material = volume.Voxels[voxel]; material != 0)
      {
        const std::size_t which = held[static_cast<std::size_t>(material)] ? 0 : 1;
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

void CheckFront(const RegistrationCase& input, const LabelVolume& materials,
  const std::vector<bool>& held, const AnatomicalAxes& axes)
{
  const std::optional<Vector3> way = HeldToFree(materials, held);
  // A breast beside a body may lie mostly to the side of the body's middle, but never behind it.
  if (way && Dot(*way, axes.Anterior) < 0.3 * Norm(*way))
  {
    char text[200];
    std::snprintf(text, sizeof text,
      "expected the breast in front of what holds it, found it %.0f mm to the left, %.0f mm to the "
      "front and %.0f mm to the head of that",
      Dot(*way, axes.Left), Dot(*way, axes.Anterior), Dot(*way, axes.Superior));
    throw InputError(PathOfTissue(input) + ": " + text,
      { "Orientation", input.Orientation, { "Orientation", "AcceptUnusual" } });
  }
}

void CheckSide(const RegistrationCase& input, const Extent& breast, const Extent& body,
  char laterality)
{
  const double leftOfIt = body.High - breast.High;
  const double rightOfIt = breast.Low - body.Low;
  constexpr double MuchMm = 100; // an arm's or a chest's width
  const double more = std::max(leftOfIt, rightOfIt);
  if (more < MuchMm || std::min(leftOfIt, rightOfIt) > 0.5 * more)
  {
    return;
  }
  const char side = rightOfIt > leftOfIt ? 'L' : 'R';
  if (laterality != '?' && laterality != side)
  {
    char text[200];
    std::snprintf(text, sizeof text,
      "expected the %s breast, which the mammogram shows, found the %s one: %.0f mm of the body "
      "lie "
      "to the left of it, %.0f mm to the right",
      NameOfSide(laterality), NameOfSide(side), leftOfIt, rightOfIt);
    throw InputError(PathOfTissue(input) + ": " + text,
      { "Laterality", std::string(1, side), { "AcceptUnusual" } });
  }
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

void CheckWholeBreast(const RegistrationCase& input, const std::string& path)
{
  if (input.Labels.AcceptUnusual)
  {
    return;
  }
  const std::optional<DicomHeader> header = ReadDicomHeader(path);
  if (const std::string found = header ? WhyNotWholeBreast(*header) : ""; !found.empty())
  {
    throw InputError(path + ": expected a mammogram of a whole breast on the receptor, found '" +
        EscapeControls(found) + "' in its header",
      { "Mammograms", found, { "AcceptUnusual" } });
  }
}

void CheckMammogram(const RegistrationCase& input, const std::vector<RegisteredView>& views)
{
  const RegisteredView& latest = views.back();
  for (const double spacing : { latest.Mammogram.ColumnSpacingMm, latest.Mammogram.RowSpacingMm })
  {
    CheckUsual(input, ValidRanges::PixelSpacing, spacing, latest.Path, "PixelSpacingMm");
  }
  const std::vector<float>& pixels = latest.Mammogram.Pixels;
  const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (const RegisteredView& earlier : views)
  {
    const std::vector<float>& others = earlier.Mammogram.Pixels;
    if (&earlier != &latest && !input.Labels.AcceptUnusual &&
      std::equal(pixels.begin(), pixels.end(), others.begin(), others.end(), same))
    {
      throw InputError(latest.Path + ": expected another picture than " + earlier.Path +
          ", found the same",
        { "Mammograms", latest.Path, { "AcceptUnusual" } });
    }
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
  const bool isSided = mammogram.Laterality == 'L' || mammogram.Laterality == 'R';
  const bool isOblique = mammogram.View == "MLO" || mammogram.View == "LMO";
  if (isSided && isOblique && !input.Labels.AcceptUnusual)
  {
    for (const std::string& direction : { mammogram.RowDirection, mammogram.ColumnDirection })
    {
      if (IsOfOtherBreast(direction, mammogram.Laterality))
      {
        throw InputError(view.Path + ": expected an oblique view of the " +
            NameOfSide(mammogram.Laterality) + " breast, found the Patient Orientation '" +
            direction + "' of the other",
          { "Laterality", direction, { "AcceptUnusual" } });
      }
    }
  }
  const bool isSaid = !input.Study && !input.Laterality.empty();
  const std::optional<char> hung = HungAs(target);
  if (isSided && !isSaid && hung && *hung != mammogram.Laterality)
  {
    target.Disagreements.push_back(std::string("The header says ") +
      NameOfSide(mammogram.Laterality) + " breast, but the chest wall is at the " +
      NameOfSide(*hung) + " edge of the picture, as the " + NameOfSide(*hung) +
      " breast is hung: check which breast it is.");
  }
}

void CheckHanded(const RegistrationCase& input, const AnatomicalAxes& axes)
{
  if (!input.Labels.AcceptUnusual && Dot(Cross(axes.Left, axes.Anterior), axes.Superior) > 0)
  {
    throw InputError("orientation " + input.Orientation +
        ": expected axes that are right-handed, found a mirror image, whose left is the patient's "
        "right",
      { "Orientation", input.Orientation, { "AcceptUnusual" } });
  }
}

void CheckTissue(const RegistrationCase& input, const LabelVolume& materials,
  const std::vector<bool>& held, const AnatomicalAxes& axes, char laterality)
{
  if (input.Labels.AcceptUnusual)
  {
    return;
  }
  CheckFront(input, materials, held, axes);
  const LabelVolume kept = KeepBreast(materials, held, axes);
  for (const Vector3& direction : { axes.Left, axes.Superior })
  {
    const Extent breast = ReachOf(kept, direction, &held);
    if (breast.Length() >= 0)
    {
      CheckUsual(input, ValidRanges::BreastWidth, breast.Length(), PathOfTissue(input), "Crop");
    }
  }
  CheckSide(input, ReachOf(kept, axes.Left, &held), ReachOf(materials, axes.Left, nullptr),
    laterality);
}

namespace
{
double AreaCm2(const RegistrationTarget& target)
{
  const auto breast = std::count(target.BreastMask.begin(), target.BreastMask.end(), 1);
  return static_cast<double>(breast) * target.Grid.PixelAreaMm2() / 100;
}

/// Of the picture's volume, area times thickness, over the MRI's breast. Of the five virtual
/// studies that the validation begins with: 0.44 to 0.77 in CC, 0.51 to 0.85 in MLO, since plates
/// do not take all that lies before the chest wall; oblique pictures have the pectoral muscle, too.
struct SizeLimits
{
  double Usual[2];
  double Possible[2];
};
constexpr SizeLimits CcLimits{ { 0.3, 1.2 }, { 0.15, 2.0 } };
constexpr SizeLimits MloLimits{ { 0.3, 1.6 }, { 0.15, 2.5 } };
/// Area of MLO over that of CC, in those studies 0.83 to 1.2.
constexpr double LeastAreaRatio = 0.55;
constexpr double MostAreaRatio = 2.2;

bool IsWithin(double value, const double (&limits)[2])
{
  return value >= limits[0] && value <= limits[1];
}

void CheckSize(double breastCm3, double areaCm2, RegisteredView& view)
{
  const double picturedCm3 = areaCm2 * view.Mammogram.BodyPartThicknessMm.value_or(0) / 10;
  if (!(picturedCm3 > 0) || !(breastCm3 > 0))
  {
    return;
  }
  const SizeLimits& limits = view.Mammogram.View == "CC" ? CcLimits : MloLimits;
  const double ratio = picturedCm3 / breastCm3;
  char text[256];
  if (!IsWithin(ratio, limits.Possible))
  {
    std::snprintf(text, sizeof text,
      ": expected a picture of the breast in the MRI (%.0f cm3), found one of %.0f cm3 (area times "
      "thickness): of another breast, or of a part of it",
      breastCm3, picturedCm3);
    throw InputError(view.Path + text, { "Mammograms", view.Path, { "AcceptUnusual" } });
  }
  if (!IsWithin(ratio, limits.Usual))
  {
    std::snprintf(text, sizeof text,
      "The picture shows %.0f cm3 of breast (area times thickness), the MRI %.0f cm3: it may be of "
      "another breast, or of a part of it.",
      picturedCm3, breastCm3);
    view.View.Target.Disagreements.emplace_back(text);
  }
}
}

void CheckSizes(const RegistrationCase& input, double breastCm3, std::vector<RegisteredView>& views)
{
  // Labels that are given may hold a part of the breast only.
  if (!input.Study || input.Labels.AcceptUnusual)
  {
    return;
  }
  double ccCm2 = 0;
  RegisteredView* mlo = nullptr;
  double mloCm2 = 0;
  for (RegisteredView& view : views)
  {
    const double areaCm2 = AreaCm2(view.View.Target);
    CheckSize(breastCm3, areaCm2, view);
    ccCm2 = view.Mammogram.View == "CC" ? areaCm2 : ccCm2;
    mlo = view.Mammogram.View == "MLO" ? &view : mlo;
    mloCm2 = mlo == &view ? areaCm2 : mloCm2;
  }
  const double ratio = mloCm2 / std::max(1e-9, ccCm2);
  if (mlo && ccCm2 > 0 && (ratio < LeastAreaRatio || ratio > MostAreaRatio))
  {
    char text[200];
    std::snprintf(text, sizeof text,
      "The breast is %.0f cm2 in MLO and %.0f in CC: they may be of two breasts, or one shows a "
      "part only.",
      mloCm2, ccCm2);
    mlo->View.Target.Disagreements.emplace_back(text);
  }
}
}
