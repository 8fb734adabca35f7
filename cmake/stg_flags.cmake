# Compile settings shared by every package of this repository. Packages exchange SIMD types, so all
# of them must be compiled for the same instruction set.
include_guard(DIRECTORY)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")

set(STG_MARCH "auto" CACHE STRING
    "Instruction set given to -march: auto (x86-64-v3 where this machine has it), none, or a name")

# Sets ${result} to the -march value to use, or to an empty string for the compiler's default.
function(stg_resolve_march result)
  if(NOT STG_MARCH STREQUAL "auto")
    if(STG_MARCH STREQUAL "none")
      set(${result} "" PARENT_SCOPE)
    else()
      set(${result} "${STG_MARCH}" PARENT_SCOPE)
    endif()
    return()
  endif()
  if(NOT DEFINED STG_CPU_HAS_X86_64_V3)
    set(found FALSE)
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND EXISTS /proc/cpuinfo)
      file(READ /proc/cpuinfo cpuinfo)
      set(found TRUE)
      foreach(feature avx avx2 bmi1 bmi2 f16c fma abm movbe)
        if(NOT cpuinfo MATCHES "[ \t]${feature}[ \n]")
          set(found FALSE)
        endif()
      endforeach()
    endif()
    set(STG_CPU_HAS_X86_64_V3 ${found} CACHE INTERNAL "This machine runs x86-64-v3 code")
  endif()
  if(STG_CPU_HAS_X86_64_V3)
    set(${result} "x86-64-v3" PARENT_SCOPE)
  else()
    set(${result} "" PARENT_SCOPE)
  endif()
endfunction()

stg_resolve_march(stg_march)
if(stg_march)
  add_compile_options(-march=${stg_march})
endif()

# Fused multiply-adds would round packs and scalars differently; results must not depend on which
# of the two the compiler happened to contract.
add_compile_options(-ffp-contract=off -Wall -Wextra)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fno-semantic-interposition)
endif()
