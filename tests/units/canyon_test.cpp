// The canyon against its golden values (sign turned once, here), and what its bounds promise.
#include "terrain/fields/canyon.h"

#include "tests/counts.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

nlohmann::json golden()
{
    return nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/d_canyon.json"));
}

/// The golden canyon: cells and height of one metre, no deposit.
CanyonShape golden_shape()
{
    CanyonShape shape;
    shape.cell = shape.height = 1.0;
    shape.seed = 7;
    shape.profile_seed = 101;  // the golden T's: the one that gives its values
    shape.sediment = 0.0;
    return shape;
}

TEST(Canyon, equals_the_golden_values)
{
    const CanyonWall wall(golden_shape());
    const nlohmann::json values = golden();
    for (const auto& row : values["F"]) {
        const Vec3d p(row["p"][0].get<double>(), row["p"][1].get<double>(), row["p"][2].get<double>());
        EXPECT_NEAR(wall.profile().at(p).t, row["T"].get<double>(), 1e-12);
        // The golden F follows the flow exactly; RK4 in ceil(3.5 H T) steps is within 1e-4 of it at these T (maths D4).
        EXPECT_NEAR(wall.value(p), -row["F"].get<double>(), 1e-4);
        EXPECT_NEAR(wall.gradient(p).z, -row["dFdz_closed"].get<double>(), 3e-3);
    }
    int hits = 0;
    for (const auto& row : values["rays"]) {
        if (row["t"].is_null()) continue;
        const Vec3d o(row["o"][0].get<double>(), row["o"][1].get<double>(), row["o"][2].get<double>());
        const Vec3d d(row["d"][0].get<double>(), row["d"][1].get<double>(), row["d"][2].get<double>());
        const Vec3d p = o + d * row["t"].get<double>();
        if (std::abs(p.z - 1.0) < 1e-9)
            EXPECT_LT(wall.value(p), 0.0);  // onto the plateau, from above
        else
            EXPECT_NEAR(wall.value(p), 0.0, 2e-4);
        ++hits;
    }
    EXPECT_EQ(hits, 11);
}

std::vector<CanyonShape> shapes()
{
    CanyonShape plain = golden_shape(), seen = golden_shape();
    plain.sediment = 0.35;
    seen = plain;
    seen.octaves = 8;
    seen.view = DetailView{Vec3d(0.3, -0.4, 0.5), 0.02, 0.0};
    CanyonShape lifted = seen;
    lifted.lift = 0.2;
    lifted.lift_wavelength = 1.5;
    return {golden_shape(), plain, seen, lifted};
}

TEST(Canyon, gradients_are_differences)
{
    for (const CanyonShape& shape : shapes()) {
        const CanyonWall wall(shape);
        Numbers random(5);
        for (int i = 0; i < 300; ++i) {
            const Vec3d p = random.in(Box3d(Vec3d(-5, -5, 0), Vec3d(5, 5, 1)));
            const Vec3d g = wall.gradient(p);
            const double h = 1e-6;
            for (int k = 0; k < 3; ++k) {
                Vec3d e(0.0);
                e[k] = h;
                // The second derivative of eight octaves is below 2e4: one-sided rounding of the differences is the larger part.
                EXPECT_NEAR(g[k], (wall.value(p + e) - wall.value(p - e)) / (2 * h), 2e-5) << p;
            }
        }
    }
}

/// Whether the local bounds hold in boxes of all sizes, with every bound multiplied by `factor`; empty, or what failed.
std::string local_fault(const CanyonWall& wall, double factor, int boxes)
{
    Numbers random(9);
    for (int i = 0; i < boxes; ++i) {
        Box3d box(random.in(Box3d(Vec3d(-6, -6, 0), Vec3d(6, 6, 1))));
        const double size = std::pow(10.0, -3.5 * random());
        box.extendBy(box.min + Vec3d(random(), random(), (i % 4 ? random() : 0.0)) * size);
        LocalField known = wall.local(box);
        const double middle = 0.5 * (known.value.lo + known.value.hi), reach = 0.5 * factor * (known.value.hi - known.value.lo);
        for (int k = 0; k < 12; ++k) {
            const Vec3d p = k == 0 ? box.min : k == 1 ? box.max : random.in(box), q = random.in(box);
            if (std::abs(wall.value(p) - middle) > reach + 1e-11) return "value";
            const Vec3d g = wall.gradient(p);
            for (std::size_t a = 0; a < 3; ++a) {
                const Interval& r = known.gradient[a];
                const double m = 0.5 * (r.lo + r.hi), e = 0.5 * factor * (r.hi - r.lo);
                if (std::abs(g[static_cast<int>(a)] - m) > e + 2e-7) return "gradient";
            }
            const double apart = (p - q).length();
            if (!(apart > 1e-5)) continue;
            const Vec3d u = (q - p) / apart;
            const double turn = std::abs((wall.gradient(q) - g).dot(u)) / apart;
            if (turn > factor * known.curvature_along(u) + 1e-7 / apart + 1e-6) return "curvature";
        }
    }
    return {};
}

TEST(Canyon, local_bounds_hold_and_not_by_a_tenth_too_much)
{
    for (const CanyonShape& shape : shapes()) {
        EXPECT_EQ(local_fault(CanyonWall(shape), 1.0, count(4000, 100000)), "");
        EXPECT_NE(local_fault(CanyonWall(shape), 0.9, 4000), "");
    }
}

TEST(Canyon, signs_known_without_following_the_flow_are_those_of_the_value)
{
    const CanyonWall wall(golden_shape());
    Numbers random(8);
    int known = 0;
    for (int i = 0; i < count(20000, 1000000); ++i) {
        const Vec3d p = random.in(Box3d(Vec3d(-6, -6, 0), Vec3d(6, 6, 1)));
        const double margin = 0.1 * random();
        const int sign = wall.certain_sign(p, margin);
        if (sign != 0) EXPECT_GT(sign * wall.value(p), margin) << p;
        known += sign != 0;
    }
    EXPECT_GT(known, 4000);
}

TEST(Canyon, a_lift_carries_layers_and_plateau_and_leaves_the_floor)
{
    CanyonShape shape = golden_shape(), lifted = golden_shape();
    lifted.lift = 0.2;
    const CanyonField flat(shape), field(lifted);
    Numbers random(2);
    double least = 1.0, most = -1.0;
    for (int i = 0; i < 500; ++i) {
        const Vec3d p = random.in(Box3d(Vec3d(-5, -5, 0), Vec3d(5, 5, 1)));
        const double s = CanyonLift::at(lifted, p).value;
        least = std::min(least, s), most = std::max(most, s);
        // Without a deposit the wall depends on the height by T alone.
        EXPECT_NEAR(field.wall().value(p), flat.wall().value(p - Vec3d(0, 0, s)), 1e-13);
        EXPECT_NEAR(field.plateau(p), flat.plateau(p) - s, 1e-14);
        EXPECT_EQ(field.floor(p), flat.floor(p));
        EXPECT_TRUE(CanyonLift::over(lifted, Box3d(p - Vec3d(0.3), p + Vec3d(0.2))).value.contains(s));
    }
    // A noise within +- 0.7072 seldom passes +- 0.5.
    EXPECT_LT(least, -0.05);
    EXPECT_GT(most, 0.05);
}

TEST(Canyon, is_empty_above_the_plateau_and_full_below_the_floor)
{
    const CanyonField field(golden_shape());
    EXPECT_GT(field.value(Vec3d(1.2, 3.4, 1.5)), 0.0);
    EXPECT_LT(field.value(Vec3d(1.2, 3.4, -0.1)), 0.0);
}

}  // namespace
}  // namespace hoodoo
