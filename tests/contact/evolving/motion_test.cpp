// SPDX-License-Identifier: GPL-3.0-or-later
/// Motions of a ball with evolving contacts against closed forms and against an independent integration of
/// the same motions in minimal coordinates, without constraints or multipliers.

#include "dae/model.hpp"
#include "lie/solver/linear_solver.hpp"
#include "tests/support/evolving.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using namespace hilda::contact;
using namespace hilda::tests;

namespace {

using std::numbers::pi;

const Vec3 planar_start(0, 1.3203946979732251, -1.2654225449401859),
    xy_start(0.93073643551905849, 1.3152971613841562, -1.1988698851259592);

struct Row {
    double t;
    Vec3 r, p;  ///< centre of the ball, contact point [m]
    double F_N;
};

// clang-format off
const std::vector<Row> planar_slide{
    {1, {0, -0.043798520215, -1.499760193906}, {0, -0.049273796838, -1.999730214353}, 10.959128729898},
    {2, {0, -1.317652815037, -1.266476403538}, {0, -1.496815548568, -1.733274769981}, 9.165254848127},
    {3.5, {0, 1.040160678533, -1.358735618322}, {0, 1.176904214354, -1.839673457768}, 9.968924414728},
    {5, {0, -0.21799345249, -1.494049204127}, {0, -0.245299738264, -1.993303014085}, 10.923840159205},
    {6, {0, -1.295763301526, -1.274783439644}, {0, -1.471411517354, -1.742915583676}, 9.243453797433},
    {7.5, {0, 1.137116622328, -1.329601281542}, {0, 1.288196529785, -1.806229922691}, 9.729976436854},
    {8.7, {0, 0.247800552005, -1.492306554697}, {0, 0.278859584149, -1.991340958844}, 10.912998214168},
    {10, {0, -1.252233042543, -1.290751717091}, {0, -1.420987374225, -1.76141292809}, 9.390381661565}};
const std::vector<Row> planar_roll{
    {1, {0, 0.286014738188, -1.489742793475}, {0, 0.321895881121, -1.988453675231}, 10.57919099149},
    {2, {0, -1.202765029037, -1.308033471612}, {0, -1.363830022044, -1.781381195835}, 9.470955790864},
    {3.5, {0, 0.041395567626, -1.499785787071}, {0, 0.046570403287, -1.999759007429}, 10.630768480454},
    {5, {0, 1.167081221515, -1.319946392529}, {0, 1.322689038339, -1.79511605417}, 9.555005010001},
    {6, {0, -0.36614374493, -1.483156983972}, {0, -0.412184027674, -1.981032764027}, 10.54487792665},
    {7.5, {0, -0.981923521827, -1.374745308567}, {0, -1.110265915268, -1.857992895261}, 9.919521019119},
    {8.7, {0, 0.949241308224, -1.383256912484}, {0, 1.07293167426, -1.867716088628}, 9.973034795711},
    {10, {0, 0.735928451711, -1.430861047745}, {0, 0.830200107516, -1.921893485484}, 10.257998046463}};
const std::vector<Row> xy_slide{
    {1, {0.352316278951, -0.065805870356, -1.491161592947}, {0.375891718342, -0.074063999537, -1.990537205047}, 11.110989983185},
    {2, {-0.682523886914, -1.311235464591, -1.232530416286}, {-0.732558295302, -1.492455135024, -1.69584023598}, 9.192279204174},
    {3.5, {-0.481376671033, 1.082611190887, -1.329295972983}, {-0.515435214573, 1.226714125517, -1.806867286865}, 9.961074601369},
    {5, {0.91264154328, -0.320802677928, -1.430221630662}, {0.975267682583, -0.362144667634, -1.924558364643}, 10.873127354311},
    {6, {0.581131370147, -1.263081522602, -1.260868178469}, {0.623270339589, -1.435637368738, -1.728253230881}, 9.438110749862},
    {7.5, {-0.836949775463, 1.204465611392, -1.253854612411}, {-0.897953513406, 1.369918691847, -1.721726199628}, 9.498005254635},
    {8.7, {-0.534075166014, 0.062342902918, -1.480390482021}, {-0.56997877223, 0.070204724898, -1.979037775021}, 11.079454803683},
    {10, {0.774395074582, -1.168162030127, -1.274205110106}, {0.830394765908, -1.327289085553, -1.744888246411}, 9.604876515552}};
const std::vector<Row> xy_roll{
    {1, {0.506229232506, 0.26675089074, -1.47382371659}, {0.540329797529, 0.300461706283, -1.971519137888}, 10.675123929733},
    {2, {-0.390738058298, -1.217042796466, -1.291581364247}, {-0.418731381462, -1.381197016814, -1.76303630992}, 9.538701242596},
    {3.5, {-0.877684103341, 0.098857769072, -1.446622910691}, {-0.937550825079, 0.111517061994, -1.942864502993}, 10.608084228353},
    {5, {0.270619847553, 1.135572456691, -1.324656526854}, {0.289776082183, 1.286802067531, -1.800852540571}, 9.730578845525},
    {6, {0.903170511146, -0.450400694663, -1.41834284141}, {0.965392118669, -0.508686858009, -1.911020418249}, 10.472206020708},
    {7.5, {0.315453301626, -0.902519475362, -1.387763332583}, {0.337308916668, -1.020014363262, -1.873270575998}, 10.166384892806},
    {8.7, {-0.707446120422, 1.033256319215, -1.323934208034}, {-0.757688152771, 1.171338123715, -1.801855910253}, 9.85557105828},
    {10, {-0.77968008688, 0.598811716194, -1.41240982077}, {-0.83342891672, 0.676356701841, -1.903426967611}, 10.411169296655}};
const std::vector<Row> xy_roll_spin{
    {1, {0.427783030633, 0.287411014019, -1.477325212023}, {0.456552057497, 0.323669918581, -1.975178237457}, 10.67956124933},
    {2, {-0.72927306027, -1.130017559993, -1.29199231386}, {-0.781656389304, -1.2828559998, -1.765169234427}, 9.631418836387},
    {3.5, {-1.055999864996, 0.157447201418, -1.420793463574}, {-1.128834089281, 0.177847186799, -1.915039370354}, 10.521022662216},
    {5, {0.979167696367, 0.8915761406, -1.32800618661}, {1.048835269389, 1.010956642931, -1.808521248738}, 9.910355780513},
    {6, {1.35635760235, -0.601788628641, -1.323091915775}, {1.453641730195, -0.683056462846, -1.806756404438}, 10.079683369513},
    {7.5, {-0.452303001663, -0.54830661287, -1.447980146871}, {-0.483027300965, -0.618214643934, -1.942114627175}, 10.498872940976},
    {8.7, {-1.183269816311, 1.15758220325, -1.21512733631}, {-1.271182309664, 1.319855311493, -1.679819526748}, 9.265757703061},
    {10, {-0.173799601138, 0.179319854549, -1.493956039042}, {-0.185411813887, 0.201787019868, -1.993316012406}, 10.737889197907}};
// clang-format on

#ifdef NDEBUG
constexpr double long_run = 10;
#else
constexpr double long_run = 3.5;  // with sanitizers
#endif

/// Largest errors of a run in the bowl at the times of the rows, and largest residuals at all nodes
struct BowlErrors {
    double r = 0, p = 0, F_N = 0, residual = 0, N = 0, tangential = 0, G = 0, F_N_0 = 0;
};

BowlErrors bowl_errors(const char* scheme, double h, const Vec3& start, Friction friction,
                       const std::vector<Row>& reference, const Vec3& omega = Vec3::Zero())
{
    BallInBowl scene(start, friction, omega);
    BowlErrors worst;
    Eigen::VectorXd Phi(scene.model.rows());
    run(scene, scheme, h, long_run, [&](const lie::State& x, long n) {
        const auto lambda = multipliers(scene.model, x);
        scene.model.phi(x, Phi);
        worst.residual = std::max(worst.residual, Phi.lpNorm<Eigen::Infinity>());
        worst.N = std::max(worst.N, lambda.N.norm() / lambda.F_N);
        worst.tangential = std::max(worst.tangential, lambda.tangential.norm() / lambda.F_N);
        worst.G = std::max(worst.G, (lambda.G - lambda.F_N * Eigen::Vector2d(-1, 1)).norm() / lambda.F_N);
        if (n == 0) worst.F_N_0 = lambda.F_N;
        for (const Row& row : reference) {
            if (std::abs(x.t - row.t) > 0.1 * h) continue;
            worst.r = std::max(worst.r, (x.body[0].r - row.r).norm());
            worst.p = std::max(worst.p, (x.alpha.tail<3>() - row.p).norm());
            worst.F_N = std::max(worst.F_N, std::abs(lambda.F_N - row.F_N));
        }
    });
    return worst;
}

std::string summary(const BowlErrors& e)
{
    std::ostringstream text;
    text << "errors r " << e.r << ", p " << e.p << ", F_N " << e.F_N << "; residual " << e.residual
         << ", lambda_N " << e.N << ", tangential " << e.tangential << ", lambda_G " << e.G;
    return text.str();
}

}  // namespace

TEST_CASE("the start of a ball in a bowl agrees with the closed form", "[contact][evolving]")
{
    // contact at (0, 1.5) on the bowl (4, 3, 2)
    BallInBowl planar(planar_start);
    const EvolvingContact& c = contact_of(planar.model);
    const ContactPoint contact_point = c.contact_point(planar.model.arguments(c, planar.x));
    CHECK((contact_point.C_j - Vec3(0, 1.5, -1.7320508075688773)).norm() < 1e-14);
    CHECK((contact_point.n - Vec3(0, -0.3592106040535498, 0.9332565252573827)).norm() < 1e-14);
    CHECK(multipliers(planar.model, planar.x).F_N == Approx(9.155246512774925).epsilon(1e-13));
    CHECK(multipliers(planar.model, planar.x).friction.norm() == 0);

    BallInBowl rolling(planar_start, Friction::rolling);
    const auto lambda = multipliers(rolling.model, rolling.x);
    CHECK(lambda.F_N == Approx(9.155246512774925).epsilon(1e-13));
    CHECK(lambda.friction.norm() == Approx(1.006816007361521).epsilon(1e-13));

    BallInBowl xy(xy_start);
    CHECK(multipliers(xy.model, xy.x).F_N == Approx(9.014262047215154).epsilon(1e-13));
}

TEST_CASE("a ball slides in a bowl for ten seconds with the order of the scheme (long)",
          "[contact][evolving][order]")
{
    struct Bounds {
        const char* scheme;
        double order, r, F_N, r_xy, F_N_xy;
    };
    const Bounds bounds = GENERATE(Bounds{"rA-half-1", 1, 6e-3, 7.5e-3, 6.1e-3, 8.7e-3},
                                   Bounds{"rA-half-1-kick", 2, 7e-5, 9e-5, 7e-5, 1e-4},
                                   Bounds{"rA-half-1-momentum", 2, 7e-5, 9e-5, 7e-5, 1e-4});
    for (const bool xy : {false, true}) {
        const auto errors = [&](double h) {
            return bowl_errors(bounds.scheme, h, xy ? xy_start : planar_start, Friction::none,
                               xy ? xy_slide : planar_slide);
        };
        const BowlErrors coarse = errors(5e-3), fine = errors(2.5e-3);
        INFO(bounds.scheme << (xy ? ", xy: " : ", planar: ") << summary(coarse)
                           << "; halved: " << summary(fine));
        CHECK(coarse.r < (xy ? bounds.r_xy : bounds.r));
        CHECK(coarse.F_N < (xy ? bounds.F_N_xy : bounds.F_N));
        CHECK(std::log2(coarse.r / fine.r) == Approx(bounds.order).margin(0.03));
        CHECK(std::log2(coarse.p / fine.p) == Approx(bounds.order).margin(0.03));
        CHECK(std::log2(coarse.F_N / fine.F_N) == Approx(bounds.order).margin(0.03));
        for (const BowlErrors& e : {coarse, fine}) {
            CHECK(e.residual < 2e-15 * 2);  // size of the contact coordinates: 2 m
            CHECK(e.N < 1e-12);
            CHECK(e.tangential < 1e-12);
            CHECK(e.G < 1e-12);
        }
    }
}

TEST_CASE("a ball rolls in a bowl for ten seconds with second order (long)", "[contact][evolving][order]")
{
    const Vec3 spin =
        -5 * Vec3(0.13852712896188304, 0.36940567723168771, -0.91888502010348160);  // about the normal
    struct Case {
        const char* name;
        Vec3 start, omega;
        const std::vector<Row>* reference;
    };
    for (const Case& c : {Case{"planar", planar_start, Vec3::Zero(), &planar_roll},
                          {"xy", xy_start, Vec3::Zero(), &xy_roll},
                          {"xy, spinning", xy_start, spin, &xy_roll_spin}}) {
        const auto errors = [&](double h) {
            return bowl_errors("rA-half-1-momentum", h, c.start, Friction::rolling, *c.reference, c.omega);
        };
        const BowlErrors coarse = errors(5e-3), fine = errors(2.5e-3);
        INFO(c.name << ": " << summary(coarse) << "; halved: " << summary(fine));
        CHECK(std::log2(coarse.r / fine.r) == Approx(2).margin(0.03));
        CHECK(std::log2(coarse.p / fine.p) == Approx(2).margin(0.03));
        CHECK(std::log2(coarse.F_N / fine.F_N) == Approx(2).margin(0.03));
        CHECK(coarse.r < 1e-4);
        CHECK(coarse.residual < 2e-15 * 2);
        CHECK(coarse.tangential < 1e-12);
    }
}

TEST_CASE("the energy error of a ball in a bowl is bounded and of second order in the step (long)",
          "[contact][evolving]")
{
    const auto drift = [](const char* scheme, double h, bool centred) {
        BallInBowl scene(planar_start);
        lie::State before;
        double first = 0, largest = 0;
        run(scene, scheme, h, long_run, [&](lie::State x, long n) {
            if (n == 0) first = lie::energy(scene.model, x);
            // the velocities of rA-half-1 belong to the middle of the step before the node; the mean of two
            // is that of the node
            if (centred && n > 1) {
                before.body[0].rdot = 0.5 * (before.body[0].rdot + x.body[0].rdot);
                largest = std::max(largest, std::abs(lie::energy(scene.model, before) - first));
            }
            if (!centred) largest = std::max(largest, std::abs(lie::energy(scene.model, x) - first));
            before = x;
        });
        return largest;
    };
    struct Case {
        const char* scheme;
        bool centred;
    };
    for (const Case& c :
         {Case{"rA-half-1", true}, {"rA-half-1-kick", false}, {"rA-half-1-momentum", false}}) {
        const double coarse = drift(c.scheme, 5e-3, c.centred), fine = drift(c.scheme, 2.5e-3, c.centred);
        INFO(c.scheme << ": " << coarse << " J, " << fine << " J");
        CHECK(coarse < 4e-5);
        CHECK(coarse / fine == Approx(4).margin(0.15));
    }
}

TEST_CASE("a ball slides and rolls along the wall of an upright cylinder (long)",
          "[contact][evolving][order]")
{
    // The normal always lies in the xy-plane. Without friction the ball falls freely; with rolling it
    // oscillates: z = z_eq (1 - cos(Ω sqrt(2/7) t)), z_eq = -5g / 2Ω².
    constexpr double rho = 2, Omega = 3, g = 9.81;
    const auto scene = [&](Friction friction, NormalRows normal_rows, ContactModel& s) {
        Motion ball;
        ball.r = Vec3(rho - R, 0, 0);
        ball.rdot = Vec3(0, Omega * (rho - R), 0);
        if (friction == Friction::rolling) ball.omega_bar = Vec3(0, 0, -Omega * (rho - R) / R);
        s.add("ball", 1, 0.4 * R * R * Mat3::Identity(), ball);
        s.add_contact("wall", 0, shape<Sphere>(R), dae::ground, shape<Cylinder>(rho, true), friction,
                      normal_rows);
        s.start();
    };
    struct Errors {
        double r = 0, z = 0, F_N = 0;
    };
    const auto errors = [&](Friction friction, double h, double t_end) {
        ContactModel s;
        scene(friction, NormalRows::tangent, s);
        Errors worst;
        run(s, "rA-half-1-momentum", h, t_end, [&](const lie::State& x, long) {
            const double z =
                friction == Friction::none
                    ? -0.5 * g * x.t * x.t
                    : -2.5 * g / (Omega * Omega) * (1 - std::cos(Omega * std::sqrt(2.0 / 7) * x.t));
            const double phi = Omega * x.t;
            worst.r = std::max(
                worst.r,
                (x.body[0].r - Vec3((rho - R) * std::cos(phi), (rho - R) * std::sin(phi), z)).norm());
            worst.z = std::max(worst.z, std::abs(x.body[0].r.z() - z));
            worst.F_N =
                std::max(worst.F_N, std::abs(multipliers(s.model, x).F_N - Omega * Omega * (rho - R)));
        });
        return worst;
    };
    for (const Friction friction : {Friction::none, Friction::rolling}) {
        const bool rolls = friction == Friction::rolling;
        const Errors coarse = errors(friction, 5e-3, rolls ? 4 : 1),
                     fine = errors(friction, 2.5e-3, rolls ? 4 : 1);
        INFO((rolls ? "rolling" : "sliding") << " r " << coarse.r << ", " << fine.r << "; z " << coarse.z
                                             << "; F_N " << coarse.F_N << ", " << fine.F_N);
        CHECK(coarse.r < (rolls ? 8e-4 : 1.8e-4));
        CHECK(coarse.z < (rolls ? 6e-4 : 1e-4));
        CHECK(std::log2(coarse.r / fine.r) == Approx(2).margin(0.03));
        CHECK(coarse.F_N < (rolls ? 2e-2 : 1e-3));
    }
    // rows along the fixed x and y do not constrain the rotation of the normals in their plane
    ContactModel s;
    try {
        scene(Friction::none, NormalRows::fixed_xy, s);
        FAIL("not rejected");
    } catch (const lie::NumericalFailure& e) {
        CHECK(e.status == "singular_matrix");
    }
}

TEST_CASE("a ball loops inside an ellipsoid through normals in the xy-plane (long)", "[contact][evolving]")
{
    const auto loop = [](NormalRows normal_rows,
                         const std::function<void(const ContactModel&, const lie::State&, long)>& f) {
        BallInBowl scene(Vec3(0, 0, -1.5), Friction::none, Vec3::Zero(), normal_rows);
        scene.x.body[0].rdot.y() = 14;
        scene.start();
        run(scene, "rA-half-1", 1e-3, 1.2, [&](const lie::State& x, long n) { f(scene, x, n); });
    };
    double highest = -2, residual = 0, worst_condition = 0;
    loop(NormalRows::tangent, [&](const ContactModel& scene, const lie::State& x, long n) {
        highest = std::max(highest, x.body[0].r.z());
        Eigen::VectorXd Phi(scene.model.rows());
        scene.model.phi(x, Phi);
        residual = std::max(residual, Phi.norm());
        if (n % 20 != 0) return;
        worst_condition = std::max(worst_condition, condition(scene.model, x, 1, R));
    });
    INFO("condition " << worst_condition << ", residual " << residual);
    CHECK(highest == Approx(1.5).margin(1e-3));
    CHECK(worst_condition < 36);
    CHECK(residual < 1e-12);

    // The rows along x and y are singular where the normal is horizontal. Newton's method passes these
    // positions with contact points that follow from the poses.
    lie::Vec3 end, end_fixed;
    loop(NormalRows::tangent, [&](const ContactModel&, const lie::State& x, long) { end = x.body[0].r; });
    loop(NormalRows::fixed_xy,
         [&](const ContactModel&, const lie::State& x, long) { end_fixed = x.body[0].r; });
    CHECK((end - end_fixed).norm() < 1e-10);
}

TEST_CASE("a ball in a V-groove has equal normal forces on both walls", "[contact][evolving]")
{
    const double half_angle = 50 * pi / 180;
    for (const lie::LinearSolver solver : {lie::LinearSolver::klu, lie::LinearSolver::condensed}) {
        ContactModel scene;
        Motion ball;
        ball.r = Vec3(0, 0, R);
        ball.rdot = Vec3(0.4, 0, 0);
        ball.omega_bar = Vec3(1, 2, 3);
        scene.add("ball", 1, 0.4 * R * R * Mat3::Identity(), ball);
        for (const double side : {-1.0, 1.0}) {
            Shape wall = shape<Plane>();
            wall.orientation = lie::exp(Vec3(side * half_angle, 0, 0));
            wall.position = Vec3(0, 0, R) - R * (wall.orientation * Vec3::UnitZ());
            scene.add_contact(side < 0 ? "left" : "right", 0, shape<Sphere>(R), dae::ground, wall);
        }
        scene.start();
        double worst = 0;
        run(
            scene, "rA-half-1-momentum", 1e-2, 2,
            [&](const lie::State& x, long) {
                for (const size_t k : {0, 1})
                    worst = std::max(worst, std::abs(multipliers(scene.model, x, k).F_N - 7.630825370750323));
                CHECK((x.body[0].r - Vec3(0.4 * x.t, 0, R)).norm() < 1e-12);
            },
            solver);
        CHECK(worst < 1e-11);
    }
}

TEST_CASE("a ball circles in a toroidal groove on its steady orbit (long)", "[contact][evolving][order]")
{
    const double R_t = 2, q = 0.6 - 0.2, beta = 0.7, g = 9.81;
    const double Omega = std::sqrt(g * std::tan(beta) / (R_t + q * std::sin(beta))),
                 rho = R_t + q * std::sin(beta);
    struct Errors {
        double r = 0, F_N = 0, L_z = 0;
    };
    const auto errors = [&](double h) {
        ContactModel scene;
        Motion ball;
        ball.r = Vec3(rho, 0, -q * std::cos(beta));
        ball.rdot = Vec3(0, Omega * rho, 0);
        scene.add("ball", 1, 0.016 * Mat3::Identity(), ball);
        scene.add_contact("groove", 0, shape<Sphere>(0.2), dae::ground, shape<Torus>(R_t, 0.6, true));
        scene.start();
        Errors worst;
        run(scene, "rA-half-1-momentum", h, 2, [&](const lie::State& x, long) {
            const Motion& b = x.body[0];
            const double phi = Omega * x.t;
            worst.r = std::max(
                worst.r, (b.r - Vec3(rho * std::cos(phi), rho * std::sin(phi), -q * std::cos(beta))).norm());
            worst.F_N = std::max(worst.F_N, std::abs(multipliers(scene.model, x).F_N - g / std::cos(beta)));
            worst.L_z = std::max(worst.L_z, std::abs(b.r.cross(b.rdot).z() - Omega * rho * rho));
        });
        return worst;
    };
    const Errors coarse = errors(4e-3), fine = errors(2e-3);
    INFO("r " << coarse.r << ", " << fine.r << "; F_N " << coarse.F_N << ", " << fine.F_N << "; L_z "
              << coarse.L_z << ", " << fine.L_z);
    CHECK(coarse.r < 7.1e-5);
    CHECK(std::log2(coarse.r / fine.r) == Approx(2).margin(0.03));
    CHECK(std::log2(coarse.F_N / fine.F_N) == Approx(2).margin(0.05));
    CHECK(coarse.L_z < 1e-13);
}
