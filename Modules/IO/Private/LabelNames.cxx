// SPDX-License-Identifier: Apache-2.0
#include "Private/LabelNames.h"

#include "Private/InputFile.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

namespace mammoray
{
namespace
{
/// In the comments that ITK-SNAP begins its file with.
constexpr const char* DescriptionMark = "itk-snap label description file";

/// Throws InputError if the label has another name already.
void NameLabel(std::map<int, std::string>& names, int label, const std::string& name,
  const std::string& where)
{
  const auto [known, isNew] = names.try_emplace(label, name);
  if (!isNew && known->second != name)
  {
    throw InputError(where + ": expected one name for label " + std::to_string(label) +
      ", found '" + known->second + "' and '" + name + "'");
  }
}

int WholeNumber(const std::map<std::string, std::string>& fields, const std::string& field,
  int least, int otherwise, const std::string& where)
{
  const auto text = fields.find(field);
  int number = otherwise;
  if (text != fields.end() &&
    (!ToPaddedNumber(text->second, number) || number < least || number > 65535))
  {
    throw InputError(where + field + ": expected a whole number from " + std::to_string(least) +
      " to 65535, found '" + text->second + "'");
  }
  return number;
}

/// The name in quotation marks at the end of a line; the seven numbers before it are `numbers`.
bool ReadDescribed(const std::string& line, std::array<double, 7>& numbers, std::string& name)
{
  const auto first = line.find('"');
  const auto last = line.rfind('"');
  if (first == std::string::npos || first == last)
  {
    return false;
  }
  name = line.substr(first + 1, last - first - 1);
  std::istringstream words(line.substr(0, first));
  for (double& number : numbers)
  {
    words >> number;
  }
  std::string more;
  return !words.fail() && !(words >> more) && IsLabel(numbers[0]);
}

std::map<int, std::string> ReadLabelDescription(const std::string& path)
{
  std::map<int, std::string> names;
  std::ifstream file = OpenText(path);
  std::size_t number = 0;
  for (std::string line; ReadLine(file, line);)
  {
    ++number;
    const auto first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] == '#')
    {
      continue;
    }
    std::array<double, 7> numbers{};
    std::string name;
    if (!ReadDescribed(line, numbers, name))
    {
      throw InputError(LineName(path, number) +
        ": expected a label, its colour (3 numbers), transparency, two marks of visibility and "
        "\"NAME\", found '" +
        line.substr(0, 80) + "'");
    }
    if (numbers[0] > 0)
    {
      NameLabel(names, static_cast<int>(numbers[0]), name, path);
    }
  }
  return names;
}

/// What a segment is, by SNOMED CT: category and type of DICOM's CID 7150 and 7163 (breast).
std::string TerminologyOf(const std::string& name)
{
  static const std::map<std::string, std::string> known{
    { "fat", "SCT^85756007^Tissue~SCT^89749009^Fatty tissue of breast" },
    { "gland", "SCT^85756007^Tissue~SCT^1342375003^Breast fibroglandular tissue" },
    { "skin", "SCT^85756007^Tissue~SCT^82038008^Skin of breast" },
    { "chest-wall", "SCT^123037004^Anatomical Structure~SCT^78904004^Chest wall" }
  };
  const auto found = known.find(name);
  return "TerminologyEntry:Segmentation category and type - DICOM master list~" +
    (found == known.end() ? "SCT^85756007^Tissue~SCT^85756007^Tissue" : found->second) +
    "~^^~Anatomic codes - DICOM master list~^^~^^|";
}
}

std::vector<Segment> ReadSegments(const TextHeader& header)
{
  std::map<int, std::map<std::string, std::string>> fieldsOf;
  for (const auto& [key, value] : header.Pairs)
  {
    const auto end = key.find('_');
    int number = 0;
    if (key.starts_with("Segment") && end != std::string::npos &&
      ToNumber(std::string_view(key).substr(7, end - 7), number) && number >= 0)
    {
      fieldsOf[number][key.substr(end + 1)] = value;
    }
  }
  std::vector<Segment> segments;
  std::map<int, std::map<int, std::string>> namesIn;
  for (const auto& [number, fields] : fieldsOf)
  {
    const std::string where = header.Path + ": Segment" + std::to_string(number) + "_";
    const auto textOf = [&fields = fields](const char* field)
    {
      const auto text = fields.find(field);
      return text == fields.end() ? std::string() : text->second;
    };
    Segment segment;
    segment.Name = textOf("Name").empty() ? textOf("ID") : textOf("Name");
    // Before it had layers, 3D Slicer kept each segment in a volume of its own, as 1.
    const int ownLayer = fields.count("LabelValue") > 0 ? 0 : static_cast<int>(segments.size());
    segment.Label = WholeNumber(fields, "LabelValue", 1, 1, where);
    segment.Layer = WholeNumber(fields, "Layer", 0, ownLayer, where);
    if (!segment.Name.empty())
    {
      NameLabel(namesIn[segment.Layer], segment.Label, segment.Name, header.Path);
      segments.push_back(segment);
    }
  }
  return segments;
}

std::map<int, std::string> ReadLabelNames(const std::string& path)
{
  std::map<int, std::string> names;
  if (const std::string extension = ExtensionOf(path); extension == ".nrrd" || extension == ".nhdr")
  {
    for (const Segment& segment : ReadSegments(TextHeader::ReadNrrd(path)))
    {
      names.try_emplace(segment.Label, segment.Name);
    }
  }
  const std::string description = LabelDescriptionOf(path);
  if (!IsLabelDescription(description))
  {
    return names;
  }
  const std::map<int, std::string> described = ReadLabelDescription(description);
  for (const auto& [label, name] : names)
  {
    if (const auto other = described.find(label); other != described.end() && other->second != name)
    {
      throw InputError(path + ": expected one name for label " + std::to_string(label) +
        ", found '" + name + "' in it and '" + other->second + "' in " + description +
        " beside it");
    }
  }
  return names.empty() ? described : names;
}

std::map<std::string, std::string> SegmentPairs(const LabelVolume& volume)
{
  std::map<std::string, std::string> pairs{ { "Segmentation_ContainedRepresentationNames",
                                              "Binary labelmap|" },
    { "Segmentation_SourceRepresentation", "Binary labelmap" },
    { "Segmentation_ReferenceImageExtentOffset", "0 0 0" } };
  // That of the layer: 3D Slicer clips all its segments to that of the first.
  std::string extent;
  for (const int size : volume.Size)
  {
    extent += (extent.empty() ? "0 " : " 0 ") + std::to_string(size - 1);
  }
  int number = 0;
  for (const auto& [label, name] : volume.Names)
  {
    const std::string segment = "Segment" + std::to_string(number++) + "_";
    char color[64];
    const std::array<unsigned char, 3> bytes = LabelColor(label);
    std::snprintf(color, sizeof color, "%.6f %.6f %.6f", bytes[0] / 255.0, bytes[1] / 255.0,
      bytes[2] / 255.0);
    pairs[segment + "ID"] = "Segment_" + std::to_string(label);
    pairs[segment + "Name"] = name;
    pairs[segment + "NameAutoGenerated"] = "0";
    pairs[segment + "Color"] = color;
    pairs[segment + "ColorAutoGenerated"] = "0";
    pairs[segment + "LabelValue"] = std::to_string(label);
    pairs[segment + "Layer"] = "0";
    pairs[segment + "Extent"] = extent;
    pairs[segment + "Tags"] = TerminologyOf(name);
  }
  return pairs;
}

std::string LabelDescription(const LabelVolume& volume)
{
  std::string text = "################################################\n"
                     "# ITK-SnAP Label Description File\n"
                     "# File format:\n"
                     "# IDX   -R-  -G-  -B-  -A--  VIS MSH  LABEL\n"
                     "# IDX: label; R, G, B: colour, 0 to 255; A: opacity, 0 to 1;\n"
                     "# VIS, MSH: shown in slices and as a surface, 0 or 1; LABEL: its name\n"
                     "################################################\n"
                     "    0     0    0    0        0  0  0    \"Clear Label\"\n";
  for (const auto& [label, name] : volume.Names)
  {
    char numbers[80];
    const std::array<unsigned char, 3> color = LabelColor(label);
    std::snprintf(numbers, sizeof numbers, "  %3d   %3d  %3d  %3d        1  1  1    \"", label,
      color[0], color[1], color[2]);
    text += numbers + name + "\"\n";
  }
  return text;
}

std::string LabelDescriptionOf(const std::string& path)
{
  std::string stem = std::filesystem::path(path).filename().string();
  stem.erase(stem.size() - std::min(stem.size(), ExtensionOf(path).size()));
  if (ExtensionOf(stem) == ".seg")
  {
    stem.erase(stem.size() - 4);
  }
  return (std::filesystem::path(path).parent_path() / (stem + ".txt")).string();
}

bool IsLabelDescription(const std::string& path)
{
  std::error_code problem;
  if (!std::filesystem::is_regular_file(path, problem))
  {
    return false;
  }
  std::ifstream file(path);
  std::string head(1000, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  std::transform(head.begin(), head.end(), head.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return head.find(DescriptionMark) != std::string::npos;
}

std::array<unsigned char, 3> LabelColor(int label)
{
  static constexpr std::array<unsigned char, 3> palette[] = { { 230, 159, 0 }, { 86, 180, 233 },
    { 0, 158, 115 }, { 240, 228, 66 }, { 0, 114, 178 }, { 213, 94, 0 }, { 204, 121, 167 },
    { 120, 120, 120 } };
  return palette[(static_cast<std::size_t>(label) + std::size(palette) - 1) % std::size(palette)];
}
}
