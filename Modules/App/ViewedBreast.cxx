// SPDX-License-Identifier: Apache-2.0
#include "mammoray/App/ViewedBreast.h"

#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/LesionShadow.h"
#include "mammoray/Study/RegisteredMammogram.h"
#include "mammoray/Study/ResultFile.h"

#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

constexpr const char* DefaultSpectrum = "W28kVp_Rh50um_Be1mm";

std::vector<double> PointsOf(vtkUnstructuredGrid* grid)
{
  std::vector<double> points(3 * static_cast<std::size_t>(grid->GetNumberOfPoints()));
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    grid->GetPoint(id, &points[3 * static_cast<std::size_t>(id)]);
  }
  return points;
}

/// A shipped table is known by its checksum; any other must be named.
MaterialTable TableOf(const ResultFile& result, const std::string& named)
{
  if (!named.empty())
  {
    return FindMaterialTable(named);
  }
  const auto table = std::find_if(result.Inputs.begin(), result.Inputs.end(),
    [](const ResultInput& input) { return input.Role == MaterialTableRole; });
  const std::string file = table == result.Inputs.end() ? "?" : table->File;
  const fs::path shipped = fs::path(DataDirectory()) / "materials" / file;
  if (fs::is_regular_file(shipped) && Sha256OfFile(shipped.string()) == table->Sha256)
  {
    return FindMaterialTable(shipped.string());
  }
  throw InputError("the result was made with the table " + file + ", which is not a shipped one",
    { "Materials", file, { "Materials" } });
}

void AddMammogram(const Mammogram& mammogram, ViewedBreast& viewed)
{
  viewed.Real = PrepareTarget(mammogram);
  viewed.Laterality = mammogram.Laterality;
}

ViewedBreast ReadResult(const ViewInput& input, const ResultFile& result)
{
  ViewedBreast viewed;
  viewed.Breast = ReadBreastInUnit(result);
  viewed.Trust = result.Trust;
  viewed.Expected = result.Expected;
  viewed.Materials = TableOf(result, input.Materials);
  viewed.Spectrum = FindSpectrum(input.Spectrum.empty() ? result.Spectrum : input.Spectrum);
  viewed.Pose = result.Pose;
  viewed.Axes = result.Axes;
  viewed.Frame = FrameOf(result.Placed, result.Unit, result.Pose);
  viewed.Laterality = result.Mammogram.Laterality;
  for (const std::string& mammogram : input.Mammograms)
  {
    if (input.Mammograms.size() == 1 || IsRegisteredMammogram(result, mammogram))
    {
      AddMammogram(ReadRegisteredMammogram(result, mammogram), viewed);
      break;
    }
  }
  return viewed;
}

/// The points before 'mammoray compress' moved them; the points themselves in another mesh.
std::vector<double> RestPoints(vtkUnstructuredGrid* grid)
{
  std::vector<double> points = PointsOf(grid);
  vtkDataArray* displacement = grid->GetPointData()->GetArray("Displacement");
  if (displacement && displacement->GetNumberOfComponents() == 3)
  {
    for (std::size_t index = 0; index < points.size(); ++index)
    {
      points[index] -=
        displacement->GetComponent(static_cast<vtkIdType>(index / 3), static_cast<int>(index % 3));
    }
  }
  return points;
}

std::optional<double> ThicknessOf(vtkUnstructuredGrid* grid)
{
  vtkDataArray* thickness = grid->GetFieldData()->GetArray("ThicknessMm");
  return thickness && thickness->GetNumberOfTuples() > 0
    ? std::optional<double>(thickness->GetComponent(0, 0))
    : std::nullopt;
}

ViewedBreast ReadMeshes(const ViewInput& input)
{
  ViewedBreast viewed;
  const std::string& path = input.Mesh;
  const auto grid = ReadMesh(path);
  if (input.Materials.empty())
  {
    throw InputError(path + ": expected a material table beside a mesh",
      { "Materials", "", { "Materials" } });
  }
  viewed.Materials = FindMaterialTable(input.Materials);
  FitGrid(grid, viewed.Materials, path);
  viewed.Spectrum = FindSpectrum(input.Spectrum.empty() ? DefaultSpectrum : input.Spectrum);
  viewed.Axes = AnatomicalAxes::FromCode(input.Orientation);
  viewed.Breast.Compressed = grid;
  viewed.Breast.Uncompressed = WithPoints(grid, RestPoints(grid));
  const std::optional<double> thickness = ThicknessOf(grid);
  for (const PoseParameter& parameter : PoseParameters)
  {
    viewed.Pose.*parameter.Value =
      input.Pose[parameter.Index].value_or(viewed.Pose.*parameter.Value);
  }
  // The compressed grid is that of its own thickness, whatever is asked for.
  viewed.Pose.ThicknessMm = thickness.value_or(BreastPose().ThicknessMm);
  viewed.Frame =
    FindPoseFrame(FromGrid(viewed.Breast.Uncompressed), viewed.Materials.Fixed(), viewed.Axes);
  if (input.Mammograms.size() > 1)
  {
    throw InputError(path + ": expected one mammogram at most beside a mesh, found " +
      std::to_string(input.Mammograms.size()));
  }
  if (!input.Mammograms.empty())
  {
    AddMammogram(ReadMammogram(input.Mammograms.front()), viewed);
  }
  return viewed;
}

/// Pixels that hold the breast's shadow, rows along the chest wall; without pictures.
ReceptorGrid GridAround(const ViewedBreast& viewed, double spacingMm)
{
  if (!(spacingMm > 0))
  {
    throw InputError(
      "pixel spacing: expected a positive length, found " + std::to_string(spacingMm) + " mm");
  }
  double low[2] = { 1e9, 0 };
  double high[2] = { -1e9, 0 };
  for (const ReceptorPoint& point :
    ProjectToReceptor(PointsOf(viewed.Breast.Compressed), viewed.Breast.Placed, viewed.Breast.Unit))
  {
    for (int axis = 0; axis < 2 && std::isfinite(point[0]); ++axis)
    {
      low[axis] = std::min(low[axis], point[axis]);
      high[axis] = std::max(high[axis], point[axis]);
    }
  }
  // Room to move: the source, the unit, a breast that becomes flatter.
  constexpr double MarginMm = 15;
  ReceptorGrid grid;
  grid.ColumnStep = { 0, spacingMm };
  grid.RowStep = { -spacingMm, 0 };
  grid.Columns = static_cast<int>(std::ceil((high[1] + MarginMm) / spacingMm));
  grid.Rows = static_cast<int>(std::ceil((high[0] - low[0] + 2 * MarginMm) / spacingMm));
  constexpr int Most = 8192;
  if (!(high[0] > low[0]) || grid.Columns < 1 || grid.Columns > Most || grid.Rows > Most)
  {
    throw InputError(
      "expected the breast in front of the receptor's edge and a picture of at most " +
        std::to_string(Most) + " pixels along each side, found " + std::to_string(grid.Columns) +
        " x " + std::to_string(grid.Rows),
      { "PixelSpacingMm", std::to_string(spacingMm), { "Orientation", "PixelSpacingMm" } });
  }
  grid.Origin = { high[0] + MarginMm - 0.5 * spacingMm, 0.5 * spacingMm };
  return grid;
}
/// Path of a file in the folder of a result; empty if there is none.
std::string BesideResult(const ViewInput& input, const char* name)
{
  const fs::path path = fs::path(input.Result) / name;
  return !input.Result.empty() && fs::is_regular_file(path) ? path.string() : "";
}

/// The volumes that the slices show.
void ReadVolumes(const ViewInput& input, ViewedBreast& viewed)
{
  const VolumeAxes axes = AxesOf(input.Labels.AxesAsGiven);
  const std::string image = input.Image.empty() ? BesideResult(input, "mri.nrrd") : input.Image;
  if (!image.empty())
  {
    viewed.Image = std::make_shared<const IntensityVolume>(ReadMri(image, axes, input.ImageSeries));
  }
  if (!input.Labels.Path.empty())
  {
    viewed.Mechanics.Volume = ReadMaterials(input.Labels, viewed.Materials);
    viewed.Tissue = std::make_shared<const LabelVolume>(*viewed.Mechanics.Volume);
  }
  else if (const std::string labels = BesideResult(input, "labels.seg.nrrd"); !labels.empty())
  {
    viewed.Tissue = std::make_shared<const LabelVolume>(
      viewed.Materials.ToMaterials(ReadLabelVolume(labels), labels));
  }
  if (!input.Lesions.empty())
  {
    viewed.Lesions = std::make_shared<const LabelVolume>(ReadLesions(input.Lesions, axes));
  }
}

/// The pose that is asked for, and what follows of it.
void Complete(const ViewInput& input, ViewedBreast& viewed)
{
  viewed.Anatomy = FitGrid(viewed.Breast.Uncompressed, viewed.Materials, viewed.Name);
  FitGrid(viewed.Breast.Compressed, viewed.Materials, viewed.Name);
  const bool uncompressed = PointsOf(viewed.Breast.Compressed) == viewed.Anatomy.Points;
  viewed.PoseDiffers = uncompressed && input.Pose[ThicknessParameter];
  for (const PoseParameter& parameter : PoseParameters)
  {
    double& value = viewed.Pose.*parameter.Value;
    const double asked = input.Pose[parameter.Index].value_or(value);
    viewed.PoseDiffers = viewed.PoseDiffers || asked != value;
    value = asked;
  }
  if (!(viewed.Pose.ThicknessMm > 0))
  {
    throw InputError("thickness: expected a positive length, found " +
      std::to_string(viewed.Pose.ThicknessMm) + " mm");
  }
  viewed.Breast.Placed = PlaceUnit(viewed.Frame, viewed.Breast.Unit, viewed.Pose);
  if (viewed.Real)
  {
    viewed.Breast.Grid = viewed.Real->Grid;
  }
  else if (input.Result.empty())
  {
    viewed.Breast.Grid = GridAround(viewed, input.PixelSpacingMm);
  }
  if (!input.SimulationMesh.empty())
  {
    viewed.Mechanics.SimulationMesh = FromGrid(ReadMesh(input.SimulationMesh));
  }
}
}

vtkSmartPointer<vtkUnstructuredGrid> WithPoints(vtkUnstructuredGrid* grid,
  const std::vector<double>& points)
{
  auto moved = vtkSmartPointer<vtkUnstructuredGrid>::New();
  moved->ShallowCopy(grid);
  vtkNew<vtkDoubleArray> values;
  values->SetNumberOfComponents(3);
  values->SetNumberOfTuples(grid->GetNumberOfPoints());
  std::copy(points.begin(), points.end(), values->GetPointer(0));
  vtkNew<vtkPoints> holder;
  holder->SetData(values);
  moved->SetPoints(holder);
  return moved;
}

std::vector<ViewedBreast> ReadViewedBreasts(const ViewInput& input)
{
  std::vector<ViewedBreast> all;
  if (input.Result.empty())
  {
    all.push_back(ReadMeshes(input));
  }
  else
  {
    const std::vector<ResultFile> results = ReadResultFiles(input.Result);
    for (const std::string& mammogram : input.Mammograms)
    {
      if (results.size() > 1 &&
        std::none_of(results.begin(), results.end(),
          [&](const ResultFile& result) { return IsRegisteredMammogram(result, mammogram); }))
      {
        throw InputError(mammogram +
          ": expected a mammogram that was registered there, found "
          "another");
      }
    }
    for (const ResultFile& result : results)
    {
      ViewedBreast& viewed = all.emplace_back(ReadResult(input, result));
      viewed.View = results.size() > 1 ? fs::path(result.Folder).filename().string() : "";
    }
  }
  ReadVolumes(input, all.front());
  for (ViewedBreast& viewed : all)
  {
    viewed.Name = fs::path(input.Result + input.Mesh).lexically_normal().string();
    viewed.Image = all.front().Image;
    viewed.Tissue = all.front().Tissue;
    viewed.Lesions = all.front().Lesions;
    viewed.Mechanics.Volume = all.front().Mechanics.Volume;
    Complete(input, viewed);
  }
  return all;
}
}
