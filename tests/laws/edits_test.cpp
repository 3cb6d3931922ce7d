// A thousand random edits, and three ways to do them wrong that the law must see.
#include "tests/counts.h"
#include "tests/edits.h"
#include "tests/stacks.h"
#include "tests/support/edit_laws.h"

#include <gtest/gtest.h>

namespace hoodoo
{
namespace
{

using namespace hoodoo::testing;

MaterialStack resting_stack()
{
    MaterialStack stack = *random_stack(3, {40, 36}, 1.0, 0.02, 700);
    stabilise(stack, everywhere(stack));
    return stack;
}

ColumnSet well(MaterialStack& stack, const char* tool, const Node& entries, std::size_t number)
{
    return edit(stack, tool, entries, number);
}

TEST(Edits, a_thousand_keep_their_promises)
{
    const Verdict v = edits_keep_their_promises(resting_stack(), well, 1, count(300, 1000), count(15, 10));
    EXPECT_TRUE(v.holds()) << v.fault;
}

TEST(Edits, the_law_sees_a_lost_unit_a_forgotten_column_and_a_slope_left_alone)
{
    const EditRunner loses = [](MaterialStack& stack, const char* tool, const Node& entries, std::size_t number) {
        ColumnSet changed = edit(stack, tool, entries, number);
        const bool settles = std::ranges::none_of(std::get<Node::Table>(entries.value), [](const auto& e) { return e.first == "stabilise"; });
        if (changed.empty() || !settles) return changed;
        const Vec2i c = changed.column(changed.indices().front());
        std::vector<Layer> column = stack.column(c.x, c.y);
        if (!column.empty() && column.back().material != Material::bedrock) --column.back().top;
        if (!column.empty()) stack.set_column(c.x, c.y, column);
        return changed;
    };
    EXPECT_FALSE(edits_keep_their_promises(resting_stack(), loses, 1, 60, 1000).holds());
    const EditRunner forgets = [](MaterialStack& stack, const char* tool, const Node& entries, std::size_t number) {
        const ColumnSet changed = edit(stack, tool, entries, number);
        std::vector<std::uint32_t> but_one = changed.indices();
        if (!but_one.empty()) but_one.pop_back();
        return ColumnSet(changed.size(), std::move(but_one));
    };
    EXPECT_FALSE(edits_keep_their_promises(resting_stack(), forgets, 1, 60, 1000).holds());
    const EditRunner leaves = [](MaterialStack& stack, const char* tool, const Node& entries, std::size_t number) {
        Node quiet = entries;
        std::erase_if(std::get<Node::Table>(quiet.value), [](const auto& e) { return e.first == "stabilise"; });
        std::get<Node::Table>(quiet.value).emplace_back("stabilise", flag(false));
        return edit(stack, tool, quiet, number);
    };
    EXPECT_FALSE(edits_keep_their_promises(resting_stack(), leaves, 1, 60, 5).holds());
}

}  // namespace
}  // namespace hoodoo
