// The quadratic in place of a field: as close as it says, and what it tells of a ray.
#include "terrain/march/patch_model.h"

#include "tests/counts.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>

#include <functional>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

/// Any function; what is known of it the tests say themselves.
class Given final : public MarchedField
{
public:
    explicit Given(std::function<double(const Vec3d&)> f) : f_(std::move(f)) {}
    double value(const Vec3d& p, double) const override { return f_(p); }
    LocalField local(const Box3d&) const override { return {}; }
    bool exists(const Vec3d&, double) const override { return true; }
    Vec3d inverse(const Vec3d& p, double) const override { return p; }
    double base_value(const Vec3d& q) const override { return f_(q); }

private:
    std::function<double(const Vec3d&)> f_;
};

LocalField known_of(double slope, double curvature)
{
    LocalField known;
    known.gradient.fill({-slope, slope});
    known.curvature = known.upright = curvature;
    return known;
}

const Box3d kBox(Vec3d(-1.0, -1.0, -1.0), Vec3d(1.0, 1.0, 1.0));

/// How far the field is from its quadratic at most, at random points, by the error that was proved.
double worst_share(const Given& field, const LocalField& known, const Box3d& box, int parts)
{
    const PatchModel model = fit_model(NodeGrid(field, box, parts), known, 0.0);
    Numbers random(3);
    double worst = 0.0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3d p = random.in(box);
        worst = std::max(worst, std::abs(field.value(p, 0.0) - model.at(p - box.center())) / static_cast<double>(model.error));
    }
    return worst;
}

TEST(PatchModel, is_the_field_itself_where_that_is_quadratic)
{
    const auto f = [](const Vec3d& p) { return 0.25 + p.x - 2.0 * p.z + 0.5 * p.x * p.x - p.y * p.z + 3.0 * p.x * p.y - 1.5 * p.z * p.z; };
    const Box3d box(Vec3d(1.0, 2.0, 3.0), Vec3d(1.5, 2.25, 4.0));
    for (const int parts : {2, 4}) {
        const PatchModel model = fit_model(NodeGrid(Given(f), box, parts), known_of(20.0, 6.0), 0.0);
        Numbers random(1);
        for (int i = 0; i < 100; ++i) {
            const Vec3d p = random.in(box);
            // Ten coefficients of sizes up to 10 in single precision: 10 x 10 x 2^-24.
            EXPECT_NEAR(model.at(p - box.center()), f(p), 6e-6);
        }
        // u^T second u: halves of the second derivatives, whole mixed ones.
        EXPECT_NEAR(model.second[0], 0.5, 1e-6);
        EXPECT_NEAR(model.second[2], -1.5, 1e-6);
        EXPECT_NEAR(model.second[3], 3.0, 1e-6);
        EXPECT_NEAR(model.second[5], -1.0, 1e-6);
    }
}

TEST(PatchModel, error_is_proved_by_second_derivatives_and_by_nine_tenths_of_them_it_is_not)
{
    // 4 u (1 - |u|): zero at the three nodes of an axis, so the quadratic is zero; its second derivative is 8 on either side and it reaches 1
    // half-way: what 8 h^2 / 8 with h = 1 allows, exactly.
    const Given field([](const Vec3d& p) { return 4.0 * p.x * (1.0 - std::abs(p.x)); });
    const double infinite_slope = 1e9;
    EXPECT_LE(worst_share(field, known_of(infinite_slope, 8.0), kBox, 2), 1.0);
    // All three axes are charged: the two along which nothing changes are worth 0.9 x 8 / 8 each, so they are taken out of the claim.
    LocalField one_axis = known_of(infinite_slope, 0.9 * 8.0 / 2.0);
    one_axis.upright = 0.0;
    EXPECT_GT(worst_share(field, one_axis, kBox, 2), 1.0);
}

TEST(PatchModel, error_is_proved_by_slopes_where_the_gradient_jumps_and_by_nine_tenths_of_them_it_is_not)
{
    // A saw of slope 1 between nodes at -1, 0, 1: zero there, 1/2 half-way.
    const Given field([](const Vec3d& p) { return std::abs(p.x - std::round(p.x)); });
    LocalField known = known_of(0.0, kInfinity);
    known.gradient[0] = {-1.0, 1.0};
    EXPECT_LE(worst_share(field, known, kBox, 2), 1.0);
    known.gradient[0] = {-0.9, 0.9};
    EXPECT_GT(worst_share(field, known, kBox, 2), 1.0);
}

TEST(PatchModel, knows_nothing_of_a_field_of_which_nothing_is_known)
{
    const PatchModel model = fit_model(NodeGrid(Given([](const Vec3d& p) { return p.x; }), kBox, 2), known_of(kInfinity, kInfinity), 0.0);
    EXPECT_FALSE(std::isfinite(model.error));
}

TEST(PatchModel, along_a_ray_is_its_value_at_the_rays_points)
{
    PatchModel model;
    model.value = 0.5f, model.gradient = {1.0f, -2.0f, 0.25f}, model.second = {1.0f, -0.5f, 2.0f, 0.75f, -1.25f, 0.5f};
    Numbers random(4);
    for (int i = 0; i < 100; ++i) {
        const Vec3d from = random.in(kBox), d = random.direction();
        const double s = random();
        EXPECT_NEAR(model.along(from, d).at(s), model.at(from + d * s), 1e-14);
    }
}

/// Whether a piece says a sign that the quadratic, up to `error` off, need not have; or pieces do not follow one another.
bool pieces_lie(const ModelAlong& model, double error, double length, double trust)
{
    SignedPiece pieces[5];
    const int count = signed_pieces(model, trust * error, length, pieces);
    double end = 0.0;
    for (int i = 0; i < count; ++i) {
        if (pieces[i].from != end || !(pieces[i].to > pieces[i].from) || (i > 0 && pieces[i].sign == pieces[i - 1].sign)) return true;
        end = pieces[i].to;
        for (int k = 0; k <= 20 && pieces[i].sign != 0; ++k)
            if (pieces[i].sign * model.at(pieces[i].from + (pieces[i].to - pieces[i].from) * k / 20.0) < error * (1.0 - 1e-9)) return true;
    }
    return end != length;
}

TEST(SignedPieces, say_only_signs_that_the_error_allows)
{
    Numbers random(6);
    int unsure = 0, mutants = 0;
    for (int i = 0; i < count(20000, 1000000); ++i) {
        const double length = std::pow(10.0, -3.0 * random());
        ModelAlong model{random.between(-1.0, 1.0), random.between(-4.0, 4.0) / length, random.between(-4.0, 4.0) / (length * length)};
        if (i % 7 == 0) model.c = 0.0;
        if (i % 11 == 0) model.b = 0.0;
        const double error = std::pow(10.0, -6.0 * random());
        // Every fifth touches the error or zero.
        if (i % 5 == 0 && model.c != 0.0) model.a = model.b * model.b / (4.0 * model.c) + (i % 2 ? error : 0.0);
        ASSERT_FALSE(pieces_lie(model, error, length, 1.0)) << i;
        mutants += pieces_lie(model, error, length, 0.9);
        SignedPiece pieces[5];
        const int n = signed_pieces(model, error, length, pieces);
        for (int k = 0; k < n; ++k) unsure += pieces[k].sign == 0;
    }
    EXPECT_GT(unsure, 5000);
    EXPECT_GT(mutants, 5000);
}

TEST(SignedPieces, of_a_parabola_that_dips_below_zero_are_five)
{
    // (s - 1)^2 - 1/4 with an error of 1/8: |q| <= 1/8 from 1 - sqrt(3/8) to 1 - sqrt(1/8), and again on the other side.
    SignedPiece pieces[5];
    ASSERT_EQ(signed_pieces({0.75, -2.0, 1.0}, 0.125, 2.0, pieces), 5);
    const double outer = std::sqrt(0.375), inner = std::sqrt(0.125);
    const double ends[6] = {0.0, 1.0 - outer, 1.0 - inner, 1.0 + inner, 1.0 + outer, 2.0};
    const int signs[5] = {1, 0, -1, 0, 1};
    for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(pieces[i].from, ends[i], 1e-6);
        EXPECT_NEAR(pieces[i].to, ends[i + 1], 1e-6);
        EXPECT_EQ(pieces[i].sign, signs[i]);
    }
}

}  // namespace
}  // namespace hoodoo
