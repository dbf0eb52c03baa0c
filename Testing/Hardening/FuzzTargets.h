// SPDX-License-Identifier: Apache-2.0
// What reads foreign bytes in the process of whoever asks, each as a function of bytes.
#ifndef mammoray_Testing_FuzzTargets_h
#define mammoray_Testing_FuzzTargets_h

#include <functional>
#include <map>
#include <string>

namespace mammoray::hardening
{
/// By name. Each returns, whatever the bytes; it ends the process where a refusal is not one
/// printable line, or is no Error.
const std::map<std::string, std::function<void(const std::string& bytes)>>& FuzzTargets();
}

#endif
