#pragma once

#include <cstdlib>  // defines __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace mba_vo {

/// For the main function of a program. Once it has freed an image, glibc takes the next ones from its heap, where small
/// blocks that stay in between keep it from shrinking: the memory of a long run grows. With this, as by the environment
/// variable MALLOC_MMAP_THRESHOLD_, images have pages of their own and give them back.
inline void giveImagesOwnPages() {
#ifdef __GLIBC__
  constexpr int kThreshold = 128 * 1024;  // glibc's own, before it adapts [bytes]
  mallopt(M_MMAP_THRESHOLD, kThreshold);
#endif
}

}  // namespace mba_vo
