// SPDX-License-Identifier: Apache-2.0
// Surfaces and meshes as other programs write them.
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

using namespace mammoray;
using testing::HasSubstr;

namespace
{
using Polygon = std::vector<int>;

/// A body of flat faces.
struct Body
{
  std::vector<Vector3> Points;
  std::vector<Polygon> Faces;
};

/// 10 mm wide, of quads.
Body Cube(const Vector3& corner = { 0, 0, 0 })
{
  Body cube{ {},
    { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 4, 6, 2 },
      { 1, 3, 7, 5 } } };
  for (int point = 0; point < 8; ++point)
  {
    cube.Points.push_back(
      corner + Vector3{ 10.0 * (point & 1), 10.0 * (point >> 1 & 1), 10.0 * (point >> 2) });
  }
  return cube;
}

/// An L, 10 mm high, whose base of 300 mm2 is a concave hexagon.
Body Angle()
{
  Body angle{ {}, { { 5, 4, 3, 2, 1, 0 }, { 6, 7, 8, 9, 10, 11 } } };
  for (const double z : { 0.0, 10.0 })
  {
    angle.Points.insert(angle.Points.end(),
      { { 0, 0, z }, { 20, 0, z }, { 20, 10, z }, { 10, 10, z }, { 10, 20, z }, { 0, 20, z } });
  }
  for (int side = 0; side < 6; ++side)
  {
    const int next = (side + 1) % 6;
    angle.Faces.push_back({ side, next, next + 6, side + 6 });
  }
  return angle;
}

Body Triangulated(const Body& body)
{
  Body cut{ body.Points, {} };
  for (const Polygon& face : body.Faces)
  {
    for (std::size_t corner = 2; corner < face.size(); ++corner)
    {
      cut.Faces.push_back({ face[0], face[corner - 1], face[corner] });
    }
  }
  return cut;
}

std::string Numbers(const Vector3& point)
{
  char text[100];
  std::snprintf(text, sizeof text, "%.17g %.17g %.17g", point[0], point[1], point[2]);
  return text;
}

std::string TextStl(const Body& body, const std::string& name = "part")
{
  std::string text = "solid " + name + "\n";
  for (const Polygon& face : body.Faces)
  {
    text += "facet normal 0 0 nan\n outer loop\n";
    for (const int corner : face)
    {
      text += "  vertex " + Numbers(body.Points[corner]) + "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

template <typename Value>
std::string Bytes(Value value, bool isSwapped = false)
{
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (isSwapped)
  {
    std::reverse(bytes.begin(), bytes.end());
  }
  return bytes;
}

std::string BinaryStl(const Body& body, std::uint32_t count, std::string header = "")
{
  header.resize(80, header.empty() ? '\0' : ' ');
  std::string bytes = header + Bytes(count);
  for (const Polygon& face : body.Faces)
  {
    bytes += std::string(12, '\0');
    for (const int corner : face)
    {
      for (const double number : body.Points[corner])
      {
        bytes += Bytes(static_cast<float>(number));
      }
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

/// `separator`: what stands behind the number of a corner.
std::string Obj(const Body& body, const std::string& behind = "")
{
  std::string text;
  for (const Vector3& point : body.Points)
  {
    text += "v " + Numbers(point) + "\n";
  }
  for (const Polygon& face : body.Faces)
  {
    text += "f";
    for (const int corner : face)
    {
      text += " " + std::to_string(corner + 1) + behind;
    }
    text += "\n";
  }
  return text;
}

/// `format`: "ascii" or one of the binary ones, whose coordinates are doubles or floats.
std::string Ply(const Body& body, const std::string& format, bool isDouble,
  std::size_t faces = std::string::npos)
{
  const std::string type = isDouble ? "double" : "float";
  std::string bytes = "ply\nformat " + format + " 1.0\ncomment by a test\nelement vertex " +
    std::to_string(body.Points.size()) + "\nproperty " + type + " x\nproperty " + type +
    " y\nproperty " + type + " z\nproperty uchar red\nelement face " +
    std::to_string(std::min(faces, body.Faces.size())) +
    "\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nend_header\n";
  const bool isSwapped = format == "binary_big_endian";
  for (const Vector3& point : body.Points)
  {
    if (format == "ascii")
    {
      bytes += Numbers(point) + " 7\n";
      continue;
    }
    for (const double number : point)
    {
      bytes += isDouble ? Bytes(number, isSwapped) : Bytes(static_cast<float>(number), isSwapped);
    }
    bytes += '\7';
  }
  for (const Polygon& face : body.Faces)
  {
    bytes += format == "ascii" ? std::to_string(face.size())
                               : std::string(1, static_cast<char>(face.size()));
    for (const int corner : face)
    {
      bytes += format == "ascii" ? " " + std::to_string(corner)
                                 : Bytes(static_cast<std::int32_t>(corner), isSwapped);
    }
    bytes += format == "ascii" ? "\n" : "";
  }
  return bytes + (format == "ascii" ? "0\n" : std::string(4, '\0'));
}

double VolumeOf(const SurfaceMesh& surface)
{
  double volume = 0;
  const Vector3 origin = surface.Point(0);
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    volume += Dot(surface.Corner(triangle, 0) - origin,
                Cross(surface.Corner(triangle, 1) - origin, surface.Corner(triangle, 2) - origin)) /
      6;
  }
  return volume;
}

std::string Joined(const std::vector<std::string>& lines)
{
  std::string text;
  for (const std::string& line : lines)
  {
    text += line + "\n";
  }
  return text;
}

/// What a file is read as, and what is told of it.
struct Reading
{
  SurfaceMesh Surface;
  std::string Told;
};

class SurfaceFiles : public testing::Test
{
protected:
  Reading Read(const std::string& name, const std::string& bytes)
  {
    NoteKeeper notes;
    Reading reading;
    reading.Surface = ReadSurface(this->Folder.Write(name, bytes));
    reading.Told = Joined(notes.Lines());
    return reading;
  }
  void ExpectVolume(const std::string& name, const std::string& bytes, double volume,
    std::size_t triangles)
  {
    const Reading reading = this->Read(name, bytes);
    EXPECT_NEAR(VolumeOf(reading.Surface), volume, 1e-9 * volume) << name;
    EXPECT_EQ(reading.Surface.NumberOfTriangles(), triangles) << name;
    EXPECT_EQ(reading.Told, "") << name;
  }
  std::string Refusal(const std::string& name, const std::string& bytes)
  {
    const std::string path = this->Folder.Write(name, bytes);
    return test::RefusalOf([&] { ReadMeshOrSurface(path); });
  }

  const test::TemporaryFolder Folder;
};

/// Two tetrahedra of 1/6 and 1/3 mm3.
std::string Gmsh2(const std::string& elements)
{
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\nby a test\n$EndComments\n"
         "$PhysicalNames\n3\n2 7 \"a side\"\n3 12 \"gland\"\n3 5 \"fat tissue\"\n"
         "$EndPhysicalNames\n$Nodes\n5\n3 0 0 0\n13 1 0 0\n23 0 1 0\n33 0 0 1\n43 1 1 1\n"
         "$EndNodes\n$Elements\n" +
    elements + "$EndElements\n";
}

/// The same by entities: volume 1 is gland, volume 2 fat.
std::string Gmsh4()
{
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 12 \"gland\"\n3 5 \"fat\"\n"
         "$EndPhysicalNames\n$Entities\n1 0 1 2\n1 0 0 0 0\n1 0 0 0 1 1 1 1 7 1 4\n"
         "1 0 0 0 1 1 1 1 12 1 1\n2 0 0 0 1 1 1 1 5 1 1\n$EndEntities\n"
         "$Nodes\n2 5 1 5\n2 1 1 1\n1\n0 0 0 0.5 0.5\n3 1 0 4\n2\n3\n4\n5\n"
         "1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n3 3 1 3\n2 1 2 1\n1 1 2 3\n"
         "3 1 4 1\n2 1 2 3 4\n3 2 4 1\n3 2 5 3 4\n$EndElements\n";
}

template <typename... Values>
std::string Join(const Values&... values)
{
  return (Bytes(values) + ...);
}

/// The same in binary.
std::string Gmsh4Binary()
{
  using Size = std::uint64_t;
  const std::string bounds = Join(0.0, 0.0, 0.0, 1.0, 1.0, 1.0);
  return "$MeshFormat\n4.1 1 8\n" + Join(1) +
    "\n$EndMeshFormat\n$PhysicalNames\n2\n3 12 \"gland\"\n3 5 \"fat\"\n$EndPhysicalNames\n"
    "$Entities\n" +
    Join(Size{ 1 }, Size{ 0 }, Size{ 1 }, Size{ 2 }, 1, 0.0, 0.0, 0.0, Size{ 0 }) + Join(1) +
    bounds + Join(Size{ 1 }, 7, Size{ 1 }, 4) + Join(1) + bounds +
    Join(Size{ 1 }, 12, Size{ 1 }, 1) + Join(2) + bounds + Join(Size{ 1 }, 5, Size{ 1 }, 1) +
    "\n$EndEntities\n$Nodes\n" +
    Join(Size{ 1 }, Size{ 5 }, Size{ 1 }, Size{ 5 }, 3, 1, 0, Size{ 5 }, Size{ 1 }, Size{ 2 },
      Size{ 3 }, Size{ 4 }, Size{ 5 }) +
    Join(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0) +
    "\n$EndNodes\n$Elements\n" +
    Join(Size{ 2 }, Size{ 2 }, Size{ 1 }, Size{ 2 }, 3, 1, 4, Size{ 1 }, Size{ 1 }, Size{ 1 },
      Size{ 2 }, Size{ 3 }, Size{ 4 }) +
    Join(3, 2, 4, Size{ 1 }, Size{ 2 }, Size{ 2 }, Size{ 5 }, Size{ 3 }, Size{ 4 }) +
    "\n$EndElements\n";
}
}

TEST_F(SurfaceFiles, TextStlOfAnyProgramIsRead)
{
  const Body cube = Triangulated(Cube());
  const std::string plain = TextStl(cube);
  this->ExpectVolume("plain.stl", plain, 1000, 12);
  this->ExpectVolume("mark.stl", "\xef\xbb\xbf" + plain, 1000, 12);
  this->ExpectVolume("long.stl", TextStl(cube, "a facet of vertex " + std::string(2000, 'x')), 1000,
    12);
  this->ExpectVolume("nameless.stl", TextStl(cube, ""), 1000, 12);
  this->ExpectVolume("quads.stl", TextStl(Cube()), 1000, 12);
  std::string other = plain;
  for (const auto& [from, to] : { std::pair{ "endloop", "end loop" },
         std::pair{ "endfacet", "END FACET" }, std::pair{ "\n", "\r\n" } })
  {
    for (std::size_t at = other.find(from); at != std::string::npos;
         at = other.find(from, at + std::string(to).size()))
    {
      other.replace(at, std::string(from).size(), to);
    }
  }
  this->ExpectVolume("other.stl", other, 1000, 12);
  EXPECT_EQ(this->Read("joined.stl", plain).Surface.NumberOfPoints(), 8u);
  EXPECT_THAT(this->Refusal("cut.stl", plain.substr(0, plain.find("endloop", plain.size() / 2))),
    HasSubstr("found the end of the file"));
  EXPECT_THAT(this->Refusal("cut.stl", plain.substr(0, plain.find("endsolid"))),
    HasSubstr("expected endsolid, found the end of the file"));
  EXPECT_THAT(this->Refusal("nan.stl", "solid a\nfacet\nouter loop\nvertex 0 0 x\n"),
    HasSubstr("nan.stl: line 4: expected three numbers for a vertex, found 'x'"));
}

TEST_F(SurfaceFiles, BinaryStlHasAllTheTrianglesThatItCounts)
{
  const Body cube = Triangulated(Cube());
  this->ExpectVolume("plain.stl", BinaryStl(cube, 12), 1000, 12);
  this->ExpectVolume("solid.stl", BinaryStl(cube, 12, "solid by a program"), 1000, 12);
  this->ExpectVolume("padded.stl", BinaryStl(cube, 12) + "\n", 1000, 12);
  Body half = cube;
  half.Faces.resize(6);
  EXPECT_THAT(this->Refusal("half.stl", BinaryStl(half, 12)),
    HasSubstr("of 12 triangles, as its header says, found 384 bytes, which hold 6"));
  EXPECT_THAT(this->Refusal("six.stl", BinaryStl(cube, 6)), HasSubstr("hold 12"));
  EXPECT_THAT(this->Refusal("short.stl", std::string(50, '\1')), HasSubstr("the end of the file"));
}

TEST_F(SurfaceFiles, WhatAFileHoldsInsteadIsNamed)
{
  EXPECT_THAT(this->Refusal("cube.stl", "# by a program\n" + Obj(Cube())),
    HasSubstr("cube.stl: expected a mesh in STL, found a text that begins with '# by a program'"));
  const std::string points = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
                             "property float y\nproperty float z\n";
  EXPECT_THAT(this->Refusal("cloud.ply", points + "end_header\n0 0 0\n1 0 0\n"),
    HasSubstr("cloud.ply: expected a mesh, found 2 points without cells"));
  this->ExpectVolume("faces-first.ply",
    "ply\nformat ascii 1.0\nelement face 4\nproperty list uint8 int64 vertex_indices\n"
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n0 0 0\n6 0 0\n0 1 0\n0 0 1\n",
    1, 4);
  EXPECT_THAT(this->Refusal("strips.ply",
                points + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"),
    HasSubstr("strips.ply: expected faces, found triangle strips"));
}

TEST_F(SurfaceFiles, AxesThatAHeaderNamesAreTold)
{
  const std::string ras = "3D Slicer output. SPACE=RAS";
  const Body cube = Triangulated(Cube());
  for (const auto& [name, bytes] : { std::pair{ "binary.stl", BinaryStl(cube, 12, ras) },
         { "text.stl", TextStl(cube, ras) }, { "mesh.obj", "# " + ras + "\n" + Obj(cube) } })
  {
    const Reading reading = this->Read(name, bytes);
    EXPECT_THAT(reading.Told, HasSubstr("its header says SPACE=RAS")) << name;
    EXPECT_NEAR(VolumeOf(reading.Surface), 1000, 1e-6) << name;
  }
  this->ExpectVolume("lps.stl", TextStl(cube, "3D Slicer output. SPACE=LPS"), 1000, 12);
}

TEST_F(SurfaceFiles, CoordinatesAreReadAsDoubles)
{
  // 894 m away floats are 0.06 mm apart.
  const Body far = Cube({ 894000.123, 100000.5, 0.25 });
  const std::pair<const char*, std::string> files[] = { { "far.stl", TextStl(Triangulated(far)) },
    { "far.obj", Obj(far) }, { "text.ply", Ply(far, "ascii", false) },
    { "little.ply", Ply(far, "binary_little_endian", true) },
    { "big.ply", Ply(far, "binary_big_endian", true) } };
  for (const auto& [name, bytes] : files)
  {
    const Reading reading = this->Read(name, bytes);
    double least = 1e9;
    for (std::size_t point = 0; point < reading.Surface.NumberOfPoints(); ++point)
    {
      least = std::min(least, reading.Surface.Point(point)[0]);
    }
    EXPECT_EQ(least, 894000.123) << name;
    EXPECT_EQ(reading.Told, "") << name;
  }
  for (const auto& [name, bytes] : { std::pair{ "far.stl", BinaryStl(Triangulated(far), 12) },
         std::pair{ "far.ply", Ply(far, "binary_little_endian", false) } })
  {
    EXPECT_THAT(this->Read(name, bytes).Told,
      HasSubstr("are floats up to 894010 from the origin, rounded by up to 0.0532"))
      << name;
  }
}

TEST_F(SurfaceFiles, PolygonsAreCutIntoTriangles)
{
  for (const bool isDouble : { false, true })
  {
    for (const char* const format : { "ascii", "binary_little_endian", "binary_big_endian" })
    {
      this->ExpectVolume("cube.ply", Ply(Cube(), format, isDouble), 1000, 12);
      this->ExpectVolume("angle.ply", Ply(Angle(), format, isDouble), 3000, 20);
    }
  }
  this->ExpectVolume("cube.obj", Obj(Cube()), 1000, 12);
  this->ExpectVolume("angle.obj", Obj(Angle()), 3000, 20);
  // The concave corner is outside: no triangle has its centre there.
  const SurfaceMesh angle = this->Read("angle.obj", Obj(Angle())).Surface;
  for (std::size_t triangle = 0; triangle < angle.NumberOfTriangles(); ++triangle)
  {
    const Vector3 centre = (1.0 / 3) *
      (angle.Corner(triangle, 0) + angle.Corner(triangle, 1) + angle.Corner(triangle, 2));
    EXPECT_FALSE(centre[0] > 10.001 && centre[1] > 10.001) << triangle;
  }
  EXPECT_THAT(this->Refusal("cut.ply", Ply(Cube(), "binary_little_endian", false).substr(0, 400)),
    HasSubstr("the end of the file"));
  EXPECT_THAT(this->Refusal("more.ply", Ply(Cube(), "binary_little_endian", false, 3)),
    HasSubstr("what else its header counts, found more"));
  Body wrong = Cube();
  wrong.Faces[4][1] = 70000;
  EXPECT_THAT(this->Refusal("wrong.ply", Ply(wrong, "ascii", false)),
    HasSubstr("face 4 of 6: expected 0 to 7, found 70000"));
}

TEST_F(SurfaceFiles, LinesEndInAnyOfThreeWays)
{
  const Body triangles = Triangulated(Cube());
  for (const std::string end : { "\r", "\r\n", "\n" })
  {
    const auto ended = [&end](std::string text)
    {
      for (std::size_t at = text.find('\n'); at != std::string::npos;
           at = text.find('\n', at + end.size()))
      {
        text.replace(at, 1, end);
      }
      return text;
    };
    this->ExpectVolume("a.obj", ended(Obj(Cube())), 1000, 12);
    this->ExpectVolume("a.stl", ended(TextStl(triangles)), 1000, 12);
    this->ExpectVolume("a.ply", ended(Ply(Cube(), "ascii", true)), 1000, 12);
    EXPECT_NEAR(FromGrid(ReadMesh(this->Folder.Write("a.msh", ended(Gmsh4())))).CellVolume(0),
      1.0 / 6, 1e-12);
    EXPECT_THAT(this->Refusal("a.obj", ended(Obj(Cube()) + "f 1 2 99\n")),
      HasSubstr("a.obj: line 15: expected vertices 1 to 8"));
    EXPECT_THAT(
      this->Refusal("a.stl", ended("solid\n\nfacet normal 0 0 1\nouter loop\nvertex 0 a 0\n")),
      HasSubstr("a.stl: line 5: expected three numbers"));
  }
}

TEST_F(SurfaceFiles, OnlyPlacesOfVerticesNeedBeNumbers)
{
  const std::string header = "element vertex 8\nproperty float x\nproperty float y\nproperty float "
                             "z\nproperty float distance\nproperty list uchar float weights\n"
                             "element face 6\nproperty list uchar int vertex_indices\nproperty "
                             "double quality\nend_header\n";
  std::string text = "ply\nformat ascii 1.0\n" + header;
  std::string binary = "ply\nformat binary_little_endian 1.0\n" + header;
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vector3& point : Cube().Points)
  {
    text += Numbers(point) + " nan 2 -nan(ind) inf\n";
    for (const double number : point)
    {
      binary += Bytes(static_cast<float>(number));
    }
    binary += Bytes(nan) + '\2' + Bytes(nan) + Bytes(nan);
  }
  for (const Polygon& face : Cube().Faces)
  {
    text += "4";
    binary += '\4';
    for (const int corner : face)
    {
      text += " " + std::to_string(corner);
      binary += Bytes(static_cast<std::int32_t>(corner));
    }
    text += " NaN\n";
    binary += Bytes(static_cast<double>(nan));
  }
  this->ExpectVolume("text.ply", text, 1000, 12);
  this->ExpectVolume("binary.ply", binary, 1000, 12);
  EXPECT_THAT(this->Refusal("cut.ply", text.substr(0, text.size() - 5)),
    HasSubstr("expected face 5 of 6, found the end of the file"));
  std::string coloured = Obj(Cube());
  for (std::size_t end = coloured.find("\nf"); end != std::string::npos;
       end = coloured.rfind("\nv", end - 1))
  {
    coloured.insert(end, " 1 nan nan nan");
  }
  this->ExpectVolume("coloured.obj", coloured, 1000, 12);
  const std::size_t place = text.find("end_header\n") + 11;
  EXPECT_THAT(this->Refusal("place.ply", text.replace(place, text.find(' ', place) - place, "nan")),
    HasSubstr("expected vertex 0 of 8, found 'nan'"));
}

TEST_F(SurfaceFiles, WhatAnObjHasBesideItsFacesIsPassedOver)
{
  std::string textures = "vn 0 0 1\n";
  for (int number = 0; number < 14; ++number)
  {
    textures += "vt 0." + std::to_string(number) + " 0\n";
  }
  const std::string plain = Obj(Cube());
  this->ExpectVolume("texture.obj", textures + Obj(Cube(), "/14/1"), 1000, 12);
  this->ExpectVolume("normals.obj", textures + Obj(Cube(), "//1"), 1000, 12);
  this->ExpectVolume("looks.obj",
    "\xef\xbb\xbfmtllib a.mtl\no box\ng side\nusemtl red\ns off\n" + plain + "l 1 2 3\np 4\n", 1000,
    12);
  std::string backwards;
  for (const Vector3& point : Cube().Points)
  {
    backwards += "v " + Numbers(point) + " 0.1 0.2 0.3\n";
  }
  for (const Polygon& face : Cube().Faces)
  {
    backwards += "f";
    for (const int corner : face)
    {
      backwards += " \\\r\n " + std::to_string(corner - 8);
    }
    backwards += " # back\n";
  }
  this->ExpectVolume("backwards.obj", backwards, 1000, 12);
  EXPECT_THAT(this->Read("form.obj", plain + "surf 0 1 0 1 1 2 3 4\nend\n").Told,
    HasSubstr("form.obj: left out 1 free-form surface(s)"));
  EXPECT_THAT(this->Refusal("wrong.obj", plain + "f 1 2 99\n"),
    HasSubstr("wrong.obj: line 15: expected vertices 1 to 8, found 99"));
  EXPECT_THAT(this->Refusal("wrong.obj", plain + "f 1 2\n"), HasSubstr("three vertices"));
  EXPECT_THAT(this->Refusal("wrong.obj", plain + "f 1 a 2\n"), HasSubstr("numbers of vertices"));
}

TEST_F(SurfaceFiles, PhysicalGroupsOfGmshAreMaterials)
{
  const auto read = [this](const std::string& bytes, std::vector<std::string>& names)
  {
    NoteKeeper notes;
    const TetrahedralMesh mesh = FromGrid(ReadMesh(this->Folder.Write("a.msh", bytes)), &names);
    return std::pair{ mesh, Joined(notes.Lines()) };
  };
  std::vector<std::string> names;
  const std::string side = "1 2 2 7 1 3 13 23\n";
  const std::string fat = "2 4 2 5 1 3 13 23 33\n";
  const std::string gland = "3 4 2 12 2 13 43 23 33\n";
  auto [mesh, told] = read(Gmsh2("3\n" + side + fat + gland), names);
  EXPECT_THAT(names, testing::ElementsAre("air", "fat tissue", "gland"));
  EXPECT_THAT(mesh.Materials, testing::ElementsAre(1, 2));
  EXPECT_NEAR(mesh.CellVolume(0), 1.0 / 6, 1e-12);
  EXPECT_NEAR(mesh.CellVolume(1), 1.0 / 3, 1e-12);
  EXPECT_THAT(told, HasSubstr("left out 1 cells that are no volumes (triangle)"));
  for (const std::string& bytes : { Gmsh4(), Gmsh4Binary() })
  {
    mesh = read(bytes, names).first;
    EXPECT_THAT(names, testing::ElementsAre("air", "fat", "gland"));
    EXPECT_THAT(mesh.Materials, testing::ElementsAre(2, 1));
    EXPECT_NEAR(mesh.CellVolume(0), 1.0 / 6, 1e-12);
    EXPECT_NEAR(mesh.CellVolume(1), 1.0 / 3, 1e-12);
  }
  // Without groups there is one material; air is no tissue.
  mesh = read(Gmsh2("2\n2 4 2 0 1 3 13 23 33\n3 4 2 0 2 13 43 23 33\n"), names).first;
  EXPECT_THAT(names, testing::IsEmpty());
  EXPECT_THAT(mesh.Materials, testing::ElementsAre(1, 1));
  // Groups without names are materials by their numbers.
  std::string numbered = Gmsh2("2\n2 4 2 2 1 3 13 23 33\n3 4 2 1 2 13 43 23 33\n");
  std::tie(mesh, told) = read(numbered, names);
  EXPECT_THAT(names, testing::IsEmpty());
  EXPECT_THAT(mesh.Materials, testing::ElementsAre(2, 1));
  EXPECT_THAT(told, HasSubstr("a.msh: its physical groups have no names"));
  std::string air = Gmsh2("2\n" + fat + gland);
  air.replace(air.find("gland"), 5, "Air");
  mesh = read(air, names).first;
  EXPECT_EQ(mesh.NumberOfCells(), 1u);
  EXPECT_EQ(mesh.NumberOfPoints(), 5u);

  EXPECT_THAT(this->Refusal("a.msh", Gmsh2("2\n" + fat + "3 4 2 0 2 13 43 23 33\n")),
    HasSubstr("expected every volume in a physical group, found 1 elements in none"));
  EXPECT_THAT(this->Refusal("a.msh", Gmsh2("1\n2 5 2 5 1 3 13 23 33 43 3 13 23\n")),
    HasSubstr("a.msh: cell 0: expected a tetrahedron, found a hexahedron"));
  EXPECT_THAT(this->Refusal("a.msh", Gmsh2("1\n2 4 2 5 1 3 13 23 34\n")), HasSubstr("node 34"));
  EXPECT_THAT(this->Refusal("a.msh", Gmsh4Binary().substr(0, 700)), HasSubstr("a.msh: "));
  EXPECT_THAT(this->Refusal("a.msh", "$MeshFormat\n1 0 8\n$EndMeshFormat\n"),
    HasSubstr("expected version 2.2 or 4.1 of a mesh of gmsh, found 1"));
  EXPECT_THAT(this->Refusal("a.msh", "$NOD\n0\n$ENDNOD\n"), HasSubstr("found version 1"));
  const std::string comments = "$Comments\nby a test\n$EndComments\n";
  EXPECT_EQ(read(comments + Gmsh4(), names).first.NumberOfCells(), 2u);
}

TEST_F(SurfaceFiles, TheSidesOfAGmshFileAreASurface)
{
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n";
  const Body cube = Cube();
  for (std::size_t point = 0; point < 8; ++point)
  {
    text += std::to_string(point + 1) + " " + Numbers(cube.Points[point]) + "\n";
  }
  text += "$EndNodes\n$Elements\n6\n";
  for (const Polygon& face : cube.Faces)
  {
    text += "1 3 2 1 1";
    for (const int corner : face)
    {
      text += " " + std::to_string(corner + 1);
    }
    text += "\n";
  }
  const std::string path = this->Folder.Write("cube.msh", text + "$EndElements\n");
  EXPECT_NEAR(VolumeOf(ReadSurface(path)), 1000, 1e-9);
  const MeshOrSurface surface = ReadMeshOrSurface(path);
  EXPECT_FALSE(surface.Volume);
  EXPECT_NEAR(VolumeOf(surface.Surface), 1000, 1e-9);
  EXPECT_THAT(test::RefusalOf([&] { ReadMesh(path); }),
    HasSubstr("expected tetrahedra, found cells that are no volumes (quad)"));
  const std::string volumes = this->Folder.Write("volumes.msh", Gmsh4());
  const MeshOrSurface mesh = ReadMeshOrSurface(volumes);
  ASSERT_TRUE(mesh.Volume);
  EXPECT_EQ(mesh.Volume->GetNumberOfCells(), ReadMesh(volumes)->GetNumberOfCells());
  EXPECT_EQ(mesh.Surface.NumberOfTriangles(), 0u);
  EXPECT_THAT(test::RefusalOf([&] { ReadSurface(volumes); }),
    HasSubstr("expected a surface, found a mesh of volumes (tetrahedron)"));
}

TEST_F(SurfaceFiles, CellsThatAreNoTetrahedraAreTold)
{
  const auto grid = [](const std::string& cells, int count, int numbers, const std::string& types,
                      const std::string& materials)
  {
    return "# vtk DataFile Version 3.0\nby a test\nASCII\nDATASET UNSTRUCTURED_GRID\n"
           "POINTS 10 double\n0 0 0 1 0 0 0 1 0 0 0 1 .5 0 0 .5 .5 0 0 .5 0 0 0 .5 .5 0 .5 0 .5 "
           ".5\nCELLS " +
      std::to_string(count) + " " + std::to_string(numbers) + "\n" + cells + "CELL_TYPES " +
      std::to_string(count) + "\n" + types + "\nCELL_DATA " + std::to_string(count) +
      "\nSCALARS Material int 1\nLOOKUP_TABLE default\n" + materials + "\n";
  };
  const auto read = [this](const std::string& bytes)
  {
    NoteKeeper notes;
    const TetrahedralMesh mesh = FromGrid(ReadMesh(this->Folder.Write("a.vtk", bytes)));
    return std::pair{ mesh, Joined(notes.Lines()) };
  };
  const auto [mixed, told] =
    read(grid("3 0 1 2\n2 0 1\n4 0 1 2 3\n", 3, 12, "5\n3\n10", "7\n8\n9"));
  EXPECT_THAT(mixed.Materials, testing::ElementsAre(9));
  EXPECT_EQ(mixed.NumberOfPoints(), 4u);
  EXPECT_THAT(told, HasSubstr("a.vtk: left out 1 cells that are no volumes (line)"));
  EXPECT_THAT(told, HasSubstr("(triangle)"));
  const auto [straight, by] = read(grid("10 0 1 2 3 4 5 6 7 8 9\n", 1, 11, "24", "3"));
  EXPECT_NEAR(straight.CellVolume(0), 1.0 / 6, 1e-12);
  EXPECT_EQ(straight.NumberOfPoints(), 4u);
  EXPECT_THAT(by, HasSubstr("1 quadratic tetrahedra are taken with straight edges"));
  EXPECT_THAT(this->Refusal("hex.vtk",
                grid("20 0 1 2 3 4 5 6 7 8 9 0 1 2 3 4 5 6 7 8 9\n", 1, 21, "25", "3")),
    HasSubstr("hex.vtk: cell 0: expected a tetrahedron, found a quadratic hexahedron"));
}
