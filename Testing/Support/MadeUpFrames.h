// SPDX-License-Identifier: Apache-2.0
// Enhanced multi-frame MR objects, byte by byte.
#ifndef mammoray_Testing_MadeUpFrames_h
#define mammoray_Testing_MadeUpFrames_h

#include "DicomBytes.h"

#include <cstring>
#include <string>
#include <vector>

namespace mammoray::test
{
/// A double (FD) in little endian.
inline std::string Fd(double value)
{
  std::string text(sizeof value, '\0');
  std::memcpy(text.data(), &value, sizeof value);
  return text;
}

/// One frame of a made-up object: axial, 5 mm pixels.
struct MadeUpFrame
{
  double HeightMm = 0;
  /// Temporal Position Index, from 1.
  int Phase = 1;
  /// The value of all its pixels, before the rescaling.
  int Value = 0;
  double Slope = 1;
  double Intercept = 0;
  /// Frame Type.
  const char* Type = "ORIGINAL\\PRIMARY\\M\\NONE";
};

struct MadeUpObject
{
  std::string Instance = "1.2.3.4";
  std::string Series = "1.2.7";
  std::string Description = "dyn";
  /// Spectrally Selected Suppression: "FAT", "NONE", ...
  std::string Suppression = "FAT";
  int Rows = 40;
  int Columns = 70;
  std::vector<MadeUpFrame> Frames;
  /// Number of Frames; 0: as many as there are.
  int Said = 0;
};

inline std::string FrameGroups(const MadeUpFrame& frame)
{
  return Sequence(0x18, 0x9226, { Element(8, 0x9007, "CS", frame.Type) }) +
    Sequence(0x20, 0x9111,
      { Element(0x18, 0x9074, "DT", std::to_string(20260110101510 + frame.Phase)) +
        Element(0x20, 0x9128, "UL", Little(static_cast<std::uint32_t>(frame.Phase), 4)) }) +
    Sequence(0x20, 0x9113, { Element(0x20, 0x32, "DS", Join({ -175, -100, frame.HeightMm })) }) +
    Sequence(0x28, 0x9145,
      { Element(0x28, 0x1052, "DS", Join({ frame.Intercept })) +
        Element(0x28, 0x1053, "DS", Join({ frame.Slope })) });
}

/// A prone T1-weighted gradient echo of the same patient as MadeUpMr's.
inline std::string EnhancedMr(const MadeUpObject& object)
{
  const std::string storage = "1.2.840.10008.5.1.4.1.1.4.1";
  std::vector<std::string> groups;
  std::string pixels;
  for (const MadeUpFrame& frame : object.Frames)
  {
    groups.push_back(FrameGroups(frame));
    for (int pixel = 0; pixel < object.Rows * object.Columns; ++pixel)
    {
      pixels += Us(static_cast<std::uint32_t>(frame.Value));
    }
  }
  const std::string shared =
    Sequence(0x18, 0x9112,
      { Element(0x18, 0x80, "DS", "4.3") + Element(0x18, 0x1314, "DS", "10") }) +
    Sequence(0x18, 0x9114, { Element(0x18, 0x9082, "FD", Fd(1.7)) }) +
    Sequence(0x18, 0x9115, { Element(0x18, 0x9025, "CS", object.Suppression) }) +
    Sequence(0x20, 0x9116, { Element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") }) +
    Sequence(0x28, 0x9110, { Element(0x18, 0x50, "DS", "3") + Element(0x28, 0x30, "DS", "5\\5") });
  const std::size_t said =
    object.Said > 0 ? static_cast<std::size_t>(object.Said) : object.Frames.size();
  return DicomBytes(storage, object.Instance,
    Element(8, 8, "CS", "ORIGINAL\\PRIMARY\\M\\NONE") + Element(8, 0x16, "UI", storage) +
      Element(8, 0x18, "UI", object.Instance) + Element(8, 0x20, "DA", "20260110") +
      Element(8, 0x60, "CS", "MR") + Element(8, 0x70, "LO", "Philips") +
      Element(8, 0x103e, "LO", object.Description) + Element(0x10, 0x10, "PN", "Doe^Jane") +
      Element(0x10, 0x20, "LO", "P1") + Element(0x10, 0x30, "DA", "19700101") +
      Element(0x10, 0x40, "CS", "F") + Element(0x18, 0x23, "CS", "3D") +
      Element(0x18, 0x5100, "CS", "HFP") + Element(0x18, 0x9008, "CS", "GRADIENT") +
      Element(0x20, 0xd, "UI", "1.9") + Element(0x20, 0xe, "UI", object.Series) +
      Element(0x20, 0x52, "UI", "1.8") + Element(0x28, 2, "US", Us(1)) +
      Element(0x28, 4, "CS", "MONOCHROME2") + Element(0x28, 8, "IS", std::to_string(said)) +
      Element(0x28, 0x10, "US", Us(static_cast<std::uint32_t>(object.Rows))) +
      Element(0x28, 0x11, "US", Us(static_cast<std::uint32_t>(object.Columns))) +
      Element(0x28, 0x100, "US", Us(16)) + Element(0x28, 0x101, "US", Us(12)) +
      Element(0x28, 0x102, "US", Us(11)) + Element(0x28, 0x103, "US", Us(0)) +
      Sequence(0x5200, 0x9229, { shared }) + Sequence(0x5200, 0x9230, groups) +
      Element(0x7fe0, 0x10, "OW", pixels));
}
}

#endif
