#pragma once

#include <cstdlib>  // defines __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace mba_vo {

/// Gives pages that hold nothing any more back to the system. glibc does so only at the end of its heap: what little
/// stays of every second would keep the place of the images that were around it, and a long run would grow.
inline void returnFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace mba_vo
