// What materials look like: means, band limits, no repetition, and the table's parameters.
#include "renderer/shading/look.h"
#include "renderer/shading/procedural.h"

#include "terrain/math/hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

using namespace hoodoo;

namespace
{

/// Looks without colour management: the numbers of a colour are taken as they are.
const ColorConverter kAsWritten = [](const ColorValue& c) { return Vec3f(c.rgb); };

Node table(std::vector<std::pair<std::string, Node>> entries)
{
    Node node;
    node.value = Node::Table(std::move(entries));
    return node;
}

Node leaf(decltype(Node::value) value)
{
    Node node;
    node.value = std::move(value);
    return node;
}

Node grey(double v)
{
    return table({{"grey", leaf(v)}});
}

std::unique_ptr<Look> look_of(const std::string& name, std::vector<std::pair<std::string, Node>> entries)
{
    std::vector<Problem> problems;
    const Values values = check(material_schema(), table(std::move(entries)), problems);
    for (const Problem& p : problems) ADD_FAILURE() << p.text();
    return make_look(name, values, kAsWritten, {});
}

Interaction place(const Vec3d& p, const Vec3d& n = Vec3d(0, 0, 1))
{
    Interaction at;
    at.position = at.texture_point = p;
    at.geometric_normal = at.shading_normal = n;
    return at;
}

const std::vector<std::string> kNatural = {"sand", "bedrock", "rock", "soil"};

double luminance(const Vec3f& c)
{
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

/// The highest autocorrelation of f over a square of side `size` sampled every metre, at lags beyond the main lobe (which ends where the correlation,
/// averaged over both signs and axes of the lag, first falls to 0.15). Lags run to half the size, along both axes and both diagonals.
double highest_far_correlation(int size, const std::function<double(int, int)>& f)
{
    std::vector<double> v(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    double mean = 0.0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) mean += v[static_cast<std::size_t>(y * size + x)] = f(x, y);
    mean /= static_cast<double>(v.size());
    for (double& s : v) s -= mean;
    const auto correlation = [&](int dx, int dy) {
        double both = 0.0, first = 0.0, second = 0.0;
        for (int y = std::max(0, -dy); y < std::min(size, size - dy); ++y)
            for (int x = 0; x < size - dx; ++x) {
                const double a = v[static_cast<std::size_t>(y * size + x)], b = v[static_cast<std::size_t>((y + dy) * size + x + dx)];
                both += a * b;
                first += a * a;
                second += b * b;
            }
        return both / std::sqrt(first * second);
    };
    double highest = -1.0;
    for (const Vec2i& direction : {Vec2i(1, 0), Vec2i(0, 1), Vec2i(1, 1), Vec2i(1, -1)}) {
        bool main_lobe = true;
        for (int lag = 1; lag < size / 2; ++lag) {
            const double c = correlation(direction.x * lag, direction.y * lag);
            if (main_lobe && c < 0.15) main_lobe = false;
            if (!main_lobe) highest = std::max(highest, c);
        }
        if (main_lobe) return 1.0;  // it never falls: one colour all over
    }
    return highest;
}

}  // namespace

TEST(Look, white_is_white_and_bare)
{
    // A furnace needs albedo 1 everywhere, no bump, no roughness, at any place and footprint, for a name that has a procedural look too.
    for (const std::string name : {"white", "sand", "bedrock"}) {
        const auto look = look_of(name, {{"albedo", grey(1.0)}});
        for (int i = 0; i < 100; ++i) {
            const Appearance a = look->appearance(place(Vec3d(i * 13.7, i * -5.1, i * 0.3), Vec3d(0.6, 0.0, 0.8)), 0.01 * i);
            EXPECT_EQ(a.albedo, Vec3f(1.0f));
            EXPECT_EQ(a.roughness, 0.0f);
            EXPECT_EQ(a.normal, Vec3d(0.6, 0.0, 0.8));
        }
    }
}

TEST(Look, a_name_alone_chooses_its_procedure_and_an_unknown_name_is_grey)
{
    for (const std::string& name : kNatural) {
        const auto given = look_of(name, {}), fallback = default_look(name, kAsWritten);
        const Interaction at = place(Vec3d(3.1, 4.7, 5.9));
        EXPECT_EQ(given->appearance(at, 0.1).albedo, fallback->appearance(at, 0.1).albedo) << name;
        EXPECT_NE(given->appearance(at, 0.1).albedo, given->appearance(place(Vec3d(103.1, 54.7, 35.9)), 0.1).albedo) << name;
    }
    EXPECT_EQ(default_look("marble", kAsWritten)->appearance(place(Vec3d(1.0)), 0.0).albedo, Vec3f(0.5f));
}

TEST(Look, albedo_sets_the_mean_of_a_procedural_look)
{
    const auto look = look_of("bedrock", {{"procedural", leaf(std::string("bedrock"))}, {"albedo", grey(0.3)}, {"variation", leaf(0.0)}});
    Vec3d sum(0.0);
    constexpr int places = 20000;
    for (int i = 0; i < places; ++i) {
        const auto random = [&](int k) { return unit_real(hash_cell(9, i, k)); };
        const double z = random(3), r = std::sqrt(1.0 - z * z), a = 6.283185307179586 * random(4);
        sum +=
            Vec3d(look->appearance(place(Vec3d(random(0), random(1), random(2)) * 3000.0, Vec3d(r * std::cos(a), r * std::sin(a), z)), 0.0).albedo);
    }
    // The look measures its mean over 1024 places with a relative spread of 0.5: 1.6% standard error, here 5 of them.
    for (unsigned k = 0; k < 3; ++k) EXPECT_NEAR(sum[k] / places, 0.3, 0.3 * 0.08);
}

TEST(Look, appearance_is_physical_everywhere)
{
    for (const std::string& name : kNatural) {
        const auto look = default_look(name, kAsWritten);
        for (int i = 0; i < 5000; ++i) {
            const auto random = [&](int k) { return unit_real(hash_cell(4, i, k)); };
            const double z = 2.0 * random(3) - 1.0, r = std::sqrt(1.0 - z * z), a = 6.283185307179586 * random(4);
            const Vec3d n(r * std::cos(a), r * std::sin(a), z);
            // Also 4000 km from the origin of the map.
            const Appearance s =
                look->appearance(place(Vec3d(random(0), random(1), random(2)) * (i % 2 ? 4e6 : 500.0), n), std::pow(10.0, 5.0 * random(5) - 3.0));
            for (unsigned k = 0; k < 3; ++k) {
                ASSERT_GE(s.albedo[k], 0.0f);
                ASSERT_LE(s.albedo[k], 1.0f);
            }
            ASSERT_GE(s.roughness, 0.0f);
            ASSERT_LE(s.roughness, 1.0f);
            ASSERT_NEAR(s.normal.length(), 1.0, 1e-9);
            ASSERT_GT(s.normal.dot(n), 0.0);
        }
    }
}

TEST(Look, detail_under_two_footprints_is_gone)
{
    // With a footprint of w, what is left has wavelengths of 2 w and more, so two points 0.02 w apart look nearly the same: contrast in the picture
    // is that of the pixels and not of what falls between them. Without the band limit the difference is that of unrelated points.
    for (const std::string& name : kNatural) {
        const auto look = default_look(name, kAsWritten);
        double near = 0.0, far = 0.0;
        constexpr double w = 1.0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3d p = Vec3d(unit_real(hash_cell(6, i, 0)), unit_real(hash_cell(6, i, 1)), unit_real(hash_cell(6, i, 2))) * 900.0;
            const Vec3d n = Vec3d(0.8, 0.0, 0.6);
            const double here = luminance(look->appearance(place(p, n), w).albedo);
            near += std::pow(luminance(look->appearance(place(p + Vec3d(0.02, 0.01, 0.01) * w, n), w).albedo) - here, 2);
            far += std::pow(luminance(look->appearance(place(p + Vec3d(400.0, 300.0, 200.0), n), w).albedo) - here, 2);
        }
        // sin(2 pi x / L) changes by at most 2 pi 0.025 w / 2 w = 0.08 of its amplitude: squared and against two unrelated values, 0.0064 / 2.
        EXPECT_LT(near, 0.01 * far) << name;
        const Vec3d n(0.0, 0.0, 1.0);
        EXPECT_LT(
            (look->appearance(place(Vec3d(1, 2, 3), n), 1000.0).albedo - look->appearance(place(Vec3d(500, 900, 3), n), 1000.0).albedo).length(),
            1e-6f)
            << name;
    }
}

TEST(Look, the_mean_stays_when_detail_fades)
{
    for (const std::string& name : kNatural) {
        const auto look = default_look(name, kAsWritten);
        const auto mean = [&](double footprint) {
            double sum = 0.0;
            constexpr int places = 20000;
            for (int i = 0; i < places; ++i) {
                const auto random = [&](int k) { return unit_real(hash_cell(5, i, k)); };
                const double z = random(3), r = std::sqrt(1.0 - z * z);
                sum += luminance(look->appearance(place(Vec3d(random(0), random(1), random(2)) * 2000.0, Vec3d(r, 0, z)), footprint).albedo);
            }
            return sum / places;
        };
        const double sharp = mean(0.0);
        for (const double footprint : {0.3, 2.0, 15.0, 200.0}) EXPECT_NEAR(mean(footprint) / sharp, 1.0, 0.1) << name << " " << footprint;
    }
}

TEST(Look, hidden_relief_becomes_roughness)
{
    for (const std::string& name : kNatural) {
        const auto look = default_look(name, kAsWritten);
        const Interaction at = place(Vec3d(20, 30, 40));
        EXPECT_GT(look->appearance(at, 5.0).roughness, look->appearance(at, 0.0).roughness) << name;
        EXPECT_EQ(look->appearance(at, 500.0).normal, at.shading_normal) << name;
    }
}

TEST(Look, albedo_over_512_m_does_not_repeat)
{
    for (const std::string& name : kNatural) {
        const auto look = default_look(name, kAsWritten);
        EXPECT_LT(
            highest_far_correlation(512, [&](int x, int y) { return luminance(look->appearance(place(Vec3d(x + 0.5, y + 0.5, 7.3)), 1.0).albedo); }),
            0.3)
            << name;
    }
}

TEST(Look, the_law_of_repetition_catches_a_look_that_repeats_every_64_m)
{
    const auto look = default_look("rock", kAsWritten);
    EXPECT_GT(highest_far_correlation(
                  256, [&](int x, int y) { return luminance(look->appearance(place(Vec3d(x % 64 + 0.5, y % 64 + 0.5, 7.3)), 1.0).albedo); }),
              0.9);
}
