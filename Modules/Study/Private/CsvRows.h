// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_CsvRows_h
#define mammoray_Private_CsvRows_h

#include <cstddef>
#include <string>
#include <vector>

namespace mammoray
{
/// A line of a CSV file, with its number in the file for error messages.
struct CsvRow
{
  int Line = 0;
  std::vector<std::string> Fields;
};

/// A CSV file with one of several known headers.
struct CsvRows
{
  std::string Path;
  /// Index of the file's header among the known ones.
  std::size_t Header = 0;
  /// Each row has as many fields as the header; empty lines are left out.
  std::vector<CsvRow> Rows;

  /// A field as a finite number. Throws InputError that names file and line.
  double Number(const CsvRow& row, std::size_t field) const;
  /// The error message "FILE: line N: expected WHAT, found 'FIELDS'".
  std::string Refusal(const CsvRow& row, const std::string& expected) const;
};

/// Reads a CSV file whose first line is one of these headers. Throws InputError that names file and
/// line.
CsvRows ReadCsvRows(const std::string& path, const std::vector<std::string>& headers);
}

#endif
