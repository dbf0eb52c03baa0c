// SPDX-License-Identifier: Apache-2.0
#include "OptionList.h"

#include "mammoray/Foundation/Error.h"

#include <cctype>
#include <cmath>
#include <cstdio>
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

bool Declaration::IsInput() const
{
  const std::string& type = this->Option->get_type_name();
  return this->IsSetting() && (type == InputTypeName || type == FileTypeName);
}

std::string Declaration::Help() const
{
  std::string text = this->Option->get_description();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

nlohmann::ordered_json Declaration::ToJson(const std::string& text) const
{
  using Json = nlohmann::ordered_json;
  const bool isText = this->Kind == std::string("string");
  return isText || !Json::accept(text) ? Json(text) : Json::parse(text);
}

nlohmann::ordered_json Declaration::Default() const
{
  using Json = nlohmann::ordered_json;
  const std::string& text = this->Option->get_default_str();
  if (!this->IsList() || text.size() < 2 || text.front() != '[')
  {
    return text.empty() ? Json() : this->ToJson(text);
  }
  // CLI11 writes the default of a list as [a,b].
  Json values = Json::array();
  for (const std::string& value : CLI::detail::split(text.substr(1, text.size() - 2), ','))
  {
    values.push_back(this->ToJson(value));
  }
  return values;
}

const Declaration* Command::Find(const std::string& name) const
{
  const auto found = std::find_if(this->Declarations.begin(), this->Declarations.end(),
    [&name](const Declaration& each) { return each.Name() == name; });
  return found == this->Declarations.end() ? nullptr : &*found;
}

namespace
{
/// The finite decimal number that a text is.
std::optional<double> ReadNumber(const std::string& text)
{
  double value = 0;
  const bool isDecimal = text.find_first_of("xX") == std::string::npos;
  return isDecimal && CLI::detail::lexical_cast(text, value) && std::isfinite(value)
    ? std::optional(value)
    : std::nullopt;
}

/// Describes the whole number that is expected; empty if the text is one.
std::string ExpectedOfWhole(const std::string& text, double lowest, double largest)
{
  const std::size_t first = std::min(text.find_first_not_of("+-"), text.size());
  const std::string digits = text.substr(first);
  if (digits.size() > 1 && digits.front() == '0' &&
    std::isalnum(static_cast<unsigned char>(digits[1])))
  {
    return "a whole number without zeros before it";
  }
  if (const std::optional<double> number = ReadNumber(text);
      number && (*number < lowest || *number > largest))
  {
    char range[80];
    std::snprintf(range, sizeof range, "a whole number from %.0f to %.0f", lowest, largest);
    return range;
  }
  const bool isWhole =
    !digits.empty() && first < 2 && digits.find_first_not_of("0123456789") == std::string::npos;
  return isWhole ? "" : "a whole number";
}

/// "expected WHAT, found TEXT", or nothing where nothing is expected.
std::string Refusal(const std::string& expected, const std::string& text)
{
  return expected.empty() ? "" : "expected " + expected + ", found " + text;
}
}

CLI::Validator NumberIn(const Quantity& quantity, bool isWhole, double lowest, double largest)
{
  return CLI::Validator(
    [quantity, isWhole, lowest, largest](const std::string& text)
    {
      const std::optional<double> number = ReadNumber(text);
      const std::string range = quantity.Range();
      if (!range.empty() && !(number && quantity.Holds(*number)))
      {
        return Refusal("a number " + range, text);
      }
      return Refusal(isWhole ? ExpectedOfWhole(text, lowest, largest)
          : number           ? ""
                             : "a number",
        text);
    },
    "");
}

CLI::Validator OneOfWords(const std::vector<std::string>& words)
{
  return CLI::Validator(
    [words](const std::string& text)
    {
      const bool isOne = std::find(words.begin(), words.end(), text) != words.end();
      return Refusal(isOne ? "" : "one of " + CLI::detail::join(words, ", "), text);
    },
    "");
}

CLI::Validator FileOrFolder(bool isFile)
{
  return CLI::Validator(
    [isFile](const std::string& path)
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
      if (isFile)
      {
        CheckInputFile(path);
      }
      return std::string();
    },
    "");
}

void AddMissingCommand(CLI::App& application, const std::string& name, const std::string& module)
{
  CLI::App* command = application.add_subcommand(name, "Not in this build: no " + module);
  command->allow_extras();
  command->callback([=] { throw InputError(name + ": this build has no " + module); });
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
