// SPDX-License-Identifier: Apache-2.0
// A scene in binary glTF 2.0, by hand.
#ifndef mammoray_GlbBytes_h
#define mammoray_GlbBytes_h

#include <cstdint>
#include <cstring>
#include <string>

namespace mammoray::testing_support
{
/// A tetrahedron whose edges at the origin are 1 long, moved by 1, 2, 3 and doubled in size by its
/// node; metres. Each of its faces has vertices of its own, as where normals differ.
inline std::string GlbOfTetrahedron()
{
  const float corners[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  const int faces[4][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 }, { 0, 3, 2 } };
  std::string bytes;
  const auto put = [&](const auto& value)
  {
    char raw[sizeof(value)];
    std::memcpy(raw, &value, sizeof(value));
    bytes.append(raw, sizeof(value));
  };
  for (const auto& face : faces)
  {
    for (const int corner : face)
    {
      put(corners[corner][0]);
      put(corners[corner][1]);
      put(corners[corner][2]);
    }
  }
  for (std::uint16_t index = 0; index < 12; ++index)
  {
    put(index);
  }
  const std::string binary = bytes; // 144 and 24 bytes
  std::string scene =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
    R"("nodes":[{"mesh":0,"translation":[1,2,3],"scale":[2,2,2]}],)"
    R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
    R"("buffers":[{"byteLength":168}],)"
    R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":144},)"
    R"({"buffer":0,"byteOffset":144,"byteLength":24}],)"
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":12,"type":"VEC3",)"
    R"("min":[0,0,0],"max":[1,1,1]},)"
    R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]})";
  scene.resize((scene.size() + 3) / 4 * 4, ' ');
  bytes.clear();
  bytes += "glTF";
  put(std::uint32_t{ 2 });
  put(static_cast<std::uint32_t>(12 + 8 + scene.size() + 8 + binary.size()));
  put(static_cast<std::uint32_t>(scene.size()));
  bytes += "JSON" + scene;
  put(static_cast<std::uint32_t>(binary.size()));
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}
}

#endif
