// SPDX-License-Identifier: Apache-2.0
// How a command declares its options: each once, with name, variable, unit, range and help.
#ifndef mammoray_OptionList_h
#define mammoray_OptionList_h

#include "Configuration.h"
#include "OutputFiles.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace mammoray
{
/// A number as an option takes it: the unit, which --help shows in the place of a type, and the
/// range, which is checked. NaN is in no range.
struct Quantity
{
  Quantity(const char* unit) // implicit: a quantity of any size is named by its unit
    : Unit(unit)
  {
  }
  Quantity(const char* unit, const CLI::Validator& range)
    : Unit(unit)
    , Range(range)
  {
  }

  /// Empty: a bare number.
  std::string Unit;
  std::optional<CLI::Validator> Range;
};

/// Finite numbers greater than 0.
Quantity Positive(const char* unit = "");
/// Finite numbers not less than 0.
Quantity NonNegative(const char* unit = "");
/// Numbers from least to most.
Quantity Between(double least, double most, const char* unit = "");

/// "expected WHAT, found TEXT" unless that is so. CLI11's own checks of numbers take NaN, tell the
/// largest double in full, or do not tell what they expected.
std::string RefusalUnless(bool isSo, const std::string& expected, const std::string& text);

/// The finite number that a text is in decimal: CLI11 takes 0x10 for 16.
std::optional<double> ReadNumber(const std::string& text);

/// Whether a whole number is written with zeros before it, which CLI11 takes for octal, or as 0x10.
bool IsPadded(const std::string& text);

/// What can be a value of this type: whole numbers that it holds, or finite numbers.
template <typename Number>
CLI::Validator NumberOfType()
{
  return CLI::Validator(
    [](const std::string& text)
    {
      const std::optional<double> number = ReadNumber(text);
      if constexpr (std::is_integral_v<Number>)
      {
        using Limits = std::numeric_limits<Number>;
        const bool isBeyond = number &&
          (*number < static_cast<double>(Limits::min()) ||
            *number > static_cast<double>(Limits::max()));
        Number value{};
        return RefusalUnless(!IsPadded(text) && CLI::detail::lexical_cast(text, value),
          "a whole number" +
            (IsPadded(text) ? " without zeros before it"
                : isBeyond
                ? " from " + std::to_string(Limits::min()) + " to " + std::to_string(Limits::max())
                : ""),
          text);
      }
      else
      {
        return RefusalUnless(number.has_value(), "a number", text);
      }
    },
    "");
}

/// Throws InputError at what is no file or folder: a pipe that nobody writes into is waited for
/// without end, a device never ends, and inputs are read more than once. What is not there passes,
/// as names of shipped files do; readers tell.
CLI::Validator FileOrFolder();

/**
 * Declares the options of a command. The variable's value is the default that --help and
 * --print-config show; an empty string, list or std::optional has none. The variables must outlive
 * the command.
 */
class OptionList
{
public:
  explicit OptionList(CLI::App& command)
    : Command(&command)
  {
  }

  /// The list whose options stand under this heading of --help.
  OptionList Group(const std::string& heading) const
  {
    OptionList list = *this;
    list.Heading = heading;
    return list;
  }

  template <typename T>
  CLI::Option* operator()(const std::string& name, T& value, const std::string& help) const
  {
    return WithNumbers<T>(this->Declared(name, value, help));
  }

  /// Files or folders that are read, one or a list, or names of shipped ones: a configuration file
  /// may name them relative to the folder that it lies in itself.
  template <typename T>
  CLI::Option* Input(const std::string& name, T& value, const std::string& help) const
  {
    return (*this)(name, value, help)->type_name(InputTypeName)->check(FileOrFolder());
  }

  /// `T`: a number, a list of numbers, or an optional number.
  template <typename T>
  CLI::Option* operator()(const std::string& name, T& value, const Quantity& quantity,
    const std::string& help) const
  {
    CLI::Option* option = this->Declared(name, value, help);
    if (!quantity.Unit.empty())
    {
      option->type_name(quantity.Unit);
    }
    if (quantity.Range)
    {
      option->check(*quantity.Range);
    }
    return WithNumbers<T>(option);
  }

  /// So many numbers at once; `type` names them in --help: "X Y Z". Of an optional array --help
  /// shows no default.
  template <typename Number, std::size_t Count>
  CLI::Option* Numbers(const std::string& name, std::optional<std::array<Number, Count>>& value,
    const char* type, const std::string& help) const
  {
    const auto take = [&value](const std::vector<Number>& numbers)
    { std::copy(numbers.begin(), numbers.end(), value.emplace().begin()); };
    return this->Placed(this->Command->add_option_function<std::vector<Number>>(name, take, help)
                          ->expected(static_cast<int>(Count))
                          ->check(NumberOfType<Number>())
                          ->type_name(type));
  }
  template <typename Number, std::size_t Count>
  CLI::Option* Numbers(const std::string& name, std::array<Number, Count>& value, const char* type,
    const std::string& help) const
  {
    const auto take = [&value](const std::vector<Number>& numbers)
    { std::copy(numbers.begin(), numbers.end(), value.begin()); };
    const std::vector<Number> standard(value.begin(), value.end());
    return this->Placed(this->Command->add_option_function<std::vector<Number>>(name, take, help)
                          ->expected(static_cast<int>(Count))
                          ->check(NumberOfType<Number>())
                          ->type_name(type)
                          ->default_str("[" + CLI::detail::join(standard) + "]"));
  }

  /// Sets the variable to true.
  CLI::Option* Flag(const std::string& name, bool& value, const std::string& help) const
  {
    return this->Placed(this->Command->add_flag(name, value, help));
  }

  /// Sets the variable, which is true by default, to false.
  CLI::Option* FlagOff(const std::string& name, bool& value, const std::string& help) const
  {
    return this->Placed(this->Command->add_flag_callback(
      name, [&value]() { value = false; }, help));
  }

  /// One of some words.
  CLI::Option* Word(const std::string& name, std::string& value,
    const std::vector<std::string>& words, const std::string& help) const
  {
    return (*this)(name, value, help)->check(CLI::IsMember(words));
  }

  /// One of some words, each of which stands for a value.
  template <typename T>
  CLI::Option* Choice(const std::string& name, T& value,
    const std::vector<std::pair<std::string, T>>& choices, const std::string& help) const
  {
    std::vector<std::string> words;
    std::string current;
    for (const auto& [word, choice] : choices)
    {
      words.push_back(word);
      current = choice == value ? word : current;
    }
    const auto take = [&value, choices](const std::string& given)
    {
      for (const auto& [word, choice] : choices)
      {
        value = word == given ? choice : value;
      }
    };
    return this->Placed(this->Command->add_option_function<std::string>(name, take, help)
                          ->check(CLI::IsMember(words))
                          ->default_str(current));
  }

  /// For what the above do not offer, such as groups of which one option must be given.
  CLI::App& App() const { return *this->Command; }

private:
  template <typename T>
  CLI::Option* Declared(const std::string& name, T& value, const std::string& help) const
  {
    return this->Placed(WithDefault(this->Command->add_option(name, value, help), value));
  }

  CLI::Option* Placed(CLI::Option* option) const
  {
    return this->Heading.empty() ? option : option->group(this->Heading);
  }

  /// Checks numbers, those of lists and optional ones, after what else is asked of them.
  template <typename T>
  static CLI::Option* WithNumbers(CLI::Option* option)
  {
    if constexpr (std::is_arithmetic_v<T>)
    {
      return option->check(NumberOfType<T>());
    }
    else if constexpr (std::is_same_v<T, std::string>)
    {
      return option;
    }
    else
    {
      return WithNumbers<typename T::value_type>(option);
    }
  }

  template <typename T>
  static CLI::Option* WithDefault(CLI::Option* option, const T& value)
  {
    if constexpr (std::is_arithmetic_v<T>)
    {
      return option->capture_default_str();
    }
    else if constexpr (requires { value.empty(); })
    {
      return value.empty() ? option : option->capture_default_str();
    }
    else
    {
      return option;
    }
  }

  CLI::App* Command;
  std::string Heading;
};

/// Adds a sub-command that is declared by `declare` and run by `run` with what was given.
template <typename Arguments>
CLI::App* AddCommand(CLI::App& application, const std::string& name, const std::string& description,
  void (*declare)(const OptionList& add, Arguments& arguments), void (*run)(Arguments& arguments))
{
  CLI::App* command = application.add_subcommand(name, description);
  auto arguments = std::make_shared<Arguments>();
  declare(OptionList(*command), *arguments);
  AddConfigurationOptions(*command);
  command->callback(
    [command, arguments, run]()
    {
      NoteGiven(*command);
      run(*arguments);
    });
  return command;
}

/**
 * NAME=VALUE in two. Throws InputError, which names the option and its form ("MATERIAL=MM, for
 * example skin=1.2"), where one of them is empty or there is no '='.
 */
std::pair<std::string, std::string> SplitAssignment(const std::string& text,
  const std::string& option, const std::string& form);
}

#endif
