// SPDX-License-Identifier: Apache-2.0
#include "Private/CsvRows.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace mammoray
{
namespace
{
std::vector<std::string> FieldsOf(const std::string& line)
{
  std::vector<std::string> fields;
  std::istringstream rest(line + ','); // so that an empty last field counts
  for (std::string field; std::getline(rest, field, ',');)
  {
    fields.push_back(field);
  }
  return fields;
}

std::string Joined(const std::vector<std::string>& texts, const char* separator)
{
  std::string joined;
  for (const std::string& text : texts)
  {
    joined += (joined.empty() ? "" : separator) + text;
  }
  return joined;
}
}

double CsvRows::Number(const CsvRow& row, std::size_t field) const
{
  const std::string& text = row.Fields[field];
  double value = 0;
  if (!ToPaddedNumber(text, value) || !std::isfinite(value))
  {
    throw InputError(this->Refusal(row, "a number in column " + std::to_string(field + 1)));
  }
  return value;
}

std::string CsvRows::Refusal(const CsvRow& row, const std::string& expected) const
{
  return this->Path + ": line " + std::to_string(row.Line) + ": expected " + expected +
    ", found '" + Joined(row.Fields, ",").substr(0, 60) + "'";
}

CsvRows ReadCsvRows(const std::string& path, const std::vector<std::string>& headers)
{
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": no such file or not readable");
  }
  std::string line;
  ReadLine(file, line);
  const auto header = std::find(headers.begin(), headers.end(), line);
  if (header == headers.end())
  {
    throw InputError(path + ": line 1: expected " + Joined(headers, " or ") + ", found '" +
      line.substr(0, 60) + "'");
  }
  CsvRows read{ path, static_cast<std::size_t>(header - headers.begin()), {} };
  const std::size_t columns = FieldsOf(*header).size();
  for (int number = 2; ReadLine(file, line); ++number)
  {
    if (line.empty())
    {
      continue;
    }
    read.Rows.push_back({ number, FieldsOf(line) });
    if (read.Rows.back().Fields.size() != columns)
    {
      throw InputError(
        read.Refusal(read.Rows.back(), std::to_string(columns) + " values (" + *header + ")"));
    }
  }
  return read;
}
}
