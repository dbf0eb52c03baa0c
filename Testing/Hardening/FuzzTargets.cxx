// SPDX-License-Identifier: Apache-2.0
#include "FuzzTargets.h"

#include "Private/AttenuationTableIO.h"
#include "Private/Guard/GuardedRead.h"
#include "Private/Guard/MeshParcel.h"
#include "Private/SpectrumIO.h"
#include "Private/StoredVoxels.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/DicomHeader.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/ScratchFolder.h"

#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace mammoray::hardening
{
namespace
{
using Target = std::function<void(const std::string& bytes)>;

[[noreturn]] void Fail(const std::string& why)
{
  std::fprintf(stderr, "not one printable line of our own: %s\n", why.c_str());
  std::abort();
}

Target Refusing(const Target& target)
{
  return [target](const std::string& bytes)
  {
    try
    {
      target(bytes);
    }
    catch (const Error& error)
    {
      if (Printable(error.what()) != error.what())
      {
        Fail(error.what());
      }
    }
    catch (const std::exception& error)
    {
      Fail(error.what());
    }
  };
}

/// A reader of files.
Target OfFile(const std::string& name, const std::function<void(const std::string& path)>& read)
{
  return Refusing(
    [name, read](const std::string& bytes)
    {
      static const ScratchFolder folder;
      const std::string path = folder.File(name);
      std::ofstream(path, std::ios::binary) << bytes;
      read(path);
    });
}

/// A header in text, its sizes, and that its voxels are there.
Target OfHeader(const char* name, TextHeader (*read)(const std::string&), const char* sizes,
  StoredVoxels (*voxelsOf)(const TextHeader&))
{
  return OfFile(name,
    [read, sizes, voxelsOf](const std::string& path)
    {
      const TextHeader header = read(path);
      header.CheckSizes(sizes);
      const StoredVoxels voxels = voxelsOf(header);
      for (const std::uint64_t count : { 1, 1000 })
      {
        voxels.CheckPresent(voxels.Path, count, 2);
      }
    });
}

template <typename Mesh>
void Unpack(const std::string& bytes)
{
  ParcelReader parcel(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), "a mesh");
  vtkNew<Mesh> mesh;
  UnpackMesh(parcel, "a mesh", mesh);
}
}

const std::map<std::string, Target>& FuzzTargets()
{
  ReadWithoutGuard();
  static const std::map<std::string, Target> targets{
    { "attenuation", OfFile("a.csv", [](const std::string& path) { ReadAttenuationTable(path); }) },
    { "dicom-header", OfFile("a.dcm", [](const std::string& path) { ReadDicomHeader(path); }) },
    { "dicom-segmentation",
      OfFile("a.dcm", [](const std::string& path) { ReadLabelVolume(path); }) },
    { "materials", OfFile("a.json", [](const std::string& path) { ReadMaterialTable(path); }) },
    { "metaimage",
      OfHeader("a.mha", TextHeader::ReadMetaImage, "dimsize", StoredVoxels::OfMetaImage) },
    { "nrrd", OfHeader("a.nrrd", TextHeader::ReadNrrd, "sizes", StoredVoxels::OfNrrd) },
    { "parcel-grid", Refusing(Unpack<vtkUnstructuredGrid>) },
    { "parcel-surface", Refusing(Unpack<vtkPolyData>) },
    { "printable",
      [](const std::string& bytes)
      {
        if (const std::string shown = Printable(bytes); Printable(shown) != shown)
        {
          Fail(shown);
        }
      } },
    { "spectrum", OfFile("a.spc", [](const std::string& path) { ReadSpectrum(path); }) },
  };
  return targets;
}
}
