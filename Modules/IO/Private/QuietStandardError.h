// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_QuietStandardError_h
#define mammoray_Private_QuietStandardError_h

#include <cstdio>
#include <fcntl.h>
#include <unistd.h>

namespace mammoray
{
/**
 * While one lives, nothing of this process reaches its standard error. MetaIO and niftilib, by
 * which ITK reads, print there and have no switch; what the user needs is in our exceptions.
 */
class QuietStandardError
{
public:
  QuietStandardError()
    : Saved(dup(STDERR_FILENO))
  {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (this->Saved >= 0 && nowhere >= 0)
    {
      std::fflush(stderr);
      dup2(nowhere, STDERR_FILENO);
    }
    if (nowhere >= 0)
    {
      close(nowhere);
    }
  }
  ~QuietStandardError()
  {
    if (this->Saved >= 0)
    {
      std::fflush(stderr);
      dup2(this->Saved, STDERR_FILENO);
      close(this->Saved);
    }
  }
  QuietStandardError(const QuietStandardError&) = delete;
  QuietStandardError& operator=(const QuietStandardError&) = delete;

private:
  const int Saved;
};
}

#endif
