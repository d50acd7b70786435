// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/mesh/mesh_surface.hpp"

#include "contact/mesh/mesh_file.hpp"
#include "contact/surface_types.hpp"
#include "contact/tangent_basis.hpp"
#include "contact/tessellation.hpp"
#include "lie/check.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::contact {

namespace {

// lengths relative to the longest edge at a vertex
constexpr double fit_reach = 2.5;  // radius within which the patch is fitted to vertices
constexpr double blend_reach =
    1.5;  // support radius ρ; every point of the mesh has a vertex within 0.6 edges

constexpr int terms = 10;                 // of a cubic in two variables
constexpr int min_vertices = 14;          // required to fit a cubic
constexpr size_t max_vertices = 4000;     // in a fit: the time for all fits grows with its square
constexpr double growth = 1.3;            // factor by which the fit radius grows if the fit is not determined
constexpr int max_growths = 3;            // number of times
constexpr double min_pivot_ratio = 1e-7;  // smallest to largest pivot of the normal equations
constexpr double max_angle = 80;          // between vertex normals of one patch [deg]

using Terms = Eigen::Matrix<double, terms, 1>;

Terms monomials(double x, double y)
{
    Terms m;
    m << 1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
    return m;
}

double longest_edge(const TriangleMesh& mesh, int vertex)
{
    double longest = 0;
    for (const int t : mesh.around[vertex])
        for (const int v : mesh.triangles[t])
            longest = std::max(longest, (mesh.vertices[v] - mesh.vertices[vertex]).norm());
    return longest;
}

/// The vertices within a distance that are connected by edges to `vertex`, which is the first. `seen` is a
/// work array, false before and after the call.
std::vector<int> neighbours(const TriangleMesh& mesh, int vertex, double distance, std::vector<bool>& seen)
{
    std::vector<int> found = {vertex};
    seen[vertex] = true;
    for (size_t k = 0; k < found.size(); ++k)
        for (const int t : mesh.around[found[k]])
            for (const int v : mesh.triangles[t])
                if (!seen[v] && (mesh.vertices[v] - mesh.vertices[vertex]).norm() < distance) {
                    seen[v] = true;
                    found.push_back(v);
                }
    for (const int v : found) seen[v] = false;
    return found;
}

constexpr const char* mesh_surface = "contact::MeshSurface: ";

[[noreturn]] void refuse(const std::string& what)
{
    throw lie::InvalidInput(mesh_surface + ("the mesh is too coarse for a smooth surface: " + what));
}

[[noreturn]] void refuse_narrow(int vertex, size_t known, double R)
{
    std::ostringstream what;
    what.precision(3);
    what << mesh_surface << "the triangles near vertex " << vertex << " are too narrow: " << known
         << " vertices are within " << R << " m, " << fit_reach << " times its longest edge; the limit is "
         << max_vertices;
    throw lie::InvalidInput(what.str());
}

void check_normals(const TriangleMesh& mesh, const std::vector<int>& near)
{
    for (const int v : near) {
        const Vec3 &n = mesh.vertex_normal[near[0]], &m = mesh.vertex_normal[v];
        const double angle = std::atan2(n.cross(m).norm(), n.dot(m)) * 180 / std::numbers::pi;
        if (angle <= max_angle) continue;
        std::ostringstream what;
        what.precision(3);
        what << "the normals of the neighbouring vertices " << near[0] << " and " << v << " differ by "
             << angle << " deg, the limit is " << max_angle << " deg";
        refuse(what.str());
    }
}

}  // namespace

MeshSurface::MeshSurface(TriangleMesh given, bool concave) : mesh(std::move(given)), concave(concave)
{
    Eigen::AlignedBox3d box;
    patches.resize(mesh.vertices.size());
    std::vector<bool> seen(std::max(mesh.vertices.size(), mesh.triangles.size()), false),
        expanded(mesh.vertices.size(), false);
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
        if (mesh.around[v].empty()) continue;
        box.extend(mesh.vertices[v]);
        patches[v] = fit_patch(v, seen);
    }
    length = 0.5 * std::cbrt(box.volume());

    // For each vertex, find the triangles that its patch contributes to: search outward over adjacent
    // triangles whose distance from the vertex is below ρ plus half an edge
    std::vector<std::vector<int>> patches_at(mesh.triangles.size());
    std::vector<int> corners;
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
        std::vector<int> reached = mesh.around[v], tested = reached;
        for (const int t : tested) seen[t] = true;
        for (size_t k = 0; k < reached.size(); ++k) {
            patches_at[reached[k]].push_back(v);  // ascending order makes the sums reproducible
            for (const int corner : mesh.triangles[reached[k]]) {
                if (expanded[corner]) continue;
                expanded[corner] = true;
                corners.push_back(corner);
                for (const int t : mesh.around[corner]) {
                    if (seen[t]) continue;
                    seen[t] = true;
                    tested.push_back(t);
                    if (mesh.distance(t, mesh.vertices[v]) < patches[v].rho + half_edge(t))
                        reached.push_back(t);
                }
            }
        }
        for (const int t : tested) seen[t] = false;
        for (const int corner : corners) expanded[corner] = false;
        corners.clear();
    }
    first_patch.push_back(0);
    for (const std::vector<int>& patches_of : patches_at) {
        patch_list.insert(patch_list.end(), patches_of.begin(), patches_of.end());
        first_patch.push_back(static_cast<int>(patch_list.size()));
    }
}

double MeshSurface::half_edge(int triangle) const
{
    const auto& [a, b, c] = mesh.triangles[triangle];
    const std::vector<Vec3>& x = mesh.vertices;
    return 0.5 * std::max({(x[a] - x[b]).norm(), (x[b] - x[c]).norm(), (x[c] - x[a]).norm()});
}

/// Least squares with the weights (1 - r²/R²)², which vanish at the fit radius R so that the fit depends
/// continuously on the vertices. Lengths are divided by R, so that the condition of the normal equations is
/// independent of the mesh size.
MeshSurface::Patch MeshSurface::fit_patch(int vertex, std::vector<bool>& seen) const
{
    const double edge = longest_edge(mesh, vertex);
    double R = fit_reach * edge;
    Patch patch{mesh.vertices[vertex], Mat3::Identity(), blend_reach * edge, {}};
    patch.E << tangent_basis(mesh.vertex_normal[vertex]), mesh.vertex_normal[vertex];
    size_t known = 0;
    for (int grown = 0; grown <= max_growths; ++grown, R *= growth) {
        const std::vector<int> near = neighbours(mesh, vertex, R, seen);
        known = near.size();
        if (known < min_vertices) continue;
        if (known > max_vertices) refuse_narrow(vertex, known, R);
        check_normals(mesh, near);

        Eigen::Matrix<double, terms, terms> normal = Eigen::Matrix<double, terms, terms>::Zero();
        Terms right = Terms::Zero();
        for (const int v : near) {
            const Vec3 x = patch.E.transpose() * (mesh.vertices[v] - patch.v) / R;
            const double w = (1 - x.squaredNorm()) * (1 - x.squaredNorm());
            const Terms m = monomials(x.x(), x.y());
            for (int i = 0; i < terms; ++i) {
                right[i] += w * m[i] * x.z();
                for (int j = 0; j <= i; ++j) normal(i, j) += w * m[i] * m[j];
            }
        }
        const Eigen::LDLT<Eigen::Matrix<double, terms, terms>> ldlt(normal);
        if (!(ldlt.vectorD().minCoeff() > min_pivot_ratio * ldlt.vectorD().maxCoeff())) continue;
        const Terms f = ldlt.solve(right);
        const double scale[] = {R, 1, 1 / R, 1 / (R * R)};
        constexpr int degree[terms] = {0, 1, 1, 2, 2, 2, 3, 3, 3, 3};
        for (int i = 0; i < terms; ++i) patch.f[i] = scale[degree[i]] * f[i];
        return patch;
    }
    refuse("the " + std::to_string(known) + " vertices near vertex " + std::to_string(vertex) +
           " do not determine a cubic");
}

Surface::Derivatives MeshSurface::Patch::at(const Vec3& a) const
{
    const Vec3 local = E.transpose() * (a - v);
    const double x = local.x(), y = local.y();
    const double f_x = f[1] + 2 * f[3] * x + f[4] * y + 3 * f[6] * x * x + 2 * f[7] * x * y + f[8] * y * y;
    const double f_y = f[2] + f[4] * x + 2 * f[5] * y + f[7] * x * x + 2 * f[8] * x * y + 3 * f[9] * y * y;
    const double f_xx = 2 * f[3] + 6 * f[6] * x + 2 * f[7] * y;
    const double f_xy = f[4] + 2 * f[7] * x + 2 * f[8] * y;
    const double f_yy = 2 * f[5] + 2 * f[8] * x + 6 * f[9] * y;
    const double height = f[0] + x * (f[1] + x * (f[3] + x * f[6])) + y * (f[2] + y * (f[5] + y * f[9])) +
                          x * y * (f[4] + x * f[7] + y * f[8]);
    const Vec3 t_x = E.col(0), t_y = E.col(1);
    const Mat3 half = t_x * (0.5 * f_xx * t_x + f_xy * t_y).transpose() + 0.5 * f_yy * t_y * t_y.transpose();
    return {local.z() - height, E.col(2) - f_x * t_x - f_y * t_y, -half - half.transpose()};
}

Surface::Derivatives MeshSurface::derivatives(const Vec3& a) const
{
    if (!a.allFinite()) return {NAN, Vec3::Constant(NAN), Mat3::Constant(NAN)};
    const TriangleMesh::Nearest near = mesh.nearest(a);
    if (!(near.distance <= half_edge(near.triangle))) return distance_function(a, near);

    // G = V / W with W = Σ w, V = Σ w Q, by the quotient rule
    Derivatives W{0, Vec3::Zero(), Mat3::Zero()}, V = W;
    for (int k = first_patch[near.triangle]; k < first_patch[near.triangle + 1]; ++k) {
        const Patch& patch = patches[patch_list[k]];
        const Vec3 d = a - patch.v;
        const double rho2 = patch.rho * patch.rho, s = 1 - d.squaredNorm() / rho2;
        if (!(s > 0)) continue;
        const Derivatives Q = patch.at(a);
        const double w = s * s * s;
        const Vec3 w_1 = -6 * s * s / rho2 * d;
        const Mat3 w_2 = 24 * s / (rho2 * rho2) * d * d.transpose() - 6 * s * s / rho2 * Mat3::Identity();
        const Mat3 mixed = w_1 * Q.gradient.transpose();
        W.G += w;
        W.gradient += w_1;
        W.hessian += w_2;
        V.G += w * Q.G;
        V.gradient += w * Q.gradient + Q.G * w_1;
        V.hessian += w * Q.hessian + mixed + mixed.transpose() + Q.G * w_2;
    }
    Derivatives G{V.G / W.G, Vec3::Zero(), Mat3::Zero()};
    G.gradient = (V.gradient - G.G * W.gradient) / W.G;
    const Mat3 half = 0.5 * (V.hessian - G.G * W.hessian) - G.gradient * W.gradient.transpose();
    G.hessian = (half + half.transpose()) / W.G;
    return G;
}

/// Signed distance to the closest face, edge or vertex, with its derivatives
Surface::Derivatives MeshSurface::distance_function(const Vec3& a, const TriangleMesh::Nearest& near) const
{
    const double side = (a - near.point).dot(mesh.normal(near.triangle, near.feature)) < 0 ? -1 : 1;
    const Vec3 n = (a - near.point) / near.distance;
    Mat3 bent = Mat3::Zero();
    if (near.feature > 0) bent = Mat3::Identity() - n * n.transpose();
    if (near.feature > 0 && near.feature < 4) {
        const Triangle& t = mesh.triangles[near.triangle];
        const Vec3 e = (mesh.vertices[t[near.feature % 3]] - mesh.vertices[t[near.feature - 1]]).normalized();
        bent -= e * e.transpose();
    }
    return {side * near.distance, side * n, side / near.distance * bent};
}

PolygonMesh MeshSurface::drawing(const DrawingExtent&) const
{
    PolygonMesh drawn;
    drawn.point = mesh.vertices;
    for (const auto& [a, b, c] : mesh.triangles) drawn.polygon.push_back({a, b, c});
    return drawn;
}

namespace {

/// The mesh of a file. The canonical form has its vertices and triangles, so that it is independent of the
/// file.
std::shared_ptr<const Surface> read_from_file(dae::ObjectReader& o)
{
    o.exclude("file", "vertices");
    o.exclude("file", "triangles");
    const auto [path, scale] =
        read_mesh_keys(o,
                       "Path of an OBJ or STL file (text or binary) with the mesh, relative to the folder "
                       "of the model file and below it, unless --allow-paths is given, instead of vertices "
                       "and triangles. Corners of an STL file with "
                       "equal coordinates become one vertex. At most 64 MiB and 200000 triangles.");
    for (const char* key : {"vertices", "triangles"}) o.record(key, {});  // their order in the canonical form
    const bool concave = read_concave(o);
    try {
        MeshFile mesh = read_mesh_file(path);
        for (Vec3& x : mesh.vertices) x *= scale;
        if (const auto fault = TriangleMesh::fault(mesh.vertices, mesh.triangles))
            throw lie::InvalidInput(mesh.message(*fault));
        dae::Json::List vertices, triangles;
        for (const Vec3& x : mesh.vertices) vertices.push_back(dae::json(x));
        for (const Triangle& t : mesh.triangles) triangles.push_back(dae::json(Vec3(t[0], t[1], t[2])));
        o.record("vertices", std::move(vertices));
        o.record("triangles", std::move(triangles));
        return std::make_shared<MeshSurface>(
            TriangleMesh(std::move(mesh.vertices), std::move(mesh.triangles)), concave);
    } catch (const dae::PlacedError&) {
        throw;
    } catch (const lie::InvalidInput& e) {
        const std::string what = e.what();
        o.fail("file", what.starts_with(mesh_surface)
                           ? path + ": " + what.substr(std::string_view(mesh_surface).size())
                           : what);
    }
}

std::shared_ptr<const Surface> read(dae::ObjectReader& o)
{
    if (o.find("file") != nullptr) return read_from_file(o);
    if (o.has("scale")) o.fail("scale", "scale is for a mesh from a file");
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    const Eigen::MatrixXd x =
        read_rows(o, "vertices", 3,
                  {"Vertices of the mesh [m], in the surface frame.",
                   "[[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]",
                   R"("minItems": 1, "items": {"$ref": "#/$defs/vector"})"});
    const Eigen::MatrixXd t = read_rows(
        o, "triangles", 3,
        {"Triangles as triples of vertex numbers counted from 0, counterclockwise seen from outside.",
         "[[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]",
         R"("minItems": 1, "items": {"type": "array", "items": {"type": "integer", "minimum": 0}, "minItems": 3, "maxItems": 3})"});
    for (Eigen::Index k = 0; k < x.rows(); ++k) vertices.emplace_back(x.row(k).transpose());
    for (Eigen::Index k = 0; k < t.rows(); ++k) {
        Triangle triangle;
        for (int corner = 0; corner < 3; ++corner) {
            const double v = t(k, corner);
            if (!(v >= 0 && v < static_cast<double>(vertices.size()) && v == std::trunc(v)))
                o.fail("triangles", "triangles[" + std::to_string(k) + "][" + std::to_string(corner) +
                                        "] must be the number of a vertex, from 0 to " +
                                        std::to_string(vertices.size() - 1) + ", got " + dae::shortest(v));
            triangle[corner] = static_cast<int>(v);
        }
        triangles.push_back(triangle);
    }
    if (const auto fault = TriangleMesh::fault(vertices, triangles))
        o.fail(fault->of_vertices ? "vertices" : "triangles", fault->what);
    const bool concave = read_concave(o);
    try {
        return std::make_shared<MeshSurface>(TriangleMesh(std::move(vertices), std::move(triangles)),
                                             concave);
    } catch (const lie::InvalidInput& e) {
        o.fail("vertices", std::string(e.what()).substr(std::string_view(mesh_surface).size()));
    }
}

const bool registered_mesh_surface = io::Registry<SurfaceType>::add(
    {.name = "mesh",
     .schema =
         {.description = "Closed triangle mesh, smoothed by cubic patches fitted at its vertices, so that "
                         "normal and curvature are continuous. The mesh must be fine enough: sharp edges and "
                         "too few vertices are rejected, and the message names the vertex. The example shows "
                         "the format only; it has too few vertices.",
          .examples =
              {R"("vertices": [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]], )"
               R"("triangles": [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, )"
               R"(5], [0, 4, 5]])",
               R"("file": "stone.stl", "scale": 0.001)"},
          .rest = R"("oneOf": [{"required": ["vertices", "triangles"], "not": {"required": ["file"]}}, )"
                  R"({"required": ["file"], )"
                  R"("not": {"anyOf": [{"required": ["vertices"]}, {"required": ["triangles"]}]}}], )"
                  R"("dependentRequired": {"scale": ["file"]})"},
     .read = read,
     .format_only = true});

}  // namespace

}  // namespace hilda::contact
