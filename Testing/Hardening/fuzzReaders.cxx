// SPDX-License-Identifier: Apache-2.0
// libFuzzer's side of FuzzTargets: `fuzzReaders --target=NAME CORPUS`.
#include "FuzzTargets.h"

#include <cstdio>
#include <cstdlib>
#include <string>

namespace
{
const mammoray::hardening::FuzzTarget* Chosen = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv)
{
  const std::string option = "--target=";
  for (int index = 1; index < *argc; ++index)
  {
    const std::string word = (*argv)[index];
    const auto& targets = mammoray::hardening::FuzzTargets();
    if (word.starts_with(option) && targets.count(word.substr(option.size())) == 1)
    {
      Chosen = &targets.at(word.substr(option.size()));
    }
  }
  if (!Chosen)
  {
    for (const auto& [name, target] : mammoray::hardening::FuzzTargets())
    {
      std::puts(name.c_str());
    }
    std::fflush(stdout);
    std::_Exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size)
{
  (*Chosen)(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
