// SPDX-License-Identifier: GPL-3.0-or-later
/// Runs a URDF or MJCF file in MuJoCo, by its RK4 scheme, for the comparison with an imported model.
///
///     mujoco_run FILE STEP END
///
/// Prints for each body with joints, with those that are welded to it: its name, the centre of mass at the
/// end [m], and the rotation from the start to the end, row by row.

#include <mujoco/mujoco.h>

#include <Eigen/Core>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using Matrix = Eigen::Matrix<mjtNum, 3, 3, Eigen::RowMajor>;

Matrix orientation(const mjData* d, int body) { return Eigen::Map<const Matrix>(d->xmat + 9 * body); }

}  // namespace

int main(int argc, char** argv)
{
    if (argc != 4) return 2;
    char message[1000] = "";
    mjModel* const m = mj_loadXML(argv[1], nullptr, message, sizeof message);
    if (m == nullptr) {
        std::fprintf(stderr, "%s\n", message);
        return 3;
    }
    m->opt.integrator = mjINT_RK4;
    m->opt.timestep = std::atof(argv[2]);
    m->opt.disableflags |= mjDSBL_LIMIT | mjDSBL_CONTACT;
    mjData* const d = mj_makeData(m);
    mj_forward(m, d);
    std::vector<Matrix> start;
    for (int b = 0; b < m->nbody; ++b) start.push_back(orientation(d, b));
    const long steps = std::lround(std::atof(argv[3]) / m->opt.timestep);
    for (long n = 0; n < steps; ++n) mj_step(m, d);
    mj_forward(m, d);
    for (int b = 1; b < m->nbody; ++b) {
        if (m->body_weldid[b] != b) continue;
        double mass = 0;
        Eigen::Vector3d r(0, 0, 0);
        for (int k = b; k < m->nbody; ++k) {
            if (m->body_weldid[k] != b) continue;
            mass += m->body_mass[k];
            r += m->body_mass[k] * Eigen::Map<const Eigen::Vector3d>(d->xipos + 3 * k);
        }
        const Matrix turn = orientation(d, b) * start[static_cast<size_t>(b)].transpose();
        std::printf("%s %.17g %.17g %.17g", mj_id2name(m, mjOBJ_BODY, b), r[0] / mass, r[1] / mass,
                    r[2] / mass);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) std::printf(" %.17g", turn(i, j));
        std::printf("\n");
    }
    mj_deleteData(d);
    mj_deleteModel(m);
}
