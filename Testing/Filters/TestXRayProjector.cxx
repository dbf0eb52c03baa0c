// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Filters/vtkXRayProjector.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace
{
/// Counts and keeps errors instead of printing them.
class ErrorCounter : public vtkCommand
{
public:
  static ErrorCounter* New() { return new ErrorCounter; }
  void Execute(vtkObject*, unsigned long, void* text) override
  {
    ++this->Count;
    this->Text = static_cast<const char*>(text);
  }
  int Count = 0;
  std::string Text;
};

/// A brick from the origin to (a, b, c) of five tetrahedra; material 1, the middle one material 2.
vtkSmartPointer<vtkUnstructuredGrid> Brick(double a, double b, double c, int middle = 1)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int corner = 0; corner < 8; ++corner)
  {
    points->InsertNextPoint((corner & 1) != 0 ? a : 0, (corner & 2) != 0 ? b : 0,
      (corner & 4) != 0 ? c : 0);
  }
  vtkNew<vtkCellArray> cells;
  for (const auto& ids : std::vector<std::array<vtkIdType, 4>>{ { 0, 1, 2, 4 }, { 3, 2, 1, 7 },
         { 5, 4, 7, 1 }, { 6, 7, 4, 2 }, { 1, 2, 4, 7 } })
  {
    cells->InsertNextCell({ ids[0], ids[1], ids[2], ids[3] });
  }
  vtkNew<vtkIntArray> materials;
  materials->SetName("Material");
  for (int cell = 0; cell < 5; ++cell)
  {
    materials->InsertNextValue(cell == 4 ? middle : 1);
  }
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(points);
  grid->SetCells(VTK_TETRA, cells);
  grid->GetCellData()->AddArray(materials);
  return grid;
}

class XRayProjectorFilter : public testing::Test
{
protected:
  void SetUp() override
  {
    std::string reason;
    if (mammoray::ListDevices(&reason).empty())
    {
      GTEST_SKIP() << reason;
    }
    this->Filter->AddObserver(vtkCommand::ErrorEvent, this->Errors);
    this->Filter->SetDetectorOrigin(1, 1.5, -5);
    this->Filter->SetPixelSpacing(2, 1.5);
    this->Filter->SetDetectorSize(4, 5);
    this->Filter->SetKey("source.beam-direction", "[0, 0, -1]");
    this->Filter->SetKey("attenuations.1", "0.05/mm");
  }
  float Value(const char* array, vtkIdType pixel)
  {
    vtkDataArray* values = this->Filter->GetOutput()->GetPointData()->GetArray(array);
    return values ? static_cast<float>(values->GetComponent(pixel, 0)) : NAN;
  }

  vtkNew<vtkXRayProjector> Filter;
  vtkNew<ErrorCounter> Errors;
};

TEST_F(XRayProjectorFilter, SamplesAverageTransmissions)
{
  // The face x = 0 goes through the middle of the first column: half of its samples see 12 mm.
  const auto grid = Brick(10, 20, 12);
  this->Filter->SetInputData(grid);
  this->Filter->SetDetectorOrigin(0, 1.5, -5);
  this->Filter->SetKey("detector.samples", "4");
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_NEAR(this->Value("Transmission", 0), 0.5 * (1 + std::exp(-0.6)), 1e-6);
  EXPECT_NEAR(this->Value("PathLength_1", 0), 6, 1e-5);
}

TEST_F(XRayProjectorFilter, BrickMatchesClosedFormAndLiesAtTheDetector)
{
  const auto grid = Brick(10, 20, 12);
  this->Filter->SetInputData(grid);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  vtkImageData* image = this->Filter->GetOutput();
  ASSERT_EQ(image->GetNumberOfPoints(), 20);
  for (vtkIdType pixel = 0; pixel < 20; ++pixel)
  {
    // Results are floats, 6e-8 relative.
    ASSERT_NEAR(this->Value("PathLength_1", pixel), 12, 1e-6);
    ASSERT_NEAR(this->Value("LogAttenuation", pixel), 0.6, 1e-7);
    ASSERT_NEAR(this->Value("Transmission", pixel), std::exp(-0.6), 1e-7);
    ASSERT_EQ(this->Value("Consistency", pixel), 1);
  }
  double corner[3];
  image->GetPoint(19, corner);
  EXPECT_DOUBLE_EQ(corner[0], 7);
  EXPECT_DOUBLE_EQ(corner[1], 7.5);
  EXPECT_DOUBLE_EQ(corner[2], -5);
}

TEST_F(XRayProjectorFilter, ScatterIsAddedAndAGridTakesItAway)
{
  this->Filter->SetInputData(Brick(100, 100, 40));
  this->Filter->SetDetectorOrigin(2.5, 2.5, -17);
  this->Filter->SetPixelSpacing(5, 5);
  this->Filter->SetDetectorSize(20, 20);
  const auto middle = [&]()
  {
    this->Filter->Update();
    return this->Value("Transmission", 10 * 20 + 10);
  };
  const float primary = middle();
  EXPECT_NEAR(primary, std::exp(-2.0), 1e-6);
  this->Filter->SetKey("scatter.method", "kernels");
  const float scatter = middle() - primary;
  // Boone and Cooper's ratio of 10 cm and 4 cm is 0.36.
  EXPECT_NEAR(scatter / primary, 0.36, 0.06);
  this->Filter->SetKey("scatter.grid.ratio", "5");
  EXPECT_LT(middle() - primary, 0.3F * scatter);
  this->Filter->SetKey("detector.photons", "1e4");
  EXPECT_NE(middle(), primary);
  EXPECT_NEAR(middle(), primary, 0.2 * primary); // noise of 3 %, and scatter
  EXPECT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  this->Filter->SetKey("scatter.method", "");
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_NE(this->Errors->Text.find("grid: expected scatter"), std::string::npos)
    << this->Errors->Text;
}

TEST_F(XRayProjectorFilter, RefractionBendsRaysAtASlope)
{
  // A tetrahedron's faces are wedges: the deflection is delta times the tangent, and one image has
  // no more than the angles of its faces.
  this->Filter->SetInputData(Brick(10, 20, 12));
  this->Filter->SetKey("attenuations.1", "H2O@1");
  this->Filter->SetKey("refraction.law", "geometric");
  this->Filter->SetKey("refraction.distance", "0");
  this->Filter->SetKey("source.beam-direction", "[0.05, 0, -1]");
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  ASSERT_NE(this->Filter->GetOutput()->GetPointData()->GetArray("Deflection"), nullptr);
  // Between parallel faces rays go on as they came.
  EXPECT_NEAR(this->Value("Deflection", 6), 0, 1e-9);
  EXPECT_LT(this->Value("Transmission", 6), 1);
  this->Filter->SetKey("attenuations.1", "0.05/mm");
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1); // of no composition
}

TEST_F(XRayProjectorFilter, AnotherBeamDoesNotTraceAgain)
{
  this->Filter->SetInputData(Brick(10, 20, 12));
  this->Filter->SetKey("detector.samples", "2");
  this->Filter->Update();
  EXPECT_EQ(this->Filter->GetNumberOfTraces(), 4);
  EXPECT_NEAR(this->Value("LogAttenuation", 0), 0.6, 1e-6);
  this->Filter->SetKey("attenuations.1", "0.1/mm");
  this->Filter->SetKey("beam.kev", "30");
  this->Filter->SetKey("detector.response", "counting");
  this->Filter->Update();
  EXPECT_EQ(this->Filter->GetNumberOfTraces(), 4);
  EXPECT_NEAR(this->Value("LogAttenuation", 0), 1.2, 1e-6);
  // A moved beam traces again, and so do moved points.
  this->Filter->SetKey("source.beam-direction", "[0, 0.5, -1]");
  this->Filter->Update();
  EXPECT_EQ(this->Filter->GetNumberOfTraces(), 8);
  this->Filter->SetKey("source.beam-direction", "[0, 0, -1]");
  this->Filter->SetInputData(Brick(10, 20, 18));
  this->Filter->Update();
  EXPECT_EQ(this->Filter->GetNumberOfTraces(), 12);
  EXPECT_NEAR(this->Value("LogAttenuation", 0), 1.8, 1e-6);
  EXPECT_EQ(this->Errors->Count, 0) << this->Errors->Text;
}

TEST_F(XRayProjectorFilter, MethodsAgree)
{
  if (!mammoray::ListDevices().front().RayTracing)
  {
    GTEST_SKIP() << "no device that traces rays";
  }
  this->Filter->SetInputData(Brick(10, 20, 12));
  this->Filter->SetDetectorOrigin(-3, -2, -5); // the outline is in the picture
  for (const int method : { vtkXRayProjector::RAY_TRACING, vtkXRayProjector::RASTERISATION })
  {
    this->Filter->SetProjectionMethod(method);
    this->Filter->Update();
    EXPECT_EQ(this->Errors->Count, 0) << this->Errors->Text;
    for (vtkIdType pixel = 0; pixel < 20; ++pixel)
    {
      const double x = -3 + 2.0 * static_cast<double>(pixel % 4);
      const double y = -2 + 1.5 * static_cast<double>(pixel / 4);
      ASSERT_NEAR(this->Value("PathLength_1", pixel), x > 0 && y > 0 ? 12 : 0, 1e-6);
    }
  }
}

TEST_F(XRayProjectorFilter, FollowsMovedPointsAndMovedSource)
{
  const auto grid = Brick(10, 20, 12);
  this->Filter->SetInputData(grid);
  this->Filter->Update();
  for (vtkIdType point = 0; point < 8; ++point)
  {
    double p[3];
    grid->GetPoint(point, p);
    grid->GetPoints()->SetPoint(point, p[0], p[1], 0.5 * p[2]);
  }
  grid->GetPoints()->Modified();
  grid->Modified();
  this->Filter->Update();
  EXPECT_NEAR(this->Value("PathLength_1", 7), 6, 1e-6);

  this->Filter->SetKey("source.beam-direction", "[0, 0.6, -0.8]");
  this->Filter->SetDetectorOrigin(1, 8, -1);
  this->Filter->Update();
  EXPECT_NEAR(this->Value("PathLength_1", 0), 6 / 0.8, 1e-6);
  EXPECT_EQ(this->Errors->Count, 0) << this->Errors->Text;
}

TEST_F(XRayProjectorFilter, StandsWhereTheInputSays)
{
  const auto grid = Brick(10, 20, 12);
  // Patient left, anterior and source along world y, -x and z.
  mammoray::AddPlacement(grid, { { 12, 9, -30 }, { 0, 1, 0 }, { -1, 0, 0 }, { 0, 0, 1 } });
  this->Filter->SetInputData(grid);
  this->Filter->PlacedByInputOn();
  this->Filter->SetSourceToDetectorMm(600);
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  vtkImageData* image = this->Filter->GetOutput();
  // Five rows from +x down to -x about the middle, four columns from half a pixel on.
  const double* first = image->GetPoint(0);
  EXPECT_DOUBLE_EQ(first[0], 12 - 1);
  EXPECT_DOUBLE_EQ(first[1], 9 + 3);
  EXPECT_DOUBLE_EQ(first[2], -30);
  std::vector<float> placed;
  for (vtkIdType pixel = 0; pixel < 20; ++pixel)
  {
    placed.push_back(this->Value("PathLength_1", pixel));
  }
  this->Filter->PlacedByInputOff();
  this->Filter->SetKey("source.beam-direction", "");
  this->Filter->SetSourcePosition(12, 9, 570);
  this->Filter->SetDetectorOrigin(11, 12, -30);
  this->Filter->SetColumnDirection(-1, 0, 0);
  this->Filter->SetRowDirection(0, -1, 0);
  this->Filter->Update();
  for (vtkIdType pixel = 0; pixel < 20; ++pixel)
  {
    EXPECT_FLOAT_EQ(placed[pixel], this->Value("PathLength_1", pixel));
  }
  this->Filter->PlacedByInputOn();
  this->Filter->SetInputData(Brick(10, 20, 12));
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_THAT(this->Errors->Text, testing::HasSubstr("Placement"));
}

TEST_F(XRayProjectorFilter, TakesMaterialsAndSpectrumByName)
{
  const auto grid = Brick(10, 20, 12);
  vtkNew<vtkStringArray> names;
  names->SetName(mammoray::MaterialNamesArrayName);
  names->InsertNextValue("air");
  names->InsertNextValue("gland"); // not the table's material 1
  grid->GetFieldData()->AddArray(names);
  this->Filter->SetKey("attenuations.1", "");
  this->Filter->SetKey("attenuations.gland", "0.05/mm");
  this->Filter->SetInputData(grid);
  this->Filter->SetMaterialTable("victre");
  this->Filter->SetSpectrum("W30kVp_Rh50um_Be1mm");
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_NEAR(this->Value("LogAttenuation", 0), 0.6, 1e-6) << "what was said of it goes first";
  this->Filter->SetKey("attenuations.gland", "");
  this->Filter->Update();
  const mammoray::MaterialTable table = mammoray::FindMaterialTable("victre");
  const mammoray::Beam beam = mammoray::MakeBeam(table,
    mammoray::FindSpectrum("W30kVp_Rh50um_Be1mm"), mammoray::DetectorResponse::EnergyIntegrating);
  mammoray::PathLengthImage lengths;
  lengths.Columns = lengths.Rows = 1;
  lengths.Materials = static_cast<int>(table.Materials.size());
  lengths.Lengths.assign(table.Materials.size(), 0.0F);
  lengths.Lengths[static_cast<std::size_t>(table.IndexOf("gland"))] = 12;
  // Both in float.
  EXPECT_NEAR(this->Value("LogAttenuation", 0), beam.LogAttenuation(lengths)[0], 1e-5);
  const double byNames = this->Value("LogAttenuation", 0);
  this->Filter->SetMaterialTable("victor");
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  // A key goes before a property.
  this->Filter->SetKey("materials", mammoray::FindMaterialTablePath("victre").c_str());
  const std::string spectra = mammoray::DataDirectory() + "/spectra/";
  this->Filter->SetKey("beam.spectrum", (spectra + "W28kVp_Rh50um_Be1mm.spc").c_str());
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 1) << this->Errors->Text;
  EXPECT_GT(this->Value("LogAttenuation", 0), 1.01 * byNames) << "28 kV is softer than 30 kV";
  this->Filter->SetKey("beam.spectrum", "");
  this->Filter->Update();
  EXPECT_EQ(this->Value("LogAttenuation", 0), byNames);
}

TEST_F(XRayProjectorFilter, NamesAreTheInputsAgainAfterAScene)
{
  const mammoray::test::TemporaryFolder folder;
  folder.Write("part.obj",
    "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string scene = folder.Write("scene.json", R"({
    "samples": [{ "file": "part.obj", "material": "Al" }], "beam": { "kev": 20 },
    "source": { "beam-direction": [0, 0, -1] },
    "detector": { "origin": [1, 1, -5], "column-direction": [1, 0, 0], "row-direction": [0, 1, 0],
      "columns": 2, "rows": 2, "pixel-spacing": 1 } })");
  const auto grid = Brick(10, 20, 12);
  this->Filter->SetInputData(grid);
  this->Filter->Update();
  EXPECT_NEAR(this->Value("PathLength_1", 0), 12, 1e-6); // floats
  this->Filter->SetKey("source.beam-direction", "");
  this->Filter->SetKey("attenuations.1", "");
  this->Filter->SetSceneFile(scene.c_str());
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_NEAR(this->Value("PathLength_Al", 0), 7, 1e-6) << "x + y + z = 9 at (1, 1)";
  this->Filter->SetSceneFile("");
  this->Filter->SetKey("source.beam-direction", "[0, 0, -1]");
  this->Filter->SetKey("attenuations.1", "0.05/mm");
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_NEAR(this->Value("PathLength_1", 0), 12, 1e-6);
}

TEST_F(XRayProjectorFilter, XRaysTheInputInASceneWithoutSamples)
{
  const mammoray::test::TemporaryFolder folder;
  const std::string scene = folder.Write("scene.json", R"({ "beam": { "kev": 30 },
    "source": { "beam-direction": [0, 0, -1] },
    "detector": { "origin": [1, 1, -5], "column-direction": [1, 0, 0], "row-direction": [0, 1, 0],
      "columns": 3, "rows": 2, "pixel-spacing": 1 } })");
  this->Filter->SetInputData(Brick(10, 20, 12));
  this->Filter->SetSceneFile(scene.c_str());
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfPoints(), 6);
  EXPECT_NEAR(this->Value("LogAttenuation", 0), 0.6, 1e-6);
  // Keys go before the file.
  this->Filter->SetKey("detector.columns", "4");
  this->Filter->SetKey("attenuations.1", "0.1/mm");
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfPoints(), 8);
  EXPECT_NEAR(this->Value("LogAttenuation", 0), 1.2, 1e-6);
  // Neither input nor samples; and a scene that stands nowhere.
  this->Filter->SetInputData(nullptr);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_THAT(this->Errors->Text, testing::HasSubstr("expected an input or a SceneFile"));
  this->Filter->SetKey("source.beam-direction", "");
  this->Filter->SetSceneFile(folder.Write("empty.json", "{}").c_str());
  this->Filter->Update();
  EXPECT_THAT(this->Errors->Text, testing::HasSubstr("empty.json: expected source.position"));
}

TEST_F(XRayProjectorFilter, RefusesKeysAtOnceAndKeepsWhatWasSet)
{
  this->Filter->SetKey("beam.fev", "20");
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_THAT(this->Errors->Text, testing::HasSubstr("no quantity 'beam.fev'"));
  const vtkMTimeType before = this->Filter->GetMTime();
  this->Filter->SetKey("beam.kev", "much");
  EXPECT_EQ(this->Errors->Count, 2);
  EXPECT_THAT(this->Errors->Text, testing::HasSubstr("SetKey beam.kev: expected a number from 1"));
  this->Filter->SetKey("attenuations.1", "0.05/mm");
  EXPECT_EQ(this->Filter->GetMTime(), before);
  this->Filter->SetInputData(Brick(10, 20, 12));
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 2) << this->Errors->Text;
  EXPECT_NEAR(this->Value("LogAttenuation", 0), 0.6, 1e-7);
}

TEST_F(XRayProjectorFilter, PolyDataWithInsideMaterialInAnyOrientation)
{
  for (const bool flipped : { false, true })
  {
    vtkNew<vtkPolyData> surface;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    for (const auto& p :
      std::vector<std::array<double, 3>>{ { 0, 0, 0 }, { 30, 0, 0 }, { 0, 30, 0 }, { 0, 0, 30 } })
    {
      points->InsertNextPoint(p.data());
    }
    for (const auto& t :
      std::vector<std::array<vtkIdType, 3>>{ { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 } })
    {
      cells->InsertNextCell({ t[0], t[flipped ? 2 : 1], t[flipped ? 1 : 2] });
    }
    surface->SetPoints(points);
    surface->SetPolys(cells);
    this->Filter->SetInputData(surface);
    this->Filter->Update();
    EXPECT_EQ(this->Errors->Count, 0) << this->Errors->Text;
    EXPECT_NEAR(this->Value("PathLength_1", 0), 30 - 1 - 1.5, 1e-5); // points are floats here
    EXPECT_EQ(this->Filter->GetNumberOfInconsistentPixels(), 0);
  }
}

TEST_F(XRayProjectorFilter, SaysOnceWhatIsWrong)
{
  const auto grid = Brick(10, 20, 12, 2);
  this->Filter->SetInputData(grid);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_THAT(this->Errors->Text, testing::HasSubstr("material '2'"));
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfPoints(), 0);

  this->Filter->SetKey("attenuations.2", "unobtainium@1");
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 2);
  EXPECT_THAT(this->Errors->Text, testing::HasSubstr("adipose"));

  this->Filter->SetKey("attenuations.2", "adipose@0.92");
  grid->GetCellData()->RemoveArray("Material");
  grid->Modified();
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 3);
  EXPECT_THAT(this->Errors->Text, testing::HasSubstr("Material"));
}
}
