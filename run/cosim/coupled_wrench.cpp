// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/coupled_wrench.hpp"

namespace hilda::run {

CoupledWrench::CoupledWrench(int body, std::string of, std::function<Wrench6(const dae::State& x)> at_start)
    : body(body), at_start(std::move(at_start))
{
    name = std::move(of);
}

void CoupledWrench::add(const dae::State& x, lie::Loads& out) const
{
    const Eigen::Map<const Wrench6> w(x.internal_state.data() + first_internal_state);
    const auto b = static_cast<size_t>(body);
    out.F[b] += w.head<3>();
    out.n_bar[b] += x.body[b].A.transpose() * w.tail<3>();
}

void CoupledWrench::update_internal_state(dae::State& x) const
{
    if (at_start) Eigen::Map<Wrench6>(x.internal_state.data() + first_internal_state) = at_start(x);
}

}  // namespace hilda::run
