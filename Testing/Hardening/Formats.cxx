// SPDX-License-Identifier: Apache-2.0
#include "Formats.h"

#include "DicomBytes.h"
#include "Files.h"
#include "GlbBytes.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MammogramPictureIO.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"

#include "vtkImageData.h"
#include "vtkJPEGWriter.h"
#include "vtkMetaImageWriter.h"
#include "vtkNew.h"
#include "vtkPLYWriter.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSTLWriter.h"
#include "vtkUnstructuredGrid.h"
#include "vtkUnstructuredGridWriter.h"
#include "vtkXMLUnstructuredGridWriter.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace mammoray::hardening
{
namespace
{
LabelVolume SomeLabels()
{
  LabelVolume volume;
  volume.Size = { 9, 8, 7 };
  volume.Spacing = { 1, 1.5, 2 };
  volume.Origin = { -10, 20, 5 };
  for (std::size_t voxel = 0; voxel < 9 * 8 * 7; ++voxel)
  {
    volume.Voxels.push_back(static_cast<std::uint16_t>(voxel % 5));
  }
  return volume;
}

IntensityVolume SomeIntensities()
{
  IntensityVolume volume;
  const LabelVolume labels = SomeLabels();
  static_cast<VolumeGrid&>(volume) = labels;
  volume.Voxels.assign(labels.Voxels.begin(), labels.Voxels.end());
  return volume;
}

/// A cube of 27 points, each of its 8 boxes in five tetrahedra.
TetrahedralMesh SomeMesh()
{
  TetrahedralMesh mesh;
  for (int point = 0; point < 27; ++point)
  {
    mesh.Points.insert(mesh.Points.end(),
      { 1.0 * (point % 3), 1.0 * (point / 3 % 3), 1.0 * (point / 9) });
  }
  for (int box = 0; box < 8; ++box)
  {
    const int first = box % 2 + 3 * (box / 2 % 2) + 9 * (box / 4);
    for (const auto& corners : { std::array{ 0, 1, 3, 9 }, std::array{ 1, 4, 3, 13 },
           std::array{ 1, 10, 9, 13 }, std::array{ 3, 9, 12, 13 }, std::array{ 1, 3, 9, 13 } })
    {
      for (const int corner : corners)
      {
        mesh.Cells.push_back(first + corner);
      }
      mesh.Materials.push_back(1 + box % 2);
      if (mesh.CellVolume(mesh.NumberOfCells() - 1) < 0)
      {
        std::swap(mesh.Cells.back(), mesh.Cells[mesh.Cells.size() - 2]);
      }
    }
  }
  return mesh;
}

SurfaceMesh SomeSurface()
{
  SurfaceMesh surface;
  surface.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  surface.Triangles = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
  surface.FrontMaterials.assign(4, 0);
  surface.BackMaterials.assign(4, 1);
  return surface;
}

Mammogram SomeMammogram()
{
  Mammogram mammogram;
  mammogram.Columns = 40;
  mammogram.Rows = 50;
  for (int pixel = 0; pixel < 40 * 50; ++pixel)
  {
    mammogram.Pixels.push_back(static_cast<float>(pixel % 977));
  }
  mammogram.View = "CC";
  mammogram.Laterality = 'L';
  mammogram.RowDirection = "A";
  mammogram.ColumnDirection = "R";
  mammogram.BodyPartThicknessMm = 50;
  mammogram.SourceToDetectorMm = 650;
  return mammogram;
}

/// Of a tomosynthesis, its source 200 mm to each side.
std::vector<Mammogram> SomeProjections()
{
  std::vector<Mammogram> projections(3, SomeMammogram());
  for (std::size_t number = 0; number < projections.size(); ++number)
  {
    projections[number].SourceFootPixel = { -0.5, 24.5 + 2000 * (static_cast<double>(number) - 1) };
  }
  return projections;
}

vtkNew<vtkImageData> SomePicture(int type, int columns, int rows)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(columns, rows, 1);
  image->AllocateScalars(type, 1);
  for (vtkIdType pixel = 0; pixel < image->GetNumberOfPoints(); ++pixel)
  {
    image->GetPointData()->GetScalars()->SetComponent(pixel, 0, static_cast<double>(pixel % 251));
  }
  return image;
}

template <typename Writer, typename Input, typename Settings>
void WriteBy(Input* input, const std::string& path, const Settings& settings)
{
  vtkNew<Writer> writer;
  writer->SetInputData(input);
  writer->SetFileName(path.c_str());
  settings(writer.Get());
  writer->Write();
}

void ReadVolumeMesh(const std::string& path)
{
  std::vector<std::string> names;
  FromGrid(ReadMesh(path), &names).Validate(path);
}

void ReadSurfaceMesh(const std::string& path)
{
  std::vector<std::string> names;
  ReadSurface(path, &names).Validate(path);
}

void ReadPictureOfBreast(const std::string& path)
{
  ReadMammogramPicture(path, { .PixelSpacingMm = 0.1, .View = "CC", .Laterality = 'L' });
}

/// Two slices of 8 x 6 pixels of one segment: bits, fractions of 200 or, with `isMap`, its number.
std::string SegmentationBytes(std::uint32_t bits = 1, bool isMap = false)
{
  using namespace test;
  std::vector<std::string> groups;
  for (const char* const place : { "0\\0\\5", "0\\0\\7" })
  {
    groups.push_back(Sequence(0x20, 0x9113, { Element(0x20, 0x32, "DS", place) }) +
      Sequence(0x62, 0xa, { Element(0x62, 0xb, "US", Us(1)) }));
  }
  const std::string shared =
    Sequence(0x20, 0x9116, { Element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") }) +
    Sequence(0x28, 0x9110,
      { Element(0x18, 0x88, "DS", "2") + Element(0x28, 0x30, "DS", "0.5\\0.5") });
  const std::string storage = "1.2.840.10008.5.1.4.1.1.66.4";
  return DicomBytes(storage, "1.2.4",
    Element(8, 0x16, "UI", storage) + Element(8, 0x18, "UI", "1.2.4") +
      Element(8, 0x60, "CS", "SEG") + Element(0x28, 2, "US", Us(1)) +
      Element(0x28, 4, "CS", "MONOCHROME2") + Element(0x28, 8, "IS", "2") +
      Element(0x28, 0x10, "US", Us(6)) + Element(0x28, 0x11, "US", Us(8)) +
      Element(0x28, 0x100, "US", Us(bits)) + Element(0x28, 0x101, "US", Us(bits)) +
      Element(0x28, 0x102, "US", Us(bits - 1)) + Element(0x28, 0x103, "US", Us(0)) +
      (isMap ? Element(0x62, 1, "CS", "LABELMAP") : "") +
      Sequence(0x62, 2, { Element(0x62, 4, "US", Us(1)) + Element(0x62, 5, "LO", "gland") }) +
      (bits == 8 && !isMap ? Element(0x62, 0xe, "US", Us(200)) : "") +
      Sequence(0x5200, 0x9229, { shared }) + Sequence(0x5200, 0x9230, groups) +
      Element(0x7fe0, 0x10, "OB",
        bits == 1 ? "MammoRay seg"
                  : std::string(48, isMap ? '\1' : '\xc8') + std::string(48, '\0')));
}

/// 4 x 3 x 2 voxels whose sform is sheared and whose qform is another.
std::string NiftiBytes()
{
  std::string bytes(352 + 24, '\1');
  std::fill_n(bytes.begin(), 352, '\0');
  const auto put = [&bytes](std::size_t offset, auto value)
  { std::memcpy(bytes.data() + offset, &value, sizeof value); };
  put(0, std::int32_t{ 348 });
  for (const auto& [offset, value] : { std::pair{ 40, 3 }, { 42, 4 }, { 44, 3 }, { 46, 2 },
         { 70, 2 }, { 72, 8 }, { 252, 2 }, { 254, 1 } })
  {
    put(static_cast<std::size_t>(offset), static_cast<std::int16_t>(value));
  }
  for (const auto& [offset, value] : { std::pair{ 76, 1.F }, { 80, 1.F }, { 84, 1.F }, { 88, 2.F },
         { 108, 352.F }, { 268, 5.F }, { 280, 1.F }, { 284, 0.1F }, { 300, 1.F }, { 320, 2.F } })
  {
    put(static_cast<std::size_t>(offset), value);
  }
  bytes[123] = 2;
  std::memcpy(bytes.data() + 344, "n+1", 4);
  return bytes;
}

/// Two layers of 2 x 2 x 1 voxels, as 3D Slicer writes them.
std::string LayersBytes()
{
  return "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 2 2 1\n"
         "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\n"
         "encoding: raw\nspace origin: (0,0,0)\nSegment0_Name:=fat\nSegment0_LabelValue:=1\n"
         "Segment0_Layer:=0\nSegment1_Name:=gland\nSegment1_LabelValue:=1\nSegment1_Layer:=1\n\n" +
    std::string("\1\0\1\1\0\1\0\0", 8);
}

/// Writes what is read as volumes, labels and meshes.
void WriteVolumes(
  const std::function<std::string(const std::string&, void (*)(const std::string&))>& place)
{
  const auto labels = [](const std::string& path) { ReadLabelVolume(path); };
  const auto intensities = [](const std::string& path) { ReadIntensityVolume(path); };
  WriteLabelVolume(SomeLabels(), place("labels.nrrd", labels));
  WriteLabelVolume(SomeLabels(), place("labels.mha", labels));
  WriteLabelVolume(SomeLabels(), place("labels.nii.gz", labels));
  std::ofstream(place("forms.nii", labels), std::ios::binary) << NiftiBytes();
  std::ofstream(place("image.nii", intensities), std::ios::binary) << NiftiBytes();
  std::ofstream(place("layers.seg.nrrd", labels), std::ios::binary) << LayersBytes();
  WriteIntensityVolume(SomeIntensities(), place("volume.nrrd", intensities));
  vtkNew<vtkImageData> image;
  image->SetDimensions(9, 8, 7);
  image->AllocateScalars(VTK_SHORT, 1);
  image->GetPointData()->GetScalars()->Fill(3);
  WriteBy<vtkMetaImageWriter>(image.Get(), place("raw.mha", intensities),
    [](auto* writer) { writer->SetCompression(false); });
}

void WriteMeshes(
  const std::function<std::string(const std::string&, void (*)(const std::string&))>& place)
{
  const auto grid = ToGrid(SomeMesh(), { "air", "fat", "gland" });
  const auto surface = ToPolyData(SomeSurface(), { "air", "fat" });
  WriteMesh(grid, place("mesh.vtu", ReadVolumeMesh));
  WriteBy<vtkXMLUnstructuredGridWriter>(grid.Get(), place("text.vtu", ReadVolumeMesh),
    [](auto* writer) { writer->SetDataModeToAscii(); });
  WriteBy<vtkUnstructuredGridWriter>(grid.Get(), place("text.vtk", ReadVolumeMesh),
    [](auto* writer) { writer->SetFileTypeToASCII(); });
  WriteBy<vtkUnstructuredGridWriter>(grid.Get(), place("binary.vtk", ReadVolumeMesh),
    [](auto* writer) { writer->SetFileTypeToBinary(); });
  for (const char* const name : { "surface.vtp", "surface.stl", "surface.ply", "surface.obj" })
  {
    WriteMesh(surface, place(name, ReadSurfaceMesh));
  }
  std::ofstream(place("scene.glb", ReadSurfaceMesh), std::ios::binary) << test::GlbOfTetrahedron();
  WriteBy<vtkPLYWriter>(surface.Get(), place("text.ply", ReadSurfaceMesh),
    [](auto* writer) { writer->SetFileTypeToASCII(); });
  std::ofstream(place("text.msh", ReadVolumeMesh))
    << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 5 \"fat\"\n"
       "$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
       "$Elements\n2\n1 2 2 7 1 1 2 3\n2 4 2 5 1 1 2 3 4\n$EndElements\n";
  WriteBy<vtkSTLWriter>(surface.Get(), place("text.stl", ReadSurfaceMesh),
    [](auto* writer) { writer->SetFileTypeToASCII(); });
}

void WritePictures(
  const std::function<std::string(const std::string&, void (*)(const std::string&))>& place)
{
  const auto nothing = [](auto*) {};
  const auto mask = [](const std::string& path) { ReadMask(path, 20, 30); };
  WriteBy<vtkPNGWriter>(SomePicture(VTK_UNSIGNED_CHAR, 40, 50).Get(),
    place("picture8.png", ReadPictureOfBreast), nothing);
  WriteBy<vtkPNGWriter>(SomePicture(VTK_UNSIGNED_SHORT, 40, 50).Get(),
    place("picture16.png", ReadPictureOfBreast), nothing);
  WriteBy<vtkJPEGWriter>(SomePicture(VTK_UNSIGNED_CHAR, 40, 50).Get(),
    place("picture.jpg", ReadPictureOfBreast), nothing);
  WriteBy<vtkPNGWriter>(SomePicture(VTK_UNSIGNED_CHAR, 20, 30).Get(), place("mask.png", mask),
    nothing);
  WriteBy<vtkMetaImageWriter>(SomePicture(VTK_UNSIGNED_CHAR, 20, 30).Get(), place("mask.mha", mask),
    nothing);
  WriteBy<vtkMetaImageWriter>(SomePicture(VTK_FLOAT, 20, 30).Get(),
    place("floats.mha", [](const std::string& path) { ReadFloatPicture(path, 20, 30); }), nothing);
}
}

std::vector<Format> MakeFormats(const std::string& folder)
{
  std::vector<Format> formats;
  const auto place = [&](const std::string& name, void (*read)(const std::string&))
  {
    formats.push_back({ name, "", read, name.ends_with(".dcm") });
    return folder + "/" + name;
  };
  WriteVolumes(place);
  WriteMeshes(place);
  WritePictures(place);
  WriteMammogram(SomeMammogram(), {},
    place("mammogram.dcm", [](const std::string& path) { ReadMammogram(path); }));
  WriteProjections(SomeProjections(), {}, 40,
    place("projections.dcm", [](const std::string& path) { ReadProjections(path); }));
  WriteMrSeries(SomeIntensities(), {},
    { place("slice.dcm", [](const std::string& path) { ReadIntensitySeries({ path }); }),
      folder + "/2.dcm", folder + "/3.dcm", folder + "/4.dcm", folder + "/5.dcm", folder + "/6.dcm",
      folder + "/7.dcm" });
  std::filesystem::copy_file(folder + "/slice.dcm",
    place("header.dcm", [](const std::string& path) { ReadDicomHeader(path); }));
  std::ofstream(place("segments.dcm", [](const std::string& path) { ReadLabelVolume(path); }),
    std::ios::binary)
    << SegmentationBytes();
  std::ofstream(place("fractions.dcm", [](const std::string& path) { ReadLabelVolume(path); }),
    std::ios::binary)
    << SegmentationBytes(8);
  std::ofstream(place("map.dcm", [](const std::string& path) { ReadLabelVolume(path); }),
    std::ios::binary)
    << SegmentationBytes(8, true);
  const std::string data = test::DataFolder();
  std::filesystem::copy_file(data + "/materials/victre.json",
    place("materials.json", [](const std::string& path) { ReadMaterialTable(path); }));
  std::filesystem::copy_file(data + "/spectra/W28kVp_Rh50um_Be1mm.spc",
    place("spectrum.spc", [](const std::string& path) { FindSpectrum(path); }));
  std::ofstream(place("spectrum.csv", [](const std::string& path) { FindSpectrum(path); }))
    << "E [keV];N per keV;centre\n10,5;1,0\n11,5;2,5\n13,0;0,5\n";
  for (Format& format : formats)
  {
    format.Bytes = test::ReadFile(folder + "/" + format.Name);
  }
  return formats;
}
}
