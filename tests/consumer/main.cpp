// SPDX-License-Identifier: GPL-3.0-or-later
// Lists the integrators of an installed HILDA: the shared library must have kept the ones that nobody calls
// by name, and with them the reader of contacts.
#include <iostream>

#include "dae/model_file_types.hpp"
#include "lie/integrator.hpp"

int main()
{
    for (const hilda::lie::Scheme& s : hilda::lie::schemes()) std::cout << s.name << "\n";
    return hilda::dae::contact_reader() != nullptr ? 0 : 1;
}
