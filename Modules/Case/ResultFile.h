// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ResultFile_h
#define mammoray_ResultFile_h

#include "mammorayCaseModule.h"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <string>

namespace mammoray
{
/// Gives `read` the result.json of a folder that 'mammoray register' wrote. Throws InputError that
/// names the file where it is missing, is no JSON, or lacks what `read` takes from it.
MAMMORAYCASE_EXPORT void ReadResultFile(const std::string& folder,
  const std::function<void(const nlohmann::json&)>& read);
}

#endif
