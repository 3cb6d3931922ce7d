// Law: what is baked, read and baked again is equal byte for byte, for stacks as rugged as stacks can be. Mutants: a reader that loses the air of a
// cave, one that is a step off in one column, one that rounds the origin to floats; each must fail.
#include "terrain/io/stack_file.h"

#include "tests/counts.h"
#include "tests/stacks.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

namespace hoodoo
{
namespace
{

using Stack = std::shared_ptr<MaterialStack>;

std::string baked(const MaterialStack& stack)
{
    const std::string path = (std::filesystem::temp_directory_path() / "hoodoo_law_of_stack_files.exr").string();
    write_stack_file(path, stack);
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

Stack read_again()
{
    const std::string path = (std::filesystem::temp_directory_path() / "hoodoo_law_of_stack_files.exr").string();
    const Stack stack = read_stack_file(path, {});
    std::filesystem::remove(path);
    return stack;
}

/// The first fault, or empty. `read` is the reader under test.
std::string round_trip_keeps_bytes(const std::function<Stack()>& read, int stacks)
{
    for (int k = 0; k < stacks; ++k) {
        const auto seed = static_cast<std::uint64_t>(k);
        const Vec2i size(1 + static_cast<int>(mix64(seed) % 80), 1 + static_cast<int>(mix64(seed + 1000) % 70));
        const Vec3d origin(unit_real(mix64(seed + 1)) * 1e6, -unit_real(mix64(seed + 2)), 1e-3 * k);
        const double cell = 0.1 + unit_real(mix64(seed + 3)), unit = cell * unit_real(mix64(seed + 4));
        const Stack stack = testing::random_stack(seed, size, cell, unit, 1 + static_cast<int>(mix64(seed + 5) % 6000), origin);
        const std::string bytes = baked(*stack);
        if (bytes != baked(*read())) return "stack " + std::to_string(k);
    }
    return {};
}

TEST(StackFileLaw, bake_read_bake_gives_equal_bytes)
{
    EXPECT_EQ(round_trip_keeps_bytes(read_again, testing::count(60, 1000)), "");
}

TEST(StackFileLaw, a_reader_that_forgets_air_fails)
{
    const auto mutant = [] {
        const Stack stack = read_again();
        for (int k = 0; k < stack->size().x * stack->size().y; ++k) {
            std::vector<Layer> column = stack->column(k % stack->size().x, k / stack->size().x);
            for (std::size_t n = 1; n < column.size(); ++n)
                if (column[n].material == Material::air) column[n].material = column[n - 1].material;
            stack->set_column(k % stack->size().x, k / stack->size().x, column);
        }
        return stack;
    };
    EXPECT_NE(round_trip_keeps_bytes(mutant, 3), "");
}

TEST(StackFileLaw, a_reader_that_is_one_step_off_in_one_column_fails)
{
    const auto mutant = [] {
        const Stack stack = read_again();
        std::vector<Layer> column = stack->column(0, 0);
        column.back().top += 1;
        stack->set_column(0, 0, column);
        return stack;
    };
    EXPECT_NE(round_trip_keeps_bytes(mutant, 1), "");
}

TEST(StackFileLaw, a_reader_that_rounds_the_origin_fails)
{
    const auto mutant = [] {
        const Stack stack = read_again();
        const Stack moved = std::make_shared<MaterialStack>(stack->size(), stack->cell(), stack->unit(), Vec3d(Vec3f(stack->origin())));
        for (int k = 0; k < stack->size().x * stack->size().y; ++k)
            moved->set_column(k % stack->size().x, k / stack->size().x, stack->column(k % stack->size().x, k / stack->size().x));
        return moved;
    };
    EXPECT_NE(round_trip_keeps_bytes(mutant, 1), "");
}

}  // namespace
}  // namespace hoodoo
