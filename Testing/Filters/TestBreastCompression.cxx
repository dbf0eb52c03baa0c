// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "TestMeshes.h"
#include "mammoray/Filters/vtkBreastCompression.h"
#include "mammoray/IO/MeshConversion.h"

#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTrivialProducer.h"
#include "vtkUnstructuredGrid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace
{
using namespace mammoray;

/// Counts and keeps errors instead of printing them.
class ErrorKeeper : public vtkCommand
{
public:
  static ErrorKeeper* New() { return new ErrorKeeper; }
  void Execute(vtkObject*, unsigned long, void* text) override
  {
    ++this->Count;
    this->Text = static_cast<const char*>(text);
  }
  int Count = 0;
  std::string Text;
};

class BreastCompression : public testing::Test
{
protected:
  void SetUp() override
  {
    // x lateral, y anterior, z up.
    this->Grid =
      ToGrid(test::MakeHalfEllipsoidMesh(40, 45, 38, 6), { "air", "breast", "chest wall" });
    this->Filter->SetInputData(this->Grid);
    this->Filter->SetOrientation("LAS");
    this->Filter->SetMaterial(1, 6, 0.49, false);
    this->Filter->SetMaterial(2, 6, 0.49, true);
    this->Filter->SetThicknessMm(54);
    this->Filter->AddObserver(vtkCommand::ErrorEvent, this->Errors);
  }
  double FieldValue(const char* name)
  {
    vtkDataArray* array = this->Filter->GetOutput()->GetFieldData()->GetArray(name);
    EXPECT_NE(array, nullptr) << name;
    return array ? array->GetTuple1(0) : std::nan("");
  }
  vtkSmartPointer<vtkUnstructuredGrid> Grid;
  vtkNew<vtkBreastCompression> Filter;
  vtkNew<ErrorKeeper> Errors;
};

TEST_F(BreastCompression, SqueezesTheGridBetweenThePlates)
{
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  vtkUnstructuredGrid* output = this->Filter->GetOutput();
  ASSERT_EQ(output->GetNumberOfPoints(), this->Grid->GetNumberOfPoints());
  vtkDataArray* displacement = output->GetPointData()->GetArray("Displacement");
  vtkDataArray* j = output->GetCellData()->GetArray("J");
  vtkDataArray* stress = output->GetCellData()->GetArray("VonMisesStressKPa");
  vtkDataArray* material = output->GetCellData()->GetArray("Material");
  ASSERT_TRUE(displacement && j && stress && material);
  double low = 0, high = 0;
  for (vtkIdType p = 0; p < output->GetNumberOfPoints(); ++p)
  {
    const double* rest = this->Grid->GetPoint(p);
    const Vector3 from{ rest[0], rest[1], rest[2] };
    const double* to = output->GetPoint(p);
    for (int axis = 0; axis < 3; ++axis)
    {
      EXPECT_NEAR(to[axis] - from[axis], displacement->GetComponent(p, axis), 1e-12);
    }
    if (from[1] > 20) // in front of the plates' edges
    {
      low = std::min(low, to[2]);
      high = std::max(high, to[2]);
    }
  }
  // Between the plates; where they touch a coarse mesh there need not be a corner.
  EXPECT_LT(high - low, 54);
  EXPECT_GT(high - low, 50);
  for (vtkIdType c = 0; c < output->GetNumberOfCells(); ++c)
  {
    EXPECT_GT(j->GetTuple1(c), 0.3);
    if (material->GetTuple1(c) == 2)
    {
      EXPECT_NEAR(stress->GetTuple1(c), 0, 1e-9); // held: no strain, no stress
    }
    else
    {
      EXPECT_GT(stress->GetTuple1(c), 0);
    }
  }
  EXPECT_GT(this->FieldValue("PaddleForceN"), 0.5);
  EXPECT_LE(this->FieldValue("LargestPenetrationMm"), 0.054);
  EXPECT_EQ(this->FieldValue("ThicknessMm"), 54);
}

TEST_F(BreastCompression, CarriesAFineGridOnACoarseOne)
{
  this->Filter->Update();
  vtkNew<vtkUnstructuredGrid> alone;
  alone->DeepCopy(this->Filter->GetOutput());
  // The same grid carried along by itself: the simulation's own nodes, which an embedding finds to
  // rounding, and stiffness sampled from voxels of one material.
  vtkNew<vtkTrivialProducer> coarse;
  coarse->SetOutput(this->Grid);
  this->Filter->SetSimulationMeshConnection(coarse->GetOutputPort());
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  vtkUnstructuredGrid* carried = this->Filter->GetOutput();
  EXPECT_EQ(this->FieldValue("InvertedCells"), 0);
  ASSERT_EQ(carried->GetNumberOfPoints(), alone->GetNumberOfPoints());
  for (vtkIdType p = 0; p < carried->GetNumberOfPoints(); ++p)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      EXPECT_NEAR(carried->GetPoint(p)[axis], alone->GetPoint(p)[axis], 1e-3);
    }
  }
  // A finer one of the same shape and chest wall: 1 mm is what the coarse one's flat cells cut off.
  const auto fine = ToGrid(test::MakeHalfEllipsoidMesh(40, 45, 38, { 12, 3, 12 }),
    { "air", "breast", "chest wall" });
  this->Filter->SetInputData(fine);
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  ASSERT_EQ(this->Filter->GetOutput()->GetNumberOfCells(), fine->GetNumberOfCells());
  double low = 0, high = 0;
  for (vtkIdType p = 0; p < fine->GetNumberOfPoints(); ++p)
  {
    const double* to = this->Filter->GetOutput()->GetPoint(p);
    if (fine->GetPoint(p)[1] > 20)
    {
      low = std::min(low, to[2]);
      high = std::max(high, to[2]);
    }
  }
  EXPECT_LT(high - low, 54 + 2);
  EXPECT_GT(high - low, 50);
}

TEST_F(BreastCompression, TellsWhereTheUnitStands)
{
  this->Filter->SetLateralMm(3);
  this->Filter->SetAnteriorMm(4);
  this->Filter->SetForceN(3);
  this->Filter->Update();
  const std::optional<VolumeFromGantry> placed = FindPlacement(this->Filter->GetOutput());
  ASSERT_TRUE(placed);
  const TetrahedralMesh mesh = FromGrid(this->Grid);
  const PoseFrame frame =
    FindPoseFrame(mesh, { false, false, true }, AnatomicalAxes::FromCode("LAS"));
  const auto& [left, anterior, superior] = frame.Axes;
  // Half of the thickness found for the force, and 2 mm of support, below the anchor.
  const Vector3 origin = frame.Anchor + 3.0 * left + 4.0 * anterior -
    (0.5 * this->FieldValue("ThicknessMm") + 2) * superior;
  EXPECT_NEAR(Norm(placed->Origin - origin), 0, 1e-12);
  EXPECT_NEAR(Norm(placed->Z - superior), 0, 1e-12);
}

TEST_F(BreastCompression, TellsThePressureOfThePlates)
{
  this->Filter->Update();
  vtkUnstructuredGrid* output = this->Filter->GetOutput();
  vtkDataArray* pressure = output->GetPointData()->GetArray("ContactPressureKPa");
  ASSERT_TRUE(pressure);
  double largest = 0;
  for (vtkIdType p = 0; p < output->GetNumberOfPoints(); ++p)
  {
    const double* point = output->GetPoint(p);
    const double value = pressure->GetTuple1(p);
    EXPECT_GE(value, 0);
    largest = std::max(largest, value);
    if (std::abs(point[2]) < 15)
    {
      EXPECT_EQ(value, 0); // far from either plate
    }
  }
  // The force over half to twice the area that two flat caps of this breast would have.
  const double mean = 1e3 * this->FieldValue("PaddleForceN") / 2000;
  EXPECT_GT(largest, mean);
  EXPECT_LT(largest, 100 * mean);
}

TEST_F(BreastCompression, IsATimeSeriesFromOpenToClosed)
{
  this->Filter->SetNumberOfTimeSteps(3);
  this->Filter->UpdateInformation();
  vtkInformation* information = this->Filter->GetOutputInformation(0);
  ASSERT_EQ(information->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()), 3);
  EXPECT_EQ(information->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS())[1], 0.5);
  std::vector<double> thickness, force;
  for (const double time : { 0.0, 0.5, 1.0, 0.5 })
  {
    this->Filter->UpdateTimeStep(time);
    ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
    EXPECT_EQ(this->Filter->GetOutput()->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()),
      time);
    thickness.push_back(this->FieldValue("ThicknessMm"));
    force.push_back(this->FieldValue("PaddleForceN"));
  }
  EXPECT_NEAR(force[0], 0, 1e-12); // roundoff of the plates' places
  EXPECT_GT(force[2], force[1]);
  EXPECT_EQ(thickness[2], 54);
  EXPECT_NEAR(thickness[1], 0.5 * (thickness[0] + 54), 1e-9);
  // Back to the same state from the other side, where contact may have been made stiffer to keep
  // its penetration: up to 0.04 mm of the thickness, a tenth of the force for a millimetre.
  EXPECT_NEAR(force[3], force[1], 0.02 * force[1]);
  // Without a series there is no time, and the plates are closed.
  this->Filter->SetNumberOfTimeSteps(1);
  this->Filter->UpdateInformation();
  EXPECT_FALSE(information->Has(vtkStreamingDemandDrivenPipeline::TIME_STEPS()));
  this->Filter->Update();
  EXPECT_EQ(this->FieldValue("ThicknessMm"), 54);
}

TEST_F(BreastCompression, GlidesAlongTheChestWallUnderGravityAndPull)
{
  this->Filter->Update();
  const double held = this->FieldValue("PaddleForceN");
  EXPECT_EQ(this->FieldValue("LargestWallGlideMm"), 0);
  this->Filter->SetChestWallToSliding();
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_GT(this->FieldValue("LargestWallGlideMm"), 1);
  EXPECT_LT(this->FieldValue("LargestWallLiftMm"), 0.5);
  EXPECT_LT(this->FieldValue("PaddleForceN"), held);
  this->Filter->SetChestWallToElastic();
  this->Filter->SetWallStiffness(20, 5);
  this->Filter->SetImagePositionToProne();
  this->Filter->SetPullN(1);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_NE(this->Errors->Text.find("expected the density"), std::string::npos);
  this->Errors->Count = 0;
  this->Filter->SetMaterial(1, 6, 0.49, false, 0, 1);
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_GT(this->FieldValue("LargestWallLiftMm"), 0.005);
  this->Filter->SetWallStiffness(-1, 5);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_NE(this->Errors->Text.find("positive stiffness"), std::string::npos);
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfCells(), 0);
}

TEST_F(BreastCompression, TakesMaterialsOfATableByTheirNames)
{
  this->Filter->Update();
  const double force = this->FieldValue("PaddleForceN");
  // In another order than those of the grid.
  const test::TemporaryFolder folder;
  const std::string table = folder.Write("table.json", R"({ "materials": [
    { "name": "air", "labels": [0] },
    { "name": "Chest-Wall", "labels": [7], "attenuation": "muscle", "density_g_per_cm3": 1.05,
      "youngs_modulus_kpa": 6, "poisson_ratio": 0.49, "fixed": true },
    { "name": "breast", "labels": [3], "attenuation": "adipose", "density_g_per_cm3": 0.95,
      "youngs_modulus_kpa": 6, "poisson_ratio": 0.49 } ] })");
  this->Filter->ClearMaterials();
  this->Filter->SetMaterialTable(table.c_str());
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_NEAR(this->FieldValue("PaddleForceN"), force, 1e-6 * force);
  this->Filter->SetInputData(
    ToGrid(test::MakeHalfEllipsoidMesh(40, 45, 38, 6), { "air", "breast", "rib" }));
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_NE(this->Errors->Text.find("material 'rib' is not in the material table"),
    std::string::npos)
    << this->Errors->Text;
  // Its number's own constants need no name.
  this->Filter->SetMaterial(2, 6, 0.49, true);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1) << this->Errors->Text;
  EXPECT_NEAR(this->FieldValue("PaddleForceN"), force, 1e-6 * force);
}

TEST_F(BreastCompression, StiffensByFungsLaw)
{
  this->Filter->Update();
  const double force = this->FieldValue("PaddleForceN");
  this->Filter->SetMaterial(1, 6, 0.49, false, 3);
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  // A bar at 30 % compression: exp(3 (0.7^2 + 2 / 0.7 - 3)) = 2.8 times the stress; where the
  // plates' edges cut in the strains are larger.
  EXPECT_GT(this->FieldValue("PaddleForceN"), 2 * force);
}

TEST_F(BreastCompression, TakesLinearElements)
{
  this->Filter->Update();
  const double quadratic = this->FieldValue("PaddleForceN");
  this->Filter->SetElementToLinear();
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  // Far stiffer on so few cells, which cannot bend round the plates' edges.
  EXPECT_GT(this->FieldValue("PaddleForceN"), 1.2 * quadratic);
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfCells(), this->Grid->GetNumberOfCells());
  this->Filter->SetElementToQuadratic();
  this->Filter->Update();
  EXPECT_NEAR(this->FieldValue("PaddleForceN"), quadratic, 1e-9 * quadratic);
}

TEST_F(BreastCompression, FindsTheThicknessOfAForce)
{
  this->Filter->SetForceN(3);
  this->Filter->SetTiltDeg(2);
  this->Filter->Update();
  ASSERT_EQ(this->Errors->Count, 0) << this->Errors->Text;
  EXPECT_NEAR(this->FieldValue("PaddleForceN"), 3, 3e-4);
  const double thickness = this->FieldValue("ThicknessMm");
  this->Filter->SetForceN(0);
  this->Filter->SetThicknessMm(thickness);
  this->Filter->Update();
  EXPECT_EQ(this->FieldValue("ThicknessMm"), thickness);
  EXPECT_NEAR(this->FieldValue("PaddleForceN"), 3, 1e-3); // warm, by Newton's tolerance
  this->Filter->SetForceN(-1);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
}

TEST_F(BreastCompression, GoesOnFromTheLastState)
{
  this->Filter->Update();
  this->Filter->SetThicknessMm(52);
  this->Filter->Update();
  vtkNew<vtkUnstructuredGrid> warm;
  warm->DeepCopy(this->Filter->GetOutput());
  vtkNew<vtkBreastCompression> fresh;
  fresh->SetInputData(this->Grid);
  fresh->SetOrientation("LAS");
  fresh->SetMaterial(1, 6, 0.49, false);
  fresh->SetMaterial(2, 6, 0.49, true);
  fresh->SetThicknessMm(52);
  fresh->Update();
  for (vtkIdType p = 0; p < warm->GetNumberOfPoints(); ++p)
  {
    const double* point = warm->GetPoint(p);
    const Vector3 a{ point[0], point[1], point[2] };
    point = fresh->GetOutput()->GetPoint(p);
    // A residual of 1e-8 of the plates' forces.
    EXPECT_LT(Norm(a - Vector3{ point[0], point[1], point[2] }), 1e-3);
  }
}

TEST_F(BreastCompression, RefusesOnceAndEmptiesTheOutput)
{
  this->Filter->ClearMaterials();
  this->Filter->SetMaterial(1, 6, 0.49, false);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_NE(this->Errors->Text.find("material 2 has no elastic constants"), std::string::npos)
    << this->Errors->Text;
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfCells(), 0);
  this->Filter->SetMaterial(2, 6, 0.49, true);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 1);
  EXPECT_GT(this->Filter->GetOutput()->GetNumberOfCells(), 0);
  this->Filter->SetThicknessMm(500);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 2);
  EXPECT_NE(this->Errors->Text.find("thickness from 5 to 150 mm, found 500"), std::string::npos)
    << this->Errors->Text;
}

TEST_F(BreastCompression, StopsWhenAsked)
{
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  this->Filter->AddObserver(vtkCommand::ProgressEvent, stop);
  this->Filter->Update();
  EXPECT_EQ(this->Errors->Count, 0);
  EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfCells(), 0);
}
}
