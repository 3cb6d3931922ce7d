// Material slides from pocket to pocket, column by column, until every slope bears what lies on it; only columns near a change are looked at.
// Peytavie2009, section 3.4, with the pockets of caves linked as they leave open: an opening between two pockets counts from the target's surface to
// the source's, cut by the target's ceiling (head(), pockets.h); across a corner only if one of the two columns beside it is open at that height.
// Each material in its turn, from the bottom up: sand moves as if nothing lay on it and carries what lies there; then soil, rock, water.
// Order: a queue of columns in nine colours, (i mod 3, j mod 3). A move touches the eight neighbours and no more, so that the moves of one colour do
// not see one another: any order, or any number of threads, gives the same result. A move queues the 3 x 3 columns around it: what slides into or out
// of a pocket depends on its own column and its neighbours alone. Termination: a move of one material lowers that material's energy (slide.cpp) and
// leaves the energies of those below it alone, because their tops do not depend on it. So the energies of sand, soil, rock and water, read as one
// word, fall lexicographically with each move. They are integers and not negative: the word can fall only finitely often. Nothing else moves
// material, so it ends, and at its end nothing slides. Heads are whole units, so a slope rests at the whole number of units nearest to d tan(alpha),
// not always below it: a coarse unit does not flatten. Border: nothing leaves the grid. Missing: grains that jam; water under pressure (a full pocket
// takes and gives nothing upwards).
#include "terrain/edit/stabilise.h"

#include "terrain/edit/pockets.h"
#include "terrain/edit/region.h"
#include "terrain/edit/rows.h"
#include "terrain/edit/slide.h"
#include "terrain/error.h"

#include <fmt/format.h>

#include <cmath>

namespace hoodoo
{

namespace
{

constexpr std::size_t kKinds = kLooseOrder.size();
constexpr std::array<Vec2i, 8> neighbours()
{
    return {Vec2i(1, 0), Vec2i(0, 1), Vec2i(-1, 0), Vec2i(0, -1), Vec2i(1, 1), Vec2i(-1, 1), Vec2i(-1, -1), Vec2i(1, -1)};
}

class Stabilisation
{
public:
    Stabilisation(MaterialStack& stack, const Repose& repose) : grid_(stack)
    {
        const std::array<double, kKinds> angles = {repose.sand, repose.soil, repose.rock, 0.0};
        for (std::size_t k = 0; k < kKinds; ++k) {
            if (!(angles[k] >= 0.0 && angles[k] < M_PI / 2)) {
                throw Error(ErrorKind::scene, Problem{{}, "angle of repose", "0 or more, below 90 degrees", fmt::to_string(angles[k]), {}});
            }
            const double bearable = stack.cell() * std::tan(angles[k]) / stack.unit();
            threshold_[k] = {std::round(bearable), std::round(M_SQRT2 * bearable)};
        }
    }

    ColumnSet run(const ColumnSet& touched)
    {
        for (const std::uint32_t index : touched.indices()) {
            const Vec2i c = touched.column(index);
            grid_.touch(c.x, c.y);
            for (std::size_t kind = 0; kind < kKinds; ++kind) queue_around(c, kind);
        }
        for (bool moved = true; moved;) {
            moved = false;
            for (std::size_t kind = 0; kind < kKinds; ++kind) moved = pass(kind) || moved;
        }
        return grid_.write();
    }

private:
    using Queue = std::array<std::vector<Vec2i>, 9>;

    void queue(int i, int j, std::size_t kind)
    {
        std::uint8_t& flags = grid_.flags(i, j);
        const auto bit = static_cast<std::uint8_t>(1u << kind);
        if (flags & bit) return;
        flags = static_cast<std::uint8_t>(flags | bit);
        queues_[kind][static_cast<std::size_t>(j % 3 * 3 + i % 3)].push_back({i, j});
    }

    void queue_around(const Vec2i& c, std::size_t kind)
    {
        for (int j = std::max(c.y - 1, 0); j <= std::min(c.y + 1, grid_.stack().size().y - 1); ++j) {
            for (int i = std::max(c.x - 1, 0); i <= std::min(c.x + 1, grid_.stack().size().x - 1); ++i) queue(i, j, kind);
        }
    }

    /// Moves one material until it rests; returns whether it moved at all.
    bool pass(std::size_t kind)
    {
        std::vector<Vec2i> work, moved;
        constexpr std::uint8_t moved_bit = 1u << kKinds;
        for (std::size_t idle = 0, colour = 0; idle < 9; colour = (colour + 1) % 9) {
            work.clear();
            work.swap(queues_[kind][colour]);
            idle = work.empty() ? idle + 1 : 0;
            for (const Vec2i& c : work) {
                std::uint8_t& flags = grid_.flags(c.x, c.y);
                flags = static_cast<std::uint8_t>(flags & ~(1u << kind));
                if (!relax(c, kind)) continue;
                queue_around(c, kind);
                if (!(flags & moved_bit)) moved.push_back(c);
                flags |= moved_bit;
            }
        }
        for (const Vec2i& c : moved) {
            grid_.flags(c.x, c.y) &= static_cast<std::uint8_t>(~moved_bit);
            for (std::size_t other = 0; other < kKinds; ++other) {
                if (other != kind) queue_around(c, other);
            }
        }
        return !moved.empty();
    }

    bool relax(const Vec2i& c, std::size_t kind)
    {
        bool moved = false;
        for (Pocket& pocket : grid_.column(c.x, c.y)) {
            if (pocket.loose[kind] > 0) moved = slide(c, pocket, kind) || moved;
        }
        return moved;
    }

    bool slide(const Vec2i& c, Pocket& from, std::size_t kind)
    {
        targets_.clear();
        places_.clear();
        constexpr std::array<Vec2i, 8> steps = neighbours();
        for (std::size_t n = 0; n < steps.size(); ++n) {
            const Vec2i d = steps[n], to = c + d;
            if (!grid_.inside(to.x, to.y)) continue;
            const bool diagonal = n >= 4;
            for (Pocket& pocket : grid_.column(to.x, to.y)) {
                const std::optional<std::int32_t> h = head(from, pocket, kind);
                if (!h) continue;
                const Target target{*h, pocket.room(), threshold_[kind][diagonal]};
                if (!slides(target) || (diagonal && !open_corner(c, d, from, pocket, kind))) continue;
                targets_.push_back(target);
                places_.push_back({&pocket, to});
            }
        }
        if (targets_.empty()) return false;
        const std::int32_t sum = share_out(targets_, from.loose[kind]);
        from.loose[kind] = static_cast<std::int16_t>(from.loose[kind] - sum);
        grid_.touch(c.x, c.y);
        for (std::size_t t = 0; t < targets_.size(); ++t) {
            if (targets_[t].share == 0) continue;
            std::int16_t& loose = places_[t].pocket->loose[kind];
            loose = static_cast<std::int16_t>(loose + targets_[t].share);
            grid_.touch(places_[t].column.x, places_[t].column.y);
        }
        return true;
    }

    bool open_corner(const Vec2i& c, const Vec2i& d, const Pocket& from, const Pocket& to, std::size_t kind)
    {
        const std::int32_t low = std::max<std::int32_t>(to.top(kind), from.floor), high = std::min<std::int32_t>(from.top(kind), to.ceiling);
        const auto open = [&](int i, int j) {
            for (const Pocket& pocket : grid_.column(i, j)) {
                if (pocket.floor < high && pocket.ceiling > low) return true;
            }
            return false;
        };
        return open(c.x + d.x, c.y) || open(c.x, c.y + d.y);
    }

    struct Place {
        Pocket* pocket;
        Vec2i column;
    };

    PocketGrid grid_;
    std::array<std::array<double, 2>, kKinds> threshold_;  ///< units; axial, diagonal
    std::array<Queue, kKinds> queues_;
    std::vector<Target> targets_;
    std::vector<Place> places_;
};

}  // namespace

ColumnSet stabilise(MaterialStack& stack, const ColumnSet& touched, const Repose& repose)
{
    return Stabilisation(stack, repose).run(touched);
}

namespace
{

/// Columns whose middle lies within `radius` of `centre` (world).
ColumnSet columns_around(const MaterialStack& stack, const Vec2d& centre, double radius)
{
    ColumnSet grid(stack.size());
    std::vector<std::uint32_t> found;
    const Vec2d c = (centre - Vec2d(stack.origin().x, stack.origin().y)) / stack.cell();
    const double r = radius / stack.cell();
    const auto bound = [](double x, int n) { return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(n))); };
    for (int j = bound(c.y - r, stack.size().y); j < bound(c.y + r + 1.0, stack.size().y); ++j) {
        for (int i = bound(c.x - r, stack.size().x); i < bound(c.x + r + 1.0, stack.size().x); ++i) {
            if ((Vec2d(i + 0.5, j + 0.5) - c).length2() <= r * r) found.push_back(grid.index(i, j));
        }
    }
    return {stack.size(), std::move(found)};
}

}  // namespace

EditTool stabilise_tool()
{
    Schema schema{"stabilise", "Lets loose material come to rest: everywhere, or in a circle and where it slides from there.", {}};
    schema.parameters = {
        {.name = "centre", .type = ParameterType::vector, .doc = "Middle of the circle.", .unit = "m", .min_count = 2, .max_count = 2},
        {.name = "radius", .type = ParameterType::length, .doc = "Of the circle.", .unit = "m", .minimum = 0, .above_minimum = true},
    };
    for (const char* material : {"sand", "soil", "rock"}) {
        schema.parameters.push_back({.name = std::string("repose_") + material,
                                     .type = ParameterType::angle,
                                     .doc = std::string("Angle of repose of ") + material + "; the terrain's by default.",
                                     .unit = "rad",
                                     .minimum = 0,
                                     .maximum = 1.55});
    }
    const auto apply = [](MaterialStack& stack, const Values& edit, const EditContext& context) {
        Repose repose = context.repose;
        if (edit.has("repose_sand")) repose.sand = edit.number("repose_sand");
        if (edit.has("repose_soil")) repose.soil = edit.number("repose_soil");
        if (edit.has("repose_rock")) repose.rock = edit.number("repose_rock");
        if (edit.has("centre") != edit.has("radius")) {
            const bool centre = edit.has("centre");
            throw edit.problem(centre ? "centre" : "radius", centre ? "a circle without a radius" : "a circle without a centre", "both or neither");
        }
        const Vec2d size = Vec2d(stack.size()) * stack.cell(), origin(stack.origin().x, stack.origin().y);
        const bool all = !edit.has("centre");
        const ColumnSet region =
            all ? columns_around(stack, origin + size / 2.0, size.length()) : columns_around(stack, edit.vec2("centre"), edit.number("radius"));
        if (region.empty()) throw outside_the_terrain(stack, edit, "centre");
        return stabilise(stack, region, repose);
    };
    return {std::move(schema), apply, true};
}

}  // namespace hoodoo
