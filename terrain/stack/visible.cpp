// Which materials the surface shows near a point: the areas of their boundaries towards what light passes, inside the kernel's cube.
// Peytavie2009, section 5, blends textures by the ratio of visible materials. A horizontal boundary of two layers counts with the column's overlap
// w_i w_j; a vertical one, between the columns i and i+1, with w_j times the height where one side is opaque and the other is not.
// Deviation: tops, undersides and sides count alike (the paper does not say). Exact: sorted lists of layers are walked side by side.
#include "terrain/stack/visible.h"

#include "terrain/stack/window.h"

#include <bit>

namespace hoodoo {

namespace {

/// Walks a column's layers upwards, the implicit ones and the border rule included.
class Cursor {
public:
    Cursor(const Ground& ground, int i, int j, double from) : floor_(ground.floor())
    {
        const Vec2i n = ground.stack().size();
        if (ground.border() == Border::cut && (i < 0 || j < 0 || i >= n.x || j >= n.y)) {
            material_ = Material::air;
            top_ = kInfinity;
            return;
        }
        words_ = ground.stack().words(std::clamp(i, 0, n.x - 1), std::clamp(j, 0, n.y - 1));
        while (top_ <= from) advance();
    }

    Material material() const { return material_; }
    double top() const { return top_; }

    /// To the next layer with a height; air without end comes last.
    void advance()
    {
        if (below_floor_) {
            below_floor_ = false;
            material_ = Material::bedrock;
            top_ = 0.0;
        } else if (!words_.empty()) {
            material_ = MaterialStack::material_of(words_.front());
            top_ = MaterialStack::top_of(words_.front());
            words_ = words_.subspan(1);
        } else {
            material_ = Material::air;
            top_ = kInfinity;
        }
    }

private:
    double floor_;
    std::span<const std::uint16_t> words_;
    bool below_floor_ = true;
    Material material_ = Material::air;
    double top_ = floor_;
};

class Areas {
public:
    Areas(const Ground& ground, MaterialSet opaque, double low, double high) : ground_(ground), opaque_(opaque), low_(low), high_(high) {}

    void add_horizontal(int i, int j, double area)
    {
        Cursor c(ground_, i, j, low_);
        Material below = c.material();
        for (; c.top() < high_; below = c.material()) {
            const bool interior = c.top() > low_;
            c.advance();
            if (interior) add(below, c.material(), area);
        }
    }

    void add_vertical(int i, int j, int i2, int j2, double area_per_unit)
    {
        Cursor a(ground_, i, j, low_), b(ground_, i2, j2, low_);
        for (double z = low_; z < high_;) {
            const double to = std::min({a.top(), b.top(), high_});
            add(a.material(), b.material(), (to - z) * area_per_unit);
            z = to;
            if (a.top() <= z) a.advance();
            if (b.top() <= z) b.advance();
        }
    }

    std::array<double, kMaterialCount> sums{};

private:
    bool is_opaque(Material m) const { return (opaque_ >> static_cast<unsigned>(m)) & 1u; }
    void add(Material a, Material b, double area)
    {
        if (is_opaque(a) != is_opaque(b)) sums[static_cast<std::size_t>(is_opaque(a) ? a : b)] += area;
    }

    const Ground& ground_;
    MaterialSet opaque_;
    double low_, high_;
};

}  // namespace

std::array<double, kMaterialCount> visible_areas(const Ground& ground, MaterialSet opaque, double sigma, const Vec3d& p)
{
    const MaterialStack& stack = ground.stack();
    const double s = stack.cell(), half = sigma / s;
    const Window x = window((p.x - stack.origin().x) / s, half, stack.size().x), y = window((p.y - stack.origin().y) / s, half, stack.size().y);
    const double z = (p.z - stack.origin().z) / stack.unit(), tall = sigma / stack.unit();
    Areas areas(ground, opaque, z - tall, z + tall);
    for (int j = y.first; j <= y.last; ++j) {
        for (int i = x.first; i <= x.last; ++i) areas.add_horizontal(i, j, x.weight(i) * y.weight(j) * s * s);
        for (int i = x.first; i < x.last; ++i) areas.add_vertical(i, j, i + 1, j, y.weight(j) * s * stack.unit());
    }
    for (int i = x.first; i <= x.last; ++i) {
        for (int j = y.first; j < y.last; ++j) areas.add_vertical(i, j, i, j + 1, x.weight(i) * s * stack.unit());
    }
    return areas.sums;
}

std::optional<Material> only_visible(const Ground& ground, MaterialSet opaque, double sigma, const Vec3d& p)
{
    const MaterialStack& stack = ground.stack();
    const double s = stack.cell(), half = sigma / s, low = (p.z - stack.origin().z - sigma) / stack.unit(), high = (p.z - stack.origin().z + sigma) / stack.unit();
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
