// SPDX-License-Identifier: GPL-3.0-or-later
// main() of all test programs.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

int main(int argc, char** argv)
{
    // All digits of a double: with the default precision a failed comparison of 1e-15 is printed as "0.0 <
    // 0.0".
    Catch::StringMaker<double>::precision = 17;
    return Catch::Session().run(argc, argv);
}
