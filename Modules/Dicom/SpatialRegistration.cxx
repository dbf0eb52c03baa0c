// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

namespace mammoray
{
namespace
{
/// PS3.3 section C.20.3: x fastest, then y, then z, as ours.
DcmItem Grid(const DisplacementField& field)
{
  const Vector3& row = field.Direction[0];
  const Vector3& column = field.Direction[1];
  DcmItem grid = Item({ { DCM_ImagePositionPatient, field.Origin },
    { DCM_ImageOrientationPatient, { row[0], row[1], row[2], column[0], column[1], column[2] } },
    { DCM_GridDimensions, std::vector<double>(field.Size.begin(), field.Size.end()) },
    { DCM_GridResolution, field.Spacing } });
  AddBulk(grid, DCM_VectorGridData, field.Vectors);
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
  AddCommon(data, UID_DeformableSpatialRegistrationStorage, "REG", "MRI to the compressed breast",
    identity);
  Add(data,
    { { DCM_FrameOfReferenceUID, registeredUid }, { DCM_Laterality, "" },
      { DCM_PositionReferenceIndicator, "" }, { DCM_ContentLabel, "COMPRESSED" },
      { DCM_ContentDescription, "From the breast between the plates to the MRI" },
      { DCM_ContentCreatorName, "" },
      { DCM_DeformableRegistrationSequence,
        Item({ { DCM_SourceFrameOfReferenceUID, sourceUid },
          { DCM_RegistrationTypeCodeSequence,
            DicomCode("125024", "Image Content-based Alignment", "DCM") },
          { DCM_DeformableRegistrationGridSequence, Grid(field) } }) } });
  WriteDicom(data, path);
}
}
