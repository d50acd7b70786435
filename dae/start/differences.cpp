// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/start/differences.hpp"

#include "lie/loads.hpp"

namespace hilda::dae {

void difference_loads(const Force& f, const State& x, lie::LoadVariation& out, Force::LoadDerivatives& d)
{
    constexpr double h = 6e-6;  // balances the truncation error h² and the rounding error 1e-16/h
    const std::array<int, 2> bodies = f.bodies();
    d.setZero();
    for (int by = 0; by < 2; ++by) {
        if (bodies[by] == ground) continue;
        Motion& moved = out.x.body[bodies[by]];
        for (int c = 0; c < 12; ++c) {
            const auto evaluate = [&](double step, lie::Loads& loads) {
                Vec3* const part[] = {&moved.r, nullptr, &moved.rdot, &moved.omega_bar};
                if (c / 3 == 1)
                    moved.A = moved.A * lie::exp(step * Vec3::Unit(c - 3));
                else
                    (*part[c / 3])[c % 3] += step;
                loads.set_zero();
                f.add(out.x, loads);
                moved = x.body[bodies[by]];
            };
            evaluate(h, out.plus);
            evaluate(-h, out.minus);
            auto column = d.col((c < 6 ? 0 : 6) + 6 * by + c);
            for (int on = 0; on < 2; ++on)
                if (const int b = bodies[on]; b != ground)
                    column.segment<6>(6 * on) << (out.plus.F[b] - out.minus.F[b]) / (2 * h),
                        (out.plus.n_bar[b] - out.minus.n_bar[b]) / (2 * h);
        }
    }
}

}  // namespace hilda::dae
