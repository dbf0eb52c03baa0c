// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Error_h
#define mammoray_Error_h

#include "mammorayFoundationModule.h"

#include <stdexcept>
#include <string>

namespace mammoray
{
/**
 * The text as it may be shown on a terminal or in a log, whatever file it came from: control
 * characters (line feeds and escape sequences among them), marks that turn the direction of
 * writing, and bytes that are no UTF-8 become a backslash, x and two digits, one for each byte.
 */
MAMMORAYFOUNDATION_EXPORT std::string Printable(const std::string& text);

/**
 * Base of every exception MammoRay throws. The message is one line that says what was expected,
 * what was found and where; it is made printable. VTK algorithms catch it in RequestData and report
 * it once; the command line prints it and exits with 1.
 */
class Error : public std::runtime_error
{
public:
  explicit Error(const std::string& message)
    : std::runtime_error(Printable(message))
  {
  }
};

/// A value, file or array the caller handed in is not usable.
class InputError : public Error
{
public:
  using Error::Error;
};

/// A computation could not reach a state that meets its limits (a Newton step, an inverted cell).
class ConvergenceError : public Error
{
public:
  using Error::Error;
};

/// The progress callback asked to stop.
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
