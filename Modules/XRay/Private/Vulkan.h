// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_Vulkan_h
#define mammoray_Private_Vulkan_h

// Vulkan's C++ bindings with the settings of this module. They take four seconds to read, so they
// are precompiled once for all of its sources.
#define VULKAN_HPP_NO_SPACESHIP_OPERATOR
#include <vulkan/vulkan_raii.hpp>

#endif
