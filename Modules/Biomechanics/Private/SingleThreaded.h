// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SingleThreaded_h
#define mammoray_SingleThreaded_h

// Defined if OpenBLAS is the BLAS of the process.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));
extern "C" int openblas_get_num_threads() __attribute__((weak));
// Defined if SuiteSparse was built with OpenMP.
extern "C" void omp_set_max_active_levels(int) __attribute__((weak));
extern "C" int omp_get_max_active_levels() __attribute__((weak));

namespace mammoray
{
/// Limits OpenBLAS and the loops of SuiteSparse to one thread during its lifetime. Most supernodes
/// are small, and threads that wait for each other by spinning cost more time than the products on
/// a busy machine (half of all samples in perf).
class SingleThreaded
{
public:
  SingleThreaded()
    : PreviousThreads(
        openblas_get_num_threads && openblas_set_num_threads ? openblas_get_num_threads() : 0)
    , PreviousLevels(
        omp_get_max_active_levels && omp_set_max_active_levels ? omp_get_max_active_levels() : 0)
  {
    if (this->PreviousThreads > 1)
    {
      openblas_set_num_threads(1);
    }
    if (this->PreviousLevels > 0)
    {
      omp_set_max_active_levels(0);
    }
  }
  ~SingleThreaded()
  {
    if (this->PreviousThreads > 1)
    {
      openblas_set_num_threads(this->PreviousThreads);
    }
    if (this->PreviousLevels > 0)
    {
      omp_set_max_active_levels(this->PreviousLevels);
    }
  }
  SingleThreaded(const SingleThreaded&) = delete;
  SingleThreaded& operator=(const SingleThreaded&) = delete;

private:
  int PreviousThreads;
  int PreviousLevels;
};
}

#endif
