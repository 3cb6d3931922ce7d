#include "tests/support/edit_laws.h"

#include "tests/edits.h"

#include "terrain/math/hash.h"

#include <fmt/format.h>

namespace hoodoo::testing
{

bool at_rest(const MaterialStack& stack, const Repose& repose, std::string* why)
{
    struct Gap {
        int floor, ceiling, content;
        std::array<int, 4> tops;
    };
    const auto gaps_of = [&](int i, int j) {
        std::vector<Gap> gaps = {{0, MaterialStack::max_top, 0, {}}};
        int below = 0;
        for (const Layer& layer : stack.column(i, j)) {
            Gap& gap = gaps.back();
            if (layer.material == Material::bedrock) {
                gap.ceiling = below;
                if (gap.ceiling == gap.floor) gaps.pop_back();
                gaps.push_back({layer.top, MaterialStack::max_top, 0, {layer.top, layer.top, layer.top, layer.top}});
            } else if (layer.material != Material::air) {
                gap.content += layer.top - below;
                const std::size_t kind = layer.material == Material::sand   ? 0
                                         : layer.material == Material::soil ? 1
                                         : layer.material == Material::rock ? 2
                                                                            : 3;
                for (std::size_t k = 0; k < 4; ++k) gap.tops[k] = k < kind ? gap.tops[k] : layer.top;
            }
            below = layer.top;
        }
        return gaps;
    };
    const std::array<double, 4> angles = {repose.sand, repose.soil, repose.rock, 0.0};
    const Vec2i n = stack.size();
    for (int j = 0; j < n.y; ++j) {
        for (int i = 0; i < n.x; ++i) {
            const auto here = gaps_of(i, j);
            for (int dj = -1; dj <= 1; ++dj) {
                for (int di = -1; di <= 1; ++di) {
                    if ((di == 0 && dj == 0) || i + di < 0 || j + dj < 0 || i + di >= n.x || j + dj >= n.y) continue;
                    for (const Gap& p : here) {
                        for (const Gap& q : gaps_of(i + di, j + dj)) {
                            for (std::size_t kind = 0; kind < 4; ++kind) {
                                const int bottom = kind == 0 ? p.floor : p.tops[kind - 1];
                                if (p.tops[kind] == bottom || q.ceiling - q.floor == q.content) continue;
                                const int high = std::min(p.tops[kind], q.ceiling), low = std::max(q.tops[kind], p.floor);
                                if (high <= low) continue;
                                bool open = di == 0 || dj == 0;
                                for (const Vec2i& beside : {Vec2i(i + di, j), Vec2i(i, j + dj)}) {
                                    for (const Gap& g : gaps_of(beside.x, beside.y))
                                        open = open || std::min(high, g.ceiling) > std::max(low, g.floor);
                                }
                                const double bears = std::hypot(di, dj) * stack.cell() * std::tan(angles[kind]) / stack.unit();
                                if (!open || high - q.tops[kind] <= bears + 1.0) continue;
                                if (why) *why = "column " + std::to_string(i) + ", " + std::to_string(j) + " kind " + std::to_string(kind);
                                return false;
                            }
                        }
                    }
                }
            }
        }
    }
    return true;
}

namespace
{

/// One random [[edit]], its tool first. Positions over the whole terrain and a little beyond.
std::pair<const char*, Node> random_edit(std::uint64_t seed, const MaterialStack& stack)
{
    int n = 0;
    const auto u = [&] { return unit_real(hash_cell(seed, ++n, 0)); };
    const Vec2d size = Vec2d(stack.size()) * stack.cell();
    const double top = stack.highest_top() * stack.unit();
    const auto point = [&] { return Item({(1.1 * u() - 0.05) * size.x, (1.1 * u() - 0.05) * size.y, 1.2 * u() * top}); };
    const auto radius = [&] { return (0.5 + 5.0 * u() * u()) * stack.cell(); };
    switch (hash_cell(seed, 0, 1) % 8) {
        case 0:
        case 1: {
            constexpr std::array materials = {"sand", "soil", "rock", "water"};
            const char* material = materials[static_cast<std::size_t>(4 * u())];
            return {
                "deposit",
                table({{"points", list({point()})}, {"radius", {radius()}}, {"amount", (0.05 + 4.0 * u()) * stack.cell()}, {"material", material}})};
        }
        case 2:
            return {"erode",
                    table({{"points", list({point(), point()})}, {"radius", {radius()}}, {"eta", u()}, {"rho", u()}, {"roughness", 0.5 * u()}})};
        case 3:
            return {"erode", table({{"points", list({point()})},
                                    {"region", "box"},
                                    {"half_size", {radius(), radius(), radius()}},
                                    {"heading_deg", 90.0 * u()},
                                    {"strategy", "surface"},
                                    {"depth", 0.5 * u() + 0.01}})};
        case 4:
            return {"sweep", table({{"points", list({point(), point()})}, {"radius", {radius()}}})};
        case 5:
            return {"sculpt", table({{"target", point()}, {"radius", radius() + stack.cell()}})};
        case 6:
            return {"fill", table({{"seed", point()}})};
        default:
            return {"stabilise", table({{"centre", {u() * size.x, u() * size.y}}, {"radius", radius()}})};
    }
}

Node quiet(const Node& entries)
{
    Node copy = entries;
    std::get<Node::Table>(copy.value).emplace_back("stabilise", flag(false));
    return copy;
}

}  // namespace

Verdict edits_keep_their_promises(const MaterialStack& begin, const EditRunner& run, std::uint64_t seed, int count, int rests)
{
    MaterialStack stack = begin;
    int done = 0;
    for (int n = 0; n < count; ++n) {
        const auto [tool, entries] = random_edit(hash_cell(seed, n, 7), stack);
        const auto fault = [&, t = tool](const std::string& what) { return Verdict{fmt::format("edit {} ({}): {}", n, t, what)}; };
        const MaterialStack before = stack;
        MaterialStack raw = stack;
        try {
            const ColumnSet named = run(raw, tool, quiet(entries), static_cast<std::size_t>(n));
            const ColumnSet changed = run(stack, tool, entries, static_cast<std::size_t>(n));
            for (int j = 0; j < stack.size().y; ++j) {
                for (int i = 0; i < stack.size().x; ++i) {
                    if (!named.contains(i, j) && !std::ranges::equal(raw.words(i, j), before.words(i, j)))
                        return fault("a column changed outside the region");
                    if (!changed.contains(i, j) && !std::ranges::equal(stack.words(i, j), before.words(i, j)))
                        return fault("a column changed unnamed");
                }
            }
        } catch (const Error&) {
            if (!same(stack, before)) return fault("refused, and yet something changed");
            continue;
        }
        ++done;
        // Stabilising moves, it neither makes nor takes; and of the tools, each makes only what it says.
        const auto was = masses(before), rough = masses(raw), now = masses(stack);
        if (now != rough) return fault("stabilising made or took something");
        if (std::string(tool) == "stabilise" && now != was) return fault("mass");
        if (std::string(tool) == "erode") {
            const auto solid = [](const auto& m) {
                return m[std::size_t(Material::sand)] + m[std::size_t(Material::bedrock)] + m[std::size_t(Material::rock)];
            };
            if (solid(now) != solid(was) || now[std::size_t(Material::soil)] != was[std::size_t(Material::soil)])
                return fault("erosion made or took something");
        }
        if (std::string(tool) == "deposit") {
            int grown = 0;
            for (std::size_t m = 0; m < kMaterialCount; ++m) {
                if (now[m] < was[m]) return fault("a deposit took something");
                grown += now[m] > was[m];
            }
            if (grown > 1) return fault("a deposit made two materials");
        }
        std::string why;
        if (n % rests == 0 && !at_rest(stack, {}, &why)) return fault("does not rest: " + why);
    }
    if (done * 2 < count) return {fmt::format("only {} of {} edits did anything", done, count)};
    return {};
}

}  // namespace hoodoo::testing
