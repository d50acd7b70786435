// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/core/neighbours_impl.hpp"

namespace hilda::granular {

template class Neighbours<par::Cpu>;

}  // namespace hilda::granular
