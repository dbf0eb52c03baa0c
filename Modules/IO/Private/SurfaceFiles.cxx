// SPDX-License-Identifier: Apache-2.0
// VTK's readers of these formats round coordinates to floats, take what they cannot read for 0, and
// end without a word where a file is cut off; CGAL's do not say where.
#include "Private/SurfaceFiles.h"

#include "Private/FileWords.h"

#include "vtkCellArray.h"
#include "vtkCleanPolyData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mammoray
{
namespace
{
/// Points and polygons as they are read.
class PolygonList
{
public:
  explicit PolygonList(bool isDouble)
  {
    this->Points->SetDataType(isDouble ? VTK_DOUBLE : VTK_FLOAT);
  }

  void AddPoint(double x, double y, double z) { this->Points->InsertNextPoint(x, y, z); }
  vtkIdType NumberOfPoints() const { return this->Points->GetNumberOfPoints(); }

  void AddPolygon(const std::vector<vtkIdType>& corners)
  {
    if (corners.size() == 3)
    {
      this->Polygons->InsertNextCell(3, corners.data());
      return;
    }
    // Quads that stand for triangles name a corner twice.
    std::vector<vtkIdType> distinct(corners);
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    if (distinct.size() > 3 && distinct.front() == distinct.back())
    {
      distinct.pop_back();
    }
    if (distinct.size() >= 3)
    {
      this->Polygons->InsertNextCell(static_cast<vtkIdType>(distinct.size()), distinct.data());
    }
  }

  vtkSmartPointer<vtkPolyData> Finish() const
  {
    auto all = vtkSmartPointer<vtkPolyData>::New();
    all->SetPoints(this->Points);
    all->SetPolys(this->Polygons);
    return all;
  }

  vtkSmartPointer<vtkPolyData> FinishJoined() const
  {
    vtkNew<vtkCleanPolyData> joined;
    joined->SetTolerance(0);
    joined->ConvertPolysToLinesOff();
    joined->ConvertLinesToPointsOff();
    joined->SetInputData(this->Finish());
    joined->Update();
    return joined->GetOutput();
  }

private:
  vtkNew<vtkPoints> Points;
  vtkNew<vtkCellArray> Polygons;
};

/// 3D Slicer names the axes of its models in a comment; it wrote RAS until 4.11.
void NoteAxes(const std::string& path, const FileWords& words)
{
  if (words.Left().substr(0, 1000).find("SPACE=RAS") != std::string_view::npos)
  {
    Note({ path,
      "its header says SPACE=RAS (x to the patient's right, y to the front): its points are taken "
      "as they are, not turned into LPS" });
  }
}

vtkSmartPointer<vtkPolyData> ReadBinaryStl(const std::string& path, FileWords& words)
{
  constexpr std::size_t header = 80;
  constexpr std::size_t bytesOfOne = 50;
  const std::size_t size = words.Left().size();
  const std::string_view start = words.Left().substr(0, header + sizeof(std::uint32_t));
  for (std::size_t skipped = 0; skipped < header / sizeof(std::uint64_t); ++skipped)
  {
    words.Binary<std::uint64_t>("a mesh in STL");
  }
  const auto count = words.Binary<std::uint32_t>("a number of triangles");
  const std::size_t held = words.Left().size() / bytesOfOne;
  // A count below 16 million has a byte that is 0.
  if (held != count && start.find('\0') == std::string_view::npos)
  {
    throw InputError(path + ": expected a mesh in STL, found a text that begins with '" +
      std::string(start.substr(0, std::min<std::size_t>(start.find_first_of("\r\n"), 40))) + "'");
  }
  // Some programs append a few bytes.
  if (held != count)
  {
    throw InputError(path + ": expected a mesh in STL of " + std::to_string(count) +
      " triangles, as its header says, found " + std::to_string(size) + " bytes, which hold " +
      std::to_string(held));
  }
  PolygonList list(false);
  for (vtkIdType first = 0; first < 3 * static_cast<vtkIdType>(count); first += 3)
  {
    float numbers[12]; // the normal, then three corners
    for (float& number : numbers)
    {
      number = words.Binary<float>("a triangle");
    }
    words.Binary<std::uint16_t>("a triangle");
    for (int corner = 3; corner < 12; corner += 3)
    {
      list.AddPoint(numbers[corner], numbers[corner + 1], numbers[corner + 2]);
    }
    list.AddPolygon({ first, first + 1, first + 2 });
  }
  return list.FinishJoined();
}

vtkSmartPointer<vtkPolyData> ReadTextStl(FileWords& words)
{
  PolygonList list(true);
  std::vector<vtkIdType> corners;
  bool isSolid = false;
  for (std::string_view found = words.Next(); !found.empty(); found = words.Next())
  {
    std::string word = LowerCase(found);
    if (word == "end")
    {
      word += LowerCase(words.Next()); // "end loop"
    }
    if (word == "solid" || word == "endsolid")
    {
      words.Line(); // its name, of any words
      isSolid = word == "solid";
    }
    else if (word == "facet")
    {
      corners.clear();
    }
    else if (word == "vertex")
    {
      const char* const expected = "three numbers for a vertex";
      const auto x = words.Number<double>(expected);
      const auto y = words.Number<double>(expected);
      const auto z = words.Number<double>(expected);
      corners.push_back(list.NumberOfPoints());
      list.AddPoint(x, y, z);
    }
    else if (word == "endfacet")
    {
      if (corners.size() < 3)
      {
        words.Refuse("three vertices of a facet", std::to_string(corners.size()));
      }
      list.AddPolygon(corners);
      corners.clear();
    }
    else if (word == "normal")
    {
      words.Next();
      words.Next();
      words.Next();
    }
    else if (word != "outer" && word != "loop" && word != "endloop")
    {
      words.Refuse("a mesh in STL, its next facet or endsolid", found);
    }
  }
  if (isSolid || !corners.empty())
  {
    words.Refuse("endsolid", "");
  }
  return list.FinishJoined();
}

/// The words of a line of OBJ or of a PLY header, without a comment of OBJ.
std::vector<std::string_view> SplitLine(std::string_view line)
{
  std::vector<std::string_view> words;
  line = line.substr(0, line.find('#'));
  constexpr std::string_view blanks = " \t\r\f\v";
  for (std::size_t begin = line.find_first_not_of(blanks); begin != std::string_view::npos;
       begin = line.find_first_not_of(blanks, begin))
  {
    const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

/// A property of PLY: one value, or a list of them.
struct PlyProperty
{
  enum class Type
  {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float,
    Double
  };
  std::string Name;
  Type Of = Type::Float;
  bool IsList = false;
  Type CountOf = Type::UInt8;
};

struct PlyElement
{
  std::string Name;
  std::uint64_t Count = 0;
  std::vector<PlyProperty> Properties;
};

class PlyFile
{
public:
  explicit PlyFile(const std::string& path)
    : Path(path)
    , Words(path)
  {
    NoteAxes(path, this->Words);
    this->ReadHeader();
  }

  vtkSmartPointer<vtkPolyData> Read()
  {
    bool isDouble = this->Format == "ascii";
    for (const PlyElement& element : this->Elements)
    {
      // Faces may come first.
      this->VertexCount +=
        element.Name == "vertex" && !element.Properties.empty() ? element.Count : 0;
      for (const PlyProperty& property : element.Properties)
      {
        isDouble =
          isDouble || (element.Name == "vertex" && property.Of == PlyProperty::Type::Double);
      }
    }
    PolygonList list(isDouble);
    for (const PlyElement& element : this->Elements)
    {
      for (std::uint64_t number = 0; number < element.Count && !element.Properties.empty();
           ++number)
      {
        this->ReadItem(element, number, list);
      }
    }
    if (!this->Words.Left().empty() && (this->Format != "ascii" || !this->Words.Next().empty()))
    {
      throw InputError(this->Path + ": expected " + std::to_string(list.NumberOfPoints()) +
        " vertices and what else its header counts, found more behind them");
    }
    return list.Finish();
  }

private:
  void ReadHeader()
  {
    for (std::string_view line = this->Words.Line(); line != "end_header";
         line = this->Words.Line())
    {
      const std::vector<std::string_view> words = SplitLine(line);
      const std::string_view first = words.empty() ? std::string_view() : words[0];
      const auto word = [&words](std::size_t index)
      { return index < words.size() ? std::string(words[index]) : std::string(); };
      if (first == "format")
      {
        this->Format = word(1);
      }
      else if (first == "element")
      {
        this->Elements.push_back({ word(1) });
        if (!ToNumber(word(2), this->Elements.back().Count))
        {
          this->RefuseHeader(line);
        }
        if (word(1) == "tristrips")
        {
          throw InputError(this->Path + ": expected faces, found triangle strips (tristrips)");
        }
      }
      else if (first == "property" && !this->Elements.empty())
      {
        this->Elements.back().Properties.push_back(word(1) == "list"
            ? PlyProperty{ word(4), this->TypeOf(word(3)), true, this->TypeOf(word(2)) }
            : PlyProperty{ word(2), this->TypeOf(word(1)) });
      }
      else if (first != "ply" && first != "comment" && first != "obj_info" && !words.empty())
      {
        this->RefuseHeader(line);
      }
      if (this->Words.Left().empty())
      {
        this->RefuseHeader("");
      }
    }
    if (this->Format != "ascii" && this->Format != "binary_little_endian" &&
      this->Format != "binary_big_endian")
    {
      throw InputError(this->Path +
        ": expected the format ascii, binary_little_endian or binary_big_endian of a mesh in PLY, "
        "found '" +
        this->Format + "'");
    }
  }

  [[noreturn]] void RefuseHeader(std::string_view line) const
  {
    throw InputError(LineName(this->Path, this->Words.LineNow() - 1) +
      ": expected a mesh in PLY, the next line of its header, found '" +
      std::string(line.substr(0, 60)) + "'");
  }

  PlyProperty::Type TypeOf(const std::string& name) const
  {
    using Type = PlyProperty::Type;
    const std::pair<const char*, Type> types[] = { { "char", Type::Int8 }, { "int8", Type::Int8 },
      { "uchar", Type::UInt8 }, { "uint8", Type::UInt8 }, { "short", Type::Int16 },
      { "int16", Type::Int16 }, { "ushort", Type::UInt16 }, { "uint16", Type::UInt16 },
      { "int", Type::Int32 }, { "int32", Type::Int32 }, { "uint", Type::UInt32 },
      { "uint32", Type::UInt32 }, { "int64", Type::Int64 }, { "uint64", Type::UInt64 },
      { "float", Type::Float }, { "float32", Type::Float }, { "double", Type::Double },
      { "float64", Type::Double } };
    for (const auto& [known, type] : types)
    {
      if (name == known)
      {
        return type;
      }
    }
    this->RefuseHeader("property " + name);
  }

  template <typename Value>
  double Take()
  {
    return static_cast<double>(
      this->Words.Binary<Value>(this->Expected.c_str(), this->Format == "binary_big_endian"));
  }

  double Number(PlyProperty::Type type)
  {
    if (this->Format == "ascii")
    {
      return this->Words.Number<double>(this->Expected.c_str());
    }
    switch (type)
    {
      case PlyProperty::Type::Int8:
        return this->Take<std::int8_t>();
      case PlyProperty::Type::UInt8:
        return this->Take<std::uint8_t>();
      case PlyProperty::Type::Int16:
        return this->Take<std::int16_t>();
      case PlyProperty::Type::UInt16:
        return this->Take<std::uint16_t>();
      case PlyProperty::Type::Int32:
        return this->Take<std::int32_t>();
      case PlyProperty::Type::UInt32:
        return this->Take<std::uint32_t>();
      case PlyProperty::Type::Int64:
        return this->Take<std::int64_t>();
      case PlyProperty::Type::UInt64:
        return this->Take<std::uint64_t>();
      case PlyProperty::Type::Float:
        return this->Take<float>();
      default:
        return this->Take<double>();
    }
  }

  /// Passes over a value that nobody needs, in a text any word: "nan" of what was not measured.
  void PassOver(PlyProperty::Type type)
  {
    if (this->Format != "ascii")
    {
      this->Number(type);
    }
    else if (this->Words.Next().empty())
    {
      this->Words.Refuse(this->Expected, "");
    }
  }

  /// The next number, which counts or names one of `most` things.
  vtkIdType Index(PlyProperty::Type type, double most)
  {
    const double number = this->Number(type);
    if (!(number >= 0 && number < most) || number != std::floor(number))
    {
      throw InputError(this->Path + ": " + this->Expected + ": expected 0 to " +
        NumberText(most - 1) + ", found " + NumberText(number));
    }
    return static_cast<vtkIdType>(number);
  }

  void ReadItem(const PlyElement& element, std::uint64_t number, PolygonList& list)
  {
    this->Expected =
      element.Name + " " + std::to_string(number) + " of " + std::to_string(element.Count);
    double place[3] = { NAN, NAN, NAN };
    for (const PlyProperty& property : element.Properties)
    {
      if (!property.IsList)
      {
        if (element.Name == "vertex" && property.Name.size() == 1 && property.Name[0] >= 'x' &&
          property.Name[0] <= 'z')
        {
          place[property.Name[0] - 'x'] = this->Number(property.Of);
        }
        else
        {
          this->PassOver(property.Of);
        }
        continue;
      }
      const bool isFace = element.Name == "face" &&
        (property.Name == "vertex_indices" || property.Name == "vertex_index");
      this->Corners.clear();
      const vtkIdType count = this->Index(property.CountOf, 4e9);
      for (vtkIdType corner = 0; corner < count; ++corner)
      {
        if (isFace)
        {
          this->Corners.push_back(this->Index(property.Of, static_cast<double>(this->VertexCount)));
        }
        else
        {
          this->PassOver(property.Of);
        }
      }
      if (isFace && count < 3)
      {
        throw InputError(this->Path + ": " + this->Expected +
          ": expected three vertices or more, found " + std::to_string(count));
      }
      if (isFace)
      {
        list.AddPolygon(this->Corners);
      }
    }
    if (element.Name == "vertex")
    {
      list.AddPoint(place[0], place[1], place[2]);
    }
  }

  const std::string Path;
  FileWords Words;
  std::string Format;
  std::vector<PlyElement> Elements;
  std::uint64_t VertexCount = 0;
  /// What is being read.
  std::string Expected;
  std::vector<vtkIdType> Corners;
};
}

vtkSmartPointer<vtkPolyData> ReadStl(const std::string& path)
{
  FileWords words(path);
  NoteAxes(path, words);
  const std::string_view start = words.Left().substr(0, 1000);
  const bool isText = LowerCase(start).find("solid") == start.find_first_not_of(" \t\r\n") &&
    start.find('\0') == std::string_view::npos;
  return isText ? ReadTextStl(words) : ReadBinaryStl(path, words);
}

vtkSmartPointer<vtkPolyData> ReadPly(const std::string& path)
{
  return PlyFile(path).Read();
}

vtkSmartPointer<vtkPolyData> ReadObj(const std::string& path)
{
  FileWords words(path);
  NoteAxes(path, words);
  PolygonList list(true);
  vtkIdType last = 0;
  std::string lastUse;
  std::size_t freeForms = 0;
  while (!words.Left().empty())
  {
    const std::string where = LineName(path, words.LineNow());
    std::string line(words.Line());
    while (line.ends_with('\\') && !words.Left().empty())
    {
      line.back() = ' ';
      line += words.Line();
    }
    const auto refuse = [&](const char* expected) {
      throw InputError(where + ": expected " + expected + ", found '" + line.substr(0, 60) + "'");
    };
    const std::vector<std::string_view> parts = SplitLine(line);
    if (parts.empty())
    {
      continue;
    }
    if (parts[0] == "v")
    {
      double place[3] = {};
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        if (parts.size() < 4 || !ToPaddedNumber(parts[axis + 1], place[axis]) ||
          !std::isfinite(place[axis]))
        {
          refuse("three numbers for a vertex");
        }
      }
      list.AddPoint(place[0], place[1], place[2]);
    }
    else if (parts[0] == "f" || parts[0] == "fo")
    {
      std::vector<vtkIdType> corners;
      for (std::size_t part = 1; part < parts.size(); ++part)
      {
        vtkIdType corner = 0; // "7/1/3": of point, texture and normal
        if (!ToNumber(parts[part].substr(0, parts[part].find('/')), corner) || corner == 0)
        {
          refuse("numbers of vertices for a face");
        }
        corners.push_back(corner > 0 ? corner - 1 : list.NumberOfPoints() + corner);
        if (corners.back() < 0)
        {
          refuse("vertices that are there");
        }
        if (corners.back() > last)
        {
          last = corners.back();
          lastUse = where;
        }
      }
      if (corners.size() < 3)
      {
        refuse("three vertices of a face");
      }
      list.AddPolygon(corners);
    }
    freeForms += parts[0] == "surf" ? 1 : 0;
  }
  if (freeForms > 0)
  {
    Note({ path, "left out " + std::to_string(freeForms) + " free-form surface(s) (surf)" });
  }
  if (last >= list.NumberOfPoints() && !lastUse.empty())
  {
    throw InputError(lastUse + ": expected vertices 1 to " + std::to_string(list.NumberOfPoints()) +
      ", found " + std::to_string(last + 1));
  }
  return list.Finish();
}
}
