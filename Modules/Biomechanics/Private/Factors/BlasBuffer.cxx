// SPDX-License-Identifier: Apache-2.0
#include "Private/Factors/BlasBuffer.h"

#include <sys/mman.h>

#include <cstddef>
#include <mutex>
#include <new>

// OpenBLAS has these, if it is the BLAS of the process.
extern "C" void* blas_memory_alloc(int) __attribute__((weak));
extern "C" void blas_memory_free(void*) __attribute__((weak));

namespace mammoray
{
void ReserveBlasBuffer()
{
  static std::once_flag once;
  std::call_once(once,
    []
    {
      if (!blas_memory_alloc || !blas_memory_free)
      {
        return;
      }
      // A buffer has 128 MiB on most processors, less on others, and a little beside it.
      constexpr std::size_t Room = std::size_t{ 130 } << 20;
      void* room = mmap(nullptr, Room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      if (room == MAP_FAILED)
      {
        throw std::bad_alloc(); // and the next call tries again
      }
      munmap(room, Room);
      blas_memory_free(blas_memory_alloc(0));
    });
}
}
