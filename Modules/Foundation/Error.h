// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Error_h
#define mammoray_Error_h

#include "mammorayFoundationModule.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * Returns the text in a form that is safe to print in a terminal or log, wherever it came from.
 * Every byte of control characters (including line feeds and escape sequences), of marks that
 * change the writing direction and of invalid UTF-8 becomes a backslash, x and two hexadecimal
 * digits.
 */
MAMMORAYFOUNDATION_EXPORT std::string EscapeControls(const std::string& text);

/// Base class of all exceptions of MammoRay. The message is one line that states what was expected,
/// what was found and where; control characters in it are escaped. VTK algorithms catch it in
/// RequestData and report it once; the command line prints it and exits with code 1.
class Error : public std::runtime_error
{
public:
  explicit Error(const std::string& message)
    : std::runtime_error(EscapeControls(message))
  {
  }
};

/// The field that an InputError is about. Fields are named like the members of structs and the
/// properties of filters ("ThicknessMm"). The command line replaces them by its options.
struct RefusedField
{
  std::string Name;
  std::string Value;
  /// Other fields that make the input usable when they are set, such as "AcceptUnusual".
  std::vector<std::string> Remedies;
  /// Whether all of them are needed; otherwise one of them is enough.
  bool All = false;
};

/// A value, file or array that the caller passed is not usable.
class InputError : public Error
{
public:
  using Error::Error;

  /// Appends "; set REMEDY or REMEDY" to the message ("and" where all are needed).
  InputError(const std::string& message, const RefusedField& field)
    : Error(message + Advice(field))
    , Refused(field)
  {
  }

  /// The error of this whole message, to which nothing is appended; from another process.
  static InputError Restored(const std::string& message, const RefusedField& field)
  {
    InputError error(message);
    error.Refused = field;
    return error;
  }

  /// Empty if the error is not about a field.
  const RefusedField& Field() const { return this->Refused; }

private:
  static std::string Advice(const RefusedField& field)
  {
    std::string advice;
    for (const std::string& remedy : field.Remedies)
    {
      advice += (advice.empty() ? "; set " : field.All ? " and " : " or ") + remedy;
    }
    return advice;
  }

  RefusedField Refused;
};

/// A line about an input that is read although two of its statements contradict each other or
/// something in it is left out.
struct InputNote
{
  /// The input, a path or a name.
  std::string File;
  /// States what was found and what is assumed. It holds nothing that a person wrote, such as a
  /// name.
  std::string Text;
  /// Further words, which follow the text and may hold names out of the file. Mostly empty.
  std::string Names;

  std::string Line() const { return this->File + ": " + this->Text + this->Names; }
};

/// Says a note, control characters escaped. The innermost NoteKeeper of this thread keeps it;
/// without one it is a warning on standard error, once.
MAMMORAYFOUNDATION_EXPORT void Note(const InputNote& note);

/// Keeps the notes of its thread from its construction to its end.
class MAMMORAYFOUNDATION_EXPORT NoteKeeper
{
public:
  enum class Others
  {
    Silent,
    /// Notes are kept and also said as they would be without this keeper.
    Told
  };
  explicit NoteKeeper(Others others = Others::Silent);
  ~NoteKeeper();
  NoteKeeper(const NoteKeeper&) = delete;
  NoteKeeper& operator=(const NoteKeeper&) = delete;

  /// In the order in which they were said.
  std::vector<InputNote> Notes;
  std::vector<std::string> Lines() const;

private:
  friend void Note(const InputNote& note);
  const bool PassesOn;
  NoteKeeper* const Outer;
};

/// A computation did not reach a state within its limits (Newton steps, inverted cells).
class ConvergenceError : public Error
{
public:
  using Error::Error;
};

/// The progress callback requested a stop.
class Interrupted : public Error
{
public:
  Interrupted()
    : Error("interrupted")
  {
  }
};
}

#endif
