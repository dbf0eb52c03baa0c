// SPDX-License-Identifier: Apache-2.0
#include "Private/Picture.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkGenericCell.h"
#include "vtkNew.h"
#include "vtkStaticCellLocator.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cstdio>
#include <set>

namespace mammoray
{
namespace
{
constexpr int LongestSidePixels = 460;
constexpr int CutMargin = 20;
constexpr double LineMarginMm = 4;
constexpr int TitleHeight = 46;
constexpr int CutLegendWidth = 190;

/// A panel's mesh, sampled at the middles of the picture's pixels.
class Cut
{
public:
  explicit Cut(const CutPanel& panel)
    : Panel(panel)
    , Mesh(FromGrid(panel.Mesh))
    , Extents(ExtentsAlong(std::array{ panel.Right, panel.Up }, this->Mesh.Points))
  {
    for (Extent& extent : this->Extents)
    {
      // Lines that the cells touch would otherwise be halved.
      extent.Low -= panel.Lines.empty() ? 0 : LineMarginMm;
      extent.High += panel.Lines.empty() ? 0 : LineMarginMm;
    }
  }

  double LongestMm() const
  {
    return std::max(this->Extents[0].Length(), this->Extents[1].Length());
  }
  int Width() const { return this->Columns; }
  int Height() const { return this->Rows; }

  /// Finds the cell of each pixel and adds the cells' materials. Throws InputError if there are
  /// none.
  void Sample(double pixelMm, std::set<int>& materials)
  {
    this->PixelMm = pixelMm;
    this->Columns = 1 + static_cast<int>(this->Extents[0].Length() / pixelMm);
    this->Rows = 1 + static_cast<int>(this->Extents[1].Length() / pixelMm);
    const CutPanel& panel = this->Panel;
    const Vector3 normal = Cross(panel.Right, panel.Up);
    vtkNew<vtkStaticCellLocator> locator;
    locator->SetDataSet(panel.Mesh);
    locator->BuildLocator();
    vtkNew<vtkGenericCell> generic;
    std::set<vtkIdType> different;
    std::size_t inside = 0;
    for (int y = 0; y < this->Rows; ++y)
    {
      for (int x = 0; x < this->Columns; ++x)
      {
        // A little beside the middle and the plane, which are on faces of regular meshes.
        const double right = this->Extents[0].Low + (x + 0.501) * pixelMm;
        const double up = this->Extents[1].Low + (y + 0.501) * pixelMm;
        Vector3 point =
          right * panel.Right + up * panel.Up + (Dot(panel.Point, normal) + 1e-6) * normal;
        double parametric[3];
        double weights[4];
        const vtkIdType cell = locator->FindCell(point.data(), 0, generic, parametric, weights);
        this->Cells.push_back(cell);
        if (cell >= 0)
        {
          ++inside;
          different.insert(cell);
          materials.insert(this->MaterialOf(cell));
        }
      }
    }
    if (inside == 0)
    {
      throw InputError("cut picture: expected a plane that meets the mesh, found none of it in '" +
        panel.Title + "'");
    }
    this->WithEdges = inside > 12 * different.size();
  }

  void Draw(Picture& picture, int left, int low) const
  {
    const auto cellAt = [&](int x, int y) -> vtkIdType
    {
      const bool beside = x >= this->Columns || y >= this->Rows;
      return beside ? -1 : this->Cells[static_cast<std::size_t>(y) * this->Columns + x];
    };
    for (int y = 0; y < this->Rows; ++y)
    {
      for (int x = 0; x < this->Columns; ++x)
      {
        const vtkIdType cell = cellAt(x, y);
        if (cell >= 0)
        {
          const bool edge =
            this->WithEdges && (cell != cellAt(x + 1, y) || cell != cellAt(x, y + 1));
          const PictureColor color = LabelColor(this->MaterialOf(cell));
          picture.Set(left + x, low + y, edge ? Mixed(Black, color, 0.6) : color);
        }
      }
    }
    for (const std::vector<Vector3>& line : this->Panel.Lines)
    {
      PictureLine points;
      for (const Vector3& point : line)
      {
        points.push_back(
          { left + (Dot(point, this->Panel.Right) - this->Extents[0].Low) / this->PixelMm,
            low + (Dot(point, this->Panel.Up) - this->Extents[1].Low) / this->PixelMm });
      }
      picture.Lines(points, 1.5, PictureInk);
    }
  }

private:
  int MaterialOf(vtkIdType cell) const
  {
    return this->Mesh.Materials[static_cast<std::size_t>(cell)];
  }

  const CutPanel& Panel;
  TetrahedralMesh Mesh;
  std::array<Extent, 2> Extents;
  double PixelMm = 1;
  int Columns = 0;
  int Rows = 0;
  /// Whether cells are so wide that edges leave their colour visible.
  bool WithEdges = false;
  /// Row by row from below; -1 outside.
  std::vector<vtkIdType> Cells;
};
}

void WriteCutPicture(const std::vector<CutPanel>& panels,
  const std::vector<std::string>& materialNames, const std::string& path)
{
  std::vector<Cut> cuts(panels.begin(), panels.end());
  double longestMm = 0;
  for (const Cut& cut : cuts)
  {
    longestMm = std::max(longestMm, cut.LongestMm());
  }
  const double pixelMm = longestMm / LongestSidePixels;
  std::set<int> materials;
  int width = CutMargin + CutLegendWidth;
  int height = 0;
  for (Cut& cut : cuts)
  {
    cut.Sample(pixelMm, materials);
    width += cut.Width() + CutMargin;
    height = std::max(height, cut.Height());
  }
  Picture picture(width, height + TitleHeight + 2 * CutMargin);
  int left = CutMargin;
  for (std::size_t index = 0; index < cuts.size(); ++index)
  {
    const Cut& cut = cuts[index];
    cut.Draw(picture, left, TitleHeight + CutMargin + (height - cut.Height()) / 2);
    picture.Text(left + 0.5 * cut.Width(), 0.5 * TitleHeight, 0.5, panels[index].Title);
    left += cut.Width() + CutMargin;
  }
  PictureLegend legend;
  for (const int material : materials)
  {
    const auto index = static_cast<std::size_t>(material);
    legend.emplace_back(index < materialNames.size() ? materialNames[index]
                                                     : "material " + std::to_string(material),
      LabelColor(material));
  }
  picture.Legend(left, picture.Height() - CutMargin, legend);
  const double barMm = TickStep(100 * pixelMm, 1);
  picture.ScaleBar(left + barMm / pixelMm, 0.5 * TitleHeight, barMm, pixelMm);
  WriteAtomicFile(path, picture.Png());
}

std::vector<CutPanel> CutsThrough(vtkUnstructuredGrid* mesh, const Vector3& point)
{
  char text[3][48];
  for (int axis = 0; axis < 3; ++axis)
  {
    std::snprintf(text[axis], sizeof(text[axis]), "%c = %.1f mm", "xyz"[axis], point[axis]);
  }
  const Vector3 x{ 1, 0, 0 };
  const Vector3 y{ 0, 1, 0 };
  const Vector3 z{ 0, 0, 1 };
  return { { mesh, point, x, y, std::string(text[2]) + " (right: x, up: y)", {} },
    { mesh, point, x, z, std::string(text[1]) + " (right: x, up: z)", {} },
    { mesh, point, y, z, std::string(text[0]) + " (right: y, up: z)", {} } };
}
}
