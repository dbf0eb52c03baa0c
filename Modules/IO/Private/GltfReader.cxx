// SPDX-License-Identifier: Apache-2.0
#include "Private/GltfReader.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/Foundation/Vector3.h"

#include "vtkCellArray.h"
#include "vtkCleanPolyData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;
using GltfJson = nlohmann::json;

/// x' = Columns[0] x + Columns[1] y + Columns[2] z + Columns[3].
struct GltfTransform
{
  std::array<Vector3, 4> Columns{ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } } };

  Vector3 Direction(const Vector3& v) const
  {
    return v[0] * this->Columns[0] + v[1] * this->Columns[1] + v[2] * this->Columns[2];
  }
  Vector3 Point(const Vector3& p) const { return this->Direction(p) + this->Columns[3]; }
  GltfTransform Of(const GltfTransform& inner) const
  {
    GltfTransform all;
    for (std::size_t column = 0; column < 3; ++column)
    {
      all.Columns[column] = this->Direction(inner.Columns[column]);
    }
    all.Columns[3] = this->Point(inner.Columns[3]);
    return all;
  }
  bool Mirrors() const
  {
    return Dot(this->Columns[0], Cross(this->Columns[1], this->Columns[2])) < 0;
  }
};

/// Numbers of a buffer, one after another or `Stride` bytes apart.
struct GltfAccessor
{
  const unsigned char* Data = nullptr;
  std::size_t Count = 0;
  std::size_t Stride = 0;
  int ComponentType = 0;

  template <typename Value>
  Value At(std::size_t element, std::size_t component = 0) const
  {
    Value value;
    std::memcpy(&value, this->Data + element * this->Stride + component * sizeof value,
      sizeof value);
    return value;
  }
};

/// Of a file's name in a URI: %20 is a blank.
std::string FromPercents(const std::string& uri)
{
  std::string name;
  for (std::size_t at = 0; at < uri.size(); ++at)
  {
    unsigned char byte = 0;
    const char* const digits = uri.data() + at + 1;
    if (uri[at] == '%' && at + 2 < uri.size() &&
      std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2)
    {
      name += static_cast<char>(byte);
      at += 2;
    }
    else
    {
      name += uri[at];
    }
  }
  return name;
}

/// Bytes of base64; the rest of the text where a letter is none.
std::string FromBase64(std::string_view text)
{
  static constexpr std::string_view letters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : text)
  {
    const std::size_t value = letters.find(letter);
    if (value == std::string_view::npos)
    {
      break; // padding
    }
    bits = (bits << 6 | static_cast<std::uint32_t>(value)) & 0xffffff;
    count += 6;
    if (count >= 8)
    {
      count -= 8;
      bytes += static_cast<char>(bits >> count & 0xff);
    }
  }
  return bytes;
}

class GltfFile
{
public:
  explicit GltfFile(const std::string& path)
    : Path(path)
  {
    const std::string bytes = ReadAll(path);
    this->File = GltfJson::parse(bytes.starts_with("glTF") ? this->TakeChunks(bytes) : bytes,
      JsonNestingLimit{ path });
    this->Points->SetDataTypeToDouble();
    const std::string version = this->File.at("asset").at("version").get<std::string>();
    if (!version.starts_with("2."))
    {
      this->Refuse("version 2 of glTF", version);
    }
    for (const GltfJson& extension : this->List(this->File, "extensionsRequired"))
    {
      const std::string name = extension.get<std::string>();
      const bool ofLooks = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") ||
        name.starts_with("EXT_texture_") || name == "KHR_lights_punctual";
      if (!ofLooks)
      {
        this->Refuse("a surface without required extensions", name);
      }
    }
    this->ReadBuffers();
  }

  vtkSmartPointer<vtkPolyData> Read()
  {
    const GltfJson& nodes = this->List(this->File, "nodes");
    this->Seen.assign(nodes.size(), false);
    const GltfJson& scenes = this->List(this->File, "scenes");
    if (scenes.empty())
    {
      this->Refuse("a scene", "none");
    }
    const std::size_t scene = this->IndexOr(0, this->File, "scene");
    for (const GltfJson& node : this->List(this->Entry(scenes, scene, "scene"), "nodes"))
    {
      this->AddNode(this->ToIndex(node), {}, 0);
    }
    if (this->Triangles->GetNumberOfCells() == 0)
    {
      this->Refuse("a mesh", "no triangles in the scene");
    }
    vtkNew<vtkPolyData> all;
    all->SetPoints(this->Points);
    all->SetPolys(this->Triangles);
    // A vertex for each normal at a point: they are one.
    vtkNew<vtkCleanPolyData> joined;
    joined->SetTolerance(0);
    joined->ConvertPolysToLinesOff();
    joined->ConvertLinesToPointsOff();
    joined->SetInputData(all);
    joined->Update();
    return joined->GetOutput();
  }

  [[noreturn]] void Refuse(const std::string& expected, const std::string& found) const
  {
    throw InputError(this->Path + ": expected " + expected + ", found " + found);
  }

private:
  static std::string ReadAll(const std::string& path)
  {
    std::ifstream file(path, std::ios::binary);
    return { std::istreambuf_iterator<char>(file), {} };
  }

  /// The text of a binary file; its buffer is kept.
  std::string TakeChunks(const std::string& bytes)
  {
    const auto number = [&](std::size_t at)
    {
      std::uint32_t value = 0;
      if (at + 4 > bytes.size())
      {
        this->Refuse("a mesh in binary glTF", "an end within its chunks");
      }
      std::memcpy(&value, bytes.data() + at, 4);
      return value;
    };
    std::string text;
    if (number(4) != 2 || number(8) > bytes.size())
    {
      this->Refuse("a mesh in binary glTF 2", "another version or an end before its own");
    }
    for (std::size_t at = 12; at + 8 <= number(8);)
    {
      const std::size_t length = number(at);
      const std::string kind = bytes.substr(at + 4, 4);
      if (length > bytes.size() - at - 8)
      {
        this->Refuse("a mesh in binary glTF", "an end within its chunks");
      }
      if (kind == "JSON")
      {
        text = bytes.substr(at + 8, length);
      }
      else if (kind == std::string("BIN\0", 4) && this->Binary.empty())
      {
        this->Binary = bytes.substr(at + 8, length);
      }
      at += 8 + length;
    }
    return text;
  }

  void ReadBuffers()
  {
    for (const GltfJson& buffer : this->List(this->File, "buffers"))
    {
      std::string bytes = this->Binary;
      if (buffer.contains("uri"))
      {
        const std::string uri = buffer.at("uri").get<std::string>();
        const std::size_t data = uri.find(";base64,");
        if (uri.starts_with("data:") && data != std::string::npos)
        {
          bytes = FromBase64(std::string_view(uri).substr(data + 8));
        }
        else
        {
          const fs::path name = FromPercents(uri);
          // Not one of another folder, whose bytes would come back as coordinates.
          if (uri.find(':') != std::string::npos || name.is_absolute() ||
            name.lexically_normal().string().starts_with(".."))
          {
            this->Refuse("a buffer in a file beside it", uri.substr(0, 60));
          }
          const fs::path file = fs::path(this->Path).parent_path() / name;
          std::error_code unusable; // as a name that is too long
          if (!fs::is_regular_file(file, unusable))
          {
            this->Refuse("the buffer " + file.string(), "no such file");
          }
          bytes = ReadAll(file.string());
        }
      }
      if (this->Index(buffer, "byteLength") > bytes.size())
      {
        this->Refuse("a buffer of " + std::to_string(this->Index(buffer, "byteLength")) + " bytes",
          std::to_string(bytes.size()));
      }
      this->Buffers.push_back(std::move(bytes));
    }
  }

  std::size_t ToIndex(const GltfJson& value) const
  {
    if (!value.is_number_unsigned())
    {
      this->Refuse("a whole number of at least 0", value.dump().substr(0, 60));
    }
    return value.get<std::size_t>();
  }
  std::size_t Index(const GltfJson& entry, const char* key) const
  {
    return this->ToIndex(entry.at(key));
  }
  std::size_t IndexOr(std::size_t standard, const GltfJson& entry, const char* key) const
  {
    return entry.contains(key) ? this->Index(entry, key) : standard;
  }
  /// An empty one where the key is absent.
  const GltfJson& List(const GltfJson& entry, const char* key) const
  {
    static const GltfJson none = GltfJson::array();
    const auto found = entry.find(key);
    if (found == entry.end())
    {
      return none;
    }
    if (!found->is_array())
    {
      this->Refuse(std::string("a list of ") + key, found->type_name());
    }
    return *found;
  }
  const GltfJson& Entry(const GltfJson& list, std::size_t index, const char* what) const
  {
    if (index >= list.size())
    {
      this->Refuse(std::string(what) + " " + std::to_string(index), std::to_string(list.size()));
    }
    return list[index];
  }

  template <std::size_t Count>
  std::array<double, Count> Numbers(const GltfJson& node, const char* key,
    const std::array<double, Count>& standard) const
  {
    if (!node.contains(key))
    {
      return standard;
    }
    std::array<double, Count> numbers{};
    const GltfJson& list = this->List(node, key);
    for (std::size_t index = 0; index < Count; ++index)
    {
      numbers[index] = list.size() == Count ? list[index].get<double>() : std::nan("");
      if (!std::isfinite(numbers[index]))
      {
        this->Refuse(std::to_string(Count) + " numbers of a node's " + key,
          list.dump().substr(0, 60));
      }
    }
    return numbers;
  }

  GltfTransform TransformOf(const GltfJson& node) const
  {
    GltfTransform own;
    if (node.contains("matrix"))
    {
      const auto matrix = this->Numbers<16>(node, "matrix", {});
      for (std::size_t column = 0; column < 4; ++column)
      {
        std::copy_n(&matrix[4 * column], 3, own.Columns[column].begin());
      }
      return own;
    }
    const auto shift = this->Numbers<3>(node, "translation", { 0, 0, 0 });
    const auto scale = this->Numbers<3>(node, "scale", { 1, 1, 1 });
    const auto [x, y, z, w] = this->Numbers<4>(node, "rotation", { 0, 0, 0, 1 });
    const double norm = x * x + y * y + z * z + w * w;
    if (!(norm > 0))
    {
      this->Refuse("a node's rotation with a length", "none");
    }
    const double s = 2 / norm;
    own.Columns[0] =
      scale[0] * Vector3{ 1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y) };
    own.Columns[1] =
      scale[1] * Vector3{ s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x) };
    own.Columns[2] =
      scale[2] * Vector3{ s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y) };
    own.Columns[3] = shift;
    return own;
  }

  void AddNode(std::size_t index, const GltfTransform& parent, int depth)
  {
    const GltfJson& node = this->Entry(this->List(this->File, "nodes"), index, "node");
    // A tree of more levels than this would end the process rather.
    constexpr int MostLevels = 1000;
    if (this->Seen[index] || depth > MostLevels)
    {
      this->Refuse("nodes in a tree", "node " + std::to_string(index) + " in several places");
    }
    this->Seen[index] = true;
    const GltfTransform placed = parent.Of(this->TransformOf(node));
    if (node.contains("mesh"))
    {
      if (node.contains("skin"))
      {
        this->Refuse("a mesh that stands still", "a skin in node " + std::to_string(index));
      }
      const GltfJson& mesh =
        this->Entry(this->List(this->File, "meshes"), this->Index(node, "mesh"), "mesh");
      for (const GltfJson* morphed : { &node, &mesh })
      {
        for (const GltfJson& weight : this->List(*morphed, "weights"))
        {
          if (weight.get<double>() != 0)
          {
            this->Refuse("a mesh at rest", "morph targets in node " + std::to_string(index));
          }
        }
      }
      for (const GltfJson& primitive : this->List(mesh, "primitives"))
      {
        this->AddPrimitive(primitive, placed);
      }
    }
    for (const GltfJson& child : this->List(node, "children"))
    {
      this->AddNode(this->ToIndex(child), placed, depth + 1);
    }
  }

  GltfAccessor Accessor(std::size_t index, const char* type, std::size_t components) const
  {
    const GltfJson& entry = this->Entry(this->List(this->File, "accessors"), index, "accessor");
    const std::string name = "accessor " + std::to_string(index);
    if (entry.contains("sparse") || !entry.contains("bufferView") ||
      entry.at("type").get<std::string>() != type)
    {
      this->Refuse(name + " to be a plain " + type, "another");
    }
    GltfAccessor accessor;
    accessor.ComponentType =
      static_cast<int>(std::min<std::size_t>(this->Index(entry, "componentType"), 65535));
    const std::size_t size = accessor.ComponentType == 5126 || accessor.ComponentType == 5125 ? 4
      : accessor.ComponentType == 5122 || accessor.ComponentType == 5123                      ? 2
                                                                                              : 1;
    const GltfJson& view = this->Entry(this->List(this->File, "bufferViews"),
      this->Index(entry, "bufferView"), "buffer view");
    const std::size_t buffer = this->Index(view, "buffer");
    if (buffer >= this->Buffers.size())
    {
      this->Refuse("buffer " + std::to_string(buffer), std::to_string(this->Buffers.size()));
    }
    accessor.Count = this->Index(entry, "count");
    accessor.Stride = this->IndexOr(components * size, view, "byteStride");
    // Sums of sizes that are no file's would wrap around.
    constexpr std::size_t MostBytes = std::size_t{ 1 } << 48;
    const std::size_t parts[] = { accessor.Count, accessor.Stride,
      this->IndexOr(0, view, "byteOffset"), this->IndexOr(0, entry, "byteOffset"),
      this->Index(view, "byteLength") };
    const bool huge = std::any_of(std::begin(parts), std::end(parts),
      [](std::size_t part) { return part > MostBytes; });
    const std::size_t begin = parts[2] + parts[3];
    const std::size_t within = std::min(parts[2] + parts[4], this->Buffers[buffer].size());
    const std::size_t last = components * size;
    if (huge || accessor.Count == 0 || accessor.Stride < last || begin + last > within ||
      (within - begin - last) / accessor.Stride + 1 < accessor.Count)
    {
      this->Refuse(name + " to lie in its buffer",
        std::to_string(accessor.Count) + " elements in " +
          std::to_string(within > begin ? within - begin : 0) + " bytes");
    }
    accessor.Data = reinterpret_cast<const unsigned char*>(this->Buffers[buffer].data()) + begin;
    return accessor;
  }

  void AddPrimitive(const GltfJson& primitive, const GltfTransform& placed)
  {
    const std::size_t mode = this->IndexOr(4, primitive, "mode");
    if (mode < 4 || mode > 6)
    {
      this->Refuse("triangles", "points or lines (mode " + std::to_string(mode) + ")");
    }
    const GltfAccessor positions =
      this->Accessor(this->Index(primitive.at("attributes"), "POSITION"), "VEC3", 3);
    if (positions.ComponentType != 5126)
    {
      this->Refuse("positions in floats",
        "component type " + std::to_string(positions.ComponentType));
    }
    const vtkIdType base = this->Points->GetNumberOfPoints();
    for (std::size_t point = 0; point < positions.Count; ++point)
    {
      const Vector3 own{ positions.At<float>(point, 0), positions.At<float>(point, 1),
        positions.At<float>(point, 2) };
      const Vector3 mm = GltfUnitMm * placed.Point(own);
      if (!std::isfinite(mm[0]) || !std::isfinite(mm[1]) || !std::isfinite(mm[2]))
      {
        this->Refuse("finite coordinates", "others at point " + std::to_string(point));
      }
      this->Points->InsertNextPoint(mm.data());
    }
    const std::vector<std::uint32_t> corners = this->CornersOf(primitive, positions.Count);
    const bool mirrors = placed.Mirrors();
    const std::size_t step = mode == 4 ? 3 : 1;
    for (std::size_t first = 0; first + 3 <= corners.size(); first += step)
    {
      // Of a strip every other triangle runs the other way.
      const bool turned = mirrors != (mode == 5 && first % 2 == 1);
      const vtkIdType ids[3] = { base + corners[mode == 6 ? 0 : first],
        base + corners[first + (turned ? 2 : 1)], base + corners[first + (turned ? 1 : 2)] };
      this->Triangles->InsertNextCell(3, ids);
    }
  }

  std::vector<std::uint32_t> CornersOf(const GltfJson& primitive, std::size_t pointCount) const
  {
    std::vector<std::uint32_t> corners;
    if (!primitive.contains("indices"))
    {
      for (std::size_t point = 0; point < pointCount; ++point)
      {
        corners.push_back(static_cast<std::uint32_t>(point));
      }
      return corners;
    }
    const GltfAccessor indices = this->Accessor(this->Index(primitive, "indices"), "SCALAR", 1);
    for (std::size_t index = 0; index < indices.Count; ++index)
    {
      const std::uint32_t corner = indices.ComponentType == 5125 ? indices.At<std::uint32_t>(index)
        : indices.ComponentType == 5123                          ? indices.At<std::uint16_t>(index)
                                                                 : indices.At<std::uint8_t>(index);
      if (corner >= pointCount ||
        (indices.ComponentType != 5125 && indices.ComponentType != 5123 &&
          indices.ComponentType != 5121))
      {
        this->Refuse("indices of the " + std::to_string(pointCount) + " points",
          std::to_string(corner) + " of component type " + std::to_string(indices.ComponentType));
      }
      corners.push_back(corner);
    }
    return corners;
  }

  std::string Path;
  GltfJson File;
  std::string Binary;
  std::vector<std::string> Buffers;
  std::vector<bool> Seen;
  vtkNew<vtkPoints> Points;
  vtkNew<vtkCellArray> Triangles;
};
}

vtkSmartPointer<vtkPolyData> ReadGltf(const std::string& path)
{
  try
  {
    return GltfFile(path).Read();
  }
  catch (const GltfJson::exception& error)
  {
    std::string message = error.what();
    std::replace(message.begin(), message.end(), '\n', ' ');
    throw InputError(path + ": expected a mesh in glTF: " + message.substr(0, 200));
  }
}
}
