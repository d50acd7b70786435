// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/outputs/output.hpp"

template class hilda::io::Registry<hilda::dae::OutputType>;
