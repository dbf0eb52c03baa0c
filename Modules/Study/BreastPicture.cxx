// SPDX-License-Identifier: Apache-2.0
#include "Private/Picture.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/StudyPictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace mammoray
{
namespace
{
constexpr int SceneWidth = 720;
constexpr int SceneMargin = 24;
/// Pixels of the drawing that become one of the picture, along each side.
constexpr int Oversampling = 2;
constexpr PictureColor SceneGround{ 22, 24, 31 };
constexpr PictureColor SkinTone{ 237, 194, 168 };
constexpr PictureColor PlateTone{ 140, 191, 242 };
constexpr double SkinOpacity = 0.3;
constexpr double PlateOpacity = 0.25;
/// Light that comes from everywhere; the rest comes from the eye's upper left.
constexpr double Ambient = 0.35;

/// What the eye sees: right and up in pixels of the drawing, and how near.
class Eye
{
public:
  explicit Eye(const BreastInSpace& breast)
    : Near(breast.ToEye)
    , Right(Cross(breast.Up, breast.ToEye))
  {
    this->Right = (1 / Norm(this->Right)) * this->Right;
    this->Up = Cross(this->Near, this->Right);
    auto [across, upwards] =
      ExtentsAlong(std::array{ this->Right, this->Up }, breast.Surface->Points);
    for (const auto& plate : breast.Plates)
    {
      for (const Vector3& corner : plate)
      {
        across.Add(Dot(corner, this->Right));
        upwards.Add(Dot(corner, this->Up));
      }
    }
    this->Low = { across.Low, upwards.Low };
    this->Scale = Oversampling * (SceneWidth - 2 * SceneMargin) / std::max(across.Length(), 1e-6);
    this->Height =
      static_cast<int>(std::ceil(this->Scale / Oversampling * upwards.Length())) + 2 * SceneMargin;
  }
  Vector3 See(const Vector3& point) const
  {
    constexpr double Border = Oversampling * SceneMargin;
    return { Border + this->Scale * (Dot(point, this->Right) - this->Low[0]),
      Border + this->Scale * (Dot(point, this->Up) - this->Low[1]),
      this->Scale * Dot(point, this->Near) };
  }
  /// Rows of the picture.
  int Rows() const { return this->Height; }

private:
  Vector3 Near;
  Vector3 Right;
  Vector3 Up{ 0, 0, 0 };
  std::array<double, 2> Low{ 0, 0 };
  double Scale = 1;
  int Height = 0;
};

/// The nearest of what was drawn at each pixel.
struct Layer
{
  explicit Layer(int rows)
    : Rows(Oversampling * rows)
    , Depths(static_cast<std::size_t>(Columns) * static_cast<std::size_t>(this->Rows),
        -std::numeric_limits<double>::infinity())
    , Colors(this->Depths.size())
  {
  }

  /// A triangle as the eye sees it.
  void Draw(const std::array<Vector3, 3>& seen, const PictureColor& tone)
  {
    const Vector3 a = seen[1] - seen[0];
    const Vector3 b = seen[2] - seen[0];
    const double area = a[0] * b[1] - a[1] * b[0];
    if (std::abs(area) < 1e-12)
    {
      return;
    }
    Vector3 normal = Cross(a, b);
    normal = ((normal[2] < 0 ? -1 : 1) / Norm(normal)) * normal;
    const Vector3 light{ -0.45, 0.55, 0.70 };
    const double bright = Ambient + (1 - Ambient) * std::max(Dot(normal, light), 0.0);
    const PictureColor color = Mixed({ 0, 0, 0 }, tone, std::min(bright, 1.0));
    const auto range = [&](int axis, int most)
    {
      const auto [low, high] = std::minmax({ seen[0][axis], seen[1][axis], seen[2][axis] });
      return std::pair{ std::clamp(static_cast<int>(std::ceil(low - 0.5)), 0, most),
        std::clamp(static_cast<int>(std::floor(high - 0.5)) + 1, 0, most) };
    };
    const auto [left, right] = range(0, Columns);
    const auto [bottom, top] = range(1, this->Rows);
    for (int y = bottom; y < top; ++y)
    {
      for (int x = left; x < right; ++x)
      {
        const double dx = x + 0.5 - seen[0][0];
        const double dy = y + 0.5 - seen[0][1];
        const double u = (dx * b[1] - dy * b[0]) / area;
        const double v = (a[0] * dy - a[1] * dx) / area;
        const double depth = seen[0][2] + u * a[2] + v * b[2];
        const std::size_t pixel = static_cast<std::size_t>(y) * Columns + x;
        if (u >= 0 && v >= 0 && u + v <= 1 && depth > this->Depths[pixel])
        {
          this->Depths[pixel] = depth;
          this->Colors[pixel] = color;
        }
      }
    }
  }

  static constexpr int Columns = Oversampling * SceneWidth;
  int Rows;
  std::vector<double> Depths;
  std::vector<PictureColor> Colors;
};

/// Lays a layer to look through over what is farther away.
void Overlay(const Layer& veil, double opacity, Layer& picture)
{
  for (std::size_t pixel = 0; pixel < picture.Depths.size(); ++pixel)
  {
    if (veil.Depths[pixel] > picture.Depths[pixel])
    {
      picture.Colors[pixel] = Mixed(picture.Colors[pixel], veil.Colors[pixel], opacity);
    }
  }
}
}

std::vector<int> EnclosedMaterials(const SurfaceMesh& surface, const MaterialTable& materials,
  int* host)
{
  // Volumes by the divergence theorem, six times over.
  std::vector<double> volumes(static_cast<std::size_t>(surface.NumberOfMaterials()));
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    const double volume = Dot(surface.Corner(triangle, 0),
      Cross(surface.Corner(triangle, 1), surface.Corner(triangle, 2)));
    volumes[surface.BackMaterials[triangle]] += volume;
    volumes[surface.FrontMaterials[triangle]] -= volume;
  }
  int around = 0;
  for (std::size_t material = 1; material < volumes.size(); ++material)
  {
    const Material& known = materials.Materials[material];
    if (!known.Fixed && !known.Thin &&
      (around == 0 || volumes[material] > volumes[static_cast<std::size_t>(around)]))
    {
      around = static_cast<int>(material);
    }
  }
  if (host)
  {
    *host = around;
  }
  std::vector<int> enclosed(surface.NumberOfTriangles(), 0);
  const auto lies = [&](std::uint16_t material)
  { return material != 0 && !materials.Materials[material].Thin; };
  for (std::size_t triangle = 0; triangle < enclosed.size(); ++triangle)
  {
    const std::uint16_t front = surface.FrontMaterials[triangle];
    const std::uint16_t back = surface.BackMaterials[triangle];
    if (lies(front) && lies(back))
    {
      enclosed[triangle] =
        back == around || (front != around && volumes[front] < volumes[back]) ? front : back;
    }
  }
  return enclosed;
}

LayeredPicture DrawBreast(const BreastInSpace& breast)
{
  if (!breast.Surface || breast.Surface->NumberOfTriangles() == 0 || !breast.Materials)
  {
    throw InputError("picture of a breast: expected a surface and its materials, found none");
  }
  const SurfaceMesh& surface = *breast.Surface;
  const std::vector<int> inner = EnclosedMaterials(surface, *breast.Materials);
  const Eye eye(breast);
  Layer picture(eye.Rows());
  std::fill(picture.Colors.begin(), picture.Colors.end(), SceneGround);
  Layer skin(eye.Rows());
  Layer plates(eye.Rows());
  std::map<int, PictureColor> tones;
  const bool any =
    std::any_of(inner.begin(), inner.end(), [](int material) { return material > 0; });
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    const std::array<Vector3, 3> seen{ eye.See(surface.Corner(triangle, 0)),
      eye.See(surface.Corner(triangle, 1)), eye.See(surface.Corner(triangle, 2)) };
    if (inner[triangle] > 0)
    {
      const auto tone =
        tones.try_emplace(inner[triangle], LabelColor(static_cast<int>(tones.size()) + 1));
      picture.Draw(seen, tone.first->second);
    }
    else if (surface.FrontMaterials[triangle] == 0 || surface.BackMaterials[triangle] == 0)
    {
      (any ? skin : picture).Draw(seen, SkinTone);
    }
  }
  for (const auto& plate : breast.Plates)
  {
    const std::array<Vector3, 4> seen{ eye.See(plate[0]), eye.See(plate[1]), eye.See(plate[2]),
      eye.See(plate[3]) };
    plates.Draw({ seen[0], seen[1], seen[2] }, PlateTone);
    plates.Draw({ seen[0], seen[2], seen[3] }, PlateTone);
  }
  Overlay(skin, SkinOpacity, picture);
  Overlay(plates, PlateOpacity, picture);

  Picture drawn(Layer::Columns, picture.Rows);
  for (int y = 0; y < picture.Rows; ++y)
  {
    for (int x = 0; x < Layer::Columns; ++x)
    {
      drawn.Set(x, y, picture.Colors[static_cast<std::size_t>(y) * Layer::Columns + x]);
    }
  }
  drawn.Shrink(Oversampling);
  PictureLegend legend{ { "skin", SkinTone } };
  for (const auto& [material, tone] : tones)
  {
    legend.emplace_back(breast.Materials->Materials[static_cast<std::size_t>(material)].Name, tone);
  }
  drawn.Legend(14, eye.Rows() - 8, legend, { LightInk, 13 });
  SvgLines lines(eye.Rows());
  for (const auto& [name, place] : breast.Marks)
  {
    const Vector3 at = eye.See(place);
    lines.Cross({ at[0] / Oversampling, at[1] / Oversampling }, name);
  }
  return { drawn.Png(), SceneWidth, eye.Rows(), lines.Elements() };
}
}
