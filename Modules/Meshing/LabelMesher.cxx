// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/LabelMesher.h"

#include "Private/LabelField.h"
#include "Private/MeshingSteps.h"
#include "Private/TriangleAim.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Meshes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/assertions_behaviour.h>
#include <CGAL/exude_mesh_3.h>
#include <CGAL/perturb_mesh_3.h>
#include <CGAL/refine_mesh_3.h>

#include <boost/variant/get.hpp>

#include <algorithm>
#include <chrono>
#include <numbers>
#include <sstream>
#include <unordered_map>
#include <variant>

namespace mammoray
{
namespace
{
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
using Point = Kernel::Point_3;
namespace parameters = CGAL::parameters;

/// The value of type T in an index of CGAL, or null. CGAL 5 has boost's variant, CGAL 6 that of the
/// standard library.
template <typename T, typename Index>
const T* As(const Index& index)
{
  if constexpr (requires { std::get_if<T>(&index); })
  {
    return std::get_if<T>(&index);
  }
  else
  {
    return boost::get<T>(&index);
  }
}

/// The material at a point, for CGAL. Also reports progress and stops the work from within.
struct Labeller
{
  const LabelField& Field;
  const ProgressCallback& Progress;
  double ExpectedCalls;
  static constexpr double Begin = 0.1;
  static constexpr double End = 0.6;
  static constexpr const char* Stage = "meshing";
  std::size_t Calls = 0;

  int operator()(const Point& point)
  {
    if (++this->Calls % 65536 == 0)
    {
      const double done = static_cast<double>(this->Calls) / this->ExpectedCalls;
      ReportProgress(this->Progress, Begin + (End - Begin) * (1 - std::exp(-done)), Stage);
    }
    return this->Field.MaterialAt(point.x(), point.y(), point.z());
  }
};

/// Size bound that depends on the material or interface of a point.
struct SizingField
{
  using FT = double;
  using Point_3 = Point;
  using Index = Domain::Index;

  double Size;
  const std::map<int, double>& OfMaterial;

  double Of(int material) const
  {
    const auto found = this->OfMaterial.find(material);
    return found == this->OfMaterial.end() ? this->Size : found->second;
  }
  double operator()(const Point&, int dimension, const Index& index) const
  {
    const auto* patch = As<Domain::Surface_patch_index>(index);
    if (dimension == 2 && patch)
    {
      return std::min(this->Of(patch->first), this->Of(patch->second));
    }
    const auto* subdomain = As<Domain::Subdomain_index>(index);
    return subdomain ? this->Of(*subdomain) : this->Size;
  }
};

/// Marks a facet as bad if its two cells have other materials than those that meet at the facet.
class LayerCriterion
  : public CGAL::Mesh_3::Abstract_criterion<Triangulation, Criteria::Facet_criteria::Visitor>
{
public:
  using Visitor = Criteria::Facet_criteria::Visitor;

  LayerCriterion(Labeller& labeller, double smallestMm)
    : Label(labeller)
    , SmallestMm2(smallestMm * smallestMm)
  {
  }

protected:
  void do_accept(Visitor& visitor) const override { visitor.visit(*this); }
  LayerCriterion* do_clone() const override { return new LayerCriterion(*this); }
  Is_bad do_is_bad(const Triangulation& triangulation,
    const Triangulation::Facet& facet) const override
  {
    const Point& centre = facet.first->get_facet_surface_center(facet.second);
    const double radiusMm2 = CGAL::squared_distance(
      triangulation.point(facet.first, (facet.second + 1) & 3).point(), centre);
    if (radiusMm2 <= this->SmallestMm2)
    {
      return Is_bad();
    }
    const auto materialOf = [&](const Triangulation::Cell_handle& cell)
    { return triangulation.is_infinite(cell) ? 0 : this->Label(triangulation.dual(cell)); };
    const int a = materialOf(facet.first);
    const int b = materialOf(facet.first->neighbor(facet.second));
    const Domain::Index index = facet.first->get_facet_surface_center_index(facet.second);
    const auto* patch = As<Domain::Surface_patch_index>(index);
    return patch && patch->first == std::min(a, b) && patch->second == std::max(a, b)
      ? Is_bad()
      : Is_bad(Quality(this->SmallestMm2 / radiusMm2));
  }

private:
  Labeller& Label;
  double SmallestMm2;
};

/// Puts points on the interfaces around every component. CGAL searches interfaces only along
/// Voronoi edges and would miss those in between.
class Seeder
{
public:
  Seeder(const LabelVolume& volume, const Domain& domain, Labeller& labeller, Complex& complex)
    : Volume(volume)
    , MeshDomain(domain)
    , Label(labeller)
    , Mesh(complex)
  {
  }

  void Shoot(const std::array<int, 3>& voxel, double depthMm, double facetSizeMm)
  {
    const Point centre(voxel[0] * this->Volume.Spacing[0], voxel[1] * this->Volume.Spacing[1],
      voxel[2] * this->Volume.Spacing[2]);
    const int material = this->Label(centre);
    const Vector3& spacing = this->Volume.Spacing;
    const double step = 0.5 * std::min({ spacing[0], spacing[1], spacing[2] });
    // Close points would cause permanently bad cells: refinement never removes a point.
    const double apart = 0.5 * std::min(facetSizeMm, depthMm);
    const int rays = 24;
    for (int ray = 0; ray < rays; ++ray)
    {
      // Spread points evenly over a sphere along a spiral with the golden angle.
      const double height = 1 - (2.0 * ray + 1) / rays;
      const double angle = ray * std::numbers::pi * (3 - std::sqrt(5.0));
      const double radius = std::sqrt(1 - height * height);
      const Kernel::Vector_3 direction(radius * std::cos(angle), radius * std::sin(angle), height);
      Point inside = centre;
      Point outside = centre + step * direction;
      while (this->Label(outside) == material)
      {
        inside = outside;
        outside = outside + step * direction;
        if (!this->Contains(outside))
        {
          break; // only outer air reaches so far
        }
      }
      const auto hit =
        this->MeshDomain.construct_intersection_object()(Kernel::Segment_3(inside, outside));
      if (std::get<2>(hit) != 0 && this->IsFree(std::get<0>(hit), apart))
      {
        this->Insert(std::get<0>(hit), std::get<1>(hit));
      }
    }
  }

private:
  bool Contains(const Point& point) const
  {
    for (int a = 0; a < 3; ++a)
    {
      if (point[a] < 0 || point[a] > (this->Volume.Size[a] - 1) * this->Volume.Spacing[a])
      {
        return false;
      }
    }
    return true;
  }

  bool IsFree(const Point& point, double apart) const
  {
    const auto nearest = this->Mesh.triangulation().nearest_power_vertex(point);
    return CGAL::squared_distance(nearest->point().point(), point) >= apart * apart;
  }

  void Insert(const Point& point, const Domain::Index& index)
  {
    const auto vertex = this->Mesh.triangulation().insert(Triangulation::Weighted_point(point));
    if (vertex != Triangulation::Vertex_handle())
    {
      this->Mesh.set_dimension(vertex, 2);
      this->Mesh.set_index(vertex, index);
    }
  }

  const LabelVolume& Volume;
  const Domain& MeshDomain;
  Labeller& Label;
  Complex& Mesh;
};

/// Adds points far outside, so that cells of air surround the tissue for FinishMesh.
void Surround(const CGAL::Bbox_3& box, Complex& complex)
{
  for (int corner = 0; corner < 8; ++corner)
  {
    const auto at = [&](int axis)
    { return (corner >> axis & 1) != 0 ? 2 * box.max(axis) : -box.max(axis); };
    const auto vertex =
      complex.triangulation().insert(Triangulation::Weighted_point(Point(at(0), at(1), at(2))));
    complex.set_dimension(vertex, 3);
    complex.set_index(vertex, Domain::Index(Domain::Subdomain_index(0)));
  }
}

/// Extracts all cells in CGAL's frame; cells of air have material 0.
TetrahedralMesh Extract(const Complex& complex)
{
  TetrahedralMesh mesh;
  std::unordered_map<const void*, std::int32_t> numberOf;
  for (const auto& cell : complex.triangulation().finite_cell_handles())
  {
    for (int corner = 0; corner < 4; ++corner)
    {
      const auto vertex = cell->vertex(corner);
      const auto [place, fresh] =
        numberOf.emplace(&*vertex, static_cast<std::int32_t>(numberOf.size()));
      if (fresh)
      {
        const auto& point = vertex->point();
        mesh.Points.insert(mesh.Points.end(), { point.x(), point.y(), point.z() });
      }
      mesh.Cells.push_back(place->second);
    }
    mesh.Materials.push_back(complex.is_in_complex(cell) ? complex.subdomain_index(cell) : 0);
  }
  return mesh;
}

void Seed(const LabelVolume& volume, const Domain& domain, const SeedPlan& plan,
  const MeshingOptions& options, Labeller& labeller, Complex& complex)
{
  Seeder seeder(volume, domain, labeller, complex);
  const auto row = static_cast<std::size_t>(volume.Size[0]);
  for (const std::vector<std::size_t>& voxels : plan.SeedVoxels)
  {
    for (const std::size_t voxel : voxels)
    {
      seeder.Shoot({ static_cast<int>(voxel % row), static_cast<int>(voxel / row % volume.Size[1]),
                     static_cast<int>(voxel / row / volume.Size[1]) },
        plan.Distance[voxel], options.FacetSizeMm);
    }
  }
}

void Refine(const Domain& domain, const MeshingOptions& options, Labeller& labeller,
  Complex& complex)
{
  const SizingField facetSize{ options.FacetSizeMm, options.FacetSizeOfMaterialMm };
  const SizingField facetDistance{ options.FacetDistanceMm, options.FacetDistanceOfMaterialMm };
  const SizingField cellSize{ options.CellSizeMm, options.CellSizeOfMaterialMm };
  Criteria criteria(parameters::facet_angle = options.FacetAngleDeg,
    parameters::facet_size = facetSize, parameters::facet_distance = facetDistance,
    parameters::cell_radius_edge_ratio = options.CellRadiusEdgeRatio,
    parameters::cell_size = cellSize);
  if (options.LayerFacetSizeMm > 0)
  {
    criteria.add_facet_criterion(new LayerCriterion(labeller, options.LayerFacetSizeMm));
  }
  // A reset would insert all points again, each located by a walk through the whole mesh.
  CGAL::refine_mesh_3(complex, domain, criteria, parameters::no_perturb(), parameters::no_exude(),
    parameters::no_lloyd(), parameters::no_odt(), parameters::no_reset_c3t3());
}

/// Returns true if a step of the optimisation reached its time limit.
bool Optimise(const Domain& domain, const MeshingOptions& options, Complex& complex)
{
  if (options.OptimisationSeconds == 0 || options.SmallestDihedralDeg == 0)
  {
    return false;
  }
  const auto perturbed =
    CGAL::perturb_mesh_3(complex, domain, parameters::time_limit = options.OptimisationSeconds,
      parameters::sliver_bound = options.SmallestDihedralDeg);
  const auto exuded =
    CGAL::exude_mesh_3(complex, parameters::time_limit = options.OptimisationSeconds,
      parameters::sliver_bound = options.SmallestDihedralDeg);
  return perturbed == CGAL::TIME_LIMIT_REACHED || exuded == CGAL::TIME_LIMIT_REACHED;
}

/// CGAL's part of the work, in the grid frame.
class Refiner
{
public:
  Refiner(const LabelVolume& volume, const Domain& domain, const SeedPlan& plan, Labeller& labeller)
    : Volume(volume)
    , MeshDomain(domain)
    , Plan(plan)
    , Label(labeller)
  {
  }

  /// Returns all cells; cells of air have material 0. `sizes` receives the sizes that produced
  /// MeshingOptions::Triangles.
  TetrahedralMesh Run(MeshingOptions& sizes, bool& timeLimitReached)
  {
    Complex complex;
    if (sizes.Triangles > 0)
    {
      this->RefineToCount(sizes, complex);
    }
    else
    {
      CheckSizes(this->Volume, sizes);
      this->Begin(sizes, complex);
      Refine(this->MeshDomain, sizes, this->Label, complex);
    }
    timeLimitReached = Optimise(this->MeshDomain, sizes, complex);
    return Extract(complex);
  }

private:
  void Begin(const MeshingOptions& sizes, Complex& complex)
  {
    complex.clear();
    Surround(this->MeshDomain.bbox(), complex);
    Seed(this->Volume, this->MeshDomain, this->Plan, sizes, this->Label, complex);
  }

  /// Reduces the sizes in steps and refines the same mesh further, so that no work is repeated.
  void RefineToCount(MeshingOptions& sizes, Complex& complex)
  {
    const MeshingOptions wanted = sizes;
    TriangleAim aim(this->Volume, wanted);
    auto verdict = TriangleAim::Verdict::TooMany;
    while (verdict != TriangleAim::Verdict::Met)
    {
      sizes = aim.Sizes();
      if (verdict == TriangleAim::Verdict::TooMany)
      {
        this->Begin(sizes, complex);
      }
      Refine(this->MeshDomain, sizes, this->Label, complex);
      verdict = aim.Judge(complex.number_of_facets_in_complex());
    }
  }

  const LabelVolume& Volume;
  const Domain& MeshDomain;
  const SeedPlan& Plan;
  Labeller& Label;
};

/// Facets no larger than the cells on their sides, whose refinement would divide them anyway: left
/// to that, CGAL 5.5 crashed with cells of 0.5 mm in facets of 3 mm.
MeshingOptions WithFacetsOfCells(MeshingOptions options)
{
  auto& facets = options.FacetSizeOfMaterialMm;
  for (const auto& [material, cell] : options.CellSizeOfMaterialMm)
  {
    facets.try_emplace(material, options.FacetSizeMm);
  }
  for (auto& [material, facet] : facets)
  {
    const auto cell = options.CellSizeOfMaterialMm.find(material);
    facet = std::min(facet,
      cell == options.CellSizeOfMaterialMm.end() ? options.CellSizeMm : cell->second);
  }
  options.FacetSizeMm = std::min(options.FacetSizeMm, options.CellSizeMm);
  return options;
}
}

MeshingOptions MeshingOptions::Anatomy(const std::vector<int>& thinMaterials)
{
  MeshingOptions options;
  options.CellSizeMm = 5.0;
  options.FacetSizeMm = 3.0;
  options.FacetDistanceMm = 0.5;
  for (const int material : thinMaterials)
  {
    options.FacetSizeOfMaterialMm[material] = 1.2;
    options.FacetDistanceOfMaterialMm[material] = 0.25;
    options.CellSizeOfMaterialMm[material] = 2.0;
  }
  options.LayerFacetSizeMm = 0.5;
  options.OptimisationSeconds = 0;
  return options;
}

void MeshingOptions::Validate() const
{
  const auto need = [](bool good, const char* name, const char* expected, double found)
  {
    if (!good || !std::isfinite(found))
    {
      std::ostringstream text;
      text << "meshing: " << name << ": expected " << expected << ", found " << found;
      throw InputError(text.str());
    }
  };
  need(this->CellSizeMm > 0, "cell size", "a positive number of mm", this->CellSizeMm);
  need(this->FacetSizeMm > 0, "facet size", "a positive number of mm", this->FacetSizeMm);
  for (const auto* sizes :
    { &this->CellSizeOfMaterialMm, &this->FacetSizeOfMaterialMm, &this->FacetDistanceOfMaterialMm })
  {
    for (const auto& [material, size] : *sizes)
    {
      need(size > 0, "size or distance of a material", "a positive number of mm", size);
    }
  }
  need(this->LayerFacetSizeMm >= 0, "layer facet size", "a number of mm of at least 0",
    this->LayerFacetSizeMm);
  need(this->FacetDistanceMm > 0, "facet distance", "a positive number of mm",
    this->FacetDistanceMm);
  need(this->FacetAngleDeg >= 0 && this->FacetAngleDeg <= 30, "facet angle",
    "0 to 30 degrees (refinement need not end above)", this->FacetAngleDeg);
  need(this->CellRadiusEdgeRatio >= 2 || this->CellRadiusEdgeRatio == 0, "cell radius-edge ratio",
    "at least 2 (refinement need not end below), or 0 for none", this->CellRadiusEdgeRatio);
  need(this->SmallestComponentMm3 >= 0, "smallest component", "a number of mm3 of at least 0",
    this->SmallestComponentMm3);
  need(this->SmoothingVoxels >= 0 && this->SmoothingVoxels <= 5, "smoothing", "0 to 5 voxels",
    this->SmoothingVoxels);
  need(this->SmallestDihedralDeg >= 0 && this->SmallestDihedralDeg <= 40, "smallest dihedral angle",
    "0 to 40 degrees", this->SmallestDihedralDeg);
  need(this->OptimisationSeconds >= 0, "optimisation time", "a number of s of at least 0",
    this->OptimisationSeconds);
}

MeshingResult MeshMaterials(const LabelVolume& materials, const MeshingOptions& options,
  const ProgressCallback& progress)
{
  const auto start = std::chrono::steady_clock::now();
  options.Validate();
  MeshingOptions sizes = WithFacetsOfCells(options);
  materials.Validate("volume to mesh");
  ReportProgress(progress, 0.0, "finding components");
  MeshingResult result;
  LabelVolume volume = PrepareVolume(materials, 2);
  result.MergedVoxels = MergeTissue(volume, options.SmallestComponentMm3);
  ReportProgress(progress, 0.02, "finding components");
  const SeedPlan plan = PlanSeeds(volume, sizes.FacetSizeMm);
  ReportProgress(progress, 0.05, "smoothing interfaces");
  const LabelField field(volume, options.SmoothingVoxels);

  const double tissueMm3 =
    std::count_if(volume.Voxels.begin(), volume.Voxels.end(), [](int m) { return m != 0; }) *
    volume.VoxelVolume();
  Labeller labeller{ field, progress,
    1e5 + 2000 * tissueMm3 / std::pow(options.CellSizeMm, 3) + 100.0 * options.Triangles };
  const Vector3 extent{ (volume.Size[0] - 1) * volume.Spacing[0],
    (volume.Size[1] - 1) * volume.Spacing[1], (volume.Size[2] - 1) * volume.Spacing[2] };
  const double finest = std::min({ volume.Spacing[0], volume.Spacing[1], volume.Spacing[2] });
  CGAL::set_warning_handler([](const char*, const char*, const char*, int, const char*) {});
  CGAL::get_default_random() = CGAL::Random(0);
  const Domain domain(
    parameters::function = [&labeller](const Point& point) { return labeller(point); },
    parameters::bounding_object =
      Kernel::Iso_cuboid_3(Point(0, 0, 0), Point(extent[0], extent[1], extent[2])),
    // CGAL's error bound is relative to half of the box's diagonal.
    parameters::relative_error_bound = 2 * 0.02 * finest / Norm(extent));

  for (const auto& component : plan.Components.Components)
  {
    result.Components += component.Material != 0;
  }
  ReportProgress(progress, labeller.Begin, labeller.Stage);
  result.Mesh = Refiner(volume, domain, plan, labeller).Run(sizes, result.TimeLimitReached);
  FinishMesh(materials, sizes, result.Mesh, ShareOf(progress, labeller.End, 0.99));
  ReportProgress(progress, 0.99, "checking");
  CheckComponents(result.Mesh, volume, plan.Components);
  PlaceInVolumeFrame(volume, result.Mesh);
  result.Mesh.Validate("mesh");
  result.Reports = ReportMaterials(materials, result.Mesh);
  result.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ReportProgress(progress, 1.0, "meshing");
  return result;
}
}
