// Loose material strewn over what lies below a region of space: on hills, and on the floors of caves alike.
// Peytavie2009, section 4.3: a region R and a distribution in it say how much is dropped at each point. Each column of the region gets the thickness
//   amount w(d),   d the distance from the region's middle line over its size,   w = (1 - d^2)^2 (smooth), 1 (even) or 1 - d (cone),
// from the points of R that lie in air: if R reaches into several pockets of a column, each gets the share of air that it has in R. It falls to its
// pocket's floor, merged; the edit's stabilisation does the rest. Patches: w is multiplied by noise of the wavelength `patch_size`, so that a dune
// field or a sward has bare places. Deviations: a pocket takes no more than it has room for; what finds no room is not dropped. A column whose part
// of R lies in matter entirely gets nothing. Missing: distributions painted by an image.
#include "terrain/edit/pockets.h"
#include "terrain/edit/region.h"
#include "terrain/edit/rows.h"
#include "terrain/math/noise.h"

#include <fmt/format.h>

namespace hoodoo
{

namespace
{

struct Dropping {
    Region region;
    std::size_t kind;  ///< index into kLooseOrder
    double amount;     ///< metres
    std::string distribution;
    double patchiness, patch_size;
    std::uint32_t seed;
};

double weight(const Dropping& drop, double d)
{
    if (drop.distribution == "even") return 1.0;
    if (drop.distribution == "cone") return 1.0 - d;
    return (1.0 - d * d) * (1.0 - d * d);
}

/// In [0, 1], mean about 1 - patchiness / 2.
double patches(const Dropping& drop, const Vec2d& p)
{
    if (!(drop.patchiness > 0.0)) return 1.0;
    const Fractal fractal{3.0, 2.0, 0.5};
    const double n = 2.0 * fbm(p / drop.patch_size, drop.seed, fractal).value / kNoise2Bound.value;
    return 1.0 - drop.patchiness * std::clamp(0.5 + 0.5 * n, 0.0, 1.0);
}

/// Air between two heights in one of a column's pockets, units. The last pocket is open: its air has no end.
double air_between(std::span<const Pocket> pockets, std::size_t k, double low, double high)
{
    const double end = k + 1 < pockets.size() ? std::min<double>(high, pockets[k].ceiling) : high;
    return std::max(0.0, end - std::max<double>(low, pockets[k].top()));
}

ColumnSet drop_on(MaterialStack& stack, const Dropping& drop, const Values& edit)
{
    const std::vector<ColumnSpan> spans = column_spans(stack, drop.region);
    if (spans.empty()) throw outside_the_terrain(stack, edit, "points");
    PocketGrid grid(stack);
    for (const ColumnSpan& span : spans) {
        const Vec2i c = span.column;
        const double low = (span.low - stack.origin().z) / stack.unit(), high = (span.high - stack.origin().z) / stack.unit();
        const Vec2d middle(stack.origin().x + (c.x + 0.5) * stack.cell(), stack.origin().y + (c.y + 0.5) * stack.cell());
        const double thickness = drop.amount * weight(drop, span.distance) * patches(drop, middle) / stack.unit();
        const std::span<Pocket> pockets = grid.column(c.x, c.y);
        double air = 0.0;
        for (std::size_t k = 0; k < pockets.size(); ++k) air += air_between(pockets, k, low, high);
        if (!(air > 0.0)) continue;
        // Shares are measured before any of them is laid down.
        std::vector<double> shares;
        for (std::size_t k = 0; k < pockets.size(); ++k) shares.push_back(air_between(pockets, k, low, high) / air);
        for (std::size_t k = 0; k < pockets.size(); ++k) {
            const auto units = static_cast<std::int32_t>(std::lround(std::min(thickness * shares[k], 2.0 * MaterialStack::max_top)));
            if (k + 1 == pockets.size() && units > pockets[k].room()) {
                throw edit.problem("amount", "the deposit rises over what the stack can hold",
                                   fmt::format("at most {:.6g} m at column ({}, {})", pockets[k].room() * stack.unit(), c.x, c.y),
                                   fmt::format("{:.6g} m", units * stack.unit()));
            }
            std::int16_t& loose = pockets[k].loose[drop.kind];
            loose = static_cast<std::int16_t>(loose + std::min(units, pockets[k].room()));
            if (units > 0) grid.touch(c.x, c.y);
        }
    }
    return grid.write();
}

}  // namespace

EditTool deposit_tool()
{
    Schema schema{"deposit", "Strews sand, soil, rock or water over what lies in or below a region, in caves too.", region_parameters()};
    const std::vector<Parameter> own = {
        {.name = "material",
         .type = ParameterType::choice,
         .doc = "What is strewn.",
         .fallback = std::string("sand"),
         .choices = {"sand", "soil", "rock", "water"}},
        {.name = "amount",
         .type = ParameterType::length,
         .doc = "Thickness under the region's middle line.",
         .required = true,
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
        {.name = "distribution",
         .type = ParameterType::choice,
         .doc = "How the thickness falls off towards the region's edge.",
         .fallback = std::string("smooth"),
         .choices = {"smooth", "even", "cone"}},
        {.name = "patchiness",
         .type = ParameterType::number,
         .doc = "How much of it noise takes away in places.",
         .fallback = 0.0,
         .minimum = 0,
         .maximum = 1},
        {.name = "patch_size",
         .type = ParameterType::length,
         .doc = "Wavelength of that noise; 8 cells by default.",
         .unit = "m",
         .minimum = 0,
         .above_minimum = true},
    };
    schema.parameters.insert(schema.parameters.end(), own.begin(), own.end());
    const auto apply = [](MaterialStack& stack, const Values& edit, const EditContext& context) {
        Dropping drop{region_of(stack, edit, context.seed), 0, edit.number("amount"), edit.text("distribution"), edit.number("patchiness"), 0.0, 0};
        const Material material = material_from_name(edit.text("material"));
        while (kLooseOrder[drop.kind] != material) ++drop.kind;
        drop.patch_size = edit.has("patch_size") ? edit.number("patch_size") : 8.0 * stack.cell();
        drop.seed = static_cast<std::uint32_t>(context.seed >> 32);
        return drop_on(stack, drop, edit);
    };
    return {std::move(schema), apply};
}

}  // namespace hoodoo
