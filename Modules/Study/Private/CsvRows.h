// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_CsvRows_h
#define mammoray_Private_CsvRows_h

#include <cstddef>
#include <string>
#include <vector>

namespace mammoray
{
/// A line of a CSV file, with its number in the file for what is said of it.
struct CsvRow
{
  int Line = 0;
  std::vector<std::string> Fields;
};

/// A CSV file of one of several known forms.
struct CsvRows
{
  std::string Path;
  /// Which of the headers the file has.
  std::size_t Header = 0;
  /// As many fields as the header has, in each; empty lines are left out.
  std::vector<CsvRow> Rows;

  /// A field as a finite number. Throws InputError that names file and line.
  double Number(const CsvRow& row, std::size_t field) const;
  /// "FILE: line N: expected WHAT, found 'FIELDS'", to be thrown.
  std::string Refusal(const CsvRow& row, const std::string& expected) const;
};

/// Reads a CSV file whose first line is one of these headers. Throws InputError that names file and
/// line.
CsvRows ReadCsvRows(const std::string& path, const std::vector<std::string>& headers);
}

#endif
