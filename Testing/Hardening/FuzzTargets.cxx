// SPDX-License-Identifier: Apache-2.0
#include "FuzzTargets.h"

#include "OptionList.h"
#include "Private/AttenuationTableIO.h"
#include "Private/Checkpoint.h"
#include "Private/LabelNames.h"
#include "Private/SpectrumIO.h"
#include "Private/StoredVoxels.h"
#include "Private/VolumePlacement.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Dicom/DicomNetwork.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/SceneIO.h"
#include "mammoray/IO/ScratchFolder.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/Study/StudyAnswers.h"
#include "mammoray/XRay/Composition.h"

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace mammoray::hardening
{
namespace
{
[[noreturn]] void Fail(const std::string& why)
{
  std::fprintf(stderr, "not one printable line of our own: %s\n", why.c_str());
  std::abort();
}

FuzzTarget Refusing(const std::function<void(const std::string& bytes)>& read)
{
  return [read](const std::string& bytes) -> std::string
  {
    NoteKeeper notes; // of which each would be kept as said
    try
    {
      read(bytes);
      return {};
    }
    catch (const Error& error)
    {
      if (EscapeControls(error.what()) != error.what())
      {
        Fail(error.what());
      }
      return error.what();
    }
    catch (const std::exception& error)
    {
      Fail(error.what());
    }
  };
}

/// A reader of files.
FuzzTarget OfFile(const std::string& name, const std::function<void(const std::string& path)>& read)
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
FuzzTarget OfHeader(const char* name, TextHeader (*read)(const std::string&), const char* sizes,
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

/// A result folder that holds this result.json; the one of a mammogram has it, too.
void ReadResult(const std::string& path)
{
  ReadResultFiles(std::filesystem::path(path).parent_path().string());
}

/// Options of every kind.
struct CaseArguments
{
  std::string Text;
  std::string File;
  double Number = 0;
  std::vector<double> Numbers;
  bool Flag = false;
};

void DeclareCase(const OptionList& add, CaseArguments& arguments)
{
  add("--name", arguments.Text, "a text");
  add.Input("--input", arguments.File, "a file");
  add.CaseFile()("--number", arguments.Number, Positive(), "a number");
  add("--numbers", arguments.Numbers, "numbers");
  add.Flag("--flag", arguments.Flag, "a flag");
}

void ParseConfiguration(const std::string& path)
{
  CLI::App application;
  AddCommand<CaseArguments>(application, "read", "Reads", "read", DeclareCase,
    [](CaseArguments&) {});
  try
  {
    application.parse(std::vector<std::string>{ path, "--config", "read" });
  }
  catch (const CLI::ParseError&)
  {
    // Shown by CommandLine.cxx as letters only.
    throw Error("options that are none");
  }
}

/// An export of the files that the mark parts, which its choice follows from.
void ReadExport(const std::string& bytes)
{
  static const std::string mark = "--FILE--";
  const ScratchFolder folder;
  std::size_t first = 0;
  for (int number = 0; first <= bytes.size() && number < 16; ++number)
  {
    const std::size_t end = std::min(bytes.find(mark, first), bytes.size());
    std::ofstream(folder.File(std::to_string(number)), std::ios::binary)
      << bytes.substr(first, end - first);
    first = end + mark.size();
  }
  const StudyChoice choice = ChooseForRegistration(ReadStudy(folder.File("")));
  StudyJson(choice);
  std::istringstream listing(StudyListing(choice));
  for (std::string line; std::getline(listing, line);)
  {
    if (EscapeControls(line) != line)
    {
      Fail(line);
    }
  }
}
}

const std::map<std::string, FuzzTarget>& FuzzTargets()
{
  ReadWithoutGuard();
  static const std::map<std::string, FuzzTarget> targets{
    { "archive-answer", Refusing([](const std::string& bytes) { WhyNotStored(200, bytes); }) },
    { "scatter", OfFile("a.csv", [](const std::string& path) { ReadScatterKernels(path); }) },
    { "attenuation", OfFile("a.csv", [](const std::string& path) { ReadAttenuationTable(path); }) },
    { "checkpoint", OfFile("checkpoint.json", ReadSearchPoints) },
    { "composition",
      Refusing(
        [](const std::string& bytes)
        {
          AttenuationTable table;
          FindComposition(bytes, table);
        }) },
    { "configuration", OfFile("c.json", ParseConfiguration) },
    { "dicom-header", OfFile("a.dcm", [](const std::string& path) { ReadDicomHeaders(path); }) },
    { "dicom-segmentation",
      OfFile("a.dcm", [](const std::string& path) { ReadLabelVolume(path); }) },
    { "study-truth", OfFile("truth.json", ReadStudyTruth) },
    { "gmsh", OfFile("a.msh", ReadMeshOrSurface) },
    { "label-description",
      OfFile("a.txt",
        [](const std::string& path)
        { ReadLabelNames(std::filesystem::path(path).replace_extension(".nii").string()); }) },
    { "landmarks", OfFile("l.csv", ReadLandmarks) },
    { "materials", OfFile("a.json", [](const std::string& path) { ReadMaterialTable(path); }) },
    { "metaimage",
      OfHeader("a.mha", TextHeader::ReadMetaImage, "dimsize", StoredVoxels::OfMetaImage) },
    { "segments",
      OfFile("a.nrrd", [](const std::string& path) { ReadSegments(TextHeader::ReadNrrd(path)); }) },
    { "nifti",
      OfFile("a.nii",
        [](const std::string& path)
        {
          LabelVolume volume;
          volume.Size = { 4, 3, 2 };
          TakeNiftiPlacement(path, NiftiHeader(path), volume);
          volume.Voxels.assign(24, 1);
          Straighten(path, volume);
          volume.Validate(path);
        }) },
    { "nrrd", OfHeader("a.nrrd", TextHeader::ReadNrrd, "sizes", StoredVoxels::OfNrrd) },
    { "obj", OfFile("a.obj", ReadMeshOrSurface) },
    { "ply", OfFile("a.ply", ReadMeshOrSurface) },
    { "printable",
      Refusing(
        [](const std::string& bytes)
        {
          if (const std::string shown = EscapeControls(bytes); EscapeControls(shown) != shown)
          {
            Fail(shown);
          }
        }) },
    { "result", OfFile(ResultFileName, ReadResult) },
    { "scene", OfFile("a.json", [](const std::string& path) { ReadScene(path); }) },
    { "spectrum", OfFile("a.spc", [](const std::string& path) { ReadSpectrum(path); }) },
    { "spectrum-table", OfFile("a.csv", [](const std::string& path) { ReadSpectrum(path); }) },
    { "stl", OfFile("a.stl", ReadMeshOrSurface) },
    { "study", Refusing(ReadExport) },
  };
  return targets;
}
}
