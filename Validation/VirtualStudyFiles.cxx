// SPDX-License-Identifier: Apache-2.0
#include "VirtualStudyFiles.h"

#include "SimulatedMri.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/IO/AtomicFile.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

/// Descriptions and scan options of a maker's headers.
struct HeaderStyle
{
  const char* Maker;
  const char* Localizer;
  const char* Plain;
  const char* Dynamic;
  const char* Enhanced;
  const char* Subtraction;
  const char* Projection;
  const char* T2;
  std::vector<std::string> PlainScanOptions;
  std::vector<std::string> SuppressedScanOptions;
};

HeaderStyle HeadersOf(const std::string& scanner)
{
  if (scanner == "ge")
  {
    return { "GE MEDICAL SYSTEMS", "3-Plane Loc", "Ax T1 non fat sat", "Ph0/Ax VIBRANT",
      "Ph1/Ax VIBRANT", "SUB Ph1-Ph0", "MIP: Sag SUB", "Ax T2 FSE", { "FAST_GEMS", "NPW" },
      { "FAST_GEMS", "EDR_GEMS", "FS" } };
  }
  if (scanner == "philips")
  {
    return { "Philips Medical Systems", "SURVEY", "T1W_TSE_tra", "dyn_eTHRIVE", "dyn_eTHRIVE",
      "sdyn_eTHRIVE subtr", "MIP_sdyn", "T2W_TSE_tra", { "OTHER" }, { "FS" } };
  }
  return { "SIEMENS", "localizer", "t1_tse_tra", "t1_fl3d_tra_dyn_spair", "t1_fl3d_tra_dyn_spair",
    "t1_fl3d_tra_dyn_spair_SUB", "t1_fl3d_tra_dyn_spair_SUB_MIP_SAG", "t2_tse_tra", { "PFP" },
    { "PFP", "SFS" } };
}

/// A grid of voxels of this size in a box, along the patient's axes, with layers from foot to head.
VolumeGrid BoxGrid(const Vector3& low, const Vector3& high, const Vector3& spacing)
{
  VolumeGrid grid;
  grid.Spacing = spacing;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const double length = high[axis] - low[axis];
    grid.Size[axis] = std::max(1, static_cast<int>(std::floor(length / spacing[axis])));
    // Centred in the box: the grid of a box that is symmetric about 0 is symmetric, too.
    grid.Origin[axis] =
      0.5 * (low[axis] + high[axis]) - 0.5 * (grid.Size[axis] - 1) * spacing[axis];
  }
  return grid;
}

VolumeGrid Refined(const VolumeGrid& grid)
{
  VolumeGrid fine = grid;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    fine.Size[axis] *= 2;
    fine.Spacing[axis] /= 2;
    fine.Origin[axis] -= 0.5 * fine.Spacing[axis];
  }
  return fine;
}

/// The field of view, and the tissue in it.
struct ScannedPatient
{
  VolumeGrid Grid;
  LabelVolume Tissue;
  CoilPair Coils;
};

ScannedPatient LieDown(const StudyPatient& patient, const VirtualStudyOptions& options,
  Draws& draws, const ProgressCallback& progress)
{
  // Where the breast hangs to: its outermost points.
  const LabelVolume& rest = patient.Rest;
  std::vector<double> corners;
  for (int k = 0; k < rest.Size[2]; k += 3)
  {
    for (int j = 0; j < rest.Size[1]; j += 3)
    {
      for (int i = 0; i < rest.Size[0]; i += 3)
      {
        if (rest.Voxels[rest.Index(i, j, k)] != 0)
        {
          const Vector3 at = rest.PointAt(i, j, k);
          corners.insert(corners.end(), at.begin(), at.end());
        }
      }
    }
  }
  const std::vector<double> hung = patient.Hang(corners);
  Vector3 low{ 1e30, 1e30, 1e30 };
  Vector3 high{ -1e30, -1e30, -1e30 };
  for (std::size_t index = 0; index < hung.size(); ++index)
  {
    low[index % 3] = std::min(low[index % 3], hung[index]);
    high[index % 3] = std::max(high[index % 3], hung[index]);
  }
  const double nipple = low[1];
  const double side = options.Laterality == 'L' ? 1 : -1;
  // Air in front of the breast, the lung behind it, the body above and below; of both breasts a
  // field that cuts neither off.
  const double half = std::max({ 176.0, -low[0] - 10, high[0] - 10 });
  low = { options.BothBreasts ? -half : low[0] - 15, nipple - 25, low[2] - 30 };
  high = { options.BothBreasts ? half : high[0] + 15, patient.Curve.At(patient.OffMm) + 80,
    high[2] + 30 };

  ScannedPatient scanned;
  scanned.Grid = BoxGrid(low, high, { options.MriPixelMm, options.MriPixelMm, options.MriSliceMm });
  const std::vector<bool> held = patient.Table.Fixed();
  scanned.Tissue = JoinBody(MoveLabels(rest, patient.Hang, Refined(scanned.Grid), progress),
    TissuesOf(patient.Table), patient.Curve, WallThicknessMm(rest, held), options.BothBreasts);
  const Vector3 loop{ side * patient.OffMm, nipple + 20, 0 };
  // Nipple to chest wall: sensitivity falls to between a half and a quarter.
  scanned.Coils.HalfAtMm = draws.Between(60, 100);
  scanned.Coils.Centres = { loop };
  if (options.BothBreasts)
  {
    scanned.Coils.Centres.push_back({ -loop[0], loop[1], loop[2] });
  }
  scanned.Coils.Reference = { loop[0], 0.5 * (nipple + patient.Curve.At(loop[0])), 0 };
  return scanned;
}

/// Files of an export: numbered images without an extension, a hundred in a folder.
class Export
{
public:
  explicit Export(const fs::path& root)
    : Root(root)
  {
  }

  std::string NextFile()
  {
    char folder[16];
    char file[16];
    std::snprintf(folder, sizeof folder, "S%04d", this->Count / 100);
    std::snprintf(file, sizeof file, "IM%06d", ++this->Count);
    const fs::path directory = this->Root / "DICOM" / folder;
    fs::create_directories(directory);
    return (directory / file).string();
  }
  std::vector<std::string> NextFiles(int count)
  {
    std::vector<std::string> files;
    files.reserve(static_cast<std::size_t>(count));
    for (int number = 0; number < count; ++number)
    {
      files.push_back(this->NextFile());
    }
    return files;
  }

private:
  fs::path Root;
  int Count = 0;
};

/// The header fields that all files have in common, or all series of the examination.
DicomHeader ExaminationHeader(const StudyTruth& truth, const char* maker)
{
  DicomHeader header;
  char number[32];
  std::snprintf(number, sizeof number, "VIRTUAL%06u", truth.Seed);
  header.Identity.PatientName = "Virtual^Study";
  header.Identity.PatientId = number;
  header.Identity.PatientBirthDate = "19700101";
  header.Identity.PatientSex = "F";
  header.Identity.StudyDate = "20260112";
  header.Identity.StudyTime = "093000";
  header.Identity.StudyInstanceUid = NewDicomUid();
  header.FrameOfReferenceUid = NewDicomUid();
  header.Manufacturer = maker;
  header.ImageType = { "ORIGINAL", "PRIMARY", "M" };
  header.PatientPosition = "HFP";
  header.SeriesDate = "20260112";
  header.AcquisitionDate = "20260112";
  header.HasScanOptions = true;
  return header;
}

/// Writes the series of the MRI, each numbered and timed after the one before it.
class MriWriter
{
public:
  MriWriter(const ScannedPatient& scanned, const VirtualStudyOptions& options,
    const StudyTruth& truth, Export& files, Draws& draws)
    : Scanned(scanned)
    , Options(options)
    , Style(HeadersOf(truth.Scanner))
    , InOneSeries(truth.Scanner == "philips")
    , Base(ExaminationHeader(truth, this->Style.Maker))
    , Files(files)
    , Draw(draws)
  {
  }

  const DicomIdentity& Identity() const { return this->Base.Identity; }

  void Write(const ProgressCallback& progress)
  {
    this->WriteLocalizer();
    const bool suppressed = this->Options.FatSuppressed;
    // All are simulated, so that the same seed draws the same noise.
    std::vector<IntensityVolume> volumes =
      this->Simulate(this->Scanned.Grid, { PlainT1, SuppressedT1, EnhancedT1, PlainT2 }, progress);
    this->WriteSpinEcho(volumes[3], this->Style.T2, 5600, 100);
    if (this->Options.Plain)
    {
      this->WriteSpinEcho(volumes[0], this->Style.Plain, 650, 11);
    }
    if (!suppressed)
    {
      return;
    }
    DicomHeader dynamic = this->GradientEcho(this->Style.Dynamic);
    const double number = *dynamic.SeriesNumber;
    dynamic.TemporalPosition = this->InOneSeries ? std::optional<double>(1) : std::nullopt;
    this->WriteVolume(volumes[1], dynamic);
    DicomHeader enhanced = this->GradientEcho(this->Style.Enhanced);
    enhanced.ContrastAgent = "GADOVIST";
    if (this->InOneSeries)
    {
      enhanced.SeriesInstanceUid = dynamic.SeriesInstanceUid;
      enhanced.SeriesNumber = number;
      enhanced.TemporalPosition = 2;
      enhanced.ContrastAgent.clear();
    }
    enhanced.AcquisitionNumber = 2;
    this->WriteVolume(volumes[2], enhanced);
    this->WriteDerived(volumes[1], volumes[2]);
  }

private:
  static constexpr double Scale = 900;

  std::vector<IntensityVolume> Simulate(const VolumeGrid& grid,
    const std::vector<TissueSignals>& signals, const ProgressCallback& progress = {})
  {
    return SimulateMri(this->Scanned.Tissue, grid, signals, this->Scanned.Coils,
      1 / this->Options.SignalToNoise, Scale, this->Draw, progress);
  }

  DicomHeader NextSeries(const char* description)
  {
    DicomHeader header = this->Base;
    header.SeriesDescription = description;
    header.ProtocolName = description;
    header.SeriesInstanceUid = NewDicomUid();
    header.SeriesNumber = ++this->Series;
    header.AcquisitionNumber = 1;
    char time[16];
    std::snprintf(time, sizeof time, "09%02d00", 30 + 2 * this->Series);
    header.SeriesTime = time;
    header.AcquisitionTime = time;
    return header;
  }

  DicomHeader GradientEcho(const char* description)
  {
    DicomHeader header = this->NextSeries(description);
    header.ScanningSequence = { "GR" };
    header.AcquisitionType = "3D";
    header.ScanOptions = this->Style.SuppressedScanOptions;
    header.RepetitionTimeMs = 4.8;
    header.EchoTimeMs = 1.9;
    header.FlipAngleDeg = 10;
    return header;
  }

  void WriteVolume(const IntensityVolume& volume, const DicomHeader& header)
  {
    WriteMrSeries(volume, header, this->Files.NextFiles(volume.Size[2]));
  }

  void WriteSpinEcho(const IntensityVolume& volume, const char* description, double trMs,
    double teMs)
  {
    DicomHeader header = this->NextSeries(description);
    header.ScanningSequence = { "SE" };
    header.AcquisitionType = "2D";
    header.ScanOptions = this->Style.PlainScanOptions;
    header.RepetitionTimeMs = trMs;
    header.EchoTimeMs = teMs;
    header.FlipAngleDeg = 150;
    this->WriteVolume(volume, header);
  }

  /// Three slices in each of three directions, in one series.
  void WriteLocalizer()
  {
    DicomHeader header = this->NextSeries(this->Style.Localizer);
    header.ScanningSequence = { "GR" };
    header.AcquisitionType = "2D";
    header.RepetitionTimeMs = 8;
    header.EchoTimeMs = 3.6;
    const VolumeGrid& whole = this->Scanned.Grid;
    for (std::size_t normal = 0; normal < 3; ++normal)
    {
      // Axes in the order row, column, normal, their lengths those of the whole field of view.
      const std::array<std::size_t, 3> axes{ normal == 0 ? std::size_t{ 1 } : std::size_t{ 0 },
        normal == 2 ? std::size_t{ 1 } : std::size_t{ 2 }, normal };
      VolumeGrid slab;
      slab.Origin = whole.Origin;
      for (std::size_t along = 0; along < 3; ++along)
      {
        const std::size_t axis = axes[along];
        const double length = whole.Size[axis] * whole.Spacing[axis];
        slab.Spacing[along] = along == 2 ? length / 4 : 4;
        slab.Size[along] = along == 2 ? 3 : std::max(1, static_cast<int>(length / 4));
        slab.Direction[along] = whole.Direction[axis];
      }
      slab.Origin = slab.Origin + slab.Spacing[2] * slab.Direction[2];
      this->WriteVolume(this->Simulate(slab, { PlainT1 }).front(), header);
    }
  }

  /// Series that a scanner computes: the difference of the phases, and its maximum intensity
  /// projection from the side.
  void WriteDerived(const IntensityVolume& before, const IntensityVolume& after)
  {
    DicomHeader header = this->GradientEcho(this->Style.Subtraction);
    header.ImageType = { "DERIVED", "PRIMARY", "M", "SUB" };
    IntensityVolume difference = after;
    for (std::size_t voxel = 0; voxel < difference.Voxels.size(); ++voxel)
    {
      difference.Voxels[voxel] = std::max(0.0f, after.Voxels[voxel] - before.Voxels[voxel]);
    }
    this->WriteVolume(difference, header);
    IntensityVolume side;
    side.Size = { difference.Size[1], difference.Size[2], 1 };
    side.Spacing = { difference.Spacing[1], difference.Spacing[2],
      difference.Size[0] * difference.Spacing[0] };
    side.Direction = { difference.Direction[1], difference.Direction[2], difference.Direction[0] };
    side.Origin = difference.PointAt(0.5 * (difference.Size[0] - 1), 0, 0);
    for (int k = 0; k < difference.Size[2]; ++k)
    {
      for (int j = 0; j < difference.Size[1]; ++j)
      {
        const auto row =
          difference.Voxels.begin() + static_cast<std::ptrdiff_t>(difference.Index(0, j, k));
        side.Voxels.push_back(*std::max_element(row, row + difference.Size[0]));
      }
    }
    header = this->GradientEcho(this->Style.Projection);
    header.ImageType = { "DERIVED", "SECONDARY", "MIP_SAG", "SUB" };
    this->WriteVolume(side, header);
  }

  const ScannedPatient& Scanned;
  const VirtualStudyOptions& Options;
  HeaderStyle Style;
  bool InOneSeries;
  DicomHeader Base;
  Export& Files;
  Draws& Draw;
  int Series = 0;
};

void WriteViews(const std::vector<Mammogram>& mammograms, const DicomIdentity& patient,
  Export& files, StudyTruth& truth)
{
  DicomIdentity identity = patient;
  identity.StudyInstanceUid = NewDicomUid();
  identity.StudyDate = "20260120";
  for (std::size_t view = 0; view < mammograms.size(); ++view)
  {
    DicomMammogramOptions written;
    written.Identity = identity;
    written.SeriesDescription = std::string(1, truth.Laterality) + ' ' + mammograms[view].View;
    written.Derivation = "Virtual study: X-ray of a compressed phantom, for tests";
    const std::string file = files.NextFile();
    WriteMammogram(mammograms[view], written, file);
    truth.Views[view].File = file;
  }
}
}

void WriteStudyFiles(const StudyPatient& patient, const std::vector<Mammogram>& mammograms,
  const VirtualStudyOptions& options, Draws& draws, const std::string& folder, StudyTruth& truth,
  const ProgressCallback& progress)
{
  WriteAtomicFolder(folder,
    [&](const std::string& written)
    {
      const fs::path temporary(written);
      fs::create_directory(temporary / "export");
      Export files(temporary / "export");
      const ScannedPatient scanned = LieDown(patient, options, draws, progress);
      MriWriter mri(scanned, options, truth, files, draws);
      mri.Write(progress);
      WriteViews(mammograms, mri.Identity(), files, truth);
      // Every export contains some files that are no images.
      WriteAtomicFile((temporary / "export" / "README.TXT").string(), "Patient CD\n");
      WriteAtomicFile((temporary / "export" / "report.pdf").string(), "%PDF-1.4\n");
      for (TrueView& view : truth.Views)
      {
        view.File = fs::path(view.File).lexically_relative(temporary).string();
      }
      WriteStudyTruth(truth, (temporary / "truth.json").string());
    });
}
}
