// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

#include <array>

namespace mammoray
{
namespace
{

std::string Decimals(const std::vector<double>& values)
{
  std::string text;
  for (const double value : values)
  {
    text.append(text.empty() ? "" : "\\").append(DecimalString(value));
  }
  return text;
}

/// PS3.3 section C.20.3: x fastest, then y, then z, as ours.
DcmItem Grid(const DisplacementField& field)
{
  const Vector3& row = field.Direction[0];
  const Vector3& column = field.Direction[1];
  DcmItem grid;
  AddTexts(grid,
    { { { 0x0020, 0x0032 }, EVR_DS,
        Decimals({ field.Origin[0], field.Origin[1], field.Origin[2] }) },
      { { 0x0020, 0x0037 }, EVR_DS,
        Decimals({ row[0], row[1], row[2], column[0], column[1], column[2] }) } });
  std::array<std::uint32_t, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    size[axis] = static_cast<std::uint32_t>(field.Size[axis]);
  }
  AddBytes(grid, { 0x0064, 0x0007 }, EVR_UL, size.data(), sizeof size);
  AddBytes(grid, { 0x0064, 0x0008 }, EVR_FD, field.Spacing.data(), sizeof field.Spacing);
  AddBytes(grid, { 0x0064, 0x0009 }, EVR_OF, field.Vectors.data(),
    sizeof(float) * field.Vectors.size());
  return grid;
}
}

void WriteSpatialRegistration(const DisplacementField& field, const std::string& registeredUid,
  const std::string& sourceUid, const DicomIdentity& identity, const std::string& path)
{
  field.ValidateGrid(path, field.Vectors.size() / 3);
  if (Dot(Cross(field.Direction[0], field.Direction[1]), field.Direction[2]) < 0)
  {
    throw InputError(path + ": expected right-handed axes of the grid, found left-handed ones");
  }
  DcmItem data;
  AddCommon(data, "1.2.840.10008.5.1.4.1.1.66.3", "REG", "MRI to the compressed breast", identity);
  AddTexts(data,
    { { { 0x0020, 0x0052 }, EVR_UI, registeredUid }, { { 0x0020, 0x0060 }, EVR_CS, "" },
      { { 0x0020, 0x1040 }, EVR_LO, "" }, { { 0x0070, 0x0080 }, EVR_CS, "COMPRESSED" },
      { { 0x0070, 0x0081 }, EVR_LO, "From the breast between the plates to the MRI" },
      { { 0x0070, 0x0084 }, EVR_PN, "" } });
  DcmItem item;
  AddTexts(item, { { { 0x0064, 0x0003 }, EVR_UI, sourceUid } });
  AddSequence(item, { 0x0070, 0x030d },
    { DicomCode("125024", "Image Content-based Alignment", "DCM") });
  AddSequence(item, { 0x0064, 0x0005 }, { Grid(field) });
  AddSequence(data, { 0x0064, 0x0002 }, { item });
  WriteDicom(data, path);
}
}
