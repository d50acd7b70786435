// SPDX-License-Identifier: GPL-3.0-or-later
/// The work of reading, rank analysis and start grows in proportion to the number of bodies. It is measured
/// by the bytes that are allocated and by the number of comparisons of strings.

#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "dae/rank.hpp"
#include "dae/start.hpp"
#include "tests/support/no_allocation.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <functional>

namespace hilda::tests {

inline std::atomic<long> comparisons{0};

}  // namespace hilda::tests

#ifndef HILDA_SANITIZED
/// Replaces that of the C library, by which strings are compared.
extern "C" __attribute__((optimize("no-tree-loop-distribute-patterns"))) int memcmp(const void* a,
                                                                                    const void* b,
                                                                                    std::size_t size)
{
    ++hilda::tests::comparisons;
    const auto *x = static_cast<const unsigned char*>(a), *y = static_cast<const unsigned char*>(b);
    for (std::size_t k = 0; k < size; ++k)
        if (x[k] != y[k]) return x[k] < y[k] ? -1 : 1;
    return 0;
}
#endif

using namespace hilda;
using namespace hilda::dae;

namespace {

/// N bodies along x, free or on joints of this type
std::string model_text(const std::string& joint, int N)
{
    std::string bodies, joints;
    for (int b = 0; b < N; ++b) {
        const std::string name = "body " + std::to_string(b), comma = b > 0 ? "," : "";
        bodies += comma + R"({"name": ")" + name + R"(", "mass": 1, "inertia": [0.1, 0.1, 0.1], "r": [)" +
                  std::to_string(b) + ".5, 0, 0]}";
        if (joint.empty()) continue;
        joints += comma + R"({"type": ")" + joint + R"(", "body_i": ")" +
                  (b > 0 ? "body " + std::to_string(b - 1) : "ground") + R"(", "body_j": ")" + name +
                  R"(", "s_bar_p_i": [)" + (b > 0 ? "0.5" : "0") + R"(, 0, 0], "s_bar_q_j": [-0.5, 0, 0])" +
                  (joint == "revolute" ? R"(, "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]})" : "}");
    }
    return R"({"hilda_model": 1, "name": "many", "bodies": [)" + bodies + R"(], "constraints": [)" + joints +
           "]}";
}

struct Work {
    double bytes, comparisons;
};

Work work_of(const std::function<void()>& f)
{
    const long bytes = tests::allocated_bytes, comparisons = tests::comparisons;
    f();
    return {static_cast<double>(tests::allocated_bytes - bytes),
            static_cast<double>(tests::comparisons - comparisons)};
}

/// Work of reading, rank analysis and start
std::array<Work, 3> work(const std::string& joint, int N)
{
    const std::string text = model_text(joint, N);
    Description d;
    std::array<Work, 3> parts{};
    parts[0] = work_of([&] { d = read_model(text, "many"); });
    d.model->prepare(d.x);
    parts[1] = work_of([&] { CHECK(dependent_rows(*d.model, d.x, 1e-7).empty()); });
    parts[2] = work_of([&] { start(d); });
    return parts;
}

}  // namespace

TEST_CASE("reading, rank analysis and start take work in proportion to the bodies", "[dae][growth]")
{
    if (!tests::counts_allocations) return;
    const std::string joint = GENERATE("", "spherical", "revolute");
    const auto of_500 = work(joint, 500), of_1000 = work(joint, 1000), of_2000 = work(joint, 2000);
    const char* parts[] = {"reading", "rank analysis", "start"};
    for (size_t k = 0; k < 3; ++k) {
        INFO((joint.empty() ? "free bodies" : joint) << ", " << parts[k]);
        const auto check = [&](double a, double b, double c, const char* what) {
            INFO(what << " of 500, 1000 and 2000 bodies: " << a << ", " << b << ", " << c);
            // 2 of linear growth, 4 of quadratic growth; constant parts cancel. Few terms are not compared.
            if (c > 20000) CHECK(c - b < 2.6 * (b - a));
        };
        check(of_500[k].bytes, of_1000[k].bytes, of_2000[k].bytes, "bytes");
        check(of_500[k].comparisons, of_1000[k].comparisons, of_2000[k].comparisons, "comparisons");
    }
}

TEST_CASE("the redundant rows of many loops are dropped at once", "[dae][growth]")
{
    if (!tests::counts_allocations) return;
    // two parallel spherical joints and a hinge: redundant rows of each body on the ground
    const auto bytes = [](int N) {
        Model model;
        State x;
        for (int b = 0; b < N; ++b) {
            model.add({.name = "b" + std::to_string(b), .m = 1, .J_bar = Mat3::Identity()});
            x.body.emplace_back().r = {b + 0.0, 0, 0};
            for (const char* side : {"left ", "right "})
                model.constrain(side + std::to_string(b), revolute(ground, Vec3(b, 0, 0), Vec3::UnitY(), b,
                                                                   Vec3::Zero(), Vec3::UnitY()));
        }
        Work start_work = work_of([&] { start(model, x); });
        CHECK(static_cast<int>(model.dropped_rows().size()) == 5 * N);
        return start_work.bytes;
    };
    const double of_200 = bytes(200), of_400 = bytes(400), of_800 = bytes(800);
    CAPTURE(of_200, of_400, of_800);
    CHECK(of_800 - of_400 < 2.6 * (of_400 - of_200));
}
