#pragma once

// One source, compiled for several instruction sets and chosen when the program starts. Sanitizers instrument the
// resolver, which runs before they are ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(MBA_VO_SANITIZED) && \
    !defined(MBA_VO_VECTORS_PORTABLE)
#ifdef MBA_VO_VECTORS_AVX2
#define MBA_VO_MULTIVERSION __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define MBA_VO_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
#else
#define MBA_VO_MULTIVERSION
#endif
