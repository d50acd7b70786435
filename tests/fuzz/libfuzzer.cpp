// SPDX-License-Identifier: GPL-3.0-or-later
/// The function that libFuzzer calls, for the target HILDA_FUZZ_TARGET.

#include "tests/fuzz/targets.hpp"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    hilda::fuzz::HILDA_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
    return 0;
}
