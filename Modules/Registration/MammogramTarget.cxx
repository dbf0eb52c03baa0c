// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/MammogramTarget.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/MammogramMask.h"

#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImageInterpolator.h"
#include "vtkImageMedian3D.h"
#include "vtkImageReslice.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace mammoray
{
namespace
{
enum class Side
{
  Left,
  Right,
  Top,
  Bottom
};

const char* NameOf(Side side)
{
  switch (side)
  {
    case Side::Left:
      return "left";
    case Side::Right:
      return "right";
    case Side::Top:
      return "upper";
    default:
      return "lower";
  }
}

using Mask = std::vector<unsigned char>;

/// Grid of the pixels with their distances, mm.
struct Grid
{
  int Columns = 0;
  int Rows = 0;
  double ColumnSpacing = 1;
  double RowSpacing = 1;

  std::size_t Count() const
  {
    return static_cast<std::size_t>(this->Columns) * static_cast<std::size_t>(this->Rows);
  }
  std::size_t Index(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Columns) +
      static_cast<std::size_t>(column);
  }
};

vtkSmartPointer<vtkImageData> EmptyImage(const Grid& grid)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(grid.Columns, grid.Rows, 1);
  image->SetSpacing(grid.ColumnSpacing, grid.RowSpacing, 1);
  return image;
}

/// The image refers to `values`, which must outlive it.
template <typename Array, typename Value>
vtkSmartPointer<vtkImageData> Wrap(const Grid& grid, std::vector<Value>& values)
{
  auto image = EmptyImage(grid);
  vtkNew<Array> array;
  array->SetArray(values.data(), static_cast<vtkIdType>(values.size()), 1);
  image->GetPointData()->SetScalars(array);
  return image;
}

template <typename Value>
std::vector<Value> Copy(vtkImageData* image)
{
  vtkDataArray* array = image->GetPointData()->GetScalars();
  const auto* values = static_cast<const Value*>(array->GetVoidPointer(0));
  return { values, values + array->GetNumberOfValues() };
}

std::vector<float> Median3x3(const Grid& grid, std::vector<float>& values)
{
  vtkNew<vtkImageMedian3D> median;
  median->SetInputData(Wrap<vtkFloatArray>(grid, values));
  median->SetKernelSize(3, 3, 1);
  median->Update();
  return Copy<float>(median->GetOutput());
}

/**
 * Squared distance transform of one line by the lower envelope of parabolas (Felzenszwalb and
 * Huttenlocher 2012, algorithm 1). `heights` are squared distances at places `spacing` apart;
 * infinite where there is none. `hull` and `reach` are working space of the line's length (+ 1).
 */
void TransformLine(const std::vector<double>& heights, double spacing, std::vector<int>& hull,
  std::vector<double>& reach, std::vector<double>& result)
{
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  const int count = static_cast<int>(heights.size());
  int last = -1;
  for (int q = 0; q < count; ++q)
  {
    if (heights[q] == Infinity)
    {
      continue;
    }
    const double atQ = q * spacing;
    double crossing = -Infinity;
    while (last >= 0)
    {
      const double atP = hull[last] * spacing;
      crossing = (heights[q] + atQ * atQ - heights[hull[last]] - atP * atP) / (2 * (atQ - atP));
      if (crossing > reach[last])
      {
        break;
      }
      --last;
    }
    ++last;
    hull[last] = q;
    reach[last] = last == 0 ? -Infinity : crossing;
  }
  if (last < 0)
  {
    std::fill(result.begin(), result.end(), Infinity);
    return;
  }
  int piece = 0;
  for (int q = 0; q < count; ++q)
  {
    while (piece < last && reach[piece + 1] < q * spacing)
    {
      ++piece;
    }
    const double offset = (q - hull[piece]) * spacing;
    result[q] = offset * offset + heights[hull[piece]];
  }
}

/**
 * Distance of each set pixel's centre to the nearest centre of a clear one, mm; 0 at clear pixels,
 * infinite where there is none. The border is nothing special. Not vtkImageEuclideanDistance: it
 * left pixels of a mammogram at its upper limit, and took half a minute for 14 million of them.
 */
std::vector<float> DistanceToClear(const Grid& grid, const Mask& mask)
{
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  std::vector<float> squares(mask.size());
  const int longest = std::max(grid.Columns, grid.Rows);
  std::vector<int> hull(longest);
  std::vector<double> reach(longest);
  std::vector<double> heights(grid.Columns);
  std::vector<double> line(grid.Columns);
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      heights[column] = mask[grid.Index(column, row)] ? Infinity : 0;
    }
    TransformLine(heights, grid.ColumnSpacing, hull, reach, line);
    std::copy(line.begin(), line.end(),
      squares.begin() + static_cast<std::ptrdiff_t>(grid.Index(0, row)));
  }
  heights.resize(grid.Rows);
  line.resize(grid.Rows);
  for (int column = 0; column < grid.Columns; ++column)
  {
    for (int row = 0; row < grid.Rows; ++row)
    {
      heights[row] = squares[grid.Index(column, row)];
    }
    TransformLine(heights, grid.RowSpacing, hull, reach, line);
    for (int row = 0; row < grid.Rows; ++row)
    {
      squares[grid.Index(column, row)] = static_cast<float>(std::sqrt(line[row]));
    }
  }
  return squares;
}

/// Pieces of a mask whose pixels share edges: a label for each pixel (0 outside) and the pixel
/// count of each label (from 1).
struct Pieces
{
  std::vector<int> Labels;
  std::vector<std::size_t> Sizes;
};

/// Here and not by vtkImageConnectivityFilter, whose module ParaView's VTK lacks.
Pieces FindPieces(const Grid& grid, const Mask& mask)
{
  Pieces pieces;
  pieces.Labels.assign(mask.size(), 0);
  pieces.Sizes.assign(1, 0);
  std::vector<std::array<int, 2>> front;
  const auto visit = [&](int column, int row)
  {
    const std::size_t pixel = grid.Index(column, row);
    if (mask[pixel] != 0 && pieces.Labels[pixel] == 0)
    {
      pieces.Labels[pixel] = static_cast<int>(pieces.Sizes.size()) - 1;
      ++pieces.Sizes.back();
      front.push_back({ column, row });
    }
  };
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    if (mask[pixel] == 0 || pieces.Labels[pixel] != 0)
    {
      continue;
    }
    pieces.Sizes.push_back(0);
    visit(static_cast<int>(pixel) % grid.Columns, static_cast<int>(pixel) / grid.Columns);
    while (!front.empty())
    {
      const auto [column, row] = front.back();
      front.pop_back();
      for (const int step : { -1, 1 })
      {
        if (column + step >= 0 && column + step < grid.Columns)
        {
          visit(column + step, row);
        }
        if (row + step >= 0 && row + step < grid.Rows)
        {
          visit(column, row + step);
        }
      }
    }
  }
  return pieces;
}

float Quantile(std::vector<float> values, double fraction)
{
  const auto nth =
    values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

std::vector<float> Select(const std::vector<float>& values, const Mask& mask)
{
  std::vector<float> selected;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (mask[i])
    {
      selected.push_back(values[i]);
    }
  }
  return selected;
}

/// Otsu (1979): the threshold that leaves the least variance within two classes.
float OtsuThreshold(const std::vector<float>& values, float low, float high)
{
  constexpr int Bins = 512;
  std::vector<double> histogram(Bins, 0.0);
  for (const float value : values)
  {
    const double bin = Bins * (static_cast<double>(value) - low) / (high - low);
    histogram[static_cast<std::size_t>(std::clamp(bin, 0.0, Bins - 1.0))] += 1;
  }
  double total = 0;
  for (int bin = 0; bin < Bins; ++bin)
  {
    total += bin * histogram[bin];
  }
  double weight = 0;
  double sum = 0;
  double best = -1;
  int bestFirst = 0;
  int bestLast = 0;
  const double count = static_cast<double>(values.size());
  for (int bin = 0; bin < Bins - 1; ++bin)
  {
    weight += histogram[bin];
    sum += bin * histogram[bin];
    if (weight == 0 || weight == count)
    {
      continue;
    }
    const double difference = sum / weight - (total - sum) / (count - weight);
    const double between = weight * (count - weight) * difference * difference;
    if (between > best)
    {
      best = between;
      bestFirst = bin;
    }
    // Empty bins between the classes are equally good: take their middle.
    if (between >= best)
    {
      bestLast = bin;
    }
  }
  return low + (high - low) * (0.5F * static_cast<float>(bestFirst + bestLast) + 1) / Bins;
}

/// More where more is absorbed, by what the header says. Air is not at 0 yet.
std::vector<float> ToLogAttenuation(const Mammogram& mammogram, std::vector<std::string>& warnings)
{
  using Relationship = Mammogram::Relationship;
  const bool processing = mammogram.PresentationIntent == Mammogram::Intent::ForProcessing;
  Relationship relationship = mammogram.IntensityRelationship;
  if (relationship == Relationship::Unknown && processing)
  {
    relationship = Relationship::Linear;
    warnings.push_back("The header does not say how stored values follow X-ray intensity; a For "
                       "Processing image is taken as linear.");
  }
  if (relationship == Relationship::Logarithmic && processing)
  {
    warnings.push_back(
      "The header calls this For Processing image logarithmic: its values are used "
      "as log attenuation up to scale and offset.");
  }
  // Small values shown bright: they are where little got through.
  const int bySign = mammogram.IntensitySign;
  const int byDisplay = mammogram.InvertedForDisplay ? 1 : -1;
  const int sign = bySign != 0 ? bySign : byDisplay;
  if (bySign != 0 && bySign != byDisplay && !processing)
  {
    warnings.push_back(
      "Pixel Intensity Relationship Sign contradicts the photometric interpretation; "
      "the former is followed.");
  }
  std::vector<float> result(mammogram.Pixels.size());
  if (relationship != Relationship::Linear || !processing)
  {
    std::transform(mammogram.Pixels.begin(), mammogram.Pixels.end(), result.begin(),
      [sign](float value) { return static_cast<float>(-sign) * value; });
    return result;
  }
  if (sign < 0)
  {
    // Linear and falling with intensity: counts are what is missing to the largest stored value.
    warnings.push_back("Stored values fall linearly with X-ray intensity; they are subtracted from "
                       "the largest value the stored bits can hold.");
  }
  const float full = std::ldexp(1.0F, mammogram.BitsStored) - 1;
  // Half a count stands for none, so that dead pixels stay finite.
  std::transform(mammogram.Pixels.begin(), mammogram.Pixels.end(), result.begin(),
    [sign, full](float value) {
      return std::isnan(value) ? value : -std::log(std::max(sign > 0 ? value : full - value, 0.5F));
    });
  return result;
}

/// How many pixels of a mask lie on each side of the picture, as a part of that side.
std::array<double, 4> TouchedSides(const Grid& grid, const Mask& mask)
{
  std::array<double, 4> touched{ 0, 0, 0, 0 };
  for (int row = 0; row < grid.Rows; ++row)
  {
    touched[0] += mask[grid.Index(0, row)] != 0;
    touched[1] += mask[grid.Index(grid.Columns - 1, row)] != 0;
  }
  for (int column = 0; column < grid.Columns; ++column)
  {
    touched[2] += mask[grid.Index(column, 0)] != 0;
    touched[3] += mask[grid.Index(column, grid.Rows - 1)] != 0;
  }
  for (int side = 0; side < 4; ++side)
  {
    touched[side] *= side < 2 ? grid.RowSpacing : grid.ColumnSpacing; // mm of contact
  }
  return touched;
}

/**
 * A dark frame along a side of the picture (rows that the detector does not read) is no air: where
 * the breast touches the line 1 mm inside the side much more than the side itself, the stripe
 * between is filled.
 */
void FillDarkFrame(const Grid& grid, Mask& mask)
{
  constexpr double FrameMm = 1;
  const int columns = grid.Columns;
  const int rows = grid.Rows;
  for (const Side side : { Side::Left, Side::Right, Side::Top, Side::Bottom })
  {
    const bool upright = side == Side::Left || side == Side::Right;
    const int length = upright ? rows : columns;
    const double spacing = upright ? grid.ColumnSpacing : grid.RowSpacing;
    const int depth = std::max(2, static_cast<int>(std::lround(FrameMm / spacing)));
    if (2 * depth >= (upright ? columns : rows))
    {
      continue;
    }
    const auto at = [&](int along, int inward)
    {
      const bool far = side == Side::Right || side == Side::Bottom;
      const int across = far ? (upright ? columns : rows) - 1 - inward : inward;
      return upright ? grid.Index(across, along) : grid.Index(along, across);
    };
    int touching = 0;
    int near = 0;
    for (int along = 0; along < length; ++along)
    {
      touching += mask[at(along, 0)];
      near += mask[at(along, depth)];
    }
    if (2 * touching >= near)
    {
      continue;
    }
    for (int along = 0; along < length; ++along)
    {
      for (int inward = 0; mask[at(along, depth)] && inward < depth; ++inward)
      {
        mask[at(along, inward)] = 1;
      }
    }
  }
}

/// Keeps what is thick, with everything of the mask near it.
Mask WithoutThinParts(const Grid& grid, Mask mask, double thinnest)
{
  const double radius = 0.5 * thinnest;
  if (radius < std::max(grid.ColumnSpacing, grid.RowSpacing))
  {
    return mask;
  }
  const std::vector<float> depth = DistanceToClear(grid, mask);
  Mask notCore(mask.size());
  std::transform(depth.begin(), depth.end(), notCore.begin(),
    [radius](float distance) { return distance <= radius ? 1 : 0; });
  const std::vector<float> toCore = DistanceToClear(grid, notCore);
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    // Twice the radius lets corners of the breast through, which the core does not reach into.
    mask[i] = mask[i] && toCore[i] <= 2 * radius ? 1 : 0;
  }
  return mask;
}

void KeepLargestPiece(const Grid& grid, Mask& mask)
{
  const Pieces pieces = FindPieces(grid, mask);
  if (pieces.Sizes.size() < 2)
  {
    throw InputError("mammogram: expected a breast, found nothing brighter than the air");
  }
  const auto largest = static_cast<int>(
    std::max_element(pieces.Sizes.begin(), pieces.Sizes.end()) - pieces.Sizes.begin());
  std::transform(pieces.Labels.begin(), pieces.Labels.end(), mask.begin(),
    [largest](int label) { return label == largest ? 1 : 0; });
}

/// Clear pieces that touch no side of the picture become part of the mask.
void FillHoles(const Grid& grid, Mask& mask)
{
  Mask clear(mask.size());
  std::transform(mask.begin(), mask.end(), clear.begin(),
    [](unsigned char set) { return set ? 0 : 1; });
  const Pieces pieces = FindPieces(grid, clear);
  std::vector<bool> open(pieces.Sizes.size(), false);
  for (int row = 0; row < grid.Rows; ++row)
  {
    open[pieces.Labels[grid.Index(0, row)]] = true;
    open[pieces.Labels[grid.Index(grid.Columns - 1, row)]] = true;
  }
  for (int column = 0; column < grid.Columns; ++column)
  {
    open[pieces.Labels[grid.Index(column, 0)]] = true;
    open[pieces.Labels[grid.Index(column, grid.Rows - 1)]] = true;
  }
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    mask[i] = mask[i] || !open[pieces.Labels[i]] ? 1 : 0;
  }
}

/// The image between its pixels: `factor` (odd) times as fine, by linear interpolation.
std::vector<float> Refine(const Grid& grid, std::vector<float>& values, const Grid& fine,
  int factor)
{
  if (factor == 1)
  {
    return values;
  }
  vtkNew<vtkImageInterpolator> linear;
  linear->SetInterpolationModeToLinear();
  linear->SetBorderModeToClamp();
  // Pixels at the border reach half a pixel beyond their centres.
  linear->SetTolerance(1.0);
  vtkNew<vtkImageReslice> reslice;
  reslice->SetInputData(Wrap<vtkFloatArray>(grid, values));
  reslice->SetInterpolator(linear);
  reslice->SetOutputSpacing(fine.ColumnSpacing, fine.RowSpacing, 1);
  reslice->SetOutputExtent(0, fine.Columns - 1, 0, fine.Rows - 1, 0, 0);
  const int half = factor / 2;
  reslice->SetOutputOrigin(-half * fine.ColumnSpacing, -half * fine.RowSpacing, 0);
  reslice->Update();
  return Copy<float>(reslice->GetOutput());
}

/// Signed distance to the outline of a mask, mm, negative inside; its border with the picture is
/// none.
std::vector<float> SignedDistance(const Grid& grid, const Mask& mask)
{
  std::vector<float> distances = DistanceToClear(grid, mask);
  Mask clear(mask.size());
  std::transform(mask.begin(), mask.end(), clear.begin(),
    [](unsigned char set) { return set ? 0 : 1; });
  const std::vector<float> outside = DistanceToClear(grid, clear);
  // The outline runs midway between the centres of a pixel in the breast and one outside.
  const auto half = static_cast<float>(0.25 * (grid.ColumnSpacing + grid.RowSpacing));
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    distances[i] = mask[i] ? half - distances[i] : outside[i] - half;
  }
  return distances;
}

/// What the letters of a direction mean along gantry +x of the view: > 0 with it, < 0 against it.
double AlongX(const std::string& direction, double rollDeg)
{
  // Gantry x at roll r is cos r * left - sin r * superior (MammographyGeometry.h).
  const double roll = rollDeg * std::numbers::pi / 180;
  const double left = std::cos(roll);
  const double head = -std::sin(roll);
  double along = 0;
  for (const char letter : direction)
  {
    along += letter == 'L' ? left
      : letter == 'R'      ? -left
      : letter == 'H'      ? head
      : letter == 'F'      ? -head
                           : 0;
  }
  return along;
}

/// Chest-wall side by Patient Orientation: the direction whose first letter is A or P leads from or
/// to it.
bool SideByHeader(const Mammogram& mammogram, Side& side)
{
  const auto first = [](const std::string& text) { return text.empty() ? ' ' : text[0]; };
  const char row = first(mammogram.RowDirection);
  const char column = first(mammogram.ColumnDirection);
  if (row == 'A' || row == 'P')
  {
    side = row == 'A' ? Side::Left : Side::Right;
    return true;
  }
  if (column == 'A' || column == 'P')
  {
    side = column == 'A' ? Side::Top : Side::Bottom;
    return true;
  }
  return false;
}

/// Answers the roll of the view, as said or assumed, degrees.
double PlaceInGantry(const Mammogram& mammogram, const Grid& grid,
  const std::array<double, 4>& touched, RegistrationTarget& target)
{
  const auto most = std::max_element(touched.begin(), touched.end());
  const Side seen = static_cast<Side>(most - touched.begin());
  Side side = seen;
  if (!SideByHeader(mammogram, side))
  {
    target.Warnings.push_back(
      std::string("The header gives no patient orientation; the chest wall is "
                  "taken to be at the ") +
      NameOf(seen) + " edge of the picture, which the breast touches most.");
  }
  else if (touched[static_cast<int>(side)] < 0.5 * *most)
  {
    target.Warnings.push_back(std::string("The header puts the chest wall at the ") + NameOf(side) +
      " edge of the picture, but the breast touches the " + NameOf(seen) +
      " edge most; the header is followed.");
  }
  const bool upright = side == Side::Left || side == Side::Right;
  const std::string& across = upright ? mammogram.ColumnDirection : mammogram.RowDirection;

  char laterality = mammogram.Laterality;
  std::optional<double> roll = NominalRollDeg(mammogram);
  if (!roll)
  {
    Mammogram assumed = mammogram;
    if (laterality != 'L' && laterality != 'R')
    {
      // Mammograms are hung with the left breast's chest wall at the left.
      laterality = side == Side::Right ? 'R' : 'L';
      assumed.Laterality = laterality;
      target.Warnings.push_back(
        std::string("The header does not say which breast this is; taken as the ") +
        (laterality == 'L' ? "left" : "right") + " one, as mammograms are hung.");
    }
    roll = NominalRollDeg(assumed);
    if (!roll)
    {
      roll = 0.0;
      target.Warnings.push_back("The header's view '" + mammogram.View +
        "' is not one of CC, MLO, ML, LM, LMO, FB; taken as CC.");
    }
  }
  double along = AlongX(across, *roll);
  if (std::abs(along) < 0.1)
  {
    if (laterality != 'L' && laterality != 'R')
    {
      laterality = side == Side::Right ? 'R' : 'L';
      target.Warnings.push_back(
        std::string("The header does not say which breast this is; taken as the ") +
        (laterality == 'L' ? "left" : "right") + " one, as mammograms are hung.");
    }
    // Hung with the lateral side (CC) or the head (other views) up.
    const bool fromAbove = std::abs(std::cos(*roll * std::numbers::pi / 180)) > 0.9;
    const std::string down = !fromAbove ? "F" : laterality == 'L' ? "R" : "L";
    along = AlongX(down, *roll);
    // Turned pictures are taken as turned by 90 degrees from the way mammograms are hung.
    if (side == Side::Top)
    {
      along = -along;
    }
    target.Warnings.push_back(
      std::string("The header does not give the patient direction along the "
                  "chest wall; the ") +
      (fromAbove ? "lateral side" : "head") + " is taken to be " +
      (upright ? "up" : "where it is after turning an upright picture") + ".");
  }
  const double direction = along > 0 ? 1 : -1;
  const double inward = side == Side::Left || side == Side::Top ? 1 : -1;
  if (upright)
  {
    target.ColumnStep = { 0, inward * grid.ColumnSpacing };
    target.RowStep = { direction * grid.RowSpacing, 0 };
    target.Origin = { -0.5 * (grid.Rows - 1) * target.RowStep[0],
      inward > 0 ? 0.5 * grid.ColumnSpacing : (grid.Columns - 0.5) * grid.ColumnSpacing };
  }
  else
  {
    target.ColumnStep = { direction * grid.ColumnSpacing, 0 };
    target.RowStep = { 0, inward * grid.RowSpacing };
    target.Origin = { -0.5 * (grid.Columns - 1) * target.ColumnStep[0],
      inward > 0 ? 0.5 * grid.RowSpacing : (grid.Rows - 0.5) * grid.RowSpacing };
  }
  return *roll;
}

/// What is not compared: see TargetOptions.
void Exclude(const Mammogram& mammogram, double rollDeg, const TargetOptions& options,
  RegistrationTarget& target)
{
  const bool oblique = mammogram.View == "MLO" || mammogram.View == "LMO";
  if (options.ExcludePectoral && oblique)
  {
    const int headward = AlongX("H", rollDeg) > 0 ? 1 : -1;
    if (const std::optional<PectoralEdge> edge = FindPectoralEdge(target, headward))
    {
      ExcludePectoral(*edge, headward, target);
    }
  }
  if (options.ExcludeMarkers)
  {
    ExcludeSaturated(target);
  }
}

/// An odd number of fine pixels per pixel.
int RefinementFactor(double spacing, double wanted)
{
  const int factor = std::max(1, static_cast<int>(std::ceil(spacing / wanted - 1e-9)));
  return factor % 2 == 1 ? factor : factor + 1;
}

void Validate(const Mammogram& mammogram, const TargetOptions& options)
{
  const std::size_t count = mammogram.Columns > 0 && mammogram.Rows > 0
    ? static_cast<std::size_t>(mammogram.Columns) * static_cast<std::size_t>(mammogram.Rows)
    : 0;
  if (mammogram.Columns < 8 || mammogram.Rows < 8 || mammogram.Pixels.size() != count)
  {
    throw InputError("mammogram: expected at least 8 x 8 pixels and a value for each, found " +
      std::to_string(mammogram.Columns) + " x " + std::to_string(mammogram.Rows) + " with " +
      std::to_string(mammogram.Pixels.size()) + " values");
  }
  if (!(mammogram.ColumnSpacingMm > 0) || !(mammogram.RowSpacingMm > 0))
  {
    throw InputError("mammogram: expected positive pixel spacings");
  }
  if (!(options.EdgeFraction > 0 && options.EdgeFraction < 1) || !(options.EdgeSigmas > 0) ||
    !(options.OutlineGridMm > 0) || !(options.ThinnestFeatureMm >= 0))
  {
    throw InputError(
      "target options: expected an edge fraction in (0, 1), positive edge sigmas and "
      "outline grid, and a thinnest feature of 0 or more");
  }
}
}

RegistrationTarget PrepareTarget(const Mammogram& mammogram, const TargetOptions& options)
{
  Validate(mammogram, options);
  RegistrationTarget target;
  target.Columns = mammogram.Columns;
  target.Rows = mammogram.Rows;
  const Grid grid{ mammogram.Columns, mammogram.Rows, mammogram.ColumnSpacingMm,
    mammogram.RowSpacingMm };
  std::vector<float>& log = target.LogAttenuation;
  log = ToLogAttenuation(mammogram, target.Warnings);

  // Padding was not exposed: it is no breast, and takes the air's value below.
  Mask measured(log.size());
  std::transform(log.begin(), log.end(), measured.begin(),
    [](float value) { return std::isfinite(value) ? 1 : 0; });
  const std::vector<float> valid = Select(log, measured);
  if (valid.empty())
  {
    throw InputError("mammogram: expected a picture, found padding only");
  }
  const float low = Quantile(valid, 0.001);
  const float high = Quantile(valid, 0.999);
  if (!(high > low))
  {
    throw InputError("mammogram: expected a breast and air, found a flat picture");
  }
  // Air first, roughly: the class below Otsu's threshold, away from it.
  for (std::size_t i = 0; i < log.size(); ++i)
  {
    log[i] = measured[i] ? log[i] : low;
  }
  std::vector<float> smooth = Median3x3(grid, log);
  const float rough = OtsuThreshold(valid, low, high);
  Mask air(log.size());
  Mask body(log.size());
  for (std::size_t i = 0; i < log.size(); ++i)
  {
    air[i] = measured[i] && smooth[i] < rough ? 1 : 0;
    body[i] = measured[i] && smooth[i] >= rough ? 1 : 0;
  }
  constexpr double EdgeZoneMm = 5; // the bulge's edge and the scatter beside it
  const std::vector<float> depth = DistanceToClear(grid, air);
  Mask farAir(log.size());
  std::transform(depth.begin(), depth.end(), farAir.begin(),
    [](float distance) { return distance > EdgeZoneMm ? 1 : 0; });
  std::vector<float> airValues = Select(smooth, farAir);
  if (airValues.size() < 64)
  {
    airValues = Select(smooth, air);
  }
  const std::vector<float> bodyValues = Select(smooth, body);
  if (airValues.empty() || bodyValues.empty())
  {
    throw InputError("mammogram: expected a breast and air, found only one of them");
  }
  const float airLevel = Quantile(airValues, 0.5);
  for (float& value : airValues)
  {
    value = std::abs(value - airLevel);
  }
  const double airSigma = 1.4826 * Quantile(airValues, 0.5);
  const double contrast = Quantile(bodyValues, 0.5) - airLevel;
  const auto edge = static_cast<float>(
    airLevel + std::max(options.EdgeFraction * contrast, options.EdgeSigmas * airSigma));
  for (float& value : log)
  {
    value -= airLevel;
  }
  for (std::size_t i = 0; i < log.size(); ++i)
  {
    log[i] = measured[i] ? log[i] : 0.0F;
    smooth[i] = measured[i] ? smooth[i] : airLevel;
  }

  const int columnFactor = RefinementFactor(grid.ColumnSpacing, options.OutlineGridMm);
  const int rowFactor = RefinementFactor(grid.RowSpacing, options.OutlineGridMm);
  const int factor = std::max(columnFactor, rowFactor);
  const Grid fine{ grid.Columns * factor, grid.Rows * factor, grid.ColumnSpacing / factor,
    grid.RowSpacing / factor };
  const std::vector<float> fineImage = Refine(grid, smooth, fine, factor);
  Mask mask(fineImage.size());
  std::transform(fineImage.begin(), fineImage.end(), mask.begin(),
    [edge](float value) { return value > edge ? 1 : 0; });
  const Mask seen = mask;
  FillDarkFrame(fine, mask);
  mask = WithoutThinParts(fine, std::move(mask), options.ThinnestFeatureMm);
  KeepLargestPiece(fine, mask);
  FillHoles(fine, mask);

  const double rollDeg = PlaceInGantry(mammogram, grid, TouchedSides(fine, mask), target);
  if (std::find(mask.begin(), mask.end(), 0) == mask.end())
  {
    throw InputError("mammogram: expected air beside the breast, found none");
  }
  const std::vector<float> distances = SignedDistance(fine, mask);
  target.SignedDistanceMm.resize(grid.Count());
  target.BreastMask.resize(grid.Count());
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      const std::size_t from = fine.Index(column * factor + factor / 2, row * factor + factor / 2);
      const std::size_t to = grid.Index(column, row);
      target.SignedDistanceMm[to] = distances[from];
      target.BreastMask[to] = distances[from] < 0 ? 1 : 0;
      // Filled: a dark frame of the detector, or a hole.
      if (options.ExcludeUnseen && mask[from] && !seen[from])
      {
        target.Excluded.resize(grid.Count(), 0);
        target.Excluded[to] = 1;
      }
    }
  }
  Exclude(mammogram, rollDeg, options, target);
  const double part = static_cast<double>(std::accumulate(target.BreastMask.begin(),
                        target.BreastMask.end(), std::size_t{ 0 })) /
    static_cast<double>(grid.Count());
  if (part < 0.02 || part > 0.95)
  {
    target.Warnings.push_back("The breast was found on " + std::to_string(std::lround(100 * part)) +
      " % of the picture: its outline should be looked at.");
  }
  return target;
}
}
