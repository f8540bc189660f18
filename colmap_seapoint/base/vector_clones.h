// Hot integer loops are compiled twice, for AVX2 and for any x86-64, and chosen at run time.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SEAPOINT_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define SEAPOINT_VECTOR_CLONES
#endif
