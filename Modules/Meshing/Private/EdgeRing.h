// The cells around an edge, and other ways to fill the same space.
#ifndef mammoray_EdgeRing_h
#define mammoray_EdgeRing_h

#include "Private/EditableMesh.h"
#include "mammorayMeshingModule.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace mammoray
{
using CellIds = std::array<std::int32_t, 4>;

/// Points around an edge in order, with the material between each point and the next.
struct EdgeRing
{
  std::vector<std::int32_t> Points;
  std::vector<std::int32_t> Materials;
  std::vector<std::int32_t> Cells;
};

/// The ring around the edge from a to b, counter-clockwise about that axis; no value if it is open
/// or has more than `most` cells.
MAMMORAYMESHING_EXPORT std::optional<EdgeRing> FindRing(const EditableMesh& mesh, std::int32_t a,
  std::int32_t b, std::size_t most);

/// The best filling of the space between two points and a polygon around them: Klincsek's
/// triangulation of the polygon, judged by the worst cell.
class MAMMORAYMESHING_EXPORT PolygonFill
{
public:
  /// `polygon` runs counter-clockwise about the axis from `below` to `above`; it must outlive this
  /// object.
  PolygonFill(const EditableMesh& mesh, const std::vector<std::int32_t>& polygon,
    std::int32_t material, std::int32_t below, std::int32_t above);

  /// Quality of the worst cell of the best filling.
  double Best() const { return this->Qualities[this->Count - 1]; }
  /// Adds the cells of the best filling.
  void Collect(std::vector<CellIds>& cells) const { this->Collect(0, this->Count - 1, cells); }

private:
  void FindMiddle(std::size_t i, std::size_t j);
  CellIds Upper(std::size_t i, std::size_t k, std::size_t j) const;
  CellIds Lower(std::size_t i, std::size_t k, std::size_t j) const;
  void Collect(std::size_t i, std::size_t j, std::vector<CellIds>& cells) const;

  const EditableMesh& Mesh;
  const std::vector<std::int32_t>& Polygon;
  std::int32_t Material;
  std::int32_t Below;
  std::int32_t Above;
  std::size_t Count;
  /// Quality of the worst cell of the best filling between corners i and j, at i * Count + j, and
  /// the corner k that it uses.
  std::vector<double> Qualities;
  std::vector<std::size_t> Middle;
};
}

#endif
