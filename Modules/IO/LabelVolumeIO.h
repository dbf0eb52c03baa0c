// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelVolumeIO_h
#define mammoray_LabelVolumeIO_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayIOModule.h"

#include <array>
#include <string>
#include <vector>

namespace mammoray
{
/// How the axes of a file are turned into those of the volume frame.
enum class VolumeAxes
{
  /**
   * The file's axes are converted to DICOM LPS. NRRD states them by its `space` (RAS and LAS are
   * converted; no space or an anonymous one is taken as LPS); MetaImage is LPS; NIfTI is RAS if its
   * sform or qform code is not 0.
   */
  Patient,
  /// The header's numbers are used as they are, whatever patient axes they state.
  AsGiven
};

/// Returns AsGiven if the axes of the file are to be used as they are.
inline VolumeAxes AxesOf(bool asGiven)
{
  return asGiven ? VolumeAxes::AsGiven : VolumeAxes::Patient;
}

/**
 * Reads a label volume with its full geometry, including oblique axes, from NRRD (.nrrd; .nhdr with
 * one data file; raw or gzip), MetaImage (.mha; .mhd with one data file; raw or compressed) or
 * NIfTI-1 (.nii, .nii.gz; sform if its code is 1 or there is no qform, otherwise qform; a note if
 * they differ by half a voxel).
 *
 * The volume has three dimensions (NIfTI may add dimensions of size 1) and any scalar type with
 * whole values in [0, 65535]. Its Names are those of 3D Slicer's segments in an NRRD's header, or
 * else those of a label description of ITK-SNAP beside the file (LabelDescriptionOf); where both
 * are there, they must agree. Throws InputError, one line that names the file, if it is missing,
 * short or damaged, on other dimensions, types, encodings or sheared axes, and on a value that is
 * no label, with its position. Memory grows with the data in the file, not with what the header
 * promises.
 */
MAMMORAYIO_EXPORT LabelVolume ReadLabelFile(const std::string& path,
  VolumeAxes axes = VolumeAxes::Patient);

/// Reads an MRI or another image with any finite values from the same formats. Throws InputError as
/// ReadLabelFile does.
MAMMORAYIO_EXPORT IntensityVolume ReadIntensityFile(const std::string& path,
  VolumeAxes axes = VolumeAxes::Patient);

/// True for a whole number from 0 to 65535, which a LabelVolume can hold.
MAMMORAYIO_EXPORT bool IsLabel(double value);

/// The error for any other value; `place` is the start of its message.
MAMMORAYIO_EXPORT InputError NoLabel(const std::string& place, double value);

/// Throws InputError unless WriteLabelVolume knows the path's extension.
MAMMORAYIO_EXPORT void CheckLabelVolumeExtension(const std::string& path);

/// Path of the label description of ITK-SNAP that belongs to a volume file: "labels.txt" for
/// "labels.nii.gz" and "labels.seg.nrrd".
MAMMORAYIO_EXPORT std::string LabelDescriptionOf(const std::string& path);
/// True for a file that ITK-SNAP's comment on label descriptions begins.
MAMMORAYIO_EXPORT bool IsLabelDescription(const std::string& path);

/// Returns true for .seg.nrrd, which holds the names of labels as 3D Slicer knows them. For other
/// formats they stand in the LabelDescriptionOf the file.
MAMMORAYIO_EXPORT bool HoldsLabelNames(const std::string& path);

/// Red, green and blue of a label in pictures and files, from 1: Okabe and Ito's colours, which the
/// colour-blind can tell apart; they repeat after eight labels.
MAMMORAYIO_EXPORT std::array<unsigned char, 3> LabelColor(int label);

/**
 * Writes labels as .nrrd (gzip), .mha (compressed) or .nii.gz (NIfTI-1) with 8 bits per voxel if
 * that is enough, otherwise 16. The file's frame is LPS. Names, if there are any, are written with
 * colours: into a .seg.nrrd as 3D Slicer's segments with terms of SNOMED CT, otherwise as
 * LabelDescriptionOf the file. Throws InputError on another extension and if a file cannot be
 * written.
 */
MAMMORAYIO_EXPORT void WriteLabelVolume(const LabelVolume& volume, const std::string& path);

/// Writes intensities as 32-bit floats in the formats of WriteLabelVolume.
MAMMORAYIO_EXPORT void WriteIntensityVolume(const IntensityVolume& volume, const std::string& path);

/// A transform of points: the point at a voxel's centre is moved by the voxel's vector.
struct DisplacementField : VolumeGrid
{
  /// 3 x voxels, mm in the volume frame: x, y, z of one voxel, then of the next, i fastest.
  std::vector<float> Vectors;
};

/// Throws InputError unless WriteDisplacement knows the path's extension.
MAMMORAYIO_EXPORT void CheckDisplacementExtension(const std::string& path);

/**
 * Writes the field as an image with three values per voxel (.nrrd, .mha, .nii.gz) or as an ITK
 * transform file, a DisplacementFieldTransform of doubles (.h5, .tfm). The file's frame is LPS. The
 * vectors of NIfTI are LPS, too, as ITK and ANTs read them. Throws InputError on an invalid grid, a
 * vector that is not finite, another extension, and if the file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteDisplacement(const DisplacementField& field, const std::string& path);
}

#endif
