// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_QuietGdcm_h
#define mammoray_QuietGdcm_h

#include <gdcmTrace.h>

namespace mammoray
{
/// While one lives, GDCM writes nothing to its own streams; what the user needs is in our
/// exceptions.
class QuietGdcm
{
public:
  QuietGdcm()
    : Warning(gdcm::Trace::GetWarningFlag())
    , Error(gdcm::Trace::GetErrorFlag())
  {
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
  }
  ~QuietGdcm()
  {
    gdcm::Trace::SetWarning(this->Warning);
    gdcm::Trace::SetError(this->Error);
  }
  QuietGdcm(const QuietGdcm&) = delete;
  QuietGdcm& operator=(const QuietGdcm&) = delete;

private:
  const bool Warning;
  const bool Error;
};
}

#endif
