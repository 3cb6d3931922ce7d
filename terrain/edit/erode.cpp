// Bedrock inside a region turns into sand and rock where it is; what follows is the stabilisation's affair: it falls, runs out, and piles up.
// Peytavie2009, section 4.4. The paper's parameters rho (share of rock) and sigma, which it does not define: here eta, the fraction that is eroded.
//   surface: a layer of `depth` at every top and underside of bedrock that lies in the region becomes sand;
//   volume:  the fraction eta of each piece of bedrock cut out by the region becomes rock (share rho) and sand, from its top if that is bare,
//            else from its bottom: an overhang crumbles from below, and a piece inside a wall leaves a niche from which its rubble runs.
// Volume is conserved to the unit: what is taken from a column's bedrock is put there as loose material. Everything happens in place, since merging
// moves what lies above a pocket's floor down to it. Deviations: sides of cliffs are no surface to the first strategy, as in the paper's text; the
// second takes them. Missing: joints and strata that decide what breaks; transport by water.
#include "terrain/edit/region.h"
#include "terrain/edit/rows.h"

#include <fmt/format.h>

namespace hoodoo
{

namespace
{

struct Erosion {
    bool volume;
    std::int32_t depth;  ///< surface: units
    double eta, rho;     ///< volume
};

/// The loose pieces that one column's bedrock turns into: disjoint, from the bottom up.
struct Piece {
    std::int32_t bottom, rock_from, top;  ///< sand below `rock_from`, rock above
};

/// A layer of bedrock and the part of it within the region, units.
struct Cut {
    std::int32_t bottom, top, low, high;
    bool bare_below;  ///< whether it has an underside: not the lowest layer of its column
};

void erode_surface(const Cut& cut, const Erosion& erosion, std::vector<Piece>& pieces)
{
    std::int32_t high = cut.top;
    if (cut.high == cut.top) high -= std::min(erosion.depth, cut.high - cut.low);
    const std::int32_t low =
        cut.bare_below && cut.low == cut.bottom ? std::min(cut.bottom + std::min(erosion.depth, cut.high - cut.low), high) : cut.bottom;
    if (low > cut.bottom) pieces.push_back({cut.bottom, low, low});
    if (high < cut.top) pieces.push_back({high, cut.top, cut.top});
}

void erode_volume(const Cut& cut, const Erosion& erosion, std::vector<Piece>& pieces)
{
    const auto eroded = static_cast<std::int32_t>(std::lround(erosion.eta * (cut.high - cut.low)));
    const std::int32_t bottom = cut.high == cut.top ? cut.high - eroded : cut.low;
    if (eroded > 0) pieces.push_back({bottom, bottom + eroded - static_cast<std::int32_t>(std::lround(erosion.rho * eroded)), bottom + eroded});
}

/// `spans`: of this column, units, disjoint, from the bottom up.
std::vector<Layer> eroded(std::span<const Layer> layers, std::span<const Run> spans, const Erosion& erosion)
{
    std::vector<Layer> result;
    std::vector<Piece> pieces;
    const auto put = [&](Material material, std::int32_t top) {
        if (top > (result.empty() ? 0 : result.back().top)) result.push_back({material, top});
    };
    std::int32_t below = 0;
    for (const Layer& layer : layers) {
        pieces.clear();
        for (const Run& span : spans) {
            const Cut cut{below, layer.top, std::max(span.bottom, below), std::min(span.top, layer.top), below > 0};
            if (layer.material != Material::bedrock || cut.low >= cut.high) continue;
            erosion.volume ? erode_volume(cut, erosion, pieces) : erode_surface(cut, erosion, pieces);
        }
        for (const Piece& piece : pieces) {
            put(Material::bedrock, piece.bottom);
            put(Material::sand, piece.rock_from);
            put(Material::rock, piece.top);
        }
        put(layer.material, layer.top);
        below = layer.top;
    }
    return result;
}

ColumnSet erode(MaterialStack& stack, const Region& region, const Erosion& erosion, const Values& edit)
{
    const std::vector<ColumnSpan> spans = column_spans(stack, region);
    if (spans.empty()) throw outside_the_terrain(stack, edit, "points");
    Vec2i from = stack.size(), to(0, 0);
    for (const ColumnSpan& span : spans) {
        from = Vec2i(std::min(from.x, span.column.x), std::min(from.y, span.column.y));
        to = Vec2i(std::max(to.x, span.column.x + 1), std::max(to.y, span.column.y + 1));
    }
    std::vector<std::vector<Layer>> columns;
    std::vector<std::uint32_t> changed;
    std::vector<Run> runs;
    std::size_t s = 0;
    for (int j = from.y; j < to.y; ++j) {
        for (int i = from.x; i < to.x; ++i) {
            runs.clear();
            for (; s < spans.size() && spans[s].column == Vec2i(i, j); ++s) {
                const auto units = [&](double z) {
                    return static_cast<std::int32_t>(
                        std::lround(std::clamp((z - stack.origin().z) / stack.unit(), 0.0, double(MaterialStack::max_top))));
                };
                runs.push_back({units(spans[s].low), units(spans[s].high)});
            }
            std::vector<Layer>& column = columns.emplace_back(stack.column(i, j));
            if (runs.empty()) continue;
            std::vector<Layer> after = eroded(column, runs, erosion);
            if (after == column) continue;
            column = std::move(after);
            changed.push_back(ColumnSet(stack.size()).index(i, j));
        }
    }
    stack.set_columns(from, to, columns);
    return {stack.size(), std::move(changed)};
}

}  // namespace

EditTool erode_tool()
{
    Schema schema{"erode", "Turns bedrock in a region into sand and rock, which then fall and pile up.", region_parameters()};
    const std::vector<Parameter> own = {
        {.name = "strategy",
         .type = ParameterType::choice,
         .doc = "surface: a layer becomes sand; volume: a fraction of all that the region cuts becomes sand and rock.",
         .fallback = std::string("volume"),
         .choices = {"surface", "volume"}},
        {.name = "depth", .type = ParameterType::length, .doc = "surface: thickness of the layer.", .unit = "m", .minimum = 0, .above_minimum = true},
        {.name = "eta", .type = ParameterType::number, .doc = "volume: fraction that is eroded; 1 by default.", .minimum = 0, .maximum = 1},
        {.name = "rho",
         .type = ParameterType::number,
         .doc = "volume: share of rock in it, the rest is sand; 0.5 by default.",
         .minimum = 0,
         .maximum = 1},
    };
    schema.parameters.insert(schema.parameters.end(), own.begin(), own.end());
    const auto apply = [](MaterialStack& stack, const Values& edit, const EditContext& context) {
        Erosion erosion{edit.text("strategy") == "volume", 0, 1.0, 0.5};
        for (const char* key : {"eta", "rho"}) {
            if (!erosion.volume && edit.has(key))
                throw edit.problem(key, "erosion of the surface", fmt::format("no `{}`: all of it becomes sand", key));
        }
        if (erosion.volume == edit.has("depth")) {
            throw edit.problem("depth", erosion.volume ? "erosion of a volume" : "erosion of the surface",
                               erosion.volume ? "no `depth`, but `eta`" : "the `depth` of the layer");
        }
        if (edit.has("eta")) erosion.eta = edit.number("eta");
        if (edit.has("rho")) erosion.rho = edit.number("rho");
        if (edit.has("depth")) erosion.depth = static_cast<std::int32_t>(std::lround(std::min(edit.number("depth") / stack.unit(), 8191.0)));
        return erode(stack, region_of(stack, edit, context.seed), erosion, edit);
    };
    return {std::move(schema), apply};
}

}  // namespace hoodoo
