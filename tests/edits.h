// Edits as a scene writes them, and what tests ask of a stack before and after.
#pragma once

#include "terrain/edit/tools.h"
#include "tests/tables.h"

#include <algorithm>
#include <string>

namespace hoodoo::testing
{

/// Applies one [[edit]] table, written without its `tool`. Throws what the scene reader would.
inline ColumnSet edit(MaterialStack& stack, const char* tool, const Node& entries, std::size_t number = 0, EditContext context = {})
{
    return apply_edit(stack, std::string(tool), entries, 1, number, std::move(context));
}

template <class Work>
std::string error_of(Work&& work)
{
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

/// All columns alike.
inline MaterialStack even_stack(Vec2i size, double cell, double unit, const std::vector<Layer>& column)
{
    MaterialStack stack(size, cell, unit);
    stack.set_columns({0, 0}, size, std::vector<std::vector<Layer>>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), column));
    return stack;
}

inline ColumnSet everywhere(const MaterialStack& stack)
{
    std::vector<std::uint32_t> all(static_cast<std::size_t>(stack.size().x) * static_cast<std::size_t>(stack.size().y));
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<std::uint32_t>(k);
    return {stack.size(), std::move(all)};
}

/// Units above the stack's origin.
inline std::int32_t top_of(const MaterialStack& stack, int i, int j)
{
    const auto words = stack.words(i, j);
    return words.empty() ? 0 : MaterialStack::top_of(words.back());
}

/// Sum of each material over all columns, units.
inline std::array<std::int64_t, kMaterialCount> masses(const MaterialStack& stack)
{
    std::array<std::int64_t, kMaterialCount> sums{};
    for (int j = 0; j < stack.size().y; ++j) {
        for (int i = 0; i < stack.size().x; ++i) {
            std::int32_t below = 0;
            for (const std::uint16_t word : stack.words(i, j)) {
                sums[static_cast<std::size_t>(MaterialStack::material_of(word))] += MaterialStack::top_of(word) - below;
                below = MaterialStack::top_of(word);
            }
        }
    }
    sums[static_cast<std::size_t>(Material::air)] = 0;
    return sums;
}

inline bool same(const MaterialStack& a, const MaterialStack& b)
{
    for (int j = 0; j < a.size().y; ++j) {
        for (int i = 0; i < a.size().x; ++i) {
            if (!std::ranges::equal(a.words(i, j), b.words(i, j))) return false;
        }
    }
    return true;
}

}  // namespace hoodoo::testing
