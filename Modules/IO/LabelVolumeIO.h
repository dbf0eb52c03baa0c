// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelVolumeIO_h
#define mammoray_LabelVolumeIO_h

#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// How the axes of a file become those of the volume frame.
enum class VolumeAxes
{
  /**
   * What the file says is turned into DICOM LPS: NRRD by its `space` (LPS kept, RAS and LAS
   * converted, none or an anonymous one taken as given), MetaImage as LPS, NIfTI as RAS when its
   * sform or qform code is not 0.
   */
  Patient,
  /// The numbers of the header, whatever they say about the patient.
  AsGiven
};

/// What --axes-as-given chooses.
inline VolumeAxes AxesOf(bool asGiven)
{
  return asGiven ? VolumeAxes::AsGiven : VolumeAxes::Patient;
}

/**
 * Reads a label volume with its whole geometry, oblique axes included: NRRD (.nrrd; .nhdr with one
 * data file; raw or gzip), MetaImage (.mha; .mhd with one data file; raw or compressed), NIfTI-1
 * (.nii, .nii.gz; sform where its code is 1, else qform) and DICOM, always in LPS: a folder with a
 * series of slices whose values are the labels, or a segmentation (.dcm; binary or fractional from
 * a half of the largest value, uncompressed) whose segment numbers are, of overlapping segments the
 * smaller one.
 *
 * Three dimensions (further ones of size 1 are allowed in NIfTI), any scalar type of whole values
 * in [0, 65535]. Throws InputError, one line with the file, on a missing, short or damaged file, on
 * other dimensions, types, encodings or sheared axes, and on a value that is no label, with its
 * place. Memory grows with the data that is there, not with what the header promises.
 */
MAMMORAYIO_EXPORT LabelVolume ReadLabelVolume(const std::string& path,
  VolumeAxes axes = VolumeAxes::Patient);

/**
 * Reads an MRI or the like from the same formats but DICOM SEG: any finite values. Throws
 * InputError as above.
 */
MAMMORAYIO_EXPORT IntensityVolume ReadIntensityVolume(const std::string& path,
  VolumeAxes axes = VolumeAxes::Patient);

/// A slice of a DICOM series: a file, or a frame, from 1, of an enhanced multi-frame MR object.
struct DicomSlice
{
  std::string Path;
  /// 0: the file is the slice.
  int Frame = 0;
};

/**
 * Reads a DICOM series from its slices, in any order, evenly spaced, each at a place of its own
 * (see FindSliceOrder); values after rescaling, DICOM LPS. Throws InputError, one line with the
 * file, on anything else, Interrupted.
 */
MAMMORAYIO_EXPORT IntensityVolume ReadIntensitySlices(const std::vector<DicomSlice>& slices,
  const ProgressCallback& progress = {});

/**
 * Reads a DICOM series from its files, whatever else lies in their folders: each a slice of one
 * series. Throws as ReadIntensitySlices.
 */
MAMMORAYIO_EXPORT IntensityVolume ReadIntensitySeries(const std::vector<std::string>& files,
  const ProgressCallback& progress = {});

/// Throws InputError unless WriteLabelVolume knows the path's extension.
MAMMORAYIO_EXPORT void CheckLabelVolumeExtension(const std::string& path);

/**
 * Writes .nrrd (gzip), .mha (compressed) or .nii.gz (NIfTI-1), 8 bits per voxel when that is
 * enough, 16 otherwise; the frame is called LPS. Throws InputError on another extension or when the
 * file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteLabelVolume(const LabelVolume& volume, const std::string& path);

/// The same of intensities, as 32-bit floats.
MAMMORAYIO_EXPORT void WriteIntensityVolume(const IntensityVolume& volume, const std::string& path);

/// A point transform on a grid: the point at a voxel's centre goes by the voxel's vector.
struct DisplacementField : VolumeGrid
{
  /// mm in the volume frame: x, y, z of one voxel, then of the next, i fastest.
  std::vector<float> Vectors;
};

/// Throws InputError unless WriteDisplacement knows the path's extension.
MAMMORAYIO_EXPORT void CheckDisplacementExtension(const std::string& path);

/**
 * Writes the field as an image of three values for each voxel (.nrrd, .mha, .nii.gz; in NIfTI the
 * vectors are LPS, too, as ITK and ANTs have them) or as an ITK transform file, a
 * DisplacementFieldTransform of doubles (.h5, .tfm). The frame is called LPS. Throws InputError
 * where the grid or a vector is none, on another extension, and when the file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteDisplacement(const DisplacementField& field, const std::string& path);
}

#endif
