// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/LabelMesher.h"

#include "Private/LabelComponents.h"
#include "Private/LabelField.h"
#include "Private/MeshingSteps.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/SurfaceMesh.h"

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

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include <unistd.h>

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

std::string Text(const char* format, double a, double b = 0, double c = 0)
{
  char text[160];
  std::snprintf(text, sizeof(text), format, a, b, c);
  return text;
}

/// Material at a point for CGAL; tells the progress and stops the work from within.
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

/// Size bound by what a point of the mesh belongs to.
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
    if (const auto* patch =
          dimension == 2 ? boost::get<Domain::Surface_patch_index>(&index) : nullptr)
    {
      return std::min(this->Of(patch->first), this->Of(patch->second));
    }
    const auto* subdomain = boost::get<Domain::Subdomain_index>(&index);
    return subdomain ? this->Of(*subdomain) : this->Size;
  }
};

/// Calls a facet bad whose two cells lie in other materials than those that meet at the facet.
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
    const auto& patch = boost::get<Domain::Surface_patch_index>(
      facet.first->get_facet_surface_center_index(facet.second));
    return patch.first == std::min(a, b) && patch.second == std::max(a, b)
      ? Is_bad()
      : Is_bad(Quality(this->SmallestMm2 / radiusMm2));
  }

private:
  Labeller& Label;
  double SmallestMm2;
};

/**
 * Puts points on the interfaces around every component: CGAL looks for interfaces along Voronoi
 * edges only, and would miss what lies between them.
 */
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
    // Close points would make bad cells for good: refinement never takes a point away.
    const double apart = 0.5 * std::min(facetSizeMm, depthMm);
    const int rays = 24;
    for (int ray = 0; ray < rays; ++ray)
    {
      // Points evenly over a sphere along a spiral of the golden angle.
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

/// Components of tissue and enclosed air, each with the places to seed it from, deepest first.
struct SeedPlan
{
  LabelComponents Found;
  std::vector<std::vector<std::size_t>> SeedVoxels;
  std::vector<float> Distance;
};

SeedPlan PlanSeeds(const LabelVolume& volume, const MeshingOptions& options)
{
  SeedPlan plan;
  plan.Found = FindComponents(volume);
  plan.Distance = InterfaceDistance(volume);
  const std::size_t count = plan.Found.Components.size();
  plan.SeedVoxels.resize(count);
  // A small component may be long and thin, so that one place would not do; big ones CGAL follows.
  const double smallMm3 = 8 * std::pow(options.FacetSizeMm, 3);
  std::vector<std::vector<std::size_t>> members(count);
  std::vector<std::size_t> deepest(count, 0);
  std::vector<float> depth(count, -1);
  for (std::size_t voxel = 0; voxel < volume.NumberOfVoxels(); ++voxel)
  {
    const std::uint32_t id = plan.Found.OfVoxel[voxel];
    const double volumeMm3 =
      static_cast<double>(plan.Found.Components[id].Voxels) * volume.VoxelVolume();
    if (volumeMm3 < smallMm3)
    {
      members[id].push_back(voxel);
    }
    if (plan.Distance[voxel] > depth[id])
    {
      depth[id] = plan.Distance[voxel];
      deepest[id] = voxel;
    }
  }
  const auto indexOf = [&](std::size_t voxel)
  {
    const std::size_t row = volume.Size[0];
    const std::size_t slice = row * volume.Size[1];
    return std::array<int, 3>{ static_cast<int>(voxel % row),
      static_cast<int>(voxel / row % volume.Size[1]), static_cast<int>(voxel / slice) };
  };
  for (std::size_t id = 0; id < count; ++id)
  {
    plan.Found.Components[id].Deepest = indexOf(deepest[id]);
    plan.Found.Components[id].DepthMm = depth[id];
    plan.SeedVoxels[id].push_back(deepest[id]);
    std::stable_sort(members[id].begin(), members[id].end(),
      [&](std::size_t a, std::size_t b) { return plan.Distance[a] > plan.Distance[b]; });
    for (const std::size_t voxel : members[id])
    {
      const std::array<int, 3> index = indexOf(voxel);
      const double apart = std::max<double>(options.FacetSizeMm, 2 * plan.Distance[voxel]);
      const bool isNew = std::all_of(plan.SeedVoxels[id].begin(), plan.SeedVoxels[id].end(),
        [&](std::size_t other)
        {
          const std::array<int, 3> otherIndex = indexOf(other);
          return Norm({ (index[0] - otherIndex[0]) * volume.Spacing[0],
                   (index[1] - otherIndex[1]) * volume.Spacing[1],
                   (index[2] - otherIndex[2]) * volume.Spacing[2] }) >= apart;
        });
      if (isNew)
      {
        plan.SeedVoxels[id].push_back(voxel);
      }
    }
  }
  return plan;
}

/// Points far outside: cells of air then lie on all sides of the tissue, for FinishMesh.
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

/// All cells as a mesh in the frame CGAL worked in, those of air with material 0.
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
      throw InputError(
        std::string("meshing: ") + name + ": expected " + expected + Text(", found %g", found));
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

namespace
{
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
  // A reset inserts all points anew, each found by a walk through the whole mesh.
  CGAL::refine_mesh_3(complex, domain, criteria, parameters::no_perturb(), parameters::no_exude(),
    parameters::no_lloyd(), parameters::no_odt(), parameters::no_reset_c3t3());
}

/// True when a step of optimisation met its time limit.
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

/// Finds the sizes that give a number of triangles, coming from coarser ones.
class TriangleAim
{
public:
  TriangleAim(const LabelVolume& volume, const MeshingOptions& options)
    : Wanted(static_cast<double>(options.Triangles))
    , Start(options)
  {
    // A triangle has about 0.6 of the square of its circumradius.
    const double triangles = this->InterfaceArea(volume) / (0.6 * std::pow(options.FacetSizeMm, 2));
    this->CheckMemory();
    this->Scale = std::sqrt(triangles / (FirstShare * this->Wanted));
  }

  /// Facets with the scale of the next attempt; cells inside need not be finer than asked for.
  MeshingOptions Sizes() const
  {
    MeshingOptions options = this->Start;
    const auto multiply = [](std::map<int, double>& sizes, double scale)
    {
      for (auto& [material, size] : sizes)
      {
        size *= scale;
      }
    };
    options.FacetSizeMm *= this->Scale;
    options.FacetDistanceMm *= this->Scale;
    options.LayerFacetSizeMm *= this->Scale;
    multiply(options.FacetSizeOfMaterialMm, this->Scale);
    multiply(options.FacetDistanceOfMaterialMm, this->Scale);
    options.CellSizeMm *= std::max(1.0, this->Scale);
    multiply(options.CellSizeOfMaterialMm, std::max(1.0, this->Scale));
    return options;
  }

  enum class Verdict
  {
    Met,
    /// Refine what is there.
    TooFew,
    /// Begin again, coarser.
    TooMany
  };

  /// Of the mesh made with Sizes(), which are then those of the next attempt.
  Verdict Judge(std::size_t triangles)
  {
    const auto found = static_cast<double>(triangles);
    if (std::abs(found - this->Wanted) <= Tolerance * this->Wanted)
    {
      return Verdict::Met;
    }
    if (++this->Attempts == MostAttempts)
    {
      throw ConvergenceError(
        Text("meshing: expected %.0f triangles, reached %.0f; the facet angle, "
             "layers and small components ask for others",
          this->Wanted, found));
    }
    // Triangles go with the square of the size, on rough interfaces with another power: that of the
    // last two attempts.
    double power = 2;
    if (this->LastTriangles > 0 && found != this->LastTriangles)
    {
      power = std::clamp(
        -std::log(found / this->LastTriangles) / std::log(this->Scale / this->LastScale), 0.8, 3.0);
    }
    this->LastTriangles = found;
    this->LastScale = this->Scale;
    // From far off half of the way, to see the power near the end: too many cannot be undone.
    const double aim =
      this->Wanted > 3 * found ? 0.5 * this->Wanted : (1 - 0.5 * Tolerance) * this->Wanted;
    this->Scale *= std::pow(std::max(found, 1.0) / aim, 1 / power);
    return found < this->Wanted ? Verdict::TooFew : Verdict::TooMany;
  }

private:
  /// mm^2. Throws InputError where there are too few voxels for the triangles.
  double InterfaceArea(const LabelVolume& volume) const
  {
    const std::size_t steps[3] = { 1, static_cast<std::size_t>(volume.Size[0]),
      static_cast<std::size_t>(volume.Size[0]) * volume.Size[1] };
    std::size_t faces = 0;
    double area = 0;
    for (int axis = 0; axis < 3; ++axis)
    {
      std::size_t ofAxis = 0;
      for (std::size_t voxel = steps[axis]; voxel < volume.NumberOfVoxels(); ++voxel)
      {
        ofAxis += volume.Voxels[voxel] != volume.Voxels[voxel - steps[axis]];
      }
      faces += ofAxis;
      area += static_cast<double>(ofAxis) * volume.VoxelVolume() / volume.Spacing[axis];
    }
    const double most = 16.0 * static_cast<double>(faces);
    if (this->Wanted > most)
    {
      throw InputError(Text("triangles: expected at most %.0f, sixteen for each voxel face between "
                            "materials, found %.0f",
        most, this->Wanted));
    }
    return area / 1.5; // stairs in all directions have 1.5 times the area of what they follow
  }

  void CheckMemory() const
  {
    const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
    const double needed = BytesPerTriangle * this->Wanted;
    if (needed > memory)
    {
      throw InputError(
        Text("triangles: %.0f of them take about %.0f GB, expected at most the %.0f GB "
             "of this machine",
          this->Wanted, needed / 1e9, memory / 1e9));
    }
  }

  /// Measured: 8.0 GB for 4.9 million triangles of a volume of 75 million voxels.
  static constexpr double BytesPerTriangle = 1600;
  static constexpr double FirstShare = 0.1;
  /// Half of what is promised; mending the mesh changes the number a little.
  static constexpr double Tolerance = 0.05;
  static constexpr int MostAttempts = 10;

  double Wanted;
  const MeshingOptions& Start;
  double Scale = 1;
  int Attempts = 0;
  double LastTriangles = 0;
  double LastScale = 1;
};

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

  /// All cells, those of air with material 0. `sizes` become those that gave Triangles.
  TetrahedralMesh Run(MeshingOptions& sizes, bool& timeLimitReached)
  {
    Complex complex;
    if (sizes.Triangles > 0)
    {
      this->RefineToCount(sizes, complex);
    }
    else
    {
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

  /// The sizes shrink in steps while the same mesh is refined on, so that no work is done twice.
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
}

MeshingResult MeshMaterials(const LabelVolume& materials, const MeshingOptions& options,
  const ProgressCallback& progress)
{
  const auto start = std::chrono::steady_clock::now();
  options.Validate();
  materials.Validate("volume to mesh");
  ReportProgress(progress, 0.0, "finding components");
  MeshingResult result;
  LabelVolume volume = PrepareVolume(materials, 2);
  result.MergedVoxels = MergeTissue(volume, options.SmallestComponentMm3);
  ReportProgress(progress, 0.02, "finding components");
  const SeedPlan plan = PlanSeeds(volume, options);
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
    // CGAL counts in halves of the box's diagonal.
    parameters::relative_error_bound = 2 * 0.02 * finest / Norm(extent));

  for (const auto& component : plan.Found.Components)
  {
    result.Components += component.Material != 0;
  }
  ReportProgress(progress, labeller.Begin, labeller.Stage);
  MeshingOptions sizes = options;
  result.Mesh = Refiner(volume, domain, plan, labeller).Run(sizes, result.TimeLimitReached);
  FinishMesh(materials, sizes, result.Mesh, Within(progress, labeller.End, 0.99));
  ReportProgress(progress, 0.99, "checking");
  CheckComponents(result.Mesh, volume, plan.Found);
  PlaceInVolumeFrame(volume, result.Mesh);
  result.Mesh.Validate("mesh");
  result.Reports = ReportMaterials(materials, result.Mesh);
  result.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ReportProgress(progress, 1.0, "meshing");
  return result;
}
}
