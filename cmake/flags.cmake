# SPDX-License-Identifier: GPL-3.0-or-later
# Compiler flags of all our targets. hilda_flags is also what `hilda info` shows.

# No contraction to fused multiply-add: the same source gives the same digits on every x86-64. We read no errno and
# unmask no floating-point traps, so the two -fno- flags change no result; -ffast-math would, and is never used.
set(hilda_flags -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-semantic-interposition)

if(HILDA_NATIVE)
    list(APPEND hilda_flags -O3 -march=native)
endif()

if(HILDA_SANITIZE STREQUAL "address")
    set(hilda_sanitize -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
elseif(HILDA_SANITIZE STREQUAL "thread")
    set(hilda_sanitize -fsanitize=thread -fno-omit-frame-pointer)
elseif(HILDA_SANITIZE STREQUAL "")
    set(hilda_sanitize "")
else()
    message(FATAL_ERROR "HILDA_SANITIZE is \"${HILDA_SANITIZE}\"; allowed are: empty, address, thread")
endif()
list(APPEND hilda_flags ${hilda_sanitize})
add_link_options(${hilda_sanitize})

set(hilda_warnings -Wall -Wextra -Wconversion -Wno-sign-conversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND hilda_warnings -Wshadow=local)
else()
    list(APPEND hilda_warnings -Wshadow) # Clang's -Wshadow is what GCC calls -Wshadow=local
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # In C++20 the optimiser of GCC 12 warns of its own std::string: s + "a" is enough (GCC bug 105329). The address
    # sanitizer of the debug build finds what these three would.
    list(APPEND hilda_warnings -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow)
    if(HILDA_NATIVE)
        # and of its own AVX-512 intrinsics, whose undefined operand is meant (GCC bug 105593)
        list(APPEND hilda_warnings -Wno-maybe-uninitialized -Wno-uninitialized)
    endif()
endif()
if(HILDA_WERROR)
    list(APPEND hilda_warnings -Werror)
endif()

add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:${hilda_flags};${hilda_warnings}>")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC looks for memory to give back after every 128 MB; at 512 MB it hardly ever does, and compiles an eighth faster.
    add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:--param ggc-min-heapsize=524288>")
endif()
# An element of a matrix that was never written shows itself as NaN.
add_compile_definitions($<$<CONFIG:Debug>:_GLIBCXX_ASSERTIONS> $<$<CONFIG:Debug>:EIGEN_INITIALIZE_MATRICES_BY_NAN>)
