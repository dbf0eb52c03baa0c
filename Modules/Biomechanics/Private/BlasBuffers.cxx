// SPDX-License-Identifier: Apache-2.0
#include "Private/BlasBuffers.h"

#include "Private/SingleThreaded.h" // openblas_get_num_threads

#include <sys/mman.h>

#include <cstddef>
#include <mutex>
#include <new>
#include <vector>

// OpenBLAS has these, if it is the BLAS of the process.
extern "C" void* blas_memory_alloc(int) __attribute__((weak));
extern "C" void blas_memory_free(void*) __attribute__((weak));
extern "C" int blas_server_avail __attribute__((weak)); ///< Its threads run.

namespace mammoray
{
namespace
{
/// Buffers that are held until all are there, so that each is another one.
class Buffers
{
public:
  Buffers() = default;
  ~Buffers()
  {
    for (void* buffer : this->Held)
    {
      blas_memory_free(buffer);
    }
  }
  Buffers(const Buffers&) = delete;
  Buffers& operator=(const Buffers&) = delete;

  void Take()
  {
    // A buffer has 128 MiB on most processors, less on others, and a little beside it.
    constexpr std::size_t Room = std::size_t{ 130 } << 20;
    void* room = mmap(nullptr, Room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (room == MAP_FAILED)
    {
      throw std::bad_alloc();
    }
    munmap(room, Room);
    this->Held.push_back(blas_memory_alloc(0));
  }

private:
  std::vector<void*> Held;
};
}

void ReserveBlasBuffers()
{
  static std::once_flag once; // a call that throws does not count
  std::call_once(once,
    []
    {
      if (!blas_memory_alloc || !blas_memory_free)
      {
        return;
      }
      // Threads that run have theirs. A fork, as of a guarded reader, ends them until they are
      // wanted again.
      const bool areRunning = &blas_server_avail && blas_server_avail != 0;
      const int wanted = areRunning || !openblas_get_num_threads ? 1 : openblas_get_num_threads();
      Buffers buffers;
      for (int count = 0; count < wanted; ++count)
      {
        buffers.Take();
      }
    });
}
}
