// A terrain as a set of points, column by column: a height function, 3-D noise in a band about it, and tunnels; then runs rounded to units.

#include "tests/support/terrains.h"

#include "terrain/math/hash.h"
#include "terrain/math/noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hoodoo::testing {
namespace {

constexpr int kUnitsPerCell = 32;
constexpr double kSample = 0.5;   ///< cells between samples along a column

struct Tunnel {
    std::vector<Vec3d> points;
    double radius;
};

class Recipe {
public:
    explicit Recipe(const TerrainRecipe& r) : r_(r)
    {
        const int count = r.tunnels >= 0 ? r.tunnels : std::max(1, r.size.x * r.size.y / (r.rugged ? 8700 : 20000));
        for (int k = 0; k < count; ++k) tunnels_.push_back(make_tunnel(hash_cell(r.seed, k, 77)));
    }

    /// Height of the ground in cells.
    double height(double x, double y) const
    {
        const auto seed = static_cast<std::uint32_t>(r_.seed);
        const double wave = r_.relief * 1.2;   // longest wavelength: slopes of about one whatever the relief
        const double rough = r_.rugged ? 1.0 : 0.35;
        const Vec2d p(x / wave, y / wave);
        double h = 0.5 + 0.35 * fbm(p, seed, {7.0, 2.0, r_.rugged ? 0.5 : 0.35}).value + rough * 0.15 * ridged(p * 2.0, seed + 1, {5.0, 2.0, 0.45}).value;
        // Canyons: narrow valleys along the zero set of a slow noise.
        const double river = std::abs(gradient_noise(p * 1.3, seed + 2).value);
        h -= rough * 0.3 * std::max(0.0, 1.0 - river / 0.08);
        // Terraces: the height gathers at steps.
        const double steps = h * 14.0, base = std::floor(steps), part = steps - base;
        const double stair = (base + std::pow(part, 4.0)) / 14.0;
        h += rough * 0.7 * (stair - h);
        return std::clamp(h, 0.02, 0.98) * r_.relief;
    }

    bool solid(double x, double y, double z, double ground) const
    {
        // Overhangs: noise moves the ground by up to a tenth of the relief.
        const double band = r_.relief * (r_.rugged ? 0.12 : 0.04) + 2.0;
        double d = z - ground;
        if (std::abs(d) < band) {
            const double size = std::max(6.0, r_.relief * 0.09);
            d += band * 1.6 * fbm(Vec3d(x, y, 1.7 * z) / size, static_cast<std::uint32_t>(r_.seed) + 3, {3.0, 2.0, 0.5}).value;
        }
        if (d >= 0.0) return false;
        for (const Tunnel* t : near_)
            if (distance(*t, {x, y, z}) < t->radius) return false;
        return true;
    }

    /// Keeps the tunnels that come near column (x, y) at hand.
    void prepare(double x, double y)
    {
        near_.clear();
        for (const Tunnel& t : tunnels_) {
            for (std::size_t k = 0; k + 1 < t.points.size(); ++k) {
                const Vec3d& a = t.points[k];
                const Vec3d& b = t.points[k + 1];
                if (x < std::min(a.x, b.x) - t.radius || x > std::max(a.x, b.x) + t.radius) continue;
                if (y < std::min(a.y, b.y) - t.radius || y > std::max(a.y, b.y) + t.radius) continue;
                near_.push_back(&t);
                break;
            }
        }
    }

private:
    static double distance(const Tunnel& t, const Vec3d& p)
    {
        double best = kInfinity;
        for (std::size_t k = 0; k + 1 < t.points.size(); ++k) {
            const Vec3d ab = t.points[k + 1] - t.points[k], ap = p - t.points[k];
            const double u = std::clamp(ap.dot(ab) / ab.dot(ab), 0.0, 1.0);
            best = std::min(best, (ap - ab * u).length());
        }
        return best;
    }

    Tunnel make_tunnel(std::uint64_t h) const
    {
        const auto next = [&h] { return unit_real(h = mix64(h)); };
        Vec3d p(next() * r_.size.x, next() * r_.size.y, 0.0);
        double heading = 6.2831853 * next();
        Tunnel t{{}, std::max(2.0, r_.relief * (0.02 + 0.03 * next()))};
        for (int k = 0; k < 7; ++k) {
            p.z = height(p.x, p.y) - (k == 0 || k == 6 ? -0.5 : 1.0 + next()) * t.radius;
            t.points.push_back(p);
            heading += 1.2 * (next() - 0.5);
            p += Vec3d(std::cos(heading), std::sin(heading), 0.0) * (3.0 * t.radius);
        }
        return t;
    }

    TerrainRecipe r_;
    std::vector<Tunnel> tunnels_;
    std::vector<const Tunnel*> near_;
};

std::vector<Layer> make_column(Recipe& recipe, double relief, double x, double y)
{
    recipe.prepare(x, y);
    const double ground = recipe.height(x, y);
    const double slope = std::abs(recipe.height(x + 1.0, y) - ground) + std::abs(recipe.height(x, y + 1.0) - ground);
    std::vector<Layer> layers;
    bool solid = true;
    double below = 0.0;
    const auto unit = [](double z) { return static_cast<std::int32_t>(std::lround(z * kUnitsPerCell)); };
    for (double z = kSample; z < relief * 1.13; z += kSample) {
        const bool now = recipe.solid(x, y, z, ground);
        if (now == solid) {
            below = z;
            continue;
        }
        double lo = below, hi = z;
        for (int k = 0; k < 8; ++k) {
            const double m = 0.5 * (lo + hi);
            (recipe.solid(x, y, m, ground) == solid ? lo : hi) = m;
        }
        const std::int32_t top = std::min(unit(hi), MaterialStack::max_top);
        if (top > (layers.empty() ? 0 : layers.back().top)) layers.push_back({solid ? Material::bedrock : Material::air, top});
        solid = now;
        below = z;
    }
    // Sand lies where the ground is flat, as the uppermost part of the top layer.
    if (slope < 0.5 && !layers.empty() && layers.back().material == Material::bedrock) {
        const std::int32_t bottom = layers.size() > 1 ? layers[layers.size() - 2].top : 0, top = layers.back().top;
        if (top - bottom > 2 * kUnitsPerCell) {
            layers.back().top = top - kUnitsPerCell;
            layers.push_back({Material::sand, top});
        }
    }
    return layers;
}

}  // namespace

std::shared_ptr<MaterialStack> make_terrain(const TerrainRecipe& r)
{
    auto stack = std::make_shared<MaterialStack>(r.size, r.cell, r.cell / kUnitsPerCell, r.origin);
    Recipe recipe(r);
    std::vector<std::vector<Layer>> columns;
    columns.reserve(static_cast<std::size_t>(r.size.x) * static_cast<std::size_t>(r.size.y));
    for (int j = 0; j < r.size.y; ++j)
        for (int i = 0; i < r.size.x; ++i) columns.push_back(make_column(recipe, r.relief, i + 0.5, j + 0.5));
    stack->set_columns({0, 0}, r.size, columns);
    return stack;
}

}  // namespace hoodoo::testing
