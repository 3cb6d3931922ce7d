// Which materials the surface shows near a point: the areas of their boundaries towards what light passes, inside the kernel's cube.
// Peytavie2009, section 5, blends textures by the ratio of visible materials. A horizontal boundary of two layers counts with the column's overlap
// w_i w_j; a vertical one, between the columns i and i+1, with w_j times the height where one side is opaque and the other is not.
// Deviation: tops, undersides and sides count alike (the paper does not say). Exact: sorted lists of layers are walked side by side.
#include "terrain/stack/visible.h"

#include "terrain/stack/window.h"

#include <bit>

namespace hoodoo
{

namespace
{

/// A layer as far as it lies in the kernel's heights: it ends at `top`, or at the kernel's upper end.
struct Part {
    double top;
    Material material;
};

/// All columns of the kernel's window, clipped to its heights, one after another: each is read once and then compared with its neighbours.
class Clipped
{
public:
    Clipped(double low, double high, std::size_t columns) : low_(low), high_(high)
    {
        parts_.reserve(4 * columns);
        begins_.reserve(columns + 1);
        begins_.push_back(0);
    }

    void add(const Ground& ground, int i, int j)
    {
        const Vec2i n = ground.stack().size();
        if (ground.border() == Border::extend || (i >= 0 && j >= 0 && i < n.x && j < n.y)) {
            put(Material::air, ground.floor());
            put(Material::bedrock, 0.0);
            for (const std::uint16_t word : ground.stack().words(std::clamp(i, 0, n.x - 1), std::clamp(j, 0, n.y - 1))) {
                put(MaterialStack::material_of(word), MaterialStack::top_of(word));
            }
        }
        put(Material::air, kInfinity);
        begins_.push_back(parts_.size());
        full_ = false;
    }

    std::span<const Part> column(std::size_t k) const { return {parts_.data() + begins_[k], begins_[k + 1] - begins_[k]}; }

private:
    void put(Material material, double top)
    {
        if (full_ || top <= low_) return;
        full_ = top >= high_;
        parts_.push_back({full_ ? high_ : top, material});
    }

    double low_, high_;
    bool full_ = false;  ///< the column under way has reached the upper end
    std::vector<Part> parts_;
    std::vector<std::size_t> begins_;
};

class Areas
{
public:
    Areas(MaterialSet opaque, double low) : opaque_(opaque), low_(low) {}

    void add_horizontal(std::span<const Part> column, double area)
    {
        for (std::size_t k = 1; k < column.size(); ++k) add(column[k - 1].material, column[k].material, area);
    }

    void add_vertical(std::span<const Part> one, std::span<const Part> other, double area_per_unit)
    {
        double z = low_;
        for (std::size_t a = 0, b = 0; a < one.size() && b < other.size();) {
            const double to = std::min(one[a].top, other[b].top);
            add(one[a].material, other[b].material, (to - z) * area_per_unit);
            z = to;
            const bool next = one[a].top <= other[b].top;
            b += other[b].top <= one[a].top;
            a += next;
        }
    }

    std::array<double, kMaterialCount> sums{};

private:
    bool is_opaque(Material m) const { return (opaque_ >> static_cast<unsigned>(m)) & 1u; }
    void add(Material a, Material b, double area)
    {
        if (is_opaque(a) != is_opaque(b)) sums[static_cast<std::size_t>(is_opaque(a) ? a : b)] += area;
    }

    MaterialSet opaque_;
    double low_;
};

}  // namespace

std::array<double, kMaterialCount> visible_areas(const Ground& ground, MaterialSet opaque, double sigma, const Vec3d& p)
{
    const MaterialStack& stack = ground.stack();
    const double s = stack.cell(), half = sigma / s;
    const Window x = window((p.x - stack.origin().x) / s, half, stack.size().x), y = window((p.y - stack.origin().y) / s, half, stack.size().y);
    const double z = (p.z - stack.origin().z) / stack.unit(), tall = sigma / stack.unit();
    const std::size_t width = static_cast<std::size_t>(x.last - x.first + 1), depth = static_cast<std::size_t>(y.last - y.first + 1);
    Clipped columns(z - tall, z + tall, width * depth);
    for (int j = y.first; j <= y.last; ++j) {
        for (int i = x.first; i <= x.last; ++i) columns.add(ground, i, j);
    }
    Areas areas(opaque, z - tall);
    for (std::size_t j = 0; j < depth; ++j) {
        const double wy = y.weight(y.first + static_cast<int>(j));
        for (std::size_t i = 0; i < width; ++i) {
            const double wx = x.weight(x.first + static_cast<int>(i));
            const std::span<const Part> here = columns.column(j * width + i);
            areas.add_horizontal(here, wx * wy * s * s);
            if (i + 1 < width) areas.add_vertical(here, columns.column(j * width + i + 1), wy * s * stack.unit());
            if (j + 1 < depth) areas.add_vertical(here, columns.column((j + 1) * width + i), wx * s * stack.unit());
        }
    }
    return areas.sums;
}

std::optional<Material> only_visible(const Ground& ground, MaterialSet opaque, double sigma, const Vec3d& p)
{
    const MaterialStack& stack = ground.stack();
    const double s = stack.cell(), half = sigma / s, low = (p.z - stack.origin().z - sigma) / stack.unit(),
                 high = (p.z - stack.origin().z + sigma) / stack.unit();
    const Window x = window((p.x - stack.origin().x) / s, half, stack.size().x), y = window((p.y - stack.origin().y) / s, half, stack.size().y);
    MaterialSet seen = 0;
    for (int j = y.first; j <= y.last; ++j) {
        for (int i = x.first; i <= x.last; ++i) {
            const Vec2i n = stack.size();
            if (ground.border() == Border::cut && (i < 0 || j < 0 || i >= n.x || j >= n.y)) continue;
            double from = 0.0;
            if (low < 0.0) seen |= material_set({Material::bedrock});
            for (const std::uint16_t word : stack.words(std::clamp(i, 0, n.x - 1), std::clamp(j, 0, n.y - 1))) {
                if (from >= high) break;
                const double to = MaterialStack::top_of(word);
                if (to > low) seen |= material_set({MaterialStack::material_of(word)});
                from = to;
            }
        }
    }
    seen &= opaque;
    if (seen == 0 || (seen & (seen - 1)) != 0) return std::nullopt;
    return static_cast<Material>(std::countr_zero(seen));
}

}  // namespace hoodoo
