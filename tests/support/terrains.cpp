// A terrain as a set of points, column by column: a height function, 3-D noise in a band about it, and tunnels; then runs rounded to units.

#include "tests/support/terrains.h"

#include "terrain/math/hash.h"
#include "terrain/math/noise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hoodoo::testing
{
namespace
{

constexpr int kUnitsPerCell = 32;
constexpr double kSample = 0.5;  ///< cells between samples along a column

struct Tunnel {
    std::vector<Vec3d> points;
    double radius;
};

class Recipe
{
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
        const double wave = r_.relief * 1.2;  // longest wavelength: slopes of about one whatever the relief
        const double rough = r_.rugged ? 1.0 : 0.35;
        const Vec2d p(x / wave, y / wave);
        double h = 0.5 + 0.35 * fbm(p, seed, {7.0, 2.0, r_.gain >= 0.0 ? r_.gain : (r_.rugged ? 0.5 : 0.35)}).value +
                   rough * 0.15 * ridged(p * 2.0, seed + 1, {5.0, 2.0, 0.45}).value;
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
        const double share = r_.overhangs >= 0.0 ? r_.overhangs : (r_.rugged ? 0.12 : 0.04);
        const double band = r_.relief * share + 2.0;
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

    const std::vector<Tunnel>& tunnels() const { return tunnels_; }

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
    std::vector<const Tunnel*> near_;  ///< set anew by prepare(), so a copy may begin with any
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

/// Whether the column under p has no matter within `reach` of p's height.
bool open_at(const MaterialStack& stack, const Vec3d& p, double reach)
{
    const int i = static_cast<int>(std::floor(p.x / stack.cell())), j = static_cast<int>(std::floor(p.y / stack.cell()));
    if (i < 0 || j < 0 || i >= stack.size().x || j >= stack.size().y) return false;
    double below = 0.0;
    for (const Layer& layer : stack.column(i, j)) {
        const double top = layer.top * stack.unit();
        if (layer.material != Material::air && below < p.z + reach && top > p.z - reach) return false;
        below = top;
    }
    return p.z > reach;
}

/// The level direction in which the view from `eye` is open farthest.
Vec3d farthest_view(const MaterialStack& stack, const Vec3d& eye)
{
    Vec3d best(1, 0, 0);
    double farthest = 0.0;
    for (int k = 0; k < 32; ++k) {
        const double phi = k * 0.19634954;
        const Vec3d d(std::cos(phi), std::sin(phi), 0.0);
        double t = 0.0;
        while (open_at(stack, eye + d * (t + stack.cell()), stack.cell())) t += stack.cell();
        if (t > farthest) farthest = t, best = d;
    }
    return best;
}

View canyon_view(const MaterialStack& stack, const Recipe& recipe, double relief)
{
    // The deepest place among a grid of places, against the mean of its surroundings.
    const double nx = stack.size().x, ny = stack.size().y, around = 0.25 * relief;
    Vec3d eye(0.5 * nx, 0.5 * ny, relief);
    double deepest = -kInfinity;
    for (double y = 0.15 * ny; y < 0.85 * ny; y += ny / 60.0) {
        for (double x = 0.15 * nx; x < 0.85 * nx; x += nx / 60.0) {
            const double h = recipe.height(x, y);
            double mean = 0.0;
            for (int k = 0; k < 8; ++k) mean += 0.125 * recipe.height(x + around * std::cos(0.7854 * k), y + around * std::sin(0.7854 * k));
            Vec3d p(x, y, h);
            for (int k = 0; k < 200 && !open_at(stack, p, 3.0); ++k) p.z += 1.0;
            if (mean - p.z > deepest) deepest = mean - p.z, eye = p;
        }
    }
    return {"canyon", eye, eye + farthest_view(stack, eye), 0.7};
}

View tunnel_view(const MaterialStack& stack, const Recipe& recipe)
{
    // In the widest tunnel that is open where its line says so and has a roof.
    View view{"tunnel", Vec3d(0.5 * stack.size().x, 0.5 * stack.size().y, 1.0), Vec3d(0.0), 0.7};
    double widest = 0.0;
    for (const Tunnel& t : recipe.tunnels()) {
        const Vec3d p = t.points[3];
        if (t.radius <= widest || !open_at(stack, p, 0.4 * t.radius) || open_at(stack, p + Vec3d(0, 0, 2.0 * t.radius), 0.5 * t.radius)) continue;
        widest = t.radius;
        view.eye = p, view.target = t.points[4];
    }
    if (view.target == Vec3d(0.0)) view.target = view.eye + farthest_view(stack, view.eye);
    return view;
}

}  // namespace

BenchTerrain bench_terrain(bool rugged, Vec2i size)
{
    TerrainRecipe r;
    r.size = size;
    r.rugged = rugged;
    r.relief = std::min(226.0, 226.0 * std::max(size.x, size.y) / 1024.0);
    r.overhangs = rugged ? 0.03 : 0.012;
    r.gain = rugged ? 0.42 : 0.35;
    BenchTerrain terrain;
    terrain.stack = make_terrain(r);
    const Recipe recipe(r);
    const double nx = size.x, ny = size.y;
    terrain.views.push_back({"aerial", {0.1 * nx, 0.05 * ny, 2.0 * r.relief}, {0.5 * nx, 0.55 * ny, 0.4 * r.relief}, 0.5});
    terrain.views.push_back(canyon_view(*terrain.stack, recipe, r.relief));
    terrain.views.push_back(tunnel_view(*terrain.stack, recipe));
    return terrain;
}

std::shared_ptr<MaterialStack> make_terrain(const TerrainRecipe& r)
{
    auto stack = std::make_shared<MaterialStack>(r.size, r.cell, r.cell / kUnitsPerCell, r.origin);
    const Recipe recipe(r);
    std::vector<std::vector<Layer>> columns(static_cast<std::size_t>(r.size.x) * static_cast<std::size_t>(r.size.y));
    tbb::parallel_for(0, r.size.y, [&](int j) {
        Recipe mine(recipe);
        for (int i = 0; i < r.size.x; ++i)
            columns[static_cast<std::size_t>(j) * static_cast<std::size_t>(r.size.x) + static_cast<std::size_t>(i)] =
                make_column(mine, r.relief, i + 0.5, j + 0.5);
    });
    stack->set_columns({0, 0}, r.size, columns);
    return stack;
}

}  // namespace hoodoo::testing
