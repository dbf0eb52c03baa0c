// SPDX-License-Identifier: Apache-2.0
#include "Private/GltfReader.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"

#include "vtkCellArray.h"
#include "vtkCleanPolyData.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <vector>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

[[noreturn]] void RefuseGltf(const std::string& path, const std::string& expected,
  const std::string& found)
{
  throw InputError(path + ": expected " + expected + ", found " + found);
}

/// True for a regular file in the folder `data` points to, or below it.
bool IsBesideGltf(const std::string& path, void* data)
{
  const fs::path inFolder =
    fs::path(path).lexically_normal().lexically_relative(*static_cast<const fs::path*>(data));
  std::error_code unusable;
  return !inFolder.empty() && *inFolder.begin() != ".." && fs::is_regular_file(path, unusable);
}

bool ReadBeside(std::vector<unsigned char>* bytes, std::string*, const std::string& path, void*)
{
  std::ifstream file(path, std::ios::binary);
  bytes->assign(std::istreambuf_iterator<char>(file), {});
  return !bytes->empty();
}

/// All of tinygltf's callbacks, of which version 2.9 has one more than 2.7: it takes all or none,
/// and with none files anywhere are read.
template <typename Callbacks>
Callbacks ReadingBeside(fs::path& folder)
{
  Callbacks result{};
  result.FileExists = IsBesideGltf;
  result.ExpandFilePath = [](const std::string& name, void*) { return name; };
  result.ReadWholeFile = ReadBeside;
  result.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&,
                            void*) { return false; };
  if constexpr (requires { result.GetFileSizeInBytes; })
  {
    result.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string& path, void*)
    {
      std::error_code unusable;
      *size = fs::file_size(path, unusable);
      return !unusable;
    };
  }
  result.user_data = &folder;
  return result;
}

bool LeaveOutImage(tinygltf::Image*, int, std::string*, std::string*, int, int,
  const unsigned char*, int, void*)
{
  return true;
}

/// Throws InputError on placements that tinygltf would leave out without a word.
void CheckGltfPlacements(const std::string& path, std::string_view text)
{
  const auto file = nlohmann::json::parse(text, JsonNestingLimit{ path });
  const std::pair<const char*, std::size_t> sizes[] = { { "matrix", 16 }, { "rotation", 4 },
    { "scale", 3 }, { "translation", 3 } };
  for (const nlohmann::json& node : file.value("nodes", nlohmann::json::array()))
  {
    for (const auto& [key, size] : sizes)
    {
      const auto numbers = node.value(key, std::vector<double>(size));
      if (numbers.size() != size ||
        !std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); }))
      {
        RefuseGltf(path, std::to_string(size) + " numbers of a node's " + key, "others");
      }
    }
  }
}

tinygltf::Model LoadGltf(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  const auto size = static_cast<unsigned int>(bytes.size());
  const bool isBinary = bytes.starts_with("glTF");
  std::uint32_t textSize = 0;
  if (size != bytes.size() || (isBinary && size < 20))
  {
    RefuseGltf(path, "a mesh in glTF of 20 bytes to 4 GiB",
      std::to_string(bytes.size()) + " bytes");
  }
  std::memcpy(&textSize, bytes.data() + (isBinary ? 12 : 0), isBinary ? sizeof textSize : 0);
  CheckGltfPlacements(path, isBinary ? std::string_view(bytes).substr(20, textSize) : bytes);

  fs::path folder = fs::absolute(path).parent_path().lexically_normal();
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(LeaveOutImage, nullptr);
  loader.SetFsCallbacks(ReadingBeside<tinygltf::FsCallbacks>(folder));
  tinygltf::Model model;
  std::string problem;
  std::string warning;
  const bool isLoaded = isBinary
    ? loader.LoadBinaryFromMemory(&model, &problem, &warning,
        reinterpret_cast<const unsigned char*>(bytes.data()), size, folder.string())
    : loader.LoadASCIIFromString(&model, &problem, &warning, bytes.data(), size, folder.string());
  if (!isLoaded || !problem.empty())
  {
    throw InputError(path + ": expected a mesh in glTF: " + problem.substr(0, problem.find('\n')));
  }
  if (!model.asset.version.starts_with("2."))
  {
    RefuseGltf(path, "version 2 of glTF", model.asset.version);
  }
  for (const std::string& name : model.extensionsRequired)
  {
    const bool ofLooks = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") ||
      name.starts_with("EXT_texture_") || name == "KHR_lights_punctual";
    if (!ofLooks)
    {
      RefuseGltf(path, "a surface without required extensions", name);
    }
  }
  return model;
}

class GltfSurface
{
public:
  explicit GltfSurface(const std::string& path)
    : Path(path)
    , Model(LoadGltf(path))
    , Seen(Model.nodes.size(), false)
  {
    this->Points->SetDataTypeToDouble();
  }

  vtkSmartPointer<vtkPolyData> Read()
  {
    const int scene = std::max(this->Model.defaultScene, 0);
    for (const int node : this->Entry(this->Model.scenes, scene, "scene").nodes)
    {
      this->AddNode(node, Eigen::Affine3d::Identity(), 0);
    }
    if (this->Triangles->GetNumberOfCells() == 0)
    {
      this->Refuse("a mesh", "no triangles in the scene");
    }
    vtkNew<vtkPolyData> all;
    all->SetPoints(this->Points);
    all->SetPolys(this->Triangles);
    // A point with several normals is a vertex for each of them.
    vtkNew<vtkCleanPolyData> joined;
    joined->SetTolerance(0);
    joined->ConvertPolysToLinesOff();
    joined->ConvertLinesToPointsOff();
    joined->SetInputData(all);
    joined->Update();
    return joined->GetOutput();
  }

private:
  [[noreturn]] void Refuse(const std::string& expected, const std::string& found) const
  {
    RefuseGltf(this->Path, expected, found);
  }

  template <typename Value>
  const Value& Entry(const std::vector<Value>& list, int index, const char* what) const
  {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size())
    {
      this->Refuse(std::string(what) + " " + std::to_string(index), std::to_string(list.size()));
    }
    return list[static_cast<std::size_t>(index)];
  }

  Eigen::Affine3d TransformOf(const tinygltf::Node& node) const
  {
    if (!node.matrix.empty())
    {
      const Eigen::Matrix4d matrix(node.matrix.data()); // column by column
      return Eigen::Affine3d(matrix.topRows<3>());
    }
    const auto vector = [](const std::vector<double>& numbers, double otherwise)
    {
      return numbers.empty() ? Eigen::Vector3d::Constant(otherwise).eval()
                             : Eigen::Vector3d(numbers.data());
    };
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    if (!node.rotation.empty())
    {
      rotation.coeffs() = Eigen::Vector4d(node.rotation.data()); // x, y, z, w
    }
    if (!(rotation.norm() > 0))
    {
      this->Refuse("a node's rotation with a length", "none");
    }
    return Eigen::Translation3d(vector(node.translation, 0)) * rotation.normalized() *
      Eigen::Scaling(vector(node.scale, 1));
  }

  void AddNode(int index, const Eigen::Affine3d& parent, int depth)
  {
    const tinygltf::Node& node = this->Entry(this->Model.nodes, index, "node");
    const std::string name = "node " + std::to_string(index);
    constexpr int MostLevels = 1000; // recursion has no room for many more
    if (this->Seen[static_cast<std::size_t>(index)] || depth > MostLevels)
    {
      this->Refuse("nodes in a tree", name + " in several places");
    }
    this->Seen[static_cast<std::size_t>(index)] = true;
    const Eigen::Affine3d placed = parent * this->TransformOf(node);
    if (node.mesh >= 0)
    {
      const tinygltf::Mesh& mesh = this->Entry(this->Model.meshes, node.mesh, "mesh");
      const auto isMorphed = [](double weight) { return weight != 0; };
      if (node.skin >= 0)
      {
        this->Refuse("a mesh that stands still", "a skin in " + name);
      }
      if (std::any_of(node.weights.begin(), node.weights.end(), isMorphed) ||
        std::any_of(mesh.weights.begin(), mesh.weights.end(), isMorphed))
      {
        this->Refuse("a mesh at rest", "morph targets in " + name);
      }
      for (const tinygltf::Primitive& primitive : mesh.primitives)
      {
        this->AddPrimitive(primitive, placed);
      }
    }
    for (const int child : node.children)
    {
      this->AddNode(child, placed, depth + 1);
    }
  }

  /// Numbers of a buffer, `Stride` bytes apart.
  struct Numbers
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

  Numbers NumbersOf(int index, int type) const
  {
    const tinygltf::Accessor& accessor = this->Entry(this->Model.accessors, index, "accessor");
    const std::string name = "accessor " + std::to_string(index);
    if (accessor.sparse.isSparse || accessor.bufferView < 0 || accessor.type != type)
    {
      this->Refuse(name + " to be a plain list", "another");
    }
    const tinygltf::BufferView& view =
      this->Entry(this->Model.bufferViews, accessor.bufferView, "buffer view");
    const std::size_t bytes = this->Entry(this->Model.buffers, view.buffer, "buffer").data.size();
    const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
    const int size =
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
    const auto element = static_cast<std::size_t>(std::max(components * size, 1));
    const std::size_t stride = view.byteStride == 0 ? element : view.byteStride;
    // In doubles, which cannot wrap around.
    const double begin = static_cast<double>(view.byteOffset) + accessor.byteOffset;
    const double end = begin + static_cast<double>(stride) * (accessor.count - 1.0) + element;
    const double most =
      std::min(static_cast<double>(view.byteOffset) + view.byteLength, static_cast<double>(bytes));
    if (accessor.count == 0 || stride < element || end > most)
    {
      this->Refuse(name + " to lie in its buffer",
        std::to_string(accessor.count) + " elements beyond its end");
    }
    return { this->Model.buffers[static_cast<std::size_t>(view.buffer)].data.data() +
        view.byteOffset + accessor.byteOffset,
      accessor.count, stride, accessor.componentType };
  }

  void AddPrimitive(const tinygltf::Primitive& primitive, const Eigen::Affine3d& placed)
  {
    const int mode = primitive.mode;
    const bool isFan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
    const bool isStrip = mode == TINYGLTF_MODE_TRIANGLE_STRIP;
    if (!isFan && !isStrip && mode != TINYGLTF_MODE_TRIANGLES)
    {
      this->Refuse("triangles", "points or lines (mode " + std::to_string(mode) + ")");
    }
    const auto position = primitive.attributes.find("POSITION");
    const Numbers positions = this->NumbersOf(
      position == primitive.attributes.end() ? -1 : position->second, TINYGLTF_TYPE_VEC3);
    if (positions.ComponentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
    {
      this->Refuse("positions in floats",
        "component type " + std::to_string(positions.ComponentType));
    }
    const vtkIdType base = this->Points->GetNumberOfPoints();
    for (std::size_t point = 0; point < positions.Count; ++point)
    {
      const Eigen::Vector3d own{ positions.At<float>(point, 0), positions.At<float>(point, 1),
        positions.At<float>(point, 2) };
      const Eigen::Vector3d mm = GltfUnitMm * (placed * own);
      if (!mm.allFinite())
      {
        this->Refuse("finite coordinates", "others at point " + std::to_string(point));
      }
      this->Points->InsertNextPoint(mm.data());
    }
    const std::vector<vtkIdType> corners = this->CornersOf(primitive, positions.Count);
    const bool isMirrored = placed.linear().determinant() < 0;
    for (std::size_t first = 0; first + 3 <= corners.size(); first += isFan || isStrip ? 1 : 3)
    {
      // Every other triangle of a strip runs the other way.
      const bool turned = isMirrored != (isStrip && first % 2 == 1);
      const vtkIdType ids[3] = { base + corners[isFan ? 0 : first],
        base + corners[first + (turned ? 2 : 1)], base + corners[first + (turned ? 1 : 2)] };
      this->Triangles->InsertNextCell(3, ids);
    }
  }

  std::vector<vtkIdType> CornersOf(const tinygltf::Primitive& primitive, std::size_t points) const
  {
    std::vector<vtkIdType> corners(points);
    std::iota(corners.begin(), corners.end(), vtkIdType{ 0 });
    if (primitive.indices < 0)
    {
      return corners;
    }
    const Numbers indices = this->NumbersOf(primitive.indices, TINYGLTF_TYPE_SCALAR);
    corners.resize(indices.Count);
    for (std::size_t index = 0; index < indices.Count; ++index)
    {
      const int type = indices.ComponentType;
      corners[index] = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT
        ? indices.At<std::uint32_t>(index)
        : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? indices.At<std::uint16_t>(index)
        : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE  ? indices.At<std::uint8_t>(index)
                                                         : std::int64_t{ -1 };
      if (corners[index] < 0 || static_cast<std::size_t>(corners[index]) >= points)
      {
        this->Refuse("indices of the " + std::to_string(points) + " points",
          std::to_string(corners[index]) + " of component type " + std::to_string(type));
      }
    }
    return corners;
  }

  const std::string Path;
  const tinygltf::Model Model;
  std::vector<bool> Seen;
  vtkNew<vtkPoints> Points;
  vtkNew<vtkCellArray> Triangles;
};
}

vtkSmartPointer<vtkPolyData> ReadGltf(const std::string& path)
{
  try
  {
    return GltfSurface(path).Read();
  }
  catch (const nlohmann::json::exception& error)
  {
    const std::string message = error.what();
    throw InputError(path + ": expected a mesh in glTF: " +
      message.substr(0, std::min<std::size_t>(message.find('\n'), 200)));
  }
}
}
