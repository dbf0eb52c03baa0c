// SPDX-License-Identifier: Apache-2.0
#include "Private/ResultFields.h"

#include "mammoray/Foundation/Error.h"

#include <limits>

namespace mammoray
{
namespace
{
/// What stands in a file, short enough for a line.
std::string Shown(const Json* json)
{
  if (!json)
  {
    return "none";
  }
  constexpr std::size_t Longest = 60;
  const std::string text = json->dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() > Longest ? text.substr(0, Longest) + "..." : text;
}
}

void FieldReader::Refuse(const std::string& field, const std::string& expected,
  const std::string& found) const
{
  const auto at = this->Object.find(field);
  throw InputError(this->File + ": field '" + this->Prefix + field + "': expected " + expected +
    ", found " + (!found.empty() ? found : Shown(at == this->Object.end() ? nullptr : &*at)));
}

void FieldReader::CheckVersion() const
{
  int version = 0;
  (*this)("formatVersion", version);
  if (version != ResultFormatVersion)
  {
    this->Refuse("formatVersion", std::to_string(ResultFormatVersion));
  }
}

void FieldReader::Check(bool fits, const Json* json, const std::string& field,
  const char* expected) const
{
  if (!fits)
  {
    throw InputError(
      this->File + ": field '" + field + "': expected " + expected + ", found " + Shown(json));
  }
}

void FieldReader::Read(const Json* json, const std::string& field, double& value) const
{
  this->Check(json && json->is_number(), json, field, "a number");
  json->get_to(value);
}

void FieldReader::Read(const Json* json, const std::string& field, int& value) const
{
  this->Check(json && json->is_number_integer(), json, field, "a whole number");
  json->get_to(value);
}

void FieldReader::Read(const Json* json, const std::string& field, bool& value) const
{
  this->Check(json && json->is_boolean(), json, field, "true or false");
  json->get_to(value);
}

void FieldReader::Read(const Json* json, const std::string& field, char& value) const
{
  std::string letter;
  this->Read(json, field, letter);
  this->Check(letter.size() == 1, json, field, "one letter");
  value = letter.front();
}

void FieldReader::Read(const Json* json, const std::string& field, std::string& value) const
{
  this->Check(json && json->is_string(), json, field, "a text");
  value = EscapeControls(json->get_ref<const std::string&>());
}

void FieldReader::Read(const Json* json, const std::string& field, Trust& value) const
{
  std::string name;
  this->Read(json, field, name);
  for (const Trust level : { Trust::Good, Trust::Doubtful, Trust::None })
  {
    if (name == NameOf(level))
    {
      value = level;
      return;
    }
  }
  this->Check(false, json, field, "good, doubtful or none");
}

void FieldReader::Read(const Json* json, const std::string& field, NumberOrNull& number) const
{
  number.Value = std::numeric_limits<double>::quiet_NaN();
  if (!json || !json->is_null())
  {
    this->Check(json && json->is_number(), json, field, "a number or null");
    json->get_to(number.Value);
  }
}

void FieldReader::Read(const Json* json, const std::string& field, ListOrNull& list) const
{
  list.Values.clear();
  if (!json || !json->is_null())
  {
    this->Check(json && json->is_array(), json, field, "a list or null");
    this->Read(json, field, list.Values);
  }
}

void FieldReader::Read(const Json* json, const std::string& field, NamedTexts& texts) const
{
  this->Check(json && json->is_object(), json, field, "an object");
  texts.Pairs.clear();
  for (const auto& [name, text] : json->items())
  {
    std::string value;
    this->Read(&text, field + "." + name, value);
    texts.Pairs.emplace_back(name, value);
  }
}
}
