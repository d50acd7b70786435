// SPDX-License-Identifier: GPL-3.0-or-later
// The main() of every test program.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

int main(int argc, char** argv)
{
    // Enough digits to tell neighbours apart: with five, a failing 1e-15 reads "0.0 < 0.0".
    Catch::StringMaker<double>::precision = 17;
    return Catch::Session().run(argc, argv);
}
