// SPDX-License-Identifier: Apache-2.0
// Debian's ITK knows the compiler that it was built with only. Included before all else by the
// preset `fuzz`.
#if defined(__cplusplus) && __has_include(<itk_compiler_detection.h>)
#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 12
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
#endif
