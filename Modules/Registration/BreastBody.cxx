// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/BreastBody.h"

#include "mammoray/Foundation/Error.h"

#include <string>
#include <utility>

namespace mammoray
{
namespace
{
/// Takes the motion of the unit's own points off velocities of `positions`: rays and pixels move
/// with the unit, and the unit with its support.
void SubtractMotion(const PlateVelocity& unit, const Plate& support,
  const std::vector<double>& positions, std::span<double> velocities)
{
  for (std::size_t index = 0; index < velocities.size(); index += 3)
  {
    const Vector3 carried =
      unit.VelocityAt(support, { positions[index], positions[index + 1], positions[index + 2] });
    for (int axis = 0; axis < 3; ++axis)
    {
      velocities[index + axis] -= carried[axis];
    }
  }
}
}

BreastBody::BreastBody(CompressionSimulation simulation, std::vector<ElasticMaterial> elastic,
  std::vector<int> gland)
  : Simulated(std::move(simulation))
  , ReferenceMaterials(std::move(elastic))
  , Gland(std::move(gland))
{
  for (const int index : this->Gland)
  {
    if (index < 0 || static_cast<std::size_t>(index) >= this->ReferenceMaterials.size())
    {
      throw InputError("breast: expected a material of the " +
        std::to_string(this->ReferenceMaterials.size()) + " known to scale, found number " +
        std::to_string(index));
    }
  }
}

void BreastBody::SetElastic(std::vector<ElasticMaterial> elastic)
{
  this->Simulated.SetMaterials(elastic);
  this->ReferenceMaterials = std::move(elastic);
}

void BreastBody::SetSurface(const std::vector<double>& points)
{
  this->SurfacePoints.emplace(this->Simulated, points);
}

const Embedding& BreastBody::Surface() const
{
  if (!this->SurfacePoints)
  {
    throw InputError("breast: expected a surface to X-ray, found none");
  }
  return *this->SurfacePoints;
}

/// Leaves a simulation alone that has this stiffness.
void BreastBody::SetStiffness(double factor)
{
  std::vector<ElasticMaterial> materials = this->ReferenceMaterials;
  bool differs = false;
  for (const int index : this->Gland)
  {
    materials[index].YoungsModulusKPa *= factor;
    differs = differs ||
      materials[index].YoungsModulusKPa != this->Simulated.Materials()[index].YoungsModulusKPa;
  }
  if (differs)
  {
    this->Simulated.SetMaterials(materials);
  }
}

MaterialDerivative BreastBody::StiffnessVelocity() const
{
  MaterialDerivative velocity(this->ReferenceMaterials.size());
  for (const int index : this->Gland)
  {
    velocity[index].YoungsModulusKPa = this->ReferenceMaterials[index].YoungsModulusKPa;
  }
  return velocity;
}

CompressionState BreastBody::Compress(const UnitPlacement& placement, const BreastPose& pose,
  const CompressionState* start, const ProgressCallback& progress)
{
  this->SetStiffness(pose.Stiffness);
  return this->Simulated.Compress(placement.PlatesAt(pose), start, progress,
    CompressionSimulation::Refusal::AtOnce);
}

CompressionState BreastBody::Adopt(const BreastBody& other, const CompressionState& state,
  double stiffness, const ProgressCallback& progress)
{
  this->SetStiffness(stiffness);
  return this->Simulated.Adopt(other.Simulated, state, progress);
}

VectorFields BreastBody::VelocitiesSeenFromUnit(const UnitPlacement& placement,
  const BreastPose& pose, const CompressionState& state, const Embedding& points,
  const std::vector<double>& positions, const std::vector<int>& wanted)
{
  // The last equilibrium may have been a refused step's, of another stiffness.
  this->SetStiffness(pose.Stiffness);
  const std::vector<PlatePairVelocity> all = placement.PlateVelocitiesAt(pose);
  std::vector<PlatePairVelocity> motions;
  std::vector<MaterialDerivative> stiffening;
  for (const int parameter : wanted)
  {
    if (parameter == StiffnessParameter)
    {
      stiffening.push_back(this->StiffnessVelocity());
    }
    else
    {
      motions.push_back(all[parameter]);
    }
  }
  const Plate support = placement.PlatesAt(pose).Support;
  const VectorFields nodes = this->Simulated.Sensitivities(state, motions, stiffening);
  VectorFields velocities(wanted.size(), positions.size());
  std::size_t motion = 0;
  for (std::size_t field = 0; field < wanted.size(); ++field)
  {
    if (wanted[field] == StiffnessParameter)
    {
      points.Map(nodes[nodes.Count() - 1], velocities[field]);
      continue;
    }
    points.Map(nodes[motion], velocities[field]);
    SubtractMotion(motions[motion].Support, support, positions, velocities[field]);
    ++motion;
  }
  return velocities;
}
}
