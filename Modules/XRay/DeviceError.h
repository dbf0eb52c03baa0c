// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DeviceError_h
#define mammoray_DeviceError_h

#include "mammoray/Foundation/Error.h"

#include <string>

namespace mammoray
{
/// No Vulkan device is usable, or the device failed. The message is one line with the reason.
class DeviceError : public Error
{
public:
  explicit DeviceError(const std::string& message, const std::string& resultName = {})
    : Error(message)
    , Result(resultName)
  {
  }
  /// Name of the VkResult, for example "VK_ERROR_OUT_OF_DEVICE_MEMORY". Empty if there is none.
  const std::string& ResultName() const { return this->Result; }

private:
  std::string Result;
};
}

#endif
