// SPDX-License-Identifier: Apache-2.0
#include "OptionList.h"

#include "mammoray/Foundation/Error.h"

#include <cctype>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace mammoray
{
std::string Quantity::Range() const
{
  std::ostringstream range;
  if (std::isfinite(this->Least) && std::isfinite(this->Most))
  {
    range << "from " << this->Least << " to " << this->Most;
  }
  else if (std::isfinite(this->Least))
  {
    range << (this->LeastExcluded ? "greater than " : "not less than ") << this->Least;
  }
  return range.str();
}

bool Quantity::Holds(double number) const
{
  return number >= this->Least && number <= this->Most &&
    !(this->LeastExcluded && number == this->Least);
}

Quantity Positive(const char* unit)
{
  Quantity quantity = NonNegative(unit);
  quantity.LeastExcluded = true;
  return quantity;
}

Quantity NonNegative(const char* unit)
{
  Quantity quantity = unit;
  quantity.Least = 0;
  return quantity;
}

Quantity Between(double least, double most, const char* unit)
{
  Quantity quantity = unit;
  quantity.Least = least;
  quantity.Most = most;
  return quantity;
}

std::string Declaration::Name() const
{
  const std::vector<std::string>& names = this->Option->get_lnames();
  return names.empty() ? this->Option->get_name(true) : names.front();
}

const Declaration* Command::Find(const std::string& name) const
{
  const auto found = std::find_if(this->Declarations.begin(), this->Declarations.end(),
    [&name](const Declaration& each) { return each.Name() == name; });
  return found == this->Declarations.end() ? nullptr : &*found;
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

CLI::Validator OneOfWords(const std::vector<std::string>& words)
{
  return CLI::Validator(
    [words](const std::string& text)
    {
      const bool isOne = std::find(words.begin(), words.end(), text) != words.end();
      return RefusalUnless(isOne, "one of " + CLI::detail::join(words, ", "), text);
    },
    "");
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
