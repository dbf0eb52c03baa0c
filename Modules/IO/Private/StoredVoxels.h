// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_StoredVoxels_h
#define mammoray_Private_StoredVoxels_h

#include "mammorayIOModule.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace mammoray
{
/// The fields of a header made of lines of text, and where the header ends.
struct MAMMORAYIO_EXPORT TextHeader
{
  std::string Path;
  /// Keys in lower case and without blanks: "space directions" is "spacedirections".
  std::map<std::string, std::string> Fields;
  /// NRRD's "key:=value", which mean something to programs alone; keys as they stand.
  std::map<std::string, std::string> Pairs;
  /// Bytes up to the first one after the header.
  std::uint64_t Bytes = 0;

  /// NRRD's "key: value" up to a blank line.
  static TextHeader ReadNrrd(const std::string& path);
  /// MetaImage's "key = value" up to ElementDataFile.
  static TextHeader ReadMetaImage(const std::string& path);

  /// The value in lower case, empty where there is none; `key` as in Fields.
  std::string Value(const std::string& key) const;
  /// Throws InputError: "path: key: expected ..., found 'value'".
  [[noreturn]] void Refuse(const std::string& key, const std::string& expected) const;
  /// Throws InputError unless the numbers of a field count voxels that a volume can have.
  void CheckSizes(const std::string& key) const;
  /// Throws InputError unless all that stands in these fields are finite numbers that lengths in mm
  /// can be: of larger ones ITK makes spacings of 1 without a word.
  void CheckLengths(const std::vector<std::string>& keys) const;
};

/**
 * Where the voxels of a volume are. ITK 5.2 fills the rest of a NIfTI or compressed MetaImage file
 * that is cut short or damaged with zeros, without a word, and asks for the memory that any header
 * promises; so their presence is checked here first.
 */
struct MAMMORAYIO_EXPORT StoredVoxels
{
  std::string Path;
  /// Bytes before them in the file, or, where the whole file is compressed, in what it inflates to.
  std::uint64_t Offset = 0;
  enum class Packing
  {
    None,
    /// From Offset on by zlib or gzip.
    Voxels,
    /// From the file's beginning by gzip.
    File
  };
  Packing Packed = Packing::None;

  /// Throw InputError on encodings other than raw and gzip, and on data spread over several files.
  static StoredVoxels OfNrrd(const TextHeader& header);
  static StoredVoxels OfMetaImage(const TextHeader& header);

  /**
   * Throws InputError, which names `header`, the file with the header, when fewer than `voxelCount`
   * voxels of `voxelBytes` bytes each are there, or compressed data is damaged.
   */
  void CheckPresent(const std::string& header, std::uint64_t voxelCount,
    std::uint64_t voxelBytes) const;
};
}

#endif
