// SPDX-License-Identifier: Apache-2.0
#include "Private/JsonFile.h"

#include "Private/InputFile.h"

#include <algorithm>
#include <set>
#include <utility>

namespace mammoray
{
nlohmann::json ParseJsonFile(const std::string& path, const std::string& what)
{
  CheckReadable(path, what);
  std::ifstream file(path);
  return ParseJson(file, path, what);
}

nlohmann::json ParseJson(std::istream& text, const std::string& where, const std::string& what)
{
  using Json = nlohmann::json;
  // The parser keeps the last of repeated keys silently.
  std::vector<std::set<std::string>> open;
  std::string repeated;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed)
  {
    // Our files have four levels; what is done with thousands of them ends the process.
    if (depth > 16)
    {
      throw InputError(where + ": expected " + what + ", found JSON nested deeper than 16");
    }
    if (event == Json::parse_event_t::object_start)
    {
      open.emplace_back();
    }
    else if (event == Json::parse_event_t::object_end)
    {
      open.pop_back();
    }
    else if (event == Json::parse_event_t::key &&
      !open.back().insert(parsed.get<std::string>()).second)
    {
      repeated = parsed.get<std::string>();
    }
    return true;
  };
  Json parsed;
  try
  {
    parsed = Json::parse(text, watch);
  }
  catch (const Json::exception& error)
  {
    std::string message = error.what();
    std::replace(message.begin(), message.end(), '\n', ' ');
    throw InputError(where + ": expected " + what + " in JSON: " + message);
  }
  if (!repeated.empty())
  {
    throw InputError(where + ": key '" + repeated + "': expected once, found more often");
  }
  return parsed;
}

void RefuseJson(const std::string& place, const std::string& expected, const nlohmann::json* found)
{
  std::string text = found ? found->dump() : "nothing";
  if (text.size() > 60)
  {
    text = text.substr(0, 57) + "...";
  }
  throw InputError(place + ": expected " + expected + ", found " + text);
}

JsonObject::JsonObject(const Json& value, std::string place, const std::vector<std::string>& keys)
  : Value(value)
  , Place(std::move(place))
{
  if (!value.is_object())
  {
    throw InputError(this->Place + ": expected a JSON object, found " + value.type_name());
  }
  for (const auto& [key, ignored] : value.items())
  {
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
    {
      std::string known;
      for (const std::string& name : keys)
      {
        known += (known.empty() ? "" : ", ") + name;
      }
      throw InputError(this->Place + ": unknown key '" + key + "', expected " + known);
    }
  }
}

JsonObject JsonObject::Root(const Json& value, const std::string& path,
  const std::vector<std::string>& keys)
{
  JsonObject root(value, path, keys);
  root.IsRoot = true;
  return root;
}

std::string JsonObject::PlaceOf(const std::string& key) const
{
  return this->Place + (this->IsRoot ? ": " : ".") + key;
}

void JsonObject::Refuse(const std::string& key, const std::string& expected) const
{
  RefuseJson(this->PlaceOf(key), expected, this->Find(key));
}

const JsonObject::Json* JsonObject::Find(const std::string& key) const
{
  const auto found = this->Value.find(key);
  return found == this->Value.end() ? nullptr : &*found;
}

const JsonObject::Json& JsonObject::Require(const std::string& key,
  const std::string& expected) const
{
  const Json* found = this->Find(key);
  if (!found)
  {
    this->Refuse(key, expected);
  }
  return *found;
}

std::string JsonObject::Text(const std::string& key) const
{
  const char* const expected = "a text that is not empty";
  const Json& found = this->Require(key, expected);
  if (!found.is_string() || found.get_ref<const std::string&>().empty())
  {
    this->Refuse(key, expected);
  }
  return EscapeControls(found.get<std::string>());
}

std::vector<std::string> JsonObject::Texts(const std::string& key) const
{
  const char* const expected = "a list of texts that are not empty, at least one";
  const Json& found = this->Require(key, expected);
  if (!found.is_array() || found.empty())
  {
    this->Refuse(key, expected);
  }
  std::vector<std::string> texts;
  for (const Json& text : found)
  {
    if (!text.is_string() || text.get_ref<const std::string&>().empty())
    {
      this->Refuse(key, expected);
    }
    texts.push_back(EscapeControls(text.get<std::string>()));
  }
  return texts;
}

int JsonObject::WholeNumber(const std::string& key, int least, int most) const
{
  const std::string expected =
    "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
  const Json& found = this->Require(key, expected);
  if (!found.is_number_integer() || found.get<double>() < least || found.get<double>() > most)
  {
    this->Refuse(key, expected);
  }
  return found.get<int>();
}
}
