// A field that grows coarser with the distance: between its levels, with bounds that count how fast it passes over.
#include "terrain/fields/detail_field.h"

#include "terrain/fields/grid_fill.h"
#include "terrain/stack/convolution.h"
#include "tests/stacks.h"
#include "tests/support/numbers.h"
#include "tests/support/surface_laws.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// z - c.
class Level final : public Field
{
public:
    explicit Level(double c) : c_(c) {}
    double value(const Vec3d& p) const override { return p.z - c_; }
    Vec3d gradient(const Vec3d&) const override { return {0, 0, 1}; }
    double slope_bound(const Segment& s) const override { return std::abs(s.b.z - s.a.z) / (s.b - s.a).length(); }
    Interval range(const Box3d& box) const override { return {box.min.z - c_, box.max.z - c_}; }
    Box3d bounds() const override { return Box3d(Vec3d(-kInfinity), Vec3d(kInfinity)); }
    std::array<Interval, 3> gradient_range(const Box3d&) const override { return {Interval{0, 0}, Interval{0, 0}, Interval{1, 1}}; }
    double curvature_bound(const Box3d&) const override { return 0.0; }

private:
    double c_;
};

/// Of the eye at the origin: footprint 0.1 r; the fades go from 2 m to 4 m and from 5 m to 10 m.
const DetailView kView{Vec3d(0.0), 0.1, 0.0};

DetailField planes()
{
    return {{std::make_shared<Level>(0.0), std::make_shared<Level>(1.0), std::make_shared<Level>(-2.0)}, {0.2, 0.5}, kView};
}

TEST(DetailField, is_each_level_at_its_distance_and_their_mean_between)
{
    const DetailField field = planes();
    EXPECT_EQ(field.value(Vec3d(1.9, 0, 0)), 0.0);
    EXPECT_EQ(field.value(Vec3d(4.5, 0, 0)), -1.0);
    EXPECT_EQ(field.value(Vec3d(11.0, 0, 0)), 2.0);
    EXPECT_NEAR(field.value(Vec3d(3.0, 0, 0)), -0.5, 1e-15);  // smoothstep(1/2) = 1/2
    EXPECT_EQ(field.fineness(Vec3d(1.0, 0, 0)), 1.0);
    EXPECT_EQ(field.fineness(Vec3d(4.5, 0, 0)), 0.0);
    // 3 m of slack: what was at 4.5 m is at 7.5 m now.
    DetailView slack = kView;
    slack.slack = 3.0;
    const DetailField later({std::make_shared<Level>(0.0), std::make_shared<Level>(1.0)}, {0.2}, slack);
    EXPECT_EQ(later.value(Vec3d(4.9, 0, 0)), 0.0);
    EXPECT_EQ(later.value(Vec3d(7.5, 0, 0)), -1.0);
}

/// What is wrong with the bounds, multiplied by `factor`, over boxes about the fades.
std::string bound_fault(const Field& field, double factor, int boxes)
{
    Numbers random(3);
    for (int i = 0; i < boxes; ++i) {
        Box3d box(random.in(Box3d(Vec3d(-8.0), Vec3d(8.0))));
        box.extendBy(box.min + Vec3d(random(), random(), random()) * std::pow(10.0, 0.5 - 3.0 * random()));
        const std::array<Interval, 3> gradient = field.gradient_range(box);
        const double curve = field.curvature_bound(box);
        const Interval range = field.range(box);
        for (int k = 0; k < 8; ++k) {
            const Vec3d p = random.in(box), q = random.in(box);
            if (field.value(p) < range.lo - 1e-12 || field.value(p) > range.hi + 1e-12) return "range";
            const Vec3d g = field.gradient(p);
            for (std::size_t a = 0; a < 3; ++a) {
                const double m = 0.5 * (gradient[a].lo + gradient[a].hi), e = 0.5 * factor * (gradient[a].hi - gradient[a].lo);
                if (std::abs(g[static_cast<int>(a)] - m) > e + 1e-9) return "gradient";
            }
            const double apart = (p - q).length();
            if (apart > 1e-6 && (g - field.gradient(q)).length() > factor * curve * apart + 1e-9) return "curvature";
            if (apart > 1e-6 && std::abs(field.value(p) - field.value(q)) > factor * field.slope_bound({p, q}) * apart + 1e-12) return "slope";
        }
    }
    return {};
}

TEST(DetailField, bounds_count_how_fast_it_passes_over)
{
    EXPECT_EQ(bound_fault(planes(), 1.0, 4000), "");
    EXPECT_NE(bound_fault(planes(), 0.9, 4000), "");
    // Without a wall between them the levels' own slopes would do: |grad| = 1. Here the mean climbs by 3/2 x 3 m in 5 m more.
    EXPECT_GT(planes().slope_bound({Vec3d(7.4, 0, 0), Vec3d(7.6, 0, 0)}), 0.85);
}

TEST(DetailField, of_layers_and_of_heights_obeys_the_laws_of_fields)
{
    const auto stack = random_stack(5, {24, 24}, 0.5, 0.01, 400, Vec3d(-6, -6, -3));
    const Ground ground(stack, kGround, Border::extend);
    const DetailField layers({std::make_shared<ConvolutionField>(ground, 0.5), std::make_shared<ConvolutionField>(ground, 1.0),
                              std::make_shared<ConvolutionField>(ground, 2.0)},
                             {0.2, 0.5}, kView);
    const Box3d where(Vec3d(-5, -5, -3), Vec3d(5, 5, 3));
    EXPECT_EQ(field_bounds_hold(layers, where, 4, 400).fault, "");
    Numbers random(7);
    for (int i = 0; i < 400; ++i) {
        const Vec3d p = random.in(where);
        // Where all levels agree on the side, so does the field.
        const double a = ConvolutionField(ground, 0.5).value(p), b = ConvolutionField(ground, 1.0).value(p),
                     c = ConvolutionField(ground, 2.0).value(p);
        if ((a < 0.0) == (b < 0.0) && (b < 0.0) == (c < 0.0)) {
            EXPECT_EQ(layers.value(p) < 0.0, a < 0.0) << p;
        }
        const Vec3d u = random.direction();
        // Kinks of the kernel lie elsewhere but for one in 1e3.
        const double h = 1e-7, slope = (layers.value(p + u * h) - layers.value(p - u * h)) / (2 * h);
        EXPECT_NEAR(layers.gradient(p).dot(u), slope, 1e-2) << p;
    }
}

TEST(DetailField, half_a_grid_keeps_slopes_and_means)
{
    // A tilted plane stays itself, but for the rims; a single spike of 16 keeps its volume: 16 = 4 x 4 in four times the area.
    HeightGrid grid({Vec3d(1.0, 2.0, 0.5), Vec2d(0.5, 0.25), 2.0}, 9, 6, SampleType::f32);
    for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 9; ++i) grid.set(i, j, 3.0 * i - j);
    grid.summarise();
    const auto half = halved(grid);
    EXPECT_EQ(half->columns(), 5);
    EXPECT_EQ(half->rows(), 4);
    EXPECT_EQ(half->frame().cell, Vec2d(1.0, 0.5));
    for (int j = 1; j < 2; ++j)
        for (int i = 1; i < 4; ++i) EXPECT_EQ(half->sample(i, j), 6.0 * i - 2.0 * j);
    HeightGrid spike({}, 9, 9, SampleType::f32);
    for (int j = 0; j < 9; ++j)
        for (int i = 0; i < 9; ++i) spike.set(i, j, i == 4 && j == 4 ? 16.0 : 0.0);
    spike.summarise();
    EXPECT_EQ(halved(spike)->sample(2, 2), 4.0);
    EXPECT_EQ(halved(spike)->sample(1, 2), 0.0);
}

}  // namespace
}  // namespace hoodoo
