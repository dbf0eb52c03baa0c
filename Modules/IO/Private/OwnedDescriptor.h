// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_OwnedDescriptor_h
#define mammoray_Private_OwnedDescriptor_h

#include <unistd.h>
#include <utility>

namespace mammoray
{
/// An open file or folder, closed at the end; below 0 where opening failed (errno says why).
class OwnedDescriptor
{
public:
  explicit OwnedDescriptor(int number)
    : Number(number)
  {
  }
  OwnedDescriptor(OwnedDescriptor&& other) noexcept
    : Number(std::exchange(other.Number, -1))
  {
  }
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(OwnedDescriptor&&) = delete;
  ~OwnedDescriptor()
  {
    if (this->Number >= 0)
    {
      close(this->Number);
    }
  }
  int Get() const { return this->Number; }

private:
  int Number;
};
}

#endif
