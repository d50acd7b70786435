// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of MJCF files, by the compiler of MuJoCo. In the module hilda-mjcf.so.

#include "io/error.hpp"
#include "run/importing/import_model.hpp"

#include <mujoco/mujoco.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

namespace hilda::run {

namespace {

using lie::Mat3;
using lie::Vec3;

Vec3 vector(const mjtNum* v) { return {v[0], v[1], v[2]}; }
Mat3 matrix(const mjtNum* M) { return Eigen::Map<const Eigen::Matrix<mjtNum, 3, 3, Eigen::RowMajor>>(M); }

class Reader {
public:
    Reader(std::string file, bool free_base, ImportedModel& to)
        : file(std::move(file)), free_base(free_base), to(to)
    {}

    void read()
    {
        std::array<char, 1000> message{};
        model = {mj_loadXML(file.c_str(), nullptr, message.data(), message.size()), mj_deleteModel};
        if (model == nullptr) {
            std::string text = message.data();
            for (char& c : text)
                if (c == '\n') c = ' ';
            // Elements of later versions are unknown to it.
            refuse("MuJoCo " + std::string(mj_versionString()) + ": " +
                   text.substr(0, text.find_last_not_of(' ') + 1));
        }
        data = {mj_makeData(model.get()), mj_deleteData};
        mj_kinematics(model.get(), data.get());
        mj_comPos(model.get(), data.get());
        to.name = std::filesystem::path(file).stem();
        to.gravity =
            (model->opt.disableflags & mjDSBL_GRAVITY) != 0 ? Vec3::Zero() : vector(model->opt.gravity);
        for (int b = 1; b < model->nbody; ++b) add_body(b);
        if (free_base) make_base_free();
        for (int e = 0; e < model->neq; ++e) add_loop(e);
        if (to.imports_contacts && (model->opt.disableflags & mjDSBL_CONTACT) == 0) add_shapes();
        warn();
    }

private:
    [[noreturn]] void refuse(const std::string& why) const { throw io::InvalidInput(file + ": " + why); }

    std::string name_of(int type, int id, const char* kind) const
    {
        const char* const name = mj_id2name(model.get(), type, id);
        return name != nullptr && *name != '\0' ? name : fmt::format("{}_{}", kind, id);
    }

    void add_body(int b)
    {
        ImportedBody body{.name = name_of(mjOBJ_BODY, b, "body"), .parent = model->body_parentid[b] - 1};
        if (body.name == "ground") body.name = "ground_body";
        body.m = model->body_mass[b];
        body.r = vector(data->xipos + 3 * b);
        body.A = matrix(data->ximat + 9 * b);
        body.J_bar = vector(model->body_inertia + 3 * b).asDiagonal();
        const int first = model->body_jntadr[b];
        for (int j = first; j < first + model->body_jntnum[b]; ++j) body.joints.push_back(joint(j));
        to.bodies.push_back(body);
    }

    /// The base is the body of the world that has no joint.
    void make_base_free()
    {
        ImportedBody* base = nullptr;
        for (ImportedBody& body : to.bodies) {
            if (body.parent >= 0 || !body.joints.empty()) continue;
            if (base != nullptr)
                refuse("--base free: the bodies '" + base->name + "' and '" + body.name +
                       "' of the world have no joint; give the base a freejoint in the file");
            base = &body;
        }
        if (base == nullptr) refuse("--base free: each body of the world has a joint");
        base->joints.push_back({.name = "base", .type = ImportedJoint::free});
    }

    ImportedJoint joint(int j)
    {
        ImportedJoint one{.name = name_of(mjOBJ_JOINT, j, "joint"),
                          .anchor = vector(data->xanchor + 3 * j),
                          .axis = vector(data->xaxis + 3 * j),
                          .stiffness = model->jnt_stiffness[j]};
        const std::string what = "joint '" + one.name + "'";
        int dofs = 1;
        switch (model->jnt_type[j]) {
            case mjJNT_HINGE:
                one.type = ImportedJoint::hinge;
                break;
            case mjJNT_SLIDE:
                one.type = ImportedJoint::slide;
                break;
            case mjJNT_BALL:
                one.type = ImportedJoint::ball, dofs = 3;
                break;
            default:
                one.type = ImportedJoint::free, dofs = 6;
                break;
        }
        const int q = model->jnt_qposadr[j], dof = model->jnt_dofadr[j];
        if (dofs == 1) one.rest = model->qpos_spring[q] - model->qpos0[q];
        one.damping = model->dof_damping[dof];
        if ((model->opt.disableflags & mjDSBL_PASSIVE) != 0) one.stiffness = one.damping = 0;
        for (int k = dof; k < dof + dofs; ++k) {
            if (model->dof_armature[k] != 0) refuse(what + ": armature is not supported");
            if (k == dof && model->dof_frictionloss[k] != 0) to.warnings.push_back("frictionloss of " + what);
        }
        if (model->jnt_limited[j] != 0) to.warnings.push_back("limits of " + what);
        return one;
    }

    void add_loop(int e)
    {
        if (model->eq_active[e] == 0 || (model->opt.disableflags & mjDSBL_EQUALITY) != 0) return;
        const std::string name = name_of(mjOBJ_EQUALITY, e, "equality");
        const int type = model->eq_type[e], b1 = model->eq_obj1id[e], b2 = model->eq_obj2id[e];
        if (type != mjEQ_CONNECT && type != mjEQ_WELD)
            refuse("equality '" + name + "': only connect and weld are supported");
        ImportedLoop loop{.name = name, .is_weld = type == mjEQ_WELD, .i = b1 - 1, .j = b2 - 1};
        loop.point = vector(data->xpos + 3 * b1) +
                     matrix(data->xmat + 9 * b1) * vector(model->eq_data + mjNEQDATA * e);
        if (loop.is_weld) compare_pose(e, name);
        to.loops.push_back(loop);
    }

    /// Warns if the pose of qpos0, which HILDA keeps, is not that of a weld.
    void compare_pose(int e, const std::string& name)
    {
        const int b1 = model->eq_obj1id[e], b2 = model->eq_obj2id[e];
        const mjtNum* const of = model->eq_data + mjNEQDATA * e;  // point of b2, point of b1, quaternion
        const Mat3 A1 = matrix(data->xmat + 9 * b1), A2 = matrix(data->xmat + 9 * b2);
        std::array<mjtNum, 9> turn{};
        mju_quat2Mat(turn.data(), of + 6);
        const double gap = (vector(data->xpos + 3 * b1) + A1 * vector(of + 3) - vector(data->xpos + 3 * b2) -
                            A2 * vector(of))
                               .norm();
        const double angle = Eigen::AngleAxisd(Mat3((A1 * matrix(turn.data())).transpose() * A2)).angle();
        if (gap > 1e-6 || angle > 1e-6)
            to.warnings.push_back(
                fmt::format("relpose of equality '{}', from which qpos0 differs by {:.3g} m and {:.3g} rad; "
                            "the pose of qpos0 is kept",
                            name, gap, angle));
    }

    void add_shapes()
    {
        for (int g = 0; g < model->ngeom; ++g)
            if (model->geom_contype[g] != 0 || model->geom_conaffinity[g] != 0) add_shape(g);
        for (int k = 0; k < model->nexclude; ++k) {  // (body1 + 1) << 16 + body2 + 1 in the numbers of MuJoCo
            const int i = (model->exclude_signature[k] >> 16) - 2,
                      j = (model->exclude_signature[k] & 0xFFFF) - 2;
            to.without_contact.insert(std::minmax(i, j));
        }
        for (int k = 0; k < model->npair; ++k)
            to.warnings.push_back(
                fmt::format("pair of the geoms '{}' and '{}': only contacts by contype and "
                            "conaffinity are imported",
                            name_of(mjOBJ_GEOM, model->pair_geom1[k], "geom"),
                            name_of(mjOBJ_GEOM, model->pair_geom2[k], "geom")));
    }

    void add_shape(int g)
    {
        const Vec3 size = vector(model->geom_size + 3 * g);
        ImportedShape shape{.name = fmt::format("geom '{}' of body '{}'", name_of(mjOBJ_GEOM, g, "geom"),
                                                name_of(mjOBJ_BODY, model->geom_bodyid[g], "body")),
                            .body = model->geom_bodyid[g] - 1,
                            .p = vector(data->geom_xpos + 3 * g),
                            .A = matrix(data->geom_xmat + 9 * g),
                            .mu = model->geom_friction[3 * g],
                            .is_frictionless = model->geom_condim[g] == 1,
                            .priority = model->geom_priority[g],
                            .type_mask = model->geom_contype[g],
                            .partner_mask = model->geom_conaffinity[g],
                            .touches_neighbours = true};  // MuJoCo tests children of the world with it
        switch (model->geom_type[g]) {
            case mjGEOM_PLANE:
                shape.type = ImportedShape::plane;
                break;
            case mjGEOM_SPHERE:
                shape.type = ImportedShape::sphere, shape.size = Vec3(size[0], 0, 0);
                break;
            case mjGEOM_CAPSULE:
                shape.type = ImportedShape::capsule, shape.size = Vec3(size[0], 2 * size[1], 0);
                break;
            case mjGEOM_ELLIPSOID:
                shape.type = ImportedShape::ellipsoid, shape.size = size;
                break;
            case mjGEOM_BOX:
                shape.type = ImportedShape::box, shape.size = 2 * size;
                break;
            case mjGEOM_MESH: {
                shape.type = ImportedShape::convex;
                const int mesh = model->geom_dataid[g], first = model->mesh_vertadr[mesh];
                for (int k = first; k < first + model->mesh_vertnum[mesh]; ++k) {
                    const float* const x = model->mesh_vert + 3 * k;
                    shape.points.emplace_back(x[0], x[1], x[2]);
                }
                break;
            }
            case mjGEOM_CYLINDER:
                return add_cylinder(to, std::move(shape), size[0], 2 * size[1]);
            default:
                to.warnings.push_back(shape.name + ": rigid contacts have no such geometry");
                return;
        }
        to.shapes.push_back(std::move(shape));
    }

    void warn()
    {
        const mjOption& option = model->opt;
        if (vector(option.wind).norm() != 0 || option.density != 0 || option.viscosity != 0)
            refuse("option: forces of a medium (wind, density, viscosity) are not supported");
        if (model->ntendon > 0) refuse("tendons are not supported");
        bool can_collide = false;
        for (int g = 0; g < model->ngeom; ++g)
            can_collide = can_collide || model->geom_contype[g] != 0 || model->geom_conaffinity[g] != 0;
        if (!to.imports_contacts && ((can_collide && model->ngeom > 1) || model->npair > 0))
            to.warnings.emplace_back("contacts between geoms, which --contacts imports");
        if (model->nu > 0) to.warnings.emplace_back("actuators");
        if (model->nkey > 0)
            to.warnings.emplace_back("keyframes; the initial state is that of qpos0 at rest");
    }

    const std::string file;
    const bool free_base;
    ImportedModel& to;
    std::unique_ptr<mjModel, void (*)(mjModel*)> model{nullptr, mj_deleteModel};
    std::unique_ptr<mjData, void (*)(mjData*)> data{nullptr, mj_deleteData};
};

}  // namespace

}  // namespace hilda::run

extern "C" void hilda_import_mjcf(const std::string& file, bool free_base, hilda::run::ImportedModel& to)
{
    hilda::run::Reader(file, free_base, to).read();
}
