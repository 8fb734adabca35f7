# Compiler settings of all packages of this repository. The packages exchange SIMD types. Therefore
# they, and all other code that includes their headers, must be compiled for the same instruction
# set. The target stg_abi has the options that such code needs.
include_guard(DIRECTORY)

option(STG_WERROR "Treat warnings in this repository's own code as errors" OFF)
set(STG_SANITIZE "" CACHE STRING "Sanitizer to build with: address, thread, undefined, address,undefined, fuzz (needs clang: address,
undefined and the instrumentation for libFuzzer), or empty")
set_property(CACHE STG_SANITIZE PROPERTY STRINGS "" address thread undefined address,undefined fuzz)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")

set(STG_MARCH "auto" CACHE STRING
    "Instruction set given to -march: auto (x86-64-v3 if this machine has it), none, or a name")

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
  # A cross build cannot run a test for the other machine. Without a name it gets the compiler's
  # default.
  if(NOT CMAKE_CROSSCOMPILING AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    include(CheckCXXSourceRuns)
    check_cxx_source_runs("
      #include \"${CMAKE_CURRENT_LIST_DIR}/x86_64_v3.h\"
      int main() { return stg_has_x86_64_v3() ? 0 : 1; }" STG_RUNS_X86_64_V3)
  endif()
  if(STG_RUNS_X86_64_V3)
    set(${result} "x86-64-v3" PARENT_SCOPE)
  else()
    set(${result} "" PARENT_SCOPE)
  endif()
endfunction()

stg_resolve_march(stg_march)
# No fused multiply-adds: the compiler might use them in SIMD code and not in scalar code, or the
# other way round. Then the two would round differently.
set(STG_ABI_OPTIONS -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 fuses them in spite of that option where it vectorises straight-line code.
  list(APPEND STG_ABI_OPTIONS -fno-tree-slp-vectorize)
endif()
if(stg_march)
  list(PREPEND STG_ABI_OPTIONS -march=${stg_march})
endif()
if(NOT TARGET stg_abi)
  add_library(stg_abi INTERFACE)
  add_library(stg::abi ALIAS stg_abi)
  target_compile_features(stg_abi INTERFACE cxx_std_17)
  target_compile_options(stg_abi INTERFACE ${STG_ABI_OPTIONS})
  # Write RPATH and not RUNPATH. The loader reads RPATH before LD_LIBRARY_PATH, and it also uses
  # RPATH for the libraries that our libraries need. So a program always loads the build that it was
  # linked with, even if another workspace is sourced.
  target_link_options(stg_abi INTERFACE -Wl,--disable-new-dtags)
endif()
set(STG_INSTALL_RPATH "" CACHE STRING "Folder where installed programs look for libraries (default: relative to the program)")
if(STG_INSTALL_RPATH)
  set(CMAKE_INSTALL_RPATH "${STG_INSTALL_RPATH}")
else()
  # Installed libraries are in one folder. The programs of a package are in a folder below it.
  set(CMAKE_INSTALL_RPATH "\$ORIGIN;\$ORIGIN/..")
endif()

add_compile_options(${STG_ABI_OPTIONS} -Wall -Wextra)
# GCC shall copy with wide registers and never with "rep movs": this instruction takes longer to
# start than the copy of a vehicle's state takes. The environment is about a tenth faster with these
# options. GCC's defaults suit integer code.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND stg_march STREQUAL "x86-64-v3")
  include(CheckCXXCompilerFlag)
  set(stg_copy_options -mmove-max=256 -mstore-max=256
      "-mmemcpy-strategy=unrolled_loop:2048:noalign,libcall:-1:noalign")
  check_cxx_compiler_flag("${stg_copy_options}" STG_HAS_COPY_OPTIONS)
  if(STG_HAS_COPY_OPTIONS)
    add_compile_options(${stg_copy_options})
  endif()
endif()
if(STG_WERROR)
  add_compile_options(-Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fno-semantic-interposition)
endif()

if(STG_SANITIZE)
  if(NOT STG_SANITIZE MATCHES "^(address|thread|undefined|address,undefined|fuzz)$")
    message(FATAL_ERROR
      "STG_SANITIZE is '${STG_SANITIZE}', but must be address, thread, undefined, address,undefined or fuzz"
    )
  endif()
  # A Release build, too, is optimised only a little and has assertions.
  set(CMAKE_CXX_FLAGS_RELEASE "-O1 -g1")
  set(stg_sanitizers ${STG_SANITIZE})
  set(stg_sanitize_options)
  if(STG_SANITIZE STREQUAL "fuzz")
    if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      message(FATAL_ERROR "STG_SANITIZE=fuzz needs clang, because libFuzzer is a part of clang")
    endif()
    set(stg_sanitizers address,undefined)
    # These two checks need type information, which the libraries from Debian do not have.
    set(stg_sanitize_options -fsanitize=fuzzer-no-link -fno-sanitize=vptr,function)
  endif()
  # With the checks of a sanitizer in the code, GCC wrongly warns that members of std::regex and
  # std::function are uninitialised.
  add_compile_options(-Wno-maybe-uninitialized)
  add_compile_options(-fsanitize=${stg_sanitizers} -fno-sanitize-recover=all
    -fno-omit-frame-pointer ${stg_sanitize_options})
  add_link_options(-fsanitize=${stg_sanitizers} ${stg_sanitize_options})
endif()
