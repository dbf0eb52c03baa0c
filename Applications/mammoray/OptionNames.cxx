// SPDX-License-Identifier: Apache-2.0
#include "OptionNames.h"

#include "mammoray/Foundation/Error.h"

#include <cctype>
#include <filesystem>
#include <new>
#include <utility>

namespace mammoray
{
namespace
{
/// Fields whose options are not called as they are.
constexpr std::pair<const char*, const char*> OtherNames[] = {
  { "ImagePosition", "--mri-position" },
  { "Laterality", "--side" },
  { "MammogramViews", "--view" },
  { "Mammograms", "--mammogram" },
  { "Surfaces", "--surface" },
};

/// Suffixes of fields that options do not have.
constexpr const char* Units[] = { "Mm", "Deg", "KeV", "KPa", "GPerCm3" };

bool IsLetter(char letter)
{
  return std::isalnum(static_cast<unsigned char>(letter)) != 0;
}

/// Puts `by` for the whole word.
void ReplaceWord(std::string& text, const std::string& word, const std::string& by)
{
  for (std::size_t place = 0; (place = text.find(word, place)) != std::string::npos;)
  {
    const std::size_t end = place + word.size();
    const bool isWhole =
      (place == 0 || !IsLetter(text[place - 1])) && (end == text.size() || !IsLetter(text[end]));
    text.replace(place, word.size(), isWhole ? by : word);
    place += isWhole ? by.size() : word.size();
  }
}

/// The error's message, with options in place of the fields that it names.
std::string InOptions(const InputError& error)
{
  std::string text = error.what();
  std::vector<std::string> fields = error.Field().Remedies;
  fields.push_back(error.Field().Name);
  for (const std::string& field : fields)
  {
    // Keys of JSON files are not those of options.
    if (!field.empty() && std::isupper(static_cast<unsigned char>(field.front())))
    {
      ReplaceWord(text, field, OptionOfField(field));
    }
  }
  return text;
}
}

std::string OptionOfField(const std::string& field)
{
  for (const auto& [name, option] : OtherNames)
  {
    if (field == name)
    {
      return option;
    }
  }
  std::string name = field;
  for (const std::string unit : Units)
  {
    if (name.ends_with(unit))
    {
      name.erase(name.size() - unit.size());
    }
  }
  std::string option = "-";
  for (const char letter : name)
  {
    const auto code = static_cast<unsigned char>(letter);
    option += std::isupper(code) ? "-" : "";
    option += static_cast<char>(std::tolower(code));
  }
  return option;
}

std::string Complaint(const std::exception& error)
{
  if (dynamic_cast<const std::bad_alloc*>(&error))
  {
    return "out of memory";
  }
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
  {
    // For example, a name that is too long.
    return EscapeControls(file->path1().string()) + ": cannot be looked for (" +
      file->code().message() + ")";
  }
  const auto* input = dynamic_cast<const InputError*>(&error);
  return input ? InOptions(*input) : EscapeControls(error.what());
}
}
