/* Checks if the processor and the operating system can run code for x86-64-v3. CMake, the launcher
 * of the Debian packages and the Python module use this file, so it is valid C and C++.
 *
 * It reads CPUID, because a kernel may hide a feature from /proc/cpuinfo that programs can use. It
 * does not use __builtin_cpu_supports, because not every compiler knows the name of the level.
 */
#ifndef STG_X86_64_V3_H
#define STG_X86_64_V3_H

#ifdef __x86_64__
#include <cpuid.h>

/* Features of the level: System V ABI of AMD64, table 3.1. Bits: manuals of Intel and AMD. */
static inline int stg_has_x86_64_v3(void) {
  /* Leaf 1, ECX: SSE3, SSSE3, FMA, CMPXCHG16B, SSE4.1, SSE4.2, MOVBE, POPCNT, OSXSAVE, AVX, F16C.
   */
  const unsigned basic = 1u << 0 | 1u << 9 | 1u << 12 | 1u << 13 | 1u << 19 | 1u << 20 | 1u << 22 |
                         1u << 23 | 1u << 27 | 1u << 28 | 1u << 29;
  /* Leaf 7, EBX: BMI1, AVX2, BMI2. Leaf 0x80000001, ECX: LAHF, LZCNT. */
  const unsigned extended = 1u << 3 | 1u << 5 | 1u << 8;
  const unsigned further = 1u << 0 | 1u << 5;
  /* XCR0: the system saves the registers of SSE and AVX when it switches to another program. */
  const unsigned kept = 1u << 1 | 1u << 2;
  unsigned a, b, c, d;
  if (!__get_cpuid(1, &a, &b, &c, &d) || (c & basic) != basic) return 0;
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || (b & extended) != extended) return 0;
  if (!__get_cpuid(0x80000001u, &a, &b, &c, &d) || (c & further) != further) return 0;
  __asm__("xgetbv" : "=a"(a), "=d"(d) : "c"(0));
  return (a & kept) == kept;
}
#else
static inline int stg_has_x86_64_v3(void) { return 0; }
#endif

#endif
