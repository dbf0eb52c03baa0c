// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/LabelVolumeIO.h"

#include "Private/InputFile.h"
#include "Private/QuietStandardError.h"
#include "Private/VolumeFile.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/ScratchFolder.h"

#include <itkDisplacementFieldTransform.h>
#include <itkHDF5TransformIO.h>
#include <itkTxtTransformIO.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace mammoray
{
namespace
{
using Transform = itk::DisplacementFieldTransform<double, 3>;

Transform::Pointer ToItk(const DisplacementField& field)
{
  using Image = Transform::DisplacementFieldType;
  const auto image = Image::New();
  Image::SizeType size;
  Image::PointType origin;
  Image::SpacingType spacing;
  Image::DirectionType direction;
  for (unsigned axis = 0; axis < 3; ++axis)
  {
    size[axis] = static_cast<itk::SizeValueType>(field.Size[axis]);
    origin[axis] = field.Origin[axis];
    spacing[axis] = field.Spacing[axis];
    for (unsigned component = 0; component < 3; ++component)
    {
      direction[component][axis] = field.Direction[axis][component];
    }
  }
  image->SetRegions(size);
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  image->SetDirection(direction);
  image->Allocate();
  std::copy(field.Vectors.begin(), field.Vectors.end(),
    image->GetBufferPointer()->GetDataPointer());
  const auto transform = Transform::New();
  transform->SetDisplacementField(image);
  return transform;
}

void WriteTransform(const Transform* transform, itk::TransformIOBaseTemplate<double>& writer,
  const std::string& path)
{
  itk::TransformIOBaseTemplate<double>::ConstTransformListType transforms;
  transforms.push_back(transform);
  writer.SetTransformList(transforms);
  writer.SetUseCompression(true);
  writer.SetFileName(path);
  writer.Write();
}

/// HDF5 writes to no file in memory and does not tell of a full disk: a file that was read again is
/// whole.
std::string Hdf5Bytes(const Transform* transform)
{
  const ScratchFolder scratch;
  const std::string path = scratch.File("transform.h5");
  const QuietStandardError quiet;
  WriteTransform(transform, *itk::HDF5TransformIO::New(), path);
  const auto reader = itk::HDF5TransformIO::New();
  reader->SetFileName(path);
  reader->Read();
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

bool IsTransformExtension(const std::string& extension)
{
  return extension == ".h5" || extension == ".tfm";
}

void WriteDisplacementTransform(const DisplacementField& field, const std::string& path)
{
  const Transform::Pointer transform = ToItk(field);
  try
  {
    if (ExtensionOf(path) == ".h5")
    {
      WriteAtomicFile(path, Hdf5Bytes(transform));
      return;
    }
    WriteAtomicFile(path,
      [&](const std::string& staged)
      { WriteTransform(transform, *itk::TxtTransformIO::New(), staged); });
  }
  catch (const itk::ExceptionObject& error)
  {
    throw InputError(path + ": cannot be written (" + error.GetDescription() + ")");
  }
}
}

void CheckDisplacementExtension(const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  if (!IsTransformExtension(extension) && !IsVolumeExtension(extension))
  {
    throw InputError(path +
      ": expected the extension .nrrd, .mha, .nii.gz, .h5 or .tfm for a displacement, found '" +
      extension + "'");
  }
}

void WriteDisplacement(const DisplacementField& field, const std::string& path)
{
  CheckDisplacementExtension(path);
  field.ValidateGrid(path, field.Vectors.size() / 3);
  const auto bad = std::find_if_not(field.Vectors.begin(), field.Vectors.end(),
    [](float value) { return std::isfinite(value); });
  if (field.Vectors.size() % 3 != 0 || bad != field.Vectors.end())
  {
    throw InputError(path + ": expected three finite numbers for each voxel, found " +
      (bad != field.Vectors.end() ? "others" : std::to_string(field.Vectors.size()) + " numbers"));
  }
  if (IsTransformExtension(ExtensionOf(path)))
  {
    WriteDisplacementTransform(field, path);
    return;
  }
  WriteVolumeFile(path, field, field.Vectors.data(), 3);
}
}
