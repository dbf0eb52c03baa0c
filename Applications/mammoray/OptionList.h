// SPDX-License-Identifier: Apache-2.0
// How a command declares its options: each once, with name, variable, unit, range, help and where
// it shows. Help, manual page, completion, JSON schema and documentation are made from that.
#ifndef mammoray_OptionList_h
#define mammoray_OptionList_h

#include "OutputFiles.h"
#include "ProgramOptions.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

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
/// A number's unit, which help shows in place of a type, and its range.
struct Quantity
{
  Quantity(const char* unit) // implicit: a quantity of any size is named by its unit
    : Unit(unit)
  {
  }

  /// Empty: a bare number.
  std::string Unit;
  double Least = -std::numeric_limits<double>::infinity();
  double Most = std::numeric_limits<double>::infinity();
  /// Whether numbers must be greater than `Least`.
  bool LeastExcluded = false;

  /// "greater than 0", "not less than 0", "from 0 to 10"; empty for any number.
  std::string Range() const;
  bool Holds(double number) const;
};

/// Finite numbers greater than 0.
Quantity Positive(const char* unit = "");
/// Finite numbers not less than 0.
Quantity NonNegative(const char* unit = "");
/// Numbers from least to most.
Quantity Between(double least, double most, const char* unit = "");

/// Where an option shows. A case file (--config) takes all of them.
enum class Shown
{
  InHelp,
  InHelpAll,
  /// Not on the command line.
  InCaseFile
};

/// The heading of the options of every command.
inline constexpr const char* ProgramHeading = "Of every command";
/// What help shows in place of a type: a file that must exist; a file, a folder or the name of a
/// shipped file.
inline constexpr const char* FileTypeName = "FILE";
inline constexpr const char* InputTypeName = "PATH";

/// An option with what CLI11 does not keep of its declaration.
struct Declaration
{
  CLI::Option* Option = nullptr;
  Shown Where = Shown::InHelp;
  /// A type of JSON schema: "number", "integer", "string" or "boolean".
  const char* Kind = "string";
  /// Unit and range of numbers.
  Quantity Numbers = "";
  /// The values that can be chosen; empty: any.
  std::vector<std::string> Words = {};
  /// Whether giving the default means the same as giving nothing, so that --print-config may.
  bool PrintsDefault = true;

  /// The long name without dashes, or that of a positional argument.
  std::string Name() const;
  /// The help in one line.
  std::string Help() const;
  bool IsFlag() const { return this->Option->get_expected_max() == 0; }
  bool IsList() const { return this->Option->get_expected_max() > 1; }
  bool IsInput() const;
  bool IsOfProgram() const { return this->Option->get_group() == ProgramHeading; }
  /// Whether a case file may hold it: all but --config and --print-config.
  bool IsSetting() const { return this->Option->get_configurable(); }
  /// A value as the command line has it, in JSON.
  nlohmann::ordered_json ToJson(const std::string& text) const;
  /// Null if there is none.
  nlohmann::ordered_json Default() const;
};

/// An option of several commands. `Numbers` is its unit and range, or what help shows in place of a
/// type: "X Y Z" of three numbers, FileTypeName or InputTypeName of what is read.
struct SharedOption
{
  std::string Name;
  std::string Help;
  Quantity Numbers = "";
};

/// A sub-command with what was declared of its options.
class Command : public CLI::App
{
public:
  Command(CLI::App& application, const std::string& name, const std::string& description)
    : CLI::App(description, name, &application)
  {
  }

  /// Null where there is none of this name.
  const Declaration* Find(const std::string& name) const;

  /// In the order of declaration.
  std::vector<Declaration> Declarations;
};

/// Accepts numbers of the quantity's range and from `lowest` to `largest`, which a variable holds.
/// CLI11's own checks accept NaN and take 0x10 for 16 and 010 for 8.
CLI::Validator NumberIn(const Quantity& quantity, bool isWhole, double lowest, double largest);

template <typename Number>
CLI::Validator NumberIn(const Quantity& quantity)
{
  using Limits = std::numeric_limits<Number>;
  return NumberIn(quantity, std::is_integral_v<Number>, static_cast<double>(Limits::lowest()),
    static_cast<double>(Limits::max()));
}

/// Accepts one of the words.
CLI::Validator OneOfWords(const std::vector<std::string>& words);

/// Throws InputError at what is no file or folder: a pipe that nobody writes into is waited for
/// without end, a device never ends, and inputs are read more than once. What is not there passes
/// unless `isFile`, as names of shipped files do; readers tell.
CLI::Validator FileOrFolder(bool isFile);

/**
 * Declares the options of a command. The variable's value is the default that --help and
 * --print-config show; an empty string, list or std::optional has none. The variables must outlive
 * the command. --help shows the first line of `help`; --help-all and the manual show all.
 */
class OptionList
{
public:
  explicit OptionList(Command& command)
    : Owner(&command)
    , Place(&command)
  {
  }

  /// The list whose options stand under this heading.
  OptionList Group(const std::string& heading) const
  {
    OptionList list = *this;
    list.Heading = heading;
    return list;
  }

  /// The list whose options show in --help-all, but not in --help.
  OptionList Expert() const
  {
    OptionList list = *this;
    list.Where = Shown::InHelpAll;
    return list;
  }

  /// The list whose options are set in the case file only.
  OptionList CaseFile() const
  {
    OptionList list = *this;
    list.Where = Shown::InCaseFile;
    return list;
  }

  /// The list of options of which exactly one must be given.
  OptionList OneOf(const std::string& heading) const
  {
    OptionList list = this->Group(heading);
    list.Place = this->Place->add_option_group(heading)->require_option(1);
    return list;
  }

  template <typename T>
  CLI::Option* operator()(const std::string& name, T& value, const std::string& help) const
  {
    return (*this)(name, value, "", help);
  }

  /// `T`: a number, a text, a list of them, or an optional one.
  template <typename T>
  CLI::Option* operator()(const std::string& name, T& value, const Quantity& quantity,
    const std::string& help) const
  {
    using Value = typename Unwrapped<T>::Type;
    CLI::Option* option = WithDefault(this->Place->add_option(name, value, help), value);
    if (!quantity.Unit.empty())
    {
      option->type_name(quantity.Unit);
    }
    if constexpr (std::is_arithmetic_v<Value>)
    {
      option->check(NumberIn<Value>(quantity));
    }
    return this->Keep({ option, this->Where, KindOf<Value>(), quantity });
  }

  template <typename T>
  CLI::Option* operator()(const SharedOption& option, T& value) const
  {
    if constexpr (requires { std::tuple_size<typename Unwrapped<T>::Type>::value; })
    {
      return this->Numbers(option.Name, value, option.Numbers.Unit.c_str(), option.Help);
    }
    else
    {
      const std::string& unit = option.Numbers.Unit;
      return unit == FileTypeName ? this->File(option.Name, value, option.Help)
        : unit == InputTypeName   ? this->Input(option.Name, value, option.Help)
                                  : (*this)(option.Name, value, option.Numbers, option.Help);
    }
  }

  /// Files or folders that are read, one or a list, or names of shipped ones: a configuration file
  /// may name them relative to the folder that it lies in itself.
  template <typename T>
  CLI::Option* Input(const std::string& name, T& value, const std::string& help) const
  {
    return (*this)(name, value, help)->type_name(InputTypeName)->check(FileOrFolder(false));
  }

  /// Files that must exist.
  template <typename T>
  CLI::Option* File(const std::string& name, T& value, const std::string& help) const
  {
    return (*this)(name, value, help)->type_name(FileTypeName)->check(FileOrFolder(true));
  }

  /// A fixed number of numbers; `type` names them in help: "X Y Z". `T`: an array, or an optional
  /// one, which has no default.
  template <typename T>
  CLI::Option* Numbers(const std::string& name, T& value, const char* type, const std::string& help,
    const Quantity& quantity = "") const
  {
    using Array = typename Unwrapped<T>::Type;
    using Number = typename Array::value_type;
    const auto take = [&value](const std::vector<Number>& numbers)
    {
      Array array{};
      std::copy(numbers.begin(), numbers.end(), array.begin());
      value = array;
    };
    CLI::Option* option = this->Place->add_option_function<std::vector<Number>>(name, take, help)
                            ->expected(static_cast<int>(std::tuple_size_v<Array>))
                            ->check(NumberIn<Number>(quantity))
                            ->type_name(type);
    if constexpr (std::is_same_v<T, Array>)
    {
      option->default_str(
        "[" + CLI::detail::join(std::vector<Number>(value.begin(), value.end())) + "]");
    }
    return this->Keep({ option, this->Where, KindOf<Number>(), quantity });
  }

  /// Sets the variable to true.
  CLI::Option* Flag(const std::string& name, bool& value, const std::string& help) const
  {
    return this->Keep({ this->Place->add_flag(name, value, help), this->Where, "boolean" });
  }

  /// Sets the variable, which is true by default, to false.
  CLI::Option* FlagOff(const std::string& name, bool& value, const std::string& help) const
  {
    return this->Keep({ this->Place->add_flag_callback(
                          name, [&value]() { value = false; }, help),
      this->Where, "boolean" });
  }

  /// One of some words, or a list of them.
  template <typename T>
  CLI::Option* Word(const std::string& name, T& value, const std::vector<std::string>& words,
    const std::string& help) const
  {
    CLI::Option* option =
      WithDefault(this->Place->add_option(name, value, help)->check(OneOfWords(words)), value);
    return this->Keep({ option, this->Where, "string", "", words });
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
    return this->Keep({ this->Place->add_option_function<std::string>(name, take, help)
                          ->check(OneOfWords(words))
                          ->default_str(current),
      this->Where, "string", "", words });
  }

  /// For what the above do not offer.
  Command& App() const { return *this->Owner; }

  /// Adds an option that was made otherwise.
  CLI::Option* Keep(const Declaration& declaration) const
  {
    this->Owner->Declarations.push_back(declaration);
    return this->Heading.empty() ? declaration.Option : declaration.Option->group(this->Heading);
  }

private:
  template <typename T>
  struct Unwrapped
  {
    using Type = T;
  };
  template <typename T>
  struct Unwrapped<std::optional<T>>
  {
    using Type = T;
  };
  template <typename T>
  struct Unwrapped<std::vector<T>>
  {
    using Type = T;
  };

  template <typename Value>
  static constexpr const char* KindOf()
  {
    return std::is_integral_v<Value> ? "integer"
      : std::is_arithmetic_v<Value>  ? "number"
                                     : "string";
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

  Command* Owner;
  CLI::App* Place;
  std::string Heading;
  Shown Where = Shown::InHelp;
};

/// Adds a sub-command that is declared by `declare` and run by `run` with what was given.
/// `example` shows a call, without the program's name.
template <typename Arguments>
Command* AddCommand(CLI::App& application, const std::string& name, const std::string& description,
  const std::string& example, void (*declare)(const OptionList& add, Arguments& arguments),
  void (*run)(Arguments& arguments))
{
  const auto command = std::make_shared<Command>(application, name, description);
  application.add_subcommand(command);
  command->footer("Example: mammoray " + example);
  auto arguments = std::make_shared<Arguments>();
  declare(OptionList(*command), *arguments);
  AddProgramOptions(*command);
  command->callback(
    [command = command.get(), arguments, run]()
    {
      NoteInputs(*command);
      run(*arguments);
    });
  return command.get();
}

/// Adds a sub-command that this build does not have for want of a module, which it says.
void AddMissingCommand(CLI::App& application, const std::string& name, const std::string& module);

/**
 * NAME=VALUE in two. Throws InputError, which names the option and its form ("MATERIAL=MM, for
 * example skin=1.2"), where one of them is empty or there is no '='.
 */
std::pair<std::string, std::string> SplitAssignment(const std::string& text,
  const std::string& option, const std::string& form);
}

#endif
