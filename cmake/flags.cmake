# SPDX-License-Identifier: GPL-3.0-or-later
# Compiler flags of all targets. `hilda --version` prints hilda_flags.

# -ffp-contract=off: no fused multiply-add, so that results are bit-identical on every x86-64. The program
# does not read errno and does not enable floating-point traps; -fno-math-errno and -fno-trapping-math
# therefore do not change results. -ffast-math changes results and is not used.
set(hilda_flags -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-semantic-interposition)

if(HILDA_NATIVE)
    list(APPEND hilda_flags -O3 -march=native)
endif()

# The loops that take the time of a run are in these rooms. GCC inlines the small loops of Eigen, which take a tenth of a step,
# with -O3 only. The results are the same bit by bit.
set(hilda_optimised_rooms lie dae contact reference)

if(HILDA_SANITIZE STREQUAL "address")
    set(hilda_sanitize -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
elseif(HILDA_SANITIZE STREQUAL "thread")
    set(hilda_sanitize -fsanitize=thread -fno-omit-frame-pointer)
elseif(HILDA_SANITIZE STREQUAL "fuzz")
    # The fuzz targets also link the main function of libFuzzer, see tests/fuzz/CMakeLists.txt.
    set(hilda_sanitize -fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all -fno-omit-frame-pointer)
elseif(HILDA_SANITIZE STREQUAL "")
    set(hilda_sanitize "")
else()
    message(FATAL_ERROR "HILDA_SANITIZE must be empty, address, thread or fuzz, got \"${HILDA_SANITIZE}\"")
endif()
list(APPEND hilda_flags ${hilda_sanitize})
add_link_options(${hilda_sanitize})

set(hilda_warnings -Wall -Wextra -Wconversion -Wno-sign-conversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND hilda_warnings -Wshadow=local)
else()
    list(APPEND hilda_warnings -Wshadow) # equal to -Wshadow=local of GCC
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 reports false positives in its own std::string in C++20, e.g. for s + "a" (GCC bug 105329). The
    # address sanitizer of the debug build covers these three warnings.
    list(APPEND hilda_warnings -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow)
    if(HILDA_NATIVE)
        # false positives in the AVX-512 intrinsics of GCC (GCC bug 105593)
        list(APPEND hilda_warnings -Wno-maybe-uninitialized -Wno-uninitialized)
    endif()
endif()
if(HILDA_WERROR)
    list(APPEND hilda_warnings -Werror)
endif()

add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:${hilda_flags};${hilda_warnings}>")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # The garbage collector of GCC then starts at 512 MB in the place of 128 MB. Compilation takes an eighth
    # less time.
    add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:--param ggc-min-heapsize=524288>")
endif()
# Debug builds initialise matrices with NaN, which reveals elements that are never set.
add_compile_definitions($<$<CONFIG:Debug>:_GLIBCXX_ASSERTIONS> $<$<CONFIG:Debug>:EIGEN_INITIALIZE_MATRICES_BY_NAN>)
