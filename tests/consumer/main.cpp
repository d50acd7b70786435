// SPDX-License-Identifier: GPL-3.0-or-later
// Lists the integrators of an installed HILDA: the shared library must have kept the ones that nobody calls
// by name.
#include <iostream>

#include "lie/integrator.hpp"

int main()
{
    for (const hilda::lie::Scheme& s : hilda::lie::schemes()) std::cout << s.name << "\n";
}
