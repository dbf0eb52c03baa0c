// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_ValidationFile_h
#define mammoray_Validation_ValidationFile_h

#include <nlohmann/json.hpp>

#include <string>

namespace mammoray
{
/**
 * A JSON file of runs, from which an interrupted validation is resumed and which tables.py reads:
 * "settings", the program's "version", the limits of trust, and the lists "twins", "landmarks",
 * "mammograms" and "studies", whose entries hold their own keys. A number that is not finite is
 * written as null.
 */
class ValidationFile
{
public:
  /**
   * `settings`: what all runs of a file must have in common. `resume`: takes the runs of an
   * existing file; throws InputError if it is not such a file or has other settings, or if the file
   * cannot be written there. It is written when the first run is added.
   */
  ValidationFile(std::string path, const nlohmann::json& settings, bool resume);

  /// The run in a list that has these values, for example {"name": "victre-1"}; null if there is
  /// none.
  const nlohmann::json* Find(const char* list, const nlohmann::json& values) const;

  /// Adds a run and replaces the file, whole or not at all.
  void Add(const char* list, nlohmann::json run);

  std::size_t NumberOfRuns() const;

private:
  std::string Path;
  nlohmann::json Content;
};
}

#endif
