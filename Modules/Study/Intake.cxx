// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Intake.h"

#include "Private/HeaderRules.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>
#include <utility>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

constexpr const char* DirectoryClass = "1.2.840.10008.1.3.10";

/// All files below a folder, in the order of their paths.
std::vector<std::string> FilesBelow(const std::string& folder)
{
  std::error_code problem;
  if (!fs::exists(folder, problem))
  {
    throw InputError(folder + ": expected the folder of a study, found nothing there");
  }
  if (!fs::is_directory(folder, problem))
  {
    throw InputError(folder + ": expected the folder of a study, found a file");
  }
  std::vector<std::string> files;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied,
    problem);
  for (; !problem && entry != fs::recursive_directory_iterator(); entry.increment(problem))
  {
    std::error_code unreadable;
    if (entry->is_regular_file(unreadable))
    {
      files.push_back(entry->path().string());
    }
  }
  if (problem)
  {
    throw InputError(folder + ": cannot be read (" + problem.message() + ")");
  }
  if (files.empty())
  {
    throw InputError(folder + ": expected the folder of a study, found no file in it");
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The headers of MRI and mammograms; everything else is counted.
std::vector<DicomHeader> ReadHeaders(const std::vector<std::string>& files, Study& study,
  const ProgressCallback& progress)
{
  std::vector<DicomHeader> images;
  std::set<std::string> instances;
  for (std::size_t index = 0; index < files.size(); ++index)
  {
    ReportProgress(progress, static_cast<double>(index) / static_cast<double>(files.size()),
      "reading headers");
    std::vector<DicomHeader> headers;
    try
    {
      headers = ReadDicomHeaders(files[index]);
    }
    catch (const InputError& error)
    {
      study.Damaged.emplace_back(error.what());
      continue;
    }
    const DicomHeader* header = headers.empty() ? nullptr : &headers.front();
    if (!header)
    {
      ++study.NotDicom;
    }
    else if (header->SopClassUid == DirectoryClass)
    {
      ++study.Directories;
    }
    else if (header->Modality != "MR" && !IsMammogram(*header))
    {
      ++study.OtherObjects;
    }
    else if (!header->SopInstanceUid.empty() && !instances.insert(header->SopInstanceUid).second)
    {
      ++study.Copies;
    }
    else
    {
      std::move(headers.begin(), headers.end(), std::back_inserter(images));
    }
  }
  return images;
}

/// Order of acquisition, or of the series' numbers where times are missing.
bool IsEarlier(const StudySeries& a, const StudySeries& b)
{
  const std::string left = MomentOf(a.Header);
  const std::string right = MomentOf(b.Header);
  if (!left.empty() && !right.empty() && left != right)
  {
    return left < right;
  }
  const double first = a.Header.SeriesNumber.value_or(0);
  const double second = b.Header.SeriesNumber.value_or(0);
  return first != second ? first < second : a.Phase < b.Phase;
}

/// What a folder without images holds, for the refusal.
std::string Found(const Study& study, const std::vector<std::string>& files)
{
  const auto packed = std::count_if(files.begin(), files.end(),
    [](const std::string& file)
    {
      const std::string extension = fs::path(file).extension().string();
      return extension == ".zip" || extension == ".gz" || extension == ".7z" ||
        extension == ".rar" || extension == ".tar" || extension == ".iso";
    });
  std::string text = std::to_string(files.size()) + " other file" + (files.size() > 1 ? "s" : "");
  text += packed > 0 ? " (" + std::to_string(packed) + " packed: unpack first)" : "";
  return study.Damaged.empty() ? text : text + ", first of damaged ones: " + study.Damaged.front();
}
}

std::string VolumesText(const Study& study)
{
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t index = 0; index < std::min(study.Series.size(), most); ++index)
  {
    const StudySeries& series = study.Series[index];
    text += (text.empty() ? ": " : ", ") + std::to_string(index + 1) + " '" + series.Description +
      "' (" + std::to_string(series.Slices.size()) + " slices of " +
      std::to_string(series.Header.Columns) + " x " + std::to_string(series.Header.Rows) +
      (series.Phases > 1 ? ", phase " + std::to_string(series.Phase) : "") +
      (series.Grid ? ")" : ", no volume)");
  }
  return study.Series.size() > most ? text + " and more" : text;
}

std::string DamagedText(const Study& study)
{
  const std::size_t count = study.Damaged.size();
  return count == 0 ? ""
    : count == 1
    ? study.Damaged.front()
    : study.Damaged.front() + " (and " + std::to_string(count - 1) + " more damaged files)";
}

namespace
{
/// Whether all slices of a series lie in folders below one.
bool LiesBelow(const StudySeries& series, const std::string& folder)
{
  return std::none_of(series.Slices.begin(), series.Slices.end(),
    [&folder](const DicomSlice& slice)
    {
      std::error_code problem;
      return fs::equivalent(fs::path(slice.Path).parent_path(), folder, problem);
    });
}

/// Why a folder's only series makes no volume. `refusal`: the reader's words, which name the files
/// of doubled slices, but take those of damaged ones for missing.
std::string WhyNoVolume(const std::string& path, const std::string& refusal, const Study& study)
{
  const std::string why = study.Series.empty() ? "" : study.Series.front().WhyNoGrid;
  return !study.Damaged.empty() ? DamagedText(study)
    : why.empty() || !study.Series.front().DoubledFiles.empty()
    ? refusal
    : path + ": expected slices that make a volume, found: " + why;
}
}

FatSuppression FatOfMri(const std::string& path, std::optional<int> series)
{
  std::error_code problem;
  if (!fs::is_directory(path, problem))
  {
    return FatSuppression::Unknown;
  }
  try
  {
    Study study = ReadStudy(path);
    return series                ? VolumeOfNumber(study, *series).Fat
      : study.Series.size() == 1 ? study.Series.front().Fat
                                 : FatSuppression::Unknown;
  }
  catch (const InputError&) // slices of no study, such as PNG
  {
    return FatSuppression::Unknown;
  }
}

IntensityVolume ReadMri(const std::string& path, VolumeAxes axes, std::optional<int> series,
  const ProgressCallback& progress)
{
  std::error_code problem;
  if (!fs::is_directory(path, problem))
  {
    if (series)
    {
      throw InputError(path +
          ": expected a folder of DICOM slices to choose a volume of, found a "
          "file",
        { "Series", std::to_string(*series) });
    }
    return ReadIntensityVolume(path, axes);
  }
  if (series)
  {
    Study study = ReadStudy(path, progress);
    const StudySeries& chosen = VolumeOfNumber(study, *series);
    if (const std::string against = AgainstVolume(chosen); !against.empty())
    {
      Note({ path, "volume " + std::to_string(*series) + " would not have been chosen",
        ": " + against });
    }
    if (!study.Damaged.empty())
    {
      Note({ path, "some of its files are damaged", ": " + DamagedText(study) });
    }
    return ReadIntensitySlices(chosen.Slices, progress);
  }
  std::string refusal;
  try
  {
    return ReadIntensityVolume(path, axes);
  }
  catch (const InputError& error)
  {
    refusal = error.what();
  }
  Study study;
  try
  {
    study = ReadStudy(path, progress);
  }
  catch (const InputError&) // it is no better told by that
  {
    throw InputError(refusal);
  }
  if (study.Series.size() == 1 && study.Series.front().Grid &&
    LiesBelow(study.Series.front(), path))
  {
    return ReadIntensitySlices(study.Series.front().Slices, progress);
  }
  if (study.Series.size() < 2)
  {
    throw InputError(WhyNoVolume(path, refusal, study));
  }
  throw InputError(path + ": expected one volume, found " + std::to_string(study.Series.size()) +
      VolumesText(study),
    { "Series", "", { "Series" } });
}

Study ReadStudy(const std::string& folder, const ProgressCallback& progress)
{
  Study study;
  const fs::path given(folder);
  // A DICOMDIR stands for the folder that it lists.
  std::error_code problem;
  study.Folder = given.filename() == "DICOMDIR" && fs::is_regular_file(given, problem)
    ? given.parent_path().string()
    : folder;
  const std::vector<std::string> files = FilesBelow(study.Folder);
  const std::vector<DicomHeader> images = ReadHeaders(files, study, progress);
  if (images.empty())
  {
    throw InputError(study.Folder +
      ": expected DICOM images of a breast (MRI and mammograms), found " + Found(study, files));
  }
  study.Warnings = CheckOnePatient(images, study.Folder);

  std::vector<DicomHeader> slices;
  for (const DicomHeader& image : images)
  {
    if (image.Modality == "MR")
    {
      slices.push_back(image);
    }
    else
    {
      study.Mammograms.push_back(DescribeMammogram(image));
    }
  }
  study.Series = SplitIntoVolumes(slices);
  std::for_each(study.Series.begin(), study.Series.end(), DescribeSeries);
  std::stable_sort(study.Series.begin(), study.Series.end(), IsEarlier);
  CompareSeries(study.Series);
  ReportProgress(progress, 1, "done");
  return study;
}
}
