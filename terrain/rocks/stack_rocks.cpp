// Questions about rock layers, answered from the columns' words (maths A9: the air-distance rule).
//
// A point at distance d from air: some column whose square is delta away horizontally has air within +- sqrt(d^2 - delta^2) of the point's height.
// The own column is asked first, then rings around it, so that a rock near the ground's surface costs one column. Water counts as air: it does not
// hide.

#include "terrain/rocks/stack_rocks.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

bool is_open(Material m)
{
    return m == Material::air || m == Material::water;
}

}  // namespace

bool has_rock_layers(const MaterialStack& stack)
{
    for (int j = 0; j < stack.size().y; ++j)
        for (int i = 0; i < stack.size().x; ++i)
            for (const std::uint16_t word : stack.words(i, j))
                if (MaterialStack::material_of(word) == Material::rock) return true;
    return false;
}

StackRocks::StackRocks(std::shared_ptr<const MaterialStack> stack, Border border) : stack_(std::move(stack)), border_(border)
{
    const MaterialStack& s = *stack_;
    const Vec3d& o = s.origin();
    for (int j = 0; j < s.size().y; ++j) {
        for (int i = 0; i < s.size().x; ++i) {
            std::int32_t below = 0;
            for (const std::uint16_t word : s.words(i, j)) {
                const std::int32_t top = MaterialStack::top_of(word);
                if (MaterialStack::material_of(word) == Material::rock) {
                    bounds_.extendBy(Vec3d(o.x + i * s.cell(), o.y + j * s.cell(), o.z + below * s.unit()));
                    bounds_.extendBy(Vec3d(o.x + (i + 1) * s.cell(), o.y + (j + 1) * s.cell(), o.z + top * s.unit()));
                }
                below = top;
            }
        }
    }
}

Vec2i StackRocks::column_of(const Vec3d& p) const
{
    const Vec3d q = (p - stack_->origin()) / stack_->cell();
    // Far outside stays outside, within the range of an integer.
    const auto whole = [](double x) { return static_cast<int>(std::floor(std::clamp(x, -1e9, 1e9))); };
    return {whole(q.x), whole(q.y)};
}

Interval StackRocks::heights(const Vec2d& lo, const Vec2d& hi) const
{
    const Vec2i a = column_of(Vec3d(lo.x, lo.y, 0.0)), b = column_of(Vec3d(hi.x, hi.y, 0.0));
    std::int32_t lowest = MaterialStack::max_top + 1, highest = -1;
    for (int j = std::max(a.y, 0); j <= std::min(b.y, stack_->size().y - 1); ++j) {
        for (int i = std::max(a.x, 0); i <= std::min(b.x, stack_->size().x - 1); ++i) {
            std::int32_t below = 0;
            for (const std::uint16_t word : stack_->words(i, j)) {
                const std::int32_t top = MaterialStack::top_of(word);
                if (MaterialStack::material_of(word) == Material::rock) lowest = std::min(lowest, below), highest = std::max(highest, top);
                below = top;
            }
        }
    }
    return {stack_->origin().z + lowest * stack_->unit(), stack_->origin().z + highest * stack_->unit()};
}

bool StackRocks::holds(const Vec3d& p) const
{
    const Vec2i c = column_of(p);
    if (c.x < 0 || c.y < 0 || c.x >= stack_->size().x || c.y >= stack_->size().y) return false;
    const double z = (p.z - stack_->origin().z) / stack_->unit();
    std::int32_t below = 0;
    for (const std::uint16_t word : stack_->words(c.x, c.y)) {
        const std::int32_t top = MaterialStack::top_of(word);
        if (z >= below && z < top) return MaterialStack::material_of(word) == Material::rock;
        below = top;
    }
    return false;
}

bool StackRocks::ground(const Vec3d& p) const
{
    const Vec2i n = stack_->size(), c = column_of(p);
    if (border_ == Border::cut && (c.x < 0 || c.y < 0 || c.x >= n.x || c.y >= n.y)) return false;
    const double z = (p.z - stack_->origin().z) / stack_->unit();
    if (z < 0.0) return true;
    std::int32_t below = 0;
    for (const std::uint16_t word : stack_->words(std::clamp(c.x, 0, n.x - 1), std::clamp(c.y, 0, n.y - 1))) {
        const std::int32_t top = MaterialStack::top_of(word);
        const Material m = MaterialStack::material_of(word);
        if (z >= below && z < top) return !is_open(m) && m != Material::rock;
        below = top;
    }
    return false;
}

bool StackRocks::column_has_air(int i, int j, double low, double high) const
{
    const Vec2i n = stack_->size();
    if (i < 0 || j < 0 || i >= n.x || j >= n.y) {
        if (border_ == Border::cut) return true;
        i = std::clamp(i, 0, n.x - 1), j = std::clamp(j, 0, n.y - 1);
    }
    std::int32_t below = 0;
    for (const std::uint16_t word : stack_->words(i, j)) {
        const std::int32_t top = MaterialStack::top_of(word);
        if (below >= high) return false;
        if (top > low && is_open(MaterialStack::material_of(word))) return true;
        below = top;
    }
    return high > below;
}

bool StackRocks::air_within(const Vec3d& p, double distance) const
{
    const Vec3d q = p - stack_->origin();
    const double cell = stack_->cell(), unit = stack_->unit(), z = q.z / unit;
    const Vec2i own = column_of(p);
    const auto gap = [&](double x, int k) { return std::max({0.0, k * cell - x, x - (k + 1) * cell}); };
    const int rings = static_cast<int>(std::ceil(distance / cell));
    for (int ring = 0; ring <= rings; ++ring) {
        for (int j = own.y - ring; j <= own.y + ring; ++j) {
            const bool whole_row = j == own.y - ring || j == own.y + ring;
            for (int i = own.x - ring; i <= own.x + ring; i += whole_row || ring == 0 ? 1 : 2 * ring) {
                const double dx = gap(q.x, i), dy = gap(q.y, j), left = distance * distance - dx * dx - dy * dy;
                if (!(left > 0.0)) continue;
                const double half = std::sqrt(left) / unit;
                if (column_has_air(i, j, z - half, z + half)) return true;
            }
        }
    }
    return false;
}

}  // namespace hoodoo
