/* Included first in every C++ test: Unity defines isnan and isinf as macros, which would break
   std::isnan and std::isinf. */
#include <unity.h>
#undef isnan
#undef isinf
