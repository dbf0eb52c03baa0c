// SPDX-License-Identifier: Apache-2.0
#include "Private/Picture.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/ContourLines.h"
#include "mammoray/Study/StudyPictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mammoray
{
namespace
{
constexpr int SlicesPerPlane = 3;
constexpr int PanelPixels = 360; // the longer side
constexpr int SliceMargin = 12;
constexpr int PlaneTitleHeight = 28;
constexpr int SliceLegendWidth = 170;
constexpr double BorderMm = 5.0;

/// A plane of the patient: what is right, up and towards the viewer in the picture.
struct Plane
{
  const char* Name;
  /// Where the normal points.
  const char* Direction;
  /// Patient directions at the left, right, upper and lower side.
  std::array<std::string, 4> Letters;
  /// Indices of patient directions, and which way they go in the picture.
  int Right;
  double RightSign;
  int Up;
  int Normal;
};

// As radiologists look at them: from below and from the front (patient's left on the right), and
// from the patient's left.
const Plane Planes[] = { { "axial", "head", { "R", "L", "A", "P" }, 0, 1, 1, 2 },
  { "coronal", "front", { "R", "L", "H", "F" }, 0, 1, 2, 1 },
  { "sagittal", "left", { "A", "P", "H", "F" }, 1, -1, 2, 0 } };

/// A slice in a picture: mm along the plane's normal, and pixels of the lower left corner.
struct Slice
{
  const Plane& In;
  double PlaceMm;
  int Left;
  int Low;
};

/// A tissue's colour, dark enough for marks and letters to stand out on it.
PictureColor Subdued(int label)
{
  return Mixed(LabelColor(label), { 30, 30, 34 }, 0.45);
}

/// The box of a volume's labels, in the directions of the patient, and its slices.
class Slices
{
public:
  /// `image` may be null.
  Slices(const IntensityVolume* image, const LabelVolume& labels, const AnatomicalAxes& axes)
    : Image(image)
    , Labels(labels)
    , Directions{ axes.Left, axes.Anterior, axes.Superior }
  {
    std::vector<double> values;
    labels.ForEachVoxel(
      [&](int i, int j, int k, std::size_t voxel)
      {
        if (labels.Voxels[voxel] == 0)
        {
          return;
        }
        const Vector3 point = labels.PointAt(i, j, k);
        for (int d = 0; d < 3; ++d)
        {
          const double at = Dot(point, this->Directions[d]);
          this->Box[d].Add(at - BorderMm);
          this->Box[d].Add(at + BorderMm);
        }
        values.push_back(this->ValueAt(point));
      });
    if (values.empty())
    {
      throw InputError("slice picture: expected labels, found only air");
    }
    this->White = std::max(QuantileElement(std::move(values), 0.995), 1e-30);
    this->PixelMm =
      std::max({ this->Box[0].Length(), this->Box[1].Length(), this->Box[2].Length() }) /
      PanelPixels;
  }

  int Width(const Plane& plane) const { return this->Pixels(plane.Right); }
  int Height(const Plane& plane) const { return this->Pixels(plane.Up); }
  /// mm along the plane's normal, a share of the way through the box.
  double PlaceAt(const Plane& plane, double share) const
  {
    return this->Box[plane.Normal].Low + share * this->Box[plane.Normal].Length();
  }
  double PlaceOf(const Plane& plane, const Vector3& point) const
  {
    return Dot(point, this->Directions[plane.Normal]);
  }
  /// The volume's point at the middle of a pixel, counted from the slice's lower left one.
  Vector3 PointAt(const Slice& slice, int x, int y) const
  {
    const Plane& plane = slice.In;
    const double start =
      plane.RightSign > 0 ? this->Box[plane.Right].Low : this->Box[plane.Right].High;
    return (start + plane.RightSign * (x + 0.5) * this->PixelMm) * this->Directions[plane.Right] +
      (this->Box[plane.Up].Low + (y + 0.5) * this->PixelMm) * this->Directions[plane.Up] +
      slice.PlaceMm * this->Directions[plane.Normal];
  }
  /// Where a point of the volume lies in the picture.
  PicturePoint PixelOf(const Slice& slice, const Vector3& point) const
  {
    const Plane& plane = slice.In;
    const double right = Dot(point, this->Directions[plane.Right]);
    const double along = plane.RightSign > 0 ? right - this->Box[plane.Right].Low
                                             : this->Box[plane.Right].High - right;
    const double up = Dot(point, this->Directions[plane.Up]) - this->Box[plane.Up].Low;
    return { slice.Left + along / this->PixelMm, slice.Low + up / this->PixelMm };
  }
  double PixelSizeMm() const { return this->PixelMm; }

  /// Draws the image in grey, or the tissues in colour, and a title below.
  void Draw(Picture& picture, const Slice& slice, bool withOutlines) const
  {
    const auto labelAt = [&](int x, int y)
    { return this->Labels.LabelAt(this->PointAt(slice, x, y)); };
    for (int y = 0; y < this->Height(slice.In); ++y)
    {
      for (int x = 0; x < this->Width(slice.In); ++x)
      {
        const int label = labelAt(x, y);
        // An outline lies inside its label, so that neighbours both show.
        const bool edge = withOutlines && label != 0 &&
          (labelAt(x - 1, y) != label || labelAt(x + 1, y) != label || labelAt(x, y - 1) != label ||
            labelAt(x, y + 1) != label);
        picture.Set(slice.Left + x, slice.Low + y,
          edge ? LabelColor(label)
            : !this->Image && label > 0
            ? Subdued(label)
            : Grey(this->ValueAt(this->PointAt(slice, x, y)) / this->White));
      }
    }
    char title[80];
    std::snprintf(title, sizeof(title), "%s, %s %.0f mm", slice.In.Name, slice.In.Direction,
      slice.PlaceMm);
    picture.Text(slice.Left + 0.5 * this->Width(slice.In), slice.Low - 0.5 * PlaneTitleHeight, 0.5,
      title);
  }

private:
  int Pixels(int direction) const
  {
    return static_cast<int>(std::ceil(this->Box[direction].Length() / this->PixelMm));
  }
  /// 0 outside, and without an image.
  double ValueAt(const Vector3& point) const
  {
    return this->Image ? this->Image->ValueAt(point).value_or(0.0F) : 0;
  }

  const IntensityVolume* Image;
  const LabelVolume& Labels;
  std::array<Vector3, 3> Directions;
  std::array<Extent, 3> Box;
  double White = 1;
  double PixelMm = 1;
};

PictureLegend LegendOf(const LabelVolume& labels, const std::vector<std::string>& names,
  PictureColor (*color)(int label))
{
  PictureLegend legend;
  for (const auto& [label, count] : labels.CountLabels())
  {
    if (label != 0)
    {
      const auto index = static_cast<std::size_t>(label);
      legend.emplace_back(index < names.size() ? names[index] : "label " + std::to_string(label),
        color(label));
    }
  }
  return legend;
}

/// Outlines of the lesion in a slice.
void OutlineLesion(const PointSlices& shown, const Slices& slices, const Slice& slice,
  SvgLines& lines)
{
  const int width = slices.Width(slice.In);
  const int height = slices.Height(slice.In);
  std::vector<float> inside;
  for (int y = 0; y < height; ++y)
  {
    for (int x = 0; x < width; ++x)
    {
      const bool lesion = shown.Lesions->LabelAt(slices.PointAt(slice, x, y)) == shown.LesionLabel;
      inside.push_back(lesion ? 1.0F : 0.0F);
    }
  }
  for (const auto& loop : ContourLines(inside.data(), width, height, 0.5F, 0.0F))
  {
    PictureLine points;
    for (const auto& [x, y] : loop)
    {
      points.push_back({ slice.Left + x + 0.5, slice.Low + y + 0.5 });
    }
    lines.Path(points, true, MarkColor);
  }
}
}

LayeredPicture DrawLabelSlices(const IntensityVolume& image, const LabelVolume& labels,
  const AnatomicalAxes& axes, const std::vector<std::string>& names, const std::string& title)
{
  image.ValidateGrid("slice picture", labels.Voxels.size());
  const Slices slices(&image, labels, axes);
  int width = 0;
  int height = SliceMargin;
  for (const Plane& plane : Planes)
  {
    width = std::max(width, SlicesPerPlane * (slices.Width(plane) + SliceMargin));
    height += slices.Height(plane) + PlaneTitleHeight;
  }
  width += SliceLegendWidth + SliceMargin;
  Picture picture(width, height);
  int low = height - SliceMargin;
  for (const Plane& plane : Planes)
  {
    low -= slices.Height(plane);
    for (int number = 0; number < SlicesPerPlane; ++number)
    {
      const double place = slices.PlaceAt(plane, (number + 1.0) / (SlicesPerPlane + 1.0));
      const int left = SliceMargin + number * (slices.Width(plane) + SliceMargin);
      slices.Draw(picture, { plane, place, left, low }, true);
    }
    low -= PlaneTitleHeight;
  }
  const int titleHeight = title.empty() ? 0 : PlaneTitleHeight;
  picture.Text(width - SliceLegendWidth, height - SliceMargin - 0.5 * titleHeight, 0, title);
  picture.Legend(width - SliceLegendWidth, height - SliceMargin - titleHeight,
    LegendOf(labels, names, [](int label) { return LabelColor(label); }));
  return { picture.Png(), width, height, {} };
}

LayeredPicture DrawPointSlices(const PointSlices& shown)
{
  const Slices slices(shown.Image, *shown.Labels, shown.Axes);
  int width = SliceMargin + (shown.Image ? 0 : SliceLegendWidth);
  int height = 0;
  for (const Plane& plane : Planes)
  {
    width += slices.Width(plane) + SliceMargin;
    height = std::max(height, slices.Height(plane));
  }
  height += PlaneTitleHeight + SliceMargin;
  Picture picture(width, height);
  SvgLines lines(height);
  int left = SliceMargin;
  for (const Plane& plane : Planes)
  {
    const int low = height - SliceMargin - slices.Height(plane);
    const Slice slice{ plane, slices.PlaceOf(plane, shown.Point), left, low };
    slices.Draw(picture, slice, false);
    picture.Letters(
      { 1.0 * left, 1.0 * low, 1.0 * slices.Width(plane), 1.0 * slices.Height(plane) }, 14,
      plane.Letters, { LightInk, 13, &Black });
    if (shown.Lesions)
    {
      OutlineLesion(shown, slices, slice, lines);
    }
    lines.Cross(slices.PixelOf(slice, shown.Point), "");
    left += slices.Width(plane) + SliceMargin;
  }
  if (!shown.Image)
  {
    picture.Legend(left, height - SliceMargin, LegendOf(*shown.Labels, shown.Names, Subdued));
  }
  // In the first slice's lower right corner.
  picture.ScaleBar(SliceMargin + slices.Width(Planes[0]) - 8,
    height - SliceMargin - slices.Height(Planes[0]) + 8, 20, slices.PixelSizeMm(),
    { LightInk, 11, &Black });
  return { picture.Png(), width, height, lines.Elements() };
}
}
