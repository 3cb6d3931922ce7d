// Certified marching of warped surfaces for every kind of flow over planes and layers; what the paper's own search misses; scenes that cannot be.
#include "renderer/geometry/tracer.h"
#include "renderer/scene/read.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/toml_text.h"
#include "terrain/march/area_march.h"
#include "terrain/march/first_crossing.h"
#include "tests/counts.h"
#include "tests/support/catalogue_rows.h"
#include "tests/support/surface_laws.h"

#include <gtest/gtest.h>

#include <numbers>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

RowInstance warped(const std::string& base, const std::string& flow)
{
    // Of a base that is cut off somewhere, what no flow here brings its rim to.
    const std::string region = base == "plane"           ? "region_min = [-3, -3, -2]\nregion_max = [5, 5, 8]\n"
                               : base == "elevation_fbm" ? "region_min = [-2, -1.5, -4]\nregion_max = [0.8, 1.5, 5]\n"
                                                         : "";
    return {"warped", "warped_test", [=](const Vec3d&) { return "base = \"" + base + "\"\npatch = 1.0\n" + region + flow; }, 0.9};
}

const std::vector<std::string>& flow_texts()
{
    static const std::vector<std::string> texts{
        "[[flow]]\nkind = \"rotation\"\ncentre = [3, 3, 3]\naxis = [1, 2, 0.5]\nstrength = 0.6\n",
        "[[flow]]\nkind = \"vortex\"\ncentre = [3, 3, 3]\naxis = [0, 1, 0.2]\nradius = 3.0\n",
        "[[flow]]\nkind = \"bulge\"\ncentre = [3, 3, 3]\nradius = 3.0\nstrength = 0.3\n",
        "[[flow]]\nkind = \"shear\"\ncentre = [3, 3, 2]\n",
        "[[flow]]\nkind = \"vertical\"\nwavelength = 4.0\noctaves = 2\n",
        "[[flow]]\nkind = \"noise\"\nwavelength = 9.0\n",
        "[[flow]]\nkind = \"curl\"\nwavelength = 20.0\nstrength = 0.3\n",
        "[[flow]]\nkind = \"curl\"\nwavelength = 20.0\nstrength = 0.3\ndrift = [2, 1, 0]\n",
    };
    return texts;
}

/// How much of the bounds of the base's warped surface is not its rim.
double trusted(const std::string& base)
{
    return base == "plane" || base == "elevation_fbm" || base == "heightfield" ? 0.9 : 1.0;
}

TEST(Warped, no_crossing_is_missed_whatever_the_flow_and_the_base)
{
    for (const std::string base : {"plane", "elevation_fbm", "convolution_cut_sphere", "implicit"}) {
        for (const std::string& flow : flow_texts()) {
            const BuiltRow built = build_row(warped(base, flow));
            // 32 combinations: 2e4 rays in all in CI, 1e5 a combination nightly.
            const std::vector<Ray> rays = law_rays(built.surface(), 31, count(625, 100000));
            const Verdict verdict = nearest_is_nearest(built.surface(), rays, trusted(base));
            EXPECT_TRUE(verdict.holds()) << base << ", " << flow << verdict.fault;
            EXPECT_TRUE(normals_are_gradients(built.surface(), rays).holds()) << base << ", " << flow;
        }
    }
}

TEST(Warped, no_crossing_is_missed_where_detail_fades)
{
    // Pixels of centimetres at the near side and of metres at the far one, so that every fade is in the picture; flows of centimetres, so that fades
    // begin at their places.
    for (const std::string base : {"plane", "heightfield", "convolution_cut_sphere"}) {
        for (const std::string flow :
             {"kind = \"vertical\"\nwavelength = 4.0\noctaves = 3\n", "kind = \"noise\"\nwavelength = 4.0\n",
              "kind = \"curl\"\nwavelength = 20.0\noctaves = 3\n", "kind = \"curl\"\nwavelength = 20.0\noctaves = 3\ndrift = [2, 1, 0]\n"}) {
            RowInstance row = warped(base, std::string("intensity = 0.1\n[[flow]]\n") + flow);
            row.view = Viewpoint{Vec3d(-3.0, 2.0, 4.0), 0.25};
            const BuiltRow built = build_row(row);
            row.view.reset();
            const BuiltRow plain = build_row(row);
            const std::vector<Ray> rays = law_rays(built.surface(), 32, count(300, 100000));
            const Verdict verdict = nearest_is_nearest(built.surface(), rays, trusted(base));
            EXPECT_TRUE(verdict.holds()) << base << ", " << flow << verdict.fault;
            EXPECT_TRUE(normals_are_gradients(built.surface(), rays).holds()) << base << ", " << flow;
            // And detail does fade: another surface than the one without a view.
            double most = 0.0;
            for (std::size_t k = 0; k < 200; ++k)
                most = std::max(most, std::abs(built.surface().field()->value(rays[k].at(3.0)) - plain.surface().field()->value(rays[k].at(3.0))));
            EXPECT_GT(most, 1e-3) << base << ", " << flow;
        }
    }
}

TEST(Canyon, no_crossing_is_missed_in_its_layers_lifted_or_fading)
{
    // Octaves of 0.33 m down to 1 cm; from 1 to 8 m away pixels are 4 cm to 30 cm wide.
    const std::string canyon = "cell = 4.0\nheight = 4.0\nextent = 4.0\ncentre = [2, 1, 2]\npatch = 0.6\ngrowth = 0.0\n";
    for (const std::string more : {"octaves = 4\n", "octaves = 3\nlift = 0.3\nlift_wavelength = 1.0\n", "octaves = 6\nlod = true\n"}) {
        RowInstance row{"canyon", "canyon_test", [=](const Vec3d&) { return canyon + more; }, 0.9};
        row.view = Viewpoint{Vec3d(-2.5, 1.0, 5.0), 0.04};
        const BuiltRow built = build_row(row);
        const Verdict verdict = nearest_is_nearest(built.surface(), law_rays(built.surface(), 33, count(1500, 100000)), 0.9);
        EXPECT_TRUE(verdict.holds()) << more << verdict.fault;
    }
}

TEST(Warped, at_any_time_of_the_shutter_is_the_still_surface_of_that_intensity)
{
    // The intensity grows from 0.2 to 0.6 while the shutter is open: at the time s it is 0.2 + 0.4 s. Vertices joined by straight lines would be off
    // by the sagitta of a turn of 0.4 x 0.6 radians at some metres: centimetres.
    const std::string flow = flow_texts().front();
    const auto at = [&](const std::string& intensity) { return build_row(warped("convolution_cut_sphere", intensity + "\n" + flow)); };
    const BuiltRow moving = at("intensity = 0.2\nintensity_close = 0.6");
    for (const double time : {0.0, 0.3, 1.0}) {
        const BuiltRow still = at("intensity = " + std::to_string(0.2 + 0.4 * time));
        int hits = 0;
        for (Ray ray : law_rays(still.surface(), 5, 400)) {
            const double expected = nearest_hit(still.surface(), ray).t;
            ray.time = time;
            const double t = nearest_hit(moving.surface(), ray).t;
            if (std::isinf(expected) && std::isinf(t)) continue;
            EXPECT_NEAR(t, expected, 1e-5) << "time " << time;
            ++hits;
        }
        EXPECT_GT(hits, 100);
    }
}

/// A straight ray that the inverse warp bends into z(s) = 0.3 sin(2 pi s) + lift over a plane.
struct OddArc {
    double lift;
    Vec3d place(double s) const { return {s, 0.0, 0.3 * std::sin(2.0 * std::numbers::pi * s) + lift}; }
};

TEST(PaperMode, misses_an_arc_that_is_odd_about_its_middle_and_certified_marching_does_not)
{
    // The middle lies on the chord, so the triangle has no area (maths D2), though the curve crosses z = 0 at sin(2 pi s) = -1/15:
    // s = 1/2 + asin(1/15) / (2 pi) = 0.510618 and s = 1 - 0.010618 = 0.989382.
    const OddArc arc{0.02};
    const auto base = [](const Vec3d& q) { return q.z; };
    double t = 0.0;
    std::uint32_t evaluations = 0;
    EXPECT_FALSE(area_march([&](double s) { return arc.place(s); }, base, 0.0, 1.0, false, {1e-6, 1.0, 20}, t, evaluations));

    const auto f = [&](double s) { return arc.place(s).z; };
    const PieceBound bound{0.3 * 2.0 * std::numbers::pi, 0.3 * 4.0 * std::numbers::pi * std::numbers::pi};
    const auto closer = [&](double, double) { return bound; };
    ASSERT_TRUE(first_crossing(f, closer, {0.0, f(0.0), 1.0, f(1.0)}, {false, false, 1e-9, 1e-9}, bound, t, evaluations));
    EXPECT_NEAR(t, 0.5 + std::asin(1.0 / 15.0) / (2.0 * std::numbers::pi), 1e-8);
}

TEST(PaperMode, misses_two_crossings_of_one_chord_and_certified_marching_does_not)
{
    // A shallow arc: z = 0.01 - 0.012 sin(pi s) is below zero between asin(5/6)/pi = 0.313 and 0.687; its triangle has the area 0.006.
    const auto place = [](double s) { return Vec3d(s, 0.0, 0.01 - 0.012 * std::sin(std::numbers::pi * s)); };
    double t = 0.0;
    std::uint32_t evaluations = 0;
    EXPECT_FALSE(area_march(
        place, [](const Vec3d& q) { return q.z; }, 0.0, 1.0, false, {0.01, 1.0, 20}, t, evaluations));
    const auto f = [&](double s) { return place(s).z; };
    const PieceBound bound{0.012 * std::numbers::pi, 0.012 * std::numbers::pi * std::numbers::pi};
    const auto closer = [&](double, double) { return bound; };
    ASSERT_TRUE(first_crossing(f, closer, {0.0, f(0.0), 1.0, f(1.0)}, {true, false, 1e-9, 1e-9}, bound, t, evaluations));
    EXPECT_NEAR(t, std::asin(5.0 / 6.0) / std::numbers::pi, 1e-8);
}

TEST(FirstCrossing, ends_on_a_ray_that_lies_in_the_surface)
{
    std::uint32_t evaluations = 0;
    double t = 0.0;
    const auto f = [](double) { return 0.0; };
    const auto closer = [](double, double) { return PieceBound{1e9, kInfinity}; };
    EXPECT_FALSE(first_crossing(f, closer, {0.0, 0.0, 1.0, 0.0}, {false, false, 1e-12, 1e-12}, {1e9, kInfinity}, t, evaluations));
    EXPECT_LE(evaluations, static_cast<std::uint32_t>(kMostEvaluations) + 8u);
}

TEST(FirstCrossing, a_curvature_bound_times_nine_tenths_loses_a_graze)
{
    // z = (s - 1/2)^2 - 1e-4 dips below zero for 0.02 around the middle: f'' = 2 exactly.
    const auto f = [](double s) { return (s - 0.5) * (s - 0.5) - 1e-4; };
    const auto found = [&](double curvature) {
        double t = 0.0;
        std::uint32_t evaluations = 0;
        const auto closer = [&](double, double) { return PieceBound{kInfinity, curvature}; };
        // The ends are where the test is sharpest: a parabola of this curvature touches zero between them.
        return first_crossing(f, closer, {0.0, f(0.0), 1.0, f(1.0)}, {false, false, 1e-12, 1e-12}, {kInfinity, curvature}, t, evaluations);
    };
    EXPECT_TRUE(found(2.0));
    EXPECT_FALSE(found(1.8));
}

std::string error_of(const std::string& terrains)
{
    const std::string text = "version = 1\n[camera]\neye = [0, 0, 100]\ntarget = [1, 0, 0]\n" + terrains;
    try {
        SceneOptions options;
        options.to_rendering = [](const ColorValue& c) { return Vec3f(c.rgb); };
        const Scene scene(read_scene(text, true, {}), options);
        return "built " + std::to_string(scene.objects().size());
    } catch (const Error& error) {
        return error.problems().front().what + "|" + error.problems().front().got + "|" + error.problems().front().nearest;
    }
}

TEST(Warped, scenes_that_cannot_be_say_why)
{
    const std::string flow = "[[terrain.w.flow]]\nkind = \"rotation\"\nstrength = 0.1\n",
                      ground = "[terrain.ground]\ntype = \"plane\"\nextent = 20.0\n";
    const std::string warp = "[terrain.w]\ntype = \"warped\"\npatch = 2.0\nregion_min = [-9, -9, -9]\nregion_max = [9, 9, 9]\n";
    EXPECT_EQ(error_of(ground + warp + "base = \"ground\"\n" + flow), "built 1");
    EXPECT_EQ(error_of(ground + "visible = true\n" + warp + "base = \"ground\"\n" + flow), "built 2");
    EXPECT_EQ(error_of(ground + warp + "base = \"grond\"\n" + flow), "there is no terrain of this name|\"grond\"|ground");
    EXPECT_EQ(error_of(ground + warp + "base = \"w\"\n" + flow), "the terrain \"w\" stands on itself||");
    EXPECT_EQ(error_of(ground + warp + "base = \"ground\"\nintensity = 200.0\n" + flow),
              "the flow's derivative is up to 0.1, and 0.1 times the duration 200 is 20: at most 8 can be traced||");
}

}  // namespace
}  // namespace hoodoo
