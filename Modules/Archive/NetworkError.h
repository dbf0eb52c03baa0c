// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_NetworkError_h
#define mammoray_NetworkError_h

#include "mammoray/Foundation/Error.h"

namespace mammoray
{
/// An archive cannot be reached, does not answer in time or refuses.
class NetworkError : public Error
{
public:
  using Error::Error;
};
}

#endif
