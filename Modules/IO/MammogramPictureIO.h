// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramPictureIO_h
#define mammoray_MammogramPictureIO_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammorayIOModule.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// What a picture without a header does not say of itself.
struct PictureDescription
{
  /// At the receptor, mm.
  std::optional<double> PixelSpacingMm;
  /// "CC", "MLO", ...; "" where it is not known.
  std::string View;
  /// 'L', 'R' or '?'.
  char Laterality = '?';
};

/// Whether a path ends as a picture without a header does: .jpg, .jpeg or .png.
MAMMORAYIO_EXPORT bool IsPicturePath(const std::string& path);

/**
 * Reads a picture of a mammogram, bright where more is absorbed, as For Presentation. Colours must
 * be grey. Throws InputError, one line that names the file and what is missing of the description.
 */
MAMMORAYIO_EXPORT Mammogram ReadMammogramPicture(const std::string& path,
  const PictureDescription& description);

/**
 * Reads an image of `columns` x `rows` pixels (.png, .mha or .mhd) as a mask: rows * columns
 * values, rows from the top as in the mammogram, 1 where the image is not 0. Throws InputError that
 * names the file.
 */
MAMMORAYIO_EXPORT std::vector<unsigned char> ReadMask(const std::string& path, int columns,
  int rows);

/**
 * Reads an image of `columns` x `rows` floats (.mha), as WriteProjection writes it: rows * columns
 * values, in the file's order. Throws InputError that names the file.
 */
MAMMORAYIO_EXPORT std::vector<float> ReadFloatPicture(const std::string& path, int columns,
  int rows);
}

#endif
