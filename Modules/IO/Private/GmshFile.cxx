// SPDX-License-Identifier: Apache-2.0
// The formats: gmsh's reference manual, chapter "Gmsh file formats" (MSH 2 and MSH 4.1).
#include "Private/GmshFile.h"

#include "Private/FileWords.h"
#include "mammoray/IO/MeshConversion.h"

#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
/// What gmsh calls a type of element.
struct GmshType
{
  int Number;
  int Cell;
  int Dimension;
  int Nodes;
};

constexpr std::array GmshTypes{ GmshType{ 1, VTK_LINE, 1, 2 }, GmshType{ 2, VTK_TRIANGLE, 2, 3 },
  GmshType{ 3, VTK_QUAD, 2, 4 }, GmshType{ 4, VTK_TETRA, 3, 4 },
  GmshType{ 5, VTK_HEXAHEDRON, 3, 8 }, GmshType{ 6, VTK_WEDGE, 3, 6 },
  GmshType{ 7, VTK_PYRAMID, 3, 5 }, GmshType{ 8, VTK_QUADRATIC_EDGE, 1, 3 },
  GmshType{ 9, VTK_QUADRATIC_TRIANGLE, 2, 6 }, GmshType{ 10, VTK_BIQUADRATIC_QUAD, 2, 9 },
  GmshType{ 11, VTK_QUADRATIC_TETRA, 3, 10 }, GmshType{ 12, VTK_TRIQUADRATIC_HEXAHEDRON, 3, 27 },
  GmshType{ 13, VTK_BIQUADRATIC_QUADRATIC_WEDGE, 3, 18 }, GmshType{ 15, VTK_VERTEX, 0, 1 },
  GmshType{ 16, VTK_QUADRATIC_QUAD, 2, 8 }, GmshType{ 17, VTK_QUADRATIC_HEXAHEDRON, 3, 20 },
  GmshType{ 18, VTK_QUADRATIC_WEDGE, 3, 15 }, GmshType{ 19, VTK_QUADRATIC_PYRAMID, 3, 13 } };

class GmshFile
{
public:
  explicit GmshFile(const std::string& path)
    : Path(path)
    , Words(path)
  {
    this->Points->SetDataTypeToDouble();
    this->Grid->Allocate(1000);
  }

  vtkSmartPointer<vtkUnstructuredGrid> Read()
  {
    std::string first(this->Words.Next());
    for (; first == "$Comments"; first = this->Words.Next())
    {
      this->SkipTo("$EndComments");
    }
    if (first != "$MeshFormat")
    {
      throw InputError(this->Path + ": expected version 2.2 or 4.1 of a mesh of gmsh, found " +
        (first == "$NOD" ? "version 1" : "no $MeshFormat"));
    }
    this->ReadFormat();
    for (std::string section(this->Words.Next()); !section.empty(); section = this->Words.Next())
    {
      if (!section.starts_with('$'))
      {
        this->Words.Refuse("the next section, $...", section);
      }
      this->Words.Line();
      this->ReadSection(section);
      this->SkipTo("$End" + section.substr(1));
    }
    return this->Finish();
  }

private:
  bool IsOld() const { return this->Version < 4; }

  void ReadFormat()
  {
    this->Version = this->Words.Number<double>("the version of a mesh of gmsh");
    const int isBinary = this->Words.Number<int>("0 or 1 for text or binary");
    if (!(this->Version >= 2 && this->Version < 3) && this->Version != 4.1)
    {
      throw InputError(this->Path + ": expected version 2.2 or 4.1 of a mesh of gmsh, found " +
        NumberText(this->Version));
    }
    this->Words.Line();
    this->IsBinary = isBinary != 0;
    if (this->IsBinary)
    {
      this->IsSwapped = this->Words.Binary<std::int32_t>("the byte order") != 1;
    }
    this->SkipTo("$EndMeshFormat");
  }

  void SkipTo(const std::string& mark)
  {
    const std::size_t at = this->Words.Left().find(mark);
    if (at == std::string_view::npos)
    {
      this->Words.Refuse(mark, "");
    }
    this->Words.Skip(at + mark.size());
  }

  void ReadSection(const std::string& section)
  {
    if (section == "$PhysicalNames")
    {
      const auto count = this->Words.Number<std::uint64_t>("a number of physical groups");
      for (std::uint64_t number = 0; number < count; ++number)
      {
        const int dimension = this->Words.Number<int>("a group's dimension");
        const int tag = this->Words.Number<int>("a group's tag");
        std::string name(this->Words.Line());
        name.erase(std::remove(name.begin(), name.end(), '"'), name.end());
        if (dimension == 3)
        {
          this->GroupNames[tag] = EscapeControls(name);
        }
      }
    }
    else if (section == "$Entities")
    {
      this->ReadEntities();
    }
    else if (section == "$Nodes")
    {
      this->IsOld() ? this->ReadOldNodes() : this->ReadNodes();
    }
    else if (section == "$Elements")
    {
      this->IsOld() ? this->ReadOldElements() : this->ReadElements();
    }
  }

  template <typename Value>
  Value Take(const char* what)
  {
    return this->IsBinary ? this->Words.Binary<Value>(what, this->IsSwapped)
                          : this->Words.Number<Value>(what);
  }
  int Int(const char* what) { return this->Take<std::int32_t>(what); }
  std::uint64_t Size(const char* what) { return this->Take<std::uint64_t>(what); }
  double Real(const char* what) { return this->Take<double>(what); }

  void ReadEntities()
  {
    std::array<std::uint64_t, 4> counts{};
    for (std::uint64_t& count : counts)
    {
      count = this->Size("a number of entities");
    }
    for (int dimension = 0; dimension <= 3; ++dimension)
    {
      for (std::uint64_t number = 0; number < counts[static_cast<std::size_t>(dimension)]; ++number)
      {
        const int tag = this->Int("an entity's tag");
        for (int bound = 0; bound < (dimension == 0 ? 3 : 6); ++bound)
        {
          this->Real("an entity's bounds");
        }
        const std::uint64_t groups = this->Size("a number of groups");
        for (std::uint64_t group = 0; group < groups; ++group)
        {
          const int found = this->Int("a group's tag");
          if (dimension == 3 && group == 1)
          {
            throw InputError(this->Path + ": volume " + std::to_string(tag) +
              ": expected one physical group, found " + std::to_string(groups));
          }
          if (dimension == 3)
          {
            this->GroupOfVolume[tag] = std::abs(found);
          }
        }
        const std::uint64_t sides = dimension == 0 ? 0 : this->Size("a number of sides");
        for (std::uint64_t side = 0; side < sides; ++side)
        {
          this->Int("a side's tag");
        }
      }
    }
  }

  void AddNode(std::uint64_t tag, double x, double y, double z)
  {
    this->PointOfNode[tag] = this->Points->InsertNextPoint(x, y, z);
  }

  void ReadOldNodes()
  {
    const auto count = this->Words.Number<std::uint64_t>("a number of nodes");
    this->Words.Line();
    for (std::uint64_t number = 0; number < count; ++number)
    {
      const auto tag = static_cast<std::uint64_t>(this->Int("a node's number"));
      const double x = this->Real("a node's coordinate");
      const double y = this->Real("a node's coordinate");
      const double z = this->Real("a node's coordinate");
      this->AddNode(tag, x, y, z);
    }
  }

  void ReadNodes()
  {
    const std::uint64_t blocks = this->Size("a number of blocks");
    for (int rest = 0; rest < 3; ++rest)
    {
      this->Size("a number of nodes");
    }
    for (std::uint64_t block = 0; block < blocks; ++block)
    {
      const int dimension = this->Int("an entity's dimension");
      this->Int("an entity's tag");
      const bool isParametric = this->Int("0 or 1 for parameters") != 0;
      const std::uint64_t count = this->Size("a number of nodes");
      std::vector<std::uint64_t> tags;
      for (std::uint64_t number = 0; number < count; ++number)
      {
        tags.push_back(this->Size("a node's tag"));
      }
      for (const std::uint64_t tag : tags)
      {
        const double x = this->Real("a node's coordinate");
        const double y = this->Real("a node's coordinate");
        const double z = this->Real("a node's coordinate");
        this->AddNode(tag, x, y, z);
        for (int parameter = 0; isParametric && parameter < dimension; ++parameter)
        {
          this->Real("a node's parameter");
        }
      }
    }
  }

  const GmshType& TypeOf(int number) const
  {
    for (const GmshType& type : GmshTypes)
    {
      if (type.Number == number)
      {
        return type;
      }
    }
    throw InputError(this->Path +
      ": expected elements of first or second order, found gmsh's element type " +
      std::to_string(number));
  }

  void AddElement(const GmshType& type, int group, const std::vector<std::uint64_t>& nodes)
  {
    std::vector<vtkIdType> corners;
    for (const std::uint64_t node : nodes)
    {
      const auto found = this->PointOfNode.find(node);
      if (found == this->PointOfNode.end())
      {
        throw InputError(this->Path + ": element " + std::to_string(this->Groups.size()) +
          ": expected nodes that are there, found node " + std::to_string(node));
      }
      corners.push_back(found->second);
    }
    this->Grid->InsertNextCell(type.Cell, static_cast<vtkIdType>(corners.size()), corners.data());
    this->Groups.push_back(type.Dimension == 3 ? group : -1);
  }

  void ReadOldElements()
  {
    const auto count = this->Words.Number<std::uint64_t>("a number of elements");
    this->Words.Line();
    std::vector<std::uint64_t> nodes;
    for (std::uint64_t number = 0; number < count;)
    {
      // In binary a head serves several elements.
      if (!this->IsBinary)
      {
        this->Int("an element's number");
      }
      const GmshType& type = this->TypeOf(this->Int("an element's type"));
      const int follow = this->IsBinary ? this->Int("a number of elements") : 1;
      const int tags = this->Int("a number of tags");
      if (follow < 1 || tags < 0)
      {
        throw InputError(this->Path + ": expected elements and their tags, found " +
          std::to_string(follow) + " and " + std::to_string(tags));
      }
      for (int element = 0; element < follow; ++element, ++number)
      {
        if (this->IsBinary)
        {
          this->Int("an element's number");
        }
        int group = 0;
        for (int tag = 0; tag < tags; ++tag)
        {
          const int found = this->Int("an element's tag");
          group = tag == 0 ? found : group;
        }
        nodes.clear();
        for (int node = 0; node < type.Nodes; ++node)
        {
          nodes.push_back(static_cast<std::uint64_t>(this->Int("an element's node")));
        }
        this->AddElement(type, group, nodes);
      }
    }
  }

  void ReadElements()
  {
    const std::uint64_t blocks = this->Size("a number of blocks");
    for (int rest = 0; rest < 3; ++rest)
    {
      this->Size("a number of elements");
    }
    std::vector<std::uint64_t> nodes;
    for (std::uint64_t block = 0; block < blocks; ++block)
    {
      const int dimension = this->Int("an entity's dimension");
      const int entity = this->Int("an entity's tag");
      const GmshType& type = this->TypeOf(this->Int("an element's type"));
      const auto group = this->GroupOfVolume.find(dimension == 3 ? entity : -1);
      const std::uint64_t count = this->Size("a number of elements");
      for (std::uint64_t element = 0; element < count; ++element)
      {
        this->Size("an element's tag");
        nodes.clear();
        for (int node = 0; node < type.Nodes; ++node)
        {
          nodes.push_back(this->Size("an element's node"));
        }
        this->AddElement(type, group == this->GroupOfVolume.end() ? 0 : group->second, nodes);
      }
    }
  }

  /// Materials by the tags of their groups; none without groups.
  std::map<int, int> MaterialOfGroup() const
  {
    std::map<int, int> materials;
    std::size_t alone = 0;
    for (const int group : this->Groups)
    {
      alone += group == 0 ? 1 : 0;
      if (group > 0)
      {
        materials[group] = 0;
      }
    }
    if (alone > 0 && !materials.empty())
    {
      throw InputError(this->Path + ": expected every volume in a physical group, found " +
        std::to_string(alone) + " elements in none");
    }
    const bool areNamed = this->NamesAny(materials);
    int next = 1;
    for (auto& [group, material] : materials)
    {
      const auto name = this->GroupNames.find(group);
      const bool isAir = name != this->GroupNames.end() && LowerCase(name->second) == "air";
      material = isAir ? -1 : areNamed ? next++ : group;
    }
    return materials;
  }

  /// Whether any of the groups has a name. Else their numbers are materials.
  bool NamesAny(const std::map<int, int>& materialOf) const
  {
    return std::any_of(materialOf.begin(), materialOf.end(),
      [this](const auto& one) { return this->GroupNames.count(one.first) > 0; });
  }

  vtkSmartPointer<vtkUnstructuredGrid> Finish()
  {
    const std::map<int, int> materialOf = this->MaterialOfGroup();
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    grid->SetPoints(this->Points);
    grid->Allocate(static_cast<vtkIdType>(this->Groups.size()));
    vtkNew<vtkIdList> corners;
    vtkNew<vtkIntArray> materials;
    materials->SetName(MaterialArrayName);
    for (std::size_t cell = 0; cell < this->Groups.size(); ++cell)
    {
      const int group = this->Groups[cell];
      const int material = group > 0 ? materialOf.at(group) : group == 0 ? 1 : 0;
      if (material >= 0)
      {
        const auto id = static_cast<vtkIdType>(cell);
        this->Grid->GetCellPoints(id, corners);
        grid->InsertNextCell(this->Grid->GetCellType(id), corners);
        materials->InsertNextValue(material);
      }
    }
    grid->GetCellData()->AddArray(materials);
    if (!materialOf.empty() && !this->NamesAny(materialOf))
    {
      Note({ this->Path, "its physical groups have no names: their numbers are materials" });
    }
    else if (!materialOf.empty())
    {
      vtkNew<vtkStringArray> names;
      names->SetName(MaterialNamesArrayName);
      names->InsertNextValue("air");
      for (const auto& [group, material] : materialOf)
      {
        const auto name = this->GroupNames.find(group);
        if (material > 0)
        {
          names->InsertNextValue(
            name == this->GroupNames.end() ? "group " + std::to_string(group) : name->second);
        }
      }
      grid->GetFieldData()->AddArray(names);
    }
    return grid;
  }

  const std::string Path;
  FileWords Words;
  double Version = 0;
  bool IsBinary = false;
  bool IsSwapped = false;
  std::map<int, std::string> GroupNames;
  std::map<int, int> GroupOfVolume;
  std::unordered_map<std::uint64_t, vtkIdType> PointOfNode;
  vtkNew<vtkPoints> Points;
  vtkNew<vtkUnstructuredGrid> Grid;
  /// By cell: the physical group of volumes, 0 of those in none, -1 of others.
  std::vector<int> Groups;
};
}

vtkSmartPointer<vtkUnstructuredGrid> ReadGmsh(const std::string& path)
{
  return GmshFile(path).Read();
}
}
