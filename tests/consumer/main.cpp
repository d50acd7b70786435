// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the integrators of an installed HILDA. The shared library must contain the integrators and the
// reader of contacts, which register themselves and are not referenced by name.
#include <iostream>

#include "dae/model_types.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"

int main()
{
    for (const hilda::lie::Scheme& s : hilda::lie::schemes()) std::cout << s.name << "\n";
    return hilda::dae::contact_reader() != nullptr ? 0 : 1;
}
