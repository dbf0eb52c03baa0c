// SPDX-License-Identifier: Apache-2.0
// The filters for meshing and registration, alone and in a pipeline with the others.
#include "Files.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Filters/vtkBreastCompression.h"
#include "mammoray/Filters/vtkBreastMesher.h"
#include "mammoray/Filters/vtkBreastRegistration.h"
#include "mammoray/Filters/vtkMammogramReader.h"
#include "mammoray/Filters/vtkXRayProjector.h"
#include "mammoray/IO/ImageConversion.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/RegistrationResult.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkTrivialProducer.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{
using namespace mammoray;

constexpr const char* Table = R"({ "materials": [
  { "name": "air", "labels": [0] },
  { "name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92,
    "youngs_modulus_kpa": 6, "poisson_ratio": 0.48 },
  { "name": "wall", "labels": [2], "attenuation": "muscle", "density_g_per_cm3": 1.05,
    "fixed": true } ] })";

/// How often an algorithm has worked, and what it complained of.
class Watch
{
public:
  explicit Watch(vtkAlgorithm* algorithm)
  {
    this->Starts->SetClientData(&this->Executions);
    this->Starts->SetCallback(
      [](vtkObject*, unsigned long, void* count, void*) { ++*static_cast<int*>(count); });
    algorithm->AddObserver(vtkCommand::StartEvent, this->Starts);
    this->Complaints->SetClientData(&this->Errors);
    this->Complaints->SetCallback([](vtkObject*, unsigned long, void* errors, void* text)
      { static_cast<std::vector<std::string>*>(errors)->push_back(static_cast<char*>(text)); });
    algorithm->AddObserver(vtkCommand::ErrorEvent, this->Complaints);
  }
  int Executions = 0;
  std::vector<std::string> Errors;

private:
  vtkNew<vtkCallbackCommand> Starts;
  vtkNew<vtkCallbackCommand> Complaints;
};

#ifdef MAMMORAY_HAS_MESHING
/// Half a ball of radius 30 mm on the plane x = 0, the layer to x = 6 of material 2; voxels of 2
/// mm, the image's i along world y and j along -x.
vtkSmartPointer<vtkImageData> HalfBall()
{
  const auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(34, 18, 34);
  image->SetSpacing(2, 2, 2);
  const double direction[9] = { 0, -1, 0, 1, 0, 0, 0, 0, 1 };
  image->SetDirectionMatrix(direction);
  image->SetOrigin(33, -33, -33);
  image->AllocateScalars(VTK_UNSIGNED_SHORT, 1);
  for (vtkIdType id = 0; id < image->GetNumberOfPoints(); ++id)
  {
    const double* p = image->GetPoint(id);
    const bool inside = p[0] > 0 && std::hypot(p[0], p[1], p[2]) < 30;
    image->GetPointData()->GetScalars()->SetTuple1(id, inside ? (p[0] < 6 ? 2 : 1) : 0);
  }
  return image;
}
#endif

class BreastPipeline : public testing::Test
{
protected:
  void SetUp() override { this->TablePath = this->Folder.Write("table.json", Table); }
  test::TemporaryFolder Folder;
  std::string TablePath;
};

#ifdef MAMMORAY_HAS_MESHING
TEST_F(BreastPipeline, MeshesAnObliqueImage)
{
  vtkNew<vtkBreastMesher> mesher;
  mesher->SetInputData(HalfBall());
  mesher->SetMaterialTable(this->TablePath.c_str());
  mesher->Update();
  vtkUnstructuredGrid* grid = mesher->GetOutput();
  double bounds[6];
  grid->GetBounds(bounds);
  // Voxels' faces: half a spacing, and the mesher's distance of facets.
  EXPECT_NEAR(bounds[0], 0, 1.5);
  EXPECT_NEAR(bounds[1], 30, 1.5);
  EXPECT_NEAR(bounds[2], -30, 1.5);
  EXPECT_NEAR(bounds[3], 30, 1.5);
  vtkDataArray* volumes = grid->GetFieldData()->GetArray("MaterialVolumesMm3");
  ASSERT_TRUE(volumes);
  // Half a ball; 2 % is the mesher's promise, 1 % the voxels' own.
  const double all = 2.0 / 3 * std::numbers::pi * 30 * 30 * 30;
  EXPECT_NEAR(volumes->GetTuple1(1) + volumes->GetTuple1(2), all, 0.03 * all);
  auto* names =
    vtkStringArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray("MaterialNames"));
  ASSERT_TRUE(names);
  EXPECT_EQ(names->GetValue(2), "wall");
  // Without a table labels are materials by number.
  mesher->SetMaterialTable("");
  mesher->ForMechanicsOn();
  mesher->SetCellSizeMm(0);
  mesher->Update();
  names = vtkStringArray::SafeDownCast(
    mesher->GetOutput()->GetFieldData()->GetAbstractArray("MaterialNames"));
  EXPECT_EQ(names->GetValue(2), "2");
  // And a file goes before a name.
  mesher->SetMaterialTable("no-such-table");
  mesher->SetMaterialTableFile(this->TablePath.c_str());
  mesher->Update();
  names = vtkStringArray::SafeDownCast(
    mesher->GetOutput()->GetFieldData()->GetAbstractArray("MaterialNames"));
  ASSERT_TRUE(names);
  EXPECT_EQ(names->GetValue(2), "wall");
}

TEST_F(BreastPipeline, MesherRefusesOnceAndStopsWhenAsked)
{
  vtkNew<vtkBreastMesher> mesher;
  const auto image = HalfBall();
  mesher->SetInputData(image);
  mesher->SetMaterialTable("no-such-table");
  Watch watch(mesher);
  mesher->Update();
  ASSERT_EQ(watch.Errors.size(), 1u);
  EXPECT_THAT(watch.Errors[0], testing::HasSubstr("no-such-table"));
  EXPECT_EQ(mesher->GetOutput()->GetNumberOfCells(), 0);
  mesher->SetMaterialTable(this->TablePath.c_str());
  image->SetSpacing(2000, 2000, 2000); // um
  mesher->Update();
  ASSERT_EQ(watch.Errors.size(), 2u);
  EXPECT_THAT(watch.Errors[1],
    testing::HasSubstr("voxel spacing from 0.05 to 10 mm, found 2000 (in um?); set AcceptUnusual"));
  image->SetSpacing(2, 2, 2);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  mesher->AddObserver(vtkCommand::ProgressEvent, stop);
  mesher->Update();
  EXPECT_EQ(watch.Errors.size(), 2u);
  EXPECT_EQ(mesher->GetOutput()->GetNumberOfCells(), 0);
}

TEST_F(BreastPipeline, UpdatesOnlyWhatChanged)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  vtkNew<vtkBreastMesher> mesher;
  mesher->SetInputData(HalfBall());
  mesher->SetMaterialTable(this->TablePath.c_str());
  mesher->ForMechanicsOn();
  mesher->SetCellSizeMm(12);
  vtkNew<vtkBreastCompression> compression;
  compression->SetInputConnection(mesher->GetOutputPort());
  compression->SetMaterialTable(this->TablePath.c_str());
  compression->SetOrientation("ALS");
  compression->SetElementToLinear();
  compression->SetThicknessMm(52);
  vtkNew<vtkXRayProjector> projector;
  projector->SetInputConnection(compression->GetOutputPort());
  projector->SetSourcePosition(20, 0, 500);
  projector->SetDetectorOrigin(0, -40, -60);
  projector->SetPixelSpacing(2, 2);
  projector->SetDetectorSize(30, 40);
  projector->SetKey("attenuations.fat", "adipose@0.92");
  projector->SetKey("attenuations.wall", "muscle@1.05");
  const Watch meshing(mesher);
  const Watch squeezing(compression);
  const Watch tracing(projector);
  const auto counts = [&]
  {
    projector->Update();
    return std::array<int, 3>{ meshing.Executions, squeezing.Executions, tracing.Executions };
  };
  using Counts = std::array<int, 3>;
  EXPECT_EQ(counts(), (Counts{ 1, 1, 1 }));
  EXPECT_EQ(counts(), (Counts{ 1, 1, 1 }));
  projector->SetKey("beam.kev", "25"); // the beam: no mesh, no mechanics, not even a ray
  EXPECT_EQ(counts(), (Counts{ 1, 1, 2 }));
  EXPECT_EQ(projector->GetNumberOfTraces(), 1);
  projector->SetSourcePosition(10, 0, 500);
  EXPECT_EQ(counts(), (Counts{ 1, 1, 3 }));
  EXPECT_EQ(projector->GetNumberOfTraces(), 2);
  compression->SetThicknessMm(50);
  EXPECT_EQ(counts(), (Counts{ 1, 2, 4 }));
  mesher->SetCellSizeMm(11);
  EXPECT_EQ(counts(), (Counts{ 2, 3, 5 }));
  EXPECT_TRUE(meshing.Errors.empty() && squeezing.Errors.empty() && tracing.Errors.empty());
}
#endif

/// A mammogram of the small breast at a pose, from the left in CC.
Mammogram MammogramOf(const TetrahedralMesh& mesh, const MaterialTable& table, double thicknessMm,
  const AnatomicalAxes& axes)
{
  BreastModel model(mesh, table);
  model.SetXRays(ExtractInterfaces(mesh), MakeProjector(),
    MakeBeam(table, FindSpectrum("W30kVp_Rh50um_Be1mm"), DetectorResponse::EnergyIntegrating));
  const UnitPlacement placement{ FindPoseFrame(mesh, table.Fixed(), axes), {} };
  BreastPose pose;
  pose.ThicknessMm = thicknessMm;
  pose.AnteriorMm = 5;
  ReceptorGrid grid;
  grid.Columns = 90;
  grid.Rows = 200;
  grid.Origin = { 59.7, 0.3 };
  grid.ColumnStep = { 0, 0.6 };
  grid.RowStep = { -0.6, 0 };
  PosedBreast breast(model, model.Body(), placement, pose,
    model.Body().Simulation().Compress(placement.PlatesAt(pose)));
  Mammogram mammogram;
  mammogram.Columns = grid.Columns;
  mammogram.Rows = grid.Rows;
  mammogram.ColumnSpacingMm = mammogram.RowSpacingMm = 0.6;
  for (const float value : breast.PictureOn(grid, 2).LogAttenuation)
  {
    mammogram.Pixels.push_back(std::round(10000 * std::exp(-value)));
  }
  mammogram.PresentationIntent = Mammogram::Intent::ForProcessing;
  mammogram.IntensityRelationship = Mammogram::Relationship::Linear;
  mammogram.IntensitySign = 1;
  mammogram.View = "CC";
  mammogram.Laterality = 'L';
  mammogram.RowDirection = "A";
  mammogram.ColumnDirection = "R";
  mammogram.BodyPartThicknessMm = thicknessMm + 2;
  return mammogram;
}

TEST_F(BreastPipeline, MammogramsSurviveAsImages)
{
  Mammogram mammogram;
  mammogram.Columns = 3;
  mammogram.Rows = 2;
  mammogram.Pixels = { 1, 2, 3, 4, 5, 6 };
  mammogram.ColumnSpacingMm = 0.1;
  mammogram.RowSpacingMm = 0.2;
  mammogram.View = "MLO";
  mammogram.Laterality = 'R';
  mammogram.RowDirection = "P";
  mammogram.ColumnDirection = "FL";
  mammogram.InvertedForDisplay = true;
  mammogram.PresentationIntent = Mammogram::Intent::ForProcessing;
  mammogram.IntensityRelationship = Mammogram::Relationship::Logarithmic;
  mammogram.IntensitySign = -1;
  mammogram.BitsStored = 14;
  mammogram.PositionerPrimaryAngleDeg = 50;
  const auto image = ToImage(mammogram);
  EXPECT_EQ(image->GetPointData()->GetScalars()->GetTuple1(0), 4); // the last row comes first
  const Mammogram again = ToMammogram(image);
  EXPECT_EQ(again.Pixels, mammogram.Pixels);
  EXPECT_EQ(again.RowSpacingMm, 0.2);
  EXPECT_EQ(again.View, "MLO");
  EXPECT_EQ(again.Laterality, 'R');
  EXPECT_EQ(again.RowDirection, "P");
  EXPECT_EQ(again.ColumnDirection, "FL");
  EXPECT_TRUE(again.InvertedForDisplay);
  EXPECT_EQ(again.PresentationIntent, Mammogram::Intent::ForProcessing);
  EXPECT_EQ(again.IntensityRelationship, Mammogram::Relationship::Logarithmic);
  EXPECT_EQ(again.IntensitySign, -1);
  EXPECT_EQ(again.BitsStored, 14);
  EXPECT_EQ(again.PositionerPrimaryAngleDeg, 50);
  EXPECT_FALSE(again.BodyPartThicknessMm);
}

class BreastRegistration : public BreastPipeline
{
protected:
  void SetUp() override
  {
    if (ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device";
    }
    BreastPipeline::SetUp();
    const TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 6);
    const MaterialTable table = FindMaterialTable(this->TablePath);
    this->Anatomy->SetOutput(ToGrid(mesh, table.Names()));
    this->Image = ToImage(MammogramOf(mesh, table, 58, AnatomicalAxes::FromCode("LAS")));
    this->Pictures->SetOutput(this->Image);
    this->Filter->SetInputConnection(this->Anatomy->GetOutputPort());
    this->Filter->SetMammogramConnection(this->Pictures->GetOutputPort());
    this->Filter->SetMaterialTable(this->TablePath.c_str());
    this->Filter->SetOrientation("LAS");
    this->Filter->SetFreeParameters("thickness lateral");
    this->Filter->SetSourceToDetectorMm(650);
    this->Filter->SetEdgeRadiusMm(MammographyUnit().EdgeRadiusMm); // of the mammogram's plates
  }
  double Field(const char* name, vtkIdType index = 0)
  {
    vtkDataArray* array = this->Filter->GetOutput()->GetFieldData()->GetArray(name);
    EXPECT_TRUE(array && array->GetNumberOfValues() > index) << name;
    return array && array->GetNumberOfValues() > index ? array->GetVariantValue(index).ToDouble()
                                                       : std::nan("");
  }
  vtkNew<vtkTrivialProducer> Anatomy;
  vtkNew<vtkTrivialProducer> Pictures;
  vtkSmartPointer<vtkImageData> Image;
  vtkNew<vtkBreastRegistration> Filter;
};

TEST_F(BreastRegistration, FindsWhatTheMammogramWasMadeWith)
{
  const Watch watch(this->Filter);
  this->Filter->Update();
  ASSERT_TRUE(watch.Errors.empty()) << watch.Errors.front();
  // The same model and another spectrum: what the picture's pixels tell of thickness, beside its
  // prior around 60, and place.
  EXPECT_NEAR(this->Field("Parameters", ThicknessParameter), 58, 1.5);
  EXPECT_NEAR(this->Field("Parameters", LateralParameter), 0, 0.3);
  EXPECT_GT(this->Field("Correlation"), 0.99);
  EXPECT_LT(this->Field("MeanOutlineDistanceMm"), 0.3);
  EXPECT_EQ(this->Field("Converged"), 1);
  vtkUnstructuredGrid* output = this->Filter->GetOutput();
  vtkFieldData* fields = output->GetFieldData();
  EXPECT_EQ(fields->GetArray("Covariance")->GetNumberOfValues(), ParameterCount * ParameterCount);
  EXPECT_GT(this->Field("Covariance", 0), 0);
  EXPECT_NEAR(std::sqrt(this->Field("Covariance", 0)), this->Field("ParameterDeviations", 0), 1e-9);
  // The model's own error is 0.3 mm each way at least, whose median distance is 1.54 times that.
  EXPECT_GT(this->Field("ExpectedErrorMm", 0), 0.46);
  EXPECT_GT(this->Field("ExpectedErrorMm", 1), this->Field("ExpectedErrorMm", 0));
  auto* trust = vtkStringArray::SafeDownCast(fields->GetAbstractArray("Trust"));
  auto* reasons = vtkStringArray::SafeDownCast(fields->GetAbstractArray("TrustReasons"));
  ASSERT_TRUE(trust && reasons);
  EXPECT_EQ(trust->GetValue(0) == "good", reasons->GetNumberOfValues() == 0);
  EXPECT_TRUE(output->GetPointData()->GetArray("Sensitivity_thickness"));
  EXPECT_FALSE(output->GetPointData()->GetArray("Sensitivity_roll"));
  vtkDataArray* displacement = output->GetPointData()->GetArray("Displacement");
  ASSERT_TRUE(displacement);
  double largest = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    largest = std::max(largest, std::abs(displacement->GetComponent(id, 2)));
  }
  EXPECT_GT(largest, 3); // plates of 58 mm at a breast of 76
}

#ifdef MAMMORAY_HAS_MESHING
/// From the same files: labels, a coarse mesh to simulate on and a DICOM mammogram.
TEST_F(BreastRegistration, FindsWhatTheCommandFinds)
{
  vtkNew<vtkBreastMesher> mesher;
  mesher->SetInputData(HalfBall());
  mesher->SetMaterialTable(this->TablePath.c_str());
  mesher->ForMechanicsOn();
  mesher->SetCellSizeMm(12);
  mesher->Update();
  const MaterialTable table = FindMaterialTable(this->TablePath);
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("ALS");

  RegistrationCase input;
  input.Labels.Path = this->Folder.File("labels.nrrd");
  input.Labels.AcceptUnusual = true; // half as large as any breast
  input.Materials = this->TablePath;
  input.Mammograms = { this->Folder.File("mammogram.dcm") };
  input.Orientation = "ALS";
  input.SimulationMesh = this->Folder.File("simulation.vtu");
  input.Free = { "thickness", "lateral" };
  input.EdgeRadiusMm = MammographyUnit().EdgeRadiusMm;
  LabelVolume labels = ToLabelVolume(HalfBall());
  labels.Names = { { 1, "Fett" } }; // which the table does not know
  WriteLabelVolume(labels, input.Labels.Path);
  WriteMesh(mesher->GetOutput(), input.SimulationMesh);
  WriteMammogram(MammogramOf(FromGrid(mesher->GetOutput()), table, 45, axes), {},
    input.Mammograms.front());
  const RegistrationCaseResult result = RunRegistrationCase(input);
  const std::string note = testing::PrintToString(result.Notes);
  EXPECT_EQ(result.Notes.size(), 1u) << note;
  EXPECT_NE(note.find("*.nrrd: no name of its labels is one of the material table"),
    std::string::npos)
    << note;
  EXPECT_EQ(note.find("Fett"), std::string::npos) << note;
  const ViewResult& found = result.Views.front().Registration;
  // The same body but for its skin's facets, and another spectrum.
  EXPECT_NEAR(found.Pose.ThicknessMm, 45, 3 * found.StandardDeviations[ThicknessParameter]);

  const Watch watch(this->Filter);
  vtkNew<vtkMammogramReader> reader;
  reader->SetFileName(input.Mammograms.front().c_str());
  this->Filter->SetInputData(0, HalfBall());
  this->Filter->SetMammogramConnection(reader->GetOutputPort());
  this->Filter->SetSimulationMeshConnection(mesher->GetOutputPort());
  this->Filter->SetOrientation("ALS");
  this->Filter->AcceptUnusualOn();
  this->Filter->Update();
  ASSERT_TRUE(watch.Errors.empty()) << watch.Errors.front();
  // Threads add in another order.
  for (int index = 0; index < ParameterCount; ++index)
  {
    EXPECT_NEAR(this->Field("Parameters", index), found.Values[index], 1e-3)
      << found.Parameters[index].Name;
  }
  EXPECT_NEAR(this->Field("TissueCorrelation"), found.After.TissueCorrelation, 1e-3);
  vtkFieldData* fields = this->Filter->GetOutput()->GetFieldData();
  const auto strings = [&](const char* name)
  { return vtkStringArray::SafeDownCast(fields->GetAbstractArray(name)); };
  ASSERT_TRUE(strings("Trust") && strings("TrustReasons"));
  EXPECT_EQ(strings("Trust")->GetValue(0), NameOf(found.Trust.Level));
  EXPECT_EQ(strings("TrustReasons")->GetNumberOfValues(),
    static_cast<vtkIdType>(found.Trust.Reasons.size()));
  ASSERT_TRUE(found.Expected);
  EXPECT_NEAR(this->Field("ExpectedErrorMm", 0), found.Expected->MedianMm, 1e-3);
  EXPECT_NEAR(this->Field("ExpectedErrorMm", 1), found.Expected->Most95Mm, 1e-3);
}
#endif

TEST_F(BreastRegistration, KeepsWhatDidNotChange)
{
  const Watch watch(this->Filter);
  this->Filter->Update();
  EXPECT_EQ(this->Filter->GetNumberOfSetups(), 1);
  this->Filter->Update();
  EXPECT_EQ(watch.Executions, 1);
  // Another mammogram: the same breast.
  Mammogram darker = ToMammogram(this->Image);
  for (float& pixel : darker.Pixels)
  {
    pixel *= 0.7F;
  }
  this->Pictures->SetOutput(ToImage(darker));
  const double before = this->Field("Parameters");
  this->Filter->Update();
  EXPECT_EQ(watch.Executions, 2);
  EXPECT_EQ(this->Filter->GetNumberOfSetups(), 1);
  EXPECT_NEAR(this->Field("Parameters"), before, 0.1); // log attenuation knows no exposure
  this->Filter->SetThicknessMm(57);
  this->Filter->Update();
  EXPECT_EQ(this->Filter->GetNumberOfSetups(), 1);
  EXPECT_TRUE(watch.Errors.empty());
}

TEST_F(BreastRegistration, RefusesOnceAndStopsWhenAsked)
{
  const Watch watch(this->Filter);
  this->Filter->SetFreeParameters("thickness rool");
  this->Filter->Update();
  ASSERT_EQ(watch.Errors.size(), 1u);
  EXPECT_THAT(watch.Errors[0], testing::HasSubstr("no parameter 'rool'"));
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfCells(), 0);
  this->Filter->SetFreeParameters("thickness");
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  this->Filter->AddObserver(vtkCommand::ProgressEvent, stop);
  this->Filter->Update();
  EXPECT_EQ(watch.Errors.size(), 1u);
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfCells(), 0);
}
}
