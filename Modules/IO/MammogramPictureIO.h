// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramPictureIO_h
#define mammoray_MammogramPictureIO_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Returns true for the extensions of pictures without a header: .jpg, .jpeg and .png, in any
/// case.
MAMMORAYIO_EXPORT bool IsPicturePath(const std::string& path);

/**
 * Reads a picture of a mammogram as For Presentation, bright where more is absorbed. Colours must
 * be grey. Throws InputError, which names the file and what the description lacks.
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
