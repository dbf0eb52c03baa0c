// SPDX-License-Identifier: Apache-2.0
// A scene in binary glTF 2.0, by hand.
#ifndef mammoray_GlbBytes_h
#define mammoray_GlbBytes_h

#include <cstdint>
#include <cstring>
#include <string>

namespace mammoray::test
{
/// Positions and indices of a tetrahedron whose edges at the origin are 1 long: 12 vertices of
/// three floats, each face with vertices of its own as where normals differ, then 12 indices of two
/// bytes.
inline std::string TetrahedronBuffer()
{
  const float corners[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  const int faces[4][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 }, { 0, 3, 2 } };
  std::string bytes(168, 0);
  for (std::size_t vertex = 0; vertex < 12; ++vertex)
  {
    std::memcpy(&bytes[12 * vertex], corners[faces[vertex / 3][vertex % 3]], 12);
    bytes[144 + 2 * vertex] = static_cast<char>(vertex);
  }
  return bytes;
}

/// The scene of such a buffer with these nodes, of which the first is the root, and these contents
/// of the only primitive; metres.
inline std::string GltfText(const std::string& nodes,
  const std::string& primitive = R"("attributes":{"POSITION":0},"indices":1)",
  const std::string& buffer = R"("byteLength":168)")
{
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
    R"(,"meshes":[{"primitives":[{)" + primitive + R"(}]}],"buffers":[{)" + buffer +
    R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":144},)"
    R"({"buffer":0,"byteOffset":144,"byteLength":24}],)"
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":12,"type":"VEC3",)"
    R"("min":[0,0,0],"max":[1,1,1]},)"
    R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]})";
}

/// Text and buffer in one file.
inline std::string Glb(std::string text, const std::string& buffer)
{
  std::string bytes = "glTF";
  const auto put = [&](std::size_t value)
  {
    char raw[4];
    const auto number = static_cast<std::uint32_t>(value);
    std::memcpy(raw, &number, 4);
    bytes.append(raw, 4);
  };
  text.resize((text.size() + 3) / 4 * 4, ' ');
  put(2);
  put(12 + 8 + text.size() + 8 + buffer.size());
  put(text.size());
  bytes += "JSON" + text;
  put(buffer.size());
  return bytes + std::string("BIN\0", 4) + buffer;
}

/// The tetrahedron moved by 1, 2, 3 and doubled in size by its node.
inline std::string GlbOfTetrahedron()
{
  return Glb(GltfText(R"([{"mesh":0,"translation":[1,2,3],"scale":[2,2,2]}])"),
    TetrahedronBuffer());
}
}

#endif
