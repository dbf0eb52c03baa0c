// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Report/SlicePicture.h"

#include "Private/Picture.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr int SlicesPerPlane = 3;
constexpr int PanelPixels = 360; // the longer side
constexpr int SliceMargin = 12;
constexpr int TitleHeight = 28;
constexpr int SliceLegendWidth = 170;
constexpr double BorderMm = 5.0;

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
  /// Indices of patient directions, and which way they go in the picture.
  int Right;
  double RightSign;
  int Up;
  double UpSign;
  int Normal;
};

// Radiologists look at them so: from below and from the front (patient's left on the right), and
// from the patient's left.
constexpr Plane Planes[] = { { "axial", "head", 0, 1, 1, 1, 2 },
  { "coronal", "front", 0, 1, 2, 1, 1 }, { "sagittal", "left", 1, -1, 2, 1, 0 } };

class Slices
{
public:
  Slices(const IntensityVolume& image, const LabelVolume& labels, const AnatomicalAxes& axes)
    : Image(image)
    , Labels(labels)
    , Directions{ axes.Left, axes.Anterior, axes.Superior }
  {
    std::vector<float> values;
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
        values.push_back(image.Voxels[voxel]);
      }
    }
    if (values.empty())
    {
      throw InputError("slice picture: expected labels, found only air");
    }
    const auto bright = values.begin() + static_cast<std::ptrdiff_t>(0.995 * (values.size() - 1));
    std::nth_element(values.begin(), bright, values.end());
    this->White = std::max<double>(*bright, 1e-30);
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

  void Draw(Picture& picture, int left, int low, const Plane& plane, double place) const
  {
    const int width = this->Pixels(plane.Right);
    const int height = this->Pixels(plane.Up);
    const auto pointAt = [&](double x, double y)
    {
      const auto along = [&](int direction, double sign, double pixels)
      {
        return sign > 0 ? this->Box.Low[direction] + pixels * this->PixelMm
                        : this->Box.High[direction] - pixels * this->PixelMm;
      };
      return along(plane.Right, plane.RightSign, x) * this->Directions[plane.Right] +
        along(plane.Up, plane.UpSign, y) * this->Directions[plane.Up] +
        place * this->Directions[plane.Normal];
    };
    std::vector<int> labels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto labelAt = [&](int x, int y) -> int&
    { return labels[static_cast<std::size_t>(y) * width + x]; };
    for (int y = 0; y < height; ++y)
    {
      for (int x = 0; x < width; ++x)
      {
        const Vector3 point = pointAt(x + 0.5, y + 0.5);
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
  /// The value of the voxel that holds the point; 0 outside.
  double ValueAt(const Vector3& point) const
  {
    const Vector3 index = this->Image.ContinuousIndex(point);
    int voxel[3];
    for (int a = 0; a < 3; ++a)
    {
      voxel[a] = static_cast<int>(std::floor(index[a] + 0.5));
      if (voxel[a] < 0 || voxel[a] >= this->Image.Size[a])
      {
        return 0;
      }
    }
    return this->Image.Voxels[this->Image.Index(voxel[0], voxel[1], voxel[2])];
  }

  const IntensityVolume& Image;
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
  const Slices slices(image, labels, axes);
  int width = SliceLegendWidth + SliceMargin;
  int height = SliceMargin;
  int rowWidth = 0;
  for (const Plane& plane : Planes)
  {
    rowWidth = std::max(rowWidth, SlicesPerPlane * (slices.Pixels(plane.Right) + SliceMargin));
    height += slices.Pixels(plane.Up) + TitleHeight;
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
      picture.Text(left + 0.5 * slices.Pixels(plane.Right), top - 0.5 * TitleHeight, 0.5, title);
    }
    top -= TitleHeight;
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
