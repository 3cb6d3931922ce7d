// Stabilisation against the golden values, against geometry (piles, slopes), and against its promises: mass, rest, bits outside.
#include "terrain/edit/stabilise.h"

#include "terrain/edit/pockets.h"
#include "terrain/edit/slide.h"
#include "terrain/error.h"
#include "tests/counts.h"
#include "tests/edits.h"
#include "tests/stacks.h"
#include "tests/support/edit_laws.h"

#include <gtest/gtest.h>

#include <set>

namespace hoodoo
{
namespace
{

using enum Material;
using testing::at_rest;
using testing::even_stack;
using testing::everywhere;
using testing::masses;
using testing::same;
using testing::top_of;
using Column = std::vector<Layer>;
constexpr double kDegree = M_PI / 180.0;

TEST(Slide, shares_are_proportional_to_the_excess_as_in_the_golden_step)
{
    // A peak one unit of length over its neighbours, alpha = 35 degrees, s = 1; in steps of 1e-6 the head is a million. The golden step hands out a =
    // 0.05 in proportion to the excess: so each neighbour's part of what is handed out must be dz / a.
    const auto golden = testing::golden_arches()["stabilise_step"];
    constexpr std::int32_t scale = 1000000;
    const double t = std::tan(golden["alpha"].get<double>() * kDegree) * scale;
    std::vector<Target> targets;
    std::vector<double> excess, part;
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (i == 1 && j == 1) continue;
            targets.push_back({scale, scale, i != 1 && j != 1 ? M_SQRT2 * t : t});
            excess.push_back(golden["excess"][j][i]);
            part.push_back(golden["dz"][j][i].get<double>() / golden["a"].get<double>());
        }
    }
    const double sum = share_out(targets, scale);
    for (std::size_t n = 0; n < targets.size(); ++n) {
        EXPECT_NEAR(targets[n].head - targets[n].threshold, excess[n] * scale, 1e-3);
        EXPECT_NEAR(targets[n].share / sum, part[n], 2e-5);
    }
}

TEST(Slide, lowers_the_energy_and_moves_something_whatever_the_numbers)
{
    // Twice the energy of the layers: sum of squared tops. `h` is the source's surface; targets stand head below it or, where a ceiling cuts the
    // head, lower.
    for (std::uint64_t n = 0; n < 20000; ++n) {
        std::uint64_t bits = hash_combine(7, n);
        const auto draw = [&](std::int64_t low, std::int64_t high) {
            bits = mix64(bits);
            return low + static_cast<std::int64_t>(bits % static_cast<std::uint64_t>(high - low + 1));
        };
        const std::int64_t h = 8000, range = draw(0, 3) == 0 ? 7000 : 8;
        std::vector<Target> targets;
        std::vector<std::int64_t> surfaces;
        for (std::int64_t k = draw(1, 8); k > 0; --k) {
            const auto head = static_cast<std::int32_t>(draw(2, range));
            const Target target{head, static_cast<std::int32_t>(draw(1, 900)), unit_real(mix64(bits)) * head * 0.999};
            ASSERT_TRUE(slides(target));
            targets.push_back(target);
            surfaces.push_back(h - head - draw(0, 50));
        }
        const auto thickness = static_cast<std::int32_t>(draw(1, draw(0, 1) ? 3 : 2000));
        const std::int64_t q = share_out(targets, thickness);
        std::int64_t sum = 0, change = (h - q) * (h - q) - h * h;
        for (std::size_t k = 0; k < targets.size(); ++k) {
            const std::int64_t s = targets[k].share, top = surfaces[k] + s;
            ASSERT_GE(s, 0);
            ASSERT_LE(s, targets[k].room);
            sum += s;
            change += top * top - surfaces[k] * surfaces[k];
        }
        ASSERT_EQ(sum, q);
        ASSERT_GE(q, 1);
        ASSERT_LE(q, thickness);
        ASSERT_LT(change, 0);
    }
}

TEST(Pockets, are_linked_as_the_brute_force_says)
{
    const auto golden = nlohmann::json::parse(std::ifstream(HOODOO_SOURCE_DIR "/tests/golden/a_pockets.json"));
    constexpr double unit = 0.01;  // heights of the file are multiples of 0.1
    std::size_t links = 0;
    for (const auto& c : golden["cases"]) {
        MaterialStack stack({2, 1}, 1.0, unit);
        for (int i = 0; i < 2; ++i) {
            Column column;
            for (const auto& layer : c[i == 0 ? "A" : "B"])
                column.push_back({static_cast<Material>(layer[0].get<int>()), static_cast<std::int32_t>(std::lround(layer[1].get<double>() / unit))});
            stack.set_column(i, 0, column);
        }
        PocketGrid grid(stack);
        std::vector<std::array<double, 4>> found;  // floor of P, floor of Q, drop, capacity
        for (const Pocket& p : grid.column(0, 0)) {
            for (const Pocket& q : grid.column(1, 0)) {
                const auto drop = head(p, q, 2);
                if (drop && q.room() > 0) found.push_back({p.floor * unit, q.floor * unit, *drop * unit, q.room() * unit});
            }
        }
        ASSERT_EQ(found.size(), c["links"].size()) << c["name"];
        for (std::size_t k = 0; k < found.size(); ++k) {
            const auto& link = c["links"][k];
            EXPECT_NEAR(found[k][0], link["P"][0].get<double>(), 1e-9) << c["name"];
            EXPECT_NEAR(found[k][1], link["Q"][0].get<double>(), 1e-9) << c["name"];
            EXPECT_NEAR(found[k][2], link["drop"].get<double>(), 1e-9) << c["name"];
            if (!link["capacity"].is_null()) {
                EXPECT_NEAR(found[k][3], link["capacity"].get<double>(), 1e-9) << c["name"];
            }
            ++links;
        }
    }
    EXPECT_GE(links, 6u);
}

TEST(Pockets, give_back_every_column_they_were_made_from)
{
    const auto stack = testing::random_stack(5, {70, 40}, 1.0, 1.0, 300);
    MaterialStack copy = *stack;
    PocketGrid grid(copy);
    for (int j = 0; j < 40; ++j) {
        for (int i = 0; i < 70; ++i) {
            grid.column(i, j);
            grid.touch(i, j);
        }
    }
    const ColumnSet changed = grid.write();
    for (int j = 0; j < 40; ++j) {
        for (int i = 0; i < 70; ++i) {
            EXPECT_EQ(copy.column(i, j), merge_and_sort(stack->column(i, j)));
            EXPECT_EQ(changed.contains(i, j), copy.column(i, j) != stack->column(i, j));
        }
    }
}

/// A tower of sand in the middle of a plain of bedrock, `volume` units in as many full columns as it takes, come to rest.
MaterialStack pile(int n, double unit, std::int32_t volume, const Repose& repose = {}, Material material = sand)
{
    MaterialStack stack = even_stack({n, n}, 1.0, unit, {{bedrock, 10}});
    std::vector<std::uint32_t> touched;
    for (int r = 0; volume > 0; ++r) {
        for (int k = 0; k < (2 * r + 1) * (2 * r + 1) && volume > 0; ++k) {
            const int i = n / 2 + k % (2 * r + 1) - r, j = n / 2 + k / (2 * r + 1) - r;
            if (std::max(std::abs(i - n / 2), std::abs(j - n / 2)) != r) continue;
            const std::int32_t put = std::min(volume, 8000);
            stack.set_column(i, j, Column{{bedrock, 10}, {material, 10 + put}});
            touched.push_back(ColumnSet(stack.size()).index(i, j));
            volume -= put;
        }
    }
    stabilise(stack, {stack.size(), std::move(touched)}, repose);
    return stack;
}

/// A straight line fitted to the heights between 15% and 75% of the peak over their distance from the middle: its slope. Above, a pile of a few cells
/// is blunt; below, its last cell holds what was left.
double flank(const MaterialStack& stack)
{
    const int n = stack.size().x;
    const double peak = top_of(stack, n / 2, n / 2) - 10;
    double s1 = 0, sr = 0, sh = 0, srr = 0, srh = 0;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const double h = top_of(stack, i, j) - 10, r = std::hypot(i - n / 2, j - n / 2);
            if (h < 0.15 * peak || h > 0.75 * peak) continue;
            s1 += 1, sr += r, sh += h, srr += r * r, srh += r * h;
        }
    }
    return -(s1 * srh - sr * sh) / (s1 * srr - sr * sr) * stack.unit() / stack.cell();
}

TEST(Stabilise, a_pile_of_a_hundred_thousand_units_rests_as_a_cone_of_its_angle)
{
    // Piles of 10 to 24 cells' radius; a smaller one is mostly its blunt top and its last ring.
    for (const double unit : {0.05, 0.02, 0.01}) {
        EXPECT_NEAR(flank(pile(101, unit, 100000)) / std::tan(33 * kDegree), 1.0, 0.05) << unit;
        EXPECT_NEAR(flank(pile(101, unit, 100000, {}, rock)) / std::tan(42 * kDegree), 1.0, 0.05) << unit;
        EXPECT_NEAR(flank(pile(101, unit, 100000, {.sand = 25 * kDegree})) / std::tan(25 * kDegree), 1.0, 0.05) << unit;
    }
}

TEST(Stabilise, the_flank_of_a_pile_stands_at_its_angle_in_all_eight_directions)
{
    // From two cells beside the top, which is blunt, down to the last column with a lower neighbour of sand.
    const MaterialStack stack = pile(61, 0.005, 100000);
    for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
            if (di == 0 && dj == 0) continue;
            int k = 2;
            while (top_of(stack, 30 + (k + 2) * di, 30 + (k + 2) * dj) > 10) ++k;
            ASSERT_GE(k, 4);
            const double fall = top_of(stack, 30 + 2 * di, 30 + 2 * dj) - top_of(stack, 30 + k * di, 30 + k * dj);
            EXPECT_NEAR(fall * 0.005 / ((k - 2) * std::hypot(di, dj)) / std::tan(33 * kDegree), 1.0, 0.05) << di << " " << dj;
        }
    }
}

TEST(Stabilise, a_sand_slope_of_fifty_degrees_moves_and_one_of_thirty_two_does_not)
{
    for (const double angle : {50.0, 34.0, 32.0}) {
        MaterialStack stack({40, 12}, 0.5, 0.001);
        const double rise = 0.5 * std::tan(angle * kDegree) / 0.001;
        for (int j = 0; j < 12; ++j) {
            for (int i = 0; i < 40; ++i) {
                const std::int32_t h = static_cast<std::int32_t>(std::min(8000.0, 100 + (i > 10 ? (i - 10) * rise : 0.0)));
                stack.set_column(i, j, Column{{sand, h}});
            }
        }
        const MaterialStack before = stack;
        const ColumnSet changed = stabilise(stack, everywhere(stack));
        EXPECT_EQ(changed.empty(), angle < 33.0) << angle;
    }
}

TEST(Stabilise, random_stacks_come_to_rest_keep_their_mass_and_then_change_no_more)
{
    for (int n = 0; n < testing::count(12, 400); ++n) {
        const auto seed = static_cast<std::uint64_t>(n);
        MaterialStack stack = *testing::random_stack(seed, {37, 35}, 1.0, n % 2 ? 0.1 : 0.003, n % 3 ? 200 : 1500);
        // Rooms without a floor, and water everywhere.
        for (int k = 0; k < 150; ++k) {
            const std::uint64_t h = hash_cell(seed + 1000, n, k);
            const int i = static_cast<int>(h % 37), j = static_cast<int>(h / 37 % 35);
            Column column = stack.column(i, j);
            column.push_back({k % 3 ? water : rock, (column.empty() ? 0 : column.back().top) + static_cast<std::int32_t>(h / 5000 % 900)});
            stack.set_column(i, j, column);
        }
        const auto before = masses(stack);
        const Repose repose{.sand = (n % 5 ? 33 : 5) * kDegree, .rock = (n % 7 ? 42 : 60) * kDegree};
        EXPECT_FALSE(at_rest(stack, repose));  // the law can fail
        stabilise(stack, everywhere(stack), repose);
        EXPECT_EQ(masses(stack), before);
        std::string why;
        EXPECT_TRUE(at_rest(stack, repose, &why)) << why;
        const MaterialStack rested = stack;
        EXPECT_TRUE(stabilise(stack, everywhere(stack), repose).empty());
        EXPECT_TRUE(same(stack, rested));
    }
}

TEST(Stabilise, keeps_the_bits_of_every_column_that_it_does_not_name)
{
    for (std::uint64_t n = 0; n < 20; ++n) {
        MaterialStack stack = *testing::random_stack(n, {80, 70}, 1.0, 0.01, 300);
        const MaterialStack before = stack;
        std::vector<std::uint32_t> touched;
        for (std::uint64_t k = 0; k < 9; ++k) touched.push_back(static_cast<std::uint32_t>(hash_cell(n, 3, 0) % 5000 + k / 3 * 80 + k % 3));
        const ColumnSet changed = stabilise(stack, {stack.size(), touched});
        for (int j = 0; j < 70; ++j) {
            for (int i = 0; i < 80; ++i) {
                EXPECT_EQ(changed.contains(i, j), !std::ranges::equal(stack.words(i, j), before.words(i, j))) << i << " " << j;
            }
        }
        EXPECT_LT(changed.count(), 5600u);
    }
}

TEST(Stabilise, sand_runs_out_of_a_window_in_the_rock_and_not_through_a_corner)
{
    // A niche full of sand in the left column, from 20 to 40; on the right open ground at 10. It runs out until the window's sill bears the rest.
    const Column niche = {{bedrock, 20}, {sand, 40}, {bedrock, 60}};
    MaterialStack stack({2, 1}, 1.0, 0.1);  // sand bears 6.49 units: 6
    stack.set_columns({0, 0}, {2, 1}, std::vector<Column>{niche, {{bedrock, 10}}});
    stabilise(stack, everywhere(stack));
    EXPECT_EQ(stack.column(0, 0), (Column{{bedrock, 20}, {sand, 28}, {air, 40}, {bedrock, 60}}));
    EXPECT_EQ(stack.column(1, 0), (Column{{bedrock, 10}, {sand, 22}}));
    // Diagonally: the same two columns with rock beside them keep it in, with one open column beside them it runs.
    for (const bool open : {false, true}) {
        MaterialStack corner({2, 2}, 1.0, 0.1);
        const Column wall = {{bedrock, 60}}, gate = {{bedrock, 15}, {air, 45}, {bedrock, 60}};
        corner.set_columns({0, 0}, {2, 2}, std::vector<Column>{niche, wall, open ? gate : wall, {{bedrock, 10}}});
        stabilise(corner, everywhere(corner));
        EXPECT_EQ(corner.column(0, 0) == niche, !open);
    }
}

TEST(Stabilise, sand_creeps_under_the_rock_that_lies_on_it)
{
    // Sand 40 high under rock 10 thick; beside it nothing. The sand slides as if the rock were not there, the rock (within its angle) stays on top of
    // it.
    MaterialStack stack({3, 1}, 1.0, 0.1);
    stack.set_columns({0, 0}, {3, 1}, std::vector<Column>{{{bedrock, 10}}, {{bedrock, 10}, {sand, 50}, {rock, 53}}, {{bedrock, 10}}});
    stabilise(stack, everywhere(stack));
    EXPECT_EQ(masses(stack)[static_cast<std::size_t>(sand)], 40);
    EXPECT_EQ(stack.column(1, 0).back(), (Layer{rock, stack.column(1, 0)[1].top + 3}));
    EXPECT_LE(stack.column(1, 0)[1].top - stack.column(0, 0)[1].top, 6);
}

TEST(EditTools, have_names_of_their_own)
{
    std::set<std::string> names;
    for (const EditTool& tool : edit_tools()) EXPECT_TRUE(names.insert(tool.schema.name).second) << tool.schema.name;
}

TEST(Stabilise, refuses_an_angle_that_no_slope_has)
{
    MaterialStack stack({2, 2}, 1.0, 0.1);
    try {
        stabilise(stack, everywhere(stack), {.rock = 1.6});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()), "angle of repose, expected 0 or more, below 90 degrees, got 1.6");
    }
}

}  // namespace
}  // namespace hoodoo
