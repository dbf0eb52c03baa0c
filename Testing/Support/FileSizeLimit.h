// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FileSizeLimit_h
#define mammoray_FileSizeLimit_h

#include <sys/resource.h>

#include <csignal>

namespace mammoray::test
{
/// A full disk: no file of this process gets larger than this while it lives; the kernel cuts at it
/// as it does at a disk's end.
class FileSizeLimit
{
public:
  explicit FileSizeLimit(rlim_t bytes)
  {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &this->Before);
    const rlimit limit{ bytes, this->Before.rlim_max };
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit()
  {
    setrlimit(RLIMIT_FSIZE, &this->Before);
    std::signal(SIGXFSZ, SIG_DFL);
  }

private:
  rlimit Before{};
};
}

#endif
