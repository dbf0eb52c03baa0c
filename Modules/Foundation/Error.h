// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Error_h
#define mammoray_Error_h

#include <stdexcept>

namespace mammoray
{
/**
 * Base of every exception MammoRay throws. The message is one line that says what was expected,
 * what was found and where. VTK algorithms catch it in RequestData and report it once; the command
 * line prints it and exits with 1.
 */
class Error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
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
