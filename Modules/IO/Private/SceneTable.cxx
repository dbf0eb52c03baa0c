// SPDX-License-Identifier: Apache-2.0
// The declarations of all quantities of a scene. Reader, writer, options and documentation follow.
#include "Private/SceneTable.h"

#include "mammoray/Foundation/Numbers.h"

#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

/// The member of a description that holds a quantity.
#define MEMBER(path) ([](auto& scene) -> auto& { return scene.path; })

namespace mammoray
{
namespace
{
using Json = nlohmann::json;
using Kind = SceneQuantity::Kind;
using Use = SceneQuantity::Use;

SceneRow MakeRow(SceneQuantity quantity, std::function<void(SceneDescription&, const Json&)> set,
  std::function<Json(const SceneDescription&)> get)
{
  const Json value = get(SceneDescription());
  if (value.is_number_float())
  {
    quantity.Default = NumberText(value.get<double>());
  }
  else if (value.is_number() || value.is_boolean())
  {
    quantity.Default = value.dump();
  }
  else if (value.is_string())
  {
    quantity.Default = value.get<std::string>();
  }
  return { std::move(quantity), std::move(set), std::move(get) };
}

template <typename Value>
void Assign(const Json& value, Value& member)
{
  member = value.get<Value>();
}
template <typename Value>
void Assign(const Json& value, std::optional<Value>& member)
{
  member = value.get<Value>();
}
template <typename Value>
void Assign(const Json& value, std::map<std::string, Value>& member)
{
  for (const auto& [name, entry] : value.items())
  {
    entry.get_to(member[name]);
  }
}
template <typename Value>
Json AsJson(const Value& member)
{
  return member;
}
template <typename Value>
Json AsJson(const std::optional<Value>& member)
{
  return member ? Json(*member) : Json();
}

/// `member` gives a reference to what holds the quantity.
template <typename Member>
SceneRow Row(SceneQuantity quantity, const Member& member)
{
  return MakeRow(
    std::move(quantity),
    [member](SceneDescription& scene, const Json& value) { Assign(value, member(scene)); },
    [member](const SceneDescription& scene) { return AsJson(member(scene)); });
}

/// Words that stand for values.
template <typename Member, typename Value>
SceneRow ChoiceRow(SceneQuantity quantity, const Member& member,
  const std::vector<std::pair<const char*, Value>>& choices)
{
  for (const auto& [word, value] : choices)
  {
    quantity.Words.emplace_back(word);
  }
  return MakeRow(
    std::move(quantity),
    [member, choices](SceneDescription& scene, const Json& word)
    {
      for (const auto& [known, value] : choices)
      {
        member(scene) = word == known ? value : member(scene);
      }
    },
    [member, choices](const SceneDescription& scene)
    {
      for (const auto& [known, value] : choices)
      {
        if (member(scene) == value)
        {
          return Json(known);
        }
      }
      return Json();
    });
}

SceneQuantity Number(const std::string& key, const std::string& unit, double least, double most,
  const std::string& help, Use use = Use::Rare)
{
  return { key, Kind::Number, help, unit, least, most, {}, use };
}

/// In mm.
SceneQuantity Length(const std::string& key, double least, double most, const std::string& help,
  Use use = Use::Rare)
{
  return { key, Kind::Length, help, "mm", least, most, {}, use };
}

SceneQuantity Whole(const std::string& key, double least, double most, const std::string& help,
  Use use = Use::Rare)
{
  return { key, Kind::WholeNumber, help, "", least, most, {}, use };
}

/// `form`: what help shows in place of a type.
SceneQuantity Other(Kind kind, const std::string& key, const std::string& form,
  const std::string& help, Use use = Use::Rare, std::size_t count = 1)
{
  return { key, kind, help, form, 0, 0, {}, use, count };
}

SceneQuantity DirectionOf(const std::string& key, const std::string& help)
{
  return { key, Kind::Component, help, "X Y Z", -1e6, 1e6, {}, Use::Expert, 3 };
}

SceneQuantity PointOf(const std::string& key, const std::string& help)
{
  return { key, Kind::Length, help, "X Y Z", -MostCoordinateMm, MostCoordinateMm, {}, Use::Expert,
    3 };
}

/// One value or more.
SceneQuantity List(SceneQuantity quantity)
{
  quantity.Count = 0;
  return quantity;
}

SceneQuantity ByMaterial(SceneQuantity quantity)
{
  quantity.IsByMaterial = true;
  return quantity;
}

std::vector<SceneRow> SubjectRows()
{
  const auto unused = [](SceneDescription&, const Json&) {};
  const auto none = [](const SceneDescription&) { return Json(); };
  SceneQuantity unit = Other(Kind::Word, "unit", "", "of all lengths in the scene; default mm");
  unit.Words = { "um", "mm", "cm", "m", "in" };
  SceneQuantity meshUnit =
    Other(Kind::Word, "mesh-unit", "", "of the mesh's numbers; default mm, of glTF m");
  meshUnit.Words = unit.Words;
  return {
    Row(Other(Kind::Text, "description", "", "a text for people"), MEMBER(Description)),
    MakeRow(unit, unused, none),
    Row(Other(Kind::File, "mesh", "",
          "tetrahedra (.vtu .vtk .msh) or surfaces (.vtp .stl .ply .obj .glb .gltf)\n(cell array "
          "Material, "
          "or one material; those of the material table)",
          Use::Daily),
      MEMBER(Mesh)),
    Row(meshUnit, MEMBER(MeshUnit)),
    MakeRow(
      Other(Kind::Table, "materials", "",
        "material table: .json or a shipped one's name (victre, segment, ...)", Use::Daily),
      [](SceneDescription& scene, const Json& value)
      { scene.Materials = value.is_object() ? value.dump() : value.get<std::string>(); },
      [](const SceneDescription& scene)
      {
        return scene.Materials.starts_with('{') ? Json::parse(scene.Materials)
                                                : Json(scene.Materials);
      }),
    Row(ByMaterial(Other(Kind::Text, "attenuations", "",
          "other attenuations of the table's materials by their names, { \"gland\": \"H2O@1.04\" "
          "}\n(a shipped table's name, a NIST compound, a formula or mass fractions; with a "
          "density in g/cm3)")),
      MEMBER(Attenuations)),
    Row(ByMaterial(
          Number("iodine", "mg/ml", 0, 500, "iodine that they have taken up, { \"gland\": 2 }")),
      MEMBER(IodineMgPerMl)),
    MakeRow(Other(Kind::Sample, "samples", "",
              "closed surfaces in place of a mesh: a list of objects (below)", Use::Rare, 0),
      unused, none),
    Row(Other(Kind::Text, "overlap-priority", "MATERIAL",
          "materials by name: where parts overlap, the first of them that is there "
          "counts\n(others follow in the table's order; without it each part counts)",
          Use::Rare, 0),
      MEMBER(OverlapPriority)),
    Row(Other(Kind::Flag, "realistic", "",
          "with noise, blur, heel and scatter\n(a modern unit, as far as nothing else is set: "
          "tungsten tube of 29 kV with 0.05 mm Rh, heel, inverse square, scatter behind 17 mm of "
          "air and a grid 5:1 of 31 lines per cm, half modulation at 5 per mm, 2e7 photons per "
          "mm2, electronic noise of 5 photons)",
          Use::Daily),
      MEMBER(IsRealistic)),
  };
}

std::vector<SceneRow> BeamRows()
{
  SceneQuantity tube = Other(Kind::Word, "beam.tube", "",
    "instead, a tube with this anode\n(up to 42 kV measured spectra of Boone, Fewell and Jennings "
    "1997; above, or with a target angle, computed tungsten without window)",
    Use::Daily);
  tube.Words = { "W", "Mo", "Rh" };
  return {
    Row(Other(Kind::FileOrName, "beam.spectrum", "",
          "spectrum: a file or a shipped one's name\n(.spc, or two columns of energy and photons; "
          "what each may hold: file formats)",
          Use::Expert),
      MEMBER(Spectrum)),
    Row(
      Number("beam.kev", "keV", 1, 500, "a single photon energy instead of a spectrum", Use::Daily),
      MEMBER(EnergyKeV)),
    Row(List(Number("beam.energies", "keV", 1, 500,
          "instead, energies in ascending order, with numbers of photons")),
      MEMBER(EnergiesKeV)),
    Row(List(Number("beam.photons", "", 0, 1e30, "of each energy, any common factor")),
      MEMBER(Photons)),
    Row(tube, MEMBER(Tube.Anode)),
    Row(Number("beam.kvp", "kV", 18, 450, "voltage of the tube; Mo and Rh to 42", Use::Daily),
      MEMBER(Tube.KilovoltagePeak)),
    MakeRow(
      Number("beam.target-angle", "deg", 3, 60,
        "angle between target and central ray of a tungsten tube from 20 kV on\n(default: 12 above "
        "42 kV)"),
      [](SceneDescription& scene, const Json& angle) { angle.get_to(scene.Tube.TargetAngleDeg); },
      [](const SceneDescription& scene)
      {
        const double angle = scene.Tube.TargetAngleDeg;
        return angle != 0 ? Json(angle) : Json();
      }),
    Row(Other(Kind::Text, "beam.filter", "MATERIAL:MM",
          "a layer that all photons pass, once for each\n(MATERIAL[@DENSITY]:MM of an element, a "
          "formula or a NIST compound, 'Air, Dry (near sea level):600')",
          Use::Daily, 0),
      MEMBER(Filters)),
  };
}

/// A vector of the source, which makes it one of this kind.
SceneRow SourceRow(const SceneQuantity& quantity, XRaySource::Kind kind,
  Vector3 XRaySource::*member)
{
  return MakeRow(
    quantity,
    [=](SceneDescription& scene, const Json& value)
    {
      scene.Fixed.Source.Type = kind;
      scene.Fixed.Source.*member = value.get<Vector3>();
    },
    [=](const SceneDescription& scene)
    {
      const XRaySource& source = scene.Fixed.Source;
      return source.Type == kind ? Json(source.*member) : Json();
    });
}

std::vector<SceneRow> SourceRows()
{
  return {
    SourceRow(PointOf("source.position", "of a point source; without it the mammography unit's"),
      XRaySource::Kind::Point, &XRaySource::Position),
    SourceRow(DirectionOf("source.beam-direction",
                "instead, parallel X-rays that travel in this direction"),
      XRaySource::Kind::Parallel, &XRaySource::Direction),
    MakeRow(
      { "source.focal-spot", Kind::Length,
        "edges of the focal spot along the detector's columns and rows; 0: a point", "mm", 0, 100,
        {}, Use::Rare, 2 },
      [](SceneDescription& scene, const Json& edges)
      {
        edges[0].get_to(scene.Fixed.Detection.FocalSpotColumnMm);
        edges[1].get_to(scene.Fixed.Detection.FocalSpotRowMm);
      },
      [](const SceneDescription& scene)
      {
        const ExposureOptions& detection = scene.Fixed.Detection;
        return Json{ detection.FocalSpotColumnMm, detection.FocalSpotRowMm };
      }),
    Row(Whole("source.focal-spot-samples", 1, 32,
          "n x n source points for the focal spot; each costs a projection"),
      MEMBER(Fixed.Detection.FocalSpotSamples)),
    Row(Other(Kind::Flag, "source.inverse-square", "",
          "fewer photons farther from the focus, and where they come in obliquely"),
      MEMBER(Fixed.Field.InverseSquare)),
    MakeRow(
      Number("source.heel.angle", "deg", 0.1, 89.9,
        "heel effect: angle between target and central ray\n(the anode lies along the columns' "
        "direction)"),
      [](SceneDescription& scene, const Json& angle)
      {
        HeelEffect& heel = scene.Fixed.Field.Heel;
        angle.get_to(heel.TargetAngleDeg);
        heel.DepthMm = scene.Has("source.heel.depth-um") ? heel.DepthMm : 0.5e-3;
      },
      [](const SceneDescription& scene)
      {
        const double angle = scene.Fixed.Field.Heel.TargetAngleDeg;
        return angle != 0 ? Json(angle) : Json();
      }),
    MakeRow(
      Number("source.heel.depth-um", "um", 0, 1000,
        "depth of the photons in the target; default 0.5, as at 28 kV (5 at 120 kV, 12 at 225, 29 "
        "at 450)"),
      [](SceneDescription& scene, const Json& value)
      { scene.Fixed.Field.Heel.DepthMm = 1e-3 * value.get<double>(); },
      [](const SceneDescription& scene)
      {
        const HeelEffect& heel = scene.Fixed.Field.Heel;
        return heel.TargetAngleDeg != 0 ? Json(1e3 * heel.DepthMm) : Json();
      }),
  };
}

/// A direction of the detector, of which a description keeps the unit vector.
SceneRow StepRow(const std::string& key, const std::string& help, Vector3 XRayDetector::*step)
{
  return MakeRow(
    DirectionOf(key, help),
    [step](SceneDescription& scene, const Json& value)
    {
      const auto direction = value.get<Vector3>();
      const double length = Norm(direction);
      // A unit vector stays what it is, so that scenes that were written are read alike.
      const bool isUnit = std::abs(length - 1) < 1e-15;
      scene.Fixed.Detector.*step = isUnit ? direction : (1 / length) * direction;
    },
    [step](const SceneDescription& scene) { return Json(scene.Fixed.Detector.*step); });
}

std::vector<SceneRow> DetectorRows()
{
  return {
    Row(PointOf("detector.origin",
          "centre of the pixel in column 0 and row 0; without it the mammography unit's"),
      MEMBER(Fixed.Detector.Origin)),
    StepRow("detector.column-direction", "from a pixel to that of the next column",
      &XRayDetector::ColumnStep),
    StepRow("detector.row-direction", "from a pixel to that of the next row",
      &XRayDetector::RowStep),
    Row(Whole("detector.columns", 1, 65535, "pixels per row", Use::Daily),
      MEMBER(Fixed.Detector.Columns)),
    Row(Whole("detector.rows", 1, 65535, "pixels per column", Use::Daily),
      MEMBER(Fixed.Detector.Rows)),
    Row(Length("detector.pixel-spacing", 1e-6, 1e3,
          "distance of the picture's pixels at the receptor", Use::Daily),
      MEMBER(PixelSpacingMm)),
    Row(Whole("detector.samples", 1, 16,
          "samples x samples rays per pixel; their transmissions are averaged", Use::Expert),
      MEMBER(Fixed.Detector.Samples)),
    ChoiceRow(Other(Kind::Word, "detector.response", "",
                "what the detector adds up: energy, or photons by counting"),
      MEMBER(Fixed.Response.ByEnergy),
      std::vector<std::pair<const char*, bool>>{ { "energy", true }, { "counting", false } }),
    Row(Other(Kind::Text, "detector.scintillator", "MATERIAL[@DENSITY]:MM",
          "only photons that this layer absorbs, 'CsI@4.51:0.15'\n(with all of their energy: no "
          "fluorescence leaves it)"),
      MEMBER(Scintillator)),
    Row(Other(Kind::File, "detector.response-table", "",
          "instead, a file: lines of keV, a comma and the signal of a photon"),
      MEMBER(ResponseTable)),
    Row(Number("detector.photons", "", 0, 1e12,
          "of a pixel without the object; adds quantum noise, 0 none", Use::Daily),
      MEMBER(Fixed.Detection.PhotonsPerPixel)),
    Row(
      Number("detector.electronic-noise", "", 0, 1e6,
        "standard deviation of the detector's own noise, in signals of one photon; needs photons"),
      MEMBER(Fixed.Detection.ElectronicNoisePhotons)),
    Row(Number("detector.half-modulation", "1/mm", 0, 1000,
          "frequency at which the detector's modulation transfer is 1/2; 0 does not blur\n(a "
          "Gaussian, besides that of its pixels; blurs signal and quantum noise; at least 0.1)"),
      MEMBER(Fixed.Detection.HalfModulationPerMm)),
    Row(
      Other(Kind::File, "detector.line-spread", "",
        "instead, its line spread function: a file with lines of mm, a comma and a value\n(from 0 "
        "on, or of both sides, which are averaged; up to 64 pixels far)"),
      MEMBER(LineSpread)),
    Row(Number("detector.gain-spread", "", 0, 0.5,
          "standard deviation of the pixels' gains, relative to 1; the same in every picture"),
      MEMBER(Fixed.Detection.GainSpread)),
    Row(Number("detector.dead-pixels", "", 0, 0.5,
          "fraction of pixels without a signal; the same ones in every picture"),
      MEMBER(Fixed.Detection.DeadPixels)),
    Row(Number("detector.dark-level", "", 0, 10,
          "signal without photons, which is added, relative to that of the open beam"),
      MEMBER(Fixed.Detection.DarkLevel)),
    Row(
      Whole("detector.bits", 0, 16,
        "signals become whole numbers of so many bits, 8 to 16; 0: they do not\n(the open beam has "
        "4/5 of the largest; pictures stay relative to the open beam)"),
      MEMBER(Fixed.Detection.Bits)),
    Row(Whole("detector.seed", 0, std::numeric_limits<int>::max(),
          "of the noise: the same seed, the same image"),
      MEMBER(Fixed.Detection.Seed)),
  };
}

/// The usual grid, with this between its septa.
AntiscatterGridOptions UsualGrid(const std::string& interspace = "fibre")
{
  return AntiscatterGridOptions::OfLead({ 5, 31, 65 }, interspace);
}

/// The grid of a description, which is made where there is none.
AntiscatterGridOptions& GridOf(SceneDescription& scene)
{
  std::optional<AntiscatterGridOptions>& grid = scene.Fixed.Scatter.Grid;
  return grid ? *grid : grid.emplace(UsualGrid());
}

/// A number of the grid; its member is `scale` times as large.
SceneRow GridRow(const SceneQuantity& quantity, double scale,
  double AntiscatterGridOptions::*member)
{
  return MakeRow(
    quantity,
    [=](SceneDescription& scene, const Json& value)
    { GridOf(scene).*member = scale * value.get<double>(); },
    [=](const SceneDescription& scene)
    {
      const auto& grid = scene.Fixed.Scatter.Grid;
      return grid ? Json((*grid).*member / scale) : Json();
    });
}

SceneRow InterspaceRow()
{
  SceneQuantity quantity =
    Other(Kind::Word, "scatter.grid.interspace", "", "what is between the septa; default fibre");
  quantity.Words = { "fibre", "air", "aluminium" };
  return MakeRow(
    quantity,
    [](SceneDescription& scene, const Json& word)
    {
      const AntiscatterGridOptions filled = UsualGrid(word.get<std::string>());
      GridOf(scene).Interspace = filled.Interspace;
      GridOf(scene).InterspaceDensityGPerCm3 = filled.InterspaceDensityGPerCm3;
    },
    [words = quantity.Words](const SceneDescription& scene)
    {
      const auto& grid = scene.Fixed.Scatter.Grid;
      for (const std::string& word : words)
      {
        if (grid && grid->Interspace == UsualGrid(word).Interspace)
        {
          return Json(word);
        }
      }
      return Json();
    });
}

std::vector<SceneRow> ScatterRows()
{
  using Model = SceneScatter::Model;
  return {
    ChoiceRow(
      Other(Kind::Word, "scatter.method", "",
        "add what is scattered\n(by kernels, from the thickness along each ray, or by following "
        "scatter.photons photons through the materials, whose compositions must be known)",
        Use::Daily),
      MEMBER(Fixed.Scatter.Method),
      std::vector<std::pair<const char*, Model>>{ { "kernels", Model::Kernels },
        { "monte-carlo", Model::MonteCarlo } }),
    Row(Other(Kind::FileOrName, "scatter.kernels", "",
          "kernels: those of breast tissue (breast), made for the scene's materials by Monte Carlo "
          "with scatter.photons photons (scene), or a file"),
      MEMBER(Kernels)),
    Row(Length("scatter.air-gap", 0, 2000,
          "of kernels: from the back of the tissue to the detector\n(of 'mammoray project' by "
          "default the height of the unit's support)"),
      MEMBER(Fixed.Scatter.AirGapMm)),
    Row(Number("scatter.photons", "", 1, 1e12,
          "photons to follow for each picture, for the dose, and for kernels of the scene"),
      MEMBER(Fixed.Scatter.Photons)),
    Row(Length("scatter.voxel", 0.05, 10, "edge of the voxels through which photons are followed"),
      MEMBER(VoxelMm)),
    GridRow(Number("scatter.grid.ratio", "", 1, 30,
              "focused anti-scatter grid of lead along the chest wall: its ratio; default 5"),
      1, &AntiscatterGridOptions::Ratio),
    GridRow(Number("scatter.grid.lines-per-cm", "1/cm", 5, 200, "of the grid; default 31"), 0.1,
      &AntiscatterGridOptions::LinesPerMm),
    GridRow(Number("scatter.grid.septum-um", "um", 0.1, 2000, "thickness of its septa; default 65"),
      1e-3, &AntiscatterGridOptions::SeptumMm),
    InterspaceRow(),
    Row(Other(Kind::Flag, "dose", "", "also the mean dose of each material, by following photons",
          Use::Daily),
      MEMBER(Fixed.Dose)),
  };
}

std::vector<SceneRow> RefractionRows()
{
  using Law = RefractionOptions::Law;
  return {
    ChoiceRow(Other(Kind::Word, "refraction.law", "",
                "bend rays by geometric optics or by the near field of the transport of "
                "intensity\n(materials need compositions)"),
      MEMBER(Fixed.Refraction),
      std::vector<std::pair<const char*, std::optional<Law>>>{ { "geometric", Law::Geometric },
        { "near-field", Law::NearField } }),
    Row(Length("refraction.distance", 0, MostCoordinateMm,
          "from where rays are bent to the detector\n(default: from the middle of the samples)"),
      MEMBER(Fixed.BendDistanceMm)),
  };
}
}

const std::vector<SceneRow>& SceneRows()
{
  static const std::vector<SceneRow> rows = []()
  {
    std::vector<SceneRow> all;
    for (const auto part :
      { SubjectRows, SourceRows, DetectorRows, BeamRows, ScatterRows, RefractionRows })
    {
      for (SceneRow& row : part())
      {
        all.push_back(std::move(row));
      }
    }
    return all;
  }();
  return rows;
}
}

#undef MEMBER
