// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/SlicePicture.h"

#include "Private/Picture.h"
#include "Private/SvgLines.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/ContourLines.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

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
/// Of letters on a slice.
constexpr PictureColor SliceInk{ 217, 222, 230 };
constexpr PictureColor SliceRim{ 0, 0, 0 };

/// A box of the volume in the directions of the patient: left, front, head; mm.
struct PatientBox
{
  Vector3 Low{ 1e30, 1e30, 1e30 };
  Vector3 High{ -1e30, -1e30, -1e30 };
};

/// A plane of the patient: what is right, up and towards the viewer in the picture.
struct Plane
{
  const char* Name;
  /// Where the normal points.
  const char* Direction;
  /// Patient directions at the left, right, upper and lower side.
  const char* Letters[4];
  /// Indices of patient directions, and which way they go in the picture.
  int Right;
  double RightSign;
  int Up;
  double UpSign;
  int Normal;
};

// Radiologists look at them so: from below and from the front (patient's left on the right), and
// from the patient's left.
constexpr Plane Planes[] = { { "axial", "head", { "R", "L", "A", "P" }, 0, 1, 1, 1, 2 },
  { "coronal", "front", { "R", "L", "H", "F" }, 0, 1, 2, 1, 1 },
  { "sagittal", "left", { "A", "P", "H", "F" }, 1, -1, 2, 1, 0 } };

/// A tissue's colour, dark enough for marks and letters to stand out on it.
PictureColor Subdued(int label)
{
  return Mixed(GroupColor(static_cast<std::size_t>(label) - 1), { 30, 30, 34 }, 0.45);
}

class Slices
{
public:
  /// `image`: null where there is none.
  Slices(const IntensityVolume* image, const LabelVolume& labels, const AnatomicalAxes& axes)
    : Image(image)
    , Labels(labels)
    , Directions{ axes.Left, axes.Anterior, axes.Superior }
  {
    std::vector<double> values;
    for (std::size_t voxel = 0; voxel < labels.Voxels.size(); ++voxel)
    {
      if (labels.Voxels[voxel] != 0)
      {
        const auto columns = static_cast<std::size_t>(labels.Size[0]);
        const auto rows = static_cast<std::size_t>(labels.Size[1]);
        const std::size_t row = voxel / columns % rows;
        const std::size_t slice = voxel / columns / rows;
        const Vector3 point = labels.PointAt(static_cast<double>(voxel % columns),
          static_cast<double>(row), static_cast<double>(slice));
        for (int d = 0; d < 3; ++d)
        {
          const double at = Dot(point, this->Directions[d]);
          this->Box.Low[d] = std::min(this->Box.Low[d], at - BorderMm);
          this->Box.High[d] = std::max(this->Box.High[d], at + BorderMm);
        }
        values.push_back(this->ValueAt(point));
      }
    }
    if (values.empty())
    {
      throw InputError("slice picture: expected labels, found only air");
    }
    const auto bright = values.begin() + static_cast<std::ptrdiff_t>(0.995 * (values.size() - 1));
    std::nth_element(values.begin(), bright, values.end());
    this->White = std::max(*bright, 1e-30);
    double longest = 0;
    for (int d = 0; d < 3; ++d)
    {
      longest = std::max(longest, this->Box.High[d] - this->Box.Low[d]);
    }
    this->PixelMm = longest / PanelPixels;
  }

  int Pixels(int direction) const
  {
    return static_cast<int>(
      std::ceil((this->Box.High[direction] - this->Box.Low[direction]) / this->PixelMm));
  }
  /// Where a slice lies, mm in the direction of the plane's normal.
  double Place(const Plane& plane, int slice) const
  {
    const double share = (slice + 1.0) / (SlicesPerPlane + 1.0);
    return this->Box.Low[plane.Normal] +
      share * (this->Box.High[plane.Normal] - this->Box.Low[plane.Normal]);
  }

  /// The volume's place of a pixel's corner, counted from the slice's lower left one.
  Vector3 PointAt(const Plane& plane, double place, double x, double y) const
  {
    const auto along = [&](int direction, double sign, double pixels)
    {
      return sign > 0 ? this->Box.Low[direction] + pixels * this->PixelMm
                      : this->Box.High[direction] - pixels * this->PixelMm;
    };
    return along(plane.Right, plane.RightSign, x) * this->Directions[plane.Right] +
      along(plane.Up, plane.UpSign, y) * this->Directions[plane.Up] +
      place * this->Directions[plane.Normal];
  }
  /// The inverse in the plane.
  PicturePoint PixelOf(const Plane& plane, const Vector3& point) const
  {
    const auto along = [&](int direction, double sign)
    {
      const double at = Dot(point, this->Directions[direction]);
      return (sign > 0 ? at - this->Box.Low[direction] : this->Box.High[direction] - at) /
        this->PixelMm;
    };
    return { along(plane.Right, plane.RightSign), along(plane.Up, plane.UpSign) };
  }
  /// mm in the direction of the plane's normal.
  double PlaceOf(const Plane& plane, const Vector3& point) const
  {
    return Dot(point, this->Directions[plane.Normal]);
  }
  double PixelSizeMm() const { return this->PixelMm; }

  /// The image in grey, or the tissues in colour.
  void DrawPlain(Picture& picture, int left, int low, const Plane& plane, double place) const
  {
    for (int y = 0; y < this->Pixels(plane.Up); ++y)
    {
      for (int x = 0; x < this->Pixels(plane.Right); ++x)
      {
        const Vector3 point = this->PointAt(plane, place, x + 0.5, y + 0.5);
        const int label = this->Image ? 0 : this->Labels.LabelAt(point);
        picture.Set(left + x, low + y,
          label != 0 ? Subdued(label) : Grey(this->ValueAt(point) / this->White));
      }
    }
  }

  void Draw(Picture& picture, int left, int low, const Plane& plane, double place) const
  {
    const int width = this->Pixels(plane.Right);
    const int height = this->Pixels(plane.Up);
    std::vector<int> labels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto labelAt = [&](int x, int y) -> int&
    { return labels[static_cast<std::size_t>(y) * width + x]; };
    for (int y = 0; y < height; ++y)
    {
      for (int x = 0; x < width; ++x)
      {
        const Vector3 point = this->PointAt(plane, place, x + 0.5, y + 0.5);
        labelAt(x, y) = this->Labels.LabelAt(point);
        picture.Set(left + x, low + y, Grey(this->ValueAt(point) / this->White));
      }
    }
    // An outline lies inside its label, so that neighbours both show.
    for (int y = 0; y < height; ++y)
    {
      for (int x = 0; x < width; ++x)
      {
        const int label = labelAt(x, y);
        const bool edge = label != 0 &&
          ((x > 0 && labelAt(x - 1, y) != label) || (x + 1 < width && labelAt(x + 1, y) != label) ||
            (y > 0 && labelAt(x, y - 1) != label) ||
            (y + 1 < height && labelAt(x, y + 1) != label));
        if (edge)
        {
          picture.Set(left + x, low + y, GroupColor(static_cast<std::size_t>(label) - 1));
        }
      }
    }
  }

private:
  /// 0 outside, and without an image.
  double ValueAt(const Vector3& point) const
  {
    return this->Image ? this->Image->ValueAt(point).value_or(0.0F) : 0;
  }

  const IntensityVolume* Image;
  const LabelVolume& Labels;
  Vector3 Directions[3];
  PatientBox Box;
  double White = 1;
  double PixelMm = 1;
};

Picture SlicePicture(const IntensityVolume& image, const LabelVolume& labels,
  const AnatomicalAxes& axes, const std::vector<std::string>& names)
{
  image.ValidateGrid("slice picture", labels.Voxels.size());
  const Slices slices(&image, labels, axes);
  int width = SliceLegendWidth + SliceMargin;
  int height = SliceMargin;
  int rowWidth = 0;
  for (const Plane& plane : Planes)
  {
    rowWidth = std::max(rowWidth, SlicesPerPlane * (slices.Pixels(plane.Right) + SliceMargin));
    height += slices.Pixels(plane.Up) + PlaneTitleHeight;
  }
  width += rowWidth;
  Picture picture(width, height);
  int top = height - SliceMargin;
  for (const Plane& plane : Planes)
  {
    top -= slices.Pixels(plane.Up);
    for (int slice = 0; slice < SlicesPerPlane; ++slice)
    {
      const int left = SliceMargin + slice * (slices.Pixels(plane.Right) + SliceMargin);
      const double place = slices.Place(plane, slice);
      slices.Draw(picture, left, top, plane, place);
      char title[80];
      std::snprintf(title, sizeof(title), "%s, %s %.0f mm", plane.Name, plane.Direction, place);
      picture.Text(left + 0.5 * slices.Pixels(plane.Right), top - 0.5 * PlaneTitleHeight, 0.5,
        title);
    }
    top -= PlaneTitleHeight;
  }
  std::size_t row = 0;
  for (const auto& [label, count] : labels.CountLabels())
  {
    if (label == 0)
    {
      continue;
    }
    const auto index = static_cast<std::size_t>(label);
    picture.LegendEntry(width - SliceLegendWidth, height - SliceMargin, row++, index - 1,
      index < names.size() ? names[index] : "label " + std::to_string(label));
  }
  return picture;
}

/// Letters at the sides of a slice, and what it is.
void AnnotateSlice(Picture& picture, const Slices& slices, const Plane& plane, int left, int low,
  double place)
{
  constexpr double Inset = 14;
  const PictureText style{ SliceInk, 13, &SliceRim };
  const double width = slices.Pixels(plane.Right);
  const double height = slices.Pixels(plane.Up);
  picture.Text(left + Inset, low + 0.5 * height, 0.5, plane.Letters[0], style);
  picture.Text(left + width - Inset, low + 0.5 * height, 0.5, plane.Letters[1], style);
  picture.Text(left + 0.5 * width, low + height - Inset, 0.5, plane.Letters[2], style);
  picture.Text(left + 0.5 * width, low + Inset, 0.5, plane.Letters[3], style);
  char title[80];
  std::snprintf(title, sizeof title, "%s, %s %.0f mm", plane.Name, plane.Direction, place);
  picture.Text(left + 0.5 * width, low - 0.5 * PlaneTitleHeight, 0.5, title);
}

/// Outlines of a lesion in a slice whose lower left corner is at `left`, `low`.
void OutlineLesion(const PointSlices& shown, const Slices& slices, const Plane& plane, int left,
  int low, SvgLines& lines)
{
  const int width = slices.Pixels(plane.Right);
  const int height = slices.Pixels(plane.Up);
  const double place = slices.PlaceOf(plane, shown.Point);
  std::vector<float> inside;
  for (int y = 0; y < height; ++y)
  {
    for (int x = 0; x < width; ++x)
    {
      const Vector3 point = slices.PointAt(plane, place, x + 0.5, y + 0.5);
      inside.push_back(shown.Lesions->LabelAt(point) == shown.LesionLabel ? 1.0F : 0.0F);
    }
  }
  for (const auto& loop : ContourLines(inside.data(), width, height, 0.5F, 0.0F))
  {
    std::vector<PicturePoint> points;
    points.reserve(loop.size());
    for (const auto& [x, y] : loop)
    {
      points.push_back({ left + x + 0.5, low + y + 0.5 });
    }
    lines.Path(points, true, MarkColor);
  }
}
}

LayeredPicture DrawPointSlices(const PointSlices& shown)
{
  const Slices slices(shown.Image, *shown.Labels, shown.Axes);
  int width = SliceMargin;
  int height = 0;
  for (const Plane& plane : Planes)
  {
    width += slices.Pixels(plane.Right) + SliceMargin;
    height = std::max(height, slices.Pixels(plane.Up));
  }
  const auto present = shown.Image ? std::map<int, std::size_t>{} : shown.Labels->CountLabels();
  width += shown.Image ? 0 : SliceLegendWidth;
  height += PlaneTitleHeight + SliceMargin;
  Picture picture(width, height);
  SvgLines lines(height);
  int left = SliceMargin;
  for (const Plane& plane : Planes)
  {
    const int low = height - SliceMargin - slices.Pixels(plane.Up);
    const double place = slices.PlaceOf(plane, shown.Point);
    slices.DrawPlain(picture, left, low, plane, place);
    AnnotateSlice(picture, slices, plane, left, low, place);
    if (shown.Lesions)
    {
      OutlineLesion(shown, slices, plane, left, low, lines);
    }
    const PicturePoint at = slices.PixelOf(plane, shown.Point);
    lines.Cross({ left + at.X, low + at.Y }, "", 16, MarkColor);
    left += slices.Pixels(plane.Right) + SliceMargin;
  }
  double top = height - SliceMargin - 12;
  for (const auto& [label, count] : present)
  {
    const auto index = static_cast<std::size_t>(label);
    if (label != 0)
    {
      const double x = width - SliceLegendWidth;
      picture.Box(x, top - 7, x + 14, top + 7, Subdued(label));
      picture.Text(x + 22, top, 0,
        index < shown.Names.size() ? shown.Names[index] : "label " + std::to_string(label));
      top -= 24;
    }
  }
  // 20 mm, in the first slice's lower right corner.
  const double length = 20 / slices.PixelSizeMm();
  const double right = SliceMargin + slices.Pixels(Planes[0].Right) - 8;
  const double bottom = height - SliceMargin - slices.Pixels(Planes[0].Up) + 8;
  picture.Box(right - length, bottom, right, bottom + 3, SliceInk);
  picture.Text(right - 0.5 * length, bottom + 14, 0.5, "20 mm", { SliceInk, 11, &SliceRim });
  return { picture.Png(), width, height, lines.Elements() };
}

void WriteSlicePicture(const IntensityVolume& image, const LabelVolume& labels,
  const AnatomicalAxes& axes, const std::vector<std::string>& names, const std::string& path)
{
  SlicePicture(image, labels, axes, names).Write(path);
}

std::string SlicePicturePng(const IntensityVolume& image, const LabelVolume& labels,
  const AnatomicalAxes& axes, const std::vector<std::string>& names)
{
  return SlicePicture(image, labels, axes, names).Png();
}
}
