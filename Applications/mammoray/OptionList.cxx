// SPDX-License-Identifier: Apache-2.0
#include "OptionList.h"

#include "mammoray/Foundation/Error.h"

#include <cctype>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace mammoray
{
namespace
{
template <typename Accepts>
CLI::Validator NumberThat(const Accepts& accepts, const std::string& expected,
  const std::string& forHelp)
{
  return CLI::Validator(
    [accepts, expected](const std::string& text)
    {
      const std::optional<double> number = ReadNumber(text);
      return RefusalUnless(number && accepts(*number), expected, text);
    },
    forHelp);
}
}

std::string RefusalUnless(bool isSo, const std::string& expected, const std::string& text)
{
  return isSo ? "" : "expected " + expected + ", found " + text;
}

std::optional<double> ReadNumber(const std::string& text)
{
  double value = 0;
  const bool isDecimal = text.find_first_of("xX") == std::string::npos;
  return isDecimal && CLI::detail::lexical_cast(text, value) && std::isfinite(value)
    ? std::optional(value)
    : std::nullopt;
}

bool IsPadded(const std::string& text)
{
  const std::size_t first = text.find_first_not_of("+-");
  return first != std::string::npos && text[first] == '0' && first + 1 < text.size() &&
    std::isalnum(static_cast<unsigned char>(text[first + 1]));
}

Quantity Positive(const char* unit)
{
  return { unit,
    NumberThat([](double value) { return value > 0; }, "a number greater than 0", "POSITIVE") };
}

Quantity NonNegative(const char* unit)
{
  return { unit,
    NumberThat([](double value) { return value >= 0; }, "a number not less than 0",
      "NONNEGATIVE") };
}

Quantity Between(double least, double most, const char* unit)
{
  std::ostringstream range;
  range << least << " to " << most;
  return { unit,
    NumberThat([least, most](double value) { return value >= least && value <= most; },
      "a number from " + range.str(), range.str()) };
}

CLI::Validator FileOrFolder()
{
  return CLI::Validator(
    [](const std::string& path)
    {
      namespace fs = std::filesystem;
      std::error_code ignored;
      const fs::file_type type = fs::status(path, ignored).type();
      const char* const found = type == fs::file_type::fifo                ? "a pipe"
        : type == fs::file_type::socket                                    ? "a socket"
        : type == fs::file_type::character || type == fs::file_type::block ? "a device"
                                                                           : nullptr;
      if (found)
      {
        throw InputError(path + ": expected a file or a folder, found " + found);
      }
      return std::string();
    },
    "");
}

std::pair<std::string, std::string> SplitAssignment(const std::string& text,
  const std::string& option, const std::string& form)
{
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
  {
    throw InputError(option + ": expected " + form + ", found '" + text + "'");
  }
  return { text.substr(0, equals), text.substr(equals + 1) };
}
}
