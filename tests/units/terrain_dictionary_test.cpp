// Splines within their bounds; a terrain written with its own patches; what few atoms and terms cost; the formula itself.

#include "terrain/error.h"
#include "terrain/fields/elevation.h"
#include "terrain/fields/radial.h"
#include "terrain/fields/terrain_dictionary.h"
#include "tests/counts.h"
#include "tests/support/numbers.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>

namespace hoodoo
{
namespace
{

using testing::Numbers;

SplineGrid random_spline(std::uint64_t seed)
{
    Numbers numbers(seed);
    std::vector<float> c(20 * 17);
    for (float& x : c) x = static_cast<float>(numbers.between(-3.0, 5.0));
    return {Vec2d(100.25, -40.5), 0.75, 20, 17, std::move(c)};
}

/// Bounds of random small areas against the function inside them; `scale` shrinks the bounds. How many are broken.
int broken_bounds(const Height& height, const Box2d& within, double scale, int count)
{
    Numbers numbers(7);
    int broken = 0;
    const auto point = [&](const Box2d& box) { return Vec2d(numbers.between(box.min.x, box.max.x), numbers.between(box.min.y, box.max.y)); };
    for (int n = 0; n < count; ++n) {
        const Vec2d middle = point(within), half(std::exp(numbers.between(-6.0, 0.5)), std::exp(numbers.between(-6.0, 0.5)));
        const Box2d box(middle - half, middle + half);
        const HeightBounds known = height.bounds(box);
        const Vec2d p = point(box), q = point(box);
        const double hp = height.height(p), hq = height.height(q), away = (p - q).length();
        const Vec2d gp = height.gradient(p), gq = height.gradient(q);
        bool holds = known.value.lo <= hp && hp <= known.value.hi;
        holds = holds && std::abs(hp - hq) <= scale * known.slope * away + 1e-12;
        holds = holds && (gp - gq).length() <= scale * known.curvature * away + 1e-12;
        for (std::size_t k = 0; k < 2; ++k)
            holds = holds && known.gradient[k].lo <= gp[static_cast<int>(k)] && gp[static_cast<int>(k)] <= known.gradient[k].hi;
        broken += !holds;
    }
    return broken;
}

TEST(SplineGrid, is_the_bicubic_b_spline_of_its_coefficients)
{
    // Coefficients of a plane give the plane; a single 1 gives the kernel, 4/9 at its node.
    std::vector<float> plane(36), one(49, 0.0f);
    for (int n = 0; n < 36; ++n) plane[static_cast<std::size_t>(n)] = static_cast<float>(2.0 * (n % 6) - 3.0 * (n / 6));
    one[24] = 1.0f;
    const SplineGrid a(Vec2d(0.0), 1.0, 6, 6, plane), b(Vec2d(0.0), 1.0, 7, 7, one);
    EXPECT_NEAR(a.height({2.3, 3.1}), 2.0 * 2.3 - 3.0 * 3.1, 1e-12);
    EXPECT_NEAR(a.gradient({1.7, 2.2}).x, 2.0, 1e-12);
    EXPECT_NEAR(a.gradient({1.7, 2.2}).y, -3.0, 1e-12);
    EXPECT_NEAR(b.height({3.0, 3.0}), 4.0 / 9.0, 1e-12);
    EXPECT_NEAR(b.height({4.0, 3.0}), 1.0 / 9.0, 1e-12);
    EXPECT_NEAR(b.height({3.5, 3.0}), (23.0 / 48.0) * (2.0 / 3.0), 1e-12);
}

TEST(SplineGrid, stays_within_its_bounds_and_nearly_reaches_them)
{
    const SplineGrid spline = random_spline(3);
    const Box2d around(spline.domain().min - Vec2d(1.0), spline.domain().max + Vec2d(1.0));
    EXPECT_EQ(broken_bounds(spline, around, 1.0, testing::count(20000, 1000000)), 0);
    EXPECT_GT(broken_bounds(spline, around, 0.3, 20000), 0) << "a bound of a third is not noticed";
}

TEST(SplineGrid, gradient_is_the_derivative)
{
    const SplineGrid spline = random_spline(4);
    Numbers numbers(5);
    for (int n = 0; n < 1000; ++n) {
        const Box2d box = spline.domain();
        const Vec2d p(numbers.between(box.min.x + 0.1, box.max.x - 0.1), numbers.between(box.min.y + 0.1, box.max.y - 0.1));
        const double e = 1e-4;
        EXPECT_NEAR(spline.gradient(p).x, (spline.height(p + Vec2d(e, 0)) - spline.height(p - Vec2d(e, 0))) / (2 * e), 1e-5);
        EXPECT_NEAR(spline.gradient(p).y, (spline.height(p + Vec2d(0, e)) - spline.height(p - Vec2d(0, e))) / (2 * e), 1e-5);
    }
}

ElevationHeight hills(double relief, double wavelength, double octaves, std::uint32_t seed)
{
    ElevationShape shape;
    shape.relief = relief;
    shape.wavelength = wavelength;
    shape.fractal.octaves = octaves;
    shape.seed = seed;
    return ElevationHeight(shape);
}

constexpr double kSpacing = 2.0;
const Box2d kArea(Vec2d(-8.0), Vec2d(8.0));

DictionaryOptions options(int atoms, int terms)
{
    return {kSpacing, kSpacing / 16.0, atoms, terms};
}

/// Root of the mean squared difference in the middle of kArea.
double difference(const Height& a, const Landform& b)
{
    Numbers numbers(9);
    double sum = 0.0;
    const int n = 4000;
    for (int k = 0; k < n; ++k) {
        const Vec2d p(numbers.between(-6.0, 6.0), numbers.between(-6.0, 6.0));
        const Elevated<Jet2> e = b.at(p, 0.0);
        const double d = e.height.value / e.weight.value - a.height(p);
        sum += d * d;
    }
    return std::sqrt(sum / n);
}

TEST(TerrainDictionary, a_patch_is_its_formula)
{
    const ElevationHeight exemplar = hills(2.0, 3.0, 5.0, 1), target = hills(1.5, 6.0, 2.0, 2);
    const TerrainDictionary dictionary(exemplar, kArea, options(24, 3));
    const std::vector<SparsePatch> patches = dictionary.represent(target, kArea);
    const LandformPtr land = dictionary.landform(patches);
    ASSERT_EQ(patches.size(), 81u);
    Numbers numbers(3);
    for (int n = 0; n < 500; ++n) {
        const Vec2d p(numbers.between(-9.0, 9.0), numbers.between(-9.0, 9.0));
        double sum = 0.0, weights = 0.0, without = 1.0;
        for (const SparsePatch& patch : patches) {
            const Vec2d q = p - patch.centre;
            if (q.length() >= 1.3 * kSpacing) continue;
            const double t = std::max(0.0, (q.length() / kSpacing - 0.72) / (1.3 - 0.72)), w = std::pow(1.0 - t * t, 3.0);
            double h = patch.mean;
            for (const auto& term : patch.terms) h += term.factor * dictionary.atom(term.atom).height(q);
            sum += w * h, weights += w, without *= 1.0 - w;
        }
        const Elevated<Jet2> e = land->at(p, 0.0);
        EXPECT_NEAR(e.weight.value, 1.0 - without, 1e-12);
        if (weights > 1e-6) {
            EXPECT_NEAR(e.height.value / e.weight.value, sum / weights, 1e-9);
        }
        if (std::abs(p.x) < 8.0 && std::abs(p.y) < 8.0) {
            EXPECT_NEAR(e.weight.value, 1.0, 1e-12) << "not covered at " << p.x << ", " << p.y;
        }
    }
}

TEST(TerrainDictionary, a_terrain_is_written_with_its_own_patches)
{
    // Every place that patches are cut at is in the dictionary, and the lattice of the target meets some of them.
    const ElevationHeight hill = hills(2.0, 3.0, 3.0, 1);
    const TerrainDictionary all(hill, kArea, options(4096, 4)), few(hill, kArea, options(8, 1));
    const double with_all = difference(hill, *all.landform(all.represent(hill, kArea)));
    const double with_few = difference(hill, *few.landform(few.represent(hill, kArea)));
    EXPECT_GT(all.size(), 100u);
    EXPECT_EQ(few.size(), 8u);
    EXPECT_LT(with_all, 0.5 * with_few);
    EXPECT_LT(with_all, 0.12) << "of hills 2 m high";
}

TEST(TerrainDictionary, more_terms_come_nearer_to_the_coarse_terrain)
{
    const ElevationHeight exemplar = hills(2.0, 3.0, 5.0, 1), target = hills(1.5, 6.0, 2.0, 2);
    double last = kInfinity;
    for (const int terms : {1, 2, 4, 8}) {
        const TerrainDictionary dictionary(exemplar, kArea, options(32, terms));
        const double d = difference(target, *dictionary.landform(dictionary.represent(target, kArea)));
        EXPECT_LT(d, last) << terms << " terms";
        last = d;
    }
}

TEST(TerrainDictionary, gives_a_coarse_terrain_the_detail_of_its_exemplar)
{
    // The target has no form below 8 m, the exemplar has forms of 12 cm. Second differences over 10 cm, far below a coarse sample (43 cm).
    const ElevationHeight exemplar = hills(2.0, 4.0, 6.0, 1), target = hills(1.5, 8.0, 1.0, 2);
    const TerrainDictionary dictionary(exemplar, kArea, {kSpacing, kSpacing / 64.0, 64, 2});
    const LandformPtr land = dictionary.landform(dictionary.represent(target, kArea));
    const auto roughness = [&](const auto& height) {
        Numbers numbers(2);
        double sum = 0.0;
        for (int n = 0; n < 4000; ++n) {
            const Vec2d p(numbers.between(-6.0, 6.0), numbers.between(-6.0, 6.0)), e(0.1, 0.0);
            sum += std::abs(height(p + e) - 2.0 * height(p) + height(p - e));
        }
        return sum / 4000.0;
    };
    const double smooth = roughness([&](const Vec2d& p) { return target.height(p); });
    const double fine = roughness([&](const Vec2d& p) { return exemplar.height(p); });
    const double detailed = roughness([&](const Vec2d& p) {
        const auto e = land->at(p, 0.0);
        return e.height.value / e.weight.value;
    });
    EXPECT_GT(detailed, 4.0 * smooth) << "exemplar " << fine;
    EXPECT_LT(detailed, fine) << "more detail than there is";
}

TEST(TerrainDictionary, is_the_same_for_any_number_of_threads)
{
    const ElevationHeight exemplar = hills(2.0, 3.0, 5.0, 1), target = hills(1.5, 6.0, 2.0, 2);
    std::vector<std::vector<SparsePatch>> found;
    for (const int threads : {1, 3}) {
        tbb::task_arena arena(threads);
        arena.execute([&] { found.push_back(TerrainDictionary(exemplar, kArea, options(16, 3)).represent(target, kArea)); });
    }
    for (std::size_t n = 0; n < found[0].size(); ++n) {
        EXPECT_EQ(found[0][n].mean, found[1][n].mean);
        ASSERT_EQ(found[0][n].terms.size(), found[1][n].terms.size());
        for (std::size_t k = 0; k < found[0][n].terms.size(); ++k) {
            EXPECT_EQ(found[0][n].terms[k].atom, found[1][n].terms[k].atom);
            EXPECT_EQ(found[0][n].terms[k].factor, found[1][n].terms[k].factor);
        }
    }
}

TEST(TerrainDictionary, has_nothing_to_cut_from_level_or_small_ground)
{
    const ElevationHeight level = hills(0.0, 3.0, 1.0, 1), hill = hills(2.0, 3.0, 3.0, 1);
    EXPECT_THROW(TerrainDictionary(level, kArea, options(4, 1)), Error);
    EXPECT_THROW(TerrainDictionary(hill, Box2d(Vec2d(0.0), Vec2d(5.0)), options(4, 1)), Error);
    EXPECT_NO_THROW(TerrainDictionary(hill, Box2d(Vec2d(0.0), Vec2d(TerrainDictionary::needed_size(kSpacing) + 1e-9)), options(4, 1)));
}

}  // namespace
}  // namespace hoodoo
