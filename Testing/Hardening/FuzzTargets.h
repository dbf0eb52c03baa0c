// SPDX-License-Identifier: Apache-2.0
// What reads foreign bytes in the process of whoever asks, each as a function of bytes.
#ifndef mammoray_Testing_FuzzTargets_h
#define mammoray_Testing_FuzzTargets_h

#include <functional>
#include <map>
#include <string>

namespace mammoray::hardening
{
/// What the bytes are refused with, empty where they are taken. It returns, whatever they are; it
/// ends the process where a refusal is not one printable line, or is no Error.
using FuzzTarget = std::function<std::string(const std::string& bytes)>;

/// By name.
const std::map<std::string, FuzzTarget>& FuzzTargets();
}

#endif
