// A stack read as the elevation map that it is where nothing overhangs (Peytavie2009 has the columns, GalinCourse the map).
// Missing: ground under an overhang; what rays would meet if it were shown by itself (the `convolution` terrain is that).
#include "terrain/surfaces/column_ground.h"

#include "terrain/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace hoodoo
{

namespace
{

HeightGrid grid_for(const MaterialStack& stack)
{
    const Vec2i n = stack.size();
    if (n.x < 2 || n.y < 2)
        throw Error(ErrorKind::scene,
                    Problem{{}, "the layers are too few columns for a ground", "at least 2 x 2", fmt::format("{} x {}", n.x, n.y), {}});
    const double cell = stack.cell();
    return HeightGrid({stack.origin() + Vec3d(0.5 * cell, 0.5 * cell, 0.0), Vec2d(cell), stack.unit()}, n.x, n.y, SampleType::f32);
}

}  // namespace

ColumnGround::ColumnGround(const MaterialStack& stack) : grid_(grid_for(stack))
{
    const Vec2i n = stack.size();
    for (int j = 0; j < n.y; ++j) {
        for (int i = 0; i < n.x; ++i) {
            std::int32_t top = 0;
            Material material = Material::bedrock;
            for (const Layer& layer : stack.column(i, j)) {
                if (layer.material == Material::air || layer.material == Material::water) continue;
                top = layer.top;
                material = layer.material;
            }
            grid_.set(i, j, top);
            const auto known = std::find(names_.begin(), names_.end(), material_name(material));
            seen_.push_back(static_cast<std::uint8_t>(known - names_.begin()));
            if (known == names_.end()) names_.push_back(material_name(material));
        }
    }
    grid_.summarise();
    info_.columns = static_cast<std::uint64_t>(n.x) * static_cast<std::uint64_t>(n.y);
    info_.layers = stack.layer_count();
    info_.trace_bytes = grid_.sample_bytes() + grid_.summary_bytes() + seen_.size();
}

void ColumnGround::dress(Interaction& at) const
{
    at.shading_normal = at.geometric_normal;
    at.texture_point = at.position;
    const GridFrame& frame = grid_.frame();
    const auto place = [](double x, int n) { return std::clamp(x, 0.0, n - 1.0); };
    const double x = place((at.position.x - frame.origin.x) / frame.cell.x, grid_.columns());
    const double y = place((at.position.y - frame.origin.y) / frame.cell.y, grid_.rows());
    const int i = std::min(static_cast<int>(x), grid_.columns() - 2), j = std::min(static_cast<int>(y), grid_.rows() - 2);
    const double u = x - i, v = y - j;
    std::array<float, kMaterialCount> share{};
    const auto add = [&](int column, int row, double weight) {
        share[seen_[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.columns()) + static_cast<std::size_t>(column)]] +=
            static_cast<float>(weight);
    };
    add(i, j, (1 - u) * (1 - v));
    add(i + 1, j, u * (1 - v));
    add(i, j + 1, (1 - u) * v);
    add(i + 1, j + 1, u * v);
    for (std::size_t m = 0; m < names_.size(); ++m)
        if (share[m] > 0.0f) at.materials.add(static_cast<std::uint8_t>(m), share[m]);
}

}  // namespace hoodoo
