// Water rises to a level wherever it can come from where it is poured: hollows, lakes, flooded caves, and only those.
// The paper (Peytavie2009) has water among its materials and no tool for it. CHOICE: the air below the level is filled in the pockets that are
// connected to the seed's: two pockets of columns side by side (not across corners) are connected if they have open heights in common below the
// level, open being what is not bedrock, sand, soil or rock. Water that is there stays. Then it flows, as stabilisation at an angle of repose of 0:
// so water poured beside a gap runs away, and `deposit` with water lets it run from anywhere. Communicating vessels fill as they should, since what
// is connected below the level is filled to it. Missing: pressure that moves water later, when an edit opens a siphon.
#include "terrain/edit/pockets.h"
#include "terrain/edit/region.h"
#include "terrain/edit/rows.h"

#include <fmt/format.h>

#include <cmath>

namespace hoodoo
{

namespace
{

constexpr std::size_t kWater = kLooseOrder.size() - 1;
static_assert(kLooseOrder[kWater] == Material::water);

/// Top of what lies under the water.
std::int32_t bed(const Pocket& pocket)
{
    return pocket.top(kWater - 1);
}

class Filling
{
public:
    Filling(MaterialStack& stack, std::int32_t level) : grid_(stack), level_(level) {}

    /// The pocket at height `z` (units) of column (i, j); nullptr if there is no open place below the level.
    Pocket* pocket_at(int i, int j, double z)
    {
        for (Pocket& pocket : grid_.column(i, j)) {
            const bool last = pocket.ceiling == MaterialStack::max_top;
            if (z >= pocket.floor && (last || z <= pocket.ceiling)) return bed(pocket) < top(pocket) ? &pocket : nullptr;
        }
        return nullptr;
    }

    ColumnSet from(int i, int j, Pocket* seed)
    {
        seed->mark = 1;
        std::vector<std::pair<Vec2i, Pocket*>> open = {{{i, j}, seed}};
        for (std::size_t k = 0; k < open.size(); ++k) {
            const auto [c, pocket] = open[k];
            for (const Vec2i& step : {Vec2i(1, 0), Vec2i(-1, 0), Vec2i(0, 1), Vec2i(0, -1)}) {
                const Vec2i to = c + step;
                if (!grid_.inside(to.x, to.y)) continue;
                for (Pocket& next : grid_.column(to.x, to.y)) {
                    if (next.mark || std::max(bed(*pocket), bed(next)) >= std::min(top(*pocket), top(next))) continue;
                    next.mark = 1;
                    open.push_back({to, &next});
                }
            }
        }
        for (const auto& [c, pocket] : open) {
            const std::int32_t depth = top(*pocket) - bed(*pocket);
            if (depth <= pocket->loose[kWater]) continue;
            pocket->loose[kWater] = static_cast<std::int16_t>(depth);
            grid_.touch(c.x, c.y);
        }
        return grid_.write();
    }

private:
    std::int32_t top(const Pocket& pocket) const { return std::min<std::int32_t>(pocket.ceiling, level_); }

    PocketGrid grid_;
    std::int32_t level_;
};

}  // namespace

EditTool fill_tool()
{
    Schema schema{"fill", "Fills with water up to a level what is connected to a point.", {}};
    schema.parameters = {
        {.name = "seed",
         .type = ParameterType::vector,
         .doc = "A point in the air (or water) below which the water stands.",
         .required = true,
         .unit = "m",
         .min_count = 3,
         .max_count = 3},
        {.name = "level", .type = ParameterType::length, .doc = "Height of the water; by default that of the seed.", .unit = "m"},
    };
    const auto apply = [](MaterialStack& stack, const Values& edit, const EditContext&) {
        const Vec3d seed = edit.vec3("seed"), local = seed - stack.origin();
        const Vec2d cell(std::floor(local.x / stack.cell()), std::floor(local.y / stack.cell()));
        if (!(cell.x >= 0 && cell.y >= 0 && cell.x < stack.size().x && cell.y < stack.size().y)) throw outside_the_terrain(stack, edit, "seed");
        const char* key = edit.has("level") ? "level" : "seed";
        const double height = edit.has("level") ? edit.number("level") : seed.z, units = (height - stack.origin().z) / stack.unit();
        if (!(units >= 0.5 && units < MaterialStack::max_top + 0.5)) {
            throw edit.problem(key, "the level of the water",
                               fmt::format("above {} m, up to {} m", stack.origin().z, stack.origin().z + MaterialStack::max_top * stack.unit()),
                               fmt::format("{} m", height));
        }
        Filling filling(stack, static_cast<std::int32_t>(std::lround(units)));
        const int i = static_cast<int>(cell.x), j = static_cast<int>(cell.y);
        Pocket* pocket = filling.pocket_at(i, j, local.z / stack.unit());
        if (!pocket) {
            throw edit.problem("seed", "no water can stand here", fmt::format("a point in the air over ground that is lower than {} m", height),
                               fmt::format("({}, {}, {})", seed.x, seed.y, seed.z));
        }
        return filling.from(i, j, pocket);
    };
    return {std::move(schema), apply};
}

}  // namespace hoodoo
