// SPDX-License-Identifier: Apache-2.0
// Files of a made-up clinic's export, of a few pixels each.
#ifndef mammoray_Testing_MadeUpStudy_h
#define mammoray_Testing_MadeUpStudy_h

#include "DicomBytes.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mammoray::test
{
/// The Reason of each series or mammogram.
template <typename T>
std::vector<std::string> ReasonsOf(const std::vector<T>& entries)
{
  std::vector<std::string> reasons;
  for (const T& entry : entries)
  {
    reasons.push_back(entry.Reason);
  }
  return reasons;
}

/// Elements of a header by group and number: their representation and value.
class MadeUpHeader
{
public:
  MadeUpHeader& Set(std::uint16_t group, std::uint16_t element, const std::string& vr,
    const std::string& value)
  {
    this->Elements[{ group, element }] = { vr, value };
    return *this;
  }
  MadeUpHeader& Remove(std::uint16_t group, std::uint16_t element)
  {
    this->Elements.erase({ group, element });
    return *this;
  }
  /// Rows and columns of 16 bits, one value a pixel.
  MadeUpHeader& SetSize(int rows, int columns)
  {
    this->Pixels = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    this->Set(0x28, 2, "US", Us(1)).Set(0x28, 4, "CS", "MONOCHROME2");
    this->Set(0x28, 0x10, "US", Us(static_cast<std::uint32_t>(rows)));
    this->Set(0x28, 0x11, "US", Us(static_cast<std::uint32_t>(columns)));
    this->Set(0x28, 0x100, "US", Us(16)).Set(0x28, 0x101, "US", Us(16));
    return this->Set(0x28, 0x102, "US", Us(15)).Set(0x28, 0x103, "US", Us(0));
  }
  /// The file, all its pixels 257.
  std::string Bytes(const std::string& instance) const
  {
    MadeUpHeader whole = *this;
    whole.Set(8, 0x18, "UI", instance);
    std::string data;
    for (const auto& [tag, value] : whole.Elements)
    {
      data += Element(tag.first, tag.second, value.first, value.second);
    }
    return DicomBytes(this->Elements.at({ 8, 0x16 }).second, instance,
      data + Element(0x7fe0, 0x10, "OW", std::string(2 * this->Pixels, '\1')));
  }

private:
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::pair<std::string, std::string>> Elements;
  std::size_t Pixels = 0;
};

/// A bilateral prone T1 of Siemens, 350 x 200 mm.
inline MadeUpHeader MadeUpMr(const std::string& series, const std::string& description)
{
  MadeUpHeader header;
  header.Set(8, 8, "CS", "ORIGINAL\\PRIMARY\\M").Set(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.4");
  header.Set(8, 0x20, "DA", "20260110").Set(8, 0x60, "CS", "MR").Set(8, 0x70, "LO", "SIEMENS");
  header.Set(8, 0x103e, "LO", description).Set(0x10, 0x10, "PN", "Doe^Jane");
  header.Set(0x10, 0x20, "LO", "P1").Set(0x10, 0x30, "DA", "19700101").Set(0x10, 0x40, "CS", "F");
  header.Set(0x18, 0x20, "CS", "GR").Set(0x18, 0x22, "CS", "PFP").Set(0x18, 0x23, "CS", "3D");
  header.Set(0x18, 0x80, "DS", "4.3").Set(0x18, 0x81, "DS", "1.7").Set(0x18, 0x1314, "DS", "10");
  header.Set(0x18, 0x5100, "CS", "HFP").Set(0x20, 0xd, "UI", "1.9").Set(0x20, 0xe, "UI", series);
  header.Set(0x20, 0x11, "IS", series.substr(series.rfind('.') + 1));
  header.Set(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0").Set(0x20, 0x52, "UI", "1.8");
  header.Set(0x28, 0x30, "DS", "5\\5");
  return header.SetSize(40, 70);
}

inline MadeUpHeader MadeUpMammogram(const std::string& side, const std::string& view,
  bool processing = false)
{
  MadeUpHeader header;
  header.Set(8, 8, "CS", "ORIGINAL\\PRIMARY\\\\");
  header.Set(8, 0x16, "UI",
    processing ? "1.2.840.10008.5.1.4.1.1.1.2.1" : "1.2.840.10008.5.1.4.1.1.1.2");
  header.Set(8, 0x20, "DA", "20260111").Set(8, 0x32, "TM", "101500").Set(8, 0x60, "CS", "MG");
  header.Set(0x10, 0x10, "PN", "Doe^Jane").Set(0x10, 0x20, "LO", "P1");
  header.Set(0x10, 0x30, "DA", "19700101").Set(0x10, 0x40, "CS", "F");
  header.Set(0x18, 0x1164, "DS", "0.1\\0.1");
  header.Set(0x18, 0x11a0, "DS", "52").Set(0x18, 0x5101, "CS", view);
  header.Set(0x20, 0xe, "UI", "1.7").Set(0x20, 0x62, "CS", side);
  return header.SetSize(2, 2);
}

/// Writes into a folder of its own, removed at the end, each file with an instance of its own.
class MadeUpStudy
{
public:
  MadeUpStudy()
    : Root(std::filesystem::path(testing::TempDir()) /
        ("mammoray-study-" + std::to_string(getpid()) + "-" + std::to_string(NextNumber())))
  {
    std::filesystem::create_directories(this->Root);
  }
  ~MadeUpStudy()
  {
    std::error_code ignored;
    std::filesystem::remove_all(this->Root, ignored);
  }
  MadeUpStudy(const MadeUpStudy&) = delete;
  MadeUpStudy& operator=(const MadeUpStudy&) = delete;

  std::string Folder() const { return this->Root.string(); }
  std::string File(const std::string& name) const { return (this->Root / name).string(); }
  void Write(const std::string& name, const std::string& bytes) const
  {
    std::filesystem::create_directories((this->Root / name).parent_path());
    std::ofstream(this->Root / name, std::ios::binary) << bytes;
  }
  void Add(const MadeUpHeader& header, const std::string& folder = "DICOM")
  {
    const std::string number = std::to_string(++this->Files);
    this->Write(folder + "/IM" + number, header.Bytes("1.2.3." + number));
  }
  /// Slices 3 mm apart from head to foot, their numbers in the order of the places.
  void AddSlices(MadeUpHeader header, int count = 40, double from = -60)
  {
    for (int slice = 0; slice < count; ++slice)
    {
      header.Set(0x20, 0x13, "IS", std::to_string(slice + 1));
      header.Set(0x20, 0x32, "DS", Join({ -175, -100, from + 3 * slice }));
      this->Add(header);
    }
  }

private:
  static int NextNumber()
  {
    static int count = 0;
    return ++count;
  }

  std::filesystem::path Root;
  int Files = 0;
};
}

#endif
