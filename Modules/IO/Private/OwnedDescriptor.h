// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_OwnedDescriptor_h
#define mammoray_Private_OwnedDescriptor_h

#include <unistd.h>

namespace mammoray
{
/// An open file or folder, closed at the end; below 0 if it could not be opened (errno).
class OwnedDescriptor
{
public:
  explicit OwnedDescriptor(int number)
    : Number(number)
  {
  }
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
  ~OwnedDescriptor() { close(this->Number); }
  int Get() const { return this->Number; }

private:
  const int Number;
};
}

#endif
