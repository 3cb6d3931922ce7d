// Questions about rock layers, answered from the columns' words (maths A9: the air-distance rule).
//
// A point at distance d from air: some column whose square is delta away horizontally has air within +- sqrt(d^2 - delta^2) of the point's height.
// Where no tile of the stack has rock nothing else is asked. The own column is asked first, then rings around it, so that a rock near the ground's
// surface costs one column. Water counts as air: it does not hide.

#include "terrain/rocks/stack_rocks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{
namespace
{

constexpr int kBlock = MaterialStack::tile_size;

bool is_open(Material m)
{
    return m == Material::air || m == Material::water;
}

}  // namespace

StackRocks::StackRocks(std::shared_ptr<const MaterialStack> stack, Border border)
    : stack_(std::move(stack)), border_(border), blocks_((stack_->size() + Vec2i(kBlock - 1)) / kBlock)
{
    rock_.resize(static_cast<std::size_t>(blocks_.x) * static_cast<std::size_t>(blocks_.y));
    tbb::parallel_for(std::size_t(0), rock_.size(), [&](std::size_t k) { look_at_block(k); });
}

/// Of the columns [i0, i1) x [j0, j1) of the grid.
StackRocks::Block StackRocks::look(int i0, int i1, int j0, int j1) const
{
    Block block;
    for (int j = j0; j < j1; ++j) {
        for (int i = i0; i < i1; ++i) {
            std::int32_t below = 0;
            for (const std::uint16_t word : stack_->words(i, j)) {
                const std::int32_t top = MaterialStack::top_of(word);
                if (MaterialStack::material_of(word) == Material::rock)
                    block.low = std::min(block.low, below), block.high = std::max(block.high, top);
                below = top;
            }
        }
    }
    return block;
}

void StackRocks::look_at_block(std::size_t index)
{
    const int i = static_cast<int>(index % static_cast<std::size_t>(blocks_.x)) * kBlock;
    const int j = static_cast<int>(index / static_cast<std::size_t>(blocks_.x)) * kBlock;
    rock_[index] = look(i, std::min(i + kBlock, stack_->size().x), j, std::min(j + kBlock, stack_->size().y));
}

void StackRocks::follow(const ColumnSet& changed)
{
    std::vector<std::size_t> blocks;
    for (const std::uint32_t index : changed.indices()) {
        const Vec2i c = changed.column(index) / kBlock;
        blocks.push_back(static_cast<std::size_t>(c.y) * static_cast<std::size_t>(blocks_.x) + static_cast<std::size_t>(c.x));
    }
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    for (const std::size_t k : blocks) look_at_block(k);
}

Box3d StackRocks::bounds() const
{
    const Vec3d& o = stack_->origin();
    const double width = kBlock * stack_->cell();
    Box3d box;
    for (std::size_t k = 0; k < rock_.size(); ++k) {
        if (rock_[k].low > rock_[k].high) continue;
        const double x = o.x + static_cast<double>(k % static_cast<std::size_t>(blocks_.x)) * width;
        const double y = o.y + static_cast<double>(k / static_cast<std::size_t>(blocks_.x)) * width;
        box.extendBy(Vec3d(x, y, o.z + rock_[k].low * stack_->unit()));
        box.extendBy(Vec3d(std::min(x + width, o.x + stack_->size().x * stack_->cell()), std::min(y + width, o.y + stack_->size().y * stack_->cell()),
                           o.z + rock_[k].high * stack_->unit()));
    }
    return box;
}

Box3d StackRocks::room() const
{
    const Vec3d size(stack_->size().x * stack_->cell(), stack_->size().y * stack_->cell(), MaterialStack::max_top * stack_->unit());
    return {stack_->origin(), stack_->origin() + size};
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
    const Vec2i n = stack_->size();
    Vec2i a = column_of(Vec3d(lo.x, lo.y, 0.0)), b = column_of(Vec3d(hi.x, hi.y, 0.0));
    a = Vec2i(std::max(a.x, 0), std::max(a.y, 0)), b = Vec2i(std::min(b.x, n.x - 1), std::min(b.y, n.y - 1));
    Block all;
    for (int y = a.y / kBlock; a.x <= b.x && y <= b.y / kBlock && a.y <= b.y; ++y) {
        for (int x = a.x / kBlock; x <= b.x / kBlock; ++x) {
            const Block& block = rock_[static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks_.x) + static_cast<std::size_t>(x)];
            if (block.low > block.high) continue;
            const Block part = look(std::max(a.x, x * kBlock), std::min(b.x, x * kBlock + kBlock - 1) + 1, std::max(a.y, y * kBlock),
                                    std::min(b.y, y * kBlock + kBlock - 1) + 1);
            all.low = std::min(all.low, part.low), all.high = std::max(all.high, part.high);
        }
    }
    return {stack_->origin().z + all.low * stack_->unit(), stack_->origin().z + all.high * stack_->unit()};
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

bool StackRocks::column_has_air(int i, int j, double z, double within2) const
{
    const Vec2i n = stack_->size();
    if (i < 0 || j < 0 || i >= n.x || j >= n.y) {
        if (border_ == Border::cut) return true;
        i = std::clamp(i, 0, n.x - 1), j = std::clamp(j, 0, n.y - 1);
    }
    std::int32_t below = 0;
    for (const std::uint16_t word : stack_->words(i, j)) {
        const std::int32_t top = MaterialStack::top_of(word);
        if (is_open(MaterialStack::material_of(word))) {
            const double away = std::max({0.0, below - z, z - top});
            if (away * away < within2) return true;
        }
        below = top;
    }
    const double away = std::max(0.0, below - z);
    return away * away < within2;
}

bool StackRocks::air_within(const Vec3d& p, double distance) const
{
    const Vec3d q = p - stack_->origin();
    const double cell = stack_->cell(), unit = stack_->unit(), z = q.z / unit, per_unit2 = 1.0 / (unit * unit);
    const Vec2i own = column_of(p);
    const auto gap2 = [&](double x, int k) {
        const double gap = std::max({0.0, k * cell - x, x - (k + 1) * cell});
        return gap * gap;
    };
    const int rings = static_cast<int>(std::ceil(distance / cell));
    for (int ring = 0; ring <= rings; ++ring) {
        for (int j = own.y - ring; j <= own.y + ring; ++j) {
            const double left = distance * distance - gap2(q.y, j);
            const bool whole_row = j == own.y - ring || j == own.y + ring;
            for (int i = own.x - ring; i <= own.x + ring; i += whole_row || ring == 0 ? 1 : 2 * ring) {
                const double within2 = (left - gap2(q.x, i)) * per_unit2;
                if (within2 > 0.0 && column_has_air(i, j, z, within2)) return true;
            }
        }
    }
    return false;
}

}  // namespace hoodoo
